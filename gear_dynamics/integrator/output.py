"""Samples off the dense output: forces and accelerations from the equations, not differences."""

from __future__ import annotations

import math

from gear_dynamics.integrator.kernel import kernel
from gear_dynamics.integrator.layout import (
    ANGLE1,
    ANGLE2,
    AX1,
    AX2,
    AY1,
    AY2,
    DELTA,
    DELTA_VALUE,
    DRIVE_SIGNAL,
    DRIVE_TORQUE,
    FORCE,
    FRICTION,
    GEAR_SPEED,
    LOAD,
    LOAD_SIGNAL,
    PSI,
    PSI_VALUE,
    Q_SUM_VALUE,
    Q_VALUE,
    SAMPLE_DELTA,
    SAMPLE_DELTA_DOT,
    SEG_FORCE,
    SEG_FRICTION,
    SPEED,
    X1,
    X2,
    Y1,
    Y2,
    Q,
    T,
)
from gear_dynamics.integrator.polynomials import fill_rates, fill_values
from gear_dynamics.integrator.vector import LANES

TURN = 2 * math.pi


@kernel
def time_of_sample(motion, sample):
    """Return the instant of a sample [s since origin]."""
    return (sample - motion.sampling.origin) / motion.sampling.sample_rate


@kernel
def operate(segment, row, degree, t, delta, delta_dot):
    """Return  stiffness(t) delta + damping(t) delta' + offset(t)  of the segment's rows."""
    if degree == 0:
        return segment[row, 0] * delta + segment[row + 1, 0] * delta_dot + segment[row + 2, 0]
    stiffness = damping = offset = 0.0
    for j in range(degree, -1, -1):
        stiffness = stiffness * t + segment[row, j]
        damping = damping * t + segment[row + 1, j]
        offset = offset * t + segment[row + 2, j]
    return stiffness * delta + damping * delta_dot + offset


@kernel
def _force_at(segment, row, stiffness_degree, degree, t, delta, delta_dot):
    """Return what `operate` does, where stiffness and damping may be constant."""
    if stiffness_degree > 0:
        return operate(segment, row, degree, t, delta, delta_dot)
    offset = 0.0
    for j in range(degree, -1, -1):
        offset = offset * t + segment[row + 2, j]
    return segment[row, 0] * delta + segment[row + 1, 0] * delta_dot + offset


@kernel
def _within_turn(angle):
    """Return an angle in [0, 2 pi)."""
    if angle < 0 or angle >= TURN:
        angle -= TURN * math.floor(angle / TURN)
    # What is negative by next to nothing has become a whole turn.
    return 0.0 if angle >= TURN else angle


@kernel
def write_due_samples(motion, whole_every, out, first):
    """Write the next samples, eight at most, that the present step spans, to rows of `out`.

    Time, angles, load torque and, where `out` has room for it, what the shafts do besides are
    written of every `whole_every`-th sample, a power of two. Return how many were written.
    """
    p, step, values = motion.constants, motion.step, motion.values
    count = _place_times(motion, out.shape[0] - first)
    if not step.rated:
        fill_rates(motion.series, motion.rates)
        step.rated = 1
    fill_values(motion.series, motion.rates, motion.times, values)
    # Into locals, since a store into `out` might otherwise be taken to change them.
    degree, segment, th1_psi = step.degree, motion.segment, p.th1_psi
    varying = step.stiffness_degree
    sample, speed, accel = motion.sampling.sample, motion.commands.speed, motion.commands.accel
    force_k, force_c, force_o = segment[0, 0], segment[1, 0], segment[2, 0]
    rub_k, rub_c, rub_o = segment[3, 0], segment[4, 0], segment[5, 0]
    for i in range(count):
        row, tau = first + i, motion.times[i]
        delta, delta_dot = values[DELTA_VALUE, i], values[DELTA, i]
        if degree == 0:
            force = force_k * delta + force_c * delta_dot + force_o
            friction = rub_k * delta + rub_c * delta_dot + rub_o
        else:
            force = _force_at(segment, SEG_FORCE, varying, degree, tau, delta, delta_dot)
            friction = _force_at(segment, SEG_FRICTION, varying, degree, tau, delta, delta_dot)
        out[row, AX1], out[row, AY1] = values[X1, i], values[Y1, i]
        out[row, AX2], out[row, AY2] = values[X2, i], values[Y2, i]
        out[row, FORCE], out[row, FRICTION] = force, friction
        out[row, SAMPLE_DELTA], out[row, SAMPLE_DELTA_DOT] = delta, delta_dot
        out[row, SPEED] = speed + accel * tau + values[Q, i] + th1_psi * values[PSI, i]
        if (sample + i) & (whole_every - 1) == 0:
            _write_shafts(motion, i, out, row)
    motion.sampling.sample += count
    return count


@kernel
def _place_times(motion, room):
    """Put the times [s] of the next eight samples into the step; return how many are in it."""
    times, begin, sample = motion.times, motion.step.begin, motion.sampling.sample
    end = begin + motion.step.length
    count = 0
    for i in range(LANES):
        instant = time_of_sample(motion, sample + i)
        count += instant < end
        times[i] = instant - begin
    return min(count, room)


@kernel
def _signal_at(motion, row, t):
    """Return the value of a signal at t [s] into the step."""
    value = 0.0
    for k in range(motion.degrees[row], -1, -1):
        value = value * t + motion.signals[row, k]
    return value


@kernel
def _write_shafts(motion, i, out, row):
    """Write time, angles, load torque and, where there is room, what the shafts do besides."""
    p, commands, phase = motion.constants, motion.commands, motion.phase
    values, tau = motion.values, motion.times[i]
    speed, accel = commands.speed, commands.accel
    psi, q, psi_dot, q_dot = values[PSI_VALUE, i], values[Q_VALUE, i], values[PSI, i], values[Q, i]
    now = phase.phase + tau / p.tooth1 * (speed + 0.5 * accel * tau)
    load = commands.torque + commands.torque_rate * tau
    out[row, T] = (motion.sampling.sample + i) / motion.sampling.sample_rate
    out[row, ANGLE1] = _within_turn(p.tooth1 * (phase.tooth1 + now) + q + p.th1_psi * psi)
    out[row, ANGLE2] = _within_turn(p.tooth2 * (phase.tooth2 + now) + p.ratio * q - p.th2_psi * psi)
    out[row, LOAD] = load
    if motion.degrees[LOAD_SIGNAL] >= 0:
        out[row, LOAD] += _signal_at(motion, LOAD_SIGNAL, tau)
    if out.shape[1] > DRIVE_TORQUE:
        turning = speed + accel * tau + q_dot
        control = p.kd * q + p.cd * q_dot + p.ki * values[Q_SUM_VALUE, i] if p.drive else 0.0
        out[row, GEAR_SPEED] = p.ratio * turning - p.th2_psi * psi_dot
        out[row, DRIVE_TORQUE] = p.ratio * load + p.inertia_t * accel - control
        out[row, DRIVE_TORQUE] += p.made_up * (load + p.inertia2 * p.ratio * accel)
        if motion.degrees[DRIVE_SIGNAL] >= 0:
            out[row, DRIVE_TORQUE] += _signal_at(motion, DRIVE_SIGNAL, tau)
