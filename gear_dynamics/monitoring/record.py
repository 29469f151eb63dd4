"""A stretch of the stream without a gap, and all the tasks that run on it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator

import numpy as np

from gear_dynamics.monitoring.contact_task import ContactTask
from gear_dynamics.monitoring.event_section import EventBatch
from gear_dynamics.monitoring.health import Health
from gear_dynamics.monitoring.judge import Judge
from gear_dynamics.monitoring.layout import Layout
from gear_dynamics.monitoring.motion_task import EXACT, MotionTask
from gear_dynamics.monitoring.operating import BatchState, History, OperatingState
from gear_dynamics.monitoring.phase_stream import PhaseStream
from gear_dynamics.monitoring.poincare import section_from_events
from gear_dynamics.monitoring.results import Result, StreamSpan, TableResult
from gear_dynamics.monitoring.task import Batch, Task, TaskResult

BATCH = 0.02
"""Seconds of samples that are processed at once."""

Factory = Callable[[], Task]


class Slot:
    """A task, how to make it anew, and whether it gave a result since `fed` was last cleared."""

    def __init__(self, make: Factory) -> None:
        self._make = make
        self.task = make()
        self.name = self.task.name
        self.fed = False

    def renew(self) -> None:
        """Begin anew after a failure."""
        self.task = self._make()


class Record:
    """Everything computed on blocks that follow each other; another record begins at a gap.

    Parameters
    ----------
    layout : Layout
    factories : iterable of function
        Each makes a task.
    judge : Judge
    operating : OperatingState
    health : Health
    start_ns : int
        Stamp of the first sample [ns].
    """

    def __init__(
        self,
        layout: Layout,
        factories: Iterable[Factory],
        judge: Judge,
        operating: OperatingState,
        health: Health,
        start_ns: int,
    ) -> None:
        self.start_ns = start_ns
        self.layout = layout
        self._judge = judge
        self._operating = operating
        self._health = health
        self._rate = layout.sample_rate
        self._done = 0
        self._waiting: list[np.ndarray] = []
        self._interpolate = False
        self._history = History()
        self._steady: bool | None = None
        self._phases = {
            mesh.mesh.name: PhaseStream(mesh.tracks, mesh.weight) for mesh in layout.meshes
        }
        self.slots = [Slot(make) for make in factories]

    def use(self, layout: Layout) -> None:
        """Take over scales that changed while the rig runs."""
        self.layout = layout
        for slot in self.slots:
            task = slot.task
            for mesh in layout.meshes:
                if isinstance(task, MotionTask) and task.mesh.name == mesh.mesh.name:
                    task.use(mesh.mesh)
                if isinstance(task, ContactTask) and task.mesh == mesh.mesh.name:
                    task.use(mesh.mesh.half_backlash or math.nan)

    def add_block(self, values: np.ndarray, interpolate: bool) -> list[Result]:
        """Take the next block, as `checked_columns` returns it; return the complete results.

        Blocks are processed together, BATCH seconds at a time: the fixed cost of a step is then
        paid less often.

        Parameters
        ----------
        values : ndarray, shape (n, columns)
        interpolate : bool
            Whether section and contact must come from the samples, for want of events.
        """
        self._waiting.append(values)
        self._interpolate = interpolate
        if sum(map(len, self._waiting)) < BATCH * self._rate:
            return []
        return self.flush()

    def flush(self) -> list[Result]:
        """Process the blocks that wait; return the complete results."""
        if not self._waiting:
            return []
        values = np.concatenate(self._waiting)
        self._waiting = []
        size = max(1, math.ceil(2 * BATCH * self._rate))
        return [
            result
            for first in range(0, len(values), size)
            for result in self._process(values[first : first + size])
        ]

    def _process(self, values: np.ndarray) -> Iterator[Result]:
        layout = self.layout
        first, self._done = self._done, self._done + len(values)
        phases, leads = {}, {}
        for mesh in layout.meshes:
            stream = self._phases[mesh.mesh.name]
            angles = values[:, [layout.index(track.column) for track in mesh.tracks]]
            phases[mesh.mesh.name] = stream.push(angles)
            leads[mesh.mesh.name] = stream.lead
        state = self._state(values, phases)
        self._history.add(first, self._done, state)
        channels = values[:, [layout.index(name) for name in layout.channel_columns]]
        if not np.all(layout.scales == 1):
            channels = channels * layout.scales
        batch = Batch(first, values, channels, phases, leads, state.bin)
        settled = self._steady is False and not state.reason
        self._steady = not state.reason
        for slot in self.slots:
            if settled:
                slot.task.restart()
            yield from self._results(slot, lambda task: self._pushed(task, batch))

    def _pushed(self, task: Task, batch: Batch) -> Iterable[TaskResult]:
        if isinstance(task, MotionTask):
            task.observe(batch)
        if isinstance(task, MotionTask | ContactTask) and not self._interpolate:
            return ()
        return task.push(batch)

    def _state(self, values: np.ndarray, phases: dict[str, np.ndarray]) -> BatchState:
        layout, seconds = self.layout, len(values) / self._rate
        speed = load = math.nan
        if layout.meshes and len(values) > 1:
            mesh = layout.meshes[0]
            phase = phases[mesh.mesh.name]
            cycles = (phase[-1] - phase[0]) / (len(phase) - 1) * self._rate
            speed = float(cycles) * 2 * math.pi / mesh.teeth[0]
        if layout.load is not None:
            load = float(values[:, layout.index(layout.load)].mean())
        state = self._operating.push(speed, load, seconds)
        self._health.seconds += seconds
        self._health.steady_seconds += 0 if state.reason else seconds
        return state

    def add_events(self, batch: EventBatch) -> list[Result]:
        """Take events whose samples have been processed; return the complete results."""
        start = (batch.span.start_ns - self.start_ns) / 1e9
        events = batch.events.copy()
        events['t'] += start
        section = section_from_events(events)
        end = start + batch.span.duration

        def found(task: Task) -> Iterable[TaskResult]:
            if isinstance(task, MotionTask) and len(section):
                return task.push_section(section, EXACT)
            if isinstance(task, ContactTask):
                return task.push_events(events, start, end)
            return ()

        return [result for slot in self.slots for result in self._results(slot, found)]

    @property
    def end_ns(self) -> int:
        """Stamp of the first sample that is not yet processed [ns]."""
        return self.start_ns + round(self._done * 1e9 / self._rate)

    def _results(self, slot: Slot, work: Callable[[Task], Iterable[TaskResult]]) -> list[Result]:
        """Return the results of a task; one that fails begins its span anew."""
        results: list[Result] = []
        try:
            for finding in work(slot.task):
                slot.fed = True
                results += self._of_finding(slot, finding)
        except Exception as error:
            # Whatever one task stumbles on, the others go on, and so does the log.
            self._health.fail(slot.name, error)
            slot.renew()
        return results

    def _of_finding(self, slot: Slot, finding: TaskResult) -> Iterator[Result]:
        span = StreamSpan(
            self.start_ns + round(finding.first * 1e9 / self._rate), finding.count / self._rate
        )
        for name, rows in finding.tables.items():
            yield TableResult(name, span, rows)
        if finding.rows:
            judgement = self._history.judge(finding.first, finding.count)
            self._health.judge(judgement.reason)
            yield self._judge.result(span, tuple(finding.rows), judgement)
