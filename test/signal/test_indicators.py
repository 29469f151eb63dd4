import math

import numpy as np
import pytest

from gear_dynamics.signal import statistics
from gear_dynamics.signal.indicators import (
    RunningKurtosis,
    energy_ratio,
    fm0,
    fm4,
    has_difference,
    m6a,
    m8a,
    mesh_envelope,
    sideband_index,
    sideband_level_factor,
)
from gear_dynamics.signal.synchronous import separate

POINTS = 34 * 64
TURN = 2 * np.pi * np.arange(POINTS) / POINTS


def test_moments_of_gaussian_noise():
    noise = np.random.default_rng(0).normal(size=1_000_000)
    # Standard errors of the moments at n = 1e6: 0.010, 0.10, 1.4 (from the moments up to order 16).
    assert fm4(noise) == pytest.approx(3, abs=0.04)
    assert m6a(noise) == pytest.approx(15, abs=0.4)
    assert m8a(noise) == pytest.approx(105, abs=5.6)
    assert statistics.skewness(noise) == pytest.approx(0, abs=0.01)


def test_moments_of_a_sine():
    sine = 7 * np.sin(34 * TURN) + 2
    assert fm4(sine) == pytest.approx(1.5)
    assert m6a(sine) == pytest.approx(2.5)
    assert m8a(sine) == pytest.approx(4.375)


def test_level_of_a_sine():
    sine = 3 * np.sin(34 * TURN)
    assert statistics.rms(sine) == pytest.approx(3 / math.sqrt(2))
    assert statistics.peak(sine) == pytest.approx(3)
    assert statistics.crest_factor(sine) == pytest.approx(math.sqrt(2))
    assert statistics.kurtosis(sine) == pytest.approx(1.5)


def test_skewness_of_an_exponential_distribution():
    # 2 for an exponential distribution
    x = np.random.default_rng(1).exponential(size=1_000_000)
    assert statistics.skewness(x) == pytest.approx(2, abs=0.05)


def test_peak_and_crest_factor_are_about_the_mean():
    sine = 3 * np.sin(34 * TURN) + 100
    assert statistics.peak(sine) == pytest.approx(3)
    assert statistics.crest_factor(sine) == pytest.approx(math.sqrt(2))
    assert statistics.std(sine) == pytest.approx(3 / math.sqrt(2))
    assert statistics.rms(sine) == pytest.approx(math.sqrt(10_000 + 4.5))


def test_moments_of_blocks_are_those_of_the_signal_by_direct_sums():
    x = np.random.default_rng(2).gamma(2.0, size=(1000, 3)) + 50
    moments = statistics.Moments()
    for block in np.split(x, [1, 10, 600]):
        moments.add(block)
    centred = x - x.mean(axis=0)
    spread = np.sqrt((centred**2).mean(axis=0))
    expected = {
        'mean': x.mean(axis=0),
        'rms': np.sqrt((x**2).mean(axis=0)),
        'std': spread,
        'peak': np.abs(centred).max(axis=0),
        'crest_factor': np.abs(centred).max(axis=0) / spread,
        'kurtosis': (centred**4).mean(axis=0) / spread**4,
        'skewness': (centred**3).mean(axis=0) / spread**3,
    }
    found = moments.indicators()
    assert found.keys() == expected.keys()
    for name, value in expected.items():
        np.testing.assert_allclose(found[name], value, rtol=1e-9, err_msg=name)


def test_constants_have_no_ratios():
    with np.errstate(all='raise'):
        assert math.isnan(statistics.crest_factor(np.zeros(8)))
        assert math.isnan(statistics.kurtosis(np.ones(8)))


@pytest.mark.parametrize('m', [0.1, 0.5])
def test_sidebands_of_an_amplitude_modulated_mesh_tone(m):
    amplitude = 2.0
    x = amplitude * (1 + m * np.cos(TURN)) * np.cos(34 * TURN)
    assert sideband_index(x, 34) == pytest.approx(amplitude * m / 2)
    expected = m * math.sqrt(2) / math.sqrt(1 + m**2 / 2)
    assert sideband_level_factor(x, 34) == pytest.approx(expected)


def test_fm0_of_mesh_tones():
    # Peak to peak 2 A over A; a cosine with its second harmonic: PP = 2 A1 for A2 <= A1 / 4.
    assert fm0(3 * np.cos(34 * TURN), 34) == pytest.approx(2)
    both = np.cos(34 * TURN) + 0.25 * np.cos(68 * TURN)
    assert fm0(both, 34) == pytest.approx(2 / 1.25)


def test_fm0_counts_a_mesh_line_at_the_nyquist_order_once():
    # Two points a tooth: the mesh is the Nyquist order, of amplitude 1 and peak-to-peak 2.
    assert fm0((-1.0) ** np.arange(68), 34) == pytest.approx(2, rel=1e-9)


def test_fm0_reads_a_narrow_pulse_between_two_points():
    # A band-limited pulse of unit height (all orders to 500) halfway between two points, over a
    # mesh line of amplitude 1 whose crest it stands on.
    half_a_point = np.pi / 1088
    turn = 2 * np.pi * np.arange(1088) / 1088 - half_a_point
    pulse = np.sum([np.cos(order * turn) for order in range(1, 501)], axis=0) / 500
    x = 10 * pulse + np.cos(34 * turn)
    fine = np.linspace(1e-6, 2 * np.pi - 1e-6, 200_001)
    # The sum of cos(k x) for k to N is (sin((N + 1/2) x) / sin(x / 2) - 1) / 2 (Dirichlet).
    of_fine = (np.sin(500.5 * fine) / np.sin(fine / 2) - 1) / 1000
    expected = np.ptp(10 * of_fine + np.cos(34 * fine))
    harmonics = 1 + 14 * 10 / 500  # the pulse has a line at each of the 14 mesh orders below 501
    assert fm0(x, 34) == pytest.approx(expected / harmonics, rel=0.01)


@pytest.mark.parametrize('teeth', [-3, 0, 2.5])
def test_impossible_teeth_are_refused(teeth):
    with pytest.raises(ValueError, match='teeth is'):
        separate(TURN, teeth)


@pytest.mark.parametrize('function', [fm0, mesh_envelope, separate, sideband_index])
def test_an_average_with_too_few_points_for_its_teeth_is_refused(function):
    with pytest.raises(ValueError, match='60 points: 34 teeth need at least'):
        function(np.zeros(60), 34)


def test_energy_ratio_of_known_parts():
    parts = separate(np.cos(34 * TURN) + 0.1 * np.cos(10 * TURN), 34)
    assert energy_ratio(parts) == pytest.approx(0.1)


def test_na4_of_a_growing_fault_follows_the_series_by_hand():
    # Residual a sin: fourth moment 3/8 a^4, variance a^2 / 2. Amplitudes 1, 1, 2, 4:
    # variances 1/2, 1/2, 2, 8; running means 1/2, 1/2, 1, 11/4.
    na4 = RunningKurtosis()
    found = [na4.add(a * np.sin(10 * TURN)) for a in (1, 1, 2, 4)]
    assert found == pytest.approx([1.5, 1.5, 6.0, 3 / 8 * 256 / (11 / 4) ** 2])


def test_mesh_envelope_of_a_modulated_harmonic():
    modulation = 1 + 0.5 * np.cos(3 * TURN)
    strongest = modulation * np.cos(68 * TURN)
    x = np.stack([strongest + 0.3 * np.cos(34 * TURN), strongest], axis=1)
    np.testing.assert_allclose(mesh_envelope(x, 34), np.stack([modulation] * 2, 1), atol=1e-9)


def test_the_envelope_of_a_given_harmonic_is_of_that_one():
    x = np.cos(34 * TURN) + (1 + 0.5 * np.cos(3 * TURN)) * np.cos(68 * TURN)
    np.testing.assert_allclose(mesh_envelope(x, 34, 1), 1, atol=1e-9)


def test_a_healthy_average_has_no_difference_signal():
    healthy = np.cos(34 * TURN)
    faulty = healthy + 1e-3 * np.cos(10 * TURN)
    parts = separate(np.stack([healthy, faulty], axis=1), 34)
    assert has_difference(parts).tolist() == [False, True]
