"""The walk over the records of an MCAP file, whole, cut or damaged."""

from __future__ import annotations

import dataclasses
import re
import struct
from collections.abc import Callable, Iterator

from mcap.opcode import Opcode
from mcap.writer import MCAP0_MAGIC

from gear_dynamics.bag.index import Index
from gear_dynamics.bag.records import (
    LARGEST_RECORD,
    RECORD,
    SMALL,
    RecordError,
    chunk_head,
    is_plausible,
)
from gear_dynamics.portable import pread

_HEAD = 64
"""First bytes of a record's content, which show whether its inner lengths fit."""

_KNOWN = frozenset(Opcode)
_PRIVATE = 0x80
"""From this opcode on, a record is an application's own: no reader knows more of it."""

_SEARCH_BLOCK = 1 << 22
# Opcode and length below 2^40, times, size and CRC, then one of three compression names.
_CHUNK_START = re.compile(
    rb'\x06(?=.{5}\x00{3}.{28}(?:\x00{4}|\x03\x00{3}lz4|\x04\x00{3}zstd))', re.DOTALL
)
_LONGEST_START = 9 + 28 + 4 + 4 + 8


@dataclasses.dataclass(frozen=True, slots=True)
class Place:
    """A record in a file: byte at which it begins, opcode, length and beginning of its content.

    `content` is complete for the opcodes in `records.SMALL`.
    """

    offset: int
    opcode: int
    length: int
    content: bytes

    @property
    def end(self) -> int:
        """Byte at which the next record begins."""
        return self.offset + RECORD.size + self.length


class Walk:
    """An iterator over the records of a file that continues behind damage.

    Parameters
    ----------
    file, size : int
        Descriptor, and bytes of the file.
    index : Index or None
        A sound index, by which chunks are found again behind damage.
    tell : callable
        Called for each damaged place: byte, reason, and whether messages may have been lost.

    Attributes
    ----------
    complete : bool
        Whether the end of the file was reached, and is that of an MCAP file.
    """

    def __init__(
        self, file: int, size: int, index: Index | None, tell: Callable[[int, str, bool], None]
    ) -> None:
        self._file = file
        self._size = size
        self._index = index
        self._chunks = {} if index is None else index.chunks
        self._limit = size if index is None else index.start
        self._tell = tell
        self._data_ended = False
        self._unknown: dict[int, tuple[int, int]] = {}  # opcode: first offset, how many
        self.complete = False

    def __iter__(self) -> Iterator[Place]:
        at = len(MCAP0_MAGIC)
        if pread(self._file, at, 0) != MCAP0_MAGIC:
            self._tell(0, 'the file does not begin as an MCAP file', False)
        while at < self._limit:
            place = self._place(at)
            if place is None:
                found = self._next_chunk(at + 1)
                if found is None:
                    break
                self._tell(at, f'{found - at} bytes are lost: they are no records', True)
                at = found
                continue
            if place.opcode == Opcode.FOOTER:
                self.complete = True
                break
            self._data_ended |= place.opcode == Opcode.DATA_END
            if place.opcode in _KNOWN:
                yield place
            else:
                first, count = self._unknown.get(place.opcode, (at, 0))
                self._unknown[place.opcode] = first, count + 1
            at = self._behind(place)
        self.complete |= self._index is not None
        self._tell_end(at)

    def _place(self, at: int) -> Place | None:
        """Return the record at a byte, None if there is none."""
        head = pread(self._file, RECORD.size + _HEAD, at)
        if len(head) < RECORD.size:
            return None
        opcode, length = RECORD.unpack_from(head)
        content = head[RECORD.size : RECORD.size + min(length, _HEAD)]
        end = at + RECORD.size + length
        if opcode == Opcode.FOOTER:
            ends = end + len(MCAP0_MAGIC) == self._size and length >= 20
            ends = ends and pread(self._file, len(MCAP0_MAGIC), end) == MCAP0_MAGIC
            return Place(at, opcode, length, content) if ends else None
        if end > self._limit:
            return None
        known = self._chunks.get(at)
        if known and (opcode, RECORD.size + length) != (Opcode.CHUNK, known.chunk_length):
            return None
        if opcode in SMALL and length > _HEAD:
            if length > LARGEST_RECORD:
                return None
            content = pread(self._file, length, at + RECORD.size)
        return Place(at, opcode, length, content) if is_plausible(opcode, length, content) else None

    def _behind(self, place: Place) -> int:
        """Return where to go on; the indexes of messages behind a chunk can be passed over."""
        known = self._chunks.get(place.offset)
        return place.end + (known.message_index_length if known else 0)

    def _next_chunk(self, start: int) -> int | None:
        """Return where to go on behind damage: at the next chunk, or at the index."""
        if self._index is not None:
            return min((at for at in self._chunks if at >= start), default=self._limit)
        return find_chunk(self._file, start, self._size)

    def _tell_end(self, at: int) -> None:
        for opcode, (first, count) in self._unknown.items():
            reason = f'{count} records of the unknown kind {opcode} are skipped'
            self._tell(first, reason, opcode < _PRIVATE)
        if not self.complete:
            lost = self._size - at
            reason = 'the file was not closed: it ends behind a whole record'
            if lost:
                reason = f'the file is cut: {lost} bytes behind the last whole record are lost'
            self._tell(at, reason, bool(lost) and not self._data_ended)


def find_chunk(file: int, start: int, size: int) -> int | None:
    """Return the offset of the first chunk from `start` on that fits a file of `size` bytes."""
    while start < size:
        block = pread(file, _SEARCH_BLOCK + _LONGEST_START, start)
        if not block:
            return None
        for match in _CHUNK_START.finditer(block):
            at = start + match.start()
            if _is_chunk(block[match.start() : match.start() + _LONGEST_START], size - at):
                return at
        start += _SEARCH_BLOCK
    return None


def _is_chunk(head: bytes, available: int) -> bool:
    """Check the lengths in the head of a chunk against each other and against the file."""
    (length,) = struct.unpack_from('<Q', head, 1)
    try:
        chunk_head(head[RECORD.size :], length)
    except RecordError:
        return False
    return RECORD.size + length <= available
