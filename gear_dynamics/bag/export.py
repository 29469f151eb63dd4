"""Topics of a log as NPZ or CSV files, one file a topic, in bounded memory."""

from __future__ import annotations

import contextlib
import csv
import re
import tempfile
import warnings
import zipfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np

from gear_dynamics.bag.channel import LogError
from gear_dynamics.bag.log import Log, LogPath, LogWarning, printable
from gear_dynamics.bag.reader import common_type, iter_rows

FORMATS = ('npz', 'csv')

MOST_TOPICS = 500
"""Topics that are exported without being named; each is read from the whole log."""


def export(
    path: LogPath,
    folder: Path,
    topics: Sequence[str] | None = None,
    file_format: str = 'npz',
    progress: Callable[[str], None] = lambda topic: None,
) -> list[Path]:
    """Write topics of a log to `folder`, as gear_pair_samples.npz or .csv.

    An NPZ file has one array for each column, under its name. Columns and t are those of
    `read_log`.

    Parameters
    ----------
    path : path, or sequence of paths
        Bag folders and MCAP files.
    folder : Path
        Created if missing; files in it are replaced.
    topics : sequence of str, optional
        All by default.
    file_format : str
        'npz' or 'csv'.
    progress : callable
        Called with each topic before it is written.

    Returns
    -------
    list of Path
        The files, one for each topic that has rows.

    Raises
    ------
    LogError
        If there is no such log or topic, or there is nothing in it.
    OSError
        If the files cannot be written.
    """
    write = {'npz': _write_npz, 'csv': _write_csv}[file_format]
    files: list[Path] = []
    with Log(path) as log:
        names = [log.resolve(topic) for topic in topics] if topics else _topics(log)
        folder.mkdir(parents=True, exist_ok=True)
        for name in names:
            progress(printable(name))
            try:
                dtype, count = _shape(log, name)
            except LogError as error:
                if topics:
                    raise
                warnings.warn(str(error), LogWarning, stacklevel=2)
                continue
            if count:
                file = _file_of(name, folder, file_format, files)
                write(file, _same_type(log, name, dtype), dtype, count)
                files.append(file)
    if not files:
        raise LogError('the log has nothing that could be exported')
    return files


def _topics(log: Log) -> list[str]:
    """Return the names of all topics that have messages."""
    names = sorted({channel.topic for channel, c in log.contents().items() if c.messages})
    if len(names) > MOST_TOPICS:
        raise LogError(
            f'the log has {len(names)} topics: more than {MOST_TOPICS} must be named one by one'
        )
    return names


def _file_of(topic: str, folder: Path, file_format: str, taken: Sequence[Path]) -> Path:
    """Return the file for a topic: its name, as far as every file system can bear it."""
    name = re.sub(r'[^A-Za-z0-9_.-]', '_', topic.strip('/'))[:100].lstrip('.') or 'topic'
    file, number = folder / f'{name}.{file_format}', 1
    while file in taken:
        number += 1
        file = folder / f'{name}_{number}.{file_format}'
    return file


def _shape(log: Log, topic: str) -> tuple[np.dtype, int]:
    """Return the number of rows and a type that holds all; texts differ in length."""
    dtype, count = None, 0
    for rows in iter_rows(log, topic):
        if dtype is None:
            dtype = rows.dtype
        elif rows.dtype != dtype:
            dtype = common_type(dtype, rows.dtype, count + len(rows), topic)
        count += len(rows)
    return (np.dtype([]) if dtype is None else dtype), count


def _same_type(log: Log, topic: str, dtype: np.dtype) -> Iterator[np.ndarray]:
    for rows in iter_rows(log, topic):
        yield rows.astype(dtype, copy=False)


def _write_csv(file: Path, blocks: Iterator[np.ndarray], dtype: np.dtype, count: int) -> None:
    with file.open('w', newline='', encoding='utf-8') as stream:
        writer = csv.writer(stream)
        writer.writerow(dtype.names or ())
        for block in blocks:
            writer.writerows(block.tolist())


def _write_npz(file: Path, blocks: Iterator[np.ndarray], dtype: np.dtype, count: int) -> None:
    """Write the columns side by side into files of their own, then put these into the archive."""
    names = dtype.names or ()
    with tempfile.TemporaryDirectory(dir=file.parent, prefix='.export_') as scratch:
        parts = [Path(scratch) / f'{number}.npy' for number in range(len(names))]
        with contextlib.ExitStack() as stack:
            streams = [stack.enter_context(part.open('wb')) for part in parts]
            for name, stream in zip(names, streams, strict=True):
                about = {
                    'descr': np.lib.format.dtype_to_descr(dtype[name]),
                    'fortran_order': False,
                    'shape': (count,),
                }
                np.lib.format.write_array_header_1_0(stream, about)
            for block in blocks:
                for name, stream in zip(names, streams, strict=True):
                    stream.write(block[name].tobytes())
        with zipfile.ZipFile(file, 'w') as archive:
            for name, part in zip(names, parts, strict=True):
                archive.write(part, f'{name}.npy')
