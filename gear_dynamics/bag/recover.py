"""A sound log out of a cut or damaged one."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import yaml

from gear_dynamics.bag.folder import Limits
from gear_dynamics.bag.log import Log, LogPath
from gear_dynamics.bag.mcap_file import McapFile
from gear_dynamics.bag.metadata import FileSummary, OfferedQos, Topic, write_metadata
from gear_dynamics.bag.source import Damage, LogChannel, LogError
from gear_dynamics.wire.messages import MessageError, message_type


@dataclasses.dataclass(frozen=True)
class Recovery:
    """What came of a recovery.

    Attributes
    ----------
    folder : Path
        The sound bag folder.
    messages : int
        Messages in it.
    lost : tuple of Damage
        What could not be saved, and where it was.
    """

    folder: Path
    messages: int
    lost: tuple[Damage, ...]


def recover(path: LogPath, folder: Path, compression: str = 'zstd') -> Recovery:
    """Copy every message of every sound chunk into a new bag folder.

    Parameters
    ----------
    path : path, or sequence of paths
        Bag folders and MCAP files; they are left as they are.
    folder : Path
        Where the sound log goes; must not exist.
    compression : str
        'none', 'lz4' or 'zstd'.

    Raises
    ------
    LogError
        If there is no such log, the folder exists, or nothing can be saved.
    OSError
        If the disk is full or the folder cannot be made.
    """
    lost: list[Damage] = []
    with Log(path, lost.append) as log:
        if next(log.messages(), None) is None:
            raise LogError('there is no message that can be saved')
        try:
            folder.mkdir(parents=True)
        except FileExistsError:
            raise LogError(f'{folder} exists: choose another folder') from None
        copy = _Copy(folder, compression)
        for source in log.sources:
            for record in source.configurations():
                copy.configure(record)
        for source, message in log.messages():
            topic = copy.topic(message.channel)
            if isinstance(topic, str):
                log.damaged(Damage(source.path, message.offset, topic))
            else:
                copy.write(topic, bytes(message.data), message.log_time, message.publish_time)
        copy.finish()
        return Recovery(folder, copy.messages, tuple(lost))


class _Copy:
    """A bag folder that is filled without the limits of a live log, but is split alike."""

    def __init__(self, folder: Path, compression: str) -> None:
        self._folder = folder
        self._compression = compression
        self._files: list[FileSummary] = []
        self._topics: dict[LogChannel, Topic | str] = {}
        self._configurations: list[dict[str, str]] = []
        self._file: McapFile | None = None
        self.messages = 0

    def configure(self, record: dict[str, str]) -> None:
        """Take a configuration; every file repeats all."""
        if record not in self._configurations:
            self._configurations.append(record)

    def topic(self, channel: LogChannel) -> Topic | str:
        """Return the topic, or the reason why its messages cannot be copied."""
        if channel not in self._topics:
            try:
                message_type(channel.type_name)
                qos = _first_qos(channel.qos)
                self._topics[channel] = Topic(channel.topic, channel.type_name, qos)
            except MessageError as error:
                self._topics[channel] = f'messages of {channel.topic} are lost: {error}'
        return self._topics[channel]

    def write(self, topic: Topic, data: bytes, log_time: int, publish_time: int) -> None:
        if self._file is None:
            name = f'{self._folder.name}_{len(self._files)}.mcap'
            self._file = McapFile(self._folder / name, self._compression)
            for record in self._configurations:
                self._file.write_configuration(record, int(record['log_time']))
        self._file.write(topic, data, log_time, publish_time)
        self.messages += 1
        if self._file.size >= Limits.split_size:
            self._finish_file()

    def finish(self) -> None:
        self._finish_file()
        write_metadata(self._folder, self._files)

    def _finish_file(self) -> None:
        if self._file is not None:
            self._files.append(self._file.finish())
            self._file = None


def _first_qos(text: str) -> OfferedQos:
    """Return what the first of the offered profiles says, defaults for what it does not."""
    try:
        profile = dict(yaml.safe_load(text)[0])
        return OfferedQos(
            int(profile['depth']),
            str(profile['reliability']),
            str(profile['durability']),
            str(profile['history']),
        )
    except (yaml.YAMLError, LookupError, TypeError, ValueError):
        return OfferedQos()
