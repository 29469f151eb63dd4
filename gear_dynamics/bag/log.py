"""A log to read: a bag folder, a file, or several, as one sequence of messages."""

from __future__ import annotations

import contextlib
import heapq
import os
import re
import warnings
from collections.abc import Callable, Collection, Iterator, Sequence
from pathlib import Path
from types import TracebackType

from gear_dynamics.bag.source import Damage, LogError, McapSource, ReadMessage
from gear_dynamics.wire.messages import MessageError, header_stamp

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
        self._told: set[Damage] = set()
        self._topics: dict[str, str] | None = None
        self.sources: list[McapSource] = []
        try:
            for file in find_files(path):
                source = McapSource(file, self.damaged)
                self._stack.callback(source.close)
                self.sources.append(source)
            if all(source.foreign for source in self.sources):
                raise LogError(f'{self.sources[0].path}: this is no MCAP file')
        except BaseException:
            self.close()
            raise

    def damaged(self, damage: Damage) -> None:
        """Tell of a damaged place, once however often it is met."""
        if damage not in self._told:
            self._told.add(damage)
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
        """Whether all files have a sound index."""
        return all(source.summary is not None for source in self.sources)

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
            Only these topics, absolute names.
        start, end : int, optional
            Only log times from `start` on and before `end` [ns].
        """
        runs = [_with_source(source, topics, start, end) for source in self.sources]
        return heapq.merge(*runs, key=lambda item: item[1].log_time)

    def topics(self) -> dict[str, str]:
        """Return the types of all topics by name; without an index the whole log is read."""
        if self._topics is None:
            for source in self.sources:
                if source.summary is None:
                    for _ in source.messages():
                        pass
            channels = [c for source in self.sources for c in source.channels.values()]
            self._topics = {channel.topic: channel.type_name for channel in channels}
        return self._topics

    def resolve(self, topic: str) -> str:
        """Return the absolute name of a topic: the name itself, or its only match in a namespace.

        Raises
        ------
        LogError
            If no topic or several match.
        """
        topics = self.topics()
        absolute = '/' + topic.lstrip('/')
        if absolute in topics:
            return absolute
        matches = [name for name in topics if name.endswith(absolute)]
        if topic.startswith('/') or len(matches) != 1:
            problem = f'{len(matches)} topics match' if matches else 'there is no topic'
            raise LogError(
                f'{problem} {topic!r} in the log; it has {", ".join(sorted(topics)) or "none"}'
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
        samples = [topic for topic in self.topics() if topic.endswith('/' + SAMPLES_TOPIC)]
        for _, message in self.messages(samples or None):
            return message_time(message)
        raise LogError('the log has no message that can be read')


def _with_source(
    source: McapSource, topics: Collection[str] | None, start: int | None, end: int | None
) -> Iterator[tuple[McapSource, ReadMessage]]:
    for message in source.messages(topics, start, end):
        yield source, message


def message_time(message: ReadMessage) -> int:
    """Return the time that a message tells of [ns]: its header stamp or its publish time."""
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
        if entry.is_dir():
            found = sorted(entry.glob('*.mcap'), key=_by_number)
            if not found:
                raise LogError(f'{entry}: there is no .mcap file in this folder')
            files += found
        elif entry.exists():
            files.append(entry)
        else:
            raise LogError(f'{entry}: there is no such file or folder')
    if not files:
        raise LogError('no log was given')
    return files


def _by_number(path: Path) -> tuple[int, str]:
    number = re.search(r'_(\d+)$', path.stem)
    return (int(number[1]) if number else -1, path.name)
