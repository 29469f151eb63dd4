"""Parquet files: a column a channel, or a row a channel."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from gear_dynamics.machine.recording_form import Rows
from gear_dynamics.recordings.optional import optional_module
from gear_dynamics.recordings.table import (
    BLOCK,
    RecordingError,
    RecordingTable,
    RowTable,
    as_numbers,
    find_column,
)


class ParquetTable(RowTable):
    """A Parquet file with a column a channel."""

    def __init__(self, path: Path) -> None:
        super().__init__(path.name)
        self._file = _open(path)
        self.columns = tuple(self._file.schema_arrow.names)
        if self._file.metadata.num_rows == 1:
            row = next(iter(self._file.iter_batches())).to_pydict()
            self.constants = {
                name: float(value[0])
                for name, value in row.items()
                if isinstance(value[0], int | float)
            }

    def rows(self, columns: Sequence[str]) -> Iterator[np.ndarray]:
        """Yield blocks of rows."""
        for batch in self._file.iter_batches(BLOCK, columns=list(columns)):
            arrays = [batch.column(batch.schema.get_field_index(each)) for each in columns]
            yield np.column_stack(
                [as_numbers(array.to_numpy(zero_copy_only=False)) for array in arrays]
            )


class RowsTable(RecordingTable):
    """A Parquet file with a row a channel: its name, all of its samples, its rate and unit."""

    def __init__(self, path: Path, form: Rows) -> None:
        super().__init__(path.name)
        self._file = _open(path)
        names = self._file.schema_arrow.names
        for wanted in (form.name, form.samples, form.rate, form.unit):
            if wanted is not None:
                find_column(path.name, names, wanted)
        self._form = form
        fields = [each for each in (form.name, form.rate, form.unit) if each is not None]
        self._about = self._file.read(columns=fields).to_pydict()
        self.columns = tuple(str(each) for each in self._about[form.name])

    def rate(self, column: str) -> float | None:
        """Return the rate that stands in the channel's row [Hz]."""
        if self._form.rate is None:
            return None
        return float(self._about[self._form.rate][self.columns.index(column)])

    def unit(self, column: str) -> str | None:
        """Return the unit that stands in the channel's row."""
        if self._form.unit is None:
            return None
        return str(self._about[self._form.unit][self.columns.index(column)])

    def open(self, columns: Sequence[str]) -> dict[str, Iterator[np.ndarray]]:
        """Return the samples of channels, each as an iterator of blocks."""
        return {column: self._blocks(self.columns.index(column)) for column in columns}

    def _blocks(self, row: int) -> Iterator[np.ndarray]:
        batches = self._file.iter_batches(1, columns=[self._form.samples])
        for index, batch in enumerate(batches):
            if index == row:
                samples = batch.column(0).flatten().to_numpy(zero_copy_only=False)
                for first in range(0, len(samples), BLOCK):
                    yield as_numbers(samples[first : first + BLOCK])
                return


def _open(path: Path):  # type: ignore[no-untyped-def]
    parquet = optional_module('pyarrow.parquet', 'pyarrow', path.name)
    try:
        return parquet.ParquetFile(path)
    except Exception as error:
        reason = ' '.join(str(error).split())[:200]
        raise RecordingError(f'{path.name} cannot be read: {reason}') from None
