"""The kind of motion: its period, or what it is if it has none."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from gear_dynamics.dynamics.regime import ENOUGH, REGULAR, recurrence_period
from gear_dynamics.dynamics.zero_one import zero_one_test

LONGEST_PERIOD = 32
"""Longest period looked for, in mesh cycles."""

RECURS = 1e-3
"""Distance of states, over half the backlash, within which they count as the same."""

GROWS = 1e-3
"""Largest exponent per tau above which a motion without a period is chaotic, if it is AGREE
standard errors from zero too."""

AGREE = 3.0

PERIOD, CHAOS, TORUS, UNDECIDED = 'period-', 'chaotic', 'quasi-periodic', 'undecided'


class Kind(NamedTuple):
    """The kind of a motion.

    Attributes
    ----------
    words : str
        `period-3`, `chaotic`, `quasi-periodic` or `undecided`.
    period : int
        In mesh cycles; 0 if there is none up to LONGEST_PERIOD.
    zero_one : float
        K of the 0-1 test; NaN if periodic or if there are fewer than ENOUGH points.
    """

    words: str
    period: int
    zero_one: float


def kind_of(states: np.ndarray, exponent: float, standard_error: float) -> Kind:
    """Return the kind of a motion by its section and its largest exponent.

    Parameters
    ----------
    states : (cycles, 2) array
        delta / b and delta_dot / (b wn) on successive sections; 64 or more.
    exponent, standard_error : float
        Largest exponent per tau.
    """
    grows = exponent > max(GROWS, AGREE * standard_error)
    period, _ = recurrence_period(states[-4 * LONGEST_PERIOD :], RECURS, LONGEST_PERIOD)
    if period and not grows:
        return Kind(f'{PERIOD}{period}', period, math.nan)
    k = zero_one_test(states[:, 0]) if len(states) >= ENOUGH else math.nan
    if grows and not k < REGULAR:
        return Kind(CHAOS, 0, k)
    if k < REGULAR and abs(exponent) <= max(GROWS, AGREE * standard_error):
        return Kind(TORUS, 0, k)
    return Kind(UNDECIDED, 0, k)


def kind_shares(kinds: np.ndarray) -> str:
    """Return in a line the shares of motions of each kind, the most frequent first."""
    words, counts = np.unique(kinds, return_counts=True)
    order = np.argsort(-counts, kind='stable')
    return ', '.join(f'{words[i]} {counts[i] / kinds.size:.1%}' for i in order)
