"""NumPy files (.npz, .npy), and recordings that are in memory already."""

from __future__ import annotations

import zipfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.lib import format as npy_format

from gear_dynamics.recordings.table import (
    BLOCK,
    ArrayTable,
    RecordingError,
    RecordingTable,
    as_numbers,
    flatten,
)


def read_npy(path: Path) -> ArrayTable:
    """Return a .npy file, mapped into memory; a structured array has a column a field."""
    try:
        values = np.load(path, mmap_mode='r', allow_pickle=False)
    except ValueError as error:
        raise RecordingError(f'{path.name} cannot be read: {error}') from None
    return ArrayTable(path.name, dict(flatten('' if values.dtype.names else 'data', values)))


class NpzTable(RecordingTable):
    """A .npz file; 1-D arrays are read block by block, others when they are asked for."""

    def __init__(self, path: Path) -> None:
        super().__init__(path.name)
        self._path = path
        self._streamed: dict[str, str] = {}
        loaded: dict[str, np.ndarray] = {}
        try:
            with zipfile.ZipFile(path) as archive, np.load(path, allow_pickle=False) as content:
                for member in archive.namelist():
                    name = member.removesuffix('.npy')
                    with archive.open(member) as stream:
                        shape, dtype = _header(stream)
                    if len(shape) == 1 and shape[0] > 1 and dtype.kind in 'fiub':
                        self._streamed[name] = member
                    elif dtype.kind not in 'OUSmM':
                        loaded.update(flatten(name, np.atleast_1d(content[name])))
        except (zipfile.BadZipFile, ValueError) as error:
            raise RecordingError(f'{path.name} cannot be read: {error}') from None
        self._loaded = ArrayTable(path.name, loaded)
        self.columns = (*self._streamed, *self._loaded.columns)
        self.constants = self._loaded.constants

    def open(self, columns: Sequence[str]) -> dict[str, Iterator[np.ndarray]]:
        """Return the values of columns, each as an iterator of blocks."""
        loaded = self._loaded.open([each for each in columns if each not in self._streamed])
        return loaded | {each: self._blocks(each) for each in columns if each in self._streamed}

    def _blocks(self, column: str) -> Iterator[np.ndarray]:
        with (
            zipfile.ZipFile(self._path) as archive,
            archive.open(self._streamed[column]) as stream,
        ):
            shape, dtype = _header(stream)
            for first in range(0, shape[0], BLOCK):
                size = min(BLOCK, shape[0] - first) * dtype.itemsize
                yield as_numbers(np.frombuffer(stream.read(size), dtype))


def _header(stream: Any) -> tuple[tuple[int, ...], np.dtype]:
    version = npy_format.read_magic(stream)
    read = npy_format.read_array_header_1_0 if version == (1, 0) else _header_2_0
    shape, _, dtype = read(stream)
    return shape, dtype


_header_2_0 = npy_format.read_array_header_2_0


def memory_table(recording: Any) -> ArrayTable:
    """Return a structured array, a mapping of columns, a DataFrame or a `Run` as a table.

    Raises
    ------
    RecordingError
        If it is none of these.
    """
    samples = getattr(recording, 'samples', None)
    if isinstance(samples, np.ndarray):  # a run of the simulator
        recording = samples
    columns: dict[str, np.ndarray] = {}
    if isinstance(recording, np.ndarray) and recording.dtype.names:
        columns.update(flatten('', recording))
    elif isinstance(recording, Mapping) or hasattr(recording, 'to_numpy'):
        for name in recording:
            values = np.atleast_1d(np.asarray(recording[name]))
            if values.dtype.kind in 'OU':
                values = as_numbers(values)
            columns.update(flatten(str(name), values))
    else:
        raise RecordingError(
            f'a recording of type {type(recording).__name__} is not known: give a path, a list of '
            'paths, a structured array, a mapping of columns or a DataFrame'
        )
    return ArrayTable('the recording', columns)
