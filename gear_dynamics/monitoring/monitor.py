"""The online analysis of a rig without ROS: blocks and events in, results out.

The same engine serves a live stream and a log: fed the same messages in the same order, it
gives the same results.
"""

from __future__ import annotations

import collections
import dataclasses

import numpy as np

from gear_dynamics.machine.columns import CHANNELS, EVENTS, EventKind
from gear_dynamics.machine.configuration import Rig
from gear_dynamics.monitoring.blocks import BlockError, checked_columns
from gear_dynamics.monitoring.event_section import EventBatch, EventBatches
from gear_dynamics.monitoring.gaps import Order, StampCheck
from gear_dynamics.monitoring.poincare import SECTION, poincare_points, section_from_events
from gear_dynamics.monitoring.record import EXACT, Record
from gear_dynamics.monitoring.results import Result, TableResult
from gear_dynamics.monitoring.thresholds import Thresholds
from gear_dynamics.parameters.settings import AnalyzerSettings
from gear_dynamics.signal.interpolation import HALF_WIDTH, interpolate

PATIENCE = 1.0
"""Seconds of samples without an event message after which the section is interpolated."""

AHEAD = 500
"""Batches of events that may wait for their samples; of more the oldest is forgotten."""


@dataclasses.dataclass
class Health:
    """Counters of what came in.

    Attributes
    ----------
    configured : bool
        Whether the rig is known.
    blocks : int
        Blocks analysed.
    waiting : int
        Blocks that came before the configuration.
    gaps, missing : int
        Gaps between blocks, and samples missing in them.
    restarts : Counter
        Times that the analysis, or a part of it, began anew, by reason.
    dropped : Counter
        Messages that were not used, by kind of fault.
    last_fault : str
        The latest reason for which a message was dropped.
    """

    configured: bool = False
    blocks: int = 0
    waiting: int = 0
    gaps: int = 0
    missing: int = 0
    restarts: collections.Counter[str] = dataclasses.field(default_factory=collections.Counter)
    dropped: collections.Counter[str] = dataclasses.field(default_factory=collections.Counter)
    last_fault: str = ''

    def drop(self, kind: str, reason: str) -> None:
        """Count a message that is not used."""
        self.dropped[kind] += 1
        self.last_fault = reason


class Monitor:
    """Analyses the stream of one rig.

    Parameters
    ----------
    settings : AnalyzerSettings
    thresholds : Thresholds
        Their levels live as long as the monitor, across gaps.
    """

    def __init__(self, settings: AnalyzerSettings, thresholds: Thresholds) -> None:
        self._settings = settings
        self._thresholds = thresholds
        self._rig: Rig | None = None
        self._record: Record | None = None
        self._check: StampCheck | None = None
        self._since_events = 0.0
        self._events: EventBatches | None = None
        self._ahead: collections.deque[EventBatch] = collections.deque(maxlen=AHEAD)
        self.health = Health()

    def configure(self, rig: Rig) -> None:
        """Learn of the rig; a change of what the record rests on begins a new one."""
        old, self._rig = self._rig, rig
        self.health.configured = True
        if old is None or old.sample_rate != rig.sample_rate:
            self._check = StampCheck(rig.sample_rate)
        if old is not None and _basis(old) == _basis(rig):
            if self._record is not None:
                self._record.use(rig)
            return
        self._events = EventBatches(rig)
        self._ahead.clear()
        if self._record is not None:
            self._record = None
            self.health.restarts['change of the rig'] += 1

    def add_block(self, stamp_ns: int, rows: np.ndarray) -> list[Result]:
        """Take a block of samples; return the results that it completes.

        A block that cannot be used is dropped and counted; a gap begins a new record.

        Parameters
        ----------
        stamp_ns : int
            Header stamp [ns].
        rows : ndarray
            Structured, with the columns of `samples`.
        """
        if self._rig is None or self._check is None:
            self.health.waiting += 1
            return []
        try:
            values = checked_columns(rows, self._rig.sample_rate)
        except BlockError as error:
            self.health.drop(error.kind, str(error))
            return []
        order = self._check.check(stamp_ns, len(values))
        if order is Order.BACK:
            self.health.drop('back', f'stamp {stamp_ns} ns goes back')
            return []
        results: list[Result] = []
        if order is not Order.NEXT or self._record is None:
            results = self._record.flush() if self._record is not None else []
            self._begin(order, stamp_ns)
        assert self._record is not None
        self.health.blocks += 1
        self._since_events += len(values) / self._rig.sample_rate
        results += self._record.add_block(values, self._since_events > PATIENCE)
        return results + self._section_of_record()

    def add_events(self, stamp_ns: int, rows: np.ndarray) -> list[Result]:
        """Take the events of a block; return the results that they complete."""
        if self._rig is None or self._events is None:
            return []
        missing = [name for name in EVENTS.names or () if name not in (rows.dtype.names or ())]
        if missing:
            self.health.drop('events', f'the events have no column {", ".join(missing)}')
            return []
        if not all(np.isfinite(rows[name]).all() for name in SECTION.names or ()):
            self.health.drop('events', 'the events have a value that is not finite')
            return []
        order, batches = self._events.push(stamp_ns, rows[list(EVENTS.names or ())])
        if order is Order.BACK:
            self.health.drop('events', f'stamp {stamp_ns} ns of events goes back')
            return []
        self._since_events = 0.0
        if order is Order.GAP:
            self.health.restarts['gap in the events'] += 1
        if order is Order.RESTART:
            self._ahead.clear()
        self._ahead.extend(batches)
        results = [each for batch in batches for each in self._points(batch, self._rig)]
        return results + self._section_of_record()

    def _points(self, batch: EventBatch, rig: Rig) -> list[Result]:
        kind = EventKind.SECTION if self._settings.section == 'phase' else EventKind.DRIVE_LOST
        points = section_from_events(batch.events, kind)
        if not len(points):
            return []
        table = poincare_points(points, rig.half_backlash, rig.wn)
        return [TableResult('poincare', batch.span, table)]

    def _section_of_record(self) -> list[Result]:
        """Judge the events whose samples the record holds; those of another are passed over."""
        results: list[Result] = []
        record = self._record
        while record is not None and self._ahead and self._ahead[0].end_ns <= record.end_ns:
            batch = self._ahead.popleft()
            section = section_from_events(batch.events)
            if batch.span.start_ns >= record.start_ns and len(section):
                section['t'] += (batch.span.start_ns - record.start_ns) / 1e9
                results += record.add_section(section, EXACT)
        return results

    def _begin(self, order: Order, stamp_ns: int) -> None:
        assert self._rig is not None
        assert self._check is not None
        if order in (Order.GAP, Order.RESTART):
            self.health.restarts[order.value] += 1
        if order is Order.GAP:
            self.health.gaps += 1
            self.health.missing += self._check.missing
        self._record = Record(
            self._settings, self._rig, self._thresholds, stamp_ns, self.health.restarts
        )


def _basis(rig: Rig) -> Rig:
    """Return the rig with what may change in the midst of a record made equal."""
    return dataclasses.replace(rig, wn=1.0, half_backlash=1.0)


def warm_up() -> None:
    """Compile or load what the first block would otherwise have to wait for."""
    interpolate(np.zeros((2 * HALF_WIDTH + 1, len(CHANNELS) + 1)), np.array([HALF_WIDTH - 0.5]))
