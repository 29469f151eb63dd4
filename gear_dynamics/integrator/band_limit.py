"""Band-limited samples: evaluation at four times the rate or more, a linear-phase FIR, decimation.

Acceleration and force jump at events; sampled as they are, what lies above half the sample rate
folds back. The filter is a Kaiser-windowed sinc, flat to 20/51.2 of the sample rate and at least
80 dB down from half the sample rate on.

Below 25 kHz four times the rate would fold the gear pair's own vibration. It is evaluated at
16, 64, ... times the rate then, and decimated by four again and again.

Even at four times the rate a jump folds: its spectrum falls with 1/f alone. The integrator knows
every jump of a value and of its first two derivatives, and its instant; each is replaced by the
same jump run through a short sinc, flat in the band and down at what folds into it (band-limited
steps: Brandt, 2001).
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable

import numpy as np

from gear_dynamics.integrator.jumps import CURVATURE, ROWS_OF_JUMP, SLOPE, VALUE
from gear_dynamics.integrator.kernel import kernel
from gear_dynamics.integrator.lanes import weighted_line, weighted_rows
from gear_dynamics.integrator.layout import (
    ANGLE1,
    ANGLE2,
    AX1,
    DRIVE_TORQUE,
    GEAR_SPEED,
    HIGH_RATE_COLUMNS,
    LOAD,
    OVERSAMPLING,
    PADDED_TAPS,
    REACH,
    SPEED,
    TAPS,
    T,
)
from gear_dynamics.integrator.vector import LANES

EVALUATED = 1e5
"""Least rate at which the motion is evaluated [Hz]."""

_PASS = 20.0 / 51.2
_STOP = 0.5
_STOP_DB = 84.0
_STEP_STOP_DB = 97.0
_STEPS_PER_SAMPLE = 512

_SPAN = TAPS + 2 * REACH
"""Rows that one sample takes: the filter's, and those ahead that jumps may still change."""


@functools.cache
def taps() -> np.ndarray:
    """Return the filter, (TAPS,), of unit gain at rest.

    Kaiser's design formulas (Kaiser, 1974; Oppenheim and Schafer, section 7.5).
    """
    half = TAPS // 2
    response = _windowed_sinc(half, TAPS, (_PASS + _STOP) / OVERSAMPLING, _STOP_DB)
    return response / response.sum()


def _windowed_sinc(reach: int, count: int, cutoff: float, stop_db: float) -> np.ndarray:
    """Return the Kaiser-windowed sinc at `count` places from -reach to reach."""
    places = np.linspace(-reach, reach, count)
    return cutoff * np.sinc(cutoff * places) * np.kaiser(count, 0.1102 * (stop_db - 8.7))


@functools.cache
def jump_residuals() -> np.ndarray:
    """Return what a band-limited jump differs by from a sharp one, (ROWS_OF_JUMP, n).

    Row VALUE: 1 less the band-limited unit step, v samples at the high rate after the jump, for v
    from 0 to REACH at _STEPS_PER_SAMPLE places a sample. Row SLOPE: its integral from v on, which
    is what a unit kink differs by. Row CURVATURE: the integral of that. Before the jump the first
    and the last have the other sign.
    """
    fine = 16 * _STEPS_PER_SAMPLE * REACH
    stop = OVERSAMPLING - _STOP
    response = _windowed_sinc(REACH, 2 * fine + 1, (_PASS + stop) / OVERSAMPLING, _STEP_STOP_DB)
    after = response[fine:]
    parts = (after[1:] + after[:-1]) / 2
    step = 0.5 - np.concatenate([[0.0], np.cumsum(parts)]) * 0.5 / parts.sum()
    kink = _integral_to_end(step, REACH / fine)
    bend = _integral_to_end(kink, REACH / fine)
    return np.ascontiguousarray(np.stack([step, kink, bend])[:, ::16])


def _integral_to_end(values: np.ndarray, spacing: float) -> np.ndarray:
    parts = (values[1:] + values[:-1]) / 2 * spacing
    return np.concatenate([np.cumsum(parts[::-1])[::-1], [0.0]])


@kernel(nogil=True)
def _decimate(weights, high, speeds, samples, shafts):
    """Fill samples and shafts with one filtered row for every OVERSAMPLING rows of `high`."""
    for i in range(high.shape[0]):
        speeds[i] = high[i, SPEED]
    for i in range(samples.shape[0]):
        first = OVERSAMPLING * i
        centre = first + TAPS // 2
        weighted_rows(weights, high, first, samples, i)
        samples[i, SPEED] = weighted_line(weights, speeds, first)
        samples[i, T], samples[i, LOAD] = high[centre, T], high[centre, LOAD]
        samples[i, ANGLE1], samples[i, ANGLE2] = high[centre, ANGLE1], high[centre, ANGLE2]
        shafts[i, 0], shafts[i, 1] = high[centre, GEAR_SPEED], high[centre, DRIVE_TORQUE]


@kernel(nogil=True)
def _smooth(residuals, jumps, rate, high, first):
    """Band-limit jumps in the rows of `high`, of which row 0 is sample `first`."""
    for i in range(jumps.shape[0]):
        instant = jumps[i, VALUE, T]
        begin = math.floor(instant) + 1 - REACH
        for sample in range(begin, begin + 2 * REACH):
            row = sample - first
            if row < 0:
                continue
            place = abs(sample - instant) * _STEPS_PER_SAMPLE
            k = min(int(place), REACH * _STEPS_PER_SAMPLE - 1)
            part = place - k
            step = (1 - part) * residuals[VALUE, k] + part * residuals[VALUE, k + 1]
            kink = (1 - part) * residuals[SLOPE, k] + part * residuals[SLOPE, k + 1]
            bend = (1 - part) * residuals[CURVATURE, k] + part * residuals[CURVATURE, k + 1]
            if sample >= jumps[i, SLOPE, T]:
                step, bend = -step, -bend
            kink, bend = kink / rate, bend / rate**2
            for j in range(AX1, SPEED + 1):
                high[row, j] += (
                    jumps[i, VALUE, j] * step
                    + jumps[i, SLOPE, j] * kink
                    + jumps[i, CURVATURE, j] * bend
                )


def decimations(sample_rate: float) -> int:
    """Return how often samples are decimated by OVERSAMPLING to come down to a rate [Hz]."""
    count = 1
    while sample_rate * OVERSAMPLING**count < EVALUATED:
        count += 1
    return count


class BandLimiter:
    """Turns samples at OVERSAMPLING times the rate into band-limited samples at the rate.

    Accelerations, forces, delta, delta_dot and speed are filtered: they, or their derivatives, jump
    at events. Time, angles and load torque are smooth and are taken at their instant, which is
    where the filter's delay puts the others.

    Parameters
    ----------
    capacity : int
        Most samples that are made at once.
    sample_rate : float
        Of the samples that are made [Hz].
    source : callable
        Fills rows, (n, HIGH_RATE_COLUMNS), with the next samples at the high rate.
    """

    def __init__(
        self, capacity: int, sample_rate: float, source: Callable[[np.ndarray], object]
    ) -> None:
        self._capacity = capacity
        self._rate = OVERSAMPLING * sample_rate
        self._source = source
        self._rows = _rows_in_cache_lines(_SPAN + OVERSAMPLING * capacity)
        padding = PADDED_TAPS - TAPS
        self._weights = np.pad(taps(), (0, padding))
        self._speeds = np.zeros(len(self._rows) + padding)
        self._held = 0
        self._first = 0
        self._jumps = np.zeros((0, ROWS_OF_JUMP, HIGH_RATE_COLUMNS))

    def start(self, first: np.ndarray) -> None:
        """Forget the past; before the run's first sample everything stood as in it."""
        self._held = TAPS // 2
        self._rows[: self._held] = first
        self._first = -self._held
        self._jumps = self._jumps[:0]

    def memory(self) -> tuple[np.ndarray, int, np.ndarray]:
        """Return what the next samples depend on besides the source."""
        return self._rows[: self._held].copy(), self._first, self._jumps.copy()

    def set_memory(self, memory: tuple[np.ndarray, int, np.ndarray]) -> None:
        """Go on from a memory."""
        rows, self._first, jumps = memory
        self._held = len(rows)
        self._rows[: self._held] = rows
        self._jumps = jumps.copy()

    def smooth(self, jumps: np.ndarray) -> None:
        """Take the jumps, (m, ROWS_OF_JUMP, HIGH_RATE_COLUMNS), that the next rows contain."""
        self._jumps = np.concatenate([self._jumps, jumps])

    def make(self, samples: np.ndarray, shafts: np.ndarray) -> None:
        """Fill samples (count, 13) and shafts (count, 2), at most `capacity`, with the next ones.

        They do not depend on how the stream is cut into calls, to the last bit.
        """
        count = len(samples)
        filled = _SPAN + OVERSAMPLING * (count - 1)
        self._source(self._rows[self._held : filled])
        # A jump is applied once all the rows that it changes are there; the filter has used none.
        last = self._first + filled - 1
        due = int(np.searchsorted(self._jumps[:, VALUE, T], last - REACH))
        _smooth(jump_residuals(), self._jumps[:due], self._rate, self._rows, self._first)
        self._jumps = self._jumps[due:]
        _decimate(self._weights, self._rows[:filled], self._speeds, samples, shafts)
        used = OVERSAMPLING * count
        self._first += used
        self._held = _SPAN - OVERSAMPLING
        self._rows[: self._held] = self._rows[used : used + self._held]

    def fill(self, rows: np.ndarray) -> None:
        """Fill rows, (n, HIGH_RATE_COLUMNS), with the next samples: a source for a lower rate."""
        for begin in range(0, len(rows), self._capacity):
            part = rows[begin : begin + self._capacity]
            samples, shafts = np.empty((len(part), GEAR_SPEED)), np.empty((len(part), 2))
            self.make(samples, shafts)
            part[:, :GEAR_SPEED], part[:, GEAR_SPEED : DRIVE_TORQUE + 1] = samples, shafts


def _rows_in_cache_lines(count: int) -> np.ndarray:
    """Return rows of samples whose filtered columns lie in two cache lines of 64 bytes each."""
    numbers = np.zeros(count * HIGH_RATE_COLUMNS + 2 * LANES)
    skip = (-(numbers.ctypes.data // numbers.itemsize) - AX1) % LANES
    return numbers[skip : skip + count * HIGH_RATE_COLUMNS].reshape(count, HIGH_RATE_COLUMNS)
