"""Small variations of the reduced motion: how motions from nearby states part.

Between events the equations of docs/model.md are linear, so that a variation obeys them without
load, transmission error and offsets, and its Taylor series follows by the same recurrences. Where
contact changes, a variation jumps by the saltation matrix I + (f+ - f-) n' / (n' f-) (Mueller
1995, Calculation of Lyapunov exponents for dynamic systems with discontinuities). The spring force
is zero at the edge and n' f- is delta' itself, so that f+ - f- is delta' times the jump of the
damping, and delta' cancels: grazing contact is no special case. Changes of stiffness and of the
sliding direction come at known times and leave a variation as it is.

A variation is x1, y1, x2, y2, psi [m] and their velocities over wn [m], one a row.
"""

from __future__ import annotations

import math

from gear_dynamics.integrator.kernel import kernel
from gear_dynamics.integrator.layout import ORDER, SEG_FORCE, SEG_FRICTION, SEG_MOMENT

VARIED = 10
"""Numbers in a variation of the reduced motion."""


_LONGEST = 5.0
"""Radians of the fastest mode that a series spans: 5^28 / 28! is 1e-10."""


@kernel
def advance_variations(p, segment, travel, h, vectors):
    """Advance each row of `vectors` over a step of h seconds at constant speed.

    The step of the motion itself may be too long for a variation: a mode that the motion does not
    excite needs no short steps there. It is split by an upper bound of the frequencies.

    Parameters
    ----------
    p : record of CONSTANTS
    segment : (SEGMENT, WIDTH) array
        Of the step, of degree 0.
    travel : float
        Rate at which the arms grow [m/s].
    h : float
        [s].
    vectors : (k, VARIED) array
    """
    square = max(p.k1 / p.m1, p.k2 / p.m2)
    square += segment[SEG_FORCE, 0] * (1 / p.m1 + 1 / p.m2 + 1 / p.me)
    parts = int(h * math.sqrt(square) / _LONGEST) + 1
    for part in range(parts):
        _advance_part(p, segment, travel, part * h / parts, h / parts, vectors)


@kernel
def _advance_part(p, segment, travel, since, h, vectors):
    """Advance over h seconds of the step, `since` its beginning.

    Series are in t / h, so that they sum to the values at the end.
    """
    square = h * h
    c1, k1, c2, k2 = p.c1 / p.m1 * h, p.k1 / p.m1 * square, p.c2 / p.m2 * h, p.k2 / p.m2 * square
    by_m1, by_m2, by_me = square / p.m1, square / p.m2, square / p.me
    psi_1, psi_2 = p.rb1 / p.inertia1 * square, p.rb2 / p.inertia2 * square
    force_k, force_c = segment[SEG_FORCE, 0], segment[SEG_FORCE + 1, 0] / h
    rub_k, rub_c = segment[SEG_FRICTION, 0], segment[SEG_FRICTION + 1, 0] / h
    turn_k = segment[SEG_MOMENT, 0] + travel * since * rub_k
    turn_c = segment[SEG_MOMENT + 1, 0] / h + travel * since * rub_c
    rubs, shift, rate = p.mu > 0, travel * h, p.wn * h
    for row in range(vectors.shape[0]):
        v = vectors[row]
        x1, y1, x2, y2, psi = v[0], v[1], v[2], v[3], v[4]
        x1n, y1n, x2n, y2n, psin = v[5] * rate, v[6] * rate, v[7] * rate, v[8] * rate, v[9] * rate
        friction = torque1 = torque2 = 0.0
        sx1, sy1, sx2, sy2, spsi = x1, y1, x2, y2, psi
        tx1 = ty1 = tx2 = ty2 = tpsi = 0.0
        for k in range(ORDER):
            order = k + 1.0
            sx1 += x1n
            sy1 += y1n
            sx2 += x2n
            sy2 += y2n
            spsi += psin
            vx1, vy1, vx2, vy2, vpsi = (
                order * x1n,
                order * y1n,
                order * x2n,
                order * y2n,
                order * psin,
            )
            tx1 += vx1
            ty1 += vy1
            tx2 += vx2
            ty2 += vy2
            tpsi += vpsi
            delta, delta_dot = y2 - y1 + psi, vy2 - vy1 + vpsi
            force = force_k * delta + force_c * delta_dot
            if rubs:
                before = friction
                friction = rub_k * delta + rub_c * delta_dot
                torque1 = turn_k * delta + turn_c * delta_dot + shift * before
                torque2 = p.arm_sum * friction - torque1
            twice = 1.0 / (order * (order + 1.0))
            x1, x1n = x1n, (friction * by_m1 - c1 * vx1 - k1 * x1) * twice
            y1, y1n = y1n, (force * by_m1 - c1 * vy1 - k1 * y1) * twice
            x2, x2n = x2n, (-friction * by_m2 - c2 * vx2 - k2 * x2) * twice
            y2, y2n = y2n, (-force * by_m2 - c2 * vy2 - k2 * y2) * twice
            psi, psin = psin, (psi_1 * torque1 + psi_2 * torque2 - force * by_me) * twice
        v[0], v[1], v[2], v[3], v[4] = sx1, sy1, sx2, sy2, spsi
        v[5], v[6], v[7], v[8], v[9] = tx1 / rate, ty1 / rate, tx2 / rate, ty2 / rate, tpsi / rate


@kernel
def divergence_over_step(p, segment, travel, h):
    """Return the integral over a step of the trace of the equations' Jacobian.

    Contact events add nothing: the determinant of their saltation matrix is n' f+ / (n' f-) = 1.
    """
    force_c, rub_c = segment[SEG_FORCE + 1, 0], segment[SEG_FRICTION + 1, 0]
    psi_1, psi_2 = p.rb1 / p.inertia1, p.rb2 / p.inertia2
    turn_c = segment[SEG_MOMENT + 1, 0] + 0.5 * travel * h * rub_c
    supports = -2 * p.c1 / p.m1 - 2 * p.c2 / p.m2
    mesh = -force_c * (1 / p.m1 + 1 / p.m2 + 1 / p.me)
    return h * (supports + mesh + psi_1 * turn_c + psi_2 * (p.arm_sum * rub_c - turn_c))


@kernel
def jump_at_contact(p, force_c, rub_c, turn_c, vectors):
    """Apply the saltation matrix to each row of `vectors`.

    force_c, rub_c, turn_c : jumps of the damping rows of F and Ff [N s/m] and of the moment [N s].
    """
    psi_1, psi_2 = p.rb1 / p.inertia1, p.rb2 / p.inertia2
    for row in range(vectors.shape[0]):
        v = vectors[row]
        apart = (v[3] - v[1] + v[4]) / p.wn
        force, friction, torque1 = force_c * apart, rub_c * apart, turn_c * apart
        v[5] += friction / p.m1
        v[6] += force / p.m1
        v[7] -= friction / p.m2
        v[8] -= force / p.m2
        torque2 = p.arm_sum * friction - torque1
        v[9] += psi_1 * torque1 + psi_2 * torque2 - force / p.me


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
