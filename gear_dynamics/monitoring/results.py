"""What the monitor returns; every result holds the span that it was computed on."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping

import numpy as np

from gear_dynamics.monitoring.level import Level


@dataclasses.dataclass(frozen=True)
class StreamSpan:
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
    span: StreamSpan
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

    span: StreamSpan
    rows: tuple[ConditionRow, ...]


Result = TableResult | ConditionResult
