"""What a log holds: topics, counts, rates, gaps, times, configuration, whole or cut."""

from __future__ import annotations

import contextlib
import dataclasses
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from gear_dynamics.bag.log import SAMPLES_TOPIC, Log, LogPath
from gear_dynamics.bag.source import Damage, LogChannel, McapSource, ReadMessage
from gear_dynamics.machine.configuration import Rig
from gear_dynamics.wire.tables import Table, TableError, decode_table


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
        Messages a second over the whole log; None for fewer than two.
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
        Whether every file ends with a sound index.
    start, end : int
        Log time of the first and of the last message [ns]; 0 if there is none.
    topics : tuple of TopicInfo
        By name.
    configurations : tuple of dict
        What the writer noted of the run, with `log_time` [ns]; a further one for each change.
    damage : tuple of Damage
        What was found; chunks of a whole file are looked at only when they are read.
    """

    files: tuple[Path, ...]
    size: int
    whole: bool
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


def log_info(path: LogPath) -> LogInfo:
    """Tell what a log holds: from the index where there is one, from all its bytes otherwise.

    Parameters
    ----------
    path : path, or sequence of paths
        Bag folders and MCAP files.

    Raises
    ------
    LogError
        If there is no such file.
    """
    damage: list[Damage] = []
    with Log(path, damage.append) as log:
        counts, start, end = _count(log)
        configurations = [c for source in log.sources for c in source.configurations()]
        rates = _sample_rates(configurations)
        seconds = (end - start) * 1e-9
        topics = [
            TopicInfo(
                name=channel.topic,
                type_name=channel.type_name,
                qos=channel.qos,
                messages=count,
                rate=(count - 1) / seconds if count > 1 and seconds > 0 else None,
                gaps=_gaps(log, channel, count, start, rates),
            )
            for channel, count in sorted(counts.items(), key=lambda item: item[0].topic)
        ]
        return LogInfo(
            files=tuple(source.path for source in log.sources),
            size=sum(source.size for source in log.sources),
            whole=log.indexed,
            start=start,
            end=end,
            topics=tuple(topics),
            configurations=tuple(_changes(configurations)),
            damage=tuple(damage),
        )


def _count(log: Log) -> tuple[dict[LogChannel, int], int, int]:
    """Return the number of messages of each channel, and the first and last log time."""
    counts: dict[LogChannel, int] = {}
    times: list[int] = []
    for source in log.sources:
        for channel, count, first, last in _count_file(source):
            counts[channel] = counts.get(channel, 0) + count
            times += [first, last] if count else []
    return counts, min(times, default=0), max(times, default=0)


def _count_file(source: McapSource) -> Iterator[tuple[LogChannel, int, int, int]]:
    statistics = source.summary.statistics if source.summary else None
    if statistics is not None:
        for number, channel in source.channels.items():
            count = statistics.channel_message_counts.get(number, 0)
            yield channel, count, statistics.message_start_time, statistics.message_end_time
        return
    found: dict[LogChannel, list[int]] = {}
    for message in source.messages():
        seen = found.setdefault(message.channel, [0, message.log_time, message.log_time])
        seen[0] += 1
        seen[1:] = min(seen[1], message.log_time), max(seen[2], message.log_time)
    for channel, (count, first, last) in found.items():
        yield channel, count, first, last


def _changes(configurations: list[dict[str, str]]) -> Iterator[dict[str, str]]:
    """Leave out what each file repeats of the one before."""
    previous: dict[str, str] = {}
    for configuration in sorted(configurations, key=lambda c: int(c.get('log_time', 0))):
        content = {key: text for key, text in configuration.items() if key != 'log_time'}
        if content != previous:
            yield configuration
        previous = content


def _sample_rates(configurations: list[dict[str, str]]) -> set[float]:
    """Return the sample rates of the rigs that the log tells of [Hz]."""
    rates = set()
    for text in {text for configuration in configurations for text in configuration.values()}:
        with contextlib.suppress(ValueError):
            rates.add(Rig.from_text(text).sample_rate)
    return rates


def _gaps(
    log: Log, channel: LogChannel, count: int, start: int, rates: set[float]
) -> tuple[Gap, ...]:
    """Return the gaps of a stream of samples; read through only if its ends do not fit."""
    if not channel.topic.endswith('/' + SAMPLES_TOPIC) or count < 2:
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


def _period(table: Table | None, rates: set[float]) -> float | None:
    """Return the spacing of column t [s].

    It is as precise as the float32 that t comes in, unless one of the known rates is meant.
    """
    if table is None or 't' not in (table.rows.dtype.names or ()) or len(table.rows) < 2:
        return None
    t = table.rows['t'].astype(np.float64)
    period = float(t[-1] - t[0]) / (len(t) - 1)
    steady = period > 0 and bool(np.all(abs(np.diff(t) - period) < 0.01 * period))
    if not steady:
        return None
    return next((1 / rate for rate in rates if abs(period * rate - 1) < 1e-5), period)


def _table(item: tuple[McapSource, ReadMessage] | None) -> Table | None:
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
        if source.summary is not None:
            starts += [
                index.message_start_time
                for index in source.summary.chunk_indexes
                if numbers.intersection(index.message_index_offsets)
            ]
    last = None
    for item in log.messages([topic], start=max(starts) if starts and log.indexed else None):
        last = item
    return last
