"""Synchronous averages of the wheels, and what is left when the mesh is taken out of them."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy import fft


def hunting_revolutions(teeth: int, other_teeth: int) -> int:
    """Return the revolutions after which the same teeth meet again: the hunting-tooth period."""
    return other_teeth // math.gcd(teeth, other_teeth)


def other_wheel_leakage(revolutions: int, teeth: int, other_teeth: int) -> float:
    """Return how much of the other wheel's worst order is left in an average over `revolutions`.

    The average answers to order r with |sin(pi N r) / (N sin(pi r))|, r counted from the nearest
    whole order (McFadden 1987). Over whole hunting-tooth periods that is zero for every order of
    the other wheel.

    Returns
    -------
    float
        Ratio of amplitudes, 0 to 1.
    """
    period = hunting_revolutions(teeth, other_teeth)
    if revolutions % period == 0:
        return 0.0
    r = np.arange(1, period) / period
    return float(np.max(np.abs(np.sin(np.pi * revolutions * r) / np.sin(np.pi * r))) / revolutions)


def synchronous_average(values: np.ndarray, points: int) -> np.ndarray:
    """Return the mean revolution of a signal resampled by angle (McFadden 1987).

    Noise falls with the square root of the number of revolutions.

    Parameters
    ----------
    values : ndarray, shape (n,) or (n, channels)
        Whole revolutions from the first value on are used.
    points : int
        Points in a revolution.

    Returns
    -------
    ndarray, shape (points,) or (points, channels)
    """
    revolutions = len(values) // points
    if revolutions == 0:
        raise ValueError(f'{len(values)} values are less than one revolution of {points} points')
    whole = values[: revolutions * points]
    return whole.reshape(revolutions, points, *values.shape[1:]).mean(axis=0)


def below_order(average: np.ndarray, highest: float) -> np.ndarray:
    """Return an average of one revolution, (points, channels), without the orders above `highest`.

    Above the band in which resampling by angle is accurate an average holds its errors: at a speed
    that fits the sample rate they repeat with the revolution, and no averaging removes them.
    """
    lines = fft.rfft(average, axis=0)
    lines[math.floor(highest) + 1 :] = 0
    return fft.irfft(lines, len(average), axis=0)


class Parts(NamedTuple):
    """A synchronous average without its mean, and its parts; all of the same shape.

    Attributes
    ----------
    average : ndarray
        Without the mean.
    regular : ndarray
        Shaft orders 1 and 2, the mesh harmonics and their first side bands.
    residual : ndarray
        Without shaft orders 1 and 2 and the mesh harmonics; side bands are kept.
    difference : ndarray
        The residual without the first side bands: average - regular.
    """

    average: np.ndarray
    regular: np.ndarray
    residual: np.ndarray
    difference: np.ndarray


def separate(average: np.ndarray, teeth: int) -> Parts:
    """Split a synchronous average as Zakrajsek, Townsend and Decker 1993 (NASA TM 105950) do.

    Parameters
    ----------
    average : ndarray, shape (points,) or (points, channels)
        One revolution of the wheel.
    teeth : int
        Of the wheel.
    """
    lines = fft.rfft(average, axis=0)
    orders = np.arange(len(lines))
    from_harmonic = np.abs(orders - teeth * np.maximum(np.round(orders / teeth), 1))
    mean = orders == 0
    mesh = (orders <= 2) | (from_harmonic == 0)
    side_bands = ~mesh & (from_harmonic == 1)

    def without(removed: np.ndarray) -> np.ndarray:
        kept = np.where(removed.reshape((-1,) + (1,) * (lines.ndim - 1)), 0, lines)
        return fft.irfft(kept, len(average), axis=0)

    difference = without(mesh | side_bands)
    whole = without(mean)
    return Parts(whole, whole - difference, without(mesh), difference)
