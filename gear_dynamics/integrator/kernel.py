"""What kernels are written with."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numba
from numba.core import types
from numba.core.imputils import impl_ret_untracked
from numba.extending import intrinsic

from gear_dynamics.kernels import kernel

__all__ = ['borrowed', 'kernel', 'vector_code']


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
