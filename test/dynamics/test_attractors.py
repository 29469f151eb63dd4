import numpy as np
from dynamics.systems import henon, logistic

from gear_dynamics.dynamics.attractors import SAME, Attractor, assign, reached, same_orbit


def pairs(series):
    return np.stack([series[:-1], series[1:]], axis=1)


def test_orbits_are_one_wherever_they_begin():
    """The period-3 orbit of the logistic map, and the same points in the other direction."""
    orbit = pairs(logistic(20200, 3.83)[20000:])[:3]
    assert same_orbit(orbit, orbit[[1, 2, 0]] + SAME / 2)
    assert not same_orbit(orbit, orbit[[1, 0, 2]])
    assert not same_orbit(orbit, orbit + 2 * SAME)
    assert not same_orbit(orbit, orbit[:2])


def test_motions_are_assigned_to_what_they_have_reached():
    """The logistic map's period-3 orbit from each of its points, a motion on its way there, one of
    period 6 about it, and chaos of another map."""
    settled = pairs(logistic(20200, 3.83)[20000:])
    period_3 = Attractor('period-3', 3, settled[:3])
    chaos = Attractor('chaotic', 0, pairs(henon(2000)))
    coming = settled[:60] + 0.1 * 0.9 ** np.arange(60)[:, np.newaxis]
    doubled = settled[:60] + 2 * SAME * (np.arange(60) // 3 % 2)[:, np.newaxis]
    motions = np.stack(
        [settled[:60], settled[1:61], settled[2:62], coming, doubled, pairs(henon(5000))[-60:]]
    )
    assert list(assign(motions, [chaos, period_3])) == [1, 1, 1, 1, -1, 0]
    assert list(reached(motions[:, :10], period_3)) == [True] * 3 + [False] * 3
