"""Band-limited interpolation between samples at equal steps."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.signal import kaiser_beta

from gear_dynamics.kernels import kernel
from gear_dynamics.signal.arguments import real_array

HALF_WIDTH = 16
"""Samples on either side of an instant from which its value is interpolated."""

_PHASES = 1024
_STOP_BAND = 100.0  # dB


def _weights() -> np.ndarray:
    """Return the windowed sinc at 1024 places between two samples, shape (1025, 32)."""
    beta = kaiser_beta(_STOP_BAND)
    taps = np.arange(1 - HALF_WIDTH, HALF_WIDTH + 1)
    distance = np.arange(_PHASES + 1)[:, np.newaxis] / _PHASES - taps
    inside = np.sqrt(np.clip(1 - (distance / HALF_WIDTH) ** 2, 0, None))
    weights = np.sinc(distance) * np.i0(beta * inside)
    return weights / weights.sum(axis=1, keepdims=True)


_WEIGHTS = _weights()

ACCURATE_BAND = 0.4
"""Fraction of the sample rate below which a tone comes out within 3e-5 of its amplitude."""


def interpolate(x: npt.ArrayLike, positions: npt.ArrayLike, *, axis: int = 0) -> np.ndarray:
    """Return a signal at fractional positions, by a windowed sinc of 32 taps.

    A tone below 0.4 of the sample rate comes out within 3e-5 of its amplitude.

    Parameters
    ----------
    x : array_like
    positions : array_like, shape (m,)
        In samples, from HALF_WIDTH - 1 to n - 1 - HALF_WIDTH.
    axis : int
        Axis of the n samples.

    Returns
    -------
    ndarray
        As x, with m values along the axis.

    Raises
    ------
    ValueError
        If a position is too close to an end, or a value is not finite.
    """
    x, positions = real_array(x, axis=axis), real_array(positions, 'positions').astype(float)
    values = interpolate_rows(x.reshape(len(x), -1), positions)
    return np.moveaxis(values.reshape((-1, *x.shape[1:])), 0, axis)


def interpolate_rows(rows: np.ndarray, positions: np.ndarray) -> np.ndarray:
    """Return rows of an (n, columns) array at m positions, as `interpolate` does.

    Raises
    ------
    ValueError
        If a position is too close to an end.
    """
    if len(positions) and not (
        positions.min() >= HALF_WIDTH - 1 and positions.max() <= len(rows) - 1 - HALF_WIDTH
    ):
        raise ValueError(
            f'positions {positions.min():g} to {positions.max():g} must lie from {HALF_WIDTH - 1} '
            f'to {len(rows) - 1 - HALF_WIDTH}'
        )
    rows = np.ascontiguousarray(rows, dtype=float)
    if rows.shape[1] == 1:
        return _interpolate_one(rows[:, 0], positions, _WEIGHTS)[:, np.newaxis]
    return _interpolate(rows, positions, _WEIGHTS)


@kernel
def _interpolate(rows, positions, weights):  # type: ignore[no-untyped-def]
    half = weights.shape[1] // 2
    phases = weights.shape[0] - 1
    result = np.zeros((len(positions), rows.shape[1]))
    for m in range(len(positions)):
        before = int(np.floor(positions[m]))
        place = (positions[m] - before) * phases
        index = min(int(place), phases - 1)
        share = place - index
        for tap in range(2 * half):
            weight = (1 - share) * weights[index, tap] + share * weights[index + 1, tap]
            row = before + 1 - half + tap
            for column in range(rows.shape[1]):
                result[m, column] += weight * rows[row, column]
    return result


@kernel
def _interpolate_one(values, positions, weights):  # type: ignore[no-untyped-def]
    """The same for one column: four sums side by side, which the processor adds at once."""
    taps = weights.shape[1]
    phases = weights.shape[0] - 1
    result = np.empty(len(positions))
    for m in range(len(positions)):
        before = int(np.floor(positions[m]))
        place = (positions[m] - before) * phases
        index = min(int(place), phases - 1)
        share = place - index
        low, high = weights[index], weights[index + 1]
        part = values[before + 1 - taps // 2 : before + 1 + taps // 2]
        a = b = c = d = 0.0
        for tap in range(0, taps, 4):
            a += (low[tap] + share * (high[tap] - low[tap])) * part[tap]
            b += (low[tap + 1] + share * (high[tap + 1] - low[tap + 1])) * part[tap + 1]
            c += (low[tap + 2] + share * (high[tap + 2] - low[tap + 2])) * part[tap + 2]
            d += (low[tap + 3] + share * (high[tap + 3] - low[tap + 3])) * part[tap + 3]
        result[m] = (a + b) + (c + d)
    return result
