"""How a first start is kept short: numba's compiler pipeline, arranged for many small functions.

A first start is compilation and little else. Left alone, numba makes every function into finished machine code, with
everything it calls inside it: a function five calls deep is optimised and emitted six times. What is different here, in
seconds of one core for two boxes that fall on a floor, numba 0.68 (others at work on the machine: within 2 s each):

    inner functions stop after their own code; a kernel links all it needs, is optimised and emitted once    49 -> 34
    no garbage collection while a kernel compiles                                                            34 -> 32
    the type of an operation on operands of given types is looked up once, not for each `+`                  32 -> 29
    passes that find nothing to do in inner functions are left out; no wrapper for C around kernels          29 -> 27

The machine code is as fast, the results are the same bits. All of it uses numba's own hooks: a compiler pipeline of
our own (`pipeline_class`), which brings the library that holds the code and the context that knows types. Hooks change
between versions of numba: kernel.py takes these with the versions they were tested with, numba's own with others.
"""

from __future__ import annotations

import gc
from typing import Any, ClassVar

from numba import types
from numba.core import typed_passes as typed
from numba.core import untyped_passes as untyped
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler
from numba.core.compiler_machinery import PassManager
from numba.core.typing import Context

#: What an inner function needs; the others of numba's passes look for closures, `with`, literal loops, array
#: expressions, and generators of exceptions, and rebuild the function's graph each.
INNER_PASSES = (
    untyped.TranslateByteCode,
    untyped.FixupArgs,
    untyped.IRProcessing,
    untyped.RewriteSemanticConstants,
    untyped.DeadBranchPrune,  # `x is None`
    untyped.GenericRewrites,
    untyped.ReconstructSSA,
    untyped.DeadBranchPrune,
    typed.NopythonTypeInference,
    typed.PreLowerStripPhis,
    typed.IRLegalization,
    typed.AnnotateTypes,
    typed.NativeLowering,
    typed.NoPythonBackend,
)


class _Library(JITCodeLibrary):
    """The code of a kernel: it takes in the code of all inner functions that it needs, directly or not."""

    def add_linking_library(self, library: JITCodeLibrary) -> None:
        """Callers stand before what they call: the linker takes from a library what was asked for by then, no more."""
        library._ensure_finalized()
        if getattr(library, "alone", library) in self._linking_libraries:
            return
        new = [library]
        if isinstance(library, _InnerLibrary):
            new = [library.alone, *library._linking_libraries]
        moved = set(new)
        self._linking_libraries = [one for one in self._linking_libraries if one not in moved] + new


class _InnerLibrary(_Library):
    """The code of an inner function: never optimised, emitted, or run by itself."""

    def __init__(self, codegen: Any, name: str) -> None:
        super().__init__(codegen, name)
        self.alone = _Alone(self)
        self._whole = None

    def _get_module_for_linking(self) -> Any:
        """With all that it needs: for a caller that numba compiles as usual (@njit in a test)."""
        if self._whole is None:
            self._whole = self.alone._get_module_for_linking().clone()
            for one in self._linking_libraries:
                self._whole.link_in(one._get_module_for_linking(), preserve=True)
        return self._whole

    def finalize(self) -> None:
        self._raise_if_finalized()
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        return 0  # numba's word for: not there

    @property
    def codegen(self) -> _NoEnvironment:
        return _NoEnvironment()


class _Alone:
    """What a kernel links of an inner function: the function without what it calls."""

    def __init__(self, library: _InnerLibrary) -> None:
        self.library = library
        self._reload_init = library._reload_init

    def _get_module_for_linking(self) -> Any:
        return JITCodeLibrary._get_module_for_linking(self.library)


class _NoEnvironment:
    """Where numba hands a function its Python constants (for printing, say): there is no place yet, none are used."""

    def set_env(self, name: str, env: object) -> None:
        pass


class _Types(Context):
    """numba's typing context with a memory: which signature a function has for given types of arguments."""

    __slots__ = ("how",)
    known: ClassVar[dict] = {}

    def __init__(self, context: Context, flags: Any) -> None:
        self.__dict__ = context.__dict__
        self.how = (flags.error_model, flags.nrt, flags.boundscheck, flags.auto_parallel.enabled)

    def resolve_function_type(self, func: Any, args: tuple, kws: dict) -> Any:
        own = isinstance(func, types.Type) and not isinstance(func, types.Function)  # compiled functions know theirs
        if own or kws or not all(isinstance(arg, types.Type) for arg in args):
            return super().resolve_function_type(func, args, kws)
        key = (func, args, self.how)
        found = self.known.get(key)
        if found is None:
            found = super().resolve_function_type(func, args, kws)
            if found is not None:
                self.known[key] = found
        return found


class KernelCompiler(Compiler):
    """numba's pipeline with our library and types, without garbage collection."""

    library = _Library

    def compile_extra(self, func: Any) -> Any:
        collects = gc.isenabled()
        gc.disable()
        try:
            return super().compile_extra(func)
        finally:
            if collects:
                gc.enable()

    def define_pipelines(self) -> list[PassManager]:
        state = self.state
        state.typingctx = _Types(state.typingctx, state.flags)
        state.library = self.library(state.targetctx.codegen(), state.func_id.func_qualname)
        state.library.enable_object_caching()
        return self.passes()

    def passes(self) -> list[PassManager]:
        return super().define_pipelines()


class ApartCompiler(KernelCompiler):
    """The same for kernels whose arrays do not overlap: loops need not look whether what one writes another one reads.

    Without it numba's machine code compares the addresses of all arrays before each loop, so once a column, and with
    more than a few arrays it does not vectorise at all.
    """

    def compile_extra(self, func: Any) -> Any:
        self.state.flags.noalias = True
        return super().compile_extra(func)


class InnerCompiler(KernelCompiler):
    """The same for inner functions, with their passes."""

    library = _InnerLibrary

    def passes(self) -> list[PassManager]:
        manager = PassManager("inner")
        for one in INNER_PASSES:
            manager.add_pass(one, one.__name__)
        manager.finalize()
        return [manager]
