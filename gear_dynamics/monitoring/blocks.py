"""Checks a block of samples, or of events, before it is let into the analysis."""

from __future__ import annotations

import math

import numpy as np

from gear_dynamics.machine.columns import EVENTS
from gear_dynamics.monitoring.gaps import SAME_TIME
from gear_dynamics.monitoring.layout import TIME, Layout

MOST_ROWS = 65536
"""Rows of a block: the greatest block size that a rig can have."""

GREATEST = 1e12
"""Magnitude beyond which a finite value is absurd in any unit of a machine."""

LONGEST = 3600.0
"""Time of an event after the stamp of its block beyond which it is absurd [s]."""


class BlockError(ValueError):
    """A block cannot be used; `kind` is for counting, the message is the reason in one line."""

    def __init__(self, kind: str, message: str) -> None:
        super().__init__(message)
        self.kind = kind


def checked_columns(rows: np.ndarray, layout: Layout) -> np.ndarray:
    """Return the columns of a block that are read as float64, shape (n, columns).

    Parameters
    ----------
    rows : ndarray
        Structured, t [s] counted from the first sample.
    layout : Layout
        The columns, and the rate that t must step by.

    Raises
    ------
    BlockError
        If there is no row or too many, a column is missing, a value is not finite or absurd, or t
        steps otherwise.
    """
    _check_rows(rows, layout.columns)
    values = np.empty((len(rows), len(layout.columns)))
    for index, name in enumerate(layout.columns):
        values[:, index] = rows[name]
    _check_values(values, layout.columns)
    rate = layout.sample_rate
    t = values[:, layout.index(TIME)]
    off = np.abs((t - t[0]) * rate - np.arange(len(values)))
    if off.max() > SAME_TIME:
        step = (t[-1] - t[0]) / max(len(values) - 1, 1)
        raise BlockError(
            'step',
            f'the step of t is {step:.9g} s: at {rate:g} samples/s it must be {1 / rate:.9g}',
        )
    return values


def checked_events(rows: np.ndarray) -> np.ndarray:
    """Return the events of a block, dtype EVENTS.

    Raises
    ------
    BlockError
        If there are too many, a column is missing, or a value is not finite or absurd.
    """
    names = EVENTS.names or ()
    if len(rows) == 0 and rows.dtype.names and set(names) <= set(rows.dtype.names):
        return rows[list(names)].astype(EVENTS)
    _check_rows(rows, names)
    values = np.column_stack([rows[name].astype(float) for name in names])
    _check_values(values, names, {'cycle': 2.0**53, 't': LONGEST})
    return rows[list(names)].astype(EVENTS)


def _check_rows(rows: np.ndarray, names: tuple[str, ...]) -> None:
    if len(rows) == 0:
        raise BlockError('empty', 'the block has no rows')
    if len(rows) > MOST_ROWS:
        raise BlockError(
            'too long', f'the block has {len(rows)} rows: at most {MOST_ROWS} are taken'
        )
    missing = [name for name in names if name not in (rows.dtype.names or ())]
    if missing:
        raise BlockError('columns', f'the block has no column {", ".join(missing)}')
    for name in names:
        if rows.dtype[name].kind not in 'iuf' or rows.dtype[name].shape:
            raise BlockError(
                'columns', f'column {name} holds {rows.dtype[name]}: numbers are needed'
            )


def _check_values(
    values: np.ndarray, names: tuple[str, ...], greatest: dict[str, float] | None = None
) -> None:
    # One pass finds both: a comparison with NaN is false.
    limits = np.array([(greatest or {}).get(name, GREATEST) for name in names])
    good = np.abs(values) <= limits
    if good.all():
        return
    row, column = (int(each) for each in np.argwhere(~good)[0])
    value = values[row, column]
    where = f'{names[column]} is {value:g} in row {row}'
    if math.isfinite(value):
        raise BlockError('absurd', f'{where}: magnitudes up to {limits[column]:g} are taken')
    raise BlockError('not finite', where)
