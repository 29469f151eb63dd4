"""The kind of motion that a section shows: periodic, quasi-periodic or chaotic."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from gear_dynamics.dynamics.lyapunov import Lyapunov, lyapunov_exponent
from gear_dynamics.dynamics.zero_one import zero_one_test

LONGEST_PERIOD = 16
"""Longest period that is told from quasi-periodic motion, in mesh cycles."""

CHAOTIC = 0.8
REGULAR = 0.2
"""Bounds of K of the 0-1 test; between them a record is too short or too noisy to tell."""

ENOUGH = 1000
"""Points of the section below which motion that is not periodic is not judged."""


class Regime(NamedTuple):
    """What the section shows.

    Attributes
    ----------
    words : str
        `period-3`, `settling to period-3`, `quasi-periodic`, `chaotic` or `undecided`.
    period : int
        In mesh cycles; 0 if not periodic.
    recurrence : float
        Greatest distance between states one period apart, in the scale; NaN if not periodic.
    zero_one : float
        K of the 0-1 test; NaN if periodic or too short.
    lyapunov : Lyapunov or None
        Largest exponent [1/s]; None if periodic or too short.
    """

    words: str
    period: int
    recurrence: float
    zero_one: float
    lyapunov: Lyapunov | None


def recurrence_period(
    states: np.ndarray, tolerance: float, longest: int = LONGEST_PERIOD
) -> tuple[int, float]:
    """Return the least n for which every state recurs after n steps, within the tolerance.

    Parameters
    ----------
    states : ndarray, shape (count, dimension)
        Successive states on the section, scaled; at least twice as many as `longest`.
    tolerance : float
        Greatest distance (maximum norm) that counts as recurrence.
    longest : int
        Longest period looked for.

    Returns
    -------
    period : int
        0 if there is none.
    distance : float
        The greatest one at that period; NaN without one.
    """
    if len(states) < 2 * longest:
        raise ValueError(f'{len(states)} states are too few for periods up to {longest}')
    for period in range(1, longest + 1):
        distance = float(np.max(np.abs(states[period:] - states[:-period])))
        if distance <= tolerance:
            return period, distance
    return 0, math.nan


def regime(states: np.ndarray, cycle_rate: float, tolerance: float) -> Regime:
    """Return the regime of a steady motion from its section.

    Periodic by recurrence within `tolerance`, settling if only the second half recurs; else the
    0-1 test tells quasi-periodic from chaotic motion, and the largest Lyapunov exponent is
    estimated from the first coordinate.

    Parameters
    ----------
    states : ndarray, shape (count, 2)
        Successive (delta, delta_dot) on the section, each over the scale of its excursions; 64 or
        more.
    cycle_rate : float
        Sections per second [Hz].
    tolerance : float
        In that scale.
    """
    period, distance = recurrence_period(states, tolerance)
    if period:
        return Regime(f'period-{period}', period, distance, math.nan, None)
    half = states[len(states) // 2 :]
    period, distance = recurrence_period(half, tolerance)
    if period:
        return Regime(f'settling to period-{period}', period, distance, math.nan, None)
    if len(states) < ENOUGH:
        return Regime('undecided', 0, math.nan, math.nan, None)
    series = states[:, 0]
    k = zero_one_test(series)
    words = 'chaotic' if k > CHAOTIC else 'quasi-periodic' if k < REGULAR else 'undecided'
    return Regime(words, 0, math.nan, k, lyapunov_exponent(series, cycle_rate, lag=1))
