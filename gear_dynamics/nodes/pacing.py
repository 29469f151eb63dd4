"""When blocks are due and what stamps they carry; no ROS, so that it is tested with any clock."""

from __future__ import annotations

from fractions import Fraction

SECOND = 1_000_000_000
"""Nanoseconds in a second."""

CATCH_UP = SECOND // 4
"""Time that a stream may be behind its schedule and still catch up [ns]; what is behind for
longer stays behind, so that listeners are not flooded."""


class StampCounter:
    """Stamps counted in whole samples, so that any gap shows; the clock is read when it is set.

    Parameters
    ----------
    sample_rate : float
        Samples per second of model time [Hz].
    """

    def __init__(self, sample_rate: float) -> None:
        self._period = SECOND / Fraction(sample_rate)
        self._origin = 0
        self._first = 0
        self._last = 0

    def set(self, sample: int, clock_ns: int) -> None:
        """Give `sample` the time `clock_ns`, or the last stamp given out if that is later."""
        self._origin = max(clock_ns, self._last)
        self._first = sample

    def stamp(self, sample: int) -> int:
        """Return the stamp of a sample [ns]."""
        stamp = self._origin + round((sample - self._first) * self._period)
        self._last = max(self._last, stamp)
        return stamp


class Schedule:
    """When blocks are due by a steady clock, and how far behind they are.

    Parameters
    ----------
    interval_ns : float
        Wall-clock time between blocks [ns]; 0 means that one is always due.
    """

    def __init__(self, interval_ns: float) -> None:
        self.interval_ns = interval_ns
        self.overruns = 0
        """Blocks that were late by more than their interval."""
        self._next = 0.0
        self._given_up = 0.0

    def start(self, now_ns: int) -> None:
        """Begin anew: the first block is due one interval from now, when its samples are past."""
        self._next = now_ns + self.interval_ns
        self._given_up = 0.0

    def due(self, now_ns: int) -> bool:
        """Tell whether a block is due.

        Half an interval early is in time: a timer of that interval keeps its phase, and a block
        that just missed its tick would wait for a whole one.
        """
        return now_ns >= self._next - self.interval_ns / 2

    def done(self, now_ns: int) -> None:
        """Note that a block went out."""
        if self.interval_ns == 0:
            return
        late = now_ns - self._next
        self.overruns += late > self.interval_ns
        self._next += self.interval_ns
        if late > CATCH_UP:
            given_up = (late - CATCH_UP) // self.interval_ns * self.interval_ns
            self._given_up += given_up
            self._next += given_up

    def lag(self, now_ns: int) -> float:
        """Return how far the stream is behind since it began [s]; never negative."""
        if self.interval_ns == 0:
            return 0.0
        return max(0.0, now_ns - self._next + self._given_up) / SECOND
