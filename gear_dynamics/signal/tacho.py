"""Pulses of a tachometer: their instants, missing and spurious ones, and the angle they give."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from gear_dynamics.signal.arguments import real_series


def trigger_level(x: npt.ArrayLike) -> float:
    """Return the value half-way between the lowest and the highest of a pulse signal."""
    x = real_series(x)
    return float((np.min(x) + np.max(x)) / 2)


def rising_edges(x: npt.ArrayLike, level: float, hysteresis: float) -> np.ndarray:
    """Return where a signal rises through a level, in samples, interpolated linearly.

    A Schmitt trigger: after an edge the signal must fall below `level` - `hysteresis` before the
    next one counts, so that noise at the level makes no second edge.

    Parameters
    ----------
    x : array_like, shape (n,)
    level, hysteresis : float
        In the unit of x.

    Returns
    -------
    ndarray
        Rising, from 0 to n - 1.
    """
    x = real_series(x)
    state = np.zeros(len(x), np.int8)
    state[x >= level] = 1
    state[x < level - hysteresis] = -1
    # Between the two thresholds the trigger keeps its state.
    places = np.where(state != 0, np.arange(len(x)), 0)
    state = state[np.maximum.accumulate(places)]
    edges = np.flatnonzero((state[1:] == 1) & (state[:-1] == -1)) + 1
    # The state turns at the first sample at or above the level.
    before = x[edges - 1]
    return edges - 1 + (level - before) / np.where(x[edges] > before, x[edges] - before, 1.0)


class Pulses(NamedTuple):
    """Instants of pulses after repair.

    Attributes
    ----------
    instants : ndarray
        Rising, in the unit given.
    numbers : ndarray of int
        Which pulse each is: it rises by more than 1 over missing ones.
    missing, spurious : int
        Pulses that were bridged, and that were left out.
    """

    instants: np.ndarray
    numbers: np.ndarray
    missing: int
    spurious: int


TOLERANCE = 0.3
"""Relative difference of an interval from its neighbours that is a change of speed."""


def repair_pulses(instants: npt.ArrayLike) -> Pulses:
    """Return pulses without spurious ones, numbered over missing ones.

    An interval is compared with the median of those around it. Of a pulse too many the one that
    splits an interval least evenly with its surroundings is left out.

    Parameters
    ----------
    instants : array_like, shape (n,)
        Rising; there may be none.

    Raises
    ------
    ValueError
        If a value is not finite.
    """
    if np.size(instants):
        instants = real_series(instants, 'instants')
    instants = np.asarray(instants, dtype=float)
    expected = _expected_intervals(instants)
    if np.all(np.abs(np.diff(instants) - expected[1:]) <= TOLERANCE * expected[1:]):
        return Pulses(instants, np.arange(len(instants)), 0, 0)
    kept = [0]
    spurious = 0
    for index in range(1, len(instants)):
        interval = instants[index] - instants[kept[-1]]
        if interval < (1 - TOLERANCE) * expected[index]:
            # Too early: it is one too many, unless the one before was.
            spurious += 1
            if len(kept) >= 2 and _fits_better(instants, kept, index, expected[index]):
                kept[-1] = index
            continue
        kept.append(index)
    good = instants[kept]
    steps = np.ones(max(len(good) - 1, 0), dtype=int)
    if len(good) > 2:
        wanted = _expected_intervals(good)[1:]
        steps = np.maximum(np.round(np.diff(good) / wanted).astype(int), 1)
    numbers = np.concatenate([[0], np.cumsum(steps)])[: len(good)]
    return Pulses(good, numbers, int((steps - 1).sum()), spurious)


def _fits_better(instants: np.ndarray, kept: list[int], index: int, expected: float) -> bool:
    before = instants[kept[-2]]
    return abs(instants[index] - before - expected) < abs(instants[kept[-1]] - before - expected)


def _expected_intervals(instants: np.ndarray, around: int = 7) -> np.ndarray:
    """Return for each instant the median of the intervals around it."""
    intervals = np.diff(instants, prepend=instants[0] if len(instants) else 0.0)
    if len(instants) < 3:
        return intervals
    intervals[0] = intervals[1]
    half = around // 2
    padded = np.pad(intervals, half, mode='reflect' if len(intervals) > half else 'edge')
    return np.median(np.lib.stride_tricks.sliding_window_view(padded, around), axis=1)


FEWEST_REVOLUTIONS = 8
"""Revolutions by which the places of a wheel's pulses are learned."""


def even_pulses(instants: npt.ArrayLike, numbers: npt.ArrayLike, pulses: int) -> np.ndarray:
    """Return the revolutions at pulses of a wheel whose marks are not evenly spaced.

    The mean place of each mark follows from where it falls between two passages of the first one
    (order tracking by a calibrated zebra tape: Resor, Trethewey and Maynard 2005).

    Parameters
    ----------
    instants : array_like, shape (n,)
        Rising.
    numbers : array_like of int, shape (n,)
        Which pulse each is.
    pulses : int
        Marks on the wheel.
    """
    instants, numbers = (
        real_series(instants, 'instants').astype(float, copy=False),
        np.asarray(numbers),
    )
    mark, turn = numbers % pulses, numbers // pulses
    first = mark == 0
    if pulses < 2 or np.count_nonzero(first) < FEWEST_REVOLUTIONS:
        return numbers / pulses
    base = np.interp(instants, instants[first], turn[first].astype(float))
    inside = (instants >= instants[first][0]) & (instants <= instants[first][-1])
    offsets = base - turn
    places = np.arange(pulses) / pulses
    for each in range(1, pulses):
        seen = inside & (mark == each)
        if np.any(seen):
            places[each] = np.mean(offsets[seen])
    revolutions = turn + places[mark]
    return revolutions if np.all(np.diff(revolutions) > 0) else numbers / pulses
