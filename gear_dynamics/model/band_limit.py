"""Band-limited samples: evaluation at four times the rate, a linear-phase FIR, decimation.

Acceleration and force jump at mesh events; sampled as they are, what lies above half the sample
rate folds back. The filter is a Kaiser-windowed sinc, flat to 20/51.2 of the sample rate and at
least 80 dB down from half the sample rate on.
"""

from __future__ import annotations

import functools

import numpy as np

from gear_dynamics.model.kernel import kernel
from gear_dynamics.model.lanes import weighted_sum
from gear_dynamics.model.layout import (
    ANGLE1,
    ANGLE2,
    HIGH_RATE_COLUMNS,
    LOAD,
    OVERSAMPLING,
    TAPS,
    T,
)

_PASS = 20.0 / 51.2
_STOP = 0.5
_STOP_DB = 84.0


@functools.cache
def taps() -> np.ndarray:
    """Return the filter, (TAPS,), of unit gain at rest.

    Kaiser's design formulas (Kaiser, 1974; Oppenheim and Schafer, section 7.5).
    """
    half = TAPS // 2
    cutoff = (_PASS + _STOP) / 2 * 2 / OVERSAMPLING
    n = np.arange(-half, half + 1)
    beta = 0.1102 * (_STOP_DB - 8.7)
    window = np.kaiser(TAPS, beta)
    response = cutoff * np.sinc(cutoff * n) * window
    return response / response.sum()


@kernel
def _decimate(weights, high, made, out):
    """Fill `out` with one filtered row for every OVERSAMPLING rows of `high`."""
    centre = TAPS // 2
    for i in range(out.shape[0]):
        first = OVERSAMPLING * i
        weighted_sum(weights, high, first, made)
        for j in range(out.shape[1]):
            out[i, j] = made[j]
        for j in (T, ANGLE1, ANGLE2, LOAD):
            out[i, j] = high[first + centre, j]


class BandLimiter:
    """Turns samples at OVERSAMPLING times the rate into band-limited samples at the rate.

    Accelerations, forces, delta, delta_dot and speed, which jump or kink at events, are filtered.
    Time, angles and load torque are smooth and are taken at their instant, which is where the
    filter's delay puts the others.

    Parameters
    ----------
    capacity : int
        Most samples that `room` is asked for at once.
    """

    def __init__(self, capacity: int) -> None:
        self.capacity = capacity
        self._rows = np.zeros((TAPS + OVERSAMPLING * capacity, HIGH_RATE_COLUMNS))
        self._made = np.zeros(HIGH_RATE_COLUMNS)
        self._held = 0

    def start(self, first: np.ndarray) -> None:
        """Forget the past; before the run's first sample everything stood as in it."""
        self._held = TAPS // 2 + 1
        self._rows[: self._held] = first

    def room(self, count: int) -> np.ndarray:
        """Return the rows, at the high rate, that are to be filled for the next `count` samples."""
        needed = TAPS + OVERSAMPLING * (count - 1)
        return self._rows[self._held : needed]

    def take(self, out: np.ndarray) -> None:
        """Fill `out`, (count, 13), once the rows of `room(count)` are filled.

        The result does not depend on how the stream is cut into calls, to the last bit.
        """
        count = len(out)
        _decimate(taps(), self._rows, self._made, out)
        used = OVERSAMPLING * count
        self._held = TAPS - OVERSAMPLING
        self._rows[: self._held] = self._rows[used : used + self._held]
