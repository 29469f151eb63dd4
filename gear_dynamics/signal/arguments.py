"""Checks and conversions of the array arguments of this room."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt


def real_array(x: npt.ArrayLike, name: str = 'x', axis: int = 0) -> np.ndarray:
    """Return an argument as a real floating-point array whose first axis is `axis`.

    Arrays of float32 and float64 keep their type; lists and integers become float64.

    Parameters
    ----------
    x : array_like
    name : str
        Of the argument, for the messages.
    axis : int
        Axis of the samples.

    Raises
    ------
    ValueError
        If x holds no real numbers, has no sample, has no such axis, or a value is not finite.
    """
    array: np.ndarray[Any, Any] = np.asarray(x)
    if array.dtype not in (np.float32, np.float64):
        if array.dtype.kind not in 'iufb':
            raise ValueError(f'{name} is of type {array.dtype}: it must hold real numbers')
        array = array.astype(np.float64)
    if not -array.ndim <= axis < array.ndim:
        raise ValueError(f'{name} has {array.ndim} axes: there is no axis {axis}')
    if array.shape[axis] == 0:
        raise ValueError(f'{name} has no samples along axis {axis}')
    finite = np.isfinite(array)
    if not finite.all():
        place = tuple(int(each) for each in np.argwhere(~finite)[0])
        where = place[0] if len(place) == 1 else place
        raise ValueError(f'{name} is {array[place]} at index {where}: all values must be finite')
    return np.moveaxis(array, axis, 0)


def real_series(x: npt.ArrayLike, name: str = 'x') -> np.ndarray:
    """Return an argument that holds one channel as a real floating-point array, shape (n,).

    Raises
    ------
    ValueError
        As `real_array`, and if there is more than one channel.
    """
    array = real_array(x, name)
    if array.size != len(array):
        raise ValueError(f'{name} has the shape {array.shape}: it must hold one channel')
    return array.reshape(-1)


def whole_number(value: Any, name: str, least: int = 1) -> int:
    """Return a count as an int.

    Raises
    ------
    ValueError
        If it is not a whole number, or less than `least`.
    """
    if not float(value).is_integer() or value < least:
        raise ValueError(f'{name} is {value}: it must be a whole number of at least {least}')
    return int(value)


def positive(value: float, name: str) -> float:
    """Return a number that must be finite and above 0.

    Raises
    ------
    ValueError
        If it is not.
    """
    if not (np.isfinite(value) and value > 0):
        raise ValueError(f'{name} is {value}: it must be a finite number above 0')
    return float(value)
