"""The recurrence behind the Taylor series, over all eight columns of a series at once.

With S_k row k of a series, delta_k its column DELTA, r_k the friction force's order k and u, w the
reciprocals of k + 2 and (k + 1)(k + 2), the equations of docs/model.md give

    S_k+2 = u (damping S_k+1 + to_delta_dot delta_k+1 + to_q_dot q_k+1)
          + w (stiffness S_k + to_delta delta_k + to_q q_k + to_q_sum q_sum_k + to_moment moved_k)

and what load and offsets add to orders 2 and 3; moved_k = travel r_k-1 + travel_rate r_k-2 is what
the arms' growth adds to the moment. delta is y2 - y1 + psi - e again at each order.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from numba.core import types

from gear_dynamics.integrator import plain
from gear_dynamics.integrator.kernel import vector_code
from gear_dynamics.integrator.layout import (
    DELTA,
    PSI,
    Q_SUM,
    ROWS,
    SEG_FORCE,
    SEG_FRICTION,
    SEG_MOMENT,
    WIDTH,
    Y1,
    Y2,
    Q,
)
from gear_dynamics.integrator.vector import (
    LANES,
    data_of,
    load,
    multiply_add,
    number_at,
    one_of,
    spread,
    store,
    vector_of,
    with_lane,
)

(
    TO_FORCE,
    TO_FRICTION,
    TO_MOMENT,
    TO_LOAD,
    STIFFNESS,
    DAMPING,
    TO_Q,
    TO_Q_DOT,
    TO_Q_SUM,
) = range(9)
ANSWERS = 9
"""Rows of `constants.answers`, zero in column DELTA: what each column's second derivative is made
of, per unit of mesh force, friction force, moment and load side torque, of the column itself and
its derivative, and of q, its derivative and its integral. (The integral of q is itself a column,
whose first derivative is q: TO_Q_DOT has that.)"""


def data_of_arrays(context: Any, builder: Any, kinds: Any, arguments: Any) -> list[Any]:
    """Return the pointers to the numbers of those arguments that are arrays."""
    return [
        data_of(context, builder, kind, value)
        for kind, value in zip(kinds, arguments, strict=True)
        if isinstance(kind, types.Array)
    ]


class _Terms(NamedTuple):
    """Vectors that multiply, all lanes alike or one for each column."""

    stiffness: Any
    damping: Any
    to_delta: Any
    to_delta_dot: Any
    to_moment: Any
    to_q: Any
    to_q_dot: Any
    to_q_sum: Any


class _Order(NamedTuple):
    """A row of the series, but for its column DELTA; and that column, in all lanes."""

    row: Any
    delta: Any


def answers_row(builder: Any, data: Any, row: int) -> Any:
    """Return a row of `constants.answers`."""
    return load(builder, data, LANES * row)


def _folded(builder: Any, answers: Any, segment: Any, row: int) -> Any:
    """Return what the mesh's stiffness (row 0), damping (1) or offset (2) does to each column."""
    total = None
    for to, rows in ((TO_FORCE, SEG_FORCE), (TO_FRICTION, SEG_FRICTION), (TO_MOMENT, SEG_MOMENT)):
        factor = spread(builder, number_at(builder, segment, WIDTH * (rows + row)))
        total = multiply_add(builder, factor, answers_row(builder, answers, to), total)
    return total


def _terms(builder: Any, answers: Any, segment: Any) -> _Terms:
    return _Terms(
        stiffness=answers_row(builder, answers, STIFFNESS),
        damping=answers_row(builder, answers, DAMPING),
        to_delta=_folded(builder, answers, segment, 0),
        to_delta_dot=_folded(builder, answers, segment, 1),
        to_moment=answers_row(builder, answers, TO_MOMENT),
        to_q=answers_row(builder, answers, TO_Q),
        to_q_dot=answers_row(builder, answers, TO_Q_DOT),
        to_q_sum=answers_row(builder, answers, TO_Q_SUM),
    )


def _delta(builder: Any, row: Any, error: Any) -> Any:
    apart = builder.fsub(one_of(builder, row, Y2), one_of(builder, row, Y1))
    return builder.fadd(apart, builder.fsub(one_of(builder, row, PSI), spread(builder, error)))


def delta_of(builder: Any, row: Any, error: Any) -> _Order:
    """Return an order with its delta."""
    return _Order(row, _delta(builder, row, error))


def store_order(builder: Any, order: _Order, data: Any, index: Any) -> None:
    """Put an order into a row of a series."""
    store(builder, with_lane(builder, order.row, order.delta, DELTA), data, index)


def _following(
    builder: Any, terms: _Terms, weights: tuple[Any, Any], now: _Order, following: _Order, more: Any
) -> Any:
    """Return order k + 2, but for its column DELTA.

    weights : u, w of order k; more : what else accelerates, or None. What depends on the last
    order comes last in each sum, since it is ready last.
    """
    rates = builder.fmul(terms.damping, following.row)
    rates = multiply_add(builder, terms.to_q_dot, one_of(builder, following.row, Q), rates)
    rates = multiply_add(builder, terms.to_delta_dot, following.delta, rates)
    total = builder.fmul(terms.stiffness, now.row)
    total = multiply_add(builder, terms.to_q, one_of(builder, now.row, Q), total)
    total = multiply_add(builder, terms.to_q_sum, one_of(builder, now.row, Q_SUM), total)
    total = multiply_add(builder, terms.to_delta, now.delta, total)
    for factor, vector in more:
        total = multiply_add(builder, factor, vector, total)
    return multiply_add(builder, weights[0], rates, builder.fmul(weights[1], total))


def first_orders(builder: Any, state: Any, error: Any) -> list[_Order]:
    """Return orders 0 and 1: positions and velocities."""
    values, slopes = load(builder, state, 0), load(builder, state, 6)
    values = with_lane(builder, values, spread(builder, number_at(builder, state, 12)), Q_SUM)
    slopes = with_lane(builder, slopes, one_of(builder, values, Q), Q_SUM)
    return [
        delta_of(builder, row, number_at(builder, error, k))
        for k, row in enumerate((values, slopes))
    ]


def _generate_orders(context: Any, builder: Any, kinds: Any, arguments: Any, pushed: bool) -> Any:
    """Generate the code of `fill_orders` or `fill_pushed_orders`."""
    data = data_of_arrays(context, builder, kinds, arguments)
    answer_data, segment_data, state_data, error_data, *push_data, series_data = data
    terms = _terms(builder, answer_data, segment_data)
    grows = [builder.fmul(terms.to_moment, spread(builder, value)) for value in arguments[4:6]]
    loads = [spread(builder, value) for value in arguments[6:8]]
    to_load = answers_row(builder, answer_data, TO_LOAD)
    offsets = _folded(builder, answer_data, segment_data, 2)
    rub_k, rub_c, rub_o = (
        spread(builder, number_at(builder, segment_data, WIDTH * (SEG_FRICTION + row)))
        for row in range(3)
    )
    orders = first_orders(builder, state_data, error_data)
    friction: list[Any] = []
    pushes = [load(builder, push_data[0], LANES * k) for k in range(ROWS - 2)] if pushed else []
    for k in range(ROWS - 2):
        now, following = orders[k], orders[k + 1]
        more = [(offsets, vector_of(1.0))] if k == 0 else []
        more += [(to_load, loads[k])] if k < 2 else []
        more += [(vector_of(1.0), pushes[k])] if pushed else []
        more += [(grows[j], friction[k - 1 - j]) for j in (1, 0) if k - 1 - j >= 0]
        weights = vector_of(1 / (k + 2)), vector_of(1 / ((k + 1) * (k + 2)))
        row = _following(builder, terms, weights, now, following, more)
        rubs = multiply_add(builder, rub_k, now.delta, rub_o if k == 0 else None)
        if pushed:
            rubs = builder.fadd(rubs, one_of(builder, pushes[k], DELTA))
        damping = builder.fmul(rub_c, vector_of(k + 1.0))
        friction.append(multiply_add(builder, damping, following.delta, rubs))
        orders.append(delta_of(builder, row, number_at(builder, error_data, k + 2)))
    for k, order in enumerate(orders):
        store_order(builder, order, series_data, LANES * k)
    return context.get_dummy_value()


@vector_code(plain.fill_orders)
def fill_orders(
    typing_context, answers, segment, state, error, travel, travel_rate, torque, torque_rate, series
):
    """Fill a series.

    answers : (ANSWERS, 8) array; segment : (SEGMENT, WIDTH) array, of which order 0 is used;
    travel [m/s], travel_rate [m/s2]; torque [N m] and its rate [N m/s]: load side torque; state :
    (STATES,) array with room for one number more; error : array whose row 0 is the series of the
    transmission error; series : (ROWS, 8) array.
    """

    def generate(context, builder, signature, arguments):
        return _generate_orders(context, builder, signature.args, arguments, False)

    signature = types.void(
        answers, segment, state, error, travel, travel_rate, torque, torque_rate, series
    )
    return signature, generate


@vector_code(plain.fill_pushed_orders)
def fill_pushed_orders(
    typing_context,
    answers,
    segment,
    state,
    error,
    travel,
    travel_rate,
    torque,
    torque_rate,
    push,
    series,
):
    """Fill a series as `fill_orders` does, with accelerations besides.

    push : (ROWS, 8) array, the series of these accelerations; column DELTA has what is added to the
    friction force.
    """

    def generate(context, builder, signature, arguments):
        return _generate_orders(context, builder, signature.args, arguments, True)

    signature = types.void(
        answers, segment, state, error, travel, travel_rate, torque, torque_rate, push, series
    )
    return signature, generate
