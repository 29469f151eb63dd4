"""A log to read: a bag folder, a file, or several, as one sequence of messages."""

from __future__ import annotations

import contextlib
import os
import re
import warnings
from collections.abc import Callable, Collection, Iterator, Sequence
from pathlib import Path
from types import TracebackType

from gear_dynamics.bag.channel import ChannelCount, Damage, LogChannel, LogError, ReadMessage
from gear_dynamics.bag.merge import in_time_order
from gear_dynamics.bag.source import McapSource, Segment
from gear_dynamics.wire.messages import MessageError, header_stamp
from gear_dynamics.wire.topics import DIAGNOSTICS

LogPath = str | os.PathLike[str] | Sequence[str | os.PathLike[str]]

SAMPLES_TOPIC = 'gear_pair/samples'


class LogWarning(UserWarning):
    """A part of a log could not be read and was skipped."""


def warn_of(damage: Damage) -> None:
    """Issue a `LogWarning` that names the place."""
    warnings.warn(str(damage), LogWarning, stacklevel=2)


class Log:
    """A log opened for reading; a context manager.

    Parameters
    ----------
    path : path, or sequence of paths
        Bag folders and MCAP files; whole, cut or damaged.
    on_damage : callable
        Told of every place that is skipped; a `LogWarning` by default.

    Raises
    ------
    LogError
        If there is no such file, or nothing in it can be read.
    """

    def __init__(self, path: LogPath, on_damage: Callable[[Damage], None] = warn_of) -> None:
        self._stack = contextlib.ExitStack()
        self._on_damage = on_damage
        self._told: dict[Damage, None] = {}
        self._topics: dict[str, str] | None = None
        self.sources: list[McapSource] = []
        try:
            for file in find_files(path):
                source = McapSource(file, self.damaged)
                self._stack.callback(source.close)
                self.sources.append(source)
            if all(source.foreign for source in self.sources):
                raise LogError(f'{self.sources[0].path}: {self.sources[0].foreign}')
            for source in self.sources:
                if source.foreign:
                    self.damaged(Damage(source.path, 0, source.foreign))
        except BaseException:
            self.close()
            raise

    def damaged(self, damage: Damage) -> None:
        """Report a damaged place once, however often it is met."""
        if damage not in self._told:
            self._told[damage] = None
            self._on_damage(damage)

    def close(self) -> None:
        """Close all files."""
        self._stack.close()

    def __enter__(self) -> Log:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    @property
    def indexed(self) -> bool:
        """Whether the indexes of all files list all topics and numbers of messages."""
        return all(s.index is not None and s.index.complete for s in self.sources)

    def messages(
        self,
        topics: Collection[str] | None = None,
        start: int | None = None,
        end: int | None = None,
    ) -> Iterator[tuple[McapSource, ReadMessage]]:
        """Iterate over the messages of all files by log time.

        Parameters
        ----------
        topics : collection of str, optional
            Only these topics, by the names that they have in the log.
        start, end : int, optional
            Only log times from `start` on and before `end` [ns].
        """
        segments = (s for source in self.sources for s in source.wanted(topics, start, end))

        def read(segment: Segment) -> list[ReadMessage]:
            return segment.source.read(segment, topics, start, end)

        return in_time_order(segments, read, self._tell_disorder)

    def messages_as_written(self) -> Iterator[tuple[McapSource, ReadMessage]]:
        """Iterate over the messages of all files in the order in which they stand there."""
        for source in self.sources:
            for segment in source.wanted(None, None, None):
                for message in source.read(segment):
                    yield source, message

    def _tell_disorder(self, segment: Segment) -> None:
        reason = 'too much overlaps in time: messages from here on come later than by log time'
        self.damaged(Damage(segment.source.path, segment.offset, reason, loss=False))

    def contents(self, check: bool = False) -> dict[LogChannel, ChannelCount]:
        """Return the messages of each channel, and log times of its first and last [ns].

        Parameters
        ----------
        check : bool
            Whether to read all messages. Without, an index gives the numbers, and the log times
            are those of the whole file.
        """
        found: dict[LogChannel, ChannelCount] = {}
        for source in self.sources:
            for channel, count in _contents(source, check).items():
                found.setdefault(channel, ChannelCount()).merge(count)
        return found

    def topic(self, name: str) -> LogChannel:
        """Return the channel of a topic, by the name that it has in the log."""
        self.topics()
        channels = (c for source in self.sources for c in source.channels.values())
        return next(channel for channel in channels if channel.topic == name)

    def topics(self) -> dict[str, str]:
        """Return the types of all topics by name; without an index, the complete log is read."""
        if self._topics is None:
            for source in self.sources:
                if source.index is None or not source.index.complete:
                    source.contents()
            channels = [c for source in self.sources for c in source.channels.values()]
            self._topics = {channel.topic: channel.type_name for channel in channels}
        return self._topics

    def resolve(self, topic: str) -> str:
        """Return the name that a topic has in the log.

        It may be given with or without the slash before it, and without its namespace if only
        one topic ends like this.

        Raises
        ------
        LogError
            If no topic or several match.
        """
        topics = self.topics()
        absolute = '/' + topic.lstrip('/')
        for name in (topic, absolute, absolute[1:]):
            if name in topics:
                return name
        matches = [name for name in topics if name.endswith(absolute)]
        if topic.startswith('/') or len(matches) != 1:
            problem = f'{len(matches)} topics match' if matches else 'there is no topic'
            raise LogError(
                f'{problem} {topic!r} in the log; it has '
                f'{", ".join(map(printable, sorted(topics))) or "none"}'
            )
        return matches[0]

    def origin(self) -> int:
        """Return the instant of t = 0 [ns]: the stamp of the first block of samples.

        A log without samples begins with the publish time of its first message.

        Raises
        ------
        LogError
            If the log has no message that can be read.
        """
        samples = [topic for topic in self.topics() if is_samples(topic)]
        for topics in (samples, None):
            for _, message in self.messages(topics):
                return message_time(message)
        raise LogError('the log has no message that can be read')


def _contents(source: McapSource, check: bool) -> dict[LogChannel, ChannelCount]:
    index = source.index
    if check or index is None or not index.complete or index.statistics is None:
        return source.contents()
    about = index.statistics
    found: dict[LogChannel, ChannelCount] = {}
    for number, channel in source.channels.items():
        count = about.channel_message_counts.get(number, 0)
        times = (about.message_start_time, about.message_end_time) if count else (0, 0)
        found.setdefault(channel, ChannelCount()).merge(ChannelCount(count, *times))
    return found


def printable(text: str, length: int = 200) -> str:
    """Return a name from a log as it can be shown in one line."""
    shown = text if len(text) <= length else text[: length - 3] + '...'
    return shown if shown.isprintable() else shown.encode('unicode_escape').decode()


def is_samples(topic: str) -> bool:
    """Tell whether a topic is the stream of samples of some rig."""
    return f'/{topic}'.endswith('/' + SAMPLES_TOPIC)


def message_time(message: ReadMessage) -> int:
    """Return the time that a message tells of [ns], on the time scale of the stream.

    It is the header stamp, or else the publish time. Diagnostics bear the time of the clock in
    their header, so that their publish time counts.
    """
    if message.channel.topic == DIAGNOSTICS.name:
        return message.publish_time
    try:
        stamp = header_stamp(message.data, message.channel.type_name)
    except MessageError:
        stamp = None
    return message.publish_time if stamp is None else stamp


def find_files(path: LogPath) -> list[Path]:
    """Return the MCAP files of bag folders and files, in the order of their numbers.

    Raises
    ------
    LogError
        If there is none.
    """
    paths = [path] if isinstance(path, str | os.PathLike) else list(path)
    files: list[Path] = []
    for entry in map(Path, paths):
        try:
            files += _files_in(entry) if entry.is_dir() else [entry]
            if not entry.exists():
                raise LogError(f'{entry}: there is no such file or folder')
        except (OSError, ValueError) as error:
            if isinstance(error, LogError):
                raise
            raise LogError(f'{printable(str(entry))}: {error}') from None
    if not files:
        raise LogError('no log was given')
    return files


def _files_in(folder: Path) -> list[Path]:
    """Return the MCAP files of a bag folder; a compressed one only where its copy is missing."""
    plain = list(folder.glob('*.mcap'))
    names = {path.name for path in plain}
    packed = [path for path in folder.glob('*.mcap.zstd') if path.stem not in names]
    found = sorted([*plain, *packed], key=_by_number)
    if not found:
        databases = sorted(path.name for path in folder.glob('*.db3*'))
        if databases:
            raise LogError(
                f'{folder}: this is an SQLite bag ({databases[0]}): `ros2 bag convert` makes an '
                'MCAP bag of it'
            )
        raise LogError(f'{folder}: there is no .mcap file in this folder')
    return found


def _by_number(path: Path) -> tuple[int, str]:
    number = re.search(r'_(\d{1,9})\.mcap(\.zstd)?$', path.name)
    return (int(number[1]) if number else -1, path.name)
