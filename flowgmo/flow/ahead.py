"""Values are asked for before they are needed.

A mesh's arrays are larger than what a processor keeps near it. Each column of cells begins somewhere else in memory, so
that its first values are on their way for as long as a hundred cells take to compute; the processor sees that only as
far ahead as two or three short columns. A kernel that reads several arrays and does little with them waits most of its
time: u + dt a of 129 000 faces in columns of 17 takes .53 ms, of which .11 are computing. Where it asks for what the
column AHEAD of it will need, it takes .3 ms. Nothing is read by that, so that it may lie outside of the array.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from flowgmo.kernel import inner

AHEAD = 10  # columns: with 2 the case above takes .40 ms, with 4 .33, with 10 and 16 .30 and .27 (measured)
LINE = 8  # values of 8 bytes that come together: 64 bytes


@intrinsic
def ask_for(typing: Any, a: Any, i: Any, j: Any, k: Any) -> tuple:
    """Ask for a[i, j, k], to be read and kept: llvm.prefetch."""

    def emit(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        array = context.make_array(a)(context, builder, values[0])
        at = [context.cast(builder, v, t, types.intp) for v, t in zip(values[1:], signature.args[1:], strict=True)]
        place = cgutils.get_item_pointer(context, builder, a, array, at)
        bytes_at, flag = builder.bitcast(place, ir.IntType(8).as_pointer()), ir.IntType(32)
        kind = ir.FunctionType(ir.VoidType(), [bytes_at.type, flag, flag, flag])
        ask = builder.module.declare_intrinsic("llvm.prefetch", [bytes_at.type], kind)
        builder.call(ask, [bytes_at, flag(0), flag(3), flag(1)])  # to read, to keep, data
        return context.get_dummy_value()

    return types.void(a, i, j, k), emit


@inner
def ask_ahead(columns, c, last, a, m, n):
    """Ask for a (mesh) in the column AHEAD of column c, of those before `last`, or in the line (m, n) beside it.

    Nothing where a is None.
    """
    if a is None:
        return
    to = min(c + AHEAD, last - 1)
    i, j = np.int64(columns[to, 0]) + m, np.int64(columns[to, 1]) + n
    for k in range(np.int64(columns[to, 2]), np.int64(columns[to, 3]) + LINE - 1, LINE):
        ask_for(a, i, j, k)


@inner
def ask_ahead_where(columns, c, last, a, lines):
    """ask_ahead of column c where lines (mesh without z) of the column ahead is not 0."""
    to = min(c + AHEAD, last - 1)
    i, j = np.int64(columns[to, 0]), np.int64(columns[to, 1])
    if lines[i, j] != 0:
        for k in range(np.int64(columns[to, 2]), np.int64(columns[to, 3]) + LINE - 1, LINE):
            ask_for(a, i, j, k)
