"""RMS and mesh harmonics of records over whole mesh cycles, closed or not."""

from __future__ import annotations

import math

import numpy as np

ACCELERATIONS = ('pinion_ax', 'pinion_ay', 'gear_ax', 'gear_ay')
QUANTITIES = (*ACCELERATIONS, 'delta', 'mesh_force', 'friction_force')

HARMONICS, DRAWN = 5, 20
"""Mesh harmonics in a row, and in a figure."""


def row_of(values: np.ndarray, cycles: int) -> np.ndarray:
    """Return RMS about the mean and peak amplitudes of mesh harmonics 1 to HARMONICS.

    values : (n,) array of samples at equal distances.
    """
    lines = np.fft.rfft(values)[cycles : (HARMONICS + 1) * cycles : cycles]
    return np.array([values.std(), *(2 * np.abs(lines) / len(values))])


def row_of_slope(slope: np.ndarray, rate: np.ndarray, cycles: int, duration: float) -> np.ndarray:
    """Return what `row_of` does of the slope of a rate, as `slope_harmonics`.

    slope : (n,) array
    """
    return np.array([slope.std(), *slope_harmonics(rate, cycles, duration)[:HARMONICS]])


def slope_harmonics(rate: np.ndarray, cycles: int, duration: float) -> np.ndarray:
    """Return the peak amplitudes of mesh harmonics 1 to DRAWN of the slope of a rate.

    They are the rate's, integrated by parts: the slope jumps where tooth pairs come and go, and
    what folds back of that would hide the low ones, which are small.

    Parameters
    ----------
    rate : (n + 1,) array
        Goes on to the end of the record.
    cycles : int
    duration : float
        Of the record [s].
    """
    change = rate[-1] - rate[0]
    harmonics = np.arange(1, DRAWN + 1) * cycles
    # By the trapezoidal rule, of which the transform leaves out the end.
    means = (np.fft.rfft(rate[:-1])[harmonics] + change / 2) / (len(rate) - 1)
    return 2 * np.abs(change / duration + 2j * math.pi * harmonics / duration * means)
