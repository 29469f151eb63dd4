"""The signals of a machine in given recordings: where each stands, and at which rate."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Iterator, Sequence

import numpy as np

from gear_dynamics.machine.machine import Machine
from gear_dynamics.machine.shaft import Angle, SpeedColumn, Tacho
from gear_dynamics.machine.source import Source, Time
from gear_dynamics.machine.units import factor
from gear_dynamics.recordings.table import RecordingError, RecordingTable, matches

SAME_RATE = 1e-3
"""Relative difference of two statements of a rate that is an error."""


@dataclasses.dataclass(frozen=True)
class FoundSignal:
    """A signal that was found.

    Attributes
    ----------
    name : str
        Of the channel or of the shaft.
    parts : tuple of (RecordingTable, str)
        Recordings and columns that follow each other.
    rate : float
        [Hz]; 0 for a single number.
    scale : float
        Factor to the unit that is analysed.
    origin : str
        Where it stands, in words.
    """

    name: str
    parts: tuple[tuple[RecordingTable, str], ...]
    rate: float
    scale: float
    origin: str


class Signals:
    """The signals of a machine in recordings.

    Parameters
    ----------
    machine : Machine
    tables : sequence of RecordingTable
        One recording, in one or more files.

    Attributes
    ----------
    channels, shafts : dict of str to FoundSignal
        Of shafts only those whose speed is recorded.
    failures : dict of str to str
        Why a channel, or the speed of a shaft, could not be found.
    notes : list of str
    """

    def __init__(self, machine: Machine, tables: Sequence[RecordingTable]) -> None:
        self._machine = machine
        self._tables = tables
        self._patterns = [
            source.file for source in _sources(machine) if source is not None and source.file
        ]
        self.channels: dict[str, FoundSignal] = {}
        self.shafts: dict[str, FoundSignal] = {}
        self.failures: dict[str, str] = {}
        self.notes: list[str] = []
        self._timed: dict[tuple[int, Time], TimeBase] = {}
        for channel in machine.channels:
            try:
                found = self._find(channel.name, channel.source, channel.scale)
                if found.rate == 0:
                    raise RecordingError(f'{found.origin} is a single number')
                self.channels[channel.name] = found
                self._check_unit(channel.recorded_unit, found)
                if found.parts[0][0].relative and channel.full_scale is None:
                    self.notes.append(
                        f'{found.origin} holds shares of full scale, and the machine file gives no '
                        f'full_scale: 1.0 {channel.recorded_unit} is assumed'
                    )
            except RecordingError as error:
                self.failures[f'channel {channel.name}'] = str(error)
        for shaft in machine.shafts:
            if isinstance(shaft.speed, Tacho | Angle | SpeedColumn):
                try:
                    self.shafts[shaft.name] = self._find(shaft.name, shaft.speed.source, 1.0)
                except RecordingError as error:
                    self.failures[f'the speed of shaft {shaft.name}'] = str(error)
        self.notes = list(dict.fromkeys(self.notes))

    def open(self) -> tuple[dict[str, Iterator[np.ndarray]], dict[str, Iterator[np.ndarray]]]:
        """Return the values of channels and shafts as iterators of blocks, scaled."""
        opener = _Opener([*self.channels.values(), *self.shafts.values()])
        return (
            {name: opener.values(each) for name, each in self.channels.items()},
            {name: opener.values(each) for name, each in self.shafts.items()},
        )

    def gaps(self) -> list[float]:
        """Return the instants [s] at which a time column jumps."""
        return sorted({index / base.rate for base in self._timed.values() for index in base.gaps})

    def _find(self, name: str, source: Source, scale: float) -> FoundSignal:
        tables = self._candidates(source)
        parts = []
        for table in tables:
            column = table.resolve(source.column, source.topic)
            parts.append((table, column))
            self.notes += [note for key, note in table.notes.items() if key in ('', column)]
        table, column = parts[0]
        origin = f'{column} of {table.name}' + (f' and {len(parts) - 1} more' * (len(parts) > 1))
        if column in table.constants:
            return FoundSignal(name, parts[:1], 0.0, scale, origin)  # type: ignore[arg-type]
        rates = [self._rate(source, *part) for part in parts]
        for (other, _), rate in zip(parts, rates, strict=True):
            if abs(rate - rates[0]) > 5 * SAME_RATE * rates[0]:
                raise RecordingError(
                    f'{table.name} is sampled at {rates[0]:g} Hz and {other.name} at {rate:g} Hz: '
                    'they are no recording end to end'
                )
        return FoundSignal(name, tuple(parts), float(np.mean(rates)), scale, origin)

    def _candidates(self, source: Source) -> list[RecordingTable]:
        """Return the files in which a signal stands, in their order."""
        if source.file is not None:
            found = [table for table in self._tables if matches(table.name, source.file)]
            if not found:
                names = ', '.join(table.name for table in self._tables[:8])
                raise RecordingError(f'no recording matches {source.file!r}: given are {names}')
        else:
            found = [
                table
                for table in self._tables
                if not any(matches(table.name, pattern) for pattern in self._patterns)
            ] or list(self._tables)
        if self._machine.recording.files == 'joined' or len(found) == 1:
            return found
        return [self._only(found, source)]

    def _only(self, tables: list[RecordingTable], source: Source) -> RecordingTable:
        """Return the one of files side by side that has a column."""
        having, reason = [], ''
        for table in tables:
            try:
                table.resolve(source.column, source.topic)
                having.append(table)
            except RecordingError as error:
                reason = str(error)
        if len(having) == 1:
            return having[0]
        if not having:
            raise RecordingError(reason)
        names = ', '.join(table.name for table in having[:8])
        raise RecordingError(f'column {source.column!r} stands in {names}: say which by file')

    def _rate(self, source: Source, table: RecordingTable, column: str) -> float:
        form = self._machine.recording
        own = source.sample_rate is not None or source.time is not None
        rate = source.sample_rate if own else form.sample_rate
        time = source.time if own else form.time
        stated, words = None, ''
        if isinstance(rate, str):
            stated, words = _constant(table, rate), f'its {rate}'
        elif rate is not None:
            stated, words = rate, 'the machine file'
        elif time is not None:
            key = (id(table), time)
            if key not in self._timed:
                self._timed[key] = scan_time(table, time)
            base = self._timed[key]
            stated, words = base.rate, 'its time column'
            if base.gaps:
                self.notes.append(f'the time of {table.name} jumps {len(base.gaps)} times')
        in_file = table.rate(column)
        if stated is None and in_file is None:
            raise RecordingError(
                f'{table.name} states no sample rate: give sample_rate in the machine file, or '
                'time with the column that holds it'
            )
        both = stated is not None and in_file is not None
        if both and abs(stated - in_file) > SAME_RATE * in_file:  # type: ignore[operator]
            raise RecordingError(
                f'the sample rate of {table.name} is {in_file:g} Hz by the file and '
                f'{stated:g} Hz by {words}: one of them is wrong'
            )
        result = stated if stated is not None else in_file
        if result is None or not 0 < result < np.inf:
            raise RecordingError(f'the sample rate of {table.name} is {result}: it must be above 0')
        return float(result)

    def _check_unit(self, recorded: str, found: FoundSignal) -> None:
        table, column = found.parts[0]
        stated = table.unit(column)
        if stated and recorded != 'unknown' and stated.replace('^', '') != recorded:
            self.notes.append(
                f'{found.origin} is in {stated!r} by the file and in {recorded!r} by the machine '
                'file, which counts'
            )
        elif stated and recorded == 'unknown':
            self.notes.append(
                f'{found.origin} is in {stated!r} by the file; the machine file states no unit, so '
                'that none is assumed'
            )


def _sources(machine: Machine) -> Iterator[Source]:
    for channel in machine.channels:
        yield channel.source
    for shaft in machine.shafts:
        if isinstance(shaft.speed, Tacho | Angle | SpeedColumn):
            yield shaft.speed.source


def _constant(table: RecordingTable, name: str) -> float:
    column = table.resolve(name)
    if column in table.constants:
        return table.constants[column]
    for block in table.open([column])[column]:
        if len(block):
            return float(block[0])
    raise RecordingError(f'{name} of {table.name} holds no value')


class _Opener:
    """Opens each recording once for all of its columns, when the first of them is read."""

    def __init__(self, signals: Sequence[FoundSignal]) -> None:
        self._columns: dict[int, list[str]] = {}
        for table, column in itertools.chain.from_iterable(each.parts for each in signals):
            wanted = self._columns.setdefault(id(table), [])
            if column not in wanted:
                wanted.append(column)
        self._opened: dict[int, dict[str, Iterator[np.ndarray]]] = {}

    def values(self, signal: FoundSignal) -> Iterator[np.ndarray]:
        """Yield the scaled blocks of a signal, file after file."""
        for table, column in signal.parts:
            key = id(table)
            if key not in self._opened:
                self._opened[key] = table.open(self._columns[key])
            blocks = self._opened[key].pop(column, None)
            if blocks is None:  # a second signal of the same column
                blocks = table.open([column])[column]
            for block in blocks:
                yield block * signal.scale if signal.scale != 1.0 else block


@dataclasses.dataclass(frozen=True)
class TimeBase:
    """What a time column says: rate [Hz], first instant [s], and the samples after jumps."""

    rate: float
    start: float
    gaps: tuple[int, ...]


def scan_time(table: RecordingTable, time: Time) -> TimeBase:
    """Return the mean rate of a time column; jumps of more than a step and a half are left out.

    Raises
    ------
    RecordingError
        If the time does not rise.
    """
    columns = [table.resolve(column) for column in time.columns]
    factors = [factor(unit, 's') for unit in time.units]
    opened = table.open(columns)
    last, first, offset = None, 0.0, 0.0
    count = gap_count = 0
    total = 0.0
    step = None
    gaps: list[int] = []
    for blocks in zip(*(opened[column] for column in columns), strict=True):
        seconds = np.sum([f * block for f, block in zip(factors, blocks, strict=True)], axis=0)
        if not len(seconds):
            continue
        if last is None:
            first = float(seconds[0])
            steps = np.diff(seconds)
        else:
            steps = np.diff(seconds, prepend=last)
        steps = np.where(np.isnan(steps), 0.0 if step is None else step, steps)
        # The time of day begins anew at midnight.
        steps[steps < -43200] += 86400
        if step is None and len(steps):
            step = float(np.median(steps))
        if step is not None and np.any(steps < -0.5 * step):
            raise RecordingError(f'the time of {table.name} goes back')
        jumps = np.flatnonzero(steps > 1.5 * step) if step else np.empty(0, int)
        gaps += [count + int(j) + (last is None) for j in jumps]
        total += float(np.sum(np.delete(steps, jumps)))
        gap_count += len(jumps)
        count += len(seconds)
        last = float(seconds[-1]) + offset
    good = count - 1 - gap_count
    if good < 1 or total <= 0:
        raise RecordingError(f'the time of {table.name} does not rise')
    return TimeBase(good / total, first, tuple(gaps))
