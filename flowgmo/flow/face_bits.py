"""Bits of the faces or cells of a mesh's vertical lines: one word holds 64 of them.

    face k of a line                bit k & 63 of word k / 64 + 1
    first and last word             empty, so that what lies beside a face may be asked for without a test

So 64 faces are compared with their neighbours at once, and those that were found are visited one by one, without a look
at the others: `first_bit` of what is left, then take it away.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from flowgmo.flow.columns import ONE
from flowgmo.kernel import inner

SHIFT, LAST = np.uint64(6), np.uint64(63)  # 2^6 faces in a word, the place of its last one
NO_BIT, ALL = np.uint64(0), np.uint64(2**64 - 1)


@intrinsic
def first_bit(typing: Any, word: Any) -> tuple:
    """Place (0 to 63) of the lowest bit that is set in a word, which is not 0: llvm.cttz."""

    def emit(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        return builder.cttz(values[0], ir.IntType(1)(1))

    return types.uint64(types.uint64), emit


def make_bits(shape: tuple[int, int, int]) -> np.ndarray:
    """Bits, none set, for a mesh of this shape: (nx, ny, words) uint64."""
    nx, ny, nz = shape
    return np.zeros((nx, ny, (nz - 1) // 64 + 3), np.uint64)


@inner
def words_of(k0, k1):
    """(first, last) of the words that hold the faces k0 <= k < k1; range(first, last)."""
    return (np.uint64(k0) >> SHIFT) + ONE, ((np.uint64(k1) - ONE) >> SHIFT) + ONE + ONE


@inner
def start_of(word):
    """The face of a word's first bit."""
    return (word - ONE) << SHIFT


@inner
def within(word, k0, k1):
    """Bits of a word that are faces k0 <= k < k1, of which it holds at least one."""
    start = start_of(word)
    low, high = max(np.uint64(k0), start) - start, min(np.uint64(k1) - ONE, start + LAST) - start
    return (ALL << low) & (ALL >> (LAST - high))


@inner
def window(bits, i, j, k):
    """The bits of faces k to k + 63 of a line; k + 64 in place of k, so that those below the mesh can be asked for."""
    word, place = k >> SHIFT, k & LAST
    return (bits[i, j, word] >> place) | ((bits[i, j, word + ONE] << ONE) << (LAST - place))
