"""Online work on the samples as they come: spectrum, statistics, envelope, contact.

A task takes rows in order, from sample 0 of its record on, and hands out what is complete as
(first sample, number of samples, outcome).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from gear_dynamics.machine.columns import CHANNELS
from gear_dynamics.monitoring.rattle import Rattle, RattleCounter
from gear_dynamics.parameters.settings import AnalyzerSettings
from gear_dynamics.signal.demodulation import Band, envelope_spectrum, most_impulsive_band
from gear_dynamics.signal.segments import SegmentBuffer, hop_of
from gear_dynamics.signal.spectrum import (
    PowerAverage,
    amplitudes,
    mean_square_lines,
    window_samples,
)
from gear_dynamics.signal.statistics import Moments


class SpectrumTask:
    """Averaged amplitude spectrum; every segment is transformed once, when it is complete.

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
        self._span = (settings.spectrum_averages - 1) * self._hop + length
        self._done = 0

    def push(self, rows: np.ndarray) -> Iterator[tuple[int, int, np.ndarray]]:
        """Take rows; yield first row, number of rows, and amplitudes (lines, columns)."""
        for segment in self._segments.push(rows):
            self._average.add(mean_square_lines(segment, self._window))
            if self._average.due:
                assert self._average.mean_square is not None
                amplitude = amplitudes(self._average.mean_square, self.length, self._scale)
                yield self._done * self._hop + self.length - self._span, self._span, amplitude
                self._average.restart_linear()
            self._done += 1


class Statistics(NamedTuple):
    """What a stretch of samples shows in time.

    Attributes
    ----------
    values : dict of str to ndarray
        One value a channel.
    contact : Rattle
    """

    values: dict[str, np.ndarray]
    contact: Rattle


class StatisticsTask:
    """Statistics of every channel over stretches that follow each other, summed block by block.

    A stretch ends with the block that makes it long enough.
    """

    def __init__(self, length: int, half_backlash: float) -> None:
        self._length = length
        self._contact = RattleCounter(half_backlash)
        self._moments = Moments()
        self._first = 0

    def use(self, half_backlash: float) -> None:
        """Take over another backlash [m] from here on."""
        self._contact.half_backlash = half_backlash

    def push(self, channels: np.ndarray) -> Iterator[tuple[int, int, Statistics]]:
        """Take samples of all channels; yield first sample, number of samples, statistics."""
        self._moments.add(channels)
        self._contact.add(channels[:, CHANNELS.index('delta')])
        count = self._moments.count
        if count >= self._length:
            yield self._first, count, Statistics(self._moments.indicators(), self._contact.take())
            self._moments = Moments()
            self._first += count


class Envelope(NamedTuple):
    """Envelope spectra of all channels.

    Attributes
    ----------
    bands : tuple of Band
        That of each channel; its kurtosis is NaN where the band was given.
    frequency : ndarray
        [Hz]
    amplitude : ndarray, shape (lines, channels)
    """

    bands: tuple[Band, ...]
    frequency: np.ndarray
    amplitude: np.ndarray


CHOICE = 8192
"""Samples, the last of a stretch, by which the band is chosen."""


class EnvelopeTask:
    """Envelope spectra of stretches that follow each other.

    Parameters
    ----------
    length : int
        Samples in a stretch.
    rate : float
        [Hz]
    low, high : float
        Band [Hz]; high 0 takes the most impulsive band of each channel.
    """

    def __init__(self, length: int, rate: float, low: float, high: float) -> None:
        self._length = length
        self._rate = rate
        self._given = Band(low, high, float('nan')) if high > 0 else None
        # Single precision is enough for a choice of band and a picture, at half the time.
        self._segments = SegmentBuffer(length, length, len(CHANNELS), np.float32)
        self._first = 0

    def push(self, channels: np.ndarray) -> Iterator[tuple[int, int, Envelope]]:
        """Take samples of all channels; yield first sample, number of samples, envelope."""
        for segment in self._segments.push(channels):
            found = [self._envelope(x) for x in np.ascontiguousarray(segment.T)]
            bands = tuple(band for band, _, _ in found)
            # All have the same step of frequency; the band of each tells how far it goes.
            frequency = max((each for _, each, _ in found), key=len)
            amplitude = np.zeros((len(frequency), len(found)), np.float32)
            for index, (_, _, column) in enumerate(found):
                amplitude[: len(column), index] = column
            yield self._first, self._length, Envelope(bands, frequency, amplitude)
            self._first += self._length

    def _envelope(self, x: np.ndarray) -> tuple[Band, np.ndarray, np.ndarray]:
        band = self._given or most_impulsive_band(x[-CHOICE:], self._rate)
        return band, *envelope_spectrum(x, self._rate, band.low, band.high)
