"""The log writer: a thread that writes messages to disk and never blocks the caller."""

from __future__ import annotations

import collections
import dataclasses
import threading
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from types import TracebackType
from typing import Any, NamedTuple

from gear_dynamics.bag.chunk_builder import COMPRESSIONS
from gear_dynamics.bag.folder import FOLDER_NAME, BagFolder, LogDeleted, LogLimits, LogStopped
from gear_dynamics.bag.metadata import LoggedTopic, OfferedQos, published_topic

SYNC_INTERVAL = 0.25
"""Seconds between writes to the disk; a crash loses little more than this."""

BATCH_SIZE = 1 << 20
"""Bytes that wait before they are written earlier than that."""

PROBE_INTERVAL = 1.0
"""Seconds between attempts to resume after a stop."""

QUEUE_SIZE = 128 << 20
"""Bytes that may wait for the disk: 48 s of the default stream."""


@dataclasses.dataclass(frozen=True)
class LogStatus:
    """State of the writer.

    Attributes
    ----------
    state : str
        'writing', 'stopped' (it tries again by itself), or 'off' (closed, or failed for good).
    reason : str
        Why it stopped; empty while writing.
    path : str
        The bag folder; the directory it was meant for while there is no folder.
    bytes : int
        Bytes of the run on the disk.
    messages : int
        Messages written, with those that later files repeat at their beginning.
    waiting : int
        Messages handed in that are not written yet.
    dropped : int
        Messages handed in that are not in the log: queue full, stopped, or lost with a chunk
        that the disk refused.
    overflows : int
        Those of `dropped` for which the queue was full.
    syncing : float
        Seconds that the disk has taken so far to sync what it was handed; 0 if it is done.
    """

    state: str
    reason: str
    path: str
    bytes: int
    messages: int
    waiting: int
    dropped: int
    overflows: int
    syncing: float


class _Message(NamedTuple):
    topic: LoggedTopic
    data: bytes
    log_time: int
    publish_time: int


class _Change(NamedTuple):
    configuration: dict[str, str]
    log_time: int


class _Batch(NamedTuple):
    """What is written in one go; `last` if nothing comes after it."""

    items: collections.deque[_Message | _Change]
    size: int
    last: bool


class LogWriter:
    """Writes a run into a bag folder `gear_log_YYYY_MM_DD-HH_MM_SS/`, as rosbag2 would.

    The system has everything within half a second, and the disk as soon as it has synced, which
    goes on in the background; `status` tells how long that takes. When the disk is full, is
    read-only or the folder disappears, logging stops at the last whole chunk, and resumes in a
    new file when it can.

    Parameters
    ----------
    directory : Path
        Where the bag folder goes.
    configuration : mapping of str to str
        The run's configuration; every file carries it as a metadata record.
    compression : str
        'none', 'lz4' or 'zstd', applied per chunk.
    split_size, split_duration, total_cap, free_floor : float
        See `LogLimits`.
    name : str
        Begins the name of the folder.

    Raises
    ------
    ValueError
        If the compression is not known or a limit is not positive.
    """

    def __init__(
        self,
        directory: Path,
        configuration: Mapping[str, str],
        compression: str = 'zstd',
        split_size: float = LogLimits.split_size,
        split_duration: float = LogLimits.split_duration,
        total_cap: float = LogLimits.total_cap,
        free_floor: float = LogLimits.free_floor,
        name: str = FOLDER_NAME,
    ) -> None:
        if compression not in COMPRESSIONS:
            raise ValueError(
                f'compression is {compression!r}: it must be one of {", ".join(COMPRESSIONS)}'
            )
        limits = LogLimits(split_size, split_duration, total_cap, free_floor)
        self._folder = BagFolder(Path(directory), configuration, compression, limits, name)
        self._topics: dict[tuple[str, str, OfferedQos], LoggedTopic] = {}
        self._queue: collections.deque[_Message | _Change] = collections.deque()
        self._queued_bytes = self._taken = 0
        self._condition = threading.Condition()
        self._closing = False
        self._reason: str | None = 'the log is being opened'
        self._messages = self._dropped = self._overflows = 0
        self._open()
        self._thread = threading.Thread(target=self._run, name='log_writer', daemon=True)
        self._thread.start()

    def write(
        self,
        topic: str,
        type_name: str,
        data: bytes,
        log_time: int,
        publish_time: int,
        qos: OfferedQos = OfferedQos(),  # noqa: B008 (frozen)
    ) -> None:
        """Queue a message; returns at once.

        Parameters
        ----------
        topic : str
            Absolute name.
        type_name : str
            As 'sensor_msgs/msg/PointCloud2'.
        data : bytes
            CDR bytes as they came; they are not looked at.
        log_time, publish_time : int
            Time of arrival and stamp [ns].
        qos : OfferedQos
            How the topic is published.

        Raises
        ------
        MessageError
            If Jazzy has no such type.
        ValueError
            If the topic is not absolute or a time is negative.
        """
        key = (topic, type_name, qos)
        if key not in self._topics:
            if not topic.startswith('/'):
                raise ValueError(f'topic {topic!r} must be absolute: it must begin with a slash')
            self._topics[key] = published_topic(*key)
        if not 0 <= log_time < 1 << 64 or not 0 <= publish_time < 1 << 64:
            raise ValueError(
                f'log_time {log_time} or publish_time {publish_time} ns is out of range'
            )
        message = _Message(self._topics[key], data, log_time, publish_time)
        with self._condition:
            if self._closing or self._queued_bytes + len(data) > QUEUE_SIZE:
                self._dropped += 1
                self._overflows += not self._closing
                return
            self._queue.append(message)
            self._queued_bytes += len(data)
            if self._queued_bytes > BATCH_SIZE:
                self._condition.notify()

    def configure(self, configuration: Mapping[str, str]) -> None:
        """Record the configuration of the run that holds from now on."""
        with self._condition:
            self._queue.append(_Change(dict(configuration), time.time_ns()))

    def status(self) -> LogStatus:
        """Return the state of the writer."""
        with self._condition:
            state = (
                'off'
                if not self._thread.is_alive()
                else 'stopped'
                if self._reason is not None
                else 'writing'
            )
            return LogStatus(
                state=state,
                reason=self._reason or '',
                path=str(self._folder.path or self._folder.directory),
                bytes=self._folder.size,
                messages=self._messages + self._folder.repeated,
                waiting=len(self._queue) + self._taken,
                dropped=self._dropped,
                overflows=self._overflows,
                syncing=self._folder.syncing,
            )

    def close(self) -> LogStatus:
        """Write what is waiting, finish the log with index and metadata.yaml, return the state.

        `reason` is empty if the log is whole.
        """
        with self._condition:
            self._closing = True
            self._condition.notify()
        self._thread.join()
        return self.status()

    def __enter__(self) -> LogWriter:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def _run(self) -> None:
        """Write until closed; the only place that touches the folder once the thread runs."""
        try:
            self._write_all()
        except Exception as error:  # told by `status`: a thread that dies tells nobody
            with self._condition:
                self._closing = True
                self._reason = f'the writer failed: {type(error).__name__}: {error}'

    def _write_all(self) -> None:
        self._deadline = time.monotonic() + SYNC_INTERVAL
        while True:
            batch = self._next_batch()
            for item in batch.items:
                self._take(item)
            with self._condition:
                self._queued_bytes -= batch.size
                self._taken = 0
            if time.monotonic() >= self._deadline:
                self._keep_up()
            if batch.last:
                break
        if self._reason is None:
            self._finish()

    def _next_batch(self) -> _Batch:
        """Wait until there is much to write, or it is time to bring it to the disk; return it.

        The thread does not wake for each message. Under load, every time that it wakes it waits
        for Python's lock behind the other threads, 5 ms for each, and would fall behind.
        """
        with self._condition:
            while not self._closing and self._queued_bytes <= BATCH_SIZE:
                left = self._deadline - time.monotonic()
                if left <= 0:
                    break
                self._condition.wait(left)
            batch = _Batch(self._queue, self._queued_bytes, self._closing)
            self._queue = collections.deque()
            self._taken = len(batch.items)
            return batch

    def _keep_up(self) -> None:
        """Sync the file, or try again to open one."""
        if self._reason is None:
            self._guard(self._folder.sync)
        else:
            self._open()
        pause = SYNC_INTERVAL if self._reason is None else PROBE_INTERVAL
        self._deadline = time.monotonic() + pause

    def _take(self, item: _Message | _Change) -> None:
        if isinstance(item, _Change):
            self._guard(self._folder.configure, item.configuration, item.log_time)
            return
        if self._reason is None:
            self._messages += 1  # by this thread alone
            self._guard(self._folder.write, *item)
        else:
            with self._condition:
                self._dropped += 1

    def _open(self) -> None:
        def resume() -> None:
            self._folder.open()
            self._reason = None

        self._guard(resume)

    def _guard(self, action: Callable[..., None], *arguments: Any) -> None:
        """Call a function of the folder; stop at the last complete chunk if it fails."""
        try:
            action(*arguments)
        except LogDeleted as deleted:
            self._folder.forget()
            self._reason = str(deleted)
        except LogStopped as stop:
            # The state changes when the file is whole, not before.
            if self._finish():
                self._reason = str(stop)
        except OSError as error:
            self._lose(f'{error.filename or self._folder.path}: {error.strerror}')

    def _finish(self) -> bool:
        """Close the file with its index, if one is open; return whether that succeeded."""
        if self._folder.is_open:
            try:
                self._folder.finish()
            except OSError as error:
                self._lose(f'{self._folder.path}: {error.strerror}')
                return False
        return True

    def _lose(self, reason: str) -> None:
        """Drop the chunk in progress, which the disk refused."""
        lost = self._folder.give_up()
        with self._condition:
            self._dropped += lost
            self._messages -= lost
            self._reason = reason
