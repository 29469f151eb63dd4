"""Records of MCAP bytes, checked: what the mcap package parses, and the messages in a chunk."""

from __future__ import annotations

import dataclasses
import struct
import zlib
from collections.abc import Iterator
from io import BytesIO
from typing import NamedTuple, TypeVar

from mcap.data_stream import ReadDataStream
from mcap.exceptions import EndOfFile, McapError
from mcap.opcode import Opcode
from mcap.records import (
    AttachmentIndex,
    Channel,
    ChunkIndex,
    Header,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)

from gear_dynamics.bag.decompress import DecompressionError, decompress

_Record = TypeVar('_Record', Channel, Schema, Metadata, Header)

LARGEST_RECORD = 1 << 27
"""Bytes beyond which a record that must be read at once is refused."""

MOST_PADDING = 1024
"""Bytes that later versions of the format may have appended to a record."""

PARSE_ERRORS = (McapError, struct.error, ValueError, OverflowError, MemoryError)
"""What mcap's record classes raise on bytes that are no such record."""

RECORD = struct.Struct('<BQ')
MESSAGE = struct.Struct('<HIQQ')
_CHUNK = struct.Struct('<QQQII')

_PARSED: dict[int, type] = {
    Opcode.HEADER: Header,
    Opcode.SCHEMA: Schema,
    Opcode.CHANNEL: Channel,
    Opcode.METADATA: Metadata,
    Opcode.CHUNK_INDEX: ChunkIndex,
    Opcode.ATTACHMENT_INDEX: AttachmentIndex,
    Opcode.STATISTICS: Statistics,
    Opcode.METADATA_INDEX: MetadataIndex,
    Opcode.SUMMARY_OFFSET: SummaryOffset,
}
"""Records that are checked by parsing them."""

SMALL = frozenset(_PARSED)
"""Opcodes of the records that are small enough to be read at once."""


class RecordError(ValueError):
    """A record cannot be trusted; the message says why."""


@dataclasses.dataclass(frozen=True, slots=True)
class ChunkHead:
    """What stands before the data of a chunk: log times [ns], sizes, CRC, compression."""

    start: int
    end: int
    size: int
    crc: int
    compression: str
    data_at: int
    data_length: int


class RawMessage(NamedTuple):
    """A message record: channel number, sequence, times [ns] and a view of its bytes."""

    channel: int
    sequence: int
    log_time: int
    publish_time: int
    data: memoryview


class _ExactStream(ReadDataStream):
    """Refuses to return fewer bytes than asked for."""

    def read(self, length: int) -> bytes:
        data = super().read(length)
        if len(data) != length:
            raise EndOfFile
        return data


def parse_record(kind: type[_Record], content: bytes | memoryview) -> _Record:
    """Parse the content of a record that is not a chunk, a message or an index of messages.

    Raises
    ------
    RecordError
        If the bytes are no such record.
    """
    stream = _ExactStream(BytesIO(content))
    try:
        record = kind.read(stream)
    except PARSE_ERRORS as error:
        raise RecordError(f'a {kind.__name__} record is damaged: {error!r}') from None
    if len(content) - stream.count > MOST_PADDING:
        raise RecordError(f'a {kind.__name__} record is damaged')
    return record


def is_plausible(opcode: int, length: int, content: bytes) -> bool:
    """Tell a record from damage by whether its inner lengths fit its length.

    Parameters
    ----------
    opcode, length : int
        Head of the record.
    content : bytes
        Its first bytes; all of them for the opcodes in `SMALL`.
    """
    if opcode in _PARSED:
        try:
            parse_record(_PARSED[opcode], content)
        except RecordError:
            return False
        return len(content) == length
    if opcode == Opcode.CHUNK:
        try:
            chunk_head(content, length)
        except RecordError:
            return False
        return True
    if opcode == Opcode.MESSAGE_INDEX:
        return length >= 6 and _fits(6 + struct.unpack_from('<I', content, 2)[0], length)
    if opcode == Opcode.MESSAGE:
        # A single flipped bit makes an index of messages look like a message.
        return length >= MESSAGE.size and not (
            length % 16 == 6 and struct.unpack_from('<I', content, 2)[0] == length - 6
        )
    if opcode == Opcode.DATA_END:
        return _fits(4, length)
    if opcode == Opcode.ATTACHMENT:
        return length >= 32
    return opcode not in (0, Opcode.FOOTER)


def _fits(needed: int, length: int) -> bool:
    return needed <= length <= needed + MOST_PADDING


def chunk_head(content: bytes | memoryview, length: int) -> ChunkHead:
    """Return the head of a chunk record of a length, from its first bytes.

    Raises
    ------
    RecordError
        If its inner lengths do not fit.
    """
    try:
        start, end, size, crc, name_length = _CHUNK.unpack_from(content)
        name = bytes(content[_CHUNK.size : _CHUNK.size + min(name_length, 16)]).decode()
        (data_length,) = struct.unpack_from('<Q', content, _CHUNK.size + name_length)
    except (struct.error, UnicodeDecodeError):
        raise RecordError('its header is damaged') from None
    data_at = _CHUNK.size + name_length + 8
    if not _fits(data_at + data_length, length):
        raise RecordError('its header is damaged')
    return ChunkHead(start, end, size, crc, name, data_at, data_length)


def unpack_chunk(content: bytes | memoryview) -> memoryview:
    """Return the records in a chunk record, decompressed and checked against its CRC.

    Raises
    ------
    RecordError
        If sizes, compression or CRC do not hold.
    """
    head = chunk_head(content, len(content))
    data = memoryview(content)[head.data_at : head.data_at + head.data_length]
    try:
        records = memoryview(decompress(head.compression, data, head.size))
    except DecompressionError as error:
        raise RecordError(str(error)) from None
    if head.crc and zlib.crc32(records) != head.crc:
        raise RecordError('its CRC is wrong')
    return records


def iter_records(records: memoryview) -> Iterator[RawMessage | Channel | Schema]:
    """Iterate over messages, channels and schemas in bytes that hold whole records.

    A loop of our own: the mcap package copies each message and does not notice a cut one.

    Raises
    ------
    RecordError
        At a record that is damaged, which only a chunk without a CRC can hold.
    """
    at = 0
    while at < len(records):
        try:
            opcode, length = RECORD.unpack_from(records, at)
        except struct.error:
            raise RecordError('it ends inside a record') from None
        start, at = at + RECORD.size, at + RECORD.size + length
        if at > len(records):
            raise RecordError('it ends inside a record')
        if opcode == Opcode.MESSAGE:
            if length < MESSAGE.size:
                raise RecordError('it holds a message record that is too short')
            fields = MESSAGE.unpack_from(records, start)
            yield RawMessage._make((*fields, records[start + MESSAGE.size : at]))
        elif opcode == Opcode.CHANNEL:
            yield parse_record(Channel, records[start:at])
        elif opcode == Opcode.SCHEMA:
            yield parse_record(Schema, records[start:at])
