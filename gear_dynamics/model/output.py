"""Samples off the dense output: forces and accelerations from the equations, not differences."""

from __future__ import annotations

import math

import numba

from gear_dynamics.model.series import (
    DELTA,
    PSI,
    SEG_FORCE,
    SEG_FRICTION,
    WIDTH,
    X1,
    X2,
    Y1,
    Y2,
    Q,
    evaluate,
)


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
def write_sample(p, clock, series, segment, point, tau, row):
    """Write the sample (SAMPLES) at `tau` seconds into the present step to `row`."""
    value, slope = point[0], point[1]
    evaluate(series, tau, value, slope)
    delta, delta_dot = value[DELTA], slope[DELTA]
    force = _operate(segment, SEG_FORCE, clock.degree, tau, delta, delta_dot)
    friction = 0.0
    if p.mu > 0:
        friction = _operate(segment, SEG_FRICTION, clock.degree, tau, delta, delta_dot)
    row.t = clock.sample / clock.sample_rate
    row.pinion_ax = (friction - p.c1 * slope[X1] - p.k1 * value[X1]) / p.m1
    row.pinion_ay = (force - p.c1 * slope[Y1] - p.k1 * value[Y1]) / p.m1
    row.gear_ax = (-friction - p.c2 * slope[X2] - p.k2 * value[X2]) / p.m2
    row.gear_ay = (-force - p.c2 * slope[Y2] - p.k2 * value[Y2]) / p.m2
    row.mesh_force, row.friction_force = force, friction
    row.delta, row.delta_dot = delta, delta_dot
    turn = 2 * math.pi
    th1_psi = p.ratio * p.inertia2 / (p.rb2 * p.inertia_t)
    th2_psi = p.inertia1 / (p.rb2 * p.inertia_t)
    th1 = value[Q] + th1_psi * value[PSI]
    th2 = p.ratio * value[Q] - th2_psi * value[PSI]
    phase = clock.phase + p.z1 / turn * tau * (clock.speed + 0.5 * clock.accel * tau)
    row.pinion_angle = (turn * (clock.cycle % p.z1 + phase) / p.z1 + th1) % turn
    row.gear_angle = (turn * (clock.cycle % p.z2 + phase) / p.z2 + th2) % turn
    row.speed = clock.speed + clock.accel * tau + slope[Q] + th1_psi * slope[PSI]
    row.load_torque = clock.torque + clock.torque_rate * tau
