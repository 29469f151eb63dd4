"""Chunks of MCAP bytes: unpack and check one, and find the next one behind damage."""

from __future__ import annotations

import dataclasses
import os
import re
import struct
import zlib
from collections.abc import Iterator
from io import BytesIO
from typing import TypeVar

import lz4.frame  # type: ignore[import-untyped]
import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Channel, Metadata, Schema

_Record = TypeVar('_Record', Channel, Schema, Metadata)

LARGEST_RECORD = 1 << 30
"""Bytes beyond which a record, or what it unpacks to, is taken for damaged, lest it exhaust the
memory."""

PARSE_ERRORS = (McapError, struct.error, ValueError, OverflowError, MemoryError)
"""What mcap's record classes raise on bytes that are no such record."""

RECORD = struct.Struct('<BQ')
_CHUNK = struct.Struct('<QQQI')
_MESSAGE = struct.Struct('<HIQQ')

_SEARCH_BLOCK = 1 << 22
# Opcode and length below 2^40, times, size and CRC, then one of three compression names.
_CHUNK_START = re.compile(
    rb'\x06(?=.{5}\x00{3}.{28}(?:\x00{4}|\x03\x00{3}lz4|\x04\x00{3}zstd))', re.DOTALL
)
_LONGEST_START = 9 + 28 + 4 + 4 + 8


class ChunkError(ValueError):
    """A chunk cannot be trusted; the message says why."""


@dataclasses.dataclass(frozen=True, slots=True)
class ChunkMessage:
    """A message in a chunk: channel number, times [ns] and a view of its bytes."""

    channel: int
    log_time: int
    publish_time: int
    data: memoryview


def unpack_chunk(content: bytes | memoryview) -> memoryview:
    """Return the records in a chunk record, decompressed and checked against its CRC.

    Raises
    ------
    ChunkError
        If sizes, compression or CRC do not hold.
    """
    size, crc, compression, data = _split(content)
    if size > LARGEST_RECORD:
        raise ChunkError(f'it claims {size} bytes')
    try:
        records = memoryview(_decompress(compression, data, size))
    except (zstandard.ZstdError, RuntimeError, MemoryError) as error:
        raise ChunkError(f'it does not decompress: {error}') from None
    if len(records) != size:
        raise ChunkError(f'it holds {len(records)} bytes instead of {size}')
    if crc and zlib.crc32(records) != crc:
        raise ChunkError('its CRC is wrong')
    return records


def _split(content: bytes | memoryview) -> tuple[int, int, str, memoryview]:
    try:
        _, _, size, crc = _CHUNK.unpack_from(content)
        (name_length,) = struct.unpack_from('<I', content, 28)
        name = bytes(content[32 : 32 + min(name_length, 16)]).decode()
        (data_length,) = struct.unpack_from('<Q', content, 32 + name_length)
    except (struct.error, UnicodeDecodeError):
        raise ChunkError('its header is damaged') from None
    if name not in ('', 'lz4', 'zstd') or 40 + name_length + data_length != len(content):
        raise ChunkError('its header is damaged')
    return size, crc, name, memoryview(content)[40 + name_length :]


def _decompress(compression: str, data: memoryview, size: int) -> bytes | memoryview:
    """Decompress into `size` bytes; a frame that claims another size is not tried."""
    if compression == 'zstd':
        claimed = zstandard.frame_content_size(data)
        if claimed not in (-1, size):
            raise ChunkError(f'it claims {claimed} bytes instead of {size}')
        return zstandard.ZstdDecompressor().decompress(data, max_output_size=size)
    if compression == 'lz4':
        claimed = lz4.frame.get_frame_info(data)['content_size']
        if claimed not in (0, size):
            raise ChunkError(f'it claims {claimed} bytes instead of {size}')
        return lz4.frame.decompress(data)
    return data


def chunk_records(records: memoryview) -> Iterator[ChunkMessage | Channel | Schema]:
    """Iterate over messages, channels and schemas of an unpacked chunk.

    Raises
    ------
    ChunkError
        At a record that is damaged, which only a chunk without a CRC can hold.
    """
    at = 0
    while at < len(records):
        try:
            opcode, length = RECORD.unpack_from(records, at)
        except struct.error:
            raise ChunkError('it ends inside a record') from None
        start, at = at + RECORD.size, at + RECORD.size + length
        if at > len(records):
            raise ChunkError('it ends inside a record')
        if opcode == Opcode.MESSAGE:
            if length < _MESSAGE.size:
                raise ChunkError('it holds a message record that is too short')
            channel, _, log_time, publish_time = _MESSAGE.unpack_from(records, start)
            data = records[start + _MESSAGE.size : at]
            yield ChunkMessage(channel, log_time, publish_time, data)
        elif opcode == Opcode.CHANNEL:
            yield parse_record(Channel, records[start:at])
        elif opcode == Opcode.SCHEMA:
            yield parse_record(Schema, records[start:at])


def parse_record(kind: type[_Record], content: bytes | memoryview) -> _Record:
    """Parse a channel, schema or metadata record, which must fill the bytes.

    Raises
    ------
    ChunkError
        If it does not.
    """
    stream = ReadDataStream(BytesIO(content))
    try:
        record = kind.read(stream)
    except PARSE_ERRORS as error:
        raise ChunkError(f'a {kind.__name__} record is damaged: {error!r}') from None
    if stream.count != len(content):
        raise ChunkError(f'a {kind.__name__} record is damaged')
    return record


def find_chunk(file: int, start: int, size: int) -> int | None:
    """Return the offset of the first chunk from `start` on that fits a file of `size` bytes."""
    while start < size:
        block = os.pread(file, _SEARCH_BLOCK + _LONGEST_START, start)
        if not block:
            return None
        for match in _CHUNK_START.finditer(block, 0, len(block)):
            at = start + match.start()
            if _is_chunk(block[match.start() : match.start() + _LONGEST_START], size - at):
                return at
        start += _SEARCH_BLOCK
    return None


def _is_chunk(head: bytes, available: int) -> bool:
    """Check the lengths in the head of a chunk against each other and against the file."""
    (length,) = struct.unpack_from('<Q', head, 1)
    (name_length,) = struct.unpack_from('<I', head, 37)
    if len(head) < 41 + name_length + 8:
        return False
    (data_length,) = struct.unpack_from('<Q', head, 41 + name_length)
    return length == 40 + name_length + data_length and 9 + length <= available
