"""Opens a recording by the kind of its file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from gear_dynamics.machine.recording_form import Rows
from gear_dynamics.recordings.delimited import CsvTable
from gear_dynamics.recordings.hdf5 import Hdf5Table
from gear_dynamics.recordings.instruments import TdmsTable, UffTable
from gear_dynamics.recordings.matlab import read_matlab
from gear_dynamics.recordings.mcap_log import McapTable
from gear_dynamics.recordings.numpy_files import NpzTable, read_npy
from gear_dynamics.recordings.parquet import ParquetTable, RowsTable
from gear_dynamics.recordings.table import RecordingError, RecordingTable
from gear_dynamics.recordings.wav import WavTable

_HDF5 = b'\x89HDF\r\n\x1a\n'


def _matlab(path: Path) -> RecordingTable:
    with path.open('rb') as stream:
        head = stream.read(520)
    # Version 7.3 has MATLAB's own text before the HDF5 signature.
    return Hdf5Table(path) if head[512:520] == _HDF5 or head[:8] == _HDF5 else read_matlab(path)


READERS: dict[str, Callable[[Path], RecordingTable]] = {
    **dict.fromkeys(('.csv', '.txt', '.tsv', '.dat', '.asc'), CsvTable),
    '.wav': WavTable,
    '.mat': _matlab,
    '.npz': NpzTable,
    '.npy': read_npy,
    '.parquet': ParquetTable,
    **dict.fromkeys(('.h5', '.hdf5', '.hdf', '.he5'), Hdf5Table),
    '.tdms': TdmsTable,
    **dict.fromkeys(('.uff', '.unv', '.u58'), UffTable),
    '.mcap': McapTable,
}
"""Reader of each ending of a file's name."""


def open_table(path: str | Path, rows: Rows | None = None) -> RecordingTable:
    """Open a recording.

    Parameters
    ----------
    path : path
        A file, or the folder of an MCAP log.
    rows : Rows, optional
        For Parquet files with a row a channel.

    Raises
    ------
    RecordingError
        If it cannot be read.
    """
    path = Path(path)
    if not path.exists():
        raise RecordingError(f'{path} does not exist')
    if path.is_dir():
        if any(path.glob('*.mcap')):
            return McapTable(path)
        raise RecordingError(f'{path} is a folder without an MCAP log: give its files')
    ending = path.suffix.lower()
    if ending == '.parquet' and rows is not None:
        return RowsTable(path, rows)
    if ending not in READERS:
        # Some test rigs write text files named by their time, without an ending.
        if _is_text(path):
            return CsvTable(path)
        known = ' '.join(READERS)
        raise RecordingError(f'{path.name} is of no known kind: known are {known}')
    try:
        return READERS[ending](path)
    except OSError as error:
        raise RecordingError(f'{path} cannot be read: {error.strerror or error}') from None


def _is_text(path: Path) -> bool:
    with path.open('rb') as stream:
        return b'\0' not in stream.read(4096)
