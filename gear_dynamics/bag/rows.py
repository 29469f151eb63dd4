"""Messages as rows of structured arrays: tables column by column, other types field by field."""

from __future__ import annotations

import dataclasses
import itertools
import struct
from collections.abc import Iterator, Sequence
from typing import Any, Protocol

import numpy as np

from gear_dynamics.bag.channel import LogChannel, LogError
from gear_dynamics.bag.log import printable
from gear_dynamics.machine.columns import SAMPLE_COLUMNS, SAMPLES
from gear_dynamics.wire.messages import MessageError, deserialize, message_class
from gear_dynamics.wire.tables import decode_table
from gear_dynamics.wire.topics import TABLE_TYPE

MOST_VALUES = 4096
"""Values in a message that can become columns of a row."""

LARGEST_ROWS = 1 << 28
"""Bytes that the rows of one message may take."""

_STAMP = struct.Struct('<iI')


class RowReader(Protocol):
    """Turns messages of one topic into rows."""

    def read(self, data: memoryview, t: float, low: float, high: float) -> np.ndarray:
        """Return the rows of a message whose stamp is `t` [s], none if all are out of range.

        The range is low <= t < high [s]; a message that is partly in it is returned whole.

        Raises
        ------
        TableError, MessageError
            If the message is damaged.
        LogError
            If it has no such column.
        """


def row_reader(channel: LogChannel, columns: Sequence[str] | None) -> RowReader:
    """Return the reader for the messages of a channel that keeps these columns, or all.

    Raises
    ------
    LogError
        If messages of this kind cannot be read as rows.
    """
    topic, type_name = printable(channel.topic), channel.type_name
    if channel.encoding != 'cdr':
        raise LogError(
            f'{topic} cannot be read as rows: its encoding is {printable(channel.encoding)!r}, '
            "that of ROS 2 is 'cdr'"
        )
    if type_name == TABLE_TYPE:
        return TableRows(columns)
    try:
        message_class(type_name)
    except MessageError as error:
        raise LogError(f'{topic} cannot be read as rows: {printable(str(error))}') from None
    return MessageRows(type_name, columns)


class TableRows:
    """Rows of tables; messages alike in all but stamp and rows are checked just once."""

    def __init__(self, columns: Sequence[str] | None) -> None:
        self._columns = columns
        self._alike = b''
        self._length = -1
        self._offset = 0
        self._wire = np.dtype([])
        self._dtype = np.dtype([])

    def read(self, data: memoryview, t: float, low: float, high: float) -> np.ndarray:
        """Return the rows with t [s] as float64; see `RowReader`."""
        wire = self._decode(data)
        if not self._overlaps(wire, t, low, high):
            return np.empty(0, self._dtype)
        rows = np.empty(len(wire), self._dtype)
        names = self._dtype.names or ()
        if self._dtype == SAMPLES and wire.dtype.itemsize == 4 * len(names):
            rows.view(np.float64).reshape(-1, len(names))[:] = wire.view(np.float32).reshape(
                -1, len(names)
            )
        else:
            for name in names:
                rows[name] = wire[name] if name in (wire.dtype.names or ()) else 0.0
        if 't' in names:
            rows['t'] += t
        return rows

    def _overlaps(self, wire: np.ndarray, t: float, low: float, high: float) -> bool:
        if low == -np.inf and high == np.inf:
            return True
        if not len(wire) or 't' not in (wire.dtype.names or ()):
            return low <= t < high
        return bool(t + float(wire['t'].max()) >= low and t + float(wire['t'].min()) < high)

    def _decode(self, data: memoryview) -> np.ndarray:
        offset = self._offset
        if len(data) != self._length or bytes(data[12:offset]) != self._alike:
            self._learn(data)
            offset = self._offset
        _, nanoseconds = _STAMP.unpack_from(data, 4)
        if nanoseconds >= 1_000_000_000:
            decode_table(data)
        count = (len(data) - offset) // max(self._wire.itemsize, 1)
        return np.frombuffer(data, self._wire, count, offset)

    def _learn(self, data: memoryview) -> None:
        """Check a message in full, and remember what is the same in the next ones."""
        table = decode_table(data)
        self._wire, self._dtype = table.rows.dtype, self._choose(table.rows.dtype)
        self._offset, self._length = table.data_offset, len(data)
        self._alike = bytes(data[12 : table.data_offset])

    def _choose(self, wire: np.dtype) -> np.dtype:
        names = wire.names or ()
        if names == SAMPLE_COLUMNS:
            available = {name: SAMPLES[name] for name in names}
        else:
            available = {'t': np.dtype(np.float64)}
            available.update({name: wire[name] for name in names if name != 't'})
        return _chosen(available, self._columns)


class MessageRows:
    """Rows of messages that are no tables: one each, or one for each value of diagnostics."""

    def __init__(self, type_name: str, columns: Sequence[str] | None) -> None:
        self._type_name = type_name
        self._columns = columns

    def read(self, data: memoryview, t: float, low: float, high: float) -> np.ndarray:
        """Return the rows, texts as wide as they need be; see `RowReader`."""
        if not low <= t < high:
            return np.empty(0, [('t', np.float64)])
        message = deserialize(data, self._type_name)
        rows = [{'t': t, **row} for row in self._rows(message)]
        if not rows:
            return np.empty(0, [('t', np.float64)])
        types = {name: _column_type([row[name] for row in rows]) for name in rows[0]}
        dtype = _chosen(types, self._columns)
        if len(rows) * dtype.itemsize > LARGEST_ROWS:
            raise MessageError(
                f'its {len(rows)} rows take {len(rows) * dtype.itemsize} bytes: '
                f'the limit is {LARGEST_ROWS}'
            )
        return np.array([tuple(row[name] for name in dtype.names or ()) for row in rows], dtype)

    def _rows(self, message: Any) -> Iterator[dict[str, Any]]:
        if self._type_name != 'diagnostic_msgs/msg/DiagnosticArray':
            values = dict(itertools.islice(_flatten(message, ''), MOST_VALUES + 1))
            if len(values) > MOST_VALUES:
                raise MessageError(f'it has more than {MOST_VALUES} values, which is the limit')
            yield values
            return
        for status in message.status:
            about = {'name': status.name, 'level': status.level, 'message': status.message}
            for value in status.values:
                yield {**about, 'key': value.key, 'value': value.value}


def _flatten(value: Any, name: str) -> Iterator[tuple[str, Any]]:
    """Iterate over the leaves of a message, with names such as accel.linear.x or position[0]."""
    if dataclasses.is_dataclass(value):
        for field in dataclasses.fields(value):
            if field.name not in ('header', '__msgtype__'):
                inner = f'{name}.{field.name}' if name else field.name
                yield from _flatten(getattr(value, field.name), inner)
    elif isinstance(value, list | np.ndarray):
        for number, item in enumerate(value):
            yield from _flatten(item, f'{name}[{number}]')
    else:
        yield name, value.item() if isinstance(value, np.generic) else value


def _column_type(values: Sequence[Any]) -> np.dtype:
    if isinstance(values[0], str):
        return np.dtype(f'U{max(1, *(len(value) for value in values))}')
    return np.asarray(values).dtype


def _chosen(available: dict[str, np.dtype], columns: Sequence[str] | None) -> np.dtype:
    for column in columns or ():
        if column not in available:
            raise LogError(f'there is no column {column!r}; there are {", ".join(available)}')
    return np.dtype([(name, available[name]) for name in columns or available])
