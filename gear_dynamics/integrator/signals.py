"""The terms of ports that add to signals, as Taylor series over the present step."""

from __future__ import annotations

import math

import numpy as np

from gear_dynamics.integrator.kernel import kernel
from gear_dynamics.integrator.layout import (
    COLUMNS,
    DRIVE_SIGNAL,
    LOAD_SIGNAL,
    LONGEST_STEP,
    MOST_RADIANS,
    ORDER,
    PUSH,
    REST,
    ROWS,
    SUPPORT_C,
    SUPPORT_K,
    SUPPORTED,
    SUPPORTS_CHANGE,
)
from gear_dynamics.integrator.polynomial import (
    add_product,
    add_scaled,
    compose,
    copy_rows,
    differentiate,
)
from gear_dynamics.integrator.tables import unpack

_INVERSE = 1.0 / np.arange(1, ORDER + 3)

_NEGLIGIBLE = 1e-19
"""Of a sine's amplitude: smaller terms of its series end it."""


@kernel
def longest_step(p):
    """Return the longest step that a motion may take [s]."""
    return min(LONGEST_STEP, MOST_RADIANS / p.fastest)


@kernel
def elapsed(motion):
    """Return the time since the start of the run where the step begins [s]."""
    sampling = motion.sampling
    return sampling.origin / sampling.sample_rate + motion.step.begin


@kernel
def strength(motion, ramp):
    """Return the strength of a group of terms where the step begins, and its rate [1/s]."""
    if ramp.rate == 0.0 or motion.commands.ports_reached == math.inf:
        return ramp.target, 0.0
    return ramp.value + ramp.rate * (elapsed(motion) - ramp.begin), ramp.rate


@kernel
def _wave_angle(motion, wave):
    """Return a sine's angle [rad], its rate and half its acceleration, where the step begins."""
    phase, commands, turn = motion.phase, motion.commands, 2 * math.pi
    if wave.teeth == 0:
        turns = wave.order * elapsed(motion)
        return turn * (turns - math.floor(turns)) + wave.phase, turn * wave.order, 0.0
    # Revolutions and the rest apart, so that an integer order keeps its precision.
    # The quotient of whole numbers below 2^53, in floating point: its floor is exact.
    whole = math.floor(phase.cycle / wave.teeth)
    tooth = phase.cycle - wave.teeth * whole
    turns = wave.order * whole
    turns = turns - math.floor(turns) + wave.order * (tooth + phase.phase) / wave.teeth
    rate = wave.order * motion.constants.z1 / wave.teeth
    return turn * turns + wave.phase, rate * commands.speed, 0.5 * rate * commands.accel


@kernel
def _add_wave(motion, wave, ramp):
    """Add a sine to its signal: a recurrence as in `series.expand_error`, cut where it is done."""
    out, degrees, scratch = motion.signals[wave.signal], motion.degrees, motion.scratch[0]
    factor, slope = strength(motion, ramp)
    if factor == 0.0 and slope == 0.0:
        return
    angle, rate, half_ramp = _wave_angle(motion, wave)
    # The series is used up to the end of the step, a few periods of the fastest mode at most.
    reach = (abs(rate) + math.sqrt(abs(half_ramp))) * longest_step(motion.constants)
    sine, cosine = math.sin(angle), math.cos(angle)
    sine_before = cosine_before = 0.0
    power, last = 1.0, ROWS - 1 if reach > 0.0 else 0
    for k in range(last + 1):
        scratch[k] = sine
        factor_rate = rate * _INVERSE[k]
        sine_next, cosine_next = factor_rate * cosine, factor_rate * sine
        if half_ramp != 0.0:
            factor_ramp = 2 * half_ramp * _INVERSE[k]
            sine_next += factor_ramp * cosine_before
            cosine_next += factor_ramp * sine_before
            sine_before, cosine_before = sine, cosine
        sine, cosine = sine_next, -cosine_next
        power *= reach * _INVERSE[k]
        if power < _NEGLIGIBLE and k >= wave.derivative + 3:
            last = k
            break
    for _ in range(wave.derivative):
        last = differentiate(scratch, last, scratch)
    factor, slope = factor * wave.amplitude, slope * wave.amplitude
    degrees[wave.signal] = add_scaled(out, degrees[wave.signal], scratch, last, factor, slope, ROWS)


@kernel
def _add_curve(motion, curve, pieces, ramp):
    """Add the present piece of a piecewise polynomial to its signal."""
    out, degrees, scratch = motion.signals[curve.signal], motion.degrees, motion.scratch[0]
    piece = pieces[curve.first + curve.piece]
    factor, slope = strength(motion, ramp)
    empty = True
    for j in range(piece.coefficients.size):
        empty = empty and piece.coefficients[j] == 0.0
    if empty or (factor == 0.0 and slope == 0.0):
        return
    by_length = 1.0 / (piece.end - piece.begin)
    if curve.timed:
        at, rate, half_ramp = elapsed(motion) - curve.lap * curve.period, 1.0, 0.0
    else:
        at = (motion.phase.cycle - curve.lap * curve.period) + motion.phase.phase
        turn = motion.constants.z1 / (2 * math.pi)
        rate, half_ramp = turn * motion.commands.speed, 0.5 * turn * motion.commands.accel
    degree = compose(
        piece.coefficients,
        (at - piece.begin) * by_length,
        rate * by_length,
        half_ramp * by_length,
        scratch,
    )
    degrees[curve.signal] = add_scaled(
        out, degrees[curve.signal], scratch, degree, factor, slope, ROWS
    )


@kernel
def fill_signals(motion, ports):
    """Fill the series of all signals that are used, and the accelerations that they give."""
    tables, degrees = unpack(ports), motion.degrees
    degrees[:] = -1
    motion.step.pushed = 0
    if tables.waves.size == 0 and tables.curves.size == 0:
        return
    for i in range(tables.waves.size):
        wave = tables.waves[i]
        _add_wave(motion, wave, tables.ramps[wave.ramp])
    for i in range(tables.curves.size):
        curve = tables.curves[i]
        _add_curve(motion, curve, tables.curve_pieces, tables.ramps[curve.ramp])
    motion.step.pushed = _fill_push(motion)


@kernel
def _add_to_column(motion, column, terms, degree, factor):
    """Add factor times a polynomial to an acceleration."""
    push, step = motion.push, motion.step
    # Rows beyond the degree have what an earlier step left there.
    for k in range(step.push_degree + 1, degree + 1):
        for c in range(COLUMNS):
            push[k, c] = 0.0
    step.push_degree = max(step.push_degree, degree)
    for k in range(degree + 1):
        push[k, column] += factor * terms[k]


@kernel
def _fill_push(motion):
    """Fill the accelerations by rest points, forces and torques.

    Return whether there are any, and SUPPORTS_CHANGE if supports change.
    """
    p, degrees, signals = motion.constants, motion.degrees, motion.signals
    pushed = False
    for row in range(REST, LOAD_SIGNAL + 1):
        pushed = pushed or degrees[row] >= 0
    supported = False
    for row in range(SUPPORT_K, SUPPORT_C + 2):
        supported = supported or degrees[row] >= 0
    if not pushed and not supported:
        return 0
    motion.step.push_degree = -1
    if supported:
        copy_rows(signals, SUPPORT_K, motion.supports)
    for column in range(SUPPORTED):
        wheel = column // 2
        mass = p.m1 if wheel == 0 else p.m2
        if degrees[REST + column] >= 0:
            _push_by_support(motion, column, wheel, mass)
        row = PUSH + column
        _add_to_column(motion, column, signals[row], degrees[row], 1.0 / mass)
    for side in range(2):
        row = DRIVE_SIGNAL if side == 0 else LOAD_SIGNAL
        for column in range(COLUMNS):
            if degrees[row] >= 0 and p.torques[side, column] != 0.0:
                torque = p.torques[side, column]
                _add_to_column(motion, column, signals[row], degrees[row], torque)
    return SUPPORTS_CHANGE if supported else 1


@kernel
def _push_by_support(motion, column, wheel, mass):
    """Add the acceleration by a support's rest point r: (k r + c r') / m."""
    p, degrees, signals, scratch = motion.constants, motion.degrees, motion.signals, motion.scratch
    rest, degree = signals[REST + column], degrees[REST + column]
    rate = scratch[0]
    rate_degree = differentiate(rest, degree, rate)
    k, c = (p.k1, p.c1) if wheel == 0 else (p.k2, p.c2)
    total = scratch[1]
    last = add_scaled(total, -1, rest, degree, k, 0.0, ROWS)
    last = add_scaled(total, last, rate, rate_degree, c, 0.0, ROWS)
    k_row, c_row = SUPPORT_K + wheel, SUPPORT_C + wheel
    last = add_product(total, last, rest, degree, signals[k_row], degrees[k_row], 1.0, ROWS)
    last = add_product(total, last, rate, rate_degree, signals[c_row], degrees[c_row], 1.0, ROWS)
    _add_to_column(motion, column, total, last, 1.0 / mass)


@kernel
def next_knot(motion, curve, pieces):
    """Return where the present piece of a curve ends: mesh cycles of the present one, or time."""
    end = pieces[curve.first + curve.piece].end
    if curve.timed:
        return end + curve.lap * curve.period
    return end - (motion.phase.cycle - curve.lap * curve.period)


@kernel
def pass_knot(curve):
    """Go on to the next piece of a curve."""
    curve.piece += 1
    if curve.piece == curve.count:
        curve.piece = 0
        curve.lap += 1
