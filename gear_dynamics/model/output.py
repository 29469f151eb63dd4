"""Samples off the dense output: forces and accelerations from the equations, not differences."""

from __future__ import annotations

import math

from gear_dynamics.model.kernel import kernel
from gear_dynamics.model.lanes import columns_at_four
from gear_dynamics.model.layout import (
    ANGLE1,
    ANGLE2,
    AX1,
    AX2,
    AY1,
    AY2,
    DELTA,
    DRIVE_TORQUE,
    FORCE,
    FRICTION,
    GEAR_SPEED,
    LOAD,
    PSI,
    Q_SUM,
    SAMPLE_DELTA,
    SAMPLE_DELTA_DOT,
    SEG_FORCE,
    SEG_FRICTION,
    SPEED,
    WIDTH,
    X1,
    X2,
    Y1,
    Y2,
    Q,
    T,
)

TURN = 2 * math.pi


@kernel
def time_of_sample(clock, sample):
    """Return the instant of a sample [s since origin]."""
    return (sample - clock.origin) / clock.sample_rate


@kernel
def operate(segment, row, degree, t, delta, delta_dot):
    """Return  stiffness(t) delta + damping(t) delta' + offset(t)  of the segment's rows."""
    if degree == 0:
        return segment[row, 0] * delta + segment[row + 1, 0] * delta_dot + segment[row + 2, 0]
    stiffness = damping = offset = 0.0
    for j in range(WIDTH - 1, -1, -1):
        stiffness = stiffness * t + segment[row, j]
        damping = damping * t + segment[row + 1, j]
        offset = offset * t + segment[row + 2, j]
    return stiffness * delta + damping * delta_dot + offset


@kernel
def _within_turn(angle):
    """Return an angle in [0, 2 pi); it is at most a turn off."""
    if angle < 0:
        angle += TURN
    return angle - TURN if angle >= TURN else angle


@kernel
def write_samples(p, clock, series, segment, point, whole_every, out, first, count):
    """Write the next one to four samples, all within the present step, to rows of `out`.

    Time, angles, load torque and, where `out` has room for it, what the shafts do besides are
    written of every `whole_every`-th sample, a power of two.
    """
    # A sample's time must not depend on which samples are written together with it.
    begin, sample = clock.begin, clock.sample
    t0 = time_of_sample(clock, sample) - begin
    t1 = time_of_sample(clock, sample + 1) - begin
    t2 = time_of_sample(clock, sample + 2) - begin
    t3 = time_of_sample(clock, sample + 3) - begin
    columns_at_four(series, t0, t1, t2, t3, point)
    # Into locals, since a store into `out` might otherwise be taken to change them.
    inv_m1, inv_m2, ratio = p.inv_m1, p.inv_m2, p.ratio
    c1, k1, c2, k2 = p.c1_m, p.k1_m, p.c2_m, p.k2_m
    th1_psi, th2_psi = p.th1_psi, p.th2_psi
    speed, accel, torque, torque_rate = clock.speed, clock.accel, clock.torque, clock.torque_rate
    wide, inertia_t = out.shape[1] > DRIVE_TORQUE, p.inertia_t
    kd, cd, ki = (p.kd, p.cd, p.ki) if p.drive else (0.0, 0.0, 0.0)
    degree, rubs, rate = clock.degree, p.mu > 0, clock.sample_rate
    tooth1, tooth2 = clock.cycle % int(p.z1), clock.cycle % int(p.z2)
    phase, per_turn = clock.phase, p.z1 / TURN
    angle1, angle2 = TURN / p.z1, TURN / p.z2
    force_k, force_c, force_o = segment[0, 0], segment[1, 0], segment[2, 0]
    rub_k, rub_c, rub_o = segment[3, 0], segment[4, 0], segment[5, 0]
    for i in range(count):
        tau = t0 if i == 0 else t1 if i == 1 else t2 if i == 2 else t3
        value, slope, row = 2 * i, 2 * i + 1, first + i
        delta, delta_dot = point[value, DELTA], point[slope, DELTA]
        psi, q = point[value, PSI], point[value, Q]
        if degree == 0:
            force = force_k * delta + force_c * delta_dot + force_o
            friction = rub_k * delta + rub_c * delta_dot + rub_o if rubs else 0.0
        else:
            force = operate(segment, SEG_FORCE, degree, tau, delta, delta_dot)
            friction = operate(segment, SEG_FRICTION, degree, tau, delta, delta_dot)
        a_x1 = friction * inv_m1 - c1 * point[slope, X1] - k1 * point[value, X1]
        a_y1 = force * inv_m1 - c1 * point[slope, Y1] - k1 * point[value, Y1]
        a_x2 = -friction * inv_m2 - c2 * point[slope, X2] - k2 * point[value, X2]
        a_y2 = -force * inv_m2 - c2 * point[slope, Y2] - k2 * point[value, Y2]
        spin = point[slope, Q] + th1_psi * point[slope, PSI]
        out[row, AX1], out[row, AY1], out[row, AX2], out[row, AY2] = a_x1, a_y1, a_x2, a_y2
        out[row, FORCE], out[row, FRICTION], out[row, SAMPLE_DELTA_DOT] = force, friction, delta_dot
        out[row, SAMPLE_DELTA] = delta
        out[row, SPEED] = speed + accel * tau + spin
        if (sample + i) & (whole_every - 1) == 0:
            now = phase + per_turn * tau * (speed + 0.5 * accel * tau)
            out[row, T] = (sample + i) / rate
            out[row, ANGLE1] = _within_turn(angle1 * (tooth1 + now) + q + th1_psi * psi)
            out[row, ANGLE2] = _within_turn(angle2 * (tooth2 + now) + ratio * q - th2_psi * psi)
            load = torque + torque_rate * tau
            out[row, LOAD] = load
            if wide:
                turning = speed + accel * tau + point[slope, Q]
                control = kd * q + cd * point[slope, Q] + ki * point[value, Q_SUM]
                out[row, GEAR_SPEED] = ratio * turning - th2_psi * point[slope, PSI]
                out[row, DRIVE_TORQUE] = ratio * load + inertia_t * accel - control
