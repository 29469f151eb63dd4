"""The jumps of forces and accelerations at events, in closed form.

Where a tooth pair enters, leaves, passes the pitch point, or changes its contact, position and
velocity go on, while force and acceleration jump, and so do their derivatives. `model.band_limit`
takes these jumps out of the samples and puts them in again band-limited.
"""

from __future__ import annotations

from gear_dynamics.integrator.kernel import kernel
from gear_dynamics.integrator.layout import (
    AX1,
    AX2,
    AY1,
    AY2,
    DELTA,
    FORCE,
    FRICTION,
    ROWS,
    SAMPLE_DELTA,
    SAMPLE_DELTA_DOT,
    SEG_FORCE,
    SEG_FRICTION,
    SEG_MOMENT,
    SPEED,
    T,
)
from gear_dynamics.integrator.output import operate
from gear_dynamics.integrator.series import polynomial, value_and_slope

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
def note_before(motion):
    """Note the forces at the end of the present step, which is a mesh or contact event."""
    clock, segment = motion.clock, motion.segment
    t, degree = clock.length, clock.degree
    delta, slope = value_and_slope(motion, DELTA, t)
    clock.before_force = operate(segment, SEG_FORCE, degree, t, delta, slope)
    clock.before_friction = operate(segment, SEG_FRICTION, degree, t, delta, slope)
    travelled = clock.travel * t * clock.before_friction
    clock.before_torque1 = operate(segment, SEG_MOMENT, degree, t, delta, slope) + travelled
    clock.before_force_k = polynomial(segment, SEG_FORCE, t)[0]
    clock.before_force_c = polynomial(segment, SEG_FORCE + 1, t)[0]
    clock.before_friction_k = polynomial(segment, SEG_FRICTION, t)[0]
    clock.before_friction_c = polynomial(segment, SEG_FRICTION + 1, t)[0]
    clock.before_curvature, clock.before_third = _higher_slopes(motion, DELTA, t)
    clock.jumped = 1


@kernel
def _fill_column(jump, column, value, slope, curvature, inverse_mass, damping, stiffness):
    """Write the jump of an acceleration  inverse_mass force - damping x' - stiffness x."""
    jump[VALUE, column] = value * inverse_mass
    jump[SLOPE, column] = slope * inverse_mass - damping * jump[VALUE, column]
    jump[CURVATURE, column] = (
        curvature * inverse_mass - damping * jump[SLOPE, column] - stiffness * jump[VALUE, column]
    )


@kernel
def _slopes_of_jump(motion, row, k_before, c_before):
    """Return the jumps of a force's first and second derivative, of healthy pairs."""
    clock, series = motion.clock, motion.series
    k, c = motion.segment[row, 0], motion.segment[row + 1, 0]
    slope, curvature, third = series[1, DELTA], 2 * series[2, DELTA], 6 * series[3, DELTA]
    before_2, before_3 = clock.before_curvature, clock.before_third
    return (
        k * slope + c * curvature - k_before * slope - c_before * before_2,
        k * curvature + c * third - k_before * before_2 - c_before * before_3,
    )


@kernel
def note_jump(motion, jumps):
    """Write the jump between `note_before` and the beginning of the present step to `jumps`."""
    p, clock = motion.constants, motion.clock
    series, segment = motion.series, motion.segment
    clock.jumped = 0
    delta, slope, curvature = series[0, DELTA], series[1, DELTA], 2 * series[2, DELTA]
    force = operate(segment, SEG_FORCE, clock.degree, 0.0, delta, slope) - clock.before_force
    friction = operate(segment, SEG_FRICTION, clock.degree, 0.0, delta, slope)
    friction -= clock.before_friction
    torque1 = operate(segment, SEG_MOMENT, clock.degree, 0.0, delta, slope) - clock.before_torque1
    torque2 = p.arm_sum * friction - torque1
    a_psi = p.psi_1 * torque1 + p.psi_2 * torque2 - force * p.inv_me
    a_q = (torque1 - p.ratio * torque2) * p.inv_it if p.drive else 0.0
    force_1, force_2 = _slopes_of_jump(
        motion, SEG_FORCE, clock.before_force_k, clock.before_force_c
    )
    friction_1, friction_2 = _slopes_of_jump(
        motion, SEG_FRICTION, clock.before_friction_k, clock.before_friction_c
    )
    third, before_2, before_3 = 6 * series[3, DELTA], clock.before_curvature, clock.before_third

    jump = jumps[clock.jumps]
    jump[:] = 0.0
    jump[VALUE, T] = clock.origin + clock.begin * clock.sample_rate
    jump[SLOPE, T] = clock.sample
    _fill_column(jump, FORCE, force, force_1, force_2, 1.0, 0.0, 0.0)
    _fill_column(jump, FRICTION, friction, friction_1, friction_2, 1.0, 0.0, 0.0)
    _fill_column(jump, AX1, friction, friction_1, friction_2, p.inv_m1, p.c1_m, p.k1_m)
    _fill_column(jump, AX2, friction, friction_1, friction_2, -p.inv_m2, p.c2_m, p.k2_m)
    _fill_column(jump, AY1, force, force_1, force_2, p.inv_m1, p.c1_m, p.k1_m)
    _fill_column(jump, AY2, force, force_1, force_2, -p.inv_m2, p.c2_m, p.k2_m)
    jump[SLOPE, SAMPLE_DELTA_DOT] = curvature - before_2
    jump[CURVATURE, SAMPLE_DELTA_DOT] = third - before_3
    jump[CURVATURE, SAMPLE_DELTA] = curvature - before_2
    jump[SLOPE, SPEED] = a_q + p.th1_psi * a_psi
    clock.jumps += 1
