"""The angles of all shafts in a span, from what the machine says of their speeds."""

from __future__ import annotations

import math

import numpy as np

from gear_dynamics.machine.machine import Machine
from gear_dynamics.machine.shaft import (
    Angle,
    FixedSpeed,
    Shaft,
    SpeedColumn,
    Tacho,
    TrackedSpeed,
)
from gear_dynamics.machine.units import factor
from gear_dynamics.monitoring.spans.data import ShaftState, Signal, Span
from gear_dynamics.signal.shaft_phase import (
    ShaftPhase,
    phase_from_angle,
    phase_from_constant,
    phase_from_pulses,
    phase_from_speed,
)
from gear_dynamics.signal.speed_tracking import TrackedLine, track_speed
from gear_dynamics.signal.tacho import repair_pulses, rising_edges, trigger_level

REMEMBERED = 8
"""Pulses of the span before that are kept, so that the angle begins with the span."""

LONGEST_GAP = 4
"""Pulses missing in a row from which on the tachometer has stopped."""


class ShaftPhases:
    """Finds the angles of a machine's shafts, span after span.

    Parameters
    ----------
    machine : Machine
    """

    def __init__(self, machine: Machine) -> None:
        self._machine = machine
        self._tachos = {
            shaft.name: _TachoReader(shaft.speed)
            for shaft in machine.shafts
            if isinstance(shaft.speed, Tacho)
        }
        self._tracked_on: dict[str, str] = {}

    def find(self, span: Span) -> dict[str, ShaftState]:
        """Return every shaft's state in a span."""
        roots: dict[str, ShaftState] = {}
        states = {}
        for shaft in self._machine.shafts:
            root, ratio = self._machine.root(shaft.name)
            if root.name not in roots:
                roots[root.name] = self._root(root, span)
            state = roots[root.name]
            if shaft.name != root.name and state.phase is not None:
                turned = ShaftPhase(state.phase.time, state.phase.revolutions * float(ratio))
                state = ShaftState(
                    turned, state.origin, state.uncertainty * float(ratio), state.at_limit
                )
            states[shaft.name] = state
        return states

    def _root(self, shaft: Shaft, span: Span) -> ShaftState:
        try:
            return self._find_root(shaft, span)
        except ValueError as error:
            return ShaftState(None, _origin(shaft), note=f'shaft {shaft.name}: {error}')

    def _find_root(self, shaft: Shaft, span: Span) -> ShaftState:
        end = span.start + span.duration
        how = shaft.speed
        if how is None:
            raise ValueError('nothing tells its speed')
        if isinstance(how, FixedSpeed):
            speed = how.speed / (2 * math.pi)
            return ShaftState(phase_from_constant(speed, span.start, end), 'fixed')
        if isinstance(how, TrackedSpeed):
            return self._track(shaft, how, span)
        if shaft.name not in span.shafts:
            raise ValueError('what tells its speed is missing here')
        signal = span.shafts[shaft.name]
        if isinstance(how, Tacho):
            phase, note = self._tachos[shaft.name].read(signal)
            return ShaftState(phase, 'tacho', note=note and f'shaft {shaft.name}: {note}')
        if not np.all(np.isfinite(signal.values)):
            raise ValueError('what tells its speed holds values that are not finite')
        if isinstance(how, Angle):
            phase = phase_from_angle(signal.values, signal.rate, how.revolution, signal.start)
            return ShaftState(phase, 'angle')
        assert isinstance(how, SpeedColumn)
        speeds = signal.values * factor(how.unit, 'rad/s') / (2 * math.pi)
        if len(speeds) == 1:
            if not speeds[0] > 0:
                raise ValueError(f'the recorded speed is {signal.values[0]:g} {how.unit}')
            return ShaftState(phase_from_constant(speeds[0], span.start, end), 'fixed')
        return ShaftState(phase_from_speed(speeds, signal.rate, signal.start), 'speed')

    def _track(self, shaft: Shaft, how: TrackedSpeed, span: Span) -> ShaftState:
        names = [how.channel] if how.channel else [c.name for c in self._machine.channels]
        if shaft.name in self._tracked_on:
            names = [self._tracked_on[shaft.name]]
        names = [name for name in names if name in span.channels]
        if not names:
            raise ValueError('the channel to track its speed by is missing here')
        orders = [how.order] if how.order else self._lines(shaft)
        found: list[tuple[float, str, TrackedLine]] = []
        reasons = []
        for name in names:
            signal = span.channels[name]
            try:
                line = track_speed(
                    signal.values,
                    signal.rate,
                    how.lowest / (2 * math.pi),
                    how.highest / (2 * math.pi),
                    orders,
                    self._spacing(shaft),
                    signal.start,
                )
            except ValueError as error:
                reasons.append(str(error))
                continue
            found.append((line.height, name, line))
        if not found:
            raise ValueError(reasons[0])
        _, name, line = max(found)
        self._tracked_on[shaft.name] = name
        note = ''
        if line.at_limit:
            note = (
                f'shaft {shaft.name}: the tracked speed stays at a limit of its range, '
                'the true one may lie beyond'
            )
        return ShaftState(line.phase, 'tracked', line.uncertainty, line.at_limit, note)

    def _lines(self, shaft: Shaft) -> list[float]:
        """Return the orders of a root shaft by which it may be tracked."""
        orders: set[float] = set()
        for mesh in self._machine.meshes:
            driver = self._machine.wheel(mesh.driver)
            root, ratio = self._machine.root(driver.shaft)
            if root.name == shaft.name:
                orders |= {driver.teeth * float(ratio) * k for k in (1, 2, 3)}
        return sorted(orders or {1.0, 2.0, 3.0})

    def _spacing(self, shaft: Shaft) -> float:
        """Return the least speed of a shaft that turns with a root, as a share of it: at most 1."""
        ratios = [
            float(ratio)
            for root, ratio in (self._machine.root(each.name) for each in self._machine.shafts)
            if root.name == shaft.name
        ]
        return min([1.0, *ratios])


def _origin(shaft: Shaft) -> str:
    names = {Tacho: 'tacho', Angle: 'angle', SpeedColumn: 'speed', TrackedSpeed: 'tracked'}
    return names.get(type(shaft.speed), 'unknown')  # type: ignore[arg-type]


class _TachoReader:
    """Reads pulses span after span, by a trigger level that stays the same."""

    def __init__(self, tacho: Tacho) -> None:
        self._tacho = tacho
        self._level = tacho.level
        self._hysteresis: float | None = None
        self._before = np.empty(0)

    def read(self, signal: Signal) -> tuple[ShaftPhase, str]:
        """Return the angle from the pulses, and what must be known of it."""
        values = signal.values
        finite = np.isfinite(values)
        if not finite.all():
            # Where there is no number, there is no pulse.
            values = np.where(finite, values, values[finite].min() if finite.any() else 0.0)
        swing = float(np.ptp(values))
        if self._hysteresis is None and swing > 0:
            self._level = trigger_level(values) if self._level is None else self._level
            self._hysteresis = 0.2 * swing
        if self._hysteresis is None or self._level is None or swing < self._hysteresis:
            self._before = np.empty(0)
            raise ValueError('the tacho is silent')
        edges = signal.start + rising_edges(values, self._level, self._hysteresis) / signal.rate
        recent = self._before > signal.start - _longest(edges)
        # Of another recording the pulses may be later: its time began anew.
        before = self._before[recent & (self._before < signal.start)]
        instants = np.concatenate([before, edges])
        self._before = instants[-REMEMBERED:]
        if len(edges) < 2 or len(instants) < 4:
            raise ValueError(f'the tacho gives {len(edges)} pulses here, at least 4 are needed')
        pulses = repair_pulses(instants)
        stops = np.flatnonzero(np.diff(pulses.numbers) > LONGEST_GAP)
        bounds = np.concatenate([[0], stops + 1, [len(pulses.numbers)]])
        longest = int(np.argmax(np.diff(bounds)))
        part = slice(bounds[longest], bounds[longest + 1])
        instants, numbers = pulses.instants[part], pulses.numbers[part]
        # One pulse before the span is enough for the angle to begin with it.
        first = max(int(np.searchsorted(instants, signal.start)) - 1, 0)
        instants, numbers = instants[first:], numbers[first:]
        if len(instants) < 4:
            raise ValueError('the tacho stops')
        phase = phase_from_pulses(instants, numbers, self._tacho.pulses)
        missing = int(np.sum(np.diff(numbers) - 1))
        return phase, self._words(phase, signal, missing, pulses.spurious)

    def _words(self, phase: ShaftPhase, signal: Signal, missing: int, spurious: int) -> str:
        notes = []
        if missing:
            notes.append(f'{missing} tacho pulses missing')
        if spurious:
            notes.append(f'{spurious} tacho pulses too many')
        end = signal.start + len(signal.values) / signal.rate
        longest = LONGEST_GAP * (phase.end - phase.start) / max(len(phase.time) - 1, 1)
        if end - phase.end > longest or phase.start - signal.start > longest:
            notes.append(f'the tacho gives pulses from {phase.start:.3f} to {phase.end:.3f} s only')
        return ', '.join(notes)


def _longest(edges: np.ndarray) -> float:
    """Return how far back pulses of the span before are still of use [s]."""
    if len(edges) < 2:
        return 0.0
    return 1.5 * float(np.median(np.diff(edges))) * REMEMBERED
