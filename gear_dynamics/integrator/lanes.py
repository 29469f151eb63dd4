"""Weighted sums by vector instructions, and a rough logarithm."""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba.core import types

from gear_dynamics.integrator import plain
from gear_dynamics.integrator.kernel import vector_code
from gear_dynamics.integrator.layout import (
    AX1,
    HIGH_RATE_COLUMNS,
    PADDED_TAPS,
    TAPS,
)
from gear_dynamics.integrator.vector import (
    DOUBLE,
    INT,
    LANES,
    ahead,
    data_of,
    load,
    multiply_add,
    number_at,
    spread,
    store,
    sum_of_lanes,
    vector_of,
)
from gear_dynamics.machine.columns import SAMPLE_COLUMNS


@vector_code(plain.rough_log2)
def rough_log2(typing_context, number):
    """Return the logarithm to base 2 of a positive number to 0.09, from its bits."""

    def generate(context, builder, signature, arguments):
        bits = builder.sitofp(builder.bitcast(arguments[0], INT), DOUBLE)
        scaled = builder.fmul(bits, ir.Constant(DOUBLE, 2.0**-52))
        return builder.fsub(scaled, ir.Constant(DOUBLE, 1023.0))

    return types.float64(number), generate


@vector_code(plain.weighted_rows)
def weighted_rows(typing_context, weights, rows, first, out, row):
    """Put the weighted sum of the columns AX1 to SAMPLE_DELTA_DOT of TAPS rows into those of `out`.

    weights : (TAPS or more,) array; rows : (n, HIGH_RATE_COLUMNS) array; first : the first row of
    these; out : array of samples, and the row of it.
    """

    def generate(context, builder, signature, arguments):
        weight, data, target = (
            data_of(context, builder, signature.args[j], arguments[j]) for j in (0, 1, 3)
        )
        begin, end = (
            context.cast(builder, arguments[j], signature.args[j], types.int64) for j in (2, 4)
        )
        data = builder.gep(data, [ahead(builder, begin, HIGH_RATE_COLUMNS, AX1)])
        # Several sums, so that none waits for its own last addition.
        sums = [vector_of(0.0)] * 8
        for k in range(TAPS):
            factor = spread(builder, number_at(builder, weight, k))
            vector = load(builder, data, k * HIGH_RATE_COLUMNS)
            sums[k % 8] = multiply_add(builder, factor, vector, sums[k % 8])
        store(builder, _total(builder, sums), target, ahead(builder, end, len(SAMPLE_COLUMNS), AX1))
        return context.get_dummy_value()

    return types.void(weights, rows, first, out, row), generate


@vector_code(plain.weighted_line)
def weighted_line(typing_context, weights, numbers, first):
    """Return the weighted sum of as many numbers as there are weights, from an index on.

    weights : (PADDED_TAPS,) array; numbers : array.
    """

    def generate(context, builder, signature, arguments):
        weight = data_of(context, builder, signature.args[0], arguments[0])
        data = data_of(context, builder, signature.args[1], arguments[1])
        begin = context.cast(builder, arguments[2], signature.args[2], types.int64)
        data = builder.gep(data, [begin])
        sums = [vector_of(0.0)] * 4
        for k in range(0, PADDED_TAPS, LANES):
            j = k // LANES % 4
            pair = load(builder, weight, k), load(builder, data, k)
            sums[j] = multiply_add(builder, *pair, sums[j])
        return sum_of_lanes(builder, _total(builder, sums))

    return types.float64(weights, numbers, first), generate


def _total(builder: Any, sums: list[Any]) -> Any:
    while len(sums) > 1:
        sums = [builder.fadd(a, b) for a, b in zip(sums[::2], sums[1::2], strict=True)]
    return sums[0]
