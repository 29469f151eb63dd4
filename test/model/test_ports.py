"""The ports' data: terms, their sums, and what is refused."""

import numpy as np
import pytest

from gear_dynamics.model.port_checks import DEGREE
from gear_dynamics.model.ports import (
    HEALTHY,
    Harmonic,
    Offset,
    Ports,
    Table,
    ToothDeviation,
    periodic_cubics,
    smooth_pulse,
)
from gear_dynamics.parameters.parameter import ParameterError

TERMS = [
    ToothDeviation('pinion', 5, [0.0, 0.005, 0.01], stiffness=[[-0.2], [-0.1]]),
    Harmonic('transmission_error', 'gear', 1.0, 5e-6),
    Table('pinion_rest_y', 'pinion', [0.0, 0.1, 0.25], [smooth_pulse(1e-6), [0.0] * 7]),
    Offset('friction', 0.02),
]


@pytest.mark.parametrize('term', TERMS)
def test_terms_of_no_strength_leave_the_machine_healthy(term):
    assert Ports([term]).scaled(0.0) == HEALTHY
    assert len(Ports([term])) == 1
    assert Ports([term]) != HEALTHY


def test_ports_add_up_and_equal_terms_are_found():
    again = ToothDeviation('pinion', 5, [0.0, 0.005, 0.01], stiffness=[[-0.2], [-0.1]])
    assert again == TERMS[0]
    assert hash(again) == hash(TERMS[0])
    assert again.scaled(2.0) != TERMS[0]
    assert Ports(TERMS[:1]) + Ports(TERMS[1:]) == Ports(TERMS)
    assert list(Ports(TERMS)) == TERMS


def test_a_pulse_is_as_high_as_said_and_smooth_at_its_ends():
    pulse = np.polynomial.Polynomial(smooth_pulse(3e-6))
    assert pulse(0.5) == pytest.approx(3e-6)
    for order in range(3):
        np.testing.assert_allclose(pulse.deriv(order)(np.array([0.0, 1.0])), 0.0, atol=1e-18)


def test_noise_repeats_and_joins_smoothly():
    noise = Table.of_noise('load_torque', 'time', 5.0, 0.01, 1000, seed=3)
    assert noise == Table.of_noise('load_torque', 'time', 5.0, 0.01, 1000, seed=3)
    values = noise.coefficients[:, 0]
    assert np.std(values) == pytest.approx(5.0, rel=0.1)
    ends = noise.coefficients.sum(axis=1)
    np.testing.assert_allclose(ends, np.roll(values, -1), atol=1e-12)
    slopes = noise.coefficients @ np.arange(DEGREE + 1)
    np.testing.assert_allclose(slopes, np.roll(noise.coefficients[:, 1], -1), atol=1e-12)
    np.testing.assert_allclose(periodic_cubics(np.ones(4))[:, 1:], 0.0)


@pytest.mark.parametrize(
    ('make', 'names'),
    [
        (lambda: ToothDeviation('wheel', 5, [0, 1]), 'wheel'),
        (lambda: ToothDeviation(None, 5, [0, 1]), 'tooth is 5'),
        (lambda: ToothDeviation('gear', 5, [1, 0]), 'edges'),
        (lambda: ToothDeviation('gear', 5, [0, 1], stiffness=[[0.1], [0.2]]), 'stiffness'),
        (lambda: ToothDeviation('gear', 5, [0, 1], error=[[np.nan]]), 'error'),
        (lambda: ToothDeviation('gear', 5, [0, 1], loss=1.1), 'loss is 1.1: .* from 0 to 1'),
        (lambda: Harmonic('torque', 'gear', 1.0, 1.0), 'torque'),
        (lambda: Harmonic('friction', 'wheel', 1.0, 1.0), 'wheel'),
        (lambda: Harmonic('friction', 'gear', np.inf, 1.0), 'order'),
        (lambda: Table('friction', 'gear', [0.0], []), 'knots'),
        (lambda: Table('friction', 'gear', [0.0, 1.0], [[0.0] * 8]), 'coefficients'),
        (lambda: Ports([1.0]), '1.0'),
    ],
)
def test_what_is_wrong_is_refused_by_name(make, names):
    with pytest.raises(ParameterError, match=names):
        make()
