"""The online analysis of a machine without ROS: blocks and events in, results out.

The same engine serves a live stream and a log: fed the same messages in the same order, it
gives the same results.
"""

from __future__ import annotations

import collections
import math

import numpy as np

from gear_dynamics.machine.configuration import Rig
from gear_dynamics.monitoring.baseline import Baseline, BaselineError, machine_text
from gear_dynamics.monitoring.blocks import BlockError, checked_columns, checked_events
from gear_dynamics.monitoring.catalogue import Catalogue
from gear_dynamics.monitoring.event_section import EventBatch, EventBatches
from gear_dynamics.monitoring.gaps import Order, StampCheck
from gear_dynamics.monitoring.health import Health
from gear_dynamics.monitoring.judge import Judge
from gear_dynamics.monitoring.layout import Layout
from gear_dynamics.monitoring.motion_task import event_points
from gear_dynamics.monitoring.operating import OperatingState
from gear_dynamics.monitoring.record import Record
from gear_dynamics.monitoring.results import Result, TableResult
from gear_dynamics.monitoring.thresholds import Change, Thresholds
from gear_dynamics.monitoring.wheel_average import Harmonics
from gear_dynamics.parameters.settings import AnalyzerSettings
from gear_dynamics.signal.interpolation import HALF_WIDTH, interpolate_rows

PATIENCE = 1.0
"""Seconds of samples without an event message after which the section is interpolated."""

AHEAD = 500
"""Batches of events that may wait for their samples; of more the oldest is forgotten."""

SAVE_EVERY = 10.0
"""Seconds of stream from one writing of a changed baseline to the next."""

LOOK_EVERY = 1.0
"""Seconds of stream from one count of the operating bins to the next."""

STARVES = 2.0
"""Spans of a task without a result, beyond the settling time, after which it starves."""


class Monitor:
    """Analyses the stream of one machine.

    Parameters
    ----------
    settings : AnalyzerSettings
    thresholds : Thresholds
        Their levels live as long as the monitor, across gaps.
    """

    def __init__(self, settings: AnalyzerSettings, thresholds: Thresholds) -> None:
        self._settings = settings
        self._layout: Layout | None = None
        self._record: Record | None = None
        self._check: StampCheck | None = None
        self._since_events = 0.0
        self._events: EventBatches | None = None
        self._ahead: collections.deque[EventBatch] = collections.deque(maxlen=AHEAD)
        self._operating = OperatingState(settings)
        self._judge = Judge(thresholds, Baseline(settings.learn_spans))
        self._harmonics: dict[str, Harmonics] = {}
        self._fed: dict[str, float] = {}
        self._saved = 0.0
        self._looked = -math.inf
        self.health = Health()

    def configure(self, machine: Rig | Layout) -> None:
        """Take the machine; a change beyond scales of the motion begins a new record.

        Raises
        ------
        ValueError
            If the machine is impossible; the monitor goes on with the one it knows.
        """
        layout = machine if isinstance(machine, Layout) else Layout.of_rig(machine)
        old, self._layout = self._layout, layout
        self.health.configured = True
        if old is None or old.sample_rate != layout.sample_rate:
            self._check = StampCheck(layout.sample_rate)
        self._use_baseline(layout)
        if old is not None and old.same_record(layout):
            if self._record is not None:
                self._record.use(layout)
            return
        self._events = EventBatches(layout.block_size, layout.sample_rate)
        self._ahead.clear()
        if self._record is not None:
            self._record = None
            self.health.restarts['change of the rig'] += 1

    def begin_again(self, reason: str) -> list[Result]:
        """End the record since the stamps of the stream begin anew; return its last results.

        No block is dropped for a stamp that goes back then.
        """
        if self._layout is None:
            return []
        self._check = StampCheck(self._layout.sample_rate)
        self._events = EventBatches(self._layout.block_size, self._layout.sample_rate)
        self._ahead.clear()
        record, self._record = self._record, None
        if record is None:
            return []
        self.health.restarts[reason] += 1
        return record.flush()

    def _use_baseline(self, layout: Layout) -> None:
        machine = machine_text(layout.machine, layout.sample_rate)
        if self._judge.baseline.machine == machine:
            return
        self.save()
        baseline = Baseline(self._settings.learn_spans, machine)
        self.health.baseline = ''
        if self._settings.baseline:
            try:
                baseline.load(self._settings.baseline)
            except BaselineError as error:
                self.health.baseline = str(error)
        self._judge.baseline = baseline
        self._judge.forget()
        self._harmonics.clear()

    def learn(self) -> None:
        """Begin to learn what is normal anew, in all operating bins."""
        self._judge.baseline.forget()
        self._judge.forget()
        self._harmonics.clear()

    def acknowledge(self) -> None:
        """Take all alarm levels back to OK, and forget when faults were first seen."""
        self._judge.thresholds.acknowledge()
        self._judge.forget()

    def take_changes(self) -> list[Change]:
        """Return the changes of alarm levels since the last call, each once."""
        return self._judge.thresholds.take_changes()

    def save(self) -> None:
        """Write what was learned to the baseline's file, if there is one and it is ours."""
        baseline = self._judge.baseline
        self.health.bins = baseline.bins
        if self._settings.baseline and baseline.unsaved and not self.health.baseline:
            try:
                baseline.save(self._settings.baseline)
            except OSError as error:
                self.health.baseline = f'{self._settings.baseline}: {error.strerror}'

    def add_block(self, stamp_ns: int, rows: np.ndarray) -> list[Result]:
        """Take a block of samples; return the results that it completes.

        A block that cannot be used is dropped and counted; a gap begins a new record.

        Parameters
        ----------
        stamp_ns : int
            Header stamp [ns].
        rows : ndarray
            Structured, with the columns of the machine's channels, angles and load.
        """
        if self._layout is None or self._check is None:
            self.health.waiting += 1
            return []
        try:
            values = checked_columns(rows, self._layout)
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
        self._since_events += len(values) / self._layout.sample_rate
        results += self._record.add_block(values, self._since_events > PATIENCE)
        results += self._events_of_record()
        self._look_after(self._record, results)
        return results

    def add_events(self, stamp_ns: int, rows: np.ndarray) -> list[Result]:
        """Take the events of a block; return the results that they complete."""
        if self._layout is None or self._events is None:
            return []
        try:
            events = checked_events(rows)
        except BlockError as error:
            self.health.drop('events', f'events: {error}')
            return []
        order, batches = self._events.push(stamp_ns, events)
        if order is Order.BACK:
            self.health.drop('events', f'stamp {stamp_ns} ns of events goes back')
            return []
        self._since_events = 0.0
        if order is Order.GAP:
            self.health.restarts['gap in the events'] += 1
        if order is Order.RESTART:
            self._ahead.clear()
        self._ahead.extend(batches)
        results = [each for batch in batches for each in self._points(batch, self._layout)]
        results += self._events_of_record()
        if self._record is not None:
            self._look_after(self._record, results)
        return results

    def _points(self, batch: EventBatch, layout: Layout) -> list[Result]:
        meshes = [mesh.mesh for mesh in layout.meshes if mesh.has_motion]
        tables = [event_points(batch, self._settings.section, mesh) for mesh in meshes[:1]]
        return [TableResult('poincare', batch.span, table) for table in tables if len(table)]

    def _events_of_record(self) -> list[Result]:
        """Pass on the events whose samples the record holds; those of another are skipped."""
        results: list[Result] = []
        record = self._record
        while record is not None and self._ahead and self._ahead[0].end_ns <= record.end_ns:
            batch = self._ahead.popleft()
            if batch.span.start_ns >= record.start_ns:
                results += record.add_events(batch)
        return results

    def _begin(self, order: Order, stamp_ns: int) -> None:
        assert self._layout is not None
        assert self._check is not None
        if order in (Order.GAP, Order.RESTART):
            self.health.restarts[order.value] += 1
        if order is Order.GAP:
            self.health.gaps += 1
            self.health.missing += self._check.missing
        else:
            self._operating.restart()
        tasks = Catalogue(
            self._settings,
            self._layout,
            self.health.restarts,
            self._harmonics,
            self._judge.normal,
        )
        self._record = Record(
            self._layout, tasks.factories(), self._judge, self._operating, self.health, stamp_ns
        )

    def _look_after(self, record: Record, results: list[Result]) -> None:
        """Keep the counters of what was learned and of what starves; save the baseline."""
        health = self.health
        now = health.seconds
        for slot in record.slots:
            if slot.fed:
                self._fed[slot.name] = now
                slot.fed = False
            waited = now - self._fed.setdefault(slot.name, now)
            wanted = STARVES * slot.task.seconds + self._settings.settling_time
            if slot.task.seconds and waited > wanted:
                health.starving[slot.name] = health.restarts.last or 'its span was never complete'
            else:
                health.starving.pop(slot.name, None)
        if self._judge.baseline.changed and now - self._looked > LOOK_EVERY:
            self._looked = now
            self._judge.baseline.changed = False
            health.bins = self._judge.baseline.bins
        if now - self._saved > SAVE_EVERY:
            self._saved = now
            self.save()


def warm_up() -> None:
    """Compile or load what the first block would otherwise have to wait for."""
    interpolate_rows(np.zeros((2 * HALF_WIDTH + 1, 2)), np.array([HALF_WIDTH - 0.5]))
