"""The jumps of forces and accelerations at events, in closed form.

Where a tooth pair enters, leaves, passes the pitch point, or changes its contact, position and
velocity go on, while force and acceleration jump, and so do their slopes. `model.band_limit` takes
these jumps out of the samples and puts them in again band-limited.
"""

from __future__ import annotations

from gear_dynamics.model.kernel import kernel
from gear_dynamics.model.layout import (
    AX1,
    AX2,
    AY1,
    AY2,
    DELTA,
    FORCE,
    FRICTION,
    HIGH_RATE_SPEED,
    SAMPLE_DELTA_DOT,
    SEG_FORCE,
    SEG_FRICTION,
    SEG_MOMENT,
    T,
)
from gear_dynamics.model.output import operate
from gear_dynamics.model.series import polynomial, value_and_slope

VALUE, SLOPE = 0, 1
"""Rows of a jump: of the columns of a sample, and of their slopes [1/s]. Column T of the first
holds its instant, in samples of the integrator since the start of the run."""


@kernel
def note_before(p, clock, series, segment):
    """Note the forces at the end of the present step, which is a mesh or contact event."""
    t, degree = clock.length, clock.degree
    delta, slope = value_and_slope(series, DELTA, t)
    clock.before_force = operate(segment, SEG_FORCE, degree, t, delta, slope)
    clock.before_friction = operate(segment, SEG_FRICTION, degree, t, delta, slope)
    travelled = clock.travel * t * clock.before_friction
    clock.before_torque1 = operate(segment, SEG_MOMENT, degree, t, delta, slope) + travelled
    clock.before_force_k = polynomial(segment, SEG_FORCE, t)[0]
    clock.before_force_c = polynomial(segment, SEG_FORCE + 1, t)[0]
    clock.before_friction_k = polynomial(segment, SEG_FRICTION, t)[0]
    clock.before_friction_c = polynomial(segment, SEG_FRICTION + 1, t)[0]
    clock.jumped = 1


@kernel
def note_jump(p, clock, series, segment, jumps):
    """Write the jump between `note_before` and the beginning of the present step to `jumps`."""
    clock.jumped = 0
    delta, slope, curvature = series[0, DELTA], series[1, DELTA], 2 * series[2, DELTA]
    force = operate(segment, SEG_FORCE, clock.degree, 0.0, delta, slope) - clock.before_force
    friction = operate(segment, SEG_FRICTION, clock.degree, 0.0, delta, slope)
    friction -= clock.before_friction
    torque1 = operate(segment, SEG_MOMENT, clock.degree, 0.0, delta, slope) - clock.before_torque1
    torque2 = p.arm_sum * friction - torque1
    a_psi = p.psi_1 * torque1 + p.psi_2 * torque2 - force * p.inv_me
    a_q = (torque1 - p.ratio * torque2) * p.inv_it if p.drive else 0.0
    a_delta = a_psi - force * (p.inv_m1 + p.inv_m2)
    was = curvature - a_delta
    force_slope = segment[SEG_FORCE, 0] * slope + segment[SEG_FORCE + 1, 0] * curvature
    force_slope -= clock.before_force_k * slope + clock.before_force_c * was
    friction_slope = segment[SEG_FRICTION, 0] * slope + segment[SEG_FRICTION + 1, 0] * curvature
    friction_slope -= clock.before_friction_k * slope + clock.before_friction_c * was

    jump = jumps[clock.jumps]
    jump[:] = 0.0
    jump[VALUE, T] = clock.origin + clock.begin * clock.sample_rate
    jump[VALUE, FORCE], jump[SLOPE, FORCE] = force, force_slope
    jump[VALUE, FRICTION], jump[SLOPE, FRICTION] = friction, friction_slope
    jump[VALUE, AX1], jump[VALUE, AX2] = friction * p.inv_m1, -friction * p.inv_m2
    jump[VALUE, AY1], jump[VALUE, AY2] = force * p.inv_m1, -force * p.inv_m2
    jump[SLOPE, AX1] = friction_slope * p.inv_m1 - p.c1_m * jump[VALUE, AX1]
    jump[SLOPE, AX2] = -friction_slope * p.inv_m2 - p.c2_m * jump[VALUE, AX2]
    jump[SLOPE, AY1] = force_slope * p.inv_m1 - p.c1_m * jump[VALUE, AY1]
    jump[SLOPE, AY2] = -force_slope * p.inv_m2 - p.c2_m * jump[VALUE, AY2]
    jump[SLOPE, SAMPLE_DELTA_DOT] = a_delta
    jump[SLOPE, HIGH_RATE_SPEED] = a_q + p.th1_psi * a_psi
    clock.jumps += 1
