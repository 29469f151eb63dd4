"""Polynomials and filters over eight numbers at once, by vector instructions.

Numba's own vectorizer does not see these short loops (measured: five to ten times slower), so
that they are written out as LLVM vector code. The arithmetic is multiply-add in a fixed order: the
same input gives the same bits wherever it stands.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic

from gear_dynamics.model.layout import AX1, HIGH_RATE_COLUMNS, ROWS, TAPS

LANES = 8

_DOUBLE = ir.DoubleType()
_INT = ir.IntType(64)
_VECTOR = ir.VectorType(_DOUBLE, LANES)


def _data(context: Any, builder: Any, kind: Any, value: Any) -> Any:
    return context.make_array(kind)(context, builder, value).data


def _at(builder: Any, data: Any, index: int) -> Any:
    return builder.gep(data, [ir.Constant(_INT, index)])


def _load(builder: Any, data: Any, index: int) -> Any:
    pointer = builder.bitcast(_at(builder, data, index), _VECTOR.as_pointer())
    return builder.load(pointer, align=8)


def _store(builder: Any, vector: Any, data: Any, index: int) -> None:
    pointer = builder.bitcast(_at(builder, data, index), _VECTOR.as_pointer())
    builder.store(vector, pointer, align=8)


def _spread(builder: Any, number: Any) -> Any:
    """Return a vector of eight times the same number."""
    one = builder.insert_element(ir.Constant(_VECTOR, ir.Undefined), number, ir.Constant(_INT, 0))
    first = ir.Constant(ir.VectorType(ir.IntType(32), LANES), [0] * LANES)
    return builder.shuffle_vector(one, ir.Constant(_VECTOR, ir.Undefined), first)


def _multiply_add(builder: Any, a: Any, b: Any, c: Any) -> Any:
    kind = ir.FunctionType(_VECTOR, [_VECTOR] * 3)
    function = cgutils.get_or_insert_function(builder.module, kind, 'llvm.fmuladd.v8f64')
    return builder.call(function, [a, b, c])


def _horner(builder: Any, coefficients: list[Any], times: list[Any]) -> list[tuple[Any, Any]]:
    """Return value and slope at each time of the polynomial with the given coefficient vectors."""
    points = [(coefficients[-1], ir.Constant(_VECTOR, [0.0] * LANES)) for _ in times]
    for vector in reversed(coefficients[:-1]):
        points = [
            (
                _multiply_add(builder, value, t, vector),
                _multiply_add(builder, slope, t, value),
            )
            for (value, slope), t in zip(points, times, strict=True)
        ]
    return points


def _columns(builder: Any, data: Any) -> list[Any]:
    return [_load(builder, data, LANES * k) for k in range(ROWS)]


@intrinsic
def columns_at(typing_context, series, t, out):
    """Put eight polynomials and their slopes at time t into rows 0 and 1 of `out`.

    series : (ROWS, 8) array; out : array with room for 16 numbers.
    """

    def generate(context, builder, signature, arguments):
        series_type, _, out_type = signature.args
        data = _data(context, builder, series_type, arguments[0])
        target = _data(context, builder, out_type, arguments[2])
        times = [_spread(builder, arguments[1])]
        ((value, slope),) = _horner(builder, _columns(builder, data), times)
        _store(builder, value, target, 0)
        _store(builder, slope, target, LANES)
        return context.get_dummy_value()

    return types.void(series, t, out), generate


@intrinsic
def columns_at_four(typing_context, series, t0, t1, t2, t3, out):
    """Put eight polynomials and their slopes at four times into eight rows of `out`.

    Rows 2 i and 2 i + 1 are values and slopes at the i-th time. Four at once keep the arithmetic
    units busy while each waits for its own last result.
    """

    def generate(context, builder, signature, arguments):
        data = _data(context, builder, signature.args[0], arguments[0])
        target = _data(context, builder, signature.args[5], arguments[5])
        times = [_spread(builder, t) for t in arguments[1:5]]
        points = _horner(builder, _columns(builder, data), times)
        for i, (value, slope) in enumerate(points):
            _store(builder, value, target, 2 * LANES * i)
            _store(builder, slope, target, (2 * i + 1) * LANES)
        return context.get_dummy_value()

    return types.void(series, t0, t1, t2, t3, out), generate


@intrinsic
def sixteenths(typing_context, polynomials, row, h, out):
    """Put a polynomial and its slope at h/16, 2h/16, ..., h into rows 0 and 1 of `out`.

    polynomials : (n, ROWS) array, of which the row is taken; out : (2, 16) array.
    """

    def generate(context, builder, signature, arguments):
        polynomials_type, row_type, _, out_type = signature.args
        data = _data(context, builder, polynomials_type, arguments[0])
        target = _data(context, builder, out_type, arguments[3])
        index = context.cast(builder, arguments[1], row_type, types.int64)
        data = builder.gep(data, [builder.mul(index, ir.Constant(_INT, ROWS))])
        whole = _spread(builder, arguments[2])
        times = []
        for half in range(2):
            parts = [(LANES * half + i + 1) / (2 * LANES) for i in range(LANES)]
            times.append(builder.fmul(ir.Constant(_VECTOR, parts), whole))
        coefficients = [_spread(builder, builder.load(_at(builder, data, k))) for k in range(ROWS)]
        for half, (value, slope) in enumerate(_horner(builder, coefficients, times)):
            _store(builder, value, target, half * LANES)
            _store(builder, slope, target, (2 + half) * LANES)
        return context.get_dummy_value()

    return types.void(polynomials, row, h, out), generate


@intrinsic
def weighted_sum(typing_context, weights, rows, first, out):
    """Put the weighted sum of sixteen numbers, from AX1 on, of TAPS rows into `out`.

    weights : (TAPS,) array; rows : (n, HIGH_RATE_COLUMNS) array, with room for one number more;
    first : the first row; out : array with room for 16 numbers.
    """

    def generate(context, builder, signature, arguments):
        weights_type, rows_type, first_type, out_type = signature.args
        weight = _data(context, builder, weights_type, arguments[0])
        data = _data(context, builder, rows_type, arguments[1])
        target = _data(context, builder, out_type, arguments[3])
        index = context.cast(builder, arguments[2], first_type, types.int64)
        data = builder.gep(data, [builder.mul(index, ir.Constant(_INT, HIGH_RATE_COLUMNS))])
        # Several sums of each half, so that none waits for its own last addition.
        halves = [[ir.Constant(_VECTOR, [0.0] * LANES)] * 4 for _ in range(2)]
        for k in range(TAPS):
            factor = _spread(builder, builder.load(_at(builder, weight, k)))
            for half, sums in enumerate(halves):
                vector = _load(builder, data, k * HIGH_RATE_COLUMNS + AX1 + half * LANES)
                sums[k % 4] = _multiply_add(builder, factor, vector, sums[k % 4])
        for half, (a, b, c, d) in enumerate(halves):
            total = builder.fadd(builder.fadd(a, b), builder.fadd(c, d))
            _store(builder, total, target, half * LANES)
        return context.get_dummy_value()

    return types.void(weights, rows, first, out), generate
