"""One MCAP file to read, whole, cut or damaged."""

from __future__ import annotations

import dataclasses
import functools
import os
from collections.abc import Callable, Collection, Iterator
from pathlib import Path

from mcap.opcode import Opcode
from mcap.records import Channel, ChunkIndex, Header, Metadata, Schema

from gear_dynamics.bag.channel import ChannelCount, Damage, LogChannel, LogError, ReadMessage
from gear_dynamics.bag.decompress import (
    ZSTD_MAGIC,
    DecompressionError,
    decompress_message,
)
from gear_dynamics.bag.index import read_index
from gear_dynamics.bag.mcap_file import CONFIGURATION, configuration_checksum
from gear_dynamics.bag.open_file import foreign_kind, open_file
from gear_dynamics.bag.records import (
    LARGEST_RECORD,
    MESSAGE,
    RECORD,
    RawMessage,
    RecordError,
    chunk_head,
    iter_records,
    parse_record,
    unpack_chunk,
)
from gear_dynamics.bag.walk import Place, Walk
from gear_dynamics.portable import pread

_LOOSE_SIZE = 1 << 20
"""Bytes of messages outside chunks that are read at once."""

LONGEST_NAME = 4096
"""Characters of a topic, a type or an encoding."""


@dataclasses.dataclass(slots=True)
class Segment:
    """Bytes of a file that are read at once: a chunk, or a run of messages outside chunks.

    Attributes
    ----------
    source : McapSource
        The file.
    offset, length : int
        Where the records are [bytes].
    start, end : int
        Log times of the first and last message [ns].
    size : int
        Bytes in memory.
    index : ChunkIndex or None
        Entry of the chunk in the index.
    is_chunk : bool
    """

    source: McapSource
    offset: int
    length: int
    start: int
    end: int
    size: int
    index: ChunkIndex | None = None
    is_chunk: bool = True


class McapSource:
    """An MCAP file, whole, cut or damaged; one that is compressed as a whole as well.

    Opening it walks over its records without unpacking any chunk.

    Parameters
    ----------
    path : Path
        The file.
    on_damage : callable
        Called with every place that cannot be read; reading continues behind it.

    Attributes
    ----------
    index : Index or None
        The index at the end of the file, if it is sound.
    segments : list of Segment
        Where messages are, in the order of the file.
    complete : bool
        Whether the file has an end, as it is written when a log is closed.
    foreign : str
        Description of a file that is no MCAP file; empty otherwise.
    profile : str or None
        Of the file, as 'ros2'; None where its header is lost.

    Raises
    ------
    LogError
        If the file cannot be opened.
    """

    def __init__(self, path: Path, on_damage: Callable[[Damage], None]) -> None:
        self.path = path
        self._on_damage = on_damage
        self._schemas: dict[int, Schema] = {}
        self._channels: dict[int, LogChannel] = {}
        self._metadata: list[tuple[int, Metadata]] = []
        self.segments: list[Segment] = []
        self.complete = False
        self.profile: str | None = None
        try:
            self.file = open_file(path)
        except OSError as error:
            raise LogError(f'{path}: {error.strerror}') from None
        try:
            self.size = os.fstat(self.file).st_size
            self.index = read_index(
                self.file, self.size, lambda at, why: self._damaged(at, why, False)
            )
            if self.index is not None:
                for schema in self.index.schemas.values():
                    self._learn(schema, self.index.start)
                for channel in self.index.channels.values():
                    self._learn(channel, self.index.start)
            self.foreign = '' if self.index is not None else foreign_kind(self.file, self.size)
            if not self.foreign:
                self._walk()
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Close the file."""
        os.close(self.file)

    @property
    def channels(self) -> dict[int, LogChannel]:
        """Channels by their number in the file; those met so far in a file without an index."""
        return self._channels

    def _walk(self) -> None:
        walk = Walk(self.file, self.size, self.index, self._damaged)
        for place in walk:
            if place.opcode == Opcode.CHUNK:
                self._add_chunk(place)
            elif place.opcode == Opcode.MESSAGE:
                self._add_loose(place)
            elif place.opcode == Opcode.HEADER:
                self.profile = parse_record(Header, place.content).profile
            elif place.opcode == Opcode.SCHEMA:
                self._learn(parse_record(Schema, place.content), place.offset)
            elif place.opcode == Opcode.CHANNEL:
                self._learn(parse_record(Channel, place.content), place.offset)
            elif place.opcode == Opcode.METADATA:
                self._metadata.append((place.offset, parse_record(Metadata, place.content)))
        self.complete = walk.complete

    def _add_chunk(self, place: Place) -> None:
        head = chunk_head(place.content, place.length)
        index = self.index.chunks.get(place.offset) if self.index is not None else None
        times = index or head
        start, end = (
            (times.message_start_time, times.message_end_time)
            if isinstance(times, ChunkIndex)
            else (times.start, times.end)
        )
        length = RECORD.size + place.length
        if length > LARGEST_RECORD:
            self._damaged(
                place.offset,
                f'a chunk of {place.length} bytes is lost: the limit is {LARGEST_RECORD}',
            )
            return
        size = length + head.size
        self.segments.append(Segment(self, place.offset, length, start, end, size, index))

    def _add_loose(self, place: Place) -> None:
        """Take a message outside chunks, together with those before it if it follows them."""
        length = RECORD.size + place.length
        if length > LARGEST_RECORD:
            self._damaged(
                place.offset,
                f'a message of {place.length} bytes is lost: the limit is {LARGEST_RECORD}',
            )
            return
        _, _, time, _ = MESSAGE.unpack_from(place.content)
        last = self.segments[-1] if self.segments else None
        if (
            last is not None
            and not last.is_chunk
            and last.offset + last.length == place.offset
            and last.length + length <= _LOOSE_SIZE
        ):
            last.length += length
            last.size += length
            last.start, last.end = min(last.start, time), max(last.end, time)
        else:
            loose = Segment(self, place.offset, length, time, time, length, is_chunk=False)
            self.segments.append(loose)

    def wanted(
        self, topics: Collection[str] | None, start: int | None, end: int | None
    ) -> Iterator[Segment]:
        """Iterate over the segments that can hold messages of topics between log times [ns]."""
        if self.index is None or not self.index.complete:
            self.contents()  # heads of chunks may be wrong, channels defined elsewhere
        for segment in self.segments:
            if start is not None and segment.end < start:
                continue
            if end is not None and segment.start >= end:
                continue
            numbers = segment.index.message_index_offsets if segment.index else {}
            if (
                topics is None
                or not numbers
                or any(
                    n not in self._channels or self._channels[n].topic in topics for n in numbers
                )
            ):
                yield segment

    def read(
        self,
        segment: Segment,
        topics: Collection[str] | None = None,
        start: int | None = None,
        end: int | None = None,
    ) -> list[ReadMessage]:
        """Return the messages of a segment in the order of the file."""
        messages = []
        offset = segment.offset
        for (_, sequence, log_time, publish_time, data), channel in self._raw_messages(segment):
            if (
                (topics is None or channel.topic in topics)
                and (start is None or log_time >= start)
                and (end is None or log_time < end)
            ):
                if data[:4] == ZSTD_MAGIC and channel.encoding == 'cdr':
                    try:
                        data = memoryview(decompress_message(data))
                    except DecompressionError as error:
                        reason = f'a message of {channel.topic[:100]!r} is lost: {error}'
                        self._damaged(offset, reason)
                        continue
                messages.append(
                    ReadMessage(channel, sequence, log_time, publish_time, data, offset)
                )
        return messages

    def _raw_messages(self, segment: Segment) -> Iterator[tuple[RawMessage, LogChannel]]:
        record = pread(self.file, segment.length, segment.offset)
        what = f'a chunk of {segment.length - RECORD.size} bytes'
        try:
            if segment.is_chunk:
                records = unpack_chunk(memoryview(record)[RECORD.size :])
            else:
                records = memoryview(record)
        except RecordError as error:
            self._damaged(segment.offset, f'{what} is lost: {error}')
            return
        unknown: dict[int, int] = {}
        try:
            for item in iter_records(records):
                if not isinstance(item, RawMessage):
                    self._learn(item, segment.offset)
                elif (channel := self._channels.get(item.channel)) is None:
                    unknown[item.channel] = unknown.get(item.channel, 0) + 1
                else:
                    yield item, channel
        except RecordError as error:
            self._damaged(segment.offset, f'the rest of {what} is lost: {error}')
        for number, count in unknown.items():
            reason = f'messages of the unknown channel {number} are lost: {count} of them'
            self._damaged(segment.offset, reason)

    def contents(self) -> dict[LogChannel, ChannelCount]:
        """Return the messages of each channel, counted by reading all of them once."""
        return self._contents

    @functools.cached_property
    def _contents(self) -> dict[LogChannel, ChannelCount]:
        # By identity while counting: the hash of a channel takes its whole definition.
        counts: dict[int, tuple[LogChannel, ChannelCount]] = {}
        for segment in self.segments:
            inside = ChannelCount()
            for raw, channel in self._raw_messages(segment):
                counted = counts.get(id(channel))
                if counted is None:
                    counted = counts[id(channel)] = channel, ChannelCount()
                counted[1].add(raw.log_time)
                inside.add(raw.log_time)
            if inside.messages:
                segment.start, segment.end = inside.start, inside.end
        found = {channel: ChannelCount() for channel in self._channels.values()}
        for channel, count in counts.values():
            found.setdefault(channel, ChannelCount()).merge(count)
        return found

    def configurations(self) -> Iterator[dict[str, str]]:
        """Iterate over the configurations of the run, each with its `log_time` [ns]."""
        for offset, record in self._metadata:
            if record.name != CONFIGURATION:
                continue
            content = dict(record.metadata)
            if content.pop('crc32', None) != configuration_checksum(content):
                self._damaged(offset, 'a configuration is lost: its CRC is wrong')
            elif not _is_time(content.get('log_time', '')):
                time = content.get('log_time', '')[:30]
                self._damaged(offset, f'a configuration is lost: its log_time is {time!r}')
            else:
                yield content

    def _learn(self, record: Schema | Channel, offset: int) -> None:
        """Take a schema or a channel, from the record or chunk at a byte."""
        names = (
            (record.name,)
            if isinstance(record, Schema)
            else (record.topic, record.message_encoding)
        )
        for name in names:
            if len(name) > LONGEST_NAME:
                self._damaged(
                    offset,
                    f'a name of {len(name)} characters is refused: the limit is {LONGEST_NAME}',
                )
                return
        if isinstance(record, Schema):
            self._schemas[record.id] = record
            return
        schema = self._schemas.get(record.schema_id)
        if schema is None and record.schema_id:
            return
        channel = LogChannel(
            topic=record.topic,
            type_name=schema.name if schema else '',
            encoding=record.message_encoding,
            schema_encoding=schema.encoding if schema else '',
            schema=schema.data if schema else b'',
            metadata=tuple(record.metadata.items()),
        )
        if self._channels.get(record.id) != channel:
            self._channels[record.id] = channel

    def _damaged(self, offset: int, reason: str, loss: bool = True) -> None:
        self._on_damage(Damage(self.path, offset, reason, loss))


def _is_time(text: str) -> bool:
    """Check that a text is a time that MCAP can hold [ns]."""
    return text.isascii() and text.isdecimal() and len(text) <= 20 and int(text) < 1 << 64
