"""Taylor series of the motion about one instant, by recurrence; the heart of the integrator.

Between events the equations of docs/model.md are linear, with coefficients that are polynomials in
time, so every order of the series follows from the orders before it in a few operations. The series
is its own dense output. (Taylor methods: Jorba and Zou, 2005.)
"""

from __future__ import annotations

import math

import numpy as np

from gear_dynamics.integrator.kernel import kernel
from gear_dynamics.integrator.lanes import rough_log2
from gear_dynamics.integrator.layout import (
    ERROR,
    ORDER,
    PSI,
    ROWS,
    VELOCITY,
    Y1,
    Y2,
)
from gear_dynamics.integrator.polynomials import advance_columns
from gear_dynamics.integrator.recurrence import Loads, fill_orders

_INVERSE = 1.0 / np.arange(1, ORDER + 3)


@kernel
def expand_error(motion):
    """Fill row 0 of the error with the series of e(phi) from the present instant on."""
    expand_own_error(motion)
    if motion.step.ported:
        added, degree = motion.signals[ERROR], motion.degrees[ERROR]
        for k in range(degree + 1):
            motion.error[0, k] += added[k]


@kernel
def expand_own_error(motion):
    """Fill row 0 of the error with the series of the pair's own transmission error."""
    p, commands, e = motion.constants, motion.commands, motion.error
    angle = 2 * math.pi * motion.phase.phase + p.phi0
    rate, ramp = p.z1 * commands.speed, p.z1 * commands.accel
    sine, cosine = p.e_a * math.sin(angle), p.e_a * math.cos(angle)
    if ramp == 0.0:
        for k in range(ROWS):
            e[0, k] = sine
            factor = rate * _INVERSE[k]
            sine, cosine = cosine * factor, -sine * factor
        return
    sine_before = cosine_before = 0.0
    for k in range(ROWS):
        e[0, k] = sine
        sine_next = (rate * cosine + ramp * cosine_before) * _INVERSE[k]
        cosine_next = -(rate * sine + ramp * sine_before) * _INVERSE[k]
        sine_before, cosine_before = sine, cosine
        sine, cosine = sine_next, cosine_next


@kernel
def arm_growth(motion):
    """Return v and w of the growth v t + w t^2 of the arms [m/s, m/s2]."""
    p, commands = motion.constants, motion.commands
    turn = p.pitch * p.z1 / (2 * math.pi)
    return turn * commands.speed, 0.5 * turn * commands.accel


@kernel
def expand(motion):
    """Fill the series with the Taylor series of the motion from the present state on.

    The transmission error's series, the segment and the push of the step must be there.
    """
    p, commands, step = motion.constants, motion.commands, motion.step
    step.travel, travel_rate = arm_growth(motion)
    # On the load side, with what accelerates the gear there.
    torque = commands.torque + p.ratio * p.inertia2 * commands.accel
    loads = Loads(step.travel, travel_rate, torque, commands.torque_rate)
    fill_orders(motion, motion, loads, step.pushed > 0)


@kernel
def advance_state(motion, t):
    """Replace the state at the beginning of the series by that at time t."""
    advance_columns(motion.series, t, motion.state)


@kernel
def apart(state, error):
    """Return delta and its rate by a state and the transmission error, row 0 of `error`."""
    delta = state[Y2] - state[Y1] + state[PSI] - error[0, 0]
    y = VELOCITY
    return delta, state[y + Y2] - state[y + Y1] + state[y + PSI] - error[0, 1]


@kernel
def value_and_slope(motion, column, t):
    """Return a column of the series and its derivative at t."""
    series = motion.series
    value, slope = series[ROWS - 1, column], 0.0
    for k in range(ROWS - 2, -1, -1):
        slope = slope * t + value
        value = value * t + series[k, column]
    return value, slope


@kernel
def polynomial(rows, row, t):
    """Return the polynomial whose coefficients are a row, and its derivative, at t."""
    last = rows.shape[1] - 1
    value, slope = rows[row, last], 0.0
    for k in range(last - 1, -1, -1):
        slope = slope * t + value
        value = value * t + rows[row, k]
    return value, slope


@kernel
def _largest(series, row, scales):
    """Return the largest magnitude in a row of the series, each column times its scale."""
    most = 0.0
    for j in range(scales.size):
        most = max(most, abs(series[row, j] * scales[j]))
    return most


@kernel
def step_size(motion):
    """Return the step [s] whose local error meets the tolerance.

    The last two orders of the accelerations' series are held to 3 % of atol + rtol |state|,
    each scaled by b and wn (b / rb for angles); velocities and positions are then better still.
    (Jorba and Zou, 2005, section 3.2.)
    """
    p, series = motion.constants, motion.series
    scales = p.scales
    size = max(_largest(series, 0, scales), _largest(series, 1, scales) / p.wn)
    tolerance = 0.03 * (p.atol * p.b + p.rtol * size) * p.wn**2
    last = (ROWS - 1) * (ROWS - 2) * _largest(series, ROWS - 1, scales)
    before = (ROWS - 2) * (ROWS - 3) * _largest(series, ROWS - 2, scales)
    by_last, by_before = rough_log2(tolerance / last), rough_log2(tolerance / before)
    return 2.0 ** min(by_last / (ROWS - 3), by_before / (ROWS - 4))
