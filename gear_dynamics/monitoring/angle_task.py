"""Online work by mesh phase: order spectrum and the synchronous averages of both wheels."""

from __future__ import annotations

import collections
import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from scipy import fft

from gear_dynamics.machine.columns import CHANNELS
from gear_dynamics.machine.configuration import Rig
from gear_dynamics.monitoring.phase_stream import AngularResampler
from gear_dynamics.monitoring.time_tasks import SpectrumTask
from gear_dynamics.monitoring.wheel_task import Past, WheelAverage, WheelTask
from gear_dynamics.parameters.settings import AnalyzerSettings

FEWEST_POINTS = 16
MOST_POINTS = 4096
"""Bounds of the points in a mesh cycle; a slower mesh than rate / MOST_POINTS is not tracked."""

LEAST_DENSITY = 0.9
GREATEST_DENSITY = 4.5
"""Points per sample for which the points in a cycle are kept: fewer would fold back what the
samples hold, more would cost time for nothing."""


class Orders(NamedTuple):
    """An order spectrum: sample numbers of its span, orders of the pinion, amplitudes."""

    first: float
    last: float
    order: np.ndarray
    amplitude: np.ndarray


class AngleTask:
    """Resample by phase and keep everything that counts in revolutions.

    Begins anew, and counts it by reason, when the speed has changed so much that the points
    in a cycle no longer suit it, when the shaft stops, and when it turns back.

    Parameters
    ----------
    settings : AnalyzerSettings
    rig : Rig
    restarts : Counter
        Where each new beginning is counted.
    """

    def __init__(
        self, settings: AnalyzerSettings, rig: Rig, restarts: collections.Counter[str]
    ) -> None:
        self._settings = settings
        self._rig = rig
        self._resampler: AngularResampler | None = None
        self._restarts = restarts
        # What NA4 and NB4 know of the past outlives a change of the points in a cycle.
        self._past = {wheel: Past() for wheel in ('pinion', 'gear')}

    def push(
        self, channels: np.ndarray, phase: np.ndarray, first: int, gear_lead: int
    ) -> Iterator[Orders | WheelAverage]:
        """Take samples of all channels with their phase; yield what is complete.

        Parameters
        ----------
        channels : ndarray, shape (n, channels)
        phase : ndarray, shape (n,)
            Mesh phase [cycles] counted from the pinion's zero.
        first : int
            Number of the first sample in the record.
        gear_lead : int
            Whole cycles by which the gear's own count is ahead.
        """
        if len(phase) < 2 or not np.all(np.diff(phase) > 0):
            self._stop('the shaft does not turn forward')
            return
        cycles_per_sample = float(phase[-1] - phase[0]) / (len(phase) - 1)
        if not self._suits(cycles_per_sample):
            self._stop('change of speed')
            self._start(cycles_per_sample, gear_lead)
        if self._resampler is None:
            return
        numbers = np.arange(first, first + len(channels), dtype=float)
        tick, rows = self._resampler.push(np.column_stack([channels, numbers]), phase)
        if len(rows):
            yield from self._orders(rows)
            for wheel in self._wheels:
                yield from wheel.push(tick, rows)

    def _suits(self, cycles_per_sample: float) -> bool:
        if self._resampler is None:
            return False
        points = self._resampler.points
        density = points * cycles_per_sample
        return density >= LEAST_DENSITY and (density <= GREATEST_DENSITY or points == FEWEST_POINTS)

    def _stop(self, reason: str) -> None:
        if self._resampler is not None:
            self._restarts[reason] += 1
        self._resampler = None

    def _start(self, cycles_per_sample: float, gear_lead: int) -> None:
        points = max(1 << math.ceil(math.log2(1 / cycles_per_sample)), FEWEST_POINTS)
        if points > MOST_POINTS:
            return
        self._resampler = AngularResampler(points)
        z1, z2 = self._rig.pinion_teeth, self._rig.gear_teeth
        self._per_revolution = points * z1
        length = self._per_revolution * self._settings.order_revolutions
        self._spectrum = SpectrumTask(self._settings, length, len(CHANNELS))
        self._marks: list[tuple[int, float]] = []
        self._points_done = 0
        longest = self._settings.average_longest * self._rig.sample_rate
        columns = len(CHANNELS) + 1
        self._wheels = (
            WheelTask('pinion', z1, z2, points, 0, columns, longest, self._past['pinion']),
            WheelTask('gear', z2, z1, points, gear_lead, columns, longest, self._past['gear']),
        )

    def _orders(self, rows: np.ndarray) -> Iterator[Orders]:
        self._marks.append((self._points_done, float(rows[0, -1])))
        self._points_done += len(rows)
        ends = [*self._marks, (self._points_done - 1, float(rows[-1, -1]))]
        for first, count, amplitude in self._spectrum.push(rows[:, :-1]):
            points, numbers = zip(*ends, strict=True)
            start, last = np.interp([first, first + count - 1], points, numbers)
            order = fft.rfftfreq(self._spectrum.length, 1 / self._per_revolution)
            yield Orders(float(start), float(last), order, amplitude)
            self._marks = [mark for mark in self._marks if mark[0] >= first]
