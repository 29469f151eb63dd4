"""Tangent vectors of the reduced motion: how motions from nearby states part.

Between events the equations of docs/model.md are linear, so that a tangent vector obeys them
without load, transmission error and offsets: its Taylor series is the motion's own, see `series`.
Where contact changes, it jumps by the saltation matrix I + (f+ - f-) n' / (n' f-) (Mueller
1995, Calculation of Lyapunov exponents for dynamic systems with discontinuities). The spring force
is zero at the edge and n' f- is the rate at which the flanks approach; f+ - f- is that rate times
the jump of the damping, so that it cancels: grazing contact is no special case. Changes of
stiffness, of the sliding direction and of flank errors come at known times and leave a tangent
vector as it is.

A tangent vector is x1, y1, x2, y2, psi [m] and their velocities over wn [m], one a row.
"""

from __future__ import annotations

import math

from gear_dynamics.integrator.kernel import kernel
from gear_dynamics.integrator.layout import (
    DAMPING,
    PSI,
    SEG_FORCE,
    SEG_FRICTION,
    SEG_MOMENT,
    SEGMENT,
    SUPPORT_C,
    SUPPORT_K,
    SUPPORTED,
    SUPPORTS_CHANGE,
    TO_FORCE,
    TO_FRICTION,
    TO_MOMENT,
    VELOCITY,
    Y1,
    Y2,
)
from gear_dynamics.integrator.polynomial import copy_rows
from gear_dynamics.integrator.polynomials import advance_columns
from gear_dynamics.integrator.recurrence import Loads, fill_orders
from gear_dynamics.integrator.series import arm_growth

_BODIES = 5
"""Coordinates of the reduced form: x1, y1, x2, y2, psi."""

VARIED = 2 * _BODIES
"""Numbers in a tangent vector."""

_LONGEST = 5.0
"""Radians of the fastest mode that a series spans: 5^28 / 28! is 1e-10."""


@kernel
def advance_vectors(motion, vectors):
    """Advance each row of `vectors` over the present step, and add up what diverges in it.

    The step of the motion itself may be too long for a tangent vector: a mode that the motion does
    not excite needs no short steps there. It is split by an upper bound of the frequencies.

    Returns the integral over the step of the trace of the equations' Jacobian. Contact events add
    nothing to it: the determinant of their saltation matrix is n' f+ / (n' f-) = 1.
    """
    h = motion.step.length
    if h <= 0:
        return 0.0
    parts = int(h * _fastest(motion, h) / _LONGEST) + 1
    _take_segment(motion)
    travel, travel_rate = arm_growth(motion)
    part = h / parts
    divergence = 0.0
    for i in range(parts):
        divergence += _divergence(motion, part, travel, travel_rate)
        for row in range(vectors.shape[0]):
            _advance_vector(motion, part, travel, travel_rate, vectors[row])
        if i + 1 < parts:
            _shift(motion, part, travel, travel_rate)
            travel += 2 * travel_rate * part
    return divergence


@kernel
def _fastest(motion, h):
    """Return a bound of the frequencies in the step [rad/s]."""
    p, stiffness = motion.constants, 0.0
    for j in range(motion.step.degree, -1, -1):
        stiffness = stiffness * h + abs(motion.segment[SEG_FORCE, j])
    mesh = p.answers[TO_FORCE, Y1] - p.answers[TO_FORCE, Y2] - p.answers[TO_FORCE, PSI]
    supports = max(p.k1 / p.m1, p.k2 / p.m2)
    if motion.step.pushed == SUPPORTS_CHANGE:
        for wheel in range(2):
            added = 0.0
            for j in range(motion.degrees[SUPPORT_K + wheel], -1, -1):
                added = added * h + abs(motion.signals[SUPPORT_K + wheel, j])
            supports += added / (p.m1 if wheel == 0 else p.m2)
    return math.sqrt(supports + stiffness * mesh)


@kernel
def _take_segment(motion):
    """Copy the step's segment without its offsets, and the changes of the supports."""
    tangent = motion.tangent
    degree = motion.step.degree
    for row in range(SEGMENT):
        for j in range(degree + 1):
            tangent.segment[row, j] = 0.0 if row % 3 == 2 else motion.segment[row, j]
    if motion.step.pushed == SUPPORTS_CHANGE:
        copy_rows(motion.signals, SUPPORT_K, tangent.supports)


@kernel
def _advance_vector(motion, h, travel, travel_rate, vector):
    """Advance one tangent vector over h seconds."""
    tangent, wn = motion.tangent, motion.constants.wn
    state = tangent.state
    state[:] = 0.0
    for j in range(_BODIES):
        state[j], state[VELOCITY + j] = vector[j], vector[_BODIES + j] * wn
    loads = Loads(travel, travel_rate, 0.0, 0.0)
    fill_orders(motion, tangent, loads, False)
    advance_columns(tangent.series, h, state)
    for j in range(_BODIES):
        vector[j], vector[_BODIES + j] = state[j], state[VELOCITY + j] / wn


@kernel
def _shift_polynomial(terms, degree, t):
    """Replace a polynomial by that in the time since t."""
    for i in range(degree):
        for j in range(degree - 1, i - 1, -1):
            terms[j] += t * terms[j + 1]


@kernel
def _shift(motion, t, travel, travel_rate):
    """Go on to the part of the step that begins t [s] later."""
    tangent, degree = motion.tangent, motion.step.degree
    segment = tangent.segment
    for row in range(SEGMENT):
        _shift_polynomial(segment[row], degree, t)
    arm = (travel + travel_rate * t) * t
    for row in range(2):
        for j in range(degree + 1):
            segment[SEG_MOMENT + row, j] += arm * segment[SEG_FRICTION + row, j]
    if motion.step.pushed == SUPPORTS_CHANGE:
        for row in range(4):
            _shift_polynomial(tangent.supports[row], motion.degrees[SUPPORT_K + row], t)


@kernel
def _divergence(motion, h, travel, travel_rate):
    """Return the integral over h seconds of the trace of the Jacobian."""
    answers, segment, degree = motion.constants.answers, motion.tangent.segment, motion.step.degree
    total = 0.0
    for j in range(_BODIES):
        total += answers[DAMPING, j] * h
    if motion.step.pushed == SUPPORTS_CHANGE:
        for column in range(SUPPORTED):
            wheel = column // 2
            mass = motion.constants.m1 if wheel == 0 else motion.constants.m2
            row = SUPPORT_C - SUPPORT_K + wheel
            for j in range(motion.degrees[SUPPORT_C + wheel] + 1):
                total -= motion.tangent.supports[row, j] * h ** (j + 1) / ((j + 1) * mass)
    for to, row in ((TO_FORCE, SEG_FORCE), (TO_FRICTION, SEG_FRICTION), (TO_MOMENT, SEG_MOMENT)):
        along = answers[to, Y2] - answers[to, Y1] + answers[to, PSI]
        for j in range(degree + 1):
            power = h ** (j + 1)
            total += along * segment[row + 1, j] * power / (j + 1)
            if to == TO_MOMENT:
                grown = travel * h / (j + 2) + travel_rate * h * h / (j + 3)
                total += along * segment[SEG_FRICTION + 1, j] * power * grown
    return total


@kernel
def damping_at_end(motion, out):
    """Fill `out` with the damping of F, Ff and the moment at the end of the present step."""
    t, segment = motion.step.length, motion.segment
    travel, travel_rate = arm_growth(motion)
    for i, row in enumerate((SEG_FORCE, SEG_FRICTION, SEG_MOMENT)):
        # Not beyond the degree, where another step's coefficients may stand.
        out[i] = 0.0
        for j in range(motion.step.stiffness_degree, -1, -1):
            out[i] = out[i] * t + segment[row + 1, j]
    out[2] += (travel + travel_rate * t) * t * out[1]


@kernel
def jump_at_contact(p, jump, vectors):
    """Apply the saltation matrix to each row of `vectors`.

    jump : (3,) array
        Jumps of the damping of F and Ff [N s/m] and of the moment [N s].
    """
    answers = p.answers
    for row in range(vectors.shape[0]):
        v = vectors[row]
        apart = (v[Y2] - v[Y1] + v[PSI]) / p.wn
        for j in range(_BODIES):
            v[_BODIES + j] += apart * (
                answers[TO_FORCE, j] * jump[0]
                + answers[TO_FRICTION, j] * jump[1]
                + answers[TO_MOMENT, j] * jump[2]
            )


@kernel
def orthonormalise(vectors, growth):
    """Make the rows of `vectors` orthonormal; add the logarithms of their lengths to `growth`.

    Modified Gram-Schmidt, each row against those before it (Benettin et al. 1980).
    """
    for i in range(vectors.shape[0]):
        v = vectors[i]
        for j in range(i):
            along = 0.0
            for k in range(v.size):
                along += v[k] * vectors[j, k]
            for k in range(v.size):
                v[k] -= along * vectors[j, k]
        length = 0.0
        for k in range(v.size):
            length += v[k] * v[k]
        length = math.sqrt(length)
        for k in range(v.size):
            v[k] /= length
        growth[i] += math.log(length)
