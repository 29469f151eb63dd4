"""Online work by the phase of a mesh: order spectrum and synchronous averages of its wheels."""

from __future__ import annotations

import collections
import math
from collections.abc import Iterator, Sequence

import numpy as np
from scipy import fft

from gear_dynamics.monitoring.layout import Layout, MeshLayout
from gear_dynamics.monitoring.phase_stream import AngularResampler
from gear_dynamics.monitoring.spectrum_task import AveragedSpectrum
from gear_dynamics.monitoring.task import Batch, Indicator, Learned, Task, TaskResult, columns_table
from gear_dynamics.monitoring.wheel_average import INDICATORS, Harmonics, WheelAverage
from gear_dynamics.parameters.settings import AnalyzerSettings
from gear_dynamics.signal.synchronous import hunting_revolutions

FEWEST_POINTS = 16
MOST_POINTS = 4096
"""Bounds of the points in a mesh cycle; a slower mesh than rate / MOST_POINTS is not tracked, nor
is one so fast that a cycle has fewer than FEWEST_POINTS / GREATEST_DENSITY samples."""

LEAST_DENSITY = 0.9
GREATEST_DENSITY = 4.5
"""Points per sample for which the points in a cycle are kept: with fewer, high orders are aliased;
more cost time for nothing."""

BACK = 'the shaft does not turn forward'
CHANGE = 'change of speed'


class AngleTask(Task):
    """Resample by the phase of a mesh; average by revolutions.

    Begins anew, and counts it by reason, when the speed has changed so much that the points
    in a cycle no longer suit it, when the shaft stops, and when it turns back.

    Parameters
    ----------
    settings : AnalyzerSettings
    layout : Layout
    mesh : MeshLayout
        The first one of the layout gives the table `order_spectrum`, in orders of its driver.
    wheels : sequence of int
        Which of the mesh's wheels are averaged: 0 the driver, 1 the driven.
    restarts : Counter
        Where each new beginning is counted.
    harmonics : mapping of str to Harmonics
        What NB4 keeps of each wheel; it outlives this task.
    normal : Learned
        What is normal of each wheel.
    """

    name = 'averages'
    indicators: tuple[Indicator, ...] = INDICATORS

    def __init__(
        self,
        settings: AnalyzerSettings,
        layout: Layout,
        mesh: MeshLayout,
        wheels: Sequence[int],
        restarts: collections.Counter[str],
        harmonics: dict[str, Harmonics],
        normal: Learned,
    ) -> None:
        self._normal = normal
        self._settings = settings
        self._mesh = mesh
        self._with_wheels = wheels
        self._with_orders = mesh is layout.meshes[0]
        self._rate = layout.sample_rate
        self._channels = layout.channels
        self._restarts = restarts
        self._harmonics = harmonics
        self._resampler: AngularResampler | None = None
        self._wheels: list[WheelAverage] = []

    def push(self, batch: Batch) -> Iterator[TaskResult]:
        """Take the next samples; yield what is complete."""
        name = self._mesh.mesh.name
        phase = batch.phases[name]
        if len(phase) < 2 or not np.all(np.diff(phase) > 0):
            self._stop(BACK)
            return
        cycles_per_sample = float(phase[-1] - phase[0]) / (len(phase) - 1)
        if not self._suits(cycles_per_sample):
            self._stop(CHANGE)
            self._start(cycles_per_sample, batch.leads[name])
        if self._resampler is None:
            return
        numbers = np.arange(batch.first, batch.first + len(phase), dtype=float)
        tick, rows = self._resampler.push(np.column_stack([batch.channels, numbers]), phase)
        if len(rows):
            if self._with_orders:
                yield from self._orders(rows)
            for wheel in self._wheels:
                yield from wheel.push(tick, rows, batch.bin)
            self._expect(cycles_per_sample)

    def restart(self) -> None:
        """Begin the averages anew; the order spectrum, which has no limits, goes on."""
        for wheel in self._wheels:
            wheel.restart()

    def _expect(self, cycles_per_sample: float) -> None:
        z1, z2 = self._mesh.teeth
        period = hunting_revolutions(z1, z2) * z1 / cycles_per_sample / self._rate
        self.seconds = max(
            min(period, self._settings.average_longest), self._settings.average_duration
        )

    def _suits(self, cycles_per_sample: float) -> bool:
        if self._resampler is None:
            return False
        density = self._resampler.points * cycles_per_sample
        return LEAST_DENSITY <= density <= GREATEST_DENSITY

    def _stop(self, reason: str) -> None:
        if self._resampler is not None:
            self._restarts[reason] += 1
        self._resampler = None
        self._wheels = []
        self.seconds = 0.0

    def _start(self, cycles_per_sample: float, lead: int) -> None:
        if not 1 / MOST_POINTS <= cycles_per_sample <= GREATEST_DENSITY / FEWEST_POINTS:
            return
        points = max(1 << math.ceil(math.log2(1 / cycles_per_sample)), FEWEST_POINTS)
        self._resampler = AngularResampler(points)
        self._per_revolution = points * self._mesh.teeth[0]
        length = self._per_revolution * self._settings.order_revolutions
        if self._with_orders:
            self._spectrum = AveragedSpectrum(self._settings, length, len(self._channels))
        self._marks: list[tuple[int, float]] = []
        self._points_done = 0
        self._wheels = [
            WheelAverage(
                self._mesh.wheels[side],
                (self._mesh.teeth[side], self._mesh.teeth[1 - side]),
                points,
                lead * side,
                self._channels,
                (
                    self._settings.average_duration * self._rate,
                    self._settings.average_longest * self._rate,
                ),
                self._harmonics.setdefault(self._mesh.wheels[side], {}),
                self._normal,
            )
            for side in self._with_wheels
        ]

    def _orders(self, rows: np.ndarray) -> Iterator[TaskResult]:
        self._marks.append((self._points_done, float(rows[0, -1])))
        self._points_done += len(rows)
        ends = [*self._marks, (self._points_done - 1, float(rows[-1, -1]))]
        for first, amplitude in self._spectrum.push(rows[:, :-1]):
            points, numbers = zip(*ends, strict=True)
            start, last = np.interp([first, first + self._spectrum.span - 1], points, numbers)
            order = fft.rfftfreq(self._spectrum.length, 1 / self._per_revolution)
            table = columns_table('order', order, self._channels, amplitude)
            yield TaskResult(
                float(start), float(last - start + 1), tables={'order_spectrum': table}
            )
            self._marks = [mark for mark in self._marks if mark[0] >= first]
