"""Checks that the blocks of a stream follow each other without a gap."""

from __future__ import annotations

import enum

SAME_TIME = 0.25
"""Fraction of a sample by which a stamp may miss its place; stamps are whole nanoseconds."""


class Order(enum.Enum):
    """How a block follows the one before."""

    FIRST = 'first block'
    NEXT = 'next block'
    GAP = 'gap'
    BACK = 'stamp goes back'
    RESTART = 'stream starts anew'


class StampCheck:
    """Check whether each block is the next one, from stamps counted in samples.

    A block that goes back in time is not to be used. A stream that has gone back and then runs
    on in order for `patience` seconds is taken to be a new one: a log that is played again.

    Parameters
    ----------
    rate : float
        Samples per second [Hz].
    patience : float
        [s]
    """

    def __init__(self, rate: float, patience: float = 1.0) -> None:
        self.rate = rate
        self._patience_ns = patience * 1e9
        self._due_ns: int | None = None
        self._behind_due_ns: int | None = None
        self._behind_ns = 0.0
        self.missing = 0

    def check(self, stamp_ns: int, width: int) -> Order:
        """Take the next block's stamp [ns] and number of samples; return its order.

        After a GAP, `missing` is the number of samples that are missing.
        """
        span_ns = width * 1e9 / self.rate
        tolerance_ns = SAME_TIME * 1e9 / self.rate
        end_ns = stamp_ns + round(span_ns)
        if self._due_ns is None:
            order = Order.FIRST
        elif abs(stamp_ns - self._due_ns) <= tolerance_ns:
            order = Order.NEXT
        elif stamp_ns > self._due_ns:
            order = Order.GAP
            self.missing = round((stamp_ns - self._due_ns) * self.rate / 1e9)
        elif self._runs_on(stamp_ns, span_ns, tolerance_ns):
            order = Order.RESTART
        else:
            return Order.BACK
        self._due_ns = end_ns
        self._behind_due_ns = None
        return order

    def _runs_on(self, stamp_ns: int, span_ns: float, tolerance_ns: float) -> bool:
        due_ns = self._behind_due_ns
        in_order = due_ns is not None and abs(stamp_ns - due_ns) <= tolerance_ns
        self._behind_ns = self._behind_ns + span_ns if in_order else span_ns
        self._behind_due_ns = stamp_ns + round(span_ns)
        return self._behind_ns > self._patience_ns
