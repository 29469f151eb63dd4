"""Taylor series of the motion about one instant, by recurrence; the heart of the integrator.

Between events the equations of docs/model.md are linear, with coefficients that are polynomials in
time, so every order of the series follows from the orders before it in a few operations. The series
is its own dense output. (Taylor methods: Jorba and Zou, 2005.)
"""

from __future__ import annotations

import math

import numpy as np

from gear_dynamics.model.kernel import kernel
from gear_dynamics.model.lanes import columns_at
from gear_dynamics.model.layout import (
    DELTA,
    ORDER,
    PSI,
    Q_SUM,
    ROWS,
    SEG_FORCE,
    SEG_FRICTION,
    SEG_MOMENT,
    WIDTH,
    X1,
    X2,
    Y1,
    Y2,
    Q,
)

_INVERSE = 1.0 / np.arange(1, ORDER + 3)


@kernel
def transmission_error(p, phase, speed, accel, e):
    """Fill row 0 of `e` with the series of e(phi) while the pinion turns at speed + accel t."""
    angle = 2 * math.pi * phase + p.phi0
    rate, ramp = p.z1 * speed, p.z1 * accel
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
def _higher_orders(segment, row, k, series):
    """Return what the segment's orders above 0 add to order k of a force or moment."""
    total = segment[row + 2, k] if 0 < k < WIDTH else 0.0
    for j in range(1, min(k, WIDTH - 1) + 1):
        total += segment[row, j] * series[k - j, DELTA]
        total += segment[row + 1, j] * (k - j + 1) * series[k - j + 1, DELTA]
    return total


@kernel
def expand(p, y, e, segment, degree, travel, travel_rate, load, load_rate, series):
    """Fill `series` with the Taylor series of the motion from state `y`.

    Parameters
    ----------
    p : record of CONSTANTS
    y : (STATES,) array
    e : (n, ROWS) array
        Row 0: series of the transmission error; zero for a variation of the motion.
    segment : (SEGMENT, WIDTH) array
        Polynomials in time of the mesh; only order 0 is used if `degree` is 0.
    degree : int
    travel, travel_rate : float
        The arms grow by travel t + travel_rate t^2 [m].
    load, load_rate : float
        Load side torque T2 + I2 Theta2'' at the beginning [N m] and its rate [N m/s].
    series : (ROWS, COLUMNS) array
        Overwritten.
    """
    # Everything from records and arrays is read into locals once: a store into `series` might
    # otherwise be taken to change it.
    inv_m1, inv_m2, inv_me, inv_it = p.inv_m1, p.inv_m2, p.inv_me, p.inv_it
    c1, k1, c2, k2 = p.c1_m, p.k1_m, p.c2_m, p.k2_m
    psi_1, psi_2 = p.psi_1, p.psi_2
    arm_sum, ratio = p.arm_sum, p.ratio
    kd, cd, ki = p.kd, p.cd, p.ki
    drive, rubs = p.drive != 0, p.mu > 0
    force_k, force_c, force_o = segment[0, 0], segment[1, 0], segment[2, 0]
    rub_k, rub_c, rub_o = segment[3, 0], segment[4, 0], segment[5, 0]
    turn_k, turn_c, turn_o = segment[6, 0], segment[7, 0], segment[8, 0]
    # x1 is order k of the position, x1n order k + 1.
    x1, y1, x2, y2, psi, q = y[0], y[1], y[2], y[3], y[4], y[5]
    x1n, y1n, x2n, y2n, psin, qn = y[6], y[7], y[8], y[9], y[10], y[11]
    q_sum = y[12]
    delta, delta_n = y2 - y1 + psi - e[0, 0], y2n - y1n + psin - e[0, 1]
    # delta'' = lead_k delta + lead_c delta' + lead_o + what does not depend on the orders of delta
    # just found: a chain of few operations from one order to the next.
    lightness, net = inv_m1 + inv_m2 + inv_me, psi_1 - psi_2
    lead_k = net * turn_k + psi_2 * arm_sum * rub_k - lightness * force_k
    lead_c = net * turn_c + psi_2 * arm_sum * rub_c - lightness * force_c
    lead_o = net * turn_o + psi_2 * arm_sum * rub_o - lightness * force_o
    load_k, load_next = load / p.rb2, load_rate / p.rb2
    friction = friction_1 = friction_2 = torque1 = torque2 = control = a_q = 0.0
    for k in range(ROWS - 1):
        order = k + 1.0
        inverse = _INVERSE[k]
        delta_dot = order * delta_n
        series[k, X1], series[k, Y1], series[k, X2], series[k, Y2] = x1, y1, x2, y2
        series[k, PSI], series[k, Q], series[k, DELTA] = psi, q, delta
        series[k, Q_SUM] = q_sum
        support1, support2 = c1 * order * y1n + k1 * y1, c2 * order * y2n + k2 * y2
        rest = support1 - support2 + load_k * inv_me + lead_o
        force = force_k * delta + force_c * delta_dot + force_o
        if degree > 0:
            series[k + 1, DELTA] = delta_n
            force += _higher_orders(segment, SEG_FORCE, k, series)
        if rubs:
            friction = rub_k * delta + rub_c * delta_dot + rub_o
            torque1 = turn_k * delta + turn_c * delta_dot + turn_o
            if degree > 0:
                friction += _higher_orders(segment, SEG_FRICTION, k, series)
                torque1 += _higher_orders(segment, SEG_MOMENT, k, series)
            moved = travel * friction_1 + travel_rate * friction_2
            torque1 += moved
            rest += net * moved
            torque2 = arm_sum * friction - torque1
            friction_2, friction_1 = friction_1, friction
        if drive:
            control = kd * q + cd * order * qn + ki * q_sum
            a_q = (torque1 - ratio * torque2 - control) * inv_it
            rest -= psi_1 * control
            q_sum = q * inverse
        a_psi = (load_k - force) * inv_me + psi_1 * (torque1 - control) + psi_2 * torque2
        twice = inverse * _INVERSE[k + 1]
        x1, x1n = x1n, (friction * inv_m1 - c1 * order * x1n - k1 * x1) * twice
        y1, y1n = y1n, (force * inv_m1 - support1) * twice
        x2, x2n = x2n, (-friction * inv_m2 - c2 * order * x2n - k2 * x2) * twice
        y2, y2n = y2n, (-force * inv_m2 - support2) * twice
        psi, psin = psin, a_psi * twice
        q, qn = qn, a_q * twice
        following = twice * (lead_k * delta + lead_c * delta_dot + rest)
        if degree > 0:
            following = y2n - y1n + psin
        delta, delta_n = delta_n, following - e[0, min(k + 2, ROWS - 1)]
        load_k, load_next = load_next, 0.0
        force_o = rub_o = turn_o = lead_o = 0.0
    k = ROWS - 1
    series[k, X1], series[k, Y1], series[k, X2], series[k, Y2] = x1, y1, x2, y2
    series[k, PSI], series[k, Q], series[k, DELTA] = psi, q, delta
    series[k, Q_SUM] = q_sum


@kernel
def advance_state(series, t, y, point):
    """Replace the state y at the beginning of the series by that at time t."""
    columns_at(series, t, point)
    for j in range(6):
        y[j], y[6 + j] = point[0, j], point[1, j]
    y[12] = point[0, Q_SUM]


@kernel
def value_and_slope(series, column, t):
    """Return a column of the series and its derivative at t."""
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
def step_size(p, series, y):
    """Return the step [s] whose local error meets the tolerance.

    The last two orders of the accelerations' series are held to a tenth of atol + rtol |state|,
    each scaled by b and wn (b / rb for angles); velocities and positions are then better still.
    (Jorba and Zou, 2005, section 3.2.)
    """
    size = last = before = 0.0
    turn = p.rb1
    inv_wn = 1 / p.wn
    for j in range(6):
        scale = 1.0 if j < 5 else turn
        size = max(size, scale * abs(y[j]), scale * inv_wn * abs(y[6 + j]))
        last = max(last, scale * abs(series[ROWS - 1, j]))
        before = max(before, scale * abs(series[ROWS - 2, j]))
    tolerance = 0.1 * (p.atol * p.b + p.rtol * size) * p.wn**2
    step = math.inf
    if last > 0:
        ratio = tolerance / ((ROWS - 1) * (ROWS - 2) * last)
        step = ratio ** (1.0 / (ROWS - 3))
    weighed = (ROWS - 2) * (ROWS - 3) * before
    if weighed > 0 and (step == math.inf or weighed * step ** (ROWS - 4) > tolerance):
        step = (tolerance / weighed) ** (1.0 / (ROWS - 4))
    return step
