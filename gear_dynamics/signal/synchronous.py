"""Synchronous averages of the wheels, and what is left when the mesh is taken out of them."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy import fft

from gear_dynamics.signal.arguments import positive, real_array, whole_number


def checked_average(
    average: npt.ArrayLike, teeth: int, least: int | None = None, *, axis: int = 0
) -> tuple[np.ndarray, int]:
    """Return a synchronous average as float64, its points along the first axis, and the teeth.

    Raises
    ------
    ValueError
        If the teeth are no positive whole number, a value is not finite, or there are fewer points
        than `least`: two a tooth by default, without which the mesh order is not resolved.
    """
    teeth = whole_number(teeth, 'teeth')
    array = real_array(average, 'average', axis).astype(float, copy=False)
    least = 2 * teeth if least is None else least
    if len(array) < least:
        raise ValueError(
            f'the average has {len(array)} points: {teeth} teeth need at least {least}'
        )
    return array, teeth


def hunting_revolutions(teeth: int, other_teeth: int) -> int:
    """Return the revolutions after which the same teeth meet again: the hunting-tooth period."""
    teeth = whole_number(teeth, 'teeth')
    other_teeth = whole_number(other_teeth, 'other_teeth')
    return other_teeth // math.gcd(teeth, other_teeth)


def other_wheel_leakage(revolutions: int, teeth: int, other_teeth: int) -> float:
    """Return how much of the other wheel's worst order is left in an average over `revolutions`.

    The frequency response of the average at order r is |sin(pi N r) / (N sin(pi r))|, r counted
    from the nearest whole order (McFadden 1987). Over whole hunting-tooth periods it is zero for
    every order of the other wheel.

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


def synchronous_average(values: npt.ArrayLike, points: int, *, axis: int = 0) -> np.ndarray:
    """Return the mean revolution of a signal resampled by angle (McFadden 1987).

    Noise falls with the square root of the number of revolutions.

    Parameters
    ----------
    values : array_like
        The complete revolutions from the first value on are used.
    points : int
        Points in a revolution.
    axis : int
        Axis of the points.

    Returns
    -------
    ndarray
        Of the shape of `values`, with `points` values along `axis`.

    Raises
    ------
    ValueError
        If there is less than one revolution, or a value is not finite.
    """
    values = real_array(values, 'values', axis)
    points = whole_number(points, 'points')
    revolutions = len(values) // points
    if revolutions == 0:
        raise ValueError(f'{len(values)} values are less than one revolution of {points} points')
    complete = values[: revolutions * points].reshape(revolutions, points, *values.shape[1:])
    return np.moveaxis(complete.mean(axis=0), 0, axis)


def below_order(average: npt.ArrayLike, highest: float, *, axis: int = 0) -> np.ndarray:
    """Return an average of one revolution along `axis` without the orders above `highest`.

    Above the band in which resampling by angle is accurate an average holds its errors: at a speed
    that fits the sample rate they repeat with the revolution, and no averaging removes them.
    """
    average = real_array(average, 'average', axis)
    lines = fft.rfft(average, axis=0)
    lines[math.floor(positive(highest, 'highest')) + 1 :] = 0
    return np.moveaxis(fft.irfft(lines, len(average), axis=0), 0, axis)


class Parts(NamedTuple):
    """A synchronous average without its mean, and its parts; all of the same shape.

    Attributes
    ----------
    average : ndarray
        Without the mean.
    regular : ndarray
        Shaft orders 1 and 2, the mesh harmonics and their first sidebands.
    residual : ndarray
        Without shaft orders 1 and 2 and the mesh harmonics; sidebands are kept.
    difference : ndarray
        The residual without the first sidebands: average - regular.
    """

    average: np.ndarray
    regular: np.ndarray
    residual: np.ndarray
    difference: np.ndarray


def separate(average: npt.ArrayLike, teeth: int, *, axis: int = 0) -> Parts:
    """Split a synchronous average as Zakrajsek, Townsend and Decker 1993 (NASA TM 105950) do.

    Parameters
    ----------
    average : array_like
        One revolution of the wheel along `axis`.
    teeth : int
        Of the wheel.
    axis : int
        Axis of the points.

    Raises
    ------
    ValueError
        If the teeth are no positive whole number, there are fewer than two points a tooth, or a
        value is not finite.
    """
    average, teeth = checked_average(average, teeth, axis=axis)
    lines = fft.rfft(average, axis=0)
    orders = np.arange(len(lines))
    from_harmonic = np.abs(orders - teeth * np.maximum(np.round(orders / teeth), 1))
    constant = orders == 0
    mesh = (orders <= 2) | (from_harmonic == 0)
    sidebands = ~mesh & (from_harmonic == 1)

    def without(removed: np.ndarray) -> np.ndarray:
        kept = np.where(removed.reshape((-1,) + (1,) * (lines.ndim - 1)), 0, lines)
        return fft.irfft(kept, len(average), axis=0)

    difference = without(mesh | sidebands)
    vibration = without(constant)
    parts = (vibration, vibration - difference, without(mesh), difference)
    return Parts(*(np.moveaxis(part, 0, axis) for part in parts))
