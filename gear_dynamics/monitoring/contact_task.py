"""Online state of contact of a mesh, from exact events or else from samples."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from gear_dynamics.monitoring.contact_state import ContactState, EventContact, SampledContact
from gear_dynamics.monitoring.task import Batch, Indicator, Row, Task, TaskResult

EXACT = 'exact, from events'
SAMPLED = 'from samples: losses shorter than a sample step are missed'


class ContactTask(Task):
    """State of contact over consecutive spans.

    Parameters
    ----------
    subject : str
        `contact`, or that of one mesh of several.
    mesh : str
        Name of the mesh.
    column : int
        Of the displacement in a batch.
    half_backlash : float
        [m]
    length : int
        Samples in a span, at least.
    rate : float
        [Hz]
    """

    name = 'contact'
    indicators = (
        Indicator('out_of_contact', '', 'fraction of time without contact of the teeth'),
        Indicator('contact_losses_per_second', '1/s', 'losses of contact of the drive flanks'),
        Indicator('back_impacts_per_second', '1/s', 'impacts on the back flanks'),
    )

    def __init__(
        self,
        subject: str,
        mesh: str,
        column: int,
        half_backlash: float,
        length: int,
        rate: float,
    ) -> None:
        self._subject = subject
        self.mesh = mesh
        self._column = column
        self._rate = rate
        self._length = length
        self._sampled = SampledContact(half_backlash)
        self._exact = EventContact(half_backlash)
        self._samples = 0
        self._events: list[np.ndarray] = []
        self._start = 0.0
        self._end = 0.0
        self.seconds = length / rate

    def use(self, half_backlash: float) -> None:
        """Take over another backlash [m] from here on."""
        self._sampled.half_backlash = self._exact.half_backlash = half_backlash

    def push(self, batch: Batch) -> Iterator[TaskResult]:
        """Take the next samples; yield what is complete."""
        self._sampled.add(batch.values[:, self._column])
        self._samples += len(batch.values)
        if self._samples >= self._length:
            end = batch.first + len(batch.values)
            state = self._sampled.take()
            yield self._finding(state, end - self._samples, self._samples, SAMPLED)
            self._samples = 0

    def push_events(self, events: np.ndarray, start: float, end: float) -> Iterator[TaskResult]:
        """Take all events from `start` to `end`, with t [s] from the start of the record."""
        # From now on events tell; what the samples told so far is dropped.
        self._sampled.take()
        self._samples = 0
        if not self._events or abs(start - self._end) > 0.5 / self._rate:
            self._events, self._start = [], start
        self._events.append(events)
        self._end = end
        if (end - self._start) * self._rate >= self._length - 0.5:
            state = self._exact.take(np.concatenate(self._events), self._start, end)
            first, count = self._start * self._rate, (end - self._start) * self._rate
            yield self._finding(state, first, count, EXACT)
            self._events = []

    def _finding(self, state: ContactState, first: float, count: float, source: str) -> TaskResult:
        seconds = count / self._rate
        values = {
            'out_of_contact': state.out_of_contact,
            'contact_losses_per_second': state.losses / seconds,
            'back_impacts_per_second': state.back_impacts / seconds,
        }
        notes = {'state': state.text, 'contact': source}
        return TaskResult(first, count, [Row(self._subject, values, notes, state.text)])
