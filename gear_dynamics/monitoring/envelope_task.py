"""Online envelope spectra of consecutive spans."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from gear_dynamics.monitoring.task import (
    OWN,
    Batch,
    Indicator,
    Row,
    Task,
    TaskResult,
    columns_table,
)
from gear_dynamics.parameters.settings import AnalyzerSettings
from gear_dynamics.signal.demodulation import Band, envelope_spectrum, most_impulsive_band
from gear_dynamics.signal.segments import SegmentBuffer

CHOICE = 8192
"""Samples, the last of a span, by which the band is chosen."""

NO_BAND = 'the channel is constant, or the band is given: no band was chosen'


class EnvelopeTask(Task):
    """Envelope spectra: the table `envelope_spectrum`, and its greatest line.

    Parameters
    ----------
    settings : AnalyzerSettings
        The band; upper limit 0 takes the most impulsive band of each channel.
    length : int
        Samples in a span.
    rate : float
        [Hz]
    channels : sequence of str
    """

    name = 'envelope_spectrum'
    indicators = (
        Indicator('envelope_low', 'Hz', 'lower limit of the envelope band'),
        Indicator('envelope_high', 'Hz', 'upper limit of the envelope band'),
        Indicator('envelope_band_kurtosis', '', 'kurtosis of the band, 0 for noise'),
        Indicator('envelope_frequency', 'Hz', 'frequency of the greatest line of the envelope'),
        Indicator('envelope_amplitude', OWN, 'peak amplitude of that line'),
    )

    def __init__(
        self, settings: AnalyzerSettings, length: int, rate: float, channels: Sequence[str]
    ) -> None:
        self._length = length
        self._rate = rate
        self._channels = channels
        high = min(settings.envelope_high, rate / 2)
        low = settings.envelope_low
        self._given = Band(low, high, math.nan) if high > low else None
        self.seconds = length / rate
        self._first: int | None = None
        self.restart()

    def restart(self) -> None:
        """Begin the span anew."""
        # Single precision is enough for a choice of band and a picture, at half the time.
        self._segments = SegmentBuffer(self._length, self._length, len(self._channels), np.float32)
        self._first = None

    def push(self, batch: Batch) -> Iterator[TaskResult]:
        """Take the next samples; yield what is complete."""
        if self._first is None:
            self._first = batch.first
        for segment in self._segments.push(batch.channels):
            yield self._finding(self._first, segment)
            self._first += self._length

    def _finding(self, first: int, segment: np.ndarray) -> TaskResult:
        found = [self._envelope(x) for x in np.ascontiguousarray(segment.T)]
        # All have the same step of frequency; the band of each tells how far it goes.
        frequency = max((each for _, each, _ in found), key=len)
        amplitude = np.zeros((len(frequency), len(found)), np.float32)
        for index, (_, _, column) in enumerate(found):
            amplitude[: len(column), index] = column
        rows = [
            self._row(channel, band, frequency, amplitude[:, index])
            for index, (channel, (band, _, _)) in enumerate(zip(self._channels, found, strict=True))
        ]
        table = columns_table('frequency', frequency, self._channels, amplitude)
        return TaskResult(first, self._length, rows, {'envelope_spectrum': table})

    def _envelope(self, x: np.ndarray) -> tuple[Band, np.ndarray, np.ndarray]:
        band = self._given or most_impulsive_band(x[-CHOICE:], self._rate)
        return band, *envelope_spectrum(x, self._rate, band.low, band.high)

    def _row(self, channel: str, band: Band, frequency: np.ndarray, amplitude: np.ndarray) -> Row:
        line = int(np.argmax(amplitude[1:])) + 1
        values = {
            'envelope_low': band.low,
            'envelope_high': band.high,
            'envelope_band_kurtosis': band.kurtosis,
            'envelope_frequency': float(frequency[line]),
            'envelope_amplitude': float(amplitude[line]),
        }
        if math.isnan(band.kurtosis):
            return Row(channel, values, reason=NO_BAND)
        choice = min(CHOICE, self._length) / self._rate
        notes = {'envelope_band': f'chosen on the last {choice:.3g} s of the span'}
        return Row(channel, values, notes)
