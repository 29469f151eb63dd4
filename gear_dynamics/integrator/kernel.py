"""What kernels are written with."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numba
from numba.core import types
from numba.core.imputils import impl_ret_untracked
from numba.extending import intrinsic
from numba.np import arrayobj

from gear_dynamics.kernels import kernel

__all__ = ['borrowed', 'kernel', 'part_of', 'vector_code']


def vector_code(plain: Callable) -> Callable:
    """Decorate a function that generates vector instructions, where `plain` says what they do.

    Where nothing is compiled, `plain` takes its place.
    """
    return lambda generator: plain if numba.config.DISABLE_JIT else intrinsic(generator)


@vector_code(lambda array: array)
def borrowed(typing_context, array):
    """Return the array without its reference count, for use while the caller holds the array.

    Counting references from function to function was a third of the cost of a step.
    """

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        view = context.make_array(array)(context, builder, arguments[0])
        view.meminfo = context.get_constant_null(types.MemInfoPointer(types.voidptr))
        view.parent = context.get_constant_null(types.pyobject)
        return impl_ret_untracked(context, builder, array, view._getvalue())

    return array(array), generate


def _plain_part_of(data, begin, count, dtype):
    return data[begin : begin + count * dtype.itemsize].view(dtype)


@vector_code(_plain_part_of)
def part_of(typing_context, data, begin, count, dtype):
    """Return `count` items of a dtype that stand in an array of bytes from an index on.

    A view without a reference count: the caller holds the array. (Slices and their `view` cost a
    kernel 50 ns.)
    """

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        source = context.make_array(signature.args[0])(context, builder, arguments[0])
        first, size = (
            context.cast(builder, arguments[i], signature.args[i], types.intp) for i in (1, 2)
        )
        kind = signature.return_type
        item = context.get_constant(
            types.intp, context.get_abi_sizeof(context.get_data_type(kind.dtype))
        )
        view = context.make_array(kind)(context, builder)
        arrayobj.populate_array(
            view,
            data=builder.bitcast(builder.gep(source.data, [first]), view.data.type),
            shape=(size,),
            strides=(item,),
            itemsize=item,
            meminfo=None,
        )
        return impl_ret_untracked(context, builder, kind, view._getvalue())

    kind = types.Array(dtype.dtype, 1, 'C')
    return kind(data, begin, count, dtype), generate
