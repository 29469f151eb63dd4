"""The regime of a motion: periodic, quasi-periodic or chaotic, told from its section."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gear_dynamics.dynamics.noise import noisy_period

if TYPE_CHECKING:
    from gear_dynamics.dynamics.lyapunov import Lyapunov

PERIOD, CHAOS, TORUS, UNDECIDED = 'period-', 'chaotic', 'quasi-periodic', 'undecided'
"""The regimes by name; that of a periodic motion goes on with its period."""

LONGEST_PERIOD = 16
"""Longest period that is told from quasi-periodic motion on line, in mesh cycles."""

LONGEST_NOISY = 64
"""Longest period looked for in a section without a known exponent, in mesh cycles; a quarter of the
states if that is less."""

LONGEST_STUDIED = 32
"""Longest period that studies look for, in mesh cycles."""

RECURS = 1e-3
"""Distance of states, over half the backlash, within which studies count them as the same."""

CHAOTIC = 0.8
REGULAR = 0.2
"""Bounds of K of the 0-1 test; between them a record is too short or too noisy to tell."""

ENOUGH = 1000
"""Points of the section below which the 0-1 test is not asked."""

GROWS = 1e-3
"""Largest exponent per tau above which a motion is chaotic, if it is AGREE standard errors from
zero too."""

AGREE = 3.0


class Regime(NamedTuple):
    """The regime that a section shows.

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
        Largest exponent [1/s], estimated from the section; None if periodic, too short, or known.
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

    Raises
    ------
    ValueError
        If there are too few states.
    """
    if len(states) < 2 * longest:
        raise ValueError(f'{len(states)} states are too few for periods up to {longest}')
    for period in range(1, longest + 1):
        distance = float(np.max(np.abs(states[period:] - states[:-period])))
        if distance <= tolerance:
            return period, distance
    return 0, math.nan


def regime(
    states: np.ndarray,
    cycle_rate: float = 1.0,
    tolerance: float = RECURS,
    *,
    exponent: float | None = None,
    standard_error: float = 0.0,
) -> Regime:
    """Return the regime of a motion from its section and, if it is known, its largest exponent.

    Without an exponent: periodic if all states recur within `tolerance`, or within noise whose
    level is estimated from the states (`noisy_period`); settling if only those of the second half
    do; else the largest exponent, estimated from the first coordinate, and the 0-1 test tell
    quasi-periodic from chaotic motion.

    With an exponent: periodic if the last states recur and the exponent is not positive; chaotic if
    it is, and the 0-1 test does not contradict it; quasi-periodic if the 0-1 test says so and the
    exponent is zero within its error.

    Parameters
    ----------
    states : ndarray, shape (count, 2)
        Successive (delta, delta_dot) on the section, scaled; 64 or more.
    cycle_rate : float
        Sections per second [Hz], for the estimated exponent.
    tolerance : float
        Distance within which states count as the same, in that scale.
    exponent, standard_error : float, optional
        Largest exponent per tau = wn t.
    """
    if exponent is None:
        return _from_section(states, cycle_rate, tolerance)
    return _from_exponent(states, tolerance, exponent, standard_error)


def _from_section(states: np.ndarray, cycle_rate: float, tolerance: float) -> Regime:
    # SciPy takes a while to load, and those who want the constants alone need it not.
    from gear_dynamics.dynamics.lyapunov import lyapunov_exponent
    from gear_dynamics.dynamics.zero_one import zero_one_test

    longest = min(LONGEST_NOISY, len(states) // 4)
    noisy, _ = noisy_period(states, longest, tolerance)
    for prefix, part in (('', states), ('settling to ', states[len(states) // 2 :])):
        period, distance = recurrence_period(part, tolerance, min(longest, len(part) // 2))
        # Under noise, and where states are interpolated, some multiple of the period recurs by
        # chance; the shorter one is that of the motion.
        explained = 0 < noisy < period or (prefix and noisy == period)
        if period and not explained:
            return Regime(f'{prefix}{PERIOD}{period}', period, distance, math.nan, None)
    if noisy:
        distance = float(np.max(np.abs(states[noisy:] - states[:-noisy])))
        return Regime(f'{PERIOD}{noisy}', noisy, distance, math.nan, None)
    if len(states) < ENOUGH:
        return Regime(UNDECIDED, 0, math.nan, math.nan, None)
    k = zero_one_test(states[:, 0])
    found = lyapunov_exponent(states[:, 0], cycle_rate, lag=1)
    # Just beyond a cascade of period doublings the bands are so narrow that K is small.
    grows = found.exponent > AGREE * found.uncertainty
    words = CHAOS if k > CHAOTIC or grows else TORUS if k < REGULAR else UNDECIDED
    return Regime(words, 0, math.nan, k, found)


def _from_exponent(
    states: np.ndarray, tolerance: float, exponent: float, standard_error: float
) -> Regime:
    from gear_dynamics.dynamics.zero_one import zero_one_test

    limit = max(GROWS, AGREE * standard_error)
    last = states[-4 * LONGEST_STUDIED :]
    period, distance = recurrence_period(last, tolerance, LONGEST_STUDIED)
    if period and exponent <= limit:
        return Regime(f'{PERIOD}{period}', period, distance, math.nan, None)
    k = zero_one_test(states[:, 0]) if len(states) >= ENOUGH else math.nan
    words = UNDECIDED
    # A comparison with NaN is false: without the test the exponent decides alone.
    if exponent > limit and not k < REGULAR:
        words = CHAOS
    elif k < REGULAR and abs(exponent) <= limit:
        words = TORUS
    return Regime(words, 0, math.nan, k, None)
