"""Published models of one degree of freedom."""

import numpy as np
import pytest

from gear_dynamics import GearPair, ParameterError, dynamics, study
from gear_dynamics.study.initial import scattered_states, states_at


def test_rigid_supports_hold_the_bodies_and_leave_two_exponents():
    """-zeta twice, below the resonance where contact is kept."""
    point = study.OperatingPoint.from_dimensionless(
        frequency_ratio=0.5, mean_load=0.1, damping_ratio=0.05, error_amplitude=0.05
    )
    assert point.frequency_ratio == pytest.approx(0.5)
    run = ([point.pair], point.speed, point.load_torque)
    bodies = dynamics.run_cycles(*run, 5, samples_per_cycle=8, with_bodies=True).bodies
    for name in ('pinion_x', 'pinion_y', 'gear_x', 'gear_y'):
        assert np.abs(bodies[name]).max() < 1e-250
    outcome = study.response(point, begin=0.5, end=0.6, count=2, transient=200)
    assert outcome.arrays['exponents'] == pytest.approx(np.full((2, 2, 2), -0.05), abs=1e-3)
    assert np.abs(outcome.arrays['sum_error']).max() < 1e-9


def test_mean_load_and_error_are_those_asked_for():
    """Static deflection beyond the gap is the mean load over k; the error is in half gaps."""
    pair = GearPair.from_dimensionless(damping_ratio=0.02, error_amplitude=0.3, error_phase=0.4)
    assert pair.transmission_error_amplitude == pytest.approx(0.3 * pair.half_backlash)
    assert pair.derived.tooth_pair_damping == pytest.approx(
        2 * 0.02 * np.sqrt(pair.derived.single_stiffness * pair.derived.equivalent_mass)
    )
    point = study.OperatingPoint.from_dimensionless(
        frequency_ratio=1.2, mean_load=0.25, damping_ratio=0.02, error_amplitude=0.0
    )
    system = dynamics.GearMap(point.pair, point.speed, point.load_torque)
    start = dynamics.static_state(point.pair, point.speed, point.load_torque)
    assert system.section(system.scaled(start)) == pytest.approx([1.25, 0.0], abs=1e-12)
    with pytest.raises(ParameterError, match='mesh_damping_ratio is -1'):
        GearPair.from_dimensionless(damping_ratio=-1.0, error_amplitude=0.1)


def rattle_model(beta=0.6, delta=0.6, epsilon=0.1, kappa=100.0):
    """The gear rattle model of Mason, Piiroinen, Wilson and Homer 2009:
    x'' + delta x' + 2 kappa B(x) = 4 pi delta - 4 pi^2 epsilon cos 2 pi t
    - 2 pi delta epsilon sin 2 pi t, with a gap from -beta to beta."""
    wn = np.sqrt(2 * kappa)
    w = 2 * np.pi / wn
    cosine = -4 * np.pi**2 * epsilon / (wn**2 * beta)
    sine = -2 * np.pi * delta * epsilon / (wn**2 * beta)
    return study.OperatingPoint.from_dimensionless(
        frequency_ratio=w,
        mean_load=4 * np.pi * delta / (wn**2 * beta),
        damping_ratio=delta / (2 * wn),
        error_amplitude=np.hypot(cosine, sine) / w**2,
        error_phase=np.arctan2(cosine, sine),
    )


def test_gear_rattle_model_has_four_period_1_motions():
    """All stable; damping acts everywhere, so that their multipliers have the product
    exp(-delta)."""
    point = rattle_model()
    system = dynamics.GearMap(point.pair, point.speed, point.load_torque)
    grid = np.meshgrid(np.linspace(-1.5, 1.5, 12), np.linspace(-1, 1, 12))
    states = states_at(point, *(each.ravel() for each in grid))
    run = ([point.pair] * len(states), point.speed, point.load_torque)
    ends = system.scaled(dynamics.run_cycles(*run, 120, states=states).states)
    found = []
    for end in ends:
        if all(np.abs(end - other.points[0]).max() > 0.01 for other in found):
            found.append(dynamics.periodic_orbit(system, 1, end))
    assert len(found) == 4
    assert all(each.stable for each in found)
    for each in found:
        assert np.prod(each.multipliers).real == pytest.approx(np.exp(-0.6), rel=1e-9)


def test_scattered_states_of_a_rigid_pair_differ_in_rotation_alone():
    states = scattered_states(rattle_model(), 4)
    assert np.ptp(states[:, [0, 1, 2, 3, 6, 7, 8, 9]], axis=0).max() == 0
