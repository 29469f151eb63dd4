"""Turns the values of a span into rows with levels: baseline, limits, operating state."""

from __future__ import annotations

import math
import time

from gear_dynamics.monitoring.baseline import Baseline
from gear_dynamics.monitoring.level import Level
from gear_dynamics.monitoring.naming import Followed, Naming
from gear_dynamics.monitoring.operating import Judgement
from gear_dynamics.monitoring.results import ConditionResult, ConditionRow, StreamSpan
from gear_dynamics.monitoring.task import Bin, Normal, Row
from gear_dynamics.monitoring.thresholds import Thresholds

WITHIN = 'within its limits'
NOT_JUDGED = 'not judged'
KEPT = 0.5
"""Fraction of its limit down to which a fault that is named counts as found."""

UNCONFIRMED = 'found once'
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
        self._naming = Naming(thresholds.rule.raised, thresholds.rule.of)

    def forget(self) -> None:
        """Forget the faults seen so far."""
        self._naming.forget()

    def normal(self, bin_: Bin, name: str) -> Normal | None:
        """Return what was learned of SUBJECT/NAME in an operating bin; None if too little."""
        return self.baseline.normal(bin_, name)

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
        followed = self._followed(span, row, judgement) if steady else []
        named = self._naming.named(row.subject)
        holds = {fault.condition.indicator for fault in named}
        levels = {
            name: self._level(row.subject, name, value, judgement, name in holds)
            for name, value in values.items()
        }
        worst = max(levels.values(), default=Level.OK)
        return ConditionRow(
            row.subject,
            worst,
            self._message(row, values, levels, judgement, followed),
            values,
            self._notes(row, values, judgement),
        )

    def _relative(self, row: Row) -> list[tuple[str, float]]:
        """Return the values that have a relative limit."""
        found = []
        for name, value in row.values.items():
            limit = self.thresholds.limit(row.subject, name)
            if limit is not None and limit.learns:
                found.append((name, value))
        return found

    def _normal(self, subject: str, name: str, judgement: Judgement) -> Normal | None:
        return self.baseline.normal(judgement.bin, f'{subject}/{name}')

    def _followed(self, span: StreamSpan, row: Row, judgement: Judgement) -> list[Followed]:
        """Return the faults of a subject that were found, those of this span taken in."""
        named = {fault.condition.indicator for fault in self._naming.named(row.subject)}
        found = [
            each
            for each in row.conditions
            if self.thresholds.beyond(
                row.subject,
                each.indicator,
                row.values[each.indicator] / (KEPT if each.indicator in named else 1.0),
                self._normal(row.subject, each.indicator, judgement),
            )
        ]
        if not found and not self._naming.follows(row.subject):
            return []
        return self._naming.update(row.subject, judgement.bin, found, span.start_ns)

    def _level(
        self, subject: str, name: str, value: float, judgement: Judgement, hold: bool
    ) -> Level:
        if judgement.reason:
            return self.thresholds.held(subject, name)
        normal = self._normal(subject, name, judgement)
        return self.thresholds.level(subject, name, value, normal, hold)

    def _message(
        self,
        row: Row,
        values: dict[str, float],
        levels: dict[str, Level],
        judgement: Judgement,
        followed: list[Followed],
    ) -> str:
        worst = max(levels.values(), default=Level.OK)
        raised = [name for name, level in levels.items() if level and level == worst]
        if judgement.reason:
            held = f'; held: {", ".join(raised)}' if raised else ''
            return f'{NOT_JUDGED}: {judgement.reason}{held}'
        if followed:
            return '; '.join(_text(row.subject, fault) for fault in followed)
        if raised:
            beyond = ', '.join(f'{name} {values[name]:.3g}' for name in raised)
            return f'{beyond}: beyond the limit'
        return row.message or row.reason or WITHIN

    def _notes(self, row: Row, values: dict[str, float], judgement: Judgement) -> dict[str, str]:
        notes = dict(row.notes)
        for name in values:
            normal = self._normal(row.subject, name, judgement)
            for word, bound in self.thresholds.bounds(row.subject, name, normal).items():
                notes[f'{name}_{word}'] = f'{bound:.6g}'
        if any(map(math.isnan, values.values())):
            notes['not_a_number'] = row.reason or NO_VALUE
        if judgement.reason:
            notes[NOT_JUDGED] = judgement.reason
        elif any(
            self._normal(row.subject, name, judgement) is None for name, _ in self._relative(row)
        ):
            notes['baseline'] = 'not learned yet in this operating bin: absolute limits only'
        return notes


def _text(subject: str, fault: Followed) -> str:
    text = fault.condition.text(subject)
    if not fault.named:
        return f'{text}, {UNCONFIRMED}'
    clock = time.strftime('%H:%M:%S', time.gmtime(fault.first_ns / 1e9))
    return f'{text}; first seen {clock} UTC'
