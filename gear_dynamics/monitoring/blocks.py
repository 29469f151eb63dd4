"""Checks a block of samples before it is let into the analysis."""

from __future__ import annotations

import numpy as np

from gear_dynamics.machine.columns import CHANNELS, SAMPLE_COLUMNS
from gear_dynamics.monitoring.gaps import SAME_TIME


class BlockError(ValueError):
    """A block cannot be used; `kind` is for counting, the message is the reason in one line."""

    def __init__(self, kind: str, message: str) -> None:
        super().__init__(message)
        self.kind = kind


def checked_columns(rows: np.ndarray, rate: float) -> np.ndarray:
    """Return a block as float64, shape (n, 13), in the order of SAMPLE_COLUMNS.

    Parameters
    ----------
    rows : ndarray
        Structured, t [s] counted from the first sample.
    rate : float
        Samples per second that t must step by [Hz].

    Raises
    ------
    BlockError
        If there is no row, a column is missing, a value is not finite, or t steps otherwise.
    """
    if len(rows) == 0:
        raise BlockError('empty', 'the block has no rows')
    missing = [name for name in SAMPLE_COLUMNS if name not in (rows.dtype.names or ())]
    if missing:
        raise BlockError('columns', f'the block has no column {", ".join(missing)}')
    values = np.empty((len(rows), len(SAMPLE_COLUMNS)))
    for index, name in enumerate(SAMPLE_COLUMNS):
        values[:, index] = rows[name]
    if not np.isfinite(values).all():
        row, column = np.argwhere(~np.isfinite(values))[0]
        raise BlockError(
            'not finite', f'{SAMPLE_COLUMNS[column]} is {values[row, column]} in row {row}'
        )
    off = np.abs((values[:, 0] - values[0, 0]) * rate - np.arange(len(values)))
    if off.max() > SAME_TIME:
        step = (values[-1, 0] - values[0, 0]) / max(len(values) - 1, 1)
        raise BlockError(
            'step',
            f'the step of t is {step:.9g} s: at {rate:g} samples/s it must be {1 / rate:.9g}',
        )
    return values


def channels_of(values: np.ndarray) -> np.ndarray:
    """Return the channels of checked columns, shape (n, 8)."""
    first = SAMPLE_COLUMNS.index(CHANNELS[0])
    return values[:, first : first + len(CHANNELS)]


def column_of(values: np.ndarray, name: str) -> np.ndarray:
    """Return one of the checked columns."""
    return values[:, SAMPLE_COLUMNS.index(name)]
