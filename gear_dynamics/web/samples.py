"""The latest samples of a stream, in a ring of fixed size."""

from __future__ import annotations

import numpy as np


class SampleRing:
    """Keep the last samples of a stream of any columns.

    Parameters
    ----------
    names : tuple of str
        Columns to keep; all are float32.
    capacity : int
        Samples kept.
    """

    def __init__(self, names: tuple[str, ...], capacity: int) -> None:
        self.names = names
        self.capacity = capacity
        self._rows = np.zeros((len(names), capacity), np.float32)
        self.count = 0
        """Samples ever added."""

    def add(self, rows: np.ndarray) -> None:
        """Add the rows of a structured array; of more than the capacity only the last stay."""
        rows = rows[-self.capacity :]
        begin = self.count % self.capacity
        first = min(len(rows), self.capacity - begin)
        for index, name in enumerate(self.names):
            column = rows[name]
            self._rows[index, begin : begin + first] = column[:first]
            self._rows[index, : len(rows) - first] = column[first:]
        self.count += len(rows)

    @property
    def held(self) -> int:
        """Samples that can be read."""
        return min(self.count, self.capacity)

    def last(self, name: str, n: int, before: int = 0) -> np.ndarray:
        """Return the last n samples of a column that lie `before` samples from the end.

        Of a column that is not there, or of samples that are not, none are returned.
        """
        if name not in self.names:
            return np.zeros(0, np.float32)
        n = max(min(n, self.held - before), 0)
        places = np.arange(self.count - before - n, self.count - before) % self.capacity
        return self._rows[self.names.index(name), places]
