"""Tables as sensor_msgs/PointCloud2: structured arrays to CDR bytes and back."""

from __future__ import annotations

import dataclasses
import functools
import struct
from typing import Any

import numpy as np

from gear_dynamics.machine.columns import SAMPLE_COLUMNS
from gear_dynamics.wire.messages import MessageError, deserialize, message_class, serialize
from gear_dynamics.wire.topics import TABLE_TYPE

SAMPLES_FLOAT32 = np.dtype([(name, np.float32) for name in SAMPLE_COLUMNS])
"""The columns of `gear_pair/samples` on the wire; t is in seconds since the header stamp."""

# sensor_msgs/PointField: INT8 = 1 ... FLOAT64 = 8
_DATATYPES: dict[int, np.dtype] = {
    1: np.dtype('<i1'),
    2: np.dtype('<u1'),
    3: np.dtype('<i2'),
    4: np.dtype('<u2'),
    5: np.dtype('<i4'),
    6: np.dtype('<u4'),
    7: np.dtype('<f4'),
    8: np.dtype('<f8'),
}
_DATATYPE_NUMBERS = {dtype: number for number, dtype in _DATATYPES.items()}

_STAMP = struct.Struct('<iI')
_WIDTH = struct.Struct('<I')
_SIZES = struct.Struct('<II')


MOST_COLUMNS = 1024
"""Columns beyond which a table that arrives is refused."""

LARGEST_ROW = 1 << 20
"""Bytes of a row of a table that arrives."""

LONGEST_NAME = 256
"""Characters of the name of a column that arrives."""


class TableError(ValueError):
    """An array cannot become a table, or bytes are no table; the message says why."""


@dataclasses.dataclass(frozen=True)
class DecodedTable:
    """A decoded table.

    Attributes
    ----------
    stamp_ns : int
        Header stamp [ns].
    frame_id : str
        Frame of the header.
    rows : ndarray
        Structured, one field a column; a view of the message bytes, hence read-only.
    data_offset : int
        Where in the message bytes the rows begin.
    """

    stamp_ns: int
    frame_id: str
    rows: np.ndarray
    data_offset: int


def encode_table(rows: np.ndarray, stamp_ns: int, frame_id: str) -> bytes:
    """Return the CDR bytes of a PointCloud2 of height 1 with one field a column.

    Parameters
    ----------
    rows : ndarray
        One-dimensional and structured, of integers up to 32 bits and floats.
    stamp_ns : int
        Header stamp [ns].
    frame_id : str
        Frame of the header.

    Raises
    ------
    TableError
        If the array has another shape or a column that PointCloud2 cannot hold, or the stamp
        is out of range.
    """
    if rows.ndim != 1:
        raise TableError(f'a table of shape {rows.shape} must have one dimension')
    template = _template(rows.dtype, frame_id)
    try:
        stamp = _STAMP.pack(*divmod(stamp_ns, 1_000_000_000))
    except struct.error:
        raise TableError(f'stamp {stamp_ns} ns is out of range: seconds must fit 32 bits') from None
    if rows.dtype is not template.dtype and rows.dtype != template.dtype:
        rows = rows.astype(template.dtype)
    data = rows.tobytes()
    return b''.join(
        (
            template.encapsulation,
            stamp,
            template.frame,
            _WIDTH.pack(len(rows)),
            template.fields,
            _SIZES.pack(len(data), len(data)),
            data,
            template.end,
        )
    )


def decode_table(data: bytes | memoryview) -> DecodedTable:
    """Return the table that the CDR bytes of a PointCloud2 hold, without copying the rows.

    Raises
    ------
    TableError
        If the bytes are cut, are no PointCloud2, or its sizes, fields or byte order are not
        those of a table.
    """
    count = _field_count(memoryview(data))
    if count > MOST_COLUMNS:
        raise TableError(f'the message has {count} fields: the limit is {MOST_COLUMNS}')
    try:
        cloud = deserialize(memoryview(data), TABLE_TYPE)
    except MessageError as error:
        raise TableError(str(error)) from None
    stamp, frame_id = cloud.header.stamp, cloud.header.frame_id
    if stamp.sec < 0:
        raise TableError(f'header.stamp.sec is {stamp.sec}: a stamp must not be before 1970')
    if stamp.nanosec >= 1_000_000_000:
        raise TableError(f'header.stamp.nanosec is {stamp.nanosec}: it must be below 1e9')
    if cloud.is_bigendian:
        raise TableError('the rows are big-endian: a table must be little-endian')
    if cloud.height != 1:
        raise TableError(f'height is {cloud.height}: a table has height 1')
    columns = tuple((f.name, f.offset, f.datatype, f.count) for f in cloud.fields)
    dtype = _dtype(columns, cloud.point_step)
    expected = cloud.width * cloud.point_step
    if cloud.row_step != expected or len(cloud.data) != expected:
        raise TableError(
            f'row_step is {cloud.row_step} and there are {len(cloud.data)} bytes of rows: '
            f'{cloud.width} rows of {cloud.point_step} bytes make {expected}'
        )
    return DecodedTable(
        stamp_ns=stamp.sec * 1_000_000_000 + stamp.nanosec,
        frame_id=frame_id,
        rows=np.frombuffer(cloud.data, dtype, cloud.width),
        data_offset=_data_offset(columns, len(frame_id.encode())),
    )


def _field_count(data: memoryview) -> int:
    """Return how many fields a cloud claims to have, before any is decoded."""
    if len(data) < 16:
        return 0  # too short for a cloud, which decoding will tell
    order: Any = 'little' if data[1] & 1 else 'big'
    at = _aligned(16 + int.from_bytes(data[12:16], order)) + 8
    return int.from_bytes(data[at : at + 4], order)


def columns_as_float32(samples: np.ndarray, t0: float) -> np.ndarray:
    """Return samples as they are published: float32, t [s] relative to `t0`.

    Parameters
    ----------
    samples : ndarray
        Of dtype SAMPLES.
    t0 : float
        Time of the header stamp [s], in the same count as the column t.
    """
    values = np.ascontiguousarray(samples).view(np.float64).reshape(-1, len(SAMPLE_COLUMNS))
    published = values.astype(np.float32)
    published[:, 0] = values[:, 0] - t0
    return published.view(SAMPLES_FLOAT32).reshape(-1)


@dataclasses.dataclass(frozen=True)
class _Template:
    dtype: np.dtype
    encapsulation: bytes
    frame: bytes
    fields: bytes
    end: bytes


@functools.lru_cache(maxsize=256)
def _template(dtype: np.dtype, frame_id: str) -> _Template:
    """Cut an encoded empty table where stamp, width and rows go."""
    packed, offsets = _packed(dtype)
    time = message_class('builtin_interfaces/msg/Time')(0, 0)
    field_class = message_class('sensor_msgs/msg/PointField')
    fields = [
        field_class(name, offset, _DATATYPE_NUMBERS[packed[name]], 1)
        for name, offset in offsets.items()
    ]
    cloud = message_class(TABLE_TYPE)(
        header=message_class('std_msgs/msg/Header')(time, frame_id),
        height=1,
        width=0,
        fields=fields,
        is_bigendian=False,
        point_step=packed.itemsize,
        row_step=0,
        data=np.empty(0, np.uint8),
        is_dense=True,
    )
    try:
        encoded = serialize(cloud)
    except MessageError as error:
        raise TableError(str(error)) from None
    width_at = _aligned(16 + len(frame_id.encode()) + 1) + 4
    sizes_at = len(encoded) - 1 - _SIZES.size
    return _Template(
        packed,
        encoded[:4],
        encoded[12:width_at],
        encoded[width_at + 4 : sizes_at],
        encoded[-1:],
    )


def _packed(dtype: np.dtype) -> tuple[np.dtype, dict[str, int]]:
    """Return the little-endian form without gaps, and the offset of each column in it."""
    if not dtype.names:
        raise TableError(f'a table of {dtype} must be a structured array with named columns')
    for name in dtype.names:
        if dtype[name].newbyteorder('<') not in _DATATYPE_NUMBERS:
            raise TableError(
                f'column {name!r} is {dtype[name]}: PointCloud2 holds int8 to int32, '
                'uint8 to uint32, float32 and float64'
            )
    columns = [(name, dtype[name].newbyteorder('<')) for name in dtype.names]
    sizes = [column[1].itemsize for column in columns]
    starts = np.cumsum([0, *sizes[:-1]]).tolist()
    return np.dtype(columns), dict(zip(dtype.names, starts, strict=True))


@functools.lru_cache(maxsize=256)
def _dtype(columns: tuple[tuple[str, int, int, int], ...], point_step: int) -> np.dtype:
    if not columns:
        raise TableError('the message has no fields: a table has one or more columns')
    for name, offset, datatype, count in columns:
        if not 0 < len(name) <= LONGEST_NAME or not name.isprintable():
            raise TableError(
                f'a column is named {name[:20]!r}: a name has 1 to {LONGEST_NAME} printable '
                'characters'
            )
        if datatype not in _DATATYPES:
            raise TableError(f'column {name!r} has datatype {datatype}: known are 1 to 8')
        if count != 1:
            raise TableError(f'column {name!r} has count {count}: a column has one value a row')
        if offset + _DATATYPES[datatype].itemsize > point_step:
            raise TableError(
                f'column {name!r} at offset {offset} does not fit point_step {point_step}'
            )
    layout: dict[str, Any] = {
        'names': [column[0] for column in columns],
        'formats': [_DATATYPES[column[2]] for column in columns],
        'offsets': [column[1] for column in columns],
        'itemsize': point_step,
    }
    if point_step > LARGEST_ROW:
        raise TableError(f'point_step is {point_step}: the limit is {LARGEST_ROW} bytes')
    try:
        return np.dtype(layout)  # type: ignore[call-overload]
    except ValueError as error:
        raise TableError(f'the columns make no table: {error}') from None


@functools.lru_cache(maxsize=256)
def _data_offset(columns: tuple[tuple[str, int, int, int], ...], frame_length: int) -> int:
    """Follow the CDR layout of PointCloud2 up to its rows."""
    at = _aligned(16 + frame_length + 1) + 12
    for name, *_ in columns:
        at = _aligned(_aligned(at) + 4 + len(name.encode()) + 1) + 4
        at = _aligned(at + 1) + 4
    return _aligned(at + 1) + 12


def _aligned(position: int) -> int:
    """Round up to 4; the 4 bytes of encapsulation shift nothing."""
    return (position + 3) & ~3
