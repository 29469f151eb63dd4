"""What a monitoring task is: it takes batches of samples and returns findings.

A task declares its name and the indicators of its results; names, docs and alarm limits follow
from these declarations. To add an indicator, add it to a task here, or write a task of its own and
list it in `catalogue`.
"""

from __future__ import annotations

import abc
import dataclasses
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

OWN = 'own'
"""Unit of an indicator that has the unit of its channel."""

Bin = tuple[int, int]
"""Operating bin: number of its speed and of its load."""


class Normal(NamedTuple):
    """Mean and standard deviation of the values learned, and how many they were."""

    mean: float
    deviation: float
    spans: int


Learned = Callable[[Bin, str], Normal | None]
"""Returns what was learned of SUBJECT/NAME in an operating bin."""


class Indicator(NamedTuple):
    """A number of `condition`: its name, its SI unit ('' for a pure number), and what it is."""

    name: str
    unit: str
    about: str


@dataclasses.dataclass(frozen=True)
class Batch:
    """Samples that follow each other, and what is known of them.

    Attributes
    ----------
    first : int
        Number of the first sample in the record.
    values : ndarray, shape (n, columns)
        The columns of the layout.
    channels : ndarray, shape (n, channels)
        In SI units.
    phases : mapping of str to ndarray
        Phase of each mesh [cycles], counted from the zero of its driver.
    leads : mapping of str to int
        Whole cycles by which the driven wheel's own count is ahead, by mesh.
    bin : Bin
        Operating bin.
    """

    first: int
    values: np.ndarray
    channels: np.ndarray
    phases: Mapping[str, np.ndarray]
    leads: Mapping[str, int]
    bin: Bin


class Condition(NamedTuple):
    """A fault that a span shows.

    Attributes
    ----------
    indicator : str
        The value that it is judged by.
    kind : str
        What is wrong, in words, such as 'local fault'.
    sure : float
        How sure that is, 0 to 1; NaN if it is not known.
    tooth, teeth : int
        Tooth from 0, and teeth of the wheel; None and 0 for a fault that belongs to no tooth.
    """

    indicator: str
    kind: str
    sure: float = math.nan
    tooth: int | None = None
    teeth: int = 0

    def text(self, subject: str) -> str:
        """Return the fault in words."""
        place = subject if self.tooth is None else f'{subject}, tooth {self.tooth}'
        sure = '' if math.isnan(self.sure) else f', {self.sure:.1f}'
        return f'{place}: {self.kind}{sure}'


@dataclasses.dataclass(frozen=True)
class Row:
    """Values of one subject.

    Attributes
    ----------
    subject : str
        A channel, a wheel, `contact` or `motion`.
    values : mapping of str to float
    notes : mapping of str to str
        What must be known to read the values.
    message : str
        In words; empty if the values speak for themselves.
    reason : str
        Why values are NaN; empty if none is.
    references : mapping of str to float
        Values that are learned into the baseline and not published.
    over_reference : mapping of str to tuple
        Values to be divided by the square of a reference: (numerator, name of the reference).
    conditions : sequence of Condition
        What may be wrong; it is if its indicator is beyond its limit.
    """

    subject: str
    values: Mapping[str, float]
    notes: Mapping[str, str] = dataclasses.field(default_factory=dict)
    message: str = ''
    reason: str = ''
    references: Mapping[str, float] = dataclasses.field(default_factory=dict)
    over_reference: Mapping[str, tuple[float, str]] = dataclasses.field(default_factory=dict)
    conditions: Sequence[Condition] = ()


@dataclasses.dataclass(frozen=True)
class TaskResult:
    """What a task found on a span.

    Attributes
    ----------
    first, count : float
        Number of the first sample of the span in the record, and its samples.
    rows : sequence of Row
    tables : mapping of str to ndarray
        Tables by topic name.
    """

    first: float
    count: float
    rows: Sequence[Row] = ()
    tables: Mapping[str, np.ndarray] = dataclasses.field(default_factory=dict)


class Task(abc.ABC):
    """Base of the tasks.

    Attributes
    ----------
    name : str
    seconds : float
        Duration of its span as far as it is known [s]; 0 before.
    """

    name: str = ''
    indicators: tuple[Indicator, ...] = ()
    seconds: float = 0.0

    @abc.abstractmethod
    def push(self, batch: Batch) -> Iterable[TaskResult]:
        """Take the next samples; yield what is complete."""

    def restart(self) -> None:  # noqa: B027 (not every task has a span)
        """Begin the span anew with the next batch: a new operating state has settled."""


def columns_table(
    first: str, axis: np.ndarray, channels: Sequence[str], values: np.ndarray
) -> np.ndarray:
    """Return a float32 table of an axis and one column a channel."""
    rows = np.empty(len(axis), [(name, np.float32) for name in (first, *channels)])
    rows[first] = axis
    for index, channel in enumerate(channels):
        rows[channel] = values[:, index]
    return rows
