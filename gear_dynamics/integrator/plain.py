"""What the vector code of `polynomials` and `lanes` does, in NumPy.

Each function has the name and the arguments of the one that it stands for. They are the ones to
read; they also run where nothing is compiled (NUMBA_DISABLE_JIT). Tests compare both.
"""

from __future__ import annotations

import numpy as np

from gear_dynamics.integrator.layout import (
    AX1,
    DELTA,
    PADDED_TAPS,
    PSI,
    Q_SUM,
    ROWS,
    STATE_Q_SUM,
    SUPPORTED,
    TAPS,
    VELOCITY,
)

COLUMNS = 8
FILTERED = slice(AX1, AX1 + COLUMNS)


def rough_log2(number):
    """Return the logarithm to base 2 of a positive number to 0.09, from its bits."""
    return float(np.float64(number).view(np.int64)) * 2.0**-52 - 1023.0


def weighted_rows(weights, rows, first, out, row):
    """Put the weighted sum of the filtered columns of TAPS rows into those of a row of `out`."""
    out[row, FILTERED] = weights[:TAPS] @ rows[first : first + TAPS, FILTERED]


def weighted_line(weights, numbers, first):
    """Return the weighted sum of numbers from an index on."""
    return weights[:PADDED_TAPS] @ numbers[first : first + PADDED_TAPS]


def values_and_slopes(coefficients, t):
    """Return polynomials, whose coefficients are the rows, and their slopes at a time."""
    value = slope = np.zeros(np.shape(coefficients[0] * t))
    for row in coefficients[::-1]:
        slope = slope * t + value
        value = value * t + row
    return value, slope


def columns_at(series, t, out):
    """Put eight polynomials and their slopes at time t into rows 0 and 1 of `out`."""
    numbers = out.reshape(-1)
    numbers[:COLUMNS], numbers[COLUMNS : 2 * COLUMNS] = values_and_slopes(series, t)


def advance_columns(series, t, state):
    """Put the state at time t into an array with room for one number more."""
    value, slope = values_and_slopes(series, t)
    state[:VELOCITY] = value[:VELOCITY]
    state[VELOCITY : 2 * VELOCITY] = slope[:VELOCITY]
    state[STATE_Q_SUM] = value[Q_SUM]


def fill_rates(series, rates):
    """Fill the series of the derivatives that samples are made of."""
    for k in range(ROWS - 1):
        rates[k, :SUPPORTED] = 0.0
        if k + 2 < ROWS:
            rates[k, :SUPPORTED] = (k + 1) * (k + 2) * series[k + 2, :SUPPORTED]
        rates[k, SUPPORTED:] = (k + 1) * series[k + 1, SUPPORTED:]


def fill_values(series, rates, times, values):
    """Evaluate the polynomials that samples are made of at eight times."""
    for row in range(DELTA + 1):
        values[row] = values_and_slopes(rates[: ROWS - 1, row], times)[0]
    for column in range(PSI, COLUMNS):
        row = DELTA + 1 + column - PSI
        values[row] = values_and_slopes(series[:ROWS, column], times)[0]


def _sixteenths_of(h):
    return h * np.arange(1, 17) / 16


def sixteenths(polynomials, row, h, out):
    """Put a polynomial and its slope at h/16, 2h/16, ..., h into rows 0 and 1 of `out`."""
    out[0], out[1] = values_and_slopes(polynomials[row, :ROWS], _sixteenths_of(h))


def delta_stays_above(series, h, level):
    """Return whether delta stays above a level from time 0 to h, by its values at sixteenths of h.

    Where it turns between two of them, its dip is at most a quarter of the change of slope times
    the time between, where delta is convex; twice that leaves room for an inflection.
    """
    delta = series[:ROWS, DELTA]
    times = np.concatenate([[0.0], _sixteenths_of(h)])
    value, slope = values_and_slopes(delta, times)
    turns = (slope[:-1] < 0) & (slope[1:] > 0)
    dip = np.where(turns, np.diff(slope) * h / 32, 0.0)
    return bool(np.all(np.minimum(value[:-1], value[1:]) - dip > level))
