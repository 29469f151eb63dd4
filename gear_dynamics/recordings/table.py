"""What every reader offers: named columns of numbers, read in blocks."""

from __future__ import annotations

import abc
import difflib
import itertools
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence

import numpy as np

BLOCK = 1 << 18
"""Values of a column that are read at once."""

RATE_NAMES = frozenset(
    'fs sr samplerate samplefrequency samplingrate samplingfrequency sampfreq sfreq'.split()
)
"""Names, in small letters and without separators, of constants that state a sample rate [Hz]."""


class RecordingError(ValueError):
    """A recording cannot be used; the message says why in one line."""


class RecordingTable(abc.ABC):
    """An open recording.

    Attributes
    ----------
    name : str
        Of the file, for messages.
    columns : sequence of str
        In the order of the file.
    constants : dict of str to float
        Single numbers that stand in the file, by name.
    notes : dict of str to str
        What a reader of the results must know, by column; under '' of the whole file.
    relative : bool
        Whether the values are shares of full scale.
    """

    def __init__(self, name: str) -> None:
        self.name = name
        self.columns: Sequence[str] = ()
        self.constants: dict[str, float] = {}
        self.notes: dict[str, str] = {}
        self.relative = False

    @abc.abstractmethod
    def open(self, columns: Sequence[str]) -> dict[str, Iterator[np.ndarray]]:
        """Return the values of columns, each as an iterator of 1-D float64 blocks.

        Columns that are opened together should be read at the same pace.
        """

    def rate(self, column: str) -> float | None:
        """Return the sample rate [Hz] that the file states for a column, if any."""
        stated = [
            value
            for name, value in self.constants.items()
            if plain(name.rpartition('.')[2]) in RATE_NAMES
        ]
        return stated[0] if len(set(stated)) == 1 else None

    def unit(self, column: str) -> str | None:
        """Return the unit that the file states for a column, if any."""
        return None

    def start_ns(self) -> int | None:
        """Return the time of the first sample since 1970 that the file states [ns], if any."""
        return None

    def resolve(self, column: str | int | None, topic: str | None = None) -> str:
        """Return the column that a source means.

        Parameters
        ----------
        column : str or int or None
            A name, a wildcard, a number from 1, or None where there is one column only.
        topic : str, optional
            For logs.

        Raises
        ------
        RecordingError
            If there is none, or more than one.
        """
        return find_column(self.name, self.columns, column)


def find_column(file: str, columns: Sequence[str], column: str | int | None) -> str:
    """Return the one of `columns` that is meant; see `RecordingTable.resolve`."""
    if column is None:
        if len(columns) == 1:
            return columns[0]
        raise RecordingError(f'{file} has {len(columns)} columns: say which; {_listed(columns)}')
    if isinstance(column, int):
        if 1 <= column <= len(columns):
            return columns[column - 1]
        raise RecordingError(f'{file} has no column {column}: it has {len(columns)}')
    if column in columns:
        return column
    found = [each for each in columns if matches(each, column) or _short(each) == column]
    if len(found) == 1:
        return found[0]
    if found:
        raise RecordingError(f'{column!r} means more than one column of {file}: {_listed(found)}')
    near = difflib.get_close_matches(column, columns, 1, 0.6)
    hint = f'did you mean {near[0]!r}?' if near else _listed(columns)
    raise RecordingError(f'{file} has no column {column!r}: {hint}')


def matches(name: str, pattern: str) -> bool:
    """Return whether a name matches a pattern with * and ?."""
    expression = re.escape(pattern).replace(r'\*', '.*').replace(r'\?', '.')
    return re.fullmatch(expression, name, re.DOTALL) is not None


def _short(name: str) -> str:
    """Return a name without the unit in brackets behind it."""
    return re.sub(r'\s*[\[(][^\[\]()]*[\])]\s*$', '', name)


def _listed(columns: Sequence[str]) -> str:
    shown = ', '.join(repr(each) for each in columns[:12])
    return f'there are {shown}' + (', ...' if len(columns) > 12 else '') if columns else 'none'


def plain(name: str) -> str:
    """Return a name in small letters without separators."""
    return re.sub(r'[^a-z0-9]', '', name.lower())


class RowTable(RecordingTable):
    """A recording whose columns are read together, row by row."""

    @abc.abstractmethod
    def rows(self, columns: Sequence[str]) -> Iterator[np.ndarray]:
        """Yield blocks of rows, float64, shape (any, columns)."""

    def open(self, columns: Sequence[str]) -> dict[str, Iterator[np.ndarray]]:
        """Return the values of columns, each as an iterator of blocks."""
        shared = itertools.tee(self.rows(columns), len(columns))
        return {
            column: _column(rows, index)
            for index, (column, rows) in enumerate(zip(columns, shared, strict=True))
        }


def _column(rows: Iterable[np.ndarray], index: int) -> Iterator[np.ndarray]:
    for block in rows:
        yield block[:, index]


class ArrayTable(RecordingTable):
    """Columns that are arrays: in memory, mapped, or of a library that reads slices.

    Parameters
    ----------
    name : str
    arrays : mapping of str to array
        Everything with a length and slices.
    """

    def __init__(self, name: str, arrays: Mapping[str, np.ndarray]) -> None:
        super().__init__(name)
        self._arrays = arrays
        self.columns = tuple(arrays)
        for column, values in arrays.items():
            if len(values) == 1:
                value = as_numbers(np.asarray(values[:1]))[0]
                if np.isfinite(value):
                    self.constants[column] = float(value)

    def open(self, columns: Sequence[str]) -> dict[str, Iterator[np.ndarray]]:
        """Return the values of columns, each as an iterator of blocks."""
        return {column: self._blocks(column) for column in columns}

    def _blocks(self, column: str) -> Iterator[np.ndarray]:
        values = self._arrays[column]
        for first in range(0, len(values), BLOCK):
            yield as_numbers(np.asarray(values[first : first + BLOCK]))


def as_numbers(values: np.ndarray) -> np.ndarray:
    """Return values as float64, NaN where there is text or nothing."""
    if values.dtype.kind in 'fiub':
        return values.astype(np.float64)
    return np.array([_number(value) for value in values.ravel()], dtype=np.float64)


def _number(value: object) -> float:
    try:
        return float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return float('nan')


def flatten(name: str, values: np.ndarray) -> Iterator[tuple[str, np.ndarray]]:
    """Yield the columns of an array: (n,), (n, 1) and (1, n) are one; others one a column."""
    if values.dtype.names:
        for field in values.dtype.names:
            yield from flatten(f'{name}.{field}' if name else field, values[field])
        return
    if values.dtype.kind not in 'fiub':
        return
    if values.ndim < 2 or min(values.shape) <= 1:
        yield name, values.reshape(-1)
        return
    if values.ndim == 2:
        if values.shape[0] < values.shape[1]:
            values = values.T
        for index in range(values.shape[1]):
            yield f'{name}[{index + 1}]', values[:, index]
