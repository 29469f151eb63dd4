"""The jumps of forces and accelerations at events, in closed form.

Where a tooth pair enters, leaves, passes the pitch point, or changes its contact, position and
velocity go on, while force and acceleration jump, and so do their derivatives.
`integrator.band_limit` takes these jumps out of the samples and puts them in again band-limited.
"""

from __future__ import annotations

from gear_dynamics.integrator.kernel import kernel
from gear_dynamics.integrator.layout import (
    AX1,
    AX2,
    AY1,
    AY2,
    DAMPING,
    DELTA,
    FORCE,
    FRICTION,
    PSI,
    ROWS,
    SAMPLE_DELTA,
    SAMPLE_DELTA_DOT,
    SEG_FORCE,
    SEG_FRICTION,
    SEG_MOMENT,
    SPEED,
    STIFFNESS,
    TO_FORCE,
    TO_FRICTION,
    TO_MOMENT,
    X1,
    X2,
    Y1,
    Y2,
    Q,
    T,
)
from gear_dynamics.integrator.output import operate
from gear_dynamics.integrator.series import value_and_slope

VALUE, SLOPE, CURVATURE = range(3)
ROWS_OF_JUMP = 3
"""Rows of a jump: of the columns of a sample, of their slopes [1/s] and curvatures [1/s2]. Column T
of the first holds its instant, in samples of the integrator since the start of the run, and of the
second the first sample after it: rounding could put a sample at the instant to either side."""


@kernel
def _higher_slopes(motion, column, t):
    """Return the second and the third derivative of a column of the series at t."""
    series = motion.series
    value, first, second, third = series[ROWS - 1, column], 0.0, 0.0, 0.0
    for k in range(ROWS - 2, -1, -1):
        third = third * t + second
        second = second * t + first
        first = first * t + value
        value = value * t + series[k, column]
    return 2 * second, 6 * third


@kernel
def _derivatives(segment, row, degree, t, motions, out):
    """Fill `out` with a force of the segment at t and its first two derivatives.

    motions : delta and its first three derivatives
    """
    delta, first, second, third = motions
    out[0] = operate(segment, row, degree, t, delta, first)
    k = c = o = k_1 = c_1 = o_1 = k_2 = c_2 = o_2 = 0.0
    for j in range(degree, -1, -1):
        k_2, c_2, o_2 = k_2 * t + k_1, c_2 * t + c_1, o_2 * t + o_1
        k_1, c_1, o_1 = k_1 * t + k, c_1 * t + c, o_1 * t + o
        k, c, o = k * t + segment[row, j], c * t + segment[row + 1, j], o * t + segment[row + 2, j]
    out[1] = k * first + c * second
    out[2] = k * second + c * third
    if degree > 0:
        out[1] += k_1 * delta + c_1 * first + o_1
        out[2] += 2 * (k_1 * first + c_1 * second) + 2 * (k_2 * delta + c_2 * first + o_2)


@kernel
def note_before(motion):
    """Note the forces at the end of the present step, which is a mesh or contact event."""
    before, segment = motion.before, motion.segment
    t, degree = motion.step.length, motion.step.degree
    delta, slope = value_and_slope(motion, DELTA, t)
    before.curvature, before.third = _higher_slopes(motion, DELTA, t)
    motions = (delta, slope, before.curvature, before.third)
    _derivatives(segment, SEG_FORCE, degree, t, motions, before.force)
    _derivatives(segment, SEG_FRICTION, degree, t, motions, before.friction)
    travelled = motion.step.travel * t * before.friction[0]
    before.torque1 = operate(segment, SEG_MOMENT, degree, t, delta, slope) + travelled
    before.jumped = 1


@kernel
def _jump_of(motion, row, before, out):
    """Fill `out` with the jump of a force and of its first two derivatives."""
    s = motion.series
    motions = (s[0, DELTA], s[1, DELTA], 2 * s[2, DELTA], 6 * s[3, DELTA])
    _derivatives(motion.segment, row, motion.step.degree, 0.0, motions, out)
    for j in range(3):
        out[j] -= before[j]


@kernel
def _fill_column(jump, column, force, factor, damping, stiffness):
    """Write the jump of an acceleration  factor force - damping x' - stiffness x."""
    jump[VALUE, column] = force[0] * factor
    jump[SLOPE, column] = force[1] * factor - damping * jump[VALUE, column]
    jump[CURVATURE, column] = (
        force[2] * factor - damping * jump[SLOPE, column] - stiffness * jump[VALUE, column]
    )


@kernel
def note_jump(motion, jumps):
    """Write the jump between `note_before` and the beginning of the present step to `jumps`."""
    p, before, series = motion.constants, motion.before, motion.series
    answers = p.answers
    before.jumped = 0
    force, friction = motion.scratch[0], motion.scratch[1]
    _jump_of(motion, SEG_FORCE, before.force, force)
    _jump_of(motion, SEG_FRICTION, before.friction, friction)
    torque1 = operate(
        motion.segment, SEG_MOMENT, motion.step.degree, 0.0, series[0, DELTA], series[1, DELTA]
    )
    torque1 -= before.torque1

    jump = jumps[motion.counts.jumps]
    jump[:] = 0.0
    jump[VALUE, T] = motion.sampling.origin + motion.step.begin * motion.sampling.sample_rate
    jump[SLOPE, T] = motion.sampling.sample
    _fill_column(jump, FORCE, force, 1.0, 0.0, 0.0)
    _fill_column(jump, FRICTION, friction, 1.0, 0.0, 0.0)
    for column, to, source, out in (
        (X1, TO_FRICTION, friction, AX1),
        (X2, TO_FRICTION, friction, AX2),
        (Y1, TO_FORCE, force, AY1),
        (Y2, TO_FORCE, force, AY2),
    ):
        damping, stiffness = -answers[DAMPING, column], -answers[STIFFNESS, column]
        _fill_column(jump, out, source, answers[to, column], damping, stiffness)
    jump[SLOPE, SAMPLE_DELTA_DOT] = 2 * series[2, DELTA] - before.curvature
    jump[CURVATURE, SAMPLE_DELTA_DOT] = 6 * series[3, DELTA] - before.third
    jump[CURVATURE, SAMPLE_DELTA] = 2 * series[2, DELTA] - before.curvature
    for column, factor in ((PSI, p.th1_psi), (Q, 1.0)):
        jump[SLOPE, SPEED] += factor * (
            answers[TO_FORCE, column] * force[0]
            + answers[TO_FRICTION, column] * friction[0]
            + answers[TO_MOMENT, column] * torque1
        )
    motion.counts.jumps += 1
