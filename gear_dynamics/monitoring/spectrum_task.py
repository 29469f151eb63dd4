"""Online averaged amplitude spectra."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from gear_dynamics.monitoring.task import Batch, Task, TaskResult, columns_table
from gear_dynamics.parameters.settings import AnalyzerSettings
from gear_dynamics.signal.segments import SegmentBuffer, hop_of
from gear_dynamics.signal.spectrum import (
    PowerAverage,
    amplitudes,
    mean_square_lines,
    window_samples,
)


class AveragedSpectrum:
    """Averaged amplitude spectrum of rows; every segment is transformed once, when complete.

    Parameters
    ----------
    settings : AnalyzerSettings
        Window, overlap, averaging and scale.
    length : int
        Rows in a segment.
    columns : int
        Columns of a row.
    """

    def __init__(self, settings: AnalyzerSettings, length: int, columns: int) -> None:
        self.length = length
        self._hop = hop_of(length, settings.spectrum_overlap)
        # Single precision, as the samples come; it halves the time.
        self._segments = SegmentBuffer(length, self._hop, columns, np.float32)
        self._window = window_samples(settings.spectrum_window, length).astype(np.float32)
        self._average = PowerAverage(settings.spectrum_averaging, settings.spectrum_averages)
        self._scale = settings.spectrum_scale
        # An exponential average remembers more, faintly; these are the segments it is made for.
        self.span = (settings.spectrum_averages - 1) * self._hop + length
        self._done = 0

    def push(self, rows: np.ndarray) -> Iterator[tuple[int, np.ndarray]]:
        """Take rows; yield first row of a span and amplitudes (lines, columns)."""
        for segment in self._segments.push(rows):
            self._average.add(mean_square_lines(segment, self._window))
            if self._average.due:
                assert self._average.mean_square is not None
                amplitude = amplitudes(self._average.mean_square, self.length, self._scale)
                yield self._done * self._hop + self.length - self.span, amplitude
                self._average.restart_linear()
            self._done += 1


class SpectrumTask(Task):
    """The table `spectrum`."""

    name = 'spectrum'

    def __init__(self, settings: AnalyzerSettings, rate: float, channels: Sequence[str]) -> None:
        self._spectrum = AveragedSpectrum(settings, settings.spectrum_length, len(channels))
        self._channels = channels
        self._frequency = np.fft.rfftfreq(settings.spectrum_length, 1 / rate)
        self.seconds = self._spectrum.span / rate

    def push(self, batch: Batch) -> Iterator[TaskResult]:
        """Take the next samples; yield what is complete."""
        for first, amplitude in self._spectrum.push(batch.channels):
            rows = columns_table('frequency', self._frequency, self._channels, amplitude)
            yield TaskResult(first, self._spectrum.span, tables={'spectrum': rows})
