"""Logs into arrays and messages: `gd.read_log`, and what `replay` plays."""

from __future__ import annotations

import dataclasses
import math
import numbers
from collections.abc import Callable, Collection, Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.lib.recfunctions import repack_fields

from gear_dynamics.bag.channel import Damage, LogChannel, LogError
from gear_dynamics.bag.log import Log, LogPath, message_time, printable, warn_of
from gear_dynamics.bag.rows import row_reader
from gear_dynamics.bag.time_range import log_time_range

_ROWS_AT_FIRST = 1 << 16
_BYTES_AT_FIRST = 1 << 23
_EXPANSION = 64

LARGEST_TEXTS = 1 << 32
"""Bytes that columns of text may take, as wide as the longest of them."""


@dataclasses.dataclass(frozen=True, slots=True)
class LogMessage:
    """A message of a log.

    Attributes
    ----------
    channel : LogChannel
        Topic, type, type hash and offered QoS profiles (YAML).
    data : bytes
        CDR bytes as they were published; not checked against the type.
    log_time, publish_time : int
        Arrival and stamp [ns].
    path : Path
        File.
    offset : int
        Byte at which the message's chunk begins.
    sequence : int
        Number that the publisher or the writer gave it; 0 in logs of this package.
    """

    channel: LogChannel
    data: bytes
    log_time: int
    publish_time: int
    path: Path
    offset: int
    sequence: int = 0

    @property
    def place(self) -> str:
        """Place of the message, for error messages."""
        return (
            f'{self.path.name}, byte {self.offset}, topic {printable(self.channel.topic)}, '
            f'log time {self.log_time} ns'
        )


def read_messages(
    path: LogPath,
    topics: Collection[str] | None = None,
    start: int | None = None,
    end: int | None = None,
    on_damage: Callable[[Damage], None] = warn_of,
) -> Iterator[LogMessage]:
    """Iterate over the messages of a log by log time, with one chunk a file in memory.

    Parameters
    ----------
    path : path, or sequence of paths
        Bag folders and MCAP files; whole, cut or damaged.
    topics : collection of str, optional
        Only these topics, absolute names.
    start, end : int, optional
        Only log times from `start` on and before `end` [ns].
    on_damage : callable
        Called with every place that is skipped; issues a `LogWarning` by default.

    Raises
    ------
    LogError
        If there is no such file.
    """
    with Log(path, on_damage) as log:
        for source, message in log.messages(topics, start, end):
            yield LogMessage(
                message.channel,
                bytes(message.data),
                message.log_time,
                message.publish_time,
                source.path,
                message.offset,
                message.sequence,
            )


def iter_rows(
    log: Log,
    topic: str,
    start: float | None = None,
    end: float | None = None,
    columns: Sequence[str] | None = None,
) -> Iterator[np.ndarray]:
    """Iterate over the messages of a topic as structured arrays; arguments as for `read_log`."""
    _check_range(start, end)
    _check_columns(columns)
    name = log.resolve(topic)
    # A time range needs t even where it is not asked for.
    hidden = columns is not None and 't' not in columns and (start, end) != (None, None)
    reader = row_reader(log.topic(name), ['t', *columns] if hidden and columns else columns)
    origin = log.origin()
    low = -np.inf if start is None else start
    high = np.inf if end is None else end
    for source, message in log.messages([name], *log_time_range(log, name, reader, low, high)):
        try:
            t = (message_time(message) - origin) * 1e-9
            rows = reader.read(message.data, t, low, high)
        except LogError:
            raise
        except ValueError as error:
            at = f'{printable(name)} at log time {message.log_time} ns'
            reason = f'a message of {at} is skipped: {error}'
            log.damaged(Damage(source.path, message.offset, reason))
            continue
        if (start, end) != (None, None):
            rows = rows[(rows['t'] >= low) & (rows['t'] < high)]
        if len(rows):
            yield repack_fields(rows[list(columns or ())]) if hidden else rows


def read_log(
    path: LogPath,
    topic: str = 'gear_pair/samples',
    start: float | None = None,
    end: float | None = None,
    columns: Sequence[str] | None = None,
) -> np.ndarray:
    """Return what was logged on a topic as one structured array.

    Samples come back as `gd.simulate` returns them (float64). Other tables keep the types of
    their columns behind a column t, and messages of other types give a row each, or one for each
    value where they hold a list of them.

    Parameters
    ----------
    path : path, or sequence of paths
        Bag folders and MCAP files; whole, cut or damaged. What cannot be read is skipped with a
        `LogWarning` that names the place.
    topic : str
        Name; that without its namespace will do if it is the only one.
    start, end : float, optional
        Only rows with start <= t < end [s].
    columns : sequence of str, optional
        Only these columns, in this order.

    Returns
    -------
    ndarray
        Structured. Its t [s] counts from the stamp of the log's first block of samples, on all
        topics alike; in a log without samples, from its first message.

    Raises
    ------
    LogError
        If there is no such file, topic or column, nothing can be read, or an argument is of no
        use.
    """
    with Log(path) as log:
        blocks = iter_rows(log, topic, start, end, columns)
        first = next(blocks, None)
        if first is None:
            return _empty(log, topic, columns)
        expected = _expected_rows(log, log.resolve(topic), first, start, end)
        rows = np.empty(max(expected, len(first), 1), first.dtype)
        rows[: len(first)] = first
        filled = len(first)
        for block in blocks:
            if block.dtype != rows.dtype:
                rows = _widen(rows, block.dtype, topic)
                block = block.astype(rows.dtype)
            if filled + len(block) > len(rows):
                rows.resize(max(2 * len(rows), filled + len(block)), refcheck=False)
            # As plain bytes: NumPy copies structured rows field by field, four times slower.
            _bytes(rows[filled : filled + len(block)])[:] = _bytes(block)
            filled += len(block)
        rows.resize(filled, refcheck=False)
        return rows


def _check_range(start: float | None, end: float | None) -> None:
    for name, value in (('start', start), ('end', end)):
        if value is not None and (not isinstance(value, numbers.Real) or math.isnan(value)):
            raise LogError(f'{name} is {value!r}: it must be a number of seconds')


def _check_columns(columns: Sequence[str] | None) -> None:
    if columns is not None and (isinstance(columns, str) or not len(columns)):
        raise LogError(f"columns is {columns!r}: it must be a list of names, as ['mesh_force']")


def _expected_rows(
    log: Log, name: str, first: np.ndarray, start: float | None, end: float | None
) -> int:
    """Guess the number of rows, so that the array need not grow: exact for equal blocks."""
    width = max(first.dtype.itemsize, 1)
    if start is not None or end is not None or not log.indexed:
        return min(_ROWS_AT_FIRST, _BYTES_AT_FIRST // width)
    messages = sum(c.messages for channel, c in log.contents().items() if channel.topic == name)
    # An index may claim any number: no more is believed than a constant signal would give.
    plausible = _EXPANSION * sum(source.size for source in log.sources) // width
    return min(messages * len(first), plausible)


def _bytes(rows: np.ndarray) -> np.ndarray:
    return rows.view(np.dtype((np.void, rows.dtype.itemsize)))


def _widen(rows: np.ndarray, dtype: np.dtype, topic: str) -> np.ndarray:
    """Make room for longer texts; any other change of columns has no common array."""
    return rows.astype(common_type(rows.dtype, dtype, len(rows), topic), copy=False)


def common_type(first: np.dtype, second: np.dtype, count: int, topic: str) -> np.dtype:
    """Return the type of `count` rows that holds those of both types.

    Raises
    ------
    LogError
        If there is none, or it would take too much memory.
    """
    try:
        dtype = np.promote_types(first, second)
    except TypeError:
        raise LogError(
            f'the columns of {printable(topic)} change within the log: read its files one by one'
        ) from None
    if count * dtype.itemsize > LARGEST_TEXTS:
        raise LogError(
            f'{count} rows of {dtype.itemsize} bytes of {printable(topic)} exceed the limit of '
            f'{LARGEST_TEXTS} bytes: read fewer columns, or a part'
        )
    return dtype


def _empty(log: Log, topic: str, columns: Sequence[str] | None) -> np.ndarray:
    """Return no rows, with the right columns if the topic has any."""
    for rows in iter_rows(log, topic, columns=columns):
        return rows[:0]
    return np.empty(0, [('t', np.float64)])
