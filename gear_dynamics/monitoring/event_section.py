"""Batches of the events of successive blocks."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from gear_dynamics.machine.columns import EVENTS
from gear_dynamics.monitoring.gaps import Order, StampCheck
from gear_dynamics.monitoring.results import StreamSpan

BATCH = 0.02
"""Seconds of events that are processed at once."""


class EventBatch(NamedTuple):
    """Events of blocks that follow each other: span, and rows with t [s] from its start."""

    span: StreamSpan
    events: np.ndarray

    @property
    def end_ns(self) -> int:
        """Stamp of the end [ns]."""
        return self.span.start_ns + round(self.span.duration * 1e9)


class EventBatches:
    """Joins the events of successive blocks; no batch reaches across a gap.

    Parameters
    ----------
    block_size : int
        Samples in a block.
    rate : float
        [Hz]
    """

    def __init__(self, block_size: int, rate: float) -> None:
        self._block = block_size
        self._check = StampCheck(rate)
        self._seconds = block_size / rate
        self._start_ns = 0
        self._rows: list[np.ndarray] = []

    def push(self, stamp_ns: int, rows: np.ndarray) -> tuple[Order, list[EventBatch]]:
        """Take the events of a block, dtype EVENTS; return its order and the complete batches.

        The events of a block that goes back are not taken.
        """
        order = self._check.check(stamp_ns, self._block)
        if order is Order.BACK:
            return order, []
        batches = [] if order is Order.NEXT else self._take()
        if not self._rows:
            self._start_ns = stamp_ns
        moved = rows.astype(EVENTS)
        moved['t'] += (stamp_ns - self._start_ns) / 1e9
        self._rows.append(moved)
        if len(self._rows) * self._seconds >= BATCH:
            batches += self._take()
        return order, batches

    def _take(self) -> list[EventBatch]:
        if not self._rows:
            return []
        span = StreamSpan(self._start_ns, len(self._rows) * self._seconds)
        batch = EventBatch(span, np.concatenate(self._rows))
        self._rows = []
        return [batch]
