"""A bag folder under construction: splits, the cap on its size, the floor on free disk space."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

from gear_dynamics.bag.mcap_file import CHUNK_SIZE, McapFile
from gear_dynamics.bag.metadata import FileSummary, LoggedTopic, write_metadata
from gear_dynamics.portable import free_space, sync_folder

FOLDER_NAME = 'gear_log'
"""Begins the name of a log's folder."""


class LogStopped(Exception):
    """Logging has to pause; the message says why."""


class LogDeleted(LogStopped):
    """The file was deleted with all its messages."""


@dataclasses.dataclass(frozen=True)
class LogLimits:
    """Limits on the size of a log.

    Attributes
    ----------
    split_size : float
        Bytes after which a new file begins.
    split_duration : float
        Seconds of log time after which a new file begins.
    total_cap : float
        Bytes of the whole run; beyond, its oldest files are removed.
    free_floor : float
        Bytes that must stay free on the disk; below, logging stops until there is room.
    """

    split_size: float = 1e9
    split_duration: float = 3600.0
    total_cap: float = 20e9
    free_floor: float = 5e9

    def __post_init__(self) -> None:
        for field in dataclasses.fields(self):
            value = getattr(self, field.name)
            if not value >= 0 or (field.name != 'free_floor' and value == 0):
                raise ValueError(f'{field.name} is {value!r}: it must be positive')

    @property
    def file_size(self) -> float:
        """Size of a file [bytes]; small against the cap, which removes whole files."""
        return min(self.split_size, self.total_cap / 4)


class _Latched(NamedTuple):
    topic: LoggedTopic
    data: bytes
    publish_time: int


class BagFolder:
    """The files of one run, `gear_log_YYYY_MM_DD-HH_MM_SS/` in a directory.

    Every file begins with the last message of each latched topic, as the rig's configuration, so
    that it can be analysed without those before it.

    Parameters
    ----------
    directory : Path
        Where the folder goes; made if missing.
    configuration : mapping
        Configuration of the run; every file holds it.
    compression : str
        'none', 'lz4' or 'zstd'.
    limits : LogLimits
        Splitting and disk space.
    name : str
        Begins the name of the folder.
    """

    def __init__(
        self,
        directory: Path,
        configuration: Mapping[str, str],
        compression: str,
        limits: LogLimits,
        name: str = FOLDER_NAME,
    ) -> None:
        self.directory = directory
        self._name = name
        self.path: Path | None = None
        self._configuration = dict(configuration)
        self._compression = compression
        self._limits = limits
        self._file: McapFile | None = None
        self._finished: list[FileSummary] = []
        self._number = 0
        self._largest = 0
        self._latched: dict[str, _Latched] = {}
        self.repeated = 0

    @property
    def is_open(self) -> bool:
        """Whether a file is being written."""
        return self._file is not None

    @property
    def size(self) -> int:
        """Bytes of all files of the run that are there."""
        finished = sum(file.size for file in self._finished)
        return finished + (self._file.size if self._file else 0)

    @property
    def syncing(self) -> float:
        """Time that the disk has been busy with syncing the file [s]."""
        file = self._file
        return file.syncing if file else 0.0

    def open(self) -> None:
        """Begin a new file; create the folder if it does not exist.

        Raises
        ------
        LogStopped
            If there is too little room.
        OSError
            If folder or file cannot be made.
        """
        folder = self._make_folder()
        self._check_room(margin=4 * CHUNK_SIZE)
        path = folder / f'{folder.name}_{self._number}.mcap'
        file = McapFile(path, self._compression)
        try:
            file.write_configuration(self._configuration, time.time_ns())
            file.sync()
            sync_folder(folder)
        except OSError:
            file.abandon()
            path.unlink(missing_ok=True)
            raise
        self._file = file
        self._number += 1

    def _make_folder(self) -> Path:
        """Create the run folder; recreate it if it was deleted, but never its parent."""
        if self.path is not None:
            self.path.mkdir(exist_ok=True)
            self._finished = [f for f in self._finished if (self.path / f.name).exists()]
            return self.path
        self.directory.mkdir(parents=True, exist_ok=True)
        name = self._name + time.strftime('_%Y_%m_%d-%H_%M_%S')
        path, number = self.directory / name, 1
        while True:
            try:
                path.mkdir()
            except FileExistsError:
                number += 1
                path = self.directory / f'{name}_{number}'
            else:
                sync_folder(self.directory)
                self.path = path
                return path

    def write(self, topic: LoggedTopic, data: bytes, log_time: int, publish_time: int) -> None:
        """Write a message; begin a new file and remove old ones as the limits demand.

        Raises
        ------
        LogStopped
            If the log was deleted or there is too little room; the message itself is written.
        OSError
            If the disk refuses; the file is whole up to its last commit.
        """
        file = self._current()
        size = file.size
        self._largest = max(self._largest, len(data))
        if file.empty:
            self._repeat_latched(file, topic, log_time)
        file.write(topic, data, log_time, publish_time)
        if topic.latched:
            self._latched[topic.name] = _Latched(topic, data, publish_time)
        if file.size != size or file.duration >= self._limits.split_duration * 1e9:
            self._check(file)

    def _repeat_latched(self, file: McapFile, first: LoggedTopic, log_time: int) -> None:
        """Write what is latched, as arrived with the first message of the file."""
        for latched in self._latched.values():
            if latched.topic.name != first.name:
                file.write(latched.topic, latched.data, log_time, latched.publish_time)
                self.repeated += 1

    def configure(self, configuration: Mapping[str, str], log_time: int) -> None:
        """Record a change of the configuration."""
        self._configuration = dict(configuration)
        if self._file:
            self._file.write_configuration(self._configuration, log_time)

    def sync(self) -> None:
        """Write all messages to the file and sync it; raises what `write` raises."""
        file = self._current()
        file.sync()
        self._check(file)

    def finish(self) -> None:
        """Close the file with its index, and write metadata.yaml."""
        self._finished.append(self._current().finish())
        self._file = None
        self._write_metadata()

    def give_up(self) -> int:
        """Close the file at its last whole chunk after an error; return the messages lost.

        The file gets its index if the disk takes that much.
        """
        file = self._file
        if file is None:
            return 0
        try:
            self.finish()
        except OSError:
            file.abandon()
        self._file = None
        return file.lost + file.uncommitted

    def forget(self) -> None:
        """Close a file that was deleted."""
        if self._file:
            self._file.abandon()
            self._file = None

    def _current(self) -> McapFile:
        if self._file is None:
            raise LogStopped('the log is not open')
        return self._file

    def _write_metadata(self) -> None:
        assert self.path is not None
        write_metadata(self.path, self._finished)

    def _check(self, file: McapFile) -> None:
        if file.deleted:
            raise LogDeleted(f'{file.path} was deleted')
        self._check_room(margin=0)
        limits = self._limits
        if file.size >= limits.file_size or file.duration >= limits.split_duration * 1e9:
            self.finish()
            self.open()
        self._remove_old()

    def _check_room(self, margin: int) -> None:
        """Keep so much free that chunk, index and metadata.yaml can still be written."""
        reserve = 4 * CHUNK_SIZE + 2 * self._largest + margin
        free = free_space(self.path or self.directory)
        if free < self._limits.free_floor + reserve:
            raise LogStopped(
                f'{free / 1e9:.3f} GB are free for {self.path}, the floor is '
                f'{self._limits.free_floor / 1e9:.3f} GB: make room or lower the floor'
            )

    def _remove_old(self) -> None:
        removed = False
        while self._finished and self.size > self._limits.total_cap:
            assert self.path is not None
            (self.path / self._finished.pop(0).name).unlink(missing_ok=True)
            removed = True
        if removed:
            self._write_metadata()
