"""What every function over arrays takes: lists, integers, any axis; and what it refuses."""

import numpy as np
import pytest

import gear_dynamics.signal as gd_signal
from gear_dynamics.signal import (
    amplitude_spectrum,
    below_order,
    crest_factor,
    energy_ratio,
    envelope,
    envelope_orders,
    envelope_spectrum,
    even_pulses,
    first_sidebands,
    fm0,
    fm4,
    has_difference,
    interpolate,
    kurtosis,
    m6a,
    m8a,
    mesh_amplitudes,
    mesh_envelope,
    mesh_phase,
    most_impulsive_band,
    normalised_moment,
    peak,
    phase_from_angle,
    phase_from_pulses,
    phase_from_speed,
    repair_pulses,
    resample_by_phase,
    rising_edges,
    rms,
    separate,
    sideband_index,
    sideband_level_factor,
    skewness,
    spectral_kurtosis,
    strongest_harmonic,
    synchronous_average,
    tooth_energy,
    track_speed,
    trigger_level,
    variance_ratio_kurtosis,
)

RATE = 12000.0
X = np.random.default_rng(0).normal(0, 8000, (3, 2, 2048)).round()

REDUCTIONS = (
    rms,
    peak,
    crest_factor,
    kurtosis,
    skewness,
    lambda x, axis: normalised_moment(x, 6, axis),
    # The rest take X as averages of a revolution of 17 teeth.
    lambda x, axis: fm0(x, 17, axis=axis),
    lambda x, axis: fm4(x, axis=axis),
    lambda x, axis: m6a(x, axis=axis),
    lambda x, axis: m8a(x, axis=axis),
    lambda x, axis: variance_ratio_kurtosis(x, 6e7, axis=axis),
    lambda x, axis: strongest_harmonic(x, 17, axis=axis),
    lambda x, axis: sideband_index(x, 17, axis=axis),
    lambda x, axis: sideband_level_factor(x, 17, axis=axis),
    lambda x, axis: energy_ratio(separate(x, 17, axis=axis), axis=axis),
    lambda x, axis: has_difference(separate(x, 17, axis=axis), axis=axis),
    lambda x, axis: tooth_energy(x, 17, axis=axis).score,
)
TRANSFORMS = (
    lambda x, axis: envelope(x, RATE, 1000, 3000, axis=axis),
    lambda x, axis: envelope_spectrum(x, RATE, 1000, 3000, axis=axis)[1],
    lambda x, axis: amplitude_spectrum(x, RATE, length=512, axis=axis)[1],
    lambda x, axis: spectral_kurtosis(x, RATE, axis=axis)[1],
    lambda x, axis: synchronous_average(x, 100, axis=axis),
    lambda x, axis: resample_by_phase(x, np.arange(2048) / 20, 16, axis=axis)[1],
    lambda x, axis: below_order(x, 40, axis=axis),
    lambda x, axis: separate(x, 17, axis=axis).residual,
    lambda x, axis: mesh_amplitudes(x, 17, axis=axis),
    lambda x, axis: mesh_envelope(x, 17, axis=axis),
    lambda x, axis: first_sidebands(x, 17, axis=axis),
    lambda x, axis: tooth_energy(x, 17, axis=axis).energy,
    lambda x, axis: interpolate(x, np.linspace(15.0, 2031.0, 100), axis=axis),
    lambda x, axis: mesh_phase(x, x, 17, 40, 0.3, axis=axis),
)


@pytest.mark.parametrize('function', [*REDUCTIONS, *TRANSFORMS])
def test_any_axis_gives_what_each_channel_gives(function):
    found = np.asarray(function(X, -1))
    for i, j in np.ndindex(3, 2):
        np.testing.assert_allclose(found[i, j], function(X[i, j], 0), rtol=1e-9)
    first = np.moveaxis(np.asarray(function(np.moveaxis(X, -1, 0), 0)), 0, -1)
    if function in TRANSFORMS:
        np.testing.assert_allclose(found, first, rtol=1e-9)


@pytest.mark.parametrize('function', [*REDUCTIONS, *TRANSFORMS])
def test_integers_and_lists_are_float64(function):
    integers = X[0, 0].astype(np.int16)
    expected = function(X[0, 0], 0)
    np.testing.assert_array_equal(function(integers, 0), expected)
    np.testing.assert_array_equal(function(integers.tolist(), 0), expected)


@pytest.mark.parametrize('function', [*REDUCTIONS, *TRANSFORMS])
@pytest.mark.parametrize('bad', [np.nan, np.inf])
def test_a_value_that_is_not_finite_is_refused_with_its_place(function, bad):
    x = X[0, 0].copy()
    x[7] = bad
    with pytest.raises(ValueError, match=f'is {bad} at index 7'):
        function(x, 0)


COUNTS = np.arange(2048)
ONE_CHANNEL = {
    # What each takes, and the series that it is tried on.
    'trigger_level': (trigger_level, X[0, 0]),
    'rising_edges': (lambda x: rising_edges(x, 0.0, 100.0), X[0, 0]),
    'repair_pulses': (lambda x: repair_pulses(x).instants, 10 * COUNTS),
    'even_pulses': (lambda x: even_pulses(x, COUNTS, 4), 10 * COUNTS),
    'phase_from_pulses': (lambda x: phase_from_pulses(x, COUNTS, 4).revolutions, 10 * COUNTS),
    'phase_from_angle': (lambda x: phase_from_angle(x, RATE, 4096).revolutions, 40 * COUNTS),
    'phase_from_speed': (lambda x: phase_from_speed(x, RATE).revolutions, 20 + COUNTS % 3),
    'track_speed': (
        lambda x: track_speed(x, RATE, 20.0, 30.0, [10.0], 1.0).phase.revolutions,
        np.round(1000 * np.sin(2 * np.pi * 250 / RATE * np.arange(24000))),
    ),
    'envelope_orders': (
        lambda x: envelope_orders(x, RATE, COUNTS / 20, 1000, 3000, 5).amplitude,
        X[0, 0],
    ),
}


@pytest.mark.parametrize('name', ONE_CHANNEL)
def test_functions_of_one_channel_take_lists_and_integers_and_refuse_the_rest(name):
    function, series = ONE_CHANNEL[name]
    expected = function(series.astype(float))
    assert np.size(expected)
    np.testing.assert_array_equal(function(series.astype(np.int32)), expected)
    np.testing.assert_array_equal(function(series.astype(int).tolist()), expected)
    bad = series.astype(float)
    bad[7] = np.nan
    with pytest.raises(ValueError, match='is nan at index 7'):
        function(bad)
    with pytest.raises(ValueError, match='must hold one channel'):
        function(np.stack([series, series], axis=1))


def test_a_column_of_integers_has_the_band_of_the_same_series():
    # Impacts that ring at 3 kHz.
    t = np.arange(12000)
    ringing = np.exp(-(t % 1200) / 60) * np.sin(2 * np.pi * 3000 / RATE * (t % 1200))
    noise = np.random.default_rng(1).normal(size=12000)
    x = (1000 * ringing + 100 * noise).astype(np.int16)
    band = most_impulsive_band(x[:, np.newaxis], RATE)
    assert band == most_impulsive_band(x.astype(float), RATE)
    assert band.low < 3000 < band.high


@pytest.mark.parametrize(
    ('call', 'words'),
    [
        (lambda: rms([]), 'no samples'),
        (lambda: rms(['a']), 'must hold real numbers'),
        (lambda: rms([1j]), 'must hold real numbers'),
        (lambda: rms([1.0], axis=1), 'no axis 1'),
        (lambda: rms(3.0), 'no axis 0'),
        (lambda: envelope(X[0, 0], 0.0, 1.0, 2.0), 'rate is 0'),
        (lambda: envelope(X[0, 0], RATE, 1000.0, 1000.1), 'no line'),
        (lambda: amplitude_spectrum(X[0, 0], np.nan), 'rate is nan'),
        (lambda: most_impulsive_band(X[0], RATE), 'must hold one channel'),
        (
            lambda: envelope_orders(X[0, 0], RATE, COUNTS[1:], 1, 2, 5),
            'revolutions has 2047 values',
        ),
        (lambda: phase_from_speed([1.0, 2.0], 0.0), 'rate is 0'),
        (lambda: synchronous_average(X[0, 0], 0), 'points is 0'),
        (lambda: resample_by_phase(X[0, 0], np.arange(5.0), 8), r'phase has the shape \(5,\)'),
        (lambda: fm4([1.0, np.nan]), 'nan at index 1'),
        (lambda: separate([np.nan] * 100, 10), 'average is nan at index 0'),
    ],
)
def test_refusals_name_the_argument(call, words):
    with pytest.raises(ValueError, match=words):
        call()


def test_the_room_exports_its_functions_by_name():
    assert 'fm4' in dir(gd_signal)
    for name in gd_signal.__all__:
        assert callable(getattr(gd_signal, name)), name
    with pytest.raises(AttributeError, match='no attribute'):
        getattr(gd_signal, 'cepstrum')  # noqa: B009
