"""What a log holds, as the lines that `log info` prints."""

from __future__ import annotations

import datetime
from collections.abc import Iterator

from gear_dynamics.bag.info import LogInfo, TopicInfo
from gear_dynamics.bag.log import printable

GAPS_SHOWN = 10
"""Gaps of a topic that are listed one by one."""

DAMAGE_SHOWN = 20
"""Damaged places that are listed one by one."""


def info_lines(info: LogInfo) -> Iterator[str]:
    """Iterate over the lines that describe a log."""
    for file in info.files:
        yield f'file           {printable(str(file))}'
    yield f'size           {info.size / 1e6:.1f} MB'
    yield f'state          {_state(info)}'
    for word, loss in (('damage', True), ('note', False)):
        told = [printable(str(each)) for each in info.damage if each.loss == loss]
        yield from _listed(word, told, DAMAGE_SHOWN)
    yield f'start          {_local(info.start)}'
    yield f'duration       {info.duration:.3f} s'
    yield f'messages       {info.messages}'
    yield from _table(info)
    for topic in info.topics:
        gaps = [f'{gap.duration:+.6f} s at {gap.at:.3f} s' for gap in topic.gaps]
        name = printable(topic.name)
        yield from _listed('gap', [f'{name}: {gap}' for gap in gaps], GAPS_SHOWN)
    for configuration in info.configurations:
        yield f'configuration from {_local(int(configuration["log_time"]))}'
        for key, text in configuration.items():
            if key != 'log_time':
                yield from _entry(key, text)


def _state(info: LogInfo) -> str:
    if not info.whole:
        return 'cut or damaged: `log recover` makes a sound copy'
    return 'whole' if info.checked else 'whole by its index; without --quick all is checked'


def _listed(word: str, items: list[str], most: int) -> Iterator[str]:
    for item in items[:most]:
        yield f'{word:<14} {item}'
    if len(items) > most:
        yield f'{word:<14} and {len(items) - most} more'


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
    kind = printable(topic.type_name or '-')
    return (printable(topic.name), kind, str(topic.messages), rate, str(len(topic.gaps)))


def _entry(key: str, text: str) -> Iterator[str]:
    if '\n' not in text.strip():
        yield f'  {printable(key)}: {printable(text.strip())}'
        return
    yield f'  {printable(key)}:'
    for line in text.rstrip().splitlines():
        yield f'    {printable(line)}'
