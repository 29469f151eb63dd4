"""The index at the end of an MCAP file, if it is sound."""

from __future__ import annotations

import dataclasses
import struct
import zlib
from collections.abc import Callable
from io import BytesIO

from mcap.opcode import Opcode
from mcap.records import Channel, ChunkIndex, Schema, Statistics
from mcap.stream_reader import StreamReader
from mcap.writer import MCAP0_MAGIC

from gear_dynamics.bag.records import PARSE_ERRORS
from gear_dynamics.portable import pread

LARGEST_INDEX = 1 << 26
"""Bytes of an index beyond which the file is read without it."""

_FOOTER = struct.Struct('<BQQQI')
_TAIL_SIZE = _FOOTER.size + len(MCAP0_MAGIC)


@dataclasses.dataclass(frozen=True)
class Index:
    """Content of the summary section of a file.

    Attributes
    ----------
    schemas : dict of int to Schema
    channels : dict of int to Channel
    chunks : dict of int to ChunkIndex
        By the byte at which the chunk begins; they are within the data and do not overlap.
    statistics : Statistics or None
    start : int
        Byte at which the section begins, behind all messages.
    """

    schemas: dict[int, Schema]
    channels: dict[int, Channel]
    chunks: dict[int, ChunkIndex]
    statistics: Statistics | None
    start: int

    @property
    def complete(self) -> bool:
        """Whether all channels and the number of their messages can be taken from it."""
        about = self.statistics
        return (
            about is not None
            and len(self.chunks) == about.chunk_count
            and len(self.channels) == about.channel_count
            and set(about.channel_message_counts) <= set(self.channels)
            and sum(about.channel_message_counts.values()) == about.message_count
            and all(c.schema_id in (0, *self.schemas) for c in self.channels.values())
        )


def read_index(file: int, size: int, tell: Callable[[int, str], None]) -> Index | None:
    """Return the index of a file, None if it has none that is sound.

    Parameters
    ----------
    file, size : int
        Descriptor, and bytes of the file.
    tell : callable
        Called with the byte and the reason where an index is damaged.
    """
    tail = pread(file, _TAIL_SIZE, max(size - _TAIL_SIZE, 0))
    if len(tail) != _TAIL_SIZE or tail[_FOOTER.size :] != MCAP0_MAGIC:
        return None
    opcode, length, start, _, crc = _FOOTER.unpack_from(tail)
    end = size - _TAIL_SIZE
    if (opcode, length) != (Opcode.FOOTER, _FOOTER.size - 9) or not start:
        return None
    if not len(MCAP0_MAGIC) <= start <= end or end - start > LARGEST_INDEX:
        tell(end, f'the index is said to begin at byte {start}: the file is read without it')
        return None
    summary = pread(file, end - start, start)
    if crc and zlib.crc32(tail[: _FOOTER.size - 4], zlib.crc32(summary)) != crc:
        tell(start, 'the index is damaged: the file is read without it')
        return None
    index = _parse(summary + tail, start)
    if index is None or not _sound(index):
        tell(start, 'the index contradicts itself or the file: the file is read without it')
        return None
    return index


def _parse(data: bytes, start: int) -> Index | None:
    """Parse the summary section with the mcap package; None if it is no index."""
    index = Index({}, {}, {}, None, start)
    try:
        # Chunks have no place here: they are not unpacked.
        reader = StreamReader(
            BytesIO(data), skip_magic=True, emit_chunks=True, record_size_limit=LARGEST_INDEX
        )
        for record in reader.records:
            if isinstance(record, Schema):
                index.schemas[record.id] = record
            elif isinstance(record, Channel):
                index.channels[record.id] = record
            elif isinstance(record, ChunkIndex):
                if record.chunk_start_offset in index.chunks:
                    return None
                index.chunks[record.chunk_start_offset] = record
            elif isinstance(record, Statistics):
                index = dataclasses.replace(index, statistics=record)
    except PARSE_ERRORS:
        return None
    return index


def _sound(index: Index) -> bool:
    """Check that the chunks lie within the data, one behind the other."""
    at = len(MCAP0_MAGIC)
    for start in sorted(index.chunks):
        chunk = index.chunks[start]
        if (
            start < at
            or chunk.chunk_length < 9
            or chunk.message_start_time > chunk.message_end_time
        ):
            return False
        at = start + chunk.chunk_length + chunk.message_index_length
    return at <= index.start
