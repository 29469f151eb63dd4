import numpy as np
import pytest
from dynamics.test_cycles import one_degree_of_freedom, speed_at
from study.convergence import assert_table_ends_at_the_exponents

from gear_dynamics import study
from gear_dynamics.study.experiments.response import contact_is_lost, jumps, rms_of_parts


def test_response_jumps_where_attractors_end():
    values, rms = np.arange(6.0), np.array([0.1, 0.11, 0.3, 0.31, 0.7, 1.6])
    # The last two are chaotic: chance makes their difference.
    error = np.array([0, 0, 0, 0, 0.03, 0.06])
    period = np.array([1, 1, 1, 2, 0, 0])
    assert jumps(values, rms, error, period) == [(1.5, 0.11, 0.3), (3.5, 0.31, 0.7)]
    # So is that of two that differ by more, if neither has a period.
    assert len(jumps(values, rms, 0 * error, period)) == 2
    # A small response jumps as a great one does.
    assert [each[0] for each in jumps(values, rms / 50, error / 50, period)] == [1.5, 3.5]


def test_contact_is_kept_on_either_flank_and_lost_between():
    least = np.array([1.01, -1.05, 0.99, -1.2, -1.3])
    greatest = np.array([1.2, -1.01, 1.2, -0.99, 1.3])
    assert list(contact_is_lost(least, greatest)) == [False, False, True, True, True]


def test_response_on_the_back_flank_loses_no_contact():
    """A load of the other sign presses the back flanks together; below resonance they stay so."""
    loaded = study.default_operating_point().with_value('load_torque', -500.0)
    outcome = study.response(loaded, begin=0.05, end=0.06, count=2, transient=100)
    assert outcome.arrays['greatest'].max() < -1
    assert outcome.text.count('contact is never lost') == 2


def test_response_of_the_linear_oscillator_has_the_closed_form_rms():
    """Fa W^2 / sqrt((1 - W^2)^2 + (2 zeta W)^2) over the square root of 2."""
    zeta, torque = 0.05, 500.0
    pair = one_degree_of_freedom(mesh_damping_ratio=zeta, transmission_error_amplitude=1e-6)
    operation = study.OperatingPoint(pair, speed_at(pair, 0.4), torque)
    arrays = study.response(operation, begin=0.4, end=0.7, count=3, transient=200).arrays
    w = np.array([0.4, 0.55, 0.7])
    amplitude = 1e-6 / pair.half_backlash * w**2 / np.hypot(1 - w**2, 2 * zeta * w)
    assert arrays['rms'] == pytest.approx(np.array([amplitude, amplitude]) / np.sqrt(2), rel=1e-4)
    assert np.all(arrays['rms_error'] < 1e-12)
    # Two of the exponents are those of the linear oscillator, -zeta; all keep the sum rule.
    nearest = np.sort(np.abs(arrays['exponents'] + zeta), axis=-1)[..., :2]
    assert nearest.max() < 5e-4 + 4 * arrays['standard_errors'].max()
    assert np.abs(arrays['sum_error']).max() < 1e-6
    # The spring carries what the damping does not.
    force = amplitude * np.hypot(1, 2 * zeta * w) * pair.half_backlash * pair.tooth_pair_stiffness
    assert arrays['force_rms'][0] == pytest.approx(force / np.sqrt(2), rel=1e-4)


def test_rms_of_noise_comes_with_its_error():
    """Of n values of a normal distribution the RMS has a standard error of sigma / sqrt(2 n)."""
    generator = np.random.default_rng(0)
    found = []
    for _ in range(200):
        parts = generator.normal(3.0, 0.5, (20, 500))
        moments = parts.mean(axis=1)[np.newaxis], parts.var(axis=1)[np.newaxis]
        found.append([float(each[0]) for each in rms_of_parts(*moments)])
    rms, error = np.mean(found, axis=0)
    assert rms == pytest.approx(0.5, rel=1e-3)
    # 200 estimates from 20 parts each: 1.2 % of scatter.
    assert error == pytest.approx(0.5 / np.sqrt(2 * 20 * 500), rel=0.05)


def test_response_of_the_linear_motion_is_the_same_up_and_down():
    outcome = study.response(
        study.default_operating_point(), begin=0.1, end=0.13, count=4, transient=200
    )
    assert_table_ends_at_the_exponents(outcome)
    up, down = outcome.arrays['rms']
    assert up == pytest.approx(down, rel=1e-4)
    assert np.all(outcome.arrays['period'] == 1)


def test_contact_is_lost_elsewhere_when_swept_down():
    """A pair in the form of Kahraman and Singh 1990, zeta 0.05, mean load 0.1, error 0.05 of b:
    without loss of contact the amplitude is 0.05 W^2 / |H|, which reaches 0.1 at W = 0.8206. Swept
    down, the motion with impacts lasts to its fold below (0.7081 by an independent
    continuation)."""
    pair = one_degree_of_freedom(
        mesh_damping_ratio=0.05, transmission_error_amplitude=7.5e-6, damping_in_gap=True
    )
    torque = 0.1 * pair.derived.gear_base_radius * pair.tooth_pair_stiffness * pair.half_backlash
    operation = study.OperatingPoint(pair, speed_at(pair, 0.8), torque)
    text = study.response(operation, begin=0.69, end=0.84, count=31, transient=300).text
    up, down = text.split('swept down')
    # The grid has 0.825 as the first value above 0.8206, and 0.71 as the last above 0.7081.
    assert 'contact is first lost at w = 0.825' in up
    assert 'contact is last lost at w = 0.710' in down


def test_constant_motion_has_no_vibration():
    """Neither error nor change of stiffness: the RMS is within the integrator's tolerance of
    1e-12, and nothing warns."""
    pair = one_degree_of_freedom(mesh_damping_ratio=0.05, transmission_error_amplitude=0.0)
    operation = study.OperatingPoint(pair, speed_at(pair, 0.4), 500.0)
    arrays = study.response(operation, begin=0.4, end=0.5, count=2, transient=400).arrays
    assert np.all(arrays['rms'] < 1e-11)
    assert np.all(arrays['rms_error'] < 1e-11)
