"""One MCAP file as rosbag2 writes it, that is always whole up to the last commit."""

from __future__ import annotations

import os
import zlib
from collections.abc import Mapping
from pathlib import Path

import yaml
from mcap.writer import CompressionType, Writer

from gear_dynamics.bag.messages import message_type
from gear_dynamics.bag.metadata import FileSummary, Topic, bag_information

COMPRESSIONS = {
    'none': CompressionType.NONE,
    'lz4': CompressionType.LZ4,
    'zstd': CompressionType.ZSTD,
}

CHUNK_SIZE = 1 << 20
"""Bytes of messages, before compression, after which a chunk is closed."""

CONFIGURATION = 'gear_dynamics'
"""Name of the metadata records that hold the run's configuration."""


class McapFile:
    """An MCAP file under construction.

    Messages become part of the file chunk by chunk: when a chunk is full, or at `sync`. A write
    that fails takes the file back to the end of the last whole chunk; `uncommitted` is the
    number of messages that are not in the file yet.

    Parameters
    ----------
    path : Path
        A file that does not exist yet.
    compression : str
        'none', 'lz4' or 'zstd', applied per chunk.

    Raises
    ------
    OSError
        If the file cannot be made; so do all methods if it cannot be written.
    """

    def __init__(self, path: Path, compression: str) -> None:
        self.path = path
        self._stream = _CommitStream(path)
        self._writer = Writer(
            self._stream,  # type: ignore[arg-type]
            chunk_size=CHUNK_SIZE,
            compression=COMPRESSIONS[compression],
        )
        self._writer.start(profile='ros2', library='gear_dynamics')
        self._stream.commit()
        self._channels: dict[Topic, int] = {}
        self._schemas: dict[str, int] = {}
        self._counts: dict[Topic, int] = {}
        self._start = 0
        self._end = 0
        self.uncommitted = 0

    @property
    def size(self) -> int:
        """Bytes in the file so far."""
        return self._stream.committed

    @property
    def duration(self) -> int:
        """Log time from the first to the last message [ns]."""
        return self._end - self._start

    @property
    def deleted(self) -> bool:
        """Whether the file is no longer in its folder."""
        return self._stream.deleted()

    def write(self, topic: Topic, data: bytes, log_time: int, publish_time: int) -> None:
        """Append a message; times in ns."""
        if topic not in self._channels:
            self._channels[topic] = self._register(topic)
            self._counts[topic] = 0
        if not any(self._counts.values()):
            self._start = self._end = log_time
        self._start, self._end = min(self._start, log_time), max(self._end, log_time)
        self._counts[topic] += 1
        self.uncommitted += 1
        self._writer.add_message(self._channels[topic], log_time, data, publish_time)
        if self._stream.pending:
            self._stream.commit()
            self.uncommitted = 0

    def _register(self, topic: Topic) -> int:
        kind = message_type(topic.type_name)
        if kind.name not in self._schemas:
            self._schemas[kind.name] = self._writer.register_schema(
                kind.name, 'ros2msg', kind.definition.encode()
            )
        metadata = {'offered_qos_profiles': topic.qos.text(), 'topic_type_hash': kind.hash}
        return self._writer.register_channel(topic.name, 'cdr', self._schemas[kind.name], metadata)

    def write_configuration(self, configuration: Mapping[str, str], log_time: int) -> None:
        """Append the configuration that holds from `log_time` [ns] on, with a checksum."""
        record = {**configuration, 'log_time': str(log_time)}
        self._writer.add_metadata(
            CONFIGURATION, {**record, 'crc32': configuration_checksum(record)}
        )
        self._stream.commit()

    def sync(self) -> None:
        """Close the chunk in progress and bring everything to the disk."""
        self._writer.flush()
        self._stream.sync()
        self.uncommitted = 0

    def finish(self) -> FileSummary:
        """Write index and footer, close, and return what metadata.yaml says of the file."""
        self._writer.flush()
        self.uncommitted = 0
        information = bag_information([self._summary()])
        self._writer.add_metadata(
            'rosbag2',
            {'serialized_metadata': yaml.safe_dump(information, sort_keys=False, width=1 << 20)},
        )
        self._writer.finish()
        self._stream.sync()
        summary = self._summary()
        self.abandon()
        return summary

    def abandon(self) -> None:
        """Close the file as it is, whole up to the last chunk but without an index."""
        self._stream.close()

    def _summary(self) -> FileSummary:
        return FileSummary(self.path.name, self._start, self._end, self.size, dict(self._counts))


def configuration_checksum(record: Mapping[str, str]) -> str:
    """Return the CRC-32 of a configuration record, which MCAP itself does not protect."""
    text = '\0'.join(f'{key}\0{record[key]}' for key in sorted(record) if key != 'crc32')
    return f'{zlib.crc32(text.encode()):08x}'


class _CommitStream:
    """What `mcap.writer.Writer` writes into: gathers records, writes them whole or not at all."""

    def __init__(self, path: Path) -> None:
        flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC
        self._file = os.open(path, flags, 0o644)
        self._parts: list[bytes] = []
        self.pending = 0
        self.committed = 0

    def write(self, data: bytes) -> int:
        if data:
            self._parts.append(data)
            self.pending += len(data)
        return len(data)

    def tell(self) -> int:
        return self.committed + self.pending

    def flush(self) -> None:
        self.commit()

    def commit(self) -> None:
        try:
            for part in self._parts:
                rest = memoryview(part)
                while rest:
                    rest = rest[os.write(self._file, rest) :]
        except OSError:
            os.ftruncate(self._file, self.committed)
            raise
        self.committed += self.pending
        self._parts.clear()
        self.pending = 0

    def sync(self) -> None:
        self.commit()
        os.fdatasync(self._file)

    def deleted(self) -> bool:
        return os.fstat(self._file).st_nlink == 0

    def close(self) -> None:
        if self._file >= 0:
            os.close(self._file)
            self._file = -1
