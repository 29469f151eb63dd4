"""The analysis of a machine, one span after the other."""

from __future__ import annotations

import math

import numpy as np
from scipy import fft

from gear_dynamics.machine.channel import Channel
from gear_dynamics.machine.machine import Machine
from gear_dynamics.machine.parts import Bearing
from gear_dynamics.monitoring.spans.bearings import bearing_state
from gear_dynamics.monitoring.spans.data import Average, ShaftState, Signal, Span, SpanResult
from gear_dynamics.monitoring.spans.gears import (
    FEWEST_REVOLUTIONS,
    HARMONICS,
    WHEEL_INDICATORS,
    Angles,
    mesh_harmonics,
    shaft_average,
    wheel_indicators,
    without_average,
)
from gear_dynamics.monitoring.spans.levels import STATISTICS, level_indicators
from gear_dynamics.monitoring.spans.phases import ShaftPhases

STEADY = 0.01
"""Greatest range of a shaft's speed in a steady span, over its mean."""

SLOW = ('degC', 'rad', 'rad/s', 's')
"""Units of channels that are no vibration: they have levels only."""


class SpanAnalysis:
    """Analyses a machine span by span; what must be remembered between spans is kept.

    Parameters
    ----------
    machine : Machine
    """

    def __init__(self, machine: Machine) -> None:
        self.machine = machine
        self._phases = ShaftPhases(machine)

    def analyse(self, span: Span) -> SpanResult:
        """Return what a span shows; its values have a column for every indicator."""
        shafts = self._phases.find(span)
        result = SpanResult({}, [], shafts, {}, {})
        result.notes += dict.fromkeys(each.note for each in shafts.values() if each.note)
        states = [state.phase for state in shafts.values()]
        steady = all(phase is not None and phase.variation <= STEADY for phase in states)
        result.values |= {'t': span.start, 'duration': span.duration, 'steady': steady}
        for name, state in shafts.items():
            result.values |= _shaft_values(name, state)
        angles = Angles(shafts)
        for channel in self.machine.channels:
            if channel.name in span.channels:
                self._channel(channel, span.channels[channel.name], angles, result)
            else:
                names = channel_columns(self.machine, channel)
                result.values |= dict.fromkeys(names, math.nan)
        return result

    def _channel(
        self, channel: Channel, signal: Signal, angles: Angles, result: SpanResult
    ) -> None:
        name = channel.name
        levels = level_indicators(signal.values, signal.rate, channel.unit)
        result.values |= {f'{name}/{key}': value for key, value in levels.items()}
        if levels['clipped'] > 0:
            result.notes.append(
                f'{name}: {levels["clipped"]:.2%} of the samples are clipped, so that peak, '
                'crest_factor and kurtosis are too low'
            )
        if levels['std'] == 0:
            result.notes.append(f'{name} is constant at {levels["mean"]:g}')
        if channel.unit in SLOW:
            return
        try:
            self._orders(name, signal, angles, result)
        except ValueError as error:
            result.notes.append(f'{name}: its orders could not be worked out: {error}')
            for column in channel_columns(self.machine, channel):
                result.values.setdefault(column, math.nan)

    def _orders(self, name: str, signal: Signal, angles: Angles, result: SpanResult) -> None:
        averages = self._averages(name, signal, angles, result)
        self._gears(name, averages, result)
        if self._near(name):
            residual = self._residual(signal, averages, angles)
            self._bearings(name, residual, angles, result)

    def _averages(
        self, name: str, signal: Signal, angles: Angles, result: SpanResult
    ) -> dict[str, Average]:
        averages = {}
        for shaft, state in result.shafts.items():
            if state.phase is None:
                continue
            if state.phase.turned < FEWEST_REVOLUTIONS:
                note = (
                    f'shaft {shaft} turns {state.phase.turned:.1f} times in a span: orders need '
                    f'{FEWEST_REVOLUTIONS}, that is {FEWEST_REVOLUTIONS / state.phase.speed:.2f} s'
                )
                if note not in result.notes:
                    result.notes.append(note)
                continue
            average = shaft_average(signal, shaft, angles, state.phase.speed)
            if average is not None:
                averages[shaft] = average
                result.averages[name, shaft] = average
        for each in self.machine.shafts:
            share = averages[each.name].share if each.name in averages else math.nan
            result.values[f'{name}/{each.name}_synchronous_share'] = share
        return averages

    def _gears(self, name: str, averages: dict[str, Average], result: SpanResult) -> None:
        for mesh in self.machine.meshes:
            wheel = self.machine.wheel(mesh.driver)
            lines = [math.nan] * HARMONICS
            if wheel.shaft in averages:
                lines = mesh_harmonics(averages[wheel.shaft], wheel.teeth)
            for number, amplitude in enumerate(lines, 1):
                result.values[f'{name}/{mesh.name}_harmonic_{number}'] = amplitude
        for wheel in self.machine.wheels:
            values = dict.fromkeys(WHEEL_INDICATORS, math.nan)
            if wheel.shaft in averages:
                values = wheel_indicators(averages[wheel.shaft], wheel, self.machine)
            result.values |= {f'{name}/{wheel.name}_{key}': v for key, v in values.items()}

    def _residual(self, signal: Signal, averages: dict[str, Average], angles: Angles) -> Signal:
        """Return the signal without what is synchronous with the shafts that have wheels."""
        taken: set[str] = set()
        for shaft, average in averages.items():
            wheels = [wheel for wheel in self.machine.wheels if wheel.shaft == shaft]
            if not wheels:
                continue
            # A mesh line belongs to both shafts; it is taken out once.
            teeth = [
                wheel.teeth
                for wheel in wheels
                if any(other.shaft in taken for _, other in self.machine.meshes_of(wheel.name))
            ]
            part = _without_multiples(average.values, teeth)
            signal = without_average(signal, shaft, angles, part)
            taken.add(shaft)
        return signal

    def _near(self, channel: str) -> list[Bearing]:
        """Return the bearings that are judged by a channel."""
        return [
            bearing
            for bearing in self.machine.bearings
            if not bearing.channels or channel in bearing.channels
        ]

    def _bearings(self, name: str, residual: Signal, angles: Angles, result: SpanResult) -> None:
        for bearing in self._near(name):
            shaft = result.shafts[bearing.shaft]
            state = None
            if shaft.phase is not None and shaft.phase.turned >= FEWEST_REVOLUTIONS:
                state = bearing_state(residual, angles, bearing, self.machine)
            if state is not None:
                result.bearings[name, bearing.name] = state
            for defect in bearing.orders:
                line = state.lines[defect] if state is not None else None
                prefix = f'{name}/{bearing.name}_{defect}'
                result.values[f'{prefix}_order'] = line.order if line else math.nan
                result.values[f'{prefix}_level'] = line.level if line else math.nan


def _shaft_values(name: str, state: ShaftState) -> dict[str, float | bool]:
    phase = state.phase
    values: dict[str, float | bool] = {
        f'{name}/speed': 2 * math.pi * phase.speed if phase is not None else math.nan,
        f'{name}/revolutions': phase.turned if phase is not None else 0.0,
    }
    if state.origin == 'tracked':
        values[f'{name}/speed_uncertainty'] = 2 * math.pi * state.uncertainty
        values[f'{name}/at_limit'] = state.at_limit
    return values


def _without_multiples(values: np.ndarray, teeth: list[int]) -> np.ndarray:
    if not teeth:
        return values
    lines = fft.rfft(values)
    for each in teeth:
        lines[each::each] = 0
    return fft.irfft(lines, len(values))


def channel_columns(machine: Machine, channel: Channel) -> dict[str, str]:
    """Return the columns of a channel, each with its unit."""
    unit = channel.unit
    units = {f'{channel.name}/{name}': unit for name in STATISTICS[:4]}
    units |= {f'{channel.name}/{name}': '1' for name in (*STATISTICS[4:], 'clipped')}
    if unit in ('m/s2', 'm/s', 'm'):
        units[f'{channel.name}/velocity_rms'] = 'm/s'
    if unit in SLOW:
        return units
    for shaft in machine.shafts:
        units[f'{channel.name}/{shaft.name}_synchronous_share'] = '1'
    for mesh in machine.meshes:
        for number in range(1, HARMONICS + 1):
            units[f'{channel.name}/{mesh.name}_harmonic_{number}'] = unit
    for wheel in machine.wheels:
        for name in WHEEL_INDICATORS:
            its = unit if name == 'sideband_index' else '1'
            units[f'{channel.name}/{wheel.name}_{name}'] = its
    for bearing in machine.bearings:
        if not bearing.channels or channel.name in bearing.channels:
            for defect in bearing.orders:
                units[f'{channel.name}/{bearing.name}_{defect}_order'] = '1/rev'
                units[f'{channel.name}/{bearing.name}_{defect}_level'] = 'dB'
    return units


def column_units(machine: Machine) -> dict[str, str]:
    """Return the unit of every column of the table, in their order."""
    units = {'t': 's', 'duration': 's', 'steady': ''}
    for shaft in machine.shafts:
        units[f'{shaft.name}/speed'] = 'rad/s'
        units[f'{shaft.name}/revolutions'] = '1'
        units[f'{shaft.name}/speed_uncertainty'] = 'rad/s'
        units[f'{shaft.name}/at_limit'] = ''
    for channel in machine.channels:
        units |= channel_columns(machine, channel)
    return units
