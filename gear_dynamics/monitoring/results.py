"""What the online analysis hands out; every result says what span it was computed on."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping

import numpy as np

from gear_dynamics.monitoring.thresholds import Level, Thresholds


@dataclasses.dataclass(frozen=True)
class Span:
    """A stretch of the stream.

    Attributes
    ----------
    start_ns : int
        Stamp of its first sample [ns].
    duration : float
        [s]
    """

    start_ns: int
    duration: float


@dataclasses.dataclass(frozen=True)
class TableResult:
    """A table, named as its topic below `gear_pair/`."""

    name: str
    span: Span
    rows: np.ndarray


@dataclasses.dataclass(frozen=True)
class ConditionRow:
    """Indicators of one channel or subject, with their worst level and why.

    `values` are the numbers by name, `notes` what must be known to read them.
    """

    subject: str
    level: Level
    message: str
    values: Mapping[str, float]
    notes: Mapping[str, str]


@dataclasses.dataclass(frozen=True)
class ConditionResult:
    """Rows that were computed on the same span."""

    span: Span
    rows: tuple[ConditionRow, ...]


Result = TableResult | ConditionResult


def span_of_table(table: TableResult) -> ConditionResult:
    """Return a row that tells the duration of a table, which has no place for it."""
    row = ConditionRow(table.name, Level.OK, f'span of {len(table.rows)} rows', {}, {})
    return ConditionResult(table.span, (row,))


def condition_row(
    subject: str,
    values: Mapping[str, float],
    thresholds: Thresholds,
    notes: Mapping[str, str] | None = None,
    message: str = 'within its limits',
) -> ConditionRow:
    """Return a row with the worst level of its values, and those beyond their limits named."""
    levels = {name: thresholds.level(subject, name, value) for name, value in values.items()}
    worst = max(levels.values(), default=Level.OK)
    if worst:
        raised = [name for name, level in levels.items() if level == worst]
        message = ', '.join(f'{name} {values[name]:.3g}' for name in raised) + ': beyond the limit'
    return ConditionRow(subject, worst, message, values, notes or {})


def columns_table(
    first: str, axis: np.ndarray, channels: tuple[str, ...], values: np.ndarray
) -> np.ndarray:
    """Return a float32 table of an axis and one column a channel."""
    rows = np.empty(len(axis), [(name, np.float32) for name in (first, *channels)])
    rows[first] = axis
    for index, channel in enumerate(channels):
        rows[channel] = values[:, index]
    return rows
