"""One MCAP file to read: by its index where that is sound, record by record otherwise."""

from __future__ import annotations

import dataclasses
import os
import struct
import zlib
from collections.abc import Callable, Collection, Iterator
from io import BytesIO
from pathlib import Path

from mcap.opcode import Opcode
from mcap.records import Channel, ChunkIndex, Metadata, Schema
from mcap.stream_reader import StreamReader
from mcap.summary import Summary
from mcap.writer import MCAP0_MAGIC

from gear_dynamics.bag.chunks import (
    LARGEST_RECORD,
    PARSE_ERRORS,
    RECORD,
    ChunkError,
    ChunkMessage,
    chunk_records,
    find_chunk,
    parse_record,
    unpack_chunk,
)
from gear_dynamics.bag.mcap_file import CONFIGURATION, configuration_checksum

_FOOTER = struct.Struct('<BQQQI')
_KNOWN = frozenset(Opcode)
_PARSED: dict[int, type] = {
    Opcode.CHANNEL: Channel,
    Opcode.SCHEMA: Schema,
    Opcode.METADATA: Metadata,
}


class LogError(ValueError):
    """A log cannot be read at all; the message says why."""


@dataclasses.dataclass(frozen=True)
class Damage:
    """A place in a log that could not be read.

    Attributes
    ----------
    path : Path
        The file.
    offset : int
        Byte at which it begins.
    reason : str
        What is wrong, and what was skipped.
    """

    path: Path
    offset: int
    reason: str

    def __str__(self) -> str:
        return f'{self.path.name}, byte {self.offset}: {self.reason}'


@dataclasses.dataclass(frozen=True)
class LogChannel:
    """A topic as a log has it: name, type, type hash, offered QoS profiles as YAML."""

    topic: str
    type_name: str
    type_hash: str
    qos: str


@dataclasses.dataclass(frozen=True)
class ReadMessage:
    """A message as it stands in a file; `data` is a view of the chunk at `offset`."""

    channel: LogChannel
    log_time: int
    publish_time: int
    data: memoryview
    offset: int


class McapSource:
    """An MCAP file, whole, cut or damaged.

    Parameters
    ----------
    path : Path
        The file.
    on_damage : callable
        Told of every place that cannot be read; reading goes on behind it.

    Raises
    ------
    LogError
        If the file cannot be opened.
    """

    def __init__(self, path: Path, on_damage: Callable[[Damage], None]) -> None:
        self.path = path
        self._on_damage = on_damage
        try:
            self.file = os.open(path, os.O_RDONLY | os.O_CLOEXEC)
            self.size = os.fstat(self.file).st_size
        except OSError as error:
            raise LogError(f'{path}: {error.strerror}') from None
        self.summary = self._read_summary()
        self._schemas: dict[int, Schema] = {}
        self._channels: dict[int, LogChannel] = {}
        for record in self._known_records():
            self._learn(record)

    def close(self) -> None:
        """Close the file."""
        os.close(self.file)

    @property
    def foreign(self) -> bool:
        """Whether neither its first bytes nor any others are those of an MCAP file."""
        return (
            self.summary is None
            and os.pread(self.file, len(MCAP0_MAGIC), 0) != MCAP0_MAGIC
            and find_chunk(self.file, 0, self.size) is None
        )

    def _known_records(self) -> list[Schema | Channel]:
        if self.summary is None:
            return []
        return [*self.summary.schemas.values(), *self.summary.channels.values()]

    @property
    def channels(self) -> dict[int, LogChannel]:
        """Channels by their number in the file; those met so far in a file without an index."""
        return self._channels

    def messages(
        self,
        topics: Collection[str] | None = None,
        start: int | None = None,
        end: int | None = None,
    ) -> Iterator[ReadMessage]:
        """Iterate over messages in the order of the file.

        Parameters
        ----------
        topics : collection of str, optional
            Only these topics.
        start, end : int, optional
            Only log times from `start` on and before `end` [ns].
        """
        for offset, content in self._chunks(topics, start, end):
            try:
                for record in chunk_records(unpack_chunk(content)):
                    if not isinstance(record, ChunkMessage):
                        self._learn(record)
                        continue
                    channel = self._channels.get(record.channel)
                    if channel is None:
                        raise ChunkError(
                            f'it has a message of the unknown channel {record.channel}'
                        )
                    if (
                        (topics is None or channel.topic in topics)
                        and (start is None or record.log_time >= start)
                        and (end is None or record.log_time < end)
                    ):
                        yield ReadMessage(
                            channel, record.log_time, record.publish_time, record.data, offset
                        )
            except ChunkError as error:
                self._damaged(offset, f'a chunk of {len(content)} bytes is lost: {error}')

    def configurations(self) -> Iterator[dict[str, str]]:
        """Iterate over the configurations that the run had, each with its `log_time` [ns]."""
        for offset, record in self._metadata():
            if record.name != CONFIGURATION:
                continue
            content = dict(record.metadata)
            if content.pop('crc32', None) == configuration_checksum(content):
                yield content
            else:
                self._damaged(offset, 'a configuration is lost: its CRC is wrong')

    def _metadata(self) -> Iterator[tuple[int, Metadata]]:
        if self.summary is None or not self.summary.metadata_indexes:
            places = ((o, c) for o, code, c in self.records() if code == Opcode.METADATA)
        else:
            places = (
                (index.offset, os.pread(self.file, index.length, index.offset)[RECORD.size :])
                for index in self.summary.metadata_indexes
            )
        for offset, content in places:
            try:
                yield offset, parse_record(Metadata, content)
            except ChunkError as error:
                self._damaged(offset, str(error))

    def _chunks(
        self, topics: Collection[str] | None, start: int | None, end: int | None
    ) -> Iterator[tuple[int, bytes | memoryview]]:
        """Iterate over offset and content of the chunks that can hold what is asked for."""
        if self.summary is None or not self.summary.chunk_indexes:
            for offset, opcode, content in self.records():
                if opcode == Opcode.CHUNK:
                    yield offset, content
                elif opcode == Opcode.SCHEMA:
                    self._learn(parse_record(Schema, content))
                elif opcode == Opcode.CHANNEL:
                    self._learn(parse_record(Channel, content))
            return
        for index in self.summary.chunk_indexes:
            if not self._wanted(index, topics, start, end):
                continue
            at, length = index.chunk_start_offset, index.chunk_length
            record = os.pread(self.file, length, at)
            if len(record) != length or record[:9] != RECORD.pack(Opcode.CHUNK, length - 9):
                self._damaged(at, f'a chunk of {length} bytes is lost: its header is damaged')
            else:
                yield at, memoryview(record)[RECORD.size :]

    def _wanted(
        self, index: ChunkIndex, topics: Collection[str] | None, start: int | None, end: int | None
    ) -> bool:
        if start is not None and index.message_end_time < start:
            return False
        if end is not None and index.message_start_time >= end:
            return False
        numbers = index.message_index_offsets
        return (
            topics is None
            or not numbers
            or any(n not in self._channels or self._channels[n].topic in topics for n in numbers)
        )

    def records(self) -> Iterator[tuple[int, int, bytes]]:
        """Walk over the records of the data section: offset, opcode, content; skips damage."""
        at = len(MCAP0_MAGIC)
        if self.foreign:
            self._damaged(0, 'this is no MCAP file')
            return
        if os.pread(self.file, at, 0) != MCAP0_MAGIC:
            self._damaged(0, 'the file does not begin as an MCAP file')
        while at < self.size:
            head = os.pread(self.file, RECORD.size, at)
            opcode, length = RECORD.unpack(head) if len(head) == RECORD.size else (0, 0)
            end = at + RECORD.size + length
            content = b''
            if opcode in _KNOWN and end <= self.size and length <= LARGEST_RECORD:
                content = os.pread(self.file, length, at + RECORD.size)
            if not _plausible(opcode, length, content):
                next_chunk = find_chunk(self.file, at + 1, self.size)
                if next_chunk is None:
                    break
                self._damaged(at, f'{next_chunk - at} bytes are lost: they are no records')
                at = next_chunk
                continue
            if opcode == Opcode.DATA_END:
                return
            yield at, opcode, content
            at = end
        lost = self.size - at
        self._damaged(at, f'the file is cut: {lost} bytes behind the last whole record are lost')

    def _learn(self, record: Schema | Channel) -> None:
        if isinstance(record, Schema):
            self._schemas[record.id] = record
        elif record.schema_id in self._schemas:
            self._channels[record.id] = LogChannel(
                topic=record.topic,
                type_name=self._schemas[record.schema_id].name,
                type_hash=record.metadata.get('topic_type_hash', ''),
                qos=record.metadata.get('offered_qos_profiles', ''),
            )

    def _read_summary(self) -> Summary | None:
        """Return the index if the file ends with one whose CRC is right."""
        tail_size = _FOOTER.size + len(MCAP0_MAGIC)
        tail = os.pread(self.file, tail_size, max(self.size - tail_size, 0))
        if len(tail) != tail_size or tail[_FOOTER.size :] != MCAP0_MAGIC:
            return None
        opcode, length, start, _, crc = _FOOTER.unpack_from(tail)
        end = self.size - tail_size
        if (opcode, length) != (
            Opcode.FOOTER,
            _FOOTER.size - 9,
        ) or not 0 < start <= end <= start + LARGEST_RECORD:
            return None
        summary = os.pread(self.file, end - start, start)
        if crc and zlib.crc32(tail[: _FOOTER.size - 4], zlib.crc32(summary)) != crc:
            self._damaged(start, 'the index is damaged: the file is read without it')
            return None
        return _parse_summary(summary + tail)

    def _damaged(self, offset: int, reason: str) -> None:
        self._on_damage(Damage(self.path, offset, reason))


def _plausible(opcode: int, length: int, content: bytes) -> bool:
    """Tell a record from damage by whether its inner lengths fit it."""
    if opcode not in _KNOWN or len(content) != length:
        return False
    if opcode == Opcode.CHUNK:
        return _chunk_fits(content)
    if opcode == Opcode.MESSAGE_INDEX:
        return length >= 6 and struct.unpack_from('<I', content, 2)[0] == length - 6
    if opcode in _PARSED:
        try:
            parse_record(_PARSED[opcode], content)
        except ChunkError:
            return False
        return True
    fixed = {Opcode.DATA_END: 4, Opcode.FOOTER: 20, Opcode.SUMMARY_OFFSET: 17}
    return length == fixed.get(Opcode(opcode), length)


def _chunk_fits(content: bytes) -> bool:
    """Check name length and data length of a chunk against its whole length."""
    if len(content) < 40:
        return False
    (name_length,) = struct.unpack_from('<I', content, 28)
    if 40 + name_length > len(content):
        return False
    (data_length,) = struct.unpack_from('<Q', content, 32 + name_length)
    return 40 + name_length + data_length == len(content)


def _parse_summary(data: bytes) -> Summary | None:
    """Parse the summary section with the mcap package; None if it is no index."""
    summary = Summary()
    places = {
        'Schema': lambda r: summary.schemas.update({r.id: r}),
        'Channel': lambda r: summary.channels.update({r.id: r}),
        'ChunkIndex': summary.chunk_indexes.append,
        'MetadataIndex': summary.metadata_indexes.append,
        'Statistics': lambda r: setattr(summary, 'statistics', r),
    }
    try:
        for record in StreamReader(BytesIO(data), skip_magic=True).records:
            places.get(type(record).__name__, lambda r: None)(record)
    except PARSE_ERRORS:
        return None
    return summary if summary.statistics else None
