"""Summary of a log: topics, counts, rates, gaps, times, configuration, damage."""

from __future__ import annotations

import contextlib
import dataclasses
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from gear_dynamics.bag.channel import ChannelCount, Damage, LogChannel, ReadMessage
from gear_dynamics.bag.log import Log, LogPath, is_samples
from gear_dynamics.bag.source import McapSource
from gear_dynamics.machine.configuration import Rig
from gear_dynamics.wire.tables import DecodedTable, TableError, decode_table


@dataclasses.dataclass(frozen=True)
class Gap:
    """A jump between the stamps of two blocks: where [s of log time] and how long [s]."""

    at: float
    duration: float


@dataclasses.dataclass(frozen=True)
class TopicInfo:
    """A topic in a log.

    Attributes
    ----------
    name, type_name, qos : str
        Topic, message type, offered QoS profiles as YAML.
    messages : int
        Messages in all files.
    rate : float or None
        Messages a second from the first to the last of the topic; None if it is not known.
    gaps : tuple of Gap
        Of samples: where the end of a block and the next stamp do not meet.
    """

    name: str
    type_name: str
    qos: str
    messages: int
    rate: float | None
    gaps: tuple[Gap, ...]


@dataclasses.dataclass(frozen=True)
class LogInfo:
    """A log.

    Attributes
    ----------
    files : tuple of Path
        In order.
    size : int
        Bytes.
    whole : bool
        Whether every file has its end and nothing was found that could have cost messages.
    checked : bool
        Whether all messages were read; otherwise the numbers are those of the indexes.
    start, end : int
        Log time of the first and of the last message [ns]; 0 if there is none.
    topics : tuple of TopicInfo
        By name.
    configurations : tuple of dict
        Configurations of the run, one for each change, with `log_time` [ns].
    damage : tuple of Damage
        What was found.
    """

    files: tuple[Path, ...]
    size: int
    whole: bool
    checked: bool
    start: int
    end: int
    topics: tuple[TopicInfo, ...]
    configurations: tuple[dict[str, str], ...]
    damage: tuple[Damage, ...]

    @property
    def messages(self) -> int:
        """Messages of all topics."""
        return sum(topic.messages for topic in self.topics)

    @property
    def duration(self) -> float:
        """Log time from the first to the last message [s]."""
        return (self.end - self.start) * 1e-9


def log_info(path: LogPath, check: bool = True) -> LogInfo:
    """Return a summary of a log.

    Parameters
    ----------
    path : path, or sequence of paths
        Bag folders and MCAP files.
    check : bool
        Whether to read all messages. Without, files with an index are not read: damage within
        them is not noticed and rates of topics are not known.

    Raises
    ------
    LogError
        If there is no such file.
    """
    damage: list[Damage] = []
    with Log(path, damage.append) as log:
        contents = log.contents(check)
        checked = check or not log.indexed
        if check:
            _compare(log)
        configurations = [c for source in log.sources for c in source.configurations()]
        rates = _sample_rates(configurations)
        times = [t for c in contents.values() if c.messages for t in (c.start, c.end)]
        start = min(times, default=0)
        topics = [
            TopicInfo(
                name=channel.topic,
                type_name=channel.type_name,
                qos=channel.qos,
                messages=count.messages,
                rate=_rate(count) if checked else None,
                gaps=_gaps(log, channel, count.messages, start, rates),
            )
            for channel, count in sorted(contents.items(), key=lambda item: item[0].topic)
        ]
        return LogInfo(
            files=tuple(source.path for source in log.sources),
            size=sum(source.size for source in log.sources),
            whole=all(s.complete for s in log.sources) and not any(d.loss for d in damage),
            checked=checked,
            start=start,
            end=max(times, default=0),
            topics=tuple(topics),
            configurations=tuple(_changes(configurations)),
            damage=tuple(damage),
        )


def _rate(count: ChannelCount) -> float | None:
    seconds = (count.end - count.start) * 1e-9
    return (count.messages - 1) / seconds if count.messages > 1 and seconds > 0 else None


def _compare(log: Log) -> None:
    """Report files whose index gives another number of messages than can be read."""
    for source in log.sources:
        about = source.index.statistics if source.index is not None else None
        found = sum(count.messages for count in source.contents().values())
        if source.index is not None and about is not None and about.message_count != found:
            reason = f'the index lists {about.message_count} messages, {found} can be read'
            log.damaged(Damage(source.path, source.index.start, reason))


def _changes(configurations: list[dict[str, str]]) -> Iterator[dict[str, str]]:
    """Leave out what each file repeats of the one before."""
    previous: dict[str, str] = {}
    for configuration in sorted(configurations, key=lambda c: int(c.get('log_time', 0))):
        content = {key: text for key, text in configuration.items() if key != 'log_time'}
        if content != previous:
            yield configuration
        previous = content


def _sample_rates(configurations: list[dict[str, str]]) -> set[float]:
    """Return the sample rates [Hz] of the rigs that the log describes."""
    rates = set()
    for text in {text for configuration in configurations for text in configuration.values()}:
        with contextlib.suppress(ValueError):
            rates.add(Rig.from_text(text).sample_rate)
    return rates


def _gaps(
    log: Log, channel: LogChannel, count: int, start: int, rates: set[float]
) -> tuple[Gap, ...]:
    """Return the gaps of a stream of samples; all of it is read only if its ends do not fit."""
    if not is_samples(channel.topic) or count < 2:
        return ()
    first = _table(next(log.messages([channel.topic]), None))
    period = _period(first, rates)
    last = None if first is None or period is None else _table(_last(log, channel.topic))
    if first is None or period is None or last is None:
        return ()
    samples = (last.stamp_ns - first.stamp_ns) * 1e-9 / period
    expected = (count - 1) * len(first.rows)
    if len(first.rows) == len(last.rows) and abs(samples - expected) < 0.25:
        return ()
    return tuple(_find_gaps(log, channel.topic, period, start))


def _find_gaps(log: Log, topic: str, period: float, start: int) -> Iterator[Gap]:
    expected: float | None = None
    for item in log.messages([topic]):
        table = _table(item)
        if table is None:
            continue
        if expected is not None and abs(table.stamp_ns - expected) * 1e-9 > period / 2:
            seconds = (table.stamp_ns - expected) * 1e-9
            yield Gap((item[1].log_time - start) * 1e-9, seconds)
        expected = table.stamp_ns + len(table.rows) * period * 1e9


def _period(table: DecodedTable | None, rates: set[float]) -> float | None:
    """Return the spacing of column t [s].

    It is as precise as the float32 that t comes in, unless one of the known rates is meant.
    """
    if table is None or 't' not in (table.rows.dtype.names or ()) or len(table.rows) < 2:
        return None
    t = table.rows['t'].astype(np.float64)
    with np.errstate(all='ignore'):
        period = float(t[-1] - t[0]) / (len(t) - 1)
        steady = period > 0 and bool(np.all(abs(np.diff(t) - period) < 0.01 * period))
    if not steady:
        return None
    return next((1 / rate for rate in rates if abs(period * rate - 1) < 1e-5), period)


def _table(item: tuple[McapSource, ReadMessage] | None) -> DecodedTable | None:
    if item is None:
        return None
    try:
        return decode_table(item[1].data)
    except TableError:
        return None


def _last(log: Log, topic: str) -> tuple[McapSource, ReadMessage] | None:
    """Return the last message of a topic, from the last chunk that has one."""
    starts = []
    for source in log.sources:
        numbers = {n for n, channel in source.channels.items() if channel.topic == topic}
        if source.index is not None:
            starts += [
                chunk.message_start_time
                for chunk in source.index.chunks.values()
                if numbers.intersection(chunk.message_index_offsets)
            ]
    last = None
    for item in log.messages([topic], start=max(starts) if starts and log.indexed else None):
        last = item
    return last
