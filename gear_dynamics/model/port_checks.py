"""Checks of the numbers that terms of ports are made of; each raises ParameterError by name."""

from __future__ import annotations

from typing import Any

import numpy as np

from gear_dynamics.parameters.parameter import ParameterError

DEGREE = 6
"""Greatest degree of a polynomial piece."""

MOST = DEGREE + 1
"""Coefficients of a piece at most."""


def finite(name: str, value: Any) -> float:
    """Return a finite number."""
    number = float(value)
    if not np.isfinite(number):
        raise ParameterError(f'{name} is {value!r}: it must be finite')
    return number


def frozen(array: np.ndarray) -> np.ndarray:
    """Return an array that cannot be written to."""
    array.setflags(write=False)
    return array


def increasing(name: str, values: Any) -> np.ndarray:
    """Return two numbers or more that increase."""
    array = np.array(values, float)
    if array.ndim != 1 or array.size < 2 or not np.isfinite(array).all():
        raise ParameterError(f'{name} must be two finite numbers or more, not {values!r}')
    if (np.diff(array) <= 0).any():
        raise ParameterError(f'{name} must increase: {values!r}')
    return frozen(array)


def pieces(name: str, values: Any, n: int) -> np.ndarray:
    """Return coefficients as an (n, MOST) array; rows may be of different lengths."""
    if np.isscalar(values):
        values = np.full((n, 1), values)
    rows = [np.atleast_1d(np.array(row, float)) for row in values]
    if len(rows) != n or any(row.ndim != 1 or not 0 < row.size <= MOST for row in rows):
        raise ParameterError(
            f'{name} is {values!r}: it must have {n} rows of 1 to {MOST} coefficients'
        )
    array = np.zeros((n, MOST))
    for place, row in zip(array, rows, strict=True):
        place[: row.size] = row
    if not np.isfinite(array).all():
        raise ParameterError(f'{name} must be finite')
    return frozen(array)
