"""Online Poincaré section of a mesh and the regime of its motion."""

from __future__ import annotations

import collections
import math
from collections.abc import Iterator

import numpy as np

from gear_dynamics.machine.columns import EventKind
from gear_dynamics.machine.parts import Mesh
from gear_dynamics.monitoring.event_section import EventBatch
from gear_dynamics.monitoring.layout import Layout, MeshLayout
from gear_dynamics.monitoring.poincare import (
    poincare_points,
    section_by_contact_loss,
    section_by_phase,
    section_from_events,
)
from gear_dynamics.monitoring.section_record import SectionRecord, SectionVerdict
from gear_dynamics.monitoring.spread import Spread
from gear_dynamics.monitoring.task import Batch, Indicator, Row, Task, TaskResult
from gear_dynamics.parameters.settings import AnalyzerSettings

EXACT = 'exact, from events'
INTERPOLATED = (
    'interpolated between samples: delta to (w h)^4 / 384, delta_dot to (w h)^4 / 43 '
    'between changes of contact'
)
"""What the states of a section are; w is the angular frequency of the motion, h the step."""


INTERPOLATED_TOLERANCE = 0.05
"""Least tolerance of recurrence for interpolated states, in standard deviations of the samples:
between changes of contact their errors, which repeat with the sampling, are smaller."""

LYAPUNOV_SHARE = 1 / 1.5
"""Share of the exponent that a thousand states of the section give: a motion of so many dimensions
has no close neighbours. Found on 25 chaotic motions whose exponents are known from tangent vectors
(benchmarks/regime_validation.py)."""

LYAPUNOV_ERROR = 0.4
"""Systematic standard error of the exponent, as a fraction of it, found there too."""

OVERLAP = 3
"""Samples of a batch that are kept for the interpolation of the next."""


def event_points(batch: EventBatch, section: str, mesh: Mesh) -> np.ndarray:
    """Return the points of the table `poincare` of a batch of events."""
    kind = EventKind.SECTION if section == 'phase' else EventKind.DRIVE_LOST
    return _points(section_from_events(batch.events, kind), mesh)


def _points(section: np.ndarray, mesh: Mesh) -> np.ndarray:
    assert mesh.half_backlash is not None
    assert mesh.natural_frequency is not None
    return poincare_points(section, mesh.half_backlash, mesh.natural_frequency)


class MotionTask(Task):
    """The regime of the motion in a mesh, and the table `poincare` where no events come.

    Parameters
    ----------
    subject : str
        `motion`, or that of one mesh of several.
    settings : AnalyzerSettings
    layout : Layout
    mesh : MeshLayout
    restarts : Counter
        Where a record that is given up is counted.
    """

    name = 'motion'
    indicators = (
        Indicator('mesh_frequency', 'Hz', 'mesh cycles per second'),
        Indicator('period', '', 'period in mesh cycles, 0 if not periodic'),
        Indicator('recurrence', '', 'distance of states a period apart, in standard deviations'),
        Indicator('zero_one_k', '', 'K of the 0-1 test: 0 regular, 1 chaotic'),
        Indicator('lyapunov', '1/s', 'largest Lyapunov exponent'),
        Indicator('lyapunov_uncertainty', '1/s', 'its standard error'),
    )

    def __init__(
        self,
        subject: str,
        settings: AnalyzerSettings,
        layout: Layout,
        mesh: MeshLayout,
        restarts: collections.Counter[str],
    ) -> None:
        self._subject = subject
        self._settings = settings
        self._rate = layout.sample_rate
        self._section_phase = layout.section_phase
        self._columns = [
            layout.index(str(name)) for name in (mesh.mesh.displacement, mesh.mesh.velocity)
        ]
        self.mesh = mesh.mesh
        self._restarts = restarts
        self._spread = Spread(self._rate)
        self._last: np.ndarray | None = None
        self._next = 0
        self._source = ''
        self._section: SectionRecord | None = None

    def use(self, mesh: Mesh) -> None:
        """Take over scales that changed while the rig runs."""
        self.mesh = mesh

    def observe(self, batch: Batch) -> None:
        """Take the scatter of the next samples; needed whatever the section is made of."""
        delta, delta_dot = batch.values[:, self._columns].T
        self._spread.add(delta, delta_dot)

    def push(self, batch: Batch) -> Iterator[TaskResult]:
        """Take the section from the next samples, interpolated."""
        phase = batch.phases[self.mesh.name]
        rows = np.column_stack([batch.values[:, self._columns], phase])
        first, margin = batch.first, 0
        if self._last is not None and self._next == batch.first:
            # The last step before this batch is interpolated now that its successor is known.
            rows = np.concatenate([self._last, rows])
            first, margin = batch.first - len(self._last), 1
        self._last, self._next = rows[-OVERLAP:], batch.first + len(phase)
        if len(rows) < 2 * OVERLAP or not np.all(np.diff(rows[:, -1]) > 0):
            return
        times = (first + np.arange(len(rows))) / self._rate
        arguments = times, rows[:, 2], rows[:, 0], rows[:, 1]
        section = section_by_phase(*arguments, self._section_phase, margin)
        points = section
        if self._settings.section == 'contact_loss':
            assert self.mesh.half_backlash is not None
            t, phases, delta, delta_dot = (
                each[OVERLAP - 1 if margin else 0 :] for each in arguments
            )
            points = section_by_contact_loss(t, phases, delta, delta_dot, self.mesh.half_backlash)
        if len(points):
            table = _points(points, self.mesh)
            yield TaskResult(batch.first, len(phase), tables={'poincare': table})
        yield from self.push_section(section, INTERPOLATED)

    def push_section(self, section: np.ndarray, source: str) -> Iterator[TaskResult]:
        """Take states of the section, t [s] from the start of the record."""
        if source != self._source or self._section is None:
            # States of different accuracy are not judged together.
            self._source = source
            tolerance = self._settings.recurrence_tolerance
            if source != EXACT:
                tolerance = max(tolerance, INTERPOLATED_TOLERANCE)
            self._section = SectionRecord(self._settings.regime_cycles, tolerance, self._restarts)
        for verdict in self._section.push(section, self._spread.over):
            self.seconds = verdict.end - verdict.start
            first, count = verdict.start * self._rate, self.seconds * self._rate
            yield TaskResult(first, count, [self._row(verdict, source)])
        self._spread.forget(self._section.start)

    def _row(self, verdict: SectionVerdict, source: str) -> Row:
        values = {'mesh_frequency': verdict.cycle_rate}
        notes = {'regime': verdict.text, 'section': source}
        found = verdict.regime
        if found is not None:
            values |= {
                'period': float(found.period),
                'recurrence': found.recurrence,
                'zero_one_k': found.zero_one,
            }
            if found.lyapunov is not None:
                exponent = found.lyapunov.exponent / LYAPUNOV_SHARE
                scatter = found.lyapunov.uncertainty / LYAPUNOV_SHARE
                values['lyapunov'] = exponent
                values['lyapunov_uncertainty'] = math.hypot(scatter, LYAPUNOV_ERROR * exponent)
        reason = 'a periodic motion has no K, another has no recurrence'
        return Row(self._subject, values, notes, verdict.text, reason)
