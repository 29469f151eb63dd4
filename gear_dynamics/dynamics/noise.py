"""Periods of a motion under measurement noise, whose level is estimated from the section itself."""

from __future__ import annotations

import numpy as np

LARGEST = 0.05
"""Scatter about a periodic motion, in standard deviations of the samples, up to which it is noise.
Chaotic motions of the gear pair scatter by 0.15 and more, periodic ones with 1 % of noise by 0.025
and less."""

FEWEST_TURNS = 12
"""Periods that a record must hold."""

SHORTER = 4.0
"""Ratio of variances up to which a shorter period explains the states as well as a longer one."""

PREDICTABLE = 0.5
"""Error of a prediction from the nearest state, over that from a random one, below which what is
left obeys equations of motion."""

CHAOTIC = 0.8
"""K of the 0-1 test from which predictable scatter is a narrow chaotic band. Errors of an
interpolated section are predictable too, and regular."""


def noisy_period(states: np.ndarray, longest: int, tolerance: float) -> tuple[int, float]:
    """Return the period of a motion whose states recur but for noise.

    For each period n the states are compared with the mean of their class, k modulo n. The least
    variance that any period leaves is the noise, and the shortest period that leaves not much more
    is taken. What it leaves must be small in the coordinate with less noise, and no narrow band of
    chaos: there the scatter follows from the state before.

    Parameters
    ----------
    states : ndarray, shape (count, dimension)
        Successive states on the section, over the standard deviations of the samples.
    longest : int
        Longest period looked for.
    tolerance : float
        Distance within which states count as the same.

    Returns
    -------
    period : int
        0 if there is none.
    scatter : float
        Standard deviation about the periodic motion in the coordinate where it is least.
    """
    longest = min(longest, len(states) // FEWEST_TURNS)
    variances = np.array([_residual(states, n).var(axis=0) for n in range(1, longest + 1)])
    # Each class has a mean of its own, which takes up a part of the noise.
    classes = np.arange(1, longest + 1)[:, np.newaxis]
    variances *= len(states) / (len(states) - classes)
    floor = np.maximum(variances.min(axis=0), (tolerance / 2) ** 2)
    period = 1 + int(np.argmax(np.all(variances <= SHORTER * floor, axis=1)))
    best = int(np.argmin(variances[period - 1]))
    scatter = float(np.sqrt(variances[period - 1, best]))
    explained = np.all(variances[period - 1] <= SHORTER * floor)
    if not explained or scatter > LARGEST:
        return 0, scatter
    if scatter > tolerance and _is_chaotic_band(_residual(states, period), period, best):
        return 0, scatter
    return period, scatter


def _residual(states: np.ndarray, period: int) -> np.ndarray:
    """Return the states less the mean of their class modulo the period."""
    residual = np.empty_like(states)
    for first in range(period):
        part = states[first::period]
        residual[first::period] = part - part.mean(axis=0)
    return residual


def _is_chaotic_band(residual: np.ndarray, period: int, coordinate: int) -> bool:
    """Return whether the state a period later follows from this one, and irregularly."""
    # SciPy takes a while to load, and those who want the constants alone need it not.
    from scipy.spatial import cKDTree

    from gear_dynamics.dynamics.zero_one import zero_one_test

    scaled = residual / np.maximum(residual.std(axis=0), np.finfo(float).tiny)
    errors = []
    for first in range(period):
        part = scaled[first::period]
        now, later = part[:-1], part[1:, coordinate]
        _, near = cKDTree(now).query(now, k=2)
        errors.append((later - later[near[:, 1]]) ** 2)
    predictable = np.concatenate(errors).mean() / 2 < PREDICTABLE
    return bool(predictable and zero_one_test(residual[:, coordinate]) > CHAOTIC)
