"""Standard deviations of the deflection and its rate over a stretch of a stream."""

from __future__ import annotations

import bisect
import math

import numpy as np

MOST = 65536
"""Batches that are kept; of a longer stretch the last ones count."""


class Spread:
    """Sums over the batches of a stream, kept until the stretch they belong to is judged.

    Parameters
    ----------
    rate : float
        [Hz]
    """

    def __init__(self, rate: float) -> None:
        self._rate = rate
        self._done = 0
        self._ends: list[float] = []
        self._sums: list[np.ndarray] = []

    def add(self, delta: np.ndarray, delta_dot: np.ndarray) -> None:
        """Take the next samples of delta [m] and delta_dot [m/s]."""
        self._done += len(delta)
        self._ends.append(self._done / self._rate)
        # The mean of delta is taken out; that of delta_dot is zero in any steady motion.
        self._sums.append(np.array([len(delta), delta.sum(), delta @ delta, delta_dot @ delta_dot]))

        if len(self._ends) > MOST:
            del self._ends[0], self._sums[0]

    def over(self, start: float, end: float) -> tuple[float, float]:
        """Return both standard deviations over the batches from start to end [s]."""
        first = bisect.bisect_right(self._ends, start)
        last = bisect.bisect_left(self._ends, end) + 1
        if first >= min(last, len(self._sums)):
            return 0.0, 0.0
        count, total, square, rate_square = np.sum(self._sums[first:last], axis=0).tolist()
        variance = max(square / count - (total / count) ** 2, 0.0)
        return math.sqrt(variance), math.sqrt(rate_square / count)

    def forget(self, before: float) -> None:
        """Forget the batches that end before a time [s]."""
        first = bisect.bisect_right(self._ends, before)
        del self._ends[:first], self._sums[:first]
