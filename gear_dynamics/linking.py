"""Kernels as other kernels call them: linked in, and optimized there with the code around them.

Numba optimizes a function together with all that it calls, and makes machine code of it, even where
only other compiled functions call it: code that lies five calls deep was optimized five times, and
a first start took three times as long. Here a function that is called by a kernel is kept as plain
LLVM code. Optimized, and made machine code, is only what Python calls.
"""

from __future__ import annotations

import operator
from typing import Any

import llvmlite.binding
from numba.core import compiler, types
from numba.core.caching import CompileResultCacheImpl
from numba.core.codegen import JITCodeLibrary
from numba.core.registry import CPUDispatcher

code_of = operator.attrgetter('library')
"""The LLVM code of a compiled function."""


class Kernel(CPUDispatcher):
    """A compiled function, whose calls by other kernels go to a linked one of the same source."""

    def __init__(
        self, py_func: Any, locals: Any = None, targetoptions: Any = None, **others: Any
    ) -> None:
        super().__init__(py_func, locals or {}, targetoptions, **others)
        self.linked = _Linked(py_func, locals or {}, targetoptions, pipeline_class=_Compiler)

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Return what a call with arguments of these types gives, compiled if need be."""
        # One signature for all literal integers: LLVM finds the constants where it links.
        return self.linked.get_call_template(tuple(map(types.unliteral, args)), kws)

    def get_overload(self, signature: Any) -> Any:
        """Return what Numba knows the function of a signature by."""
        return self.linked.get_overload(signature)


class _Linked(CPUDispatcher):
    """Compiles a function for each signature that kernels call it with."""

    def add_overload(self, result: Any) -> None:
        if result.entry_point is None:
            result = result._replace(entry_point=_entry_point())
            code = code_of(result)
            self.targetctx.insert_user_function(result.entry_point, result.fndesc, [code])
        self.overloads[tuple(result.signature.args)] = result


def _entry_point() -> object:
    """Return what Numba knows a function by, in place of the machine code that there is none of."""
    return object()


class _Library(JITCodeLibrary):
    """LLVM code for linking alone: not optimized as a whole, and no machine code."""

    def _optimize_final_module(self) -> None:
        pass

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._finalized = True


class _Compiler(compiler.CompilerBase):
    """Numba's compiler up to LLVM code."""

    def define_pipelines(self) -> list:
        state = self.state
        state.flags.no_compile = True
        state.flags.no_cpython_wrapper = True
        state.flags.no_cfunc_wrapper = True
        state['library'] = _Library(state.targetctx.codegen(), state.func_id.func_qualname)
        return [compiler.DefaultPassBuilder.define_nopython_pipeline(state)]


class LinkedCacheImpl(CompileResultCacheImpl):
    """What Numba's cache keeps of a linked function: its LLVM code."""

    def get_filename_base(self, *names: str) -> str:
        """Return the beginning of its files' names."""
        return f'linked-{super().get_filename_base(*names)}'

    def reduce(self, result: Any) -> tuple:
        """Return what is kept of a function."""
        code = code_of(result)
        description = result.fndesc
        description.typemap = description.calltypes = None  # of the compiler; not to be pickled
        bits = code._get_module_for_linking().as_bitcode()
        return code.name, bits, description, result.signature

    def rebuild(self, context: Any, payload: tuple) -> Any:
        """Return the function again."""
        name, bits, description, signature = payload
        library = _Library(context.codegen(), name)
        library._final_module = llvmlite.binding.parse_bitcode(bits)
        library._finalize_final_module()
        return compiler.compile_result(
            target_context=context,
            entry_point=_entry_point(),
            library=library,
            fndesc=description,
            signature=signature,
            objectmode=False,
        )
