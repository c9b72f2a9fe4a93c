"""The decorators of all compiled functions.

`kernel` and `flow_kernel` are called from Python. `inner` is called from kernels only. Tests call inner functions
through a kernel of their own. Kernels are cached on disk (the package names the folder, see __init__). A division by
zero gives infinity or nan, as in numpy, and no exception: kernels test for what they need. compiler.py keeps their
first start short.
"""

from __future__ import annotations

import numba
from numba import njit

#: Versions of numba that compiler.py was tested with; with others compilation takes twice as long, and works.
TESTED = ("0.68",)


def pipelines(version: str) -> tuple[dict, dict, dict]:
    """Options that choose the compiler of kernels, of inner functions, and of kernels of the flow with this version of
    numba ("0.68.1")."""
    if ".".join(version.split(".")[:2]) not in TESTED:
        return {}, {}, {}
    from flowgmo.compiler import ApartCompiler, InnerCompiler, KernelCompiler

    return {"pipeline_class": KernelCompiler}, {"pipeline_class": InnerCompiler}, {"pipeline_class": ApartCompiler}


_of_kernel, _of_inner, _of_flow = pipelines(numba.__version__)
kernel = njit(cache=True, error_model="numpy", no_cfunc_wrapper=True, **_of_kernel)
inner = njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True, **_of_inner)
#: An inner function of which each kernel holds a copy: for what is done column by column with many arrays. A call hands
#: over seven numbers and more for each array, and does not know that arrays do not overlap: with 30 arrays a quarter of
#: advection's time.
inlined = njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True, forceinline=True, **_of_inner)
#: As `kernel`, and releases Python's lock: what threads share that needs arrays of its own.
free_kernel = njit(cache=True, error_model="numpy", no_cfunc_wrapper=True, nogil=True, **_of_kernel)
#: A kernel of the flow: releases Python's lock, so that threads share its columns; a * b + c may be one operation. It
#: makes no arrays, and does not count references to those that it was given (_nrt): counting them in every cell, for
#: each inner function, costs more than the work. What it writes it reads under the same name only: no two of its arrays
#: overlap (or only so that a loop reads and writes the same cell at once).
flow_kernel = njit(
    cache=True, error_model="numpy", no_cfunc_wrapper=True, nogil=True, fastmath={"contract"}, _nrt=False, **_of_flow
)
