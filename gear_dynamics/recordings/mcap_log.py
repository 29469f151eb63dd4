"""MCAP logs: the columns of PointCloud2 topics, and the values of Float64 and other topics."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from gear_dynamics.bag.channel import LogError
from gear_dynamics.bag.log import Log
from gear_dynamics.bag.reader import iter_rows
from gear_dynamics.recordings.table import RecordingError, RecordingTable, as_numbers, find_column


class McapTable(RecordingTable):
    """A log; a column is named `topic:column`. Its rate is that of the stamps, on average."""

    def __init__(self, path: Path) -> None:
        super().__init__(path.name)
        self._path = path
        try:
            with Log(path) as log:
                self._topics = tuple(log.topics())
        except LogError as error:
            raise RecordingError(str(error)) from None
        self.columns = self._topics
        self._rates: dict[str, float | None] = {}

    def resolve(self, column: str | int | None, topic: str | None = None) -> str:
        """Return `topic:column`."""
        if topic is None:
            raise RecordingError(f'{self.name} is a log: column {column!r} needs a topic')
        try:
            with Log(self._path) as log:
                name = log.resolve(topic)
                first = next(iter_rows(log, name), None)
        except LogError as error:
            raise RecordingError(str(error)) from None
        if first is None:
            raise RecordingError(f'{self.name} has no messages on {name}')
        columns = [each for each in first.dtype.names or () if each != 't' or column == 't']
        return f'{name}:{find_column(f"{self.name}, topic {name},", columns, column)}'

    def rate(self, column: str) -> float | None:
        """Return the mean rate of a topic's rows [Hz]."""
        topic = column.rpartition(':')[0]
        if topic not in self._rates:
            self._rates[topic] = self._mean_rate(topic)
        return self._rates[topic]

    def open(self, columns: Sequence[str]) -> dict[str, Iterator[np.ndarray]]:
        """Return the values of columns, each as an iterator of blocks."""
        return {column: self._blocks(column) for column in columns}

    def _blocks(self, column: str) -> Iterator[np.ndarray]:
        topic, _, name = column.rpartition(':')
        with Log(self._path) as log:
            for rows in iter_rows(log, topic, columns=[name]):
                yield as_numbers(rows[name])

    def _mean_rate(self, topic: str) -> float | None:
        first = last = np.nan
        count = 0
        with Log(self._path) as log:
            for rows in iter_rows(log, topic, columns=['t']):
                if count == 0:
                    first = rows['t'][0]
                last = rows['t'][-1]
                count += len(rows)
        return (count - 1) / (last - first) if count > 1 and last > first else None
