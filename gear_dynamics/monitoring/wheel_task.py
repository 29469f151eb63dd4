"""Online synchronous average of one wheel, with its condition indicators."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from gear_dynamics.signal import indicators
from gear_dynamics.signal.interpolation import ACCURATE_BAND
from gear_dynamics.signal.segments import SegmentBuffer
from gear_dynamics.signal.statistics import rms
from gear_dynamics.signal.synchronous import (
    Parts,
    below_order,
    hunting_revolutions,
    other_wheel_leakage,
    separate,
)

NO_DIFFERENCE = 'no difference signal: its ratios would tell of rounding only'
NO_RESIDUAL = 'no residual signal: its ratios would tell of rounding only'


class WheelAverage(NamedTuple):
    """A finished average of one wheel.

    Attributes
    ----------
    wheel : str
        pinion or gear.
    first, last : float
        Sample numbers where it begins and ends.
    revolutions : int
    leakage : float
        What is left of the other wheel's worst order, 0 to 1.
    values : dict of str to ndarray
        Indicators, one value a channel; NaN where they would be noise.
    notes : list of str
        What must be known of the values, one text a channel, mostly empty.
    """

    wheel: str
    first: float
    last: float
    revolutions: int
    leakage: float
    values: dict[str, np.ndarray]
    notes: list[str]


class Past:
    """What NA4 and NB4 keep of the averages so far."""

    def __init__(self) -> None:
        self.na4 = indicators.RunningKurtosis()
        self.nb4 = indicators.RunningKurtosis()


class WheelTask:
    """Average the revolutions of a wheel over a hunting-tooth period, again and again.

    Parameters
    ----------
    wheel : str
        pinion or gear.
    teeth, other_teeth : int
        Of this wheel and of the other.
    points : int
        Points in a mesh cycle.
    lead : int
        Whole mesh cycles by which this wheel's angle is ahead of the phase.
    columns : int
        Columns of a row; the last is the sample number, which is not averaged.
    longest : float
        Samples that a record may have; a longer hunting-tooth period is cut to whole revolutions.
    past : Past
        Of the same wheel.
    """

    def __init__(
        self,
        wheel: str,
        teeth: int,
        other_teeth: int,
        points: int,
        lead: int,
        columns: int,
        longest: float,
        past: Past,
    ) -> None:
        self._wheel = wheel
        self._teeth, self._other = teeth, other_teeth
        self._points = teeth * points
        self._lead = lead * points
        self._longest = longest
        self._segments: SegmentBuffer | None = None
        self._columns = columns
        self._sum = np.zeros((self._points, columns - 1))
        self._count = 0
        self._first = 0.0
        self._past = past

    def push(self, first: int, rows: np.ndarray) -> Iterator[WheelAverage]:
        """Take rows at the points `first`, `first` + 1, ...; yield the averages completed."""
        if self._segments is None:
            skipped = -(first + self._lead) % self._points
            if skipped >= len(rows):
                return
            rows = rows[skipped:]
            self._segments = SegmentBuffer(self._points, self._points, self._columns)
        for revolution in self._segments.push(rows):
            if self._count == 0:
                self._first = float(revolution[0, -1])
            self._sum += revolution[:, :-1]
            self._count += 1
            last = float(revolution[-1, -1])
            if self._complete(last):
                yield self._finish(last)

    def _complete(self, last: float) -> bool:
        if self._count >= hunting_revolutions(self._teeth, self._other):
            return True
        taken = last - self._first
        return taken + taken / self._count > self._longest

    def _finish(self, last: float) -> WheelAverage:
        samples_per_revolution = (last - self._first) / self._count
        average = below_order(self._sum / self._count, ACCURATE_BAND * samples_per_revolution)
        parts = separate(average, self._teeth)
        values, notes = self._indicators(average, parts)
        leakage = other_wheel_leakage(self._count, self._teeth, self._other)
        result = WheelAverage(self._wheel, self._first, last, self._count, leakage, values, notes)
        self._sum[:] = 0
        self._count = 0
        return result

    def _indicators(
        self, average: np.ndarray, parts: Parts
    ) -> tuple[dict[str, np.ndarray], list[str]]:
        teeth = self._teeth
        difference = indicators.has_difference(parts)
        residual = rms(parts.residual) >= indicators.NOTHING * rms(parts.regular)
        envelope = indicators.mesh_envelope(average, teeth)
        modulated = np.std(envelope, axis=0) >= indicators.NOTHING * np.mean(envelope, axis=0)
        values = {
            'fm0': indicators.fm0(average, teeth),
            'sideband_index': indicators.sideband_index(average, teeth),
            'sideband_level_factor': indicators.sideband_level_factor(average, teeth),
            'na4': np.where(residual, self._past.na4.add(parts.residual), math.nan),
            'nb4': np.where(modulated, self._past.nb4.add(envelope), math.nan),
            **_of_difference(parts, difference),
        }
        notes = [
            NO_RESIDUAL if not r else NO_DIFFERENCE if not d else ''
            for r, d in zip(residual, difference, strict=True)
        ]
        return values, notes


def _of_difference(parts: Parts, there: np.ndarray) -> dict[str, np.ndarray]:
    values = {
        'fm4': indicators.fm4(parts.difference),
        'm6a': indicators.m6a(parts.difference),
        'm8a': indicators.m8a(parts.difference),
        'energy_ratio': indicators.energy_ratio(parts),
    }
    return {name: np.where(there, value, math.nan) for name, value in values.items()}
