"""Samples off the dense output: forces and accelerations from the equations, not differences."""

from __future__ import annotations

import math

import numba

from gear_dynamics.model.lanes import columns_at_four
from gear_dynamics.model.layout import (
    ANGLE1,
    ANGLE2,
    AX1,
    AX2,
    AY1,
    AY2,
    DELTA,
    FORCE,
    FRICTION,
    LOAD,
    PSI,
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


@numba.njit(cache=True)
def time_of_sample(clock, sample):
    """Return the instant of a sample [s since origin]."""
    return (sample - clock.origin) / clock.sample_rate


@numba.njit(cache=True)
def _operate(segment, row, degree, t, delta, delta_dot):
    """Return  stiffness(t) delta + damping(t) delta' + offset(t)  of the segment's rows."""
    if degree == 0:
        return segment[row, 0] * delta + segment[row + 1, 0] * delta_dot + segment[row + 2, 0]
    stiffness = damping = offset = 0.0
    for j in range(WIDTH - 1, -1, -1):
        stiffness = stiffness * t + segment[row, j]
        damping = damping * t + segment[row + 1, j]
        offset = offset * t + segment[row + 2, j]
    return stiffness * delta + damping * delta_dot + offset


@numba.njit(cache=True)
def _within_turn(angle):
    """Return an angle in [0, 2 pi); it is at most a turn off."""
    if angle < 0:
        angle += TURN
    return angle - TURN if angle >= TURN else angle


@numba.njit(cache=True)
def write_samples(p, clock, series, segment, point, angles_every, out):
    """Write the next one to four samples, all within the present step, to the rows of `out`."""
    inv_m1, inv_m2 = 1 / p.m1, 1 / p.m2
    c1, k1, c2, k2 = p.c1 * inv_m1, p.k1 * inv_m1, p.c2 * inv_m2, p.k2 * inv_m2
    th1_psi = p.ratio * p.inertia2 / (p.rb2 * p.inertia_t)
    th2_psi = p.inertia1 / (p.rb2 * p.inertia_t)
    # A sample's time must not depend on which samples are written together with it.
    t0 = time_of_sample(clock, clock.sample) - clock.begin
    t1 = time_of_sample(clock, clock.sample + 1) - clock.begin
    t2 = time_of_sample(clock, clock.sample + 2) - clock.begin
    t3 = time_of_sample(clock, clock.sample + 3) - clock.begin
    columns_at_four(series, t0, t1, t2, t3, point)
    for i in range(out.shape[0]):
        tau = time_of_sample(clock, clock.sample + i) - clock.begin
        value, slope = point[2 * i], point[2 * i + 1]
        delta, delta_dot = value[DELTA], slope[DELTA]
        force = _operate(segment, SEG_FORCE, clock.degree, tau, delta, delta_dot)
        friction = 0.0
        if p.mu > 0:
            friction = _operate(segment, SEG_FRICTION, clock.degree, tau, delta, delta_dot)
        row = out[i]
        row[T] = (clock.sample + i) / clock.sample_rate
        row[AX1] = friction * inv_m1 - c1 * slope[X1] - k1 * value[X1]
        row[AY1] = force * inv_m1 - c1 * slope[Y1] - k1 * value[Y1]
        row[AX2] = -friction * inv_m2 - c2 * slope[X2] - k2 * value[X2]
        row[AY2] = -force * inv_m2 - c2 * slope[Y2] - k2 * value[Y2]
        row[FORCE], row[FRICTION] = force, friction
        row[SAMPLE_DELTA], row[SAMPLE_DELTA_DOT] = delta, delta_dot
        row[SPEED] = clock.speed + clock.accel * tau + slope[Q] + th1_psi * slope[PSI]
        row[LOAD] = clock.torque + clock.torque_rate * tau
        if (clock.sample + i) % angles_every == 0:
            th1 = value[Q] + th1_psi * value[PSI]
            th2 = p.ratio * value[Q] - th2_psi * value[PSI]
            phase = clock.phase + p.z1 / TURN * tau * (clock.speed + 0.5 * clock.accel * tau)
            row[ANGLE1] = _within_turn(TURN * (clock.cycle % p.z1 + phase) / p.z1 + th1)
            row[ANGLE2] = _within_turn(TURN * (clock.cycle % p.z2 + phase) / p.z2 + th2)
