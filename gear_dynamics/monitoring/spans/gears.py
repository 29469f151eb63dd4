"""Synchronous averages of the shafts, and the indicators of their wheels and meshes."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from scipy import fft

from gear_dynamics.machine.machine import Machine
from gear_dynamics.machine.parts import Wheel
from gear_dynamics.monitoring.spans.data import Average, ShaftState, Signal
from gear_dynamics.signal import indicators
from gear_dynamics.signal.interpolation import ACCURATE_BAND, HALF_WIDTH
from gear_dynamics.signal.order_tracking import resample_by_phase
from gear_dynamics.signal.synchronous import below_order, separate, synchronous_average

FEWEST_REVOLUTIONS = 10
"""Revolutions of a shaft that its orders need."""

DENSITY = 0.92
"""Points a sample; twice the accurate band, and some."""

HARMONICS = 5
"""Mesh harmonics in the table."""

WHEEL_INDICATORS = (
    *('fm0', 'fm4', 'm6a', 'm8a', 'energy_ratio', 'sideband_index', 'sideband_level_factor'),
)


class Angles:
    """The angles of the shafts at the samples of signals; each is worked out once.

    Parameters
    ----------
    states : mapping of str to ShaftState
        By the shaft's name.
    """

    def __init__(self, states: Mapping[str, ShaftState]) -> None:
        self._states = states
        self._kept: dict[tuple[str, float, float, int], tuple[slice, np.ndarray]] = {}

    def at(self, shaft: str, signal: Signal) -> tuple[slice, np.ndarray]:
        """Return which samples lie where the angle is known, and the revolutions there."""
        key = (shaft, signal.rate, signal.start, len(signal.values))
        if key not in self._kept:
            phase = self._states[shaft].phase
            assert phase is not None
            time = signal.time
            first = int(np.searchsorted(time, phase.start))
            last = int(np.searchsorted(time, phase.end, side='right'))
            self._kept[key] = slice(first, last), phase.at(time[first:last])
        return self._kept[key]


def resampled(signal: Signal, shaft: str, angles: Angles) -> tuple[np.ndarray, int]:
    """Return a signal by the angle of a shaft from a whole revolution on, and points a revolution.

    There are DENSITY points a sample: what folds back lies beyond the accurate band.
    """
    known, revolutions = angles.at(shaft, signal)
    values = signal.values[known]
    if len(values) <= 4 * HALF_WIDTH:
        return np.empty(0), 1
    speed = (revolutions[-1] - revolutions[0]) / (len(values) - 1)
    points = fft.next_fast_len(math.ceil(DENSITY / speed), real=True)
    first, even = resample_by_phase(values, revolutions, points)
    return even[-first % points :], points


def shaft_average(signal: Signal, shaft: str, angles: Angles, speed: float) -> Average | None:
    """Return the synchronous average over all whole revolutions; None if they are too few.

    Parameters
    ----------
    signal : Signal
    shaft : str
    angles : Angles
    speed : float
        Mean speed of the shaft [revolutions/s].
    """
    even, points = resampled(signal, shaft, angles)
    count = len(even) // points
    if count < FEWEST_REVOLUTIONS:
        return None
    highest = ACCURATE_BAND * signal.rate / speed
    average = below_order(synchronous_average(even, points), highest)
    variance = float(np.var(signal.values))
    share = 0.0
    if variance > 0:
        # Of what is not synchronous, 1 / count of the variance is left in the average.
        share = (float(np.var(average)) / variance - 1 / count) / (1 - 1 / count)
    return Average(average, count, highest, min(max(share, 0.0), 1.0))


def without_average(signal: Signal, shaft: str, angles: Angles, average: np.ndarray) -> Signal:
    """Return a signal without its synchronous average: the residual record."""
    known, revolutions = angles.at(shaft, signal)
    place = (revolutions - np.floor(revolutions)) * len(average)
    before = np.minimum(place.astype(np.intp), len(average) - 1)
    centred = average - average.mean()
    steps = np.roll(centred, -1) - centred
    values = signal.values.copy()
    values[known] -= centred[before] + (place - before) * steps[before]
    return Signal(values, signal.rate, signal.start)


def wheel_indicators(average: Average, wheel: Wheel, machine: Machine) -> dict[str, float]:
    """Return the indicators of a wheel from the average of its shaft, NaN where they tell nothing.

    Mesh lines of other wheels on the same shaft are taken out first, with their first sidebands.
    """
    values = _without_others(average.values, wheel, machine)
    if 2 * wheel.teeth >= len(values) or wheel.teeth > average.highest_order:
        return dict.fromkeys(WHEEL_INDICATORS, math.nan)
    parts = separate(values, wheel.teeth)
    found = {
        'fm0': indicators.fm0(values, wheel.teeth),
        'fm4': indicators.fm4(parts.difference),
        'm6a': indicators.m6a(parts.difference),
        'm8a': indicators.m8a(parts.difference),
        'energy_ratio': indicators.energy_ratio(parts),
        'sideband_index': indicators.sideband_index(values, wheel.teeth),
        'sideband_level_factor': indicators.sideband_level_factor(values, wheel.teeth),
    }
    if not indicators.has_difference(parts):
        found |= dict.fromkeys(('fm4', 'm6a', 'm8a', 'energy_ratio'), np.array(math.nan))
    return {name: float(value) for name, value in found.items()}


def _without_others(values: np.ndarray, wheel: Wheel, machine: Machine) -> np.ndarray:
    others = [
        each for each in machine.wheels if each.shaft == wheel.shaft and each.teeth != wheel.teeth
    ]
    if not others:
        return values
    lines = fft.rfft(values)
    orders = np.arange(len(lines))
    own = np.abs(orders - wheel.teeth * np.round(orders / wheel.teeth)) <= 1
    for other in others:
        theirs = np.abs(orders - other.teeth * np.round(orders / other.teeth)) <= 1
        lines[theirs & ~own & (orders > 1)] = 0
    return fft.irfft(lines, len(values))


def mesh_harmonics(average: Average, teeth: int) -> list[float]:
    """Return the peak amplitudes of the mesh lines 1 to 5; NaN beyond the accurate band."""
    lines = 2 / len(average.values) * np.abs(fft.rfft(average.values))
    return [
        float(lines[teeth * k]) if teeth * k <= average.highest_order else math.nan
        for k in range(1, HARMONICS + 1)
    ]


def sidebands(average: Average, teeth: int, harmonic: int, reach: int = 3) -> list[float]:
    """Return the amplitudes from `reach` sidebands below a mesh line to as many above it."""
    lines = 2 / len(average.values) * np.abs(fft.rfft(average.values))
    centre = teeth * harmonic
    return [
        float(lines[k]) if 0 < k <= min(average.highest_order, len(lines) - 1) else math.nan
        for k in range(centre - reach, centre + reach + 1)
    ]
