"""Evaluation of a series' polynomials, by vector instructions."""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba.core import types

from gear_dynamics.integrator import plain
from gear_dynamics.integrator.kernel import vector_code
from gear_dynamics.integrator.layout import (
    DELTA,
    PSI,
    Q_SUM,
    ROWS,
)
from gear_dynamics.integrator.vector import (
    DOUBLE,
    INT,
    LANES,
    data_of,
    load,
    multiply_add,
    number_at,
    place,
    shifted,
    smaller,
    spread,
    store,
    vector_of,
)


def _value_and_slope(builder: Any, coefficients: list[Any], t: Any) -> tuple[Any, Any]:
    """Return value and slope at t of the polynomials with the given coefficients.

    Even and odd powers apart, p(t) = E(u) + t O(u) with u = t^2, so that two chains of
    multiplications run side by side.
    """
    u = builder.fmul(t, t)
    even, even_slope = _horner(builder, coefficients[::2], u)
    odd, odd_slope = _horner(builder, coefficients[1::2], u)
    slope = multiply_add(builder, t, odd_slope, even_slope)
    return (
        multiply_add(builder, t, odd, even),
        multiply_add(builder, builder.fadd(t, t), slope, odd),
    )


def _value(builder: Any, coefficients: list[Any], t: Any) -> Any:
    """Return the value alone."""
    u = builder.fmul(t, t)
    even, odd = _horner(builder, coefficients[::2], u), _horner(builder, coefficients[1::2], u)
    return multiply_add(builder, t, odd[0], even[0])


def _horner(builder: Any, coefficients: list[Any], t: Any) -> tuple[Any, Any]:
    """Return value and slope by Horner's rule; the compiler drops what is not used."""
    value, slope = multiply_add(builder, coefficients[-1], t, coefficients[-2]), coefficients[-1]
    for vector in reversed(coefficients[:-2]):
        slope = multiply_add(builder, slope, t, value)
        value = multiply_add(builder, value, t, vector)
    return value, slope


def _sixteenths_of(builder: Any, h: Any) -> list[Any]:
    """Return h/16, 2h/16, ..., h in two vectors."""
    parts = [(j + 1) / (2 * LANES) for j in range(2 * LANES)]
    whole = spread(builder, h)
    return [builder.fmul(vector_of(*parts[j : j + LANES]), whole) for j in (0, LANES)]


def _columns(builder: Any, data: Any) -> list[Any]:
    return [load(builder, data, LANES * k) for k in range(ROWS)]


@vector_code(plain.columns_at)
def columns_at(typing_context, series, t, out):
    """Put eight polynomials and their slopes at time t into rows 0 and 1 of `out`.

    series : (ROWS, 8) array; out : array with room for 16 numbers.
    """

    def generate(context, builder, signature, arguments):
        series_type, _, out_type = signature.args
        data = data_of(context, builder, series_type, arguments[0])
        target = data_of(context, builder, out_type, arguments[2])
        value, slope = _value_and_slope(
            builder, _columns(builder, data), spread(builder, arguments[1])
        )
        store(builder, value, target, 0)
        store(builder, slope, target, LANES)
        return context.get_dummy_value()

    return types.void(series, t, out), generate


@vector_code(plain.advance_columns)
def advance_columns(typing_context, series, t, state):
    """Put the state at time t into a (STATES,) array with room for one number more.

    series : (ROWS, 8) array.
    """

    def generate(context, builder, signature, arguments):
        data = data_of(context, builder, signature.args[0], arguments[0])
        target = data_of(context, builder, signature.args[2], arguments[2])
        value, slope = _value_and_slope(
            builder, _columns(builder, data), spread(builder, arguments[1])
        )
        store(builder, value, target, 0)
        store(builder, slope, target, 6)
        q_sum = builder.extract_element(value, ir.Constant(ir.IntType(32), Q_SUM))
        builder.store(q_sum, place(builder, target, 12))
        return context.get_dummy_value()

    return types.void(series, t, state), generate


@vector_code(plain.fill_rates)
def fill_rates(typing_context, series, rates):
    """Fill the series of the derivatives that samples are made of, in the columns of a series.

    Second derivatives of X1, Y1, X2 and Y2, first ones of the others. series, rates : (ROWS, 8)
    arrays; the last row of `rates` is left.
    """

    def generate(context, builder, signature, arguments):
        data, target = (
            data_of(context, builder, kind, value)
            for kind, value in zip(signature.args, arguments, strict=True)
        )
        rows = _columns(builder, data)
        for k in range(ROWS - 1):
            first = vector_of(*[0.0] * 4, *[k + 1.0] * 4)
            second = vector_of(*[(k + 1.0) * (k + 2.0)] * 4, *[0.0] * 4)
            total = builder.fmul(first, rows[k + 1])
            if k + 2 < ROWS:
                total = multiply_add(builder, second, rows[k + 2], total)
            store(builder, total, target, LANES * k)
        return context.get_dummy_value()

    return types.void(series, rates), generate


@vector_code(plain.fill_values)
def fill_values(typing_context, series, rates, times, values):
    """Evaluate the polynomials that samples are made of at eight times.

    series, rates : (ROWS, 8) arrays, as of `fill_rates`; times : (8,) array; values : (11, 8)
    array, filled with seven columns of the rates, then psi, q, delta and the integral of q.
    """

    def generate(context, builder, signature, arguments):
        data = [
            data_of(context, builder, kind, value)
            for kind, value in zip(signature.args, arguments, strict=True)
        ]
        t = load(builder, data[2], 0)
        columns = [(data[1], column, ROWS - 1) for column in range(LANES - 1)]
        columns += [(data[0], column, ROWS) for column in range(PSI, LANES)]
        for row, (source, column, rows) in enumerate(columns):
            numbers = [number_at(builder, source, LANES * k + column) for k in range(rows)]
            value = _value(builder, [spread(builder, number) for number in numbers], t)
            store(builder, value, data[3], LANES * row)
        return context.get_dummy_value()

    return types.void(series, rates, times, values), generate


@vector_code(plain.sixteenths)
def sixteenths(typing_context, polynomials, row, h, out):
    """Put a polynomial and its slope at h/16, 2h/16, ..., h into rows 0 and 1 of `out`.

    polynomials : (n, ROWS) array, of which the row is taken; out : (2, 16) array.
    """

    def generate(context, builder, signature, arguments):
        polynomials_type, row_type, _, out_type = signature.args
        data = data_of(context, builder, polynomials_type, arguments[0])
        target = data_of(context, builder, out_type, arguments[3])
        index = context.cast(builder, arguments[1], row_type, types.int64)
        data = builder.gep(data, [builder.mul(index, ir.Constant(INT, ROWS))])
        times = _sixteenths_of(builder, arguments[2])
        coefficients = [spread(builder, number_at(builder, data, k)) for k in range(ROWS)]
        for half, (value, slope) in enumerate(
            _value_and_slope(builder, coefficients, t) for t in times
        ):
            store(builder, value, target, half * LANES)
            store(builder, slope, target, (2 + half) * LANES)
        return context.get_dummy_value()

    return types.void(polynomials, row, h, out), generate


@vector_code(plain.delta_stays_above)
def delta_stays_above(typing_context, series, h, level):
    """Return whether delta stays above a level from time 0 to h: the common case, told quickly.

    Looked at are delta and its slope at sixteenths of h; between two of them delta is above the
    lower one, or turns. Then its dip below that is at most a quarter of the change of slope times
    the time between where delta is convex; twice that leaves room for an inflection.

    series : (ROWS, 8) array.
    """

    def generate(context, builder, signature, arguments):
        data = data_of(context, builder, signature.args[0], arguments[0])
        coefficients = [
            spread(builder, number_at(builder, data, LANES * k + DELTA)) for k in range(ROWS)
        ]
        half_part = spread(builder, builder.fmul(arguments[1], ir.Constant(DOUBLE, 0.25 / LANES)))
        level, zero = spread(builder, arguments[2]), vector_of(0.0)
        before = coefficients[0], coefficients[1]
        below = None
        for t in _sixteenths_of(builder, arguments[1]):
            now = _value_and_slope(builder, coefficients, t)
            value, slope = (shifted(builder, *pair) for pair in zip(before, now, strict=True))
            dip = builder.fmul(half_part, builder.fsub(now[1], slope))
            turns = builder.and_(
                builder.fcmp_unordered('<', slope, zero), builder.fcmp_unordered('>', now[1], zero)
            )
            dip = builder.select(turns, dip, zero)
            lowest = builder.fsub(smaller(builder, value, now[0]), dip)
            low = builder.fcmp_unordered('<=', lowest, level)
            below = low if below is None else builder.or_(below, low)
            before = now
        bits = builder.bitcast(below, ir.IntType(LANES))
        return builder.icmp_unsigned('==', bits, ir.Constant(ir.IntType(LANES), 0))

    return types.boolean(series, h, level), generate
