"""The analysis of a machine's live stream: blocks in, results of each span out."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from gear_dynamics.machine.machine import Machine
from gear_dynamics.machine.parts import DEFECTS
from gear_dynamics.machine.shaft import Angle, SpeedColumn, Tacho
from gear_dynamics.machine.source import Source
from gear_dynamics.monitoring.health import Health
from gear_dynamics.monitoring.level import Level
from gear_dynamics.monitoring.results import (
    ConditionResult,
    ConditionRow,
    Result,
    StreamSpan,
    TableResult,
)
from gear_dynamics.monitoring.spans.analysis import SpanAnalysis
from gear_dynamics.monitoring.spans.data import Signal, Span, SpanResult
from gear_dynamics.monitoring.spans.summary import MeanSpectrum
from gear_dynamics.monitoring.task import columns_table

LONGEST_SPAN = 10.0
"""Span of a machine file that has `span: record` [s]: a stream has no end."""


class JitteredStamps:
    """Check whether blocks follow each other by stamps that jitter.

    A block follows if its stamp misses its place by less than half a block. The expected place
    moves with the stamps slowly, so that the clock of a data logger may drift.

    Parameters
    ----------
    rate : float
        [Hz]
    """

    FOLLOW = 0.05
    """Fraction of each deviation that the expected stamp takes over."""

    def __init__(self, rate: float) -> None:
        self._rate = rate
        self._due: float | None = None

    def missing(self, stamp_ns: int, width: int) -> int | None:
        """Take a block; return how many samples are missing before it, None if it goes back."""
        due, duration = self._due, width * 1e9 / self._rate
        if due is None or abs(stamp_ns - due) <= 0.5 * duration:
            place = stamp_ns if due is None else due + self.FOLLOW * (stamp_ns - due)
            self._due = place + duration
            return 0
        if stamp_ns < due:
            return None
        self._due = stamp_ns + duration
        return round((stamp_ns - due) * self._rate / 1e9)


class MachineMonitor:
    """Analyses the stream of a machine span by span, as `gd.analyse` does a recording.

    Parameters
    ----------
    machine : Machine
        Its columns are those of the stream; a rate that is no number is taken from the column t.
    """

    def __init__(self, machine: Machine) -> None:
        self.machine = machine
        self.health = Health(configured=True)
        self._engine = SpanAnalysis(machine)
        rate = machine.recording.sample_rate
        self._rate = rate if isinstance(rate, float) else None
        self._length = machine.recording.span or LONGEST_SPAN
        self._stamps: JitteredStamps | None = None
        self._sources = dict(_sources(machine))
        self._held: dict[tuple[str, str], list[np.ndarray]] = {}
        self._count = 0
        self._start_ns = 0
        self._origin_ns = 0
        self._done = 0

    def add_block(self, stamp_ns: int, rows: np.ndarray) -> list[Result]:
        """Take a block of samples; return the results of the spans that it completes.

        A block that cannot be used is dropped and counted; after a gap the span begins anew.

        Parameters
        ----------
        stamp_ns : int
            Header stamp [ns].
        rows : ndarray
            Structured, with the columns of the machine file.
        """
        health = self.health
        values = self._values(rows)
        if values is None:
            return []
        if self._rate is None or self._stamps is None:
            self._rate = self._rate or _rate_of(rows)
            if self._rate is None:
                health.drop('rate', 'the machine file has no sample_rate, and the stream no t')
                return []
            self._stamps = JitteredStamps(self._rate)
            self._origin_ns = stamp_ns
        missing = self._stamps.missing(stamp_ns, len(rows))
        if missing is None:
            health.drop('back', f'stamp {stamp_ns} ns goes back')
            return []
        if missing:
            health.gaps += 1
            health.missing += missing
            health.restarts['gap'] += 1
        if missing or self._held.keys() != values.keys():
            self._begin(stamp_ns)
        if self._count == 0:
            self._start_ns = stamp_ns
        for key, block in values.items():
            self._held.setdefault(key, []).append(block)
        self._count += len(rows)
        health.blocks += 1
        return list(self._complete())

    def _begin(self, stamp_ns: int) -> None:
        self._held = {}
        self._count = 0
        self._start_ns = stamp_ns

    def _values(self, rows: np.ndarray) -> dict[tuple[str, str], np.ndarray] | None:
        names = rows.dtype.names or ()
        if len(rows) == 0:
            self.health.drop('empty', 'the block has no rows')
            return None
        found = {}
        for key, source in self._sources.items():
            column = _column(source, names)
            if column is not None:
                found[key] = rows[column].astype(np.float64)
        if not any(kind == 'channel' for kind, _ in found):
            wanted = ', '.join(
                str(source.column) for (kind, _), source in self._sources.items() if kind != 'shaft'
            )
            self.health.drop('columns', f'the block has none of the columns {wanted}')
            return None
        for (_, name), block in found.items():
            if not np.isfinite(block).all():
                self.health.drop('not finite', f'{name} holds a value that is not finite')
                return None
        return found

    def _complete(self) -> Iterator[Result]:
        assert self._rate is not None
        length = round(self._length * self._rate)
        while self._count >= length:
            joined = {key: np.concatenate(blocks) for key, blocks in self._held.items()}
            yield from self._analyse({key: values[:length] for key, values in joined.items()})
            self._held = {key: [values[length:]] for key, values in joined.items()}
            self._count -= length
            self._start_ns += round(length * 1e9 / self._rate)

    def _analyse(self, values: dict[tuple[str, str], np.ndarray]) -> Iterator[Result]:
        assert self._rate is not None
        start = (self._start_ns - self._origin_ns) / 1e9
        channels = {
            name: Signal(block * self.machine.channel(name).scale, self._rate, start)
            for (kind, name), block in values.items()
            if kind == 'channel'
        }
        shafts = {
            name: Signal(block, self._rate, start)
            for (kind, name), block in values.items()
            if kind == 'shaft'
        }
        duration = len(next(iter(channels.values())).values) / self._rate
        result = self._engine.analyse(Span(start, duration, channels, shafts))
        span = StreamSpan(self._start_ns, duration)
        self.health.seconds += duration
        yield TableResult('spectrum', span, _spectrum(channels))
        yield ConditionResult(span, tuple(self._rows(result, channels)))

    def _rows(self, result: SpanResult, channels: dict[str, Signal]) -> Iterator[ConditionRow]:
        notes = {f'note_{number}': text for number, text in enumerate(result.notes, 1)}
        for name in channels:
            level, message = self._judged(name, result)
            yield ConditionRow(name, level, message, _numbers(name, result), notes)
        for shaft in self.machine.shafts:
            values = _numbers(shaft.name, result)
            note = result.shafts[shaft.name].note
            level = Level.WARN if note else Level.OK
            yield ConditionRow(shaft.name, level, note or 'its speed is known', values, {})

    def _judged(self, channel: str, result: SpanResult) -> tuple[Level, str]:
        """Return the level of a channel, by bearing faults and severity zone, and why."""
        level, reasons = Level.OK, []
        for (its, bearing), state in result.bearings.items():
            if its == channel and state.named in DEFECTS:
                line = state.lines[state.named]
                level = Level.WARN
                reasons.append(
                    f'bearing {bearing}: {state.named} stands out by {line.level:.1f} dB at order '
                    f'{line.order:.3f}'
                )
            elif its == channel and state.named:
                reasons.append(f'bearing {bearing}: {state.named}')
        velocity = float(result.values.get(f'{channel}/velocity_rms', math.nan))
        if self.machine.severity is not None and not math.isnan(velocity):
            zone = self.machine.severity.zone(velocity)
            reasons.append(f'zone {zone}')
            level = max(level, {'C': Level.WARN, 'D': Level.ERROR}.get(zone, Level.OK))
        return level, '; '.join(reasons) or 'nothing stands out'


def _sources(machine: Machine) -> Iterator[tuple[tuple[str, str], Source]]:
    for channel in machine.channels:
        yield ('channel', channel.name), channel.source
    for shaft in machine.shafts:
        if isinstance(shaft.speed, Tacho | Angle | SpeedColumn):
            yield ('shaft', shaft.name), shaft.speed.source


def _column(source: Source, names: tuple[str, ...]) -> str | None:
    if isinstance(source.column, int):
        return names[source.column - 1] if source.column <= len(names) else None
    return source.column if source.column in names else None


def _rate_of(rows: np.ndarray) -> float | None:
    """Return the rate by the column t of a block, None without one."""
    if 't' not in (rows.dtype.names or ()) or len(rows) < 2:
        return None
    duration = float(rows['t'][-1]) - float(rows['t'][0])
    return (len(rows) - 1) / duration if duration > 0 else None


def _spectrum(channels: dict[str, Signal]) -> np.ndarray:
    spectra = {}
    for name, signal in channels.items():
        spectra[name] = MeanSpectrum(signal)
        spectra[name].add(signal.values)
    frequency = next(iter(spectra.values())).frequency
    amplitudes = np.column_stack([spectrum.amplitude for spectrum in spectra.values()])
    return columns_table('frequency', frequency, tuple(spectra), amplitudes)


def _numbers(subject: str, result: SpanResult) -> dict[str, float]:
    """Return the values of a subject by their names without it."""
    return {
        column.partition('/')[2]: float(value)
        for column, value in result.values.items()
        if column.startswith(f'{subject}/')
    }
