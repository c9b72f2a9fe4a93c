"""The two decorators of all compiled functions.

`kernel` is called from Python. `inner` is called from kernels only: without the wrappers that Python needs it
compiles in half the time (a scene's first start is mostly compilation). Tests call inner functions through a
kernel of their own.

Both are cached on disk (the package names the folder, see __init__). A division by zero gives infinity or nan, as in
numpy, and no exception: kernels test for what they need.
"""

from __future__ import annotations

from numba import njit

kernel = njit(cache=True, error_model="numpy")
inner = njit(cache=True, error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
