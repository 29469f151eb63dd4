"""A chunk of an MCAP file under construction."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable

import lz4.frame  # type: ignore[import-untyped]
import numpy as np
import zstandard
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import Channel, ChunkIndex, Schema

COMPRESSIONS: dict[str, Callable[[bytes], bytes]] = {
    'none': bytes,
    'lz4': lz4.frame.compress,
    'zstd': zstandard.ZstdCompressor(level=1).compress,
}
"""Compressions by name, and the functions that compress.

On vibration in float32, level 1 of zstd leaves fewer bytes than its default, level 3, and is
faster."""

_MESSAGE = struct.Struct('<BQHIQQ')
_CHUNK = struct.Struct('<BQQQQI')
_INDEX = struct.Struct('<BQHI')


class ChunkBuilder:
    """Gathers records and makes them into a chunk record with its message indexes.

    The mcap package's own writer compresses at the default level of zstd and takes twice as long;
    and a chunk that the disk refused stays in its index.

    Parameters
    ----------
    compression : str
        'none', 'lz4' or 'zstd'.
    """

    def __init__(self, compression: str) -> None:
        self._name = '' if compression == 'none' else compression
        self._compress = COMPRESSIONS[compression]
        self.clear()

    def clear(self) -> None:
        """Begin anew."""
        self._parts: list[bytes] = []
        self._indexes: dict[int, list[tuple[int, int]]] = {}
        self.size = 0

    @property
    def counts(self) -> dict[int, int]:
        """Messages of each channel."""
        return {channel: len(index) for channel, index in self._indexes.items()}

    def add_record(self, record: Schema | Channel) -> None:
        """Append a schema or a channel."""
        builder = RecordBuilder()
        record.write(builder)
        self._append(builder.end())

    def add_message(
        self, channel: int, sequence: int, log_time: int, publish_time: int, data: bytes
    ) -> None:
        """Append a message; times in ns."""
        self._indexes.setdefault(channel, []).append((log_time, self.size))
        length = _MESSAGE.size - 9 + len(data)
        self._append(
            _MESSAGE.pack(Opcode.MESSAGE, length, channel, sequence, log_time, publish_time)
        )
        self._append(data)

    def _append(self, part: bytes) -> None:
        self._parts.append(part)
        self.size += len(part)

    def build(self, offset: int) -> tuple[list[bytes], ChunkIndex]:
        """Return the bytes of chunk and message indexes, and their entry in the file's index.

        The bytes come in parts, which need not be joined to be written.

        Parameters
        ----------
        offset : int
            Where in the file they go.
        """
        records = b''.join(self._parts)
        data = self._compress(records)
        size = len(data)
        head, start, end = self._head(zlib.crc32(records), size)
        parts, places = [head, data], {}
        chunk_length = len(head) + size
        at = offset + chunk_length
        for channel, index in self._indexes.items():
            places[channel] = at
            entries = np.array(index, np.uint64).tobytes()
            opening = _INDEX.pack(Opcode.MESSAGE_INDEX, 6 + len(entries), channel, len(entries))
            parts.append(opening + entries)
            at += len(parts[-1])
        index_entry = ChunkIndex(
            message_start_time=start,
            message_end_time=end,
            chunk_start_offset=offset,
            chunk_length=chunk_length,
            message_index_offsets=places,
            message_index_length=at - offset - chunk_length,
            compression=self._name,
            compressed_size=size,
            uncompressed_size=self.size,
        )
        return parts, index_entry

    def _head(self, crc: int, size: int) -> tuple[bytes, int, int]:
        """Return what stands before `size` bytes of data, and the first and last log time."""
        times = [time for index in self._indexes.values() for time, _ in index]
        start, end = min(times), max(times)
        name = self._name.encode()
        length = _CHUNK.size - 9 + 4 + len(name) + 8 + size
        head = _CHUNK.pack(Opcode.CHUNK, length, start, end, self.size, crc)
        return head + struct.pack('<I', len(name)) + name + struct.pack('<Q', size), start, end
