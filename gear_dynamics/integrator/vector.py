"""Vectors of eight numbers in LLVM code: what the vector kernels are made of.

Numba's own vectorizer does not see the short loops of a series (measured: five to ten times
slower), so that they are written out as LLVM vector code. The arithmetic is multiply-add in a fixed
order: the same input gives the same bits wherever it stands.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba.core import cgutils

LANES = 8

DOUBLE = ir.DoubleType()
INT = ir.IntType(64)
_VECTOR = ir.VectorType(DOUBLE, LANES)


def data_of(context: Any, builder: Any, kind: Any, value: Any) -> Any:
    """Return the pointer to an array's numbers."""
    return context.make_array(kind)(context, builder, value).data


def place(builder: Any, data: Any, index: Any) -> Any:
    """Return the pointer to a number of an array."""
    return builder.gep(data, [ir.Constant(INT, index) if isinstance(index, int) else index])


def ahead(builder: Any, index: Any, times: int, plus: int) -> Any:
    """Return  times index + plus."""
    scaled = builder.mul(index, ir.Constant(INT, times))
    return builder.add(scaled, ir.Constant(INT, plus))


def number_at(builder: Any, data: Any, index: Any) -> Any:
    """Return one number of an array."""
    return builder.load(place(builder, data, index))


def load(builder: Any, data: Any, index: Any) -> Any:
    """Return the eight numbers of an array from an index on."""
    pointer = builder.bitcast(place(builder, data, index), _VECTOR.as_pointer())
    return builder.load(pointer, align=8)


def store(builder: Any, vector: Any, data: Any, index: Any) -> None:
    """Put a vector into an array from an index on."""
    pointer = builder.bitcast(place(builder, data, index), _VECTOR.as_pointer())
    builder.store(vector, pointer, align=8)


def vector_of(*numbers: float) -> Any:
    """Return the vector of eight constants, or of eight times the same one."""
    return ir.Constant(_VECTOR, list(numbers) if len(numbers) > 1 else list(numbers) * LANES)


def _shuffled(builder: Any, vector: Any, lanes: list[int]) -> Any:
    mask = ir.Constant(ir.VectorType(ir.IntType(32), LANES), lanes)
    return builder.shuffle_vector(vector, ir.Constant(_VECTOR, ir.Undefined), mask)


def spread(builder: Any, number: Any) -> Any:
    """Return a vector of eight times the same number."""
    one = builder.insert_element(ir.Constant(_VECTOR, ir.Undefined), number, ir.Constant(INT, 0))
    return _shuffled(builder, one, [0] * LANES)


def shifted(builder: Any, before: Any, vector: Any) -> Any:
    """Return the lanes of a vector moved up by one, after the last lane of the one before."""
    lanes = ir.Constant(ir.VectorType(ir.IntType(32), LANES), list(range(LANES - 1, 2 * LANES - 1)))
    return builder.shuffle_vector(before, vector, lanes)


def smaller(builder: Any, a: Any, b: Any) -> Any:
    """Return the smaller of each two lanes."""
    return builder.select(builder.fcmp_ordered('<', a, b), a, b)


def multiply_add(builder: Any, a: Any, b: Any, c: Any = None) -> Any:
    """Return a b + c, or a b without c."""
    if c is None:
        return builder.fmul(a, b)
    kind = ir.FunctionType(_VECTOR, [_VECTOR] * 3)
    function = cgutils.get_or_insert_function(builder.module, kind, 'llvm.fmuladd.v8f64')
    return builder.call(function, [a, b, c])


def sum_of_lanes(builder: Any, vector: Any) -> Any:
    """Return the sum of the lanes as a number."""
    for step in (4, 2, 1):
        other = _shuffled(builder, vector, [(j + step) % LANES for j in range(LANES)])
        vector = builder.fadd(vector, other)
    return builder.extract_element(vector, ir.Constant(ir.IntType(32), 0))
