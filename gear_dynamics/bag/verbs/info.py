"""Tell what a log holds: topics, types, counts, rates, gaps, configuration, whole or cut."""

from __future__ import annotations

import argparse
import datetime
from collections.abc import Iterator

from gear_dynamics.bag.info import LogInfo, TopicInfo, log_info
from gear_dynamics.bag.source import LogError

GAPS_SHOWN = 10


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the verb takes."""
    parser.add_argument('log', nargs='+', help='bag folders or MCAP files')


def run(arguments: argparse.Namespace) -> int:
    """Print it."""
    info = log_info(arguments.log)
    print('\n'.join(lines(info)))
    if not (info.whole or info.messages or info.configurations):
        raise LogError('nothing in the log can be read')
    return 0


def lines(info: LogInfo) -> Iterator[str]:
    """Iterate over the lines that tell of a log."""
    for file in info.files:
        yield f'file           {file}'
    yield f'size           {info.size / 1e6:.1f} MB'
    state = 'whole' if info.whole else 'cut or damaged: `log recover` makes a sound copy'
    yield f'state          {state}'
    for damage in info.damage:
        yield f'damage         {damage}'
    yield f'start          {_local(info.start)}'
    yield f'duration       {info.duration:.3f} s'
    yield f'messages       {info.messages}'
    yield from _table(info)
    for topic in info.topics:
        for gap in topic.gaps[:GAPS_SHOWN]:
            yield f'gap            {topic.name}: {gap.duration:+.6f} s at {gap.at:.3f} s'
        if len(topic.gaps) > GAPS_SHOWN:
            yield f'gap            {topic.name}: and {len(topic.gaps) - GAPS_SHOWN} more'
    for configuration in info.configurations:
        yield f'configuration from {_local(int(configuration["log_time"]))}'
        for key, text in configuration.items():
            if key != 'log_time':
                yield from _entry(key, text)


def _local(nanoseconds: int) -> str:
    """Return the local time, as far as the calendar goes."""
    try:
        time = datetime.datetime.fromtimestamp(nanoseconds * 1e-9).astimezone()
    except (ValueError, OverflowError, OSError):
        return f'{nanoseconds} ns'
    return time.isoformat(sep=' ', timespec='milliseconds')


def _table(info: LogInfo) -> Iterator[str]:
    rows = [('topic', 'type', 'messages', 'rate [Hz]', 'gaps')]
    rows += [_row(topic) for topic in info.topics]
    widths = [max(len(row[column]) for row in rows) for column in range(4)]
    for name, kind, count, rate, gaps in rows:
        yield (
            f'  {name:<{widths[0]}}  {kind:<{widths[1]}}  {count:>{widths[2]}}  '
            f'{rate:>{widths[3]}}  {gaps}'
        )


def _row(topic: TopicInfo) -> tuple[str, str, str, str, str]:
    rate = '-' if topic.rate is None else f'{topic.rate:.3f}'
    return (topic.name, topic.type_name, str(topic.messages), rate, str(len(topic.gaps)))


def _entry(key: str, text: str) -> Iterator[str]:
    if '\n' not in text.strip():
        yield f'  {key}: {text.strip()}'
        return
    yield f'  {key}:'
    for line in text.rstrip().splitlines():
        yield f'    {line}'
