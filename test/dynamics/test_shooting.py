import numpy as np
import pytest
from dynamics.maps import Henon
from dynamics.oscillators import ERROR, MEAN, ZETA, cycle_by_scipy, kahraman_singh

from gear_dynamics import dynamics, study


def fixed_point(a, b=0.3):
    """Of the Henon map: a x^2 + (1 - b) x - 1 = 0, the root that is stable for small a."""
    x = (b - 1 + np.sqrt((1 - b) ** 2 + 4 * a)) / (2 * a)
    return np.array([x, b * x])


def test_unstable_fixed_point_of_the_henon_map():
    """Its multipliers are the roots of m^2 + 2 a x m - b = 0."""
    orbit = dynamics.periodic_orbit(Henon(1.4), 1, np.array([0.5, 0.2]))
    expected = fixed_point(1.4)
    assert orbit.points[0] == pytest.approx(expected, abs=1e-12)
    roots = np.roots([1, 2 * 1.4 * expected[0], -0.3])
    assert np.sort(orbit.multipliers.real) == pytest.approx(np.sort(roots), abs=1e-10)
    assert not orbit.stable
    assert orbit.errors.max() < 1e-9


def test_period_2_of_the_henon_map():
    """a x^2 - (1 - b) x + (1 - b)^2 / a - 1 = 0 for both x (from the map iterated twice)."""
    a, b = 0.8, 0.3
    start = np.array([[1.2, -0.1], [-0.3, 0.4]])
    orbit = dynamics.periodic_orbit(Henon(a), 2, start)
    expected = np.roots([a, b - 1, (1 - b) ** 2 / a - 1])
    assert np.sort(orbit.points[:, 0]) == pytest.approx(np.sort(expected), abs=1e-12)
    assert orbit.period == 2
    assert orbit.stable


def test_orbit_that_closes_sooner_has_its_own_period():
    orbit = dynamics.periodic_orbit(Henon(0.2), 4, np.array([0.9, 0.2]))
    assert orbit.period == 1
    assert orbit.points[0] == pytest.approx(fixed_point(0.2), abs=1e-10)


def test_no_orbit_is_told_in_one_line():
    """Below a = -(1 - b)^2 / 4 the Henon map has no fixed point, and so no orbit at all."""
    with pytest.raises(dynamics.OrbitError, match='no orbit of period 1 was found') as caught:
        dynamics.periodic_orbit(Henon(-0.2), 1, np.array([0.5, 0.2]))
    assert '\n' not in str(caught.value)
    with pytest.raises(ValueError, match='period is 33: it must be from 1 to 32'):
        dynamics.periodic_orbit(Henon(1.4), 33, np.zeros(2))
    with pytest.raises(ValueError, match=r'start has the shape \(3,\): it must be \(2,\) or'):
        dynamics.periodic_orbit(Henon(1.4), 1, np.zeros(3))


def test_motion_without_loss_of_contact_has_multipliers_and_amplitude_in_closed_form():
    w = 0.5
    system = kahraman_singh(w)
    start = dynamics.static_state(system.pair, system.speed, system.load_torque)
    orbit = dynamics.periodic_orbit(system, 1, system.scaled(start))
    period = 2 * np.pi / w
    expected = np.exp((-ZETA + 1j * np.sqrt(1 - ZETA**2)) * period)
    assert orbit.multipliers.shape == (2,)
    assert np.abs(orbit.multipliers - expected).min() < 1e-10
    assert np.abs(orbit.multipliers - expected.conj()).min() < 1e-10
    contact = system.contact(orbit.points)
    amplitude = ERROR * w**2 / np.hypot(1 - w**2, 2 * ZETA * w)
    assert contact.sequence == 'D'
    assert contact.rms == pytest.approx(amplitude / np.sqrt(2), rel=1e-9)
    assert contact.clearance == pytest.approx(MEAN - amplitude, rel=1e-6)


def test_impacting_orbit_is_that_of_an_independent_shooting():
    """The upper of the two motions of Kahraman and Singh's oscillator at w = 0.75."""
    w = 0.75
    system = kahraman_singh(w)
    start = dynamics.states_at(
        system.pair, system.speed, system.load_torque, np.array([1.6]), np.array([0.3])
    )
    settled = dynamics.run_cycles(
        [system.pair], system.speed, system.load_torque, 400, states=start
    ).states
    orbit = dynamics.periodic_orbit(system, 1, system.scaled(settled[0]))
    contact = system.contact(orbit.points)
    assert contact.sequence == 'DG'
    x, v = system.section(orbit.points)[0]
    for _ in range(3):
        end = cycle_by_scipy(w, x, v)
        step = 1e-5
        jacobian = np.stack(
            [(cycle_by_scipy(w, x + step, v) - cycle_by_scipy(w, x - step, v)) / (2 * step),
             (cycle_by_scipy(w, x, v + step) - cycle_by_scipy(w, x, v - step)) / (2 * step)],
            axis=1,
        )  # fmt: skip
        x, v = np.array([x, v]) + np.linalg.solve(np.eye(2) - jacobian, end - [x, v])
    assert system.section(orbit.points)[0] == pytest.approx([x, v], abs=1e-8)
    # Differences over 1e-5 of what SciPy has to 1e-10, or to 1e-9 in older releases.
    for expected in np.linalg.eigvals(jacobian):
        assert np.abs(orbit.multipliers - expected).min() < 1e-4


def test_jacobian_is_that_of_finite_differences():
    """On the preset's unstable period-1 orbit, which loses contact."""
    point = study.friction_chaos()
    system = dynamics.GearMap(point.pair, point.speed, point.load_torque)
    run = dynamics.run_cycles([point.pair], point.speed, point.load_torque, 500)
    orbit = dynamics.periodic_orbit(system, 1, system.scaled(run.states[0]))
    assert system.contact(orbit.points).sequence == 'DG'
    assert not orbit.stable
    steps = 1e-6 * np.eye(10)
    above, below = (system.iterate(orbit.points + each) for each in (steps, -steps))
    assert pytest.approx(orbit.monodromy, abs=1e-6) == (above - below).T / 2e-6
