"""The recurrence behind the Taylor series: each order of the motion from the two before it.

With u = 1/(k + 2) and w = 1/((k + 1)(k + 2)), the equations of docs/model.md give order k + 2 of a
coordinate z with mass m, and stiffness and damping of its support, as

    z_k+2 = u (-c/m z_k+1) + w (-k/m z_k + force_k / m).

The mesh force is the product of series, force_k = sum_j K_j delta_k-j + C_j (k - j + 1) delta_k-j+1
+ offset_k; friction force and moment likewise, see `segment`. The moment has besides what the
growth of the arms, v t + w t^2, makes of the friction force: v friction_k-1 + w friction_k-2.
Order 0 of the mesh's stiffness and damping acts on the coordinates directly, the higher ones
through the forces: where the mesh is constant, there are none. delta is y2 - y1 + psi - e again at
each order, so that no rounding parts them.

The matrices of `model.system` are written out here; a test compares both, order by order.

Each order waits for the one before. Sums are written so that what depends on the last order comes
in last.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from gear_dynamics.integrator.kernel import kernel
from gear_dynamics.integrator.layout import (
    DAMPING,
    DELTA,
    ORDER,
    PSI,
    Q_SUM,
    ROWS,
    SEG_FORCE,
    SEG_FRICTION,
    SEG_MOMENT,
    STATE_Q_SUM,
    STIFFNESS,
    SUPPORT_C,
    SUPPORT_K,
    SUPPORTS_CHANGE,
    TO_FORCE,
    TO_FRICTION,
    TO_LOAD,
    TO_MOMENT,
    TO_Q,
    TO_Q_DOT,
    TO_Q_SUM,
    VELOCITY,
    X1,
    X2,
    Y1,
    Y2,
    Q,
)

_FACTOR = np.arange(1.0, ORDER + 2)
_U = 1.0 / (_FACTOR + 1)
_W = _U / _FACTOR


class Loads(NamedTuple):
    """What acts on the pair besides mesh, supports and drive.

    The arms grow by travel t + travel_rate t^2 [m/s, m/s2]; the load side torque is torque +
    torque_rate t [N m, N m/s].
    """

    travel: float
    travel_rate: float
    torque: float
    torque_rate: float


@kernel
def fill_orders(motion, own, loads, pushed):
    """Fill the series of a motion or of a tangent vector.

    Parameters
    ----------
    motion : MOTION
    own : MOTION or TANGENT
        Whose state, error, segment and changes of the supports these are, and whose series.
    loads : Loads
    pushed : bool
        Whether the accelerations `motion.push` act.
    """
    answers, segment, series, error = motion.constants.answers, own.segment, own.series, own.error
    state, push = own.state, motion.push
    degree, varying = motion.step.degree, motion.step.stiffness_degree
    # Answers of the coordinates to force, friction force, moment and load, and to q.
    s1, s2, d1, d2 = (
        answers[STIFFNESS, X1], answers[STIFFNESS, X2], answers[DAMPING, X1], answers[DAMPING, X2],
    )  # fmt: skip
    r1, r2, f1, f2 = (
        answers[TO_FRICTION, X1], answers[TO_FRICTION, X2],
        answers[TO_FORCE, Y1], answers[TO_FORCE, Y2],
    )  # fmt: skip
    f_psi, r_psi, r_q = answers[TO_FORCE, PSI], answers[TO_FRICTION, PSI], answers[TO_FRICTION, Q]
    m_psi, m_q = answers[TO_MOMENT, PSI], answers[TO_MOMENT, Q]
    l_psi, l_q = answers[TO_LOAD, PSI], answers[TO_LOAD, Q]
    p_psi, p_q = answers[TO_Q, PSI], answers[TO_Q, Q]
    v_psi, v_q = answers[TO_Q_DOT, PSI], answers[TO_Q_DOT, Q]
    i_psi, i_q = answers[TO_Q_SUM, PSI], answers[TO_Q_SUM, Q]
    # Order 0 of the mesh: per delta, and per delta'.
    k_r, c_r = segment[SEG_FRICTION, 0], segment[SEG_FRICTION + 1, 0]
    k_f, c_f = segment[SEG_FORCE, 0], segment[SEG_FORCE + 1, 0]
    k_m, c_m = segment[SEG_MOMENT, 0], segment[SEG_MOMENT + 1, 0]
    k_psi = f_psi * k_f + r_psi * k_r + m_psi * k_m
    c_psi = f_psi * c_f + r_psi * c_r + m_psi * c_m
    k_q, c_q = r_q * k_r + m_q * k_m, r_q * c_r + m_q * c_m
    k_x1, c_x1, k_x2, c_x2 = r1 * k_r, r1 * c_r, r2 * k_r, r2 * c_r
    k_y1, c_y1, k_y2, c_y2 = f1 * k_f, f1 * c_f, f2 * k_f, f2 * c_f
    # Orders k and k + 1 of the coordinates.
    x1, y1, x2, y2, psi, q = state[X1], state[Y1], state[X2], state[Y2], state[PSI], state[Q]
    x1_next, y1_next, x2_next, y2_next, psi_next, q_next = (
        state[VELOCITY + X1], state[VELOCITY + Y1], state[VELOCITY + X2],
        state[VELOCITY + Y2], state[VELOCITY + PSI], state[VELOCITY + Q],
    )  # fmt: skip
    q_sum, q_sum_next = state[STATE_Q_SUM], q
    delta = y2 - y1 + (psi - error[0, 0])
    delta_next = y2_next - y1_next + (psi_next - error[0, 1])
    _put(series, 0, (x1, y1, x2, y2, psi, q, delta, q_sum))
    _put(series, 1, (x1_next, y1_next, x2_next, y2_next, psi_next, q_next, delta_next, q_sum_next))
    m1, m2 = motion.constants.m1, motion.constants.m2
    push_degree = motion.step.push_degree if pushed else -1
    supports_change = motion.step.pushed == SUPPORTS_CHANGE
    load, load_next = loads.torque, loads.torque_rate
    rubs = rubs_before = 0.0
    for k in range(ROWS - 2):
        u, w = _U[k], _W[k]
        # What accelerates besides order 0 of the mesh, and besides supports that do not change.
        moment = loads.travel * rubs + loads.travel_rate * rubs_before
        on_psi = l_psi * load + p_psi * q + i_psi * q_sum + m_psi * moment
        on_q = l_q * load + p_q * q + i_q * q_sum + m_q * moment
        on_x1 = on_y1 = on_x2 = on_y2 = friction = 0.0
        if k <= degree or varying > 0:
            force, friction, moment = _higher_orders(own, k, degree, varying)
            on_x1, on_x2, on_y1, on_y2 = r1 * friction, r2 * friction, f1 * force, f2 * force
            on_psi += f_psi * force + r_psi * friction + m_psi * moment
            on_q += r_q * friction + m_q * moment
        if k <= push_degree:
            on_x1, on_y1 = on_x1 + push[k, X1], on_y1 + push[k, Y1]
            on_x2, on_y2 = on_x2 + push[k, X2], on_y2 + push[k, Y2]
            on_psi, on_q = on_psi + push[k, PSI], on_q + push[k, Q]
        if supports_change:
            on_x1 -= _by_support(motion, own, k, X1, 0) / m1
            on_y1 -= _by_support(motion, own, k, Y1, 0) / m1
            on_x2 -= _by_support(motion, own, k, X2, 1) / m2
            on_y2 -= _by_support(motion, own, k, Y2, 1) / m2
        rubs_before = rubs
        rubs = friction + k_r * delta + c_r * (_FACTOR[k] * delta_next)
        q_after = w * (on_q + k_q * delta) + u * (v_q * q_next + c_q * delta_next)
        psi_after = w * (on_psi + k_psi * delta) + u * (v_psi * q_next + c_psi * delta_next)
        x1_after = w * (on_x1 + s1 * x1 + k_x1 * delta) + u * (d1 * x1_next + c_x1 * delta_next)
        x2_after = w * (on_x2 + s2 * x2 + k_x2 * delta) + u * (d2 * x2_next + c_x2 * delta_next)
        y1_after = w * (on_y1 + s1 * y1 + k_y1 * delta) + u * (d1 * y1_next + c_y1 * delta_next)
        y2_after = w * (on_y2 + s2 * y2 + k_y2 * delta) + u * (d2 * y2_next + c_y2 * delta_next)
        x1, x1_next = x1_next, x1_after
        y1, y1_next = y1_next, y1_after
        x2, x2_next = x2_next, x2_after
        y2, y2_next = y2_next, y2_after
        psi, psi_next = psi_next, psi_after
        q_sum, q_sum_next = q_sum_next, u * q_next
        q, q_next = q_next, q_after
        delta, delta_next = delta_next, y2_after - y1_after + (psi_after - error[0, k + 2])
        load, load_next = load_next, 0.0
        order = (x1_next, y1_next, x2_next, y2_next, psi_next, q_next, delta_next, q_sum_next)
        _put(series, k + 2, order)


@kernel
def _put(series, row, order):
    """Put x1, y1, x2, y2, psi, q, delta and the integral of q into a row."""
    series[row, X1], series[row, Y1], series[row, X2], series[row, Y2] = order[:4]
    series[row, PSI], series[row, Q], series[row, DELTA], series[row, Q_SUM] = order[4:]


@kernel
def _higher_orders(own, k, degree, varying):
    """Return order k of force, friction force and moment but for order 0 of the mesh.

    degree : degree of the offsets; varying : degree of stiffness and damping.
    """
    segment, series = own.segment, own.series
    force = friction = moment = 0.0
    if k <= degree:
        force = segment[SEG_FORCE + 2, k]
        friction = segment[SEG_FRICTION + 2, k]
        moment = segment[SEG_MOMENT + 2, k]
    for j in range(min(k, varying), 0, -1):
        apart, rate = series[k - j, DELTA], _FACTOR[k - j] * series[k - j + 1, DELTA]
        force += segment[SEG_FORCE, j] * apart + segment[SEG_FORCE + 1, j] * rate
        friction += segment[SEG_FRICTION, j] * apart + segment[SEG_FRICTION + 1, j] * rate
        moment += segment[SEG_MOMENT, j] * apart + segment[SEG_MOMENT + 1, j] * rate
    return force, friction, moment


@kernel
def _by_support(motion, own, k, column, wheel):
    """Return order k of the force by the changes of a support's stiffness and damping."""
    series, degrees, force = own.series, motion.degrees, 0.0
    for j in range(min(k, degrees[SUPPORT_K + wheel]) + 1):
        force += own.supports[wheel, j] * series[k - j, column]
    for j in range(min(k, degrees[SUPPORT_C + wheel]) + 1):
        rate = _FACTOR[k - j] * series[k - j + 1, column]
        force += own.supports[2 + wheel, j] * rate
    return force
