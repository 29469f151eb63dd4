"""What the vector code of `recurrence`, `convolution`, `polynomials` and `lanes` does, in NumPy.

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
    SEG_FORCE,
    SEG_FRICTION,
    SEG_MOMENT,
    STATE_Q_SUM,
    SUPPORTED,
    TAPS,
    VELOCITY,
    Y1,
    Y2,
    Q,
)

(
    TO_FORCE,
    TO_FRICTION,
    TO_MOMENT,
    TO_LOAD,
    STIFFNESS,
    DAMPING,
    TO_Q,
    TO_Q_DOT,
    TO_Q_SUM,
) = range(9)

COLUMNS = 8
FILTERED = slice(AX1, AX1 + COLUMNS)


def rough_log2(number):
    """Return the logarithm to base 2 of a positive number to 0.09, from its bits."""
    return float(np.float64(number).view(np.int64)) * 2.0**-52 - 1023.0


def largest(series, row, scales):
    """Return the largest magnitude in a row of a series, each column times its scale."""
    return np.abs(series[row] * scales).max()


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


def _delta(row, error):
    return row[Y2] - row[Y1] + (row[PSI] - error)


def begin_series(state, error, series):
    """Fill rows 0 and 1 of a series: positions and velocities."""
    errors = np.ravel(error)
    series[0, :VELOCITY], series[1, :VELOCITY] = state[:VELOCITY], state[VELOCITY : 2 * VELOCITY]
    series[0, Q_SUM], series[1, Q_SUM] = state[STATE_Q_SUM], state[Q]
    for k in range(2):
        series[k, DELTA] = _delta(series[k], errors[k])


def _folded(answers, segment, row):
    """Return what the mesh's stiffness (row 0), damping (1) or offset (2) does to each column."""
    return (
        segment[SEG_FORCE + row, 0] * answers[TO_FORCE]
        + segment[SEG_FRICTION + row, 0] * answers[TO_FRICTION]
        + segment[SEG_MOMENT + row, 0] * answers[TO_MOMENT]
    )


def _put_next(answers, segment, error, k, weights, more, series):
    """Put order k + 2 of a series; `more` is what else accelerates."""
    now, following = series[k], series[k + 1]
    rates = (
        answers[DAMPING] * following
        + answers[TO_Q_DOT] * following[Q]
        + _folded(answers, segment, 1) * following[DELTA]
    )
    total = (
        answers[STIFFNESS] * now
        + answers[TO_Q] * now[Q]
        + answers[TO_Q_SUM] * now[Q_SUM]
        + _folded(answers, segment, 0) * now[DELTA]
        + more
    )
    series[k + 2] = weights[0] * rates + weights[1] * total
    series[k + 2, DELTA] = _delta(series[k + 2], np.ravel(error)[k + 2])


def fill_orders(answers, segment, state, error, travel, travel_rate, torque, torque_rate, series):
    """Fill a series."""
    push = np.zeros((ROWS, COLUMNS))
    fill_pushed_orders(
        answers, segment, state, error, travel, travel_rate, torque, torque_rate, push, series
    )


def fill_pushed_orders(
    answers, segment, state, error, travel, travel_rate, torque, torque_rate, push, series
):
    """Fill a series, with accelerations besides."""
    begin_series(state, error, series)
    friction = np.zeros(ROWS)
    for k in range(ROWS - 2):
        more = push[k].copy()
        if k == 0:
            more += _folded(answers, segment, 2)
        if k < 2:
            more += answers[TO_LOAD] * (torque, torque_rate)[k]
        for j, grows in enumerate((travel, travel_rate)):
            if k - 1 - j >= 0:
                more += answers[TO_MOMENT] * grows * friction[k - 1 - j]
        weights = 1 / (k + 2), 1 / ((k + 1) * (k + 2))
        _put_next(answers, segment, error, k, weights, more, series)
        rubs = segment[SEG_FRICTION : SEG_FRICTION + 3, 0]
        friction[k] = rubs[0] * series[k, DELTA] + rubs[1] * (k + 1) * series[k + 1, DELTA]
        friction[k] += push[k, DELTA] + (rubs[2] if k == 0 else 0.0)


def put_folded(answers, segment, row, j, out, index):
    """Put what order j of stiffness (row 0), damping (1) or offset (2) does to each column."""
    friction = answers[TO_FRICTION].copy()
    friction[DELTA] = 1.0
    out.reshape(-1)[COLUMNS * index : COLUMNS * (index + 1)] = (
        answers[TO_FORCE] * segment[SEG_FORCE + row, j]
        + friction * segment[SEG_FRICTION + row, j]
        + answers[TO_MOMENT] * segment[SEG_MOMENT + row, j]
    )


def fill_convolved_orders(
    answers,
    folded,
    offsets,
    support_rows,
    state,
    error,
    orders,
    weights,
    degree_count,
    support_count,
    travel,
    travel_rate,
    series,
):
    """Fill a series whose coefficients are polynomials in time."""
    begin_series(state, error, series)
    friction = np.zeros(ROWS)
    for k in range(ROWS - 2):
        now, following = series[k], series[k + 1]
        total = offsets[k] + answers[STIFFNESS] * now
        total += answers[TO_Q] * now[Q] + answers[TO_Q_SUM] * now[Q_SUM]
        for j in range(min(k + 1, degree_count)):
            rate = (k - j + 1) * series[k - j + 1, DELTA]
            total += folded[j, :COLUMNS] * series[k - j, DELTA] + folded[j, COLUMNS:] * rate
        friction[k] = total[DELTA]
        for j, grows in enumerate((travel, travel_rate)):
            if k - 1 - j >= 0:
                total += answers[TO_MOMENT] * grows * friction[k - 1 - j]
        for j in range(min(k + 1, support_count)):
            rates = (k - j + 1) * series[k - j + 1]
            total += support_rows[j, :COLUMNS] * series[k - j] + support_rows[j, COLUMNS:] * rates
        rates = answers[DAMPING] * following + answers[TO_Q_DOT] * following[Q]
        series[k + 2] = weights[2 * k] * rates + weights[2 * k + 1] * total
        series[k + 2, DELTA] = _delta(series[k + 2], np.ravel(error)[k + 2])
