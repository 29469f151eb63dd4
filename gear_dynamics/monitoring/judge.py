"""Turns the values of a span into rows with levels: baseline, limits, operating state."""

from __future__ import annotations

import math
import time

from gear_dynamics.monitoring.baseline import Baseline, Normal
from gear_dynamics.monitoring.level import Level
from gear_dynamics.monitoring.operating import Judgement
from gear_dynamics.monitoring.results import ConditionResult, ConditionRow, StreamSpan
from gear_dynamics.monitoring.task import Row
from gear_dynamics.monitoring.thresholds import Thresholds

WITHIN = 'within its limits'
NOT_JUDGED = 'not judged'
NO_VALUE = 'the value is undefined on this span'


class Judge:
    """Learns what is normal and says what is not; it outlives gaps and records.

    Parameters
    ----------
    thresholds : Thresholds
    baseline : Baseline
    """

    def __init__(self, thresholds: Thresholds, baseline: Baseline) -> None:
        self.thresholds = thresholds
        self.baseline = baseline
        self._first_seen: dict[str, int] = {}

    def forget(self) -> None:
        """Forget the faults seen so far."""
        self._first_seen.clear()

    def result(
        self, span: StreamSpan, rows: tuple[Row, ...], judgement: Judgement
    ) -> ConditionResult:
        """Return the rows of a span with their levels."""
        return ConditionResult(span, tuple(self._row(span, row, judgement) for row in rows))

    def _row(self, span: StreamSpan, row: Row, judgement: Judgement) -> ConditionRow:
        steady = not judgement.reason
        if steady:
            for name, value in (*row.references.items(), *self._relative(row)):
                self.baseline.learn(judgement.bin, f'{row.subject}/{name}', value)
        values = dict(row.values)
        for name, (moment, reference) in row.over_reference.items():
            normal = self.baseline.mean(judgement.bin, f'{row.subject}/{reference}')
            values[name] = moment / normal**2 if normal > 0 else math.nan
        levels = {
            name: self._level(row.subject, name, value, judgement) for name, value in values.items()
        }
        worst = max(levels.values(), default=Level.OK)
        return ConditionRow(
            row.subject,
            worst,
            self._message(span, row, values, levels, judgement),
            values,
            self._notes(row, values, judgement),
        )

    def _relative(self, row: Row) -> list[tuple[str, float]]:
        """Return the values that have a relative limit."""
        found = []
        for name, value in row.values.items():
            limit = self.thresholds.limit(row.subject, name)
            if limit is not None and limit.relative:
                found.append((name, value))
        return found

    def _normal(self, subject: str, name: str, judgement: Judgement) -> Normal | None:
        return self.baseline.normal(judgement.bin, f'{subject}/{name}')

    def _level(self, subject: str, name: str, value: float, judgement: Judgement) -> Level:
        if judgement.reason:
            return self.thresholds.held(subject, name)
        normal = self._normal(subject, name, judgement)
        return self.thresholds.level(subject, name, value, normal)

    def _message(
        self,
        span: StreamSpan,
        row: Row,
        values: dict[str, float],
        levels: dict[str, Level],
        judgement: Judgement,
    ) -> str:
        worst = max(levels.values(), default=Level.OK)
        raised = [name for name, level in levels.items() if level and level == worst]
        if judgement.reason:
            held = f'; held: {", ".join(raised)}' if raised else ''
            return f'{NOT_JUDGED}: {judgement.reason}{held}'
        if row.fault:
            first = self._first_seen.setdefault(row.fault, span.start_ns)
            clock = time.strftime('%H:%M:%S', time.gmtime(first / 1e9))
            return f'{row.message}; first seen {clock} UTC'
        if raised:
            beyond = ', '.join(f'{name} {values[name]:.3g}' for name in raised)
            return f'{beyond}: beyond the limit'
        return row.message or row.reason or WITHIN

    def _notes(self, row: Row, values: dict[str, float], judgement: Judgement) -> dict[str, str]:
        notes = dict(row.notes)
        if any(map(math.isnan, values.values())):
            notes['not_a_number'] = row.reason or NO_VALUE
        if judgement.reason:
            notes[NOT_JUDGED] = judgement.reason
        elif any(
            self._normal(row.subject, name, judgement) is None for name, _ in self._relative(row)
        ):
            notes['baseline'] = 'not learned yet in this operating bin: absolute limits only'
        return notes
