"""Write one MCAP file as rosbag2 does, complete up to its last chunk at any time."""

from __future__ import annotations

import os
import time
import zlib
from collections.abc import Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

import yaml
from mcap.data_stream import RecordBuilder
from mcap.records import Channel, Header, Metadata, MetadataIndex, Schema
from mcap.writer import MCAP0_MAGIC

from gear_dynamics.bag.chunk_builder import ChunkBuilder
from gear_dynamics.bag.mcap_index import McapIndex
from gear_dynamics.bag.metadata import FileSummary, LoggedTopic, bag_information
from gear_dynamics.portable import WRITE_NEW, sync_data, writev

CHUNK_SIZE = 1 << 20
"""Bytes of messages, before compression, after which a chunk is closed."""

CONFIGURATION = 'gear_dynamics'
"""Name of the metadata records that hold the run's configuration."""


class McapFile:
    """An MCAP file under construction.

    Messages become part of the file chunk by chunk: when a chunk is full, or at `sync`. A write
    that fails takes the file back to the end of the last whole chunk, and the chunk that failed
    is given up; then the file may still be finished.

    Parameters
    ----------
    path : Path
        A file that does not exist yet.
    compression : str
        'none', 'lz4' or 'zstd', applied per chunk.
    profile : str
        Of the file; 'ros2' for what ROS 2 is to play.

    Raises
    ------
    OSError
        If the file cannot be made; so do all methods if it cannot be written.
    """

    def __init__(self, path: Path, compression: str, profile: str = 'ros2') -> None:
        self.path = path
        self._file = os.open(path, WRITE_NEW, 0o644)
        self.size = 0
        self.lost = 0
        self._chunk = ChunkBuilder(compression)
        self._index = McapIndex()
        self._syncer = ThreadPoolExecutor(1, 'log_sync')
        self._syncing: Future[None] | None = None
        self._synced = 0
        self._sync_start = 0.0
        self._channels: dict[LoggedTopic, Channel] = {}
        self._started = False
        self._start = self._end = 0
        builder = RecordBuilder()
        Header(profile, 'gear_dynamics').write(builder)
        try:
            self._write(MCAP0_MAGIC + builder.end())
        except OSError:
            self.abandon()
            path.unlink(missing_ok=True)
            raise

    @property
    def empty(self) -> bool:
        """Whether no message was handed in yet."""
        return not self._started

    @property
    def uncommitted(self) -> int:
        """Messages that are not in the file yet."""
        return sum(self._chunk.counts.values())

    @property
    def duration(self) -> int:
        """Log time from the first to the last message [ns]."""
        return self._end - self._start

    @property
    def deleted(self) -> bool:
        """Whether the file is no longer in its folder."""
        return os.fstat(self._file).st_nlink == 0

    def write(
        self, topic: LoggedTopic, data: bytes, log_time: int, publish_time: int, sequence: int = 0
    ) -> None:
        """Append a message; times in ns."""
        if topic not in self._channels:
            self._register(topic)
        if not self._started:
            self._started, self._start = True, log_time
        self._start, self._end = min(self._start, log_time), max(self._end, log_time)
        channel = self._channels[topic].id
        self._chunk.add_message(channel, sequence, log_time, publish_time, data)
        if self._chunk.size > CHUNK_SIZE:
            self._commit()

    def _register(self, topic: LoggedTopic) -> None:
        """Add the channel, and its schema if that is new, to the chunk that holds its messages."""
        key = (topic.type_name, topic.schema_encoding, topic.schema)
        schema = self._index.schemas.get(key)
        if schema is None and any(key):
            number = len(self._index.schemas) + 1
            schema = Schema(number, topic.schema, topic.schema_encoding, topic.type_name)
            self._index.schemas[key] = schema
            self._chunk.add_record(schema)
        channel = Channel(
            id=len(self._channels) + 1,
            topic=topic.name,
            message_encoding=topic.encoding,
            metadata=topic.metadata,
            schema_id=schema.id if schema else 0,
        )
        self._channels[topic] = channel
        self._index.channels.append(channel)
        self._chunk.add_record(channel)

    def write_configuration(self, configuration: Mapping[str, str], log_time: int) -> None:
        """Append the configuration that holds from `log_time` [ns] on, with a checksum."""
        record = {**configuration, 'log_time': str(log_time)}
        self._write_metadata(CONFIGURATION, {**record, 'crc32': configuration_checksum(record)})

    def _write_metadata(self, name: str, content: dict[str, str]) -> None:
        record = _metadata_record(name, content)
        place = MetadataIndex(self.size, len(record), name)
        self._write(record)
        self._index.metadata.append(place)

    def sync(self) -> None:
        """Close the chunk in progress, and sync the file to the disk in the background.

        A disk that is slow to sync delays nothing: what was written outlives the end of this
        process.
        """
        self._commit()
        if self._syncing is not None:
            if not self._syncing.done():
                return
            self._end_sync()
        if self.size != self._synced:
            self._synced = self.size
            self._sync_start = time.monotonic()
            self._syncing = self._syncer.submit(sync_data, self._file)

    @property
    def syncing(self) -> float:
        """Time that the present sync has taken so far [s]; 0 if there is none."""
        syncing = self._syncing  # asked by other threads
        running = syncing is not None and not syncing.done()
        return time.monotonic() - self._sync_start if running else 0.0

    def _end_sync(self) -> None:
        """Wait for the sync in the background, and raise its error once."""
        syncing, self._syncing = self._syncing, None
        if syncing is not None:
            syncing.result()

    def finish(self) -> FileSummary:
        """Write index and footer, close, and return the entry of metadata.yaml."""
        self._end_sync()
        self._commit()
        information = bag_information([self._summary()])
        text = yaml.safe_dump(information, sort_keys=False, width=1 << 20)
        record = _metadata_record('rosbag2', {'serialized_metadata': text})
        place = MetadataIndex(self.size, len(record), 'rosbag2')
        self._write(record + self._index.build(self.size + len(record), place))
        sync_data(self._file)
        self.abandon()
        return self._summary()

    def abandon(self) -> None:
        """Close the file as it is, complete up to the last chunk; unfinished, it has no index."""
        if self._file >= 0:
            self._syncer.shutdown()
            os.close(self._file)
            self._file = -1

    def _summary(self) -> FileSummary:
        counts = {
            topic: self._index.counts.get(channel.id, 0)
            for topic, channel in self._channels.items()
        }
        return FileSummary(self.path.name, self._index.start, self._index.end, self.size, counts)

    def _commit(self) -> None:
        """Write the chunk in progress."""
        if not self.uncommitted:
            return
        parts, index = self._chunk.build(self.size)
        counts = self._chunk.counts
        self._chunk.clear()
        try:
            self._write(*parts)
        except OSError:
            self.lost += sum(counts.values())
            raise
        self._index.add_chunk(index, counts)

    def _write(self, *parts: bytes) -> None:
        """Write all parts, or none of them if the disk refuses."""
        size = sum(map(len, parts))
        try:
            written = writev(self._file, parts)
            if written < size:
                rest = memoryview(b''.join(parts))[written:]
                while rest:
                    rest = rest[os.write(self._file, rest) :]
        except OSError:
            os.ftruncate(self._file, self.size)
            os.lseek(self._file, self.size, os.SEEK_SET)
            raise
        self.size += size


def _metadata_record(name: str, content: dict[str, str]) -> bytes:
    builder = RecordBuilder()
    Metadata(name, content).write(builder)
    return builder.end()


def configuration_checksum(record: Mapping[str, str]) -> str:
    """Return the CRC-32 of a configuration record, which MCAP itself does not protect."""
    text = '\0'.join(f'{key}\0{record[key]}' for key in sorted(record) if key != 'crc32')
    return f'{zlib.crc32(text.encode()):08x}'
