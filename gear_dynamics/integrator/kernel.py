"""How the model's kernels are compiled."""

from __future__ import annotations

from typing import Any

import numba
from numba.core import types
from numba.core.imputils import impl_ret_untracked
from numba.extending import intrinsic

kernel = numba.njit(cache=True, error_model='numpy')
"""Decorator: compiled once and cached on disk; a division by zero gives inf as in NumPy, which
spares a test at each division. Never fastmath: chaotic runs must repeat to the last bit."""


@intrinsic
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
