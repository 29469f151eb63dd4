"""Band-limited samples: evaluation at four times the rate, a linear-phase FIR, decimation.

Acceleration and force jump at mesh events; sampled as they are, what lies above half the sample
rate folds back. The filter is a Kaiser-windowed sinc, flat to 20/51.2 of the sample rate and at
least 80 dB down from half the sample rate on.
"""

from __future__ import annotations

import functools

import numpy as np

from gear_dynamics.model.columns import CHANNELS, SAMPLES

OVERSAMPLING = 4
DELAY = 24
"""Samples by which the filter looks ahead of the sample that it makes."""

FILTERED = (*CHANNELS, 'speed')
"""Columns that jump or kink at events. The others are smooth and are taken at their instant, which
is where the filter's delay puts the filtered ones."""

_PASS = 20.0 / 51.2
_STOP = 0.5
_STOP_DB = 84.0
_CHUNK = 16


@functools.cache
def taps() -> np.ndarray:
    """Return the filter, (2 DELAY OVERSAMPLING + 1,), of unit gain at rest.

    Kaiser's design formulas (Kaiser, 1974; Oppenheim and Schafer, section 7.5).
    """
    half = DELAY * OVERSAMPLING
    cutoff = (_PASS + _STOP) / 2 * 2 / OVERSAMPLING
    n = np.arange(-half, half + 1)
    beta = 0.1102 * (_STOP_DB - 8.7)
    window = np.kaiser(2 * half + 1, beta)
    response = cutoff * np.sinc(cutoff * n) * window
    return response / response.sum()


@functools.cache
def _chunk_matrix() -> np.ndarray:
    """Return the matrix that makes _CHUNK samples at once out of the samples at the high rate."""
    h = taps()
    matrix = np.zeros((_CHUNK, h.size + OVERSAMPLING * (_CHUNK - 1)))
    for i in range(_CHUNK):
        matrix[i, OVERSAMPLING * i : OVERSAMPLING * i + h.size] = h
    return matrix


class BandLimiter:
    """Turns samples at OVERSAMPLING times the rate into band-limited samples at the rate."""

    def __init__(self) -> None:
        self._columns = np.zeros((0, len(FILTERED)))
        self._rows = np.zeros(0, SAMPLES)

    @property
    def missing(self) -> int:
        """Samples at the high rate that are needed before the next sample can be made."""
        return max(0, 2 * DELAY * OVERSAMPLING + 1 - len(self._rows))

    def start(self, first: np.ndarray) -> None:
        """Forget the past; before the run's first sample everything stood as in it."""
        history = np.repeat(first[:1], DELAY * OVERSAMPLING)
        self._rows = history
        self._columns = _filtered_columns(history)

    def feed(self, rows: np.ndarray) -> np.ndarray:
        """Take samples at the high rate (SAMPLES) and return those at the rate that they complete.

        The result does not depend on how the stream is cut into calls, to the last bit.
        """
        all_rows = np.concatenate([self._rows, rows])
        columns = np.concatenate([self._columns, _filtered_columns(rows)])
        span = 2 * DELAY * OVERSAMPLING + 1
        count = max(0, (len(all_rows) - span) // OVERSAMPLING + 1)
        centre = DELAY * OVERSAMPLING
        out = all_rows[centre : centre + count * OVERSAMPLING : OVERSAMPLING].copy()
        matrix = _chunk_matrix()
        padded = np.concatenate([columns, np.zeros((matrix.shape[1], len(FILTERED)))])
        # Every product has the same shape, so that its rounding is the same wherever it falls.
        for begin in range(0, count, _CHUNK):
            high = OVERSAMPLING * begin
            made = matrix @ padded[high : high + matrix.shape[1]]
            for j, name in enumerate(FILTERED):
                out[name][begin : begin + _CHUNK] = made[: count - begin, j]
        used = count * OVERSAMPLING
        self._rows, self._columns = all_rows[used:], columns[used:]
        return out


def _filtered_columns(rows: np.ndarray) -> np.ndarray:
    return np.stack([rows[name] for name in FILTERED], axis=1)
