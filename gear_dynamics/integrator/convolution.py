"""The recurrence of a Taylor series whose coefficients are polynomials in time.

As in `recurrence`, but stiffness and damping of the mesh and of the supports are series themselves,
so that each order is a sum of products with all orders before it:

    S_k+2 = u (damping S_k+1 + to_q_dot q_k+1)
          + w (stiffness S_k + to_q q_k + to_q_sum q_sum_k + to_moment moved_k + offset_k
               + sum_j K_j delta_k-j + C_j (k - j + 1) delta_k-j+1
               - sum_j dk_j S_k-j + dc_j (k - j + 1) S_k-j+1)
"""

from __future__ import annotations

from typing import Any

import numpy as np
from llvmlite import ir
from numba.core import cgutils, types

from gear_dynamics.integrator import plain
from gear_dynamics.integrator.kernel import kernel, vector_code
from gear_dynamics.integrator.layout import (
    COLUMNS,
    DELTA,
    ORDER,
    Q_SUM,
    ROWS,
    SEG_FORCE,
    SEG_FRICTION,
    SEG_MOMENT,
    SUPPORT_C,
    SUPPORT_K,
    SUPPORTED,
    WIDTH,
    Q,
)
from gear_dynamics.integrator.recurrence import (
    DAMPING,
    STIFFNESS,
    TO_FORCE,
    TO_FRICTION,
    TO_LOAD,
    TO_MOMENT,
    TO_Q,
    TO_Q_DOT,
    TO_Q_SUM,
    answers_row,
    data_of_arrays,
    delta_of,
    first_orders,
    store_order,
)
from gear_dynamics.integrator.vector import (
    DOUBLE,
    INT,
    LANES,
    ahead,
    load,
    multiply_add,
    number_at,
    one_of,
    place,
    spread,
    store,
    vector_of,
    with_lane,
)

_INVERSE = 1.0 / np.arange(1, ORDER + 3)
_WEIGHTS = np.stack([_INVERSE[1:], _INVERSE[1:] * _INVERSE[:-1]], axis=1).ravel()
"""u and w of each order."""


@kernel
def fold(motion, own):
    """Fill what the orders of the segment do to each column: K_j and C_j, and the offsets."""
    answers, folded = motion.constants.answers, own.folded
    for j in range(motion.step.stiffness_degree + 1):
        put_folded(answers, own.segment, 0, j, folded, 2 * j)
        put_folded(answers, own.segment, 1, j, folded, 2 * j + 1)
    for j in range(motion.step.degree + 1):
        put_folded(answers, own.segment, 2, j, own.offsets, j)


@vector_code(plain.put_folded)
def put_folded(typing_context, answers, segment, row, j, out, index):
    """Put what order j of stiffness (row 0), damping (1) or offset (2) does to each column.

    out : array; index : which eight numbers of it. Column DELTA, which is made from the others,
    has the friction force.
    """

    def generate(context, builder, signature, arguments):
        answers_data, segment_data, target = data_of_arrays(
            context, builder, signature.args, arguments
        )
        first, order, place_of_row = (
            context.cast(builder, arguments[i], signature.args[i], types.int64) for i in (2, 3, 5)
        )
        at = builder.add(builder.mul(first, ir.Constant(INT, WIDTH)), order)
        total = None
        for to, rows in (
            (TO_FORCE, SEG_FORCE),
            (TO_FRICTION, SEG_FRICTION),
            (TO_MOMENT, SEG_MOMENT),
        ):
            per_unit = answers_row(builder, answers_data, to)
            if to == TO_FRICTION:
                per_unit = with_lane(builder, per_unit, vector_of(1.0), DELTA)
            number = number_at(builder, segment_data, ahead(builder, at, 1, WIDTH * rows))
            product = builder.fmul(per_unit, spread(builder, number))
            total = product if total is None else builder.fadd(total, product)
        store(builder, total, target, ahead(builder, place_of_row, LANES, 0))
        return context.get_dummy_value()

    return types.void(answers, segment, row, j, out, index), generate


@kernel
def fold_varying_offset(motion):
    """Fill the offsets with the push and what varies of the segment's offset.

    With constant stiffness and damping, `recurrence.fill_pushed_orders` takes them as its push.
    """
    offsets, push, degree = motion.offsets, motion.push, motion.step.degree
    for c in range(COLUMNS):
        offsets[0, c] = 0.0
    for k in range(1, degree + 1):
        put_folded(motion.constants.answers, motion.segment, 2, k, offsets, k)
    for k in range(degree + 1, ROWS):
        for c in range(COLUMNS):
            offsets[k, c] = 0.0
    if motion.step.pushed:
        for k in range(ROWS):
            for c in range(COLUMNS):
                offsets[k, c] += push[k, c]


@kernel
def add_loads(motion, torque, torque_rate):
    """Add the load side torque and the push to the offsets of a motion."""
    offsets, push, degree = motion.offsets, motion.push, motion.step.degree
    for k in range(degree + 1, ROWS):
        for c in range(COLUMNS):
            offsets[k, c] = 0.0
    to_load = motion.constants.answers[TO_LOAD]
    for c in range(COLUMNS):
        offsets[0, c] += to_load[c] * torque
        offsets[1, c] += to_load[c] * torque_rate
    if motion.step.pushed:
        for k in range(ROWS):
            for c in range(COLUMNS):
                offsets[k, c] += push[k, c]


@kernel
def fold_supports(motion, own):
    """Fill what changes of the supports take from each column; return how many orders there are."""
    p, degrees, rows = motion.constants, motion.degrees, own.support_rows
    count = 0
    for row in range(SUPPORT_K, SUPPORT_C + 2):
        count = max(count, degrees[row] + 1)
    rows[:count] = 0.0
    for row in range(SUPPORT_K, SUPPORT_C + 2):
        wheel = (row - SUPPORT_K) % 2
        first = COLUMNS * ((row - SUPPORT_K) // 2) + SUPPORTED // 2 * wheel
        by_mass = 1.0 / p.m1 if wheel == 0 else 1.0 / p.m2
        for j in range(degrees[row] + 1):
            for c in range(SUPPORTED // 2):
                rows[j, first + c] = -by_mass * own.supports[row - SUPPORT_K, j]
    return count


@kernel
def expand_by_convolution(motion, own, supports, travel, travel_rate):
    """Fill the series of a motion or of a tangent vector, whose segment has been folded.

    supports : int
        Orders of the changes of the supports.
    """
    fill_convolved_orders(
        motion.constants.answers,
        own.folded,
        own.offsets,
        own.support_rows,
        own.state,
        own.error,
        own.orders,
        _WEIGHTS,
        motion.step.stiffness_degree + 1,
        supports,
        travel,
        travel_rate,
        own.series,
    )


_DELTAS, _RATES, _FRICTION = 0, ROWS, 2 * ROWS
"""Places in the scratch: orders of delta, of its derivative, and of the friction force, after two
zeros."""


@vector_code(plain.fill_convolved_orders)
def fill_convolved_orders(
    typing_context,
    answers,
    folded,
    offsets,
    support_rows,
    state,
    error,
    orders,
    weights,
    degree_count,
    support_count,
    travel,
    travel_rate,
    series,
):
    """Fill a series.

    folded : (n, 16) array, K_j and C_j; offsets : (ROWS, 8) array; support_rows : (n, 16) array,
    -dk_j and -dc_j over the masses; orders : scratch; weights : u and w of each order, in turns;
    degree_count, support_count : rows of `folded` and `support_rows` that count; the others are as
    in `recurrence.fill_orders`. Column DELTA of `folded` and `offsets` has the friction force.
    """

    def generate(context, builder, signature, arguments):
        data = data_of_arrays(context, builder, signature.args, arguments)
        counts = [
            context.cast(builder, arguments[i], signature.args[i], types.int64) for i in (8, 9)
        ]
        grows = [spread(builder, value) for value in arguments[10:12]]
        _generate(builder, data, counts, grows)
        return context.get_dummy_value()

    signature = types.void(
        answers, folded, offsets, support_rows, state, error, orders, weights,
        degree_count, support_count, travel, travel_rate, series,
    )  # fmt: skip
    return signature, generate


def _generate(builder: Any, data: list[Any], counts: list[Any], grows: list[Any]) -> None:
    answers, folded, offsets, supports, state, error, scratch, weights, series = data
    row_of = {
        to: answers_row(builder, answers, to)
        for to in (STIFFNESS, DAMPING, TO_MOMENT, TO_Q, TO_Q_DOT, TO_Q_SUM)
    }

    def put(number: Any, index: Any) -> None:
        builder.store(number, place(builder, scratch, index))

    zero = ir.Constant(DOUBLE, 0.0)
    for k, order in enumerate(first_orders(builder, state, error)):
        store_order(builder, order, series, LANES * k)
        delta = _lane(builder, order.delta)
        put(delta, _DELTAS + k)
        put(delta if k else zero, _RATES if k else _FRICTION)
    put(zero, _FRICTION + 1)

    with cgutils.for_range(builder, ir.Constant(INT, ROWS - 2)) as orders:
        k = orders.index
        now, following = (load(builder, series, ahead(builder, k, LANES, i)) for i in (0, LANES))
        rates = builder.fmul(row_of[DAMPING], following)
        rates = multiply_add(builder, row_of[TO_Q_DOT], one_of(builder, following, Q), rates)
        total = load(builder, offsets, ahead(builder, k, LANES, 0))
        total = multiply_add(builder, row_of[STIFFNESS], now, total)
        total = multiply_add(builder, row_of[TO_Q], one_of(builder, now, Q), total)
        total = multiply_add(builder, row_of[TO_Q_SUM], one_of(builder, now, Q_SUM), total)
        total = _sum_over_orders(
            builder, k, counts[0], folded, total, lambda at: (
                spread(builder, number_at(builder, scratch, ahead(builder, at, 1, _DELTAS))),
                spread(builder, number_at(builder, scratch, ahead(builder, at, 1, _RATES))),
            )
        )  # fmt: skip
        put(_lane(builder, total, DELTA), ahead(builder, k, 1, _FRICTION + 2))
        for i, growth in enumerate(grows):
            before = number_at(builder, scratch, ahead(builder, k, 1, _FRICTION + 1 - i))
            moved = builder.fmul(growth, spread(builder, before))
            total = multiply_add(builder, row_of[TO_MOMENT], moved, total)

        def rows_at(at: Any) -> tuple[Any, Any]:
            here = load(builder, series, ahead(builder, at, LANES, 0))
            after = load(builder, series, ahead(builder, at, LANES, LANES))
            factor = builder.sitofp(ahead(builder, at, 1, 1), DOUBLE)
            return here, builder.fmul(spread(builder, factor), after)

        total = _sum_over_orders(builder, k, counts[1], supports, total, rows_at)
        u, w = (
            spread(builder, number_at(builder, weights, ahead(builder, k, 2, i))) for i in (0, 1)
        )
        row = multiply_add(builder, u, rates, builder.fmul(w, total))
        order = delta_of(builder, row, number_at(builder, error, ahead(builder, k, 1, 2)))
        store_order(builder, order, series, ahead(builder, k, LANES, 2 * LANES))
        delta = _lane(builder, order.delta)
        put(delta, ahead(builder, k, 1, _DELTAS + 2))
        factor = builder.sitofp(ahead(builder, k, 1, 2), DOUBLE)
        put(builder.fmul(factor, delta), ahead(builder, k, 1, _RATES + 1))


def _sum_over_orders(builder: Any, k: Any, count: Any, rows: Any, start: Any, factors: Any) -> Any:
    """Return start plus the sum over j < count, j <= k of two rows times their factors at k - j."""
    # A sum for each factor, so that two chains of additions run side by side.
    totals = [cgutils.alloca_once_value(builder, value) for value in (start, vector_of(0.0))]
    reachable = ahead(builder, k, 1, 1)
    fewer = builder.icmp_signed('<', count, reachable)
    with cgutils.for_range(builder, builder.select(fewer, count, reachable)) as loop:
        at = builder.sub(k, loop.index)
        for i, factor in enumerate(factors(at)):
            row = load(builder, rows, ahead(builder, loop.index, 2 * LANES, LANES * i))
            value = multiply_add(builder, row, factor, builder.load(totals[i]))
            builder.store(value, totals[i])
    return builder.fadd(*(builder.load(total) for total in totals))


def _lane(builder: Any, vector: Any, lane: int = 0) -> Any:
    return builder.extract_element(vector, ir.Constant(ir.IntType(32), lane))
