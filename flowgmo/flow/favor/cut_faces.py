"""Which faces feel a solid.

Most faces of a mesh are far from solids: there the terms of the momentum equation need no open fractions and run as
long loops without branches. The others, `cut` faces, are listed and done one by one with all that FAVOR asks for. A
face of component c on cell P is

    closed   its own open area is 0: it gets no acceleration
    plain    P, the cell above it along c, and the neighbours of both along all directions are open to the full
    cut      all else
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flowgmo.flow.favor.changed_cells import merged, runs_around
from flowgmo.flow.fields import G, Open
from flowgmo.kernel import free_kernel, inner

Array = np.ndarray

#: Steps (in x, y, z) of the three directions, unsigned: numba then skips its test for negative indices, so that loops
#: over k vectorise.
STEPS = tuple(tuple(np.uint64(a == b) for b in range(3)) for a in range(3))
U64, ONE, TWO = np.uint64, np.uint64(1), np.uint64(2)


class CutFaces(NamedTuple):
    """plain: uint8 of mesh size, bit 1, 2, 4 set where the face of u, v, w is plain; None without solids.

    rows: for u, v, w the cut faces (n, 4) int32 as columns of one cell each (i, j, k, k + 1); None where absent.
    """

    plain: Array | None
    rows: tuple[Array | None, Array | None, Array | None]


NO_SOLIDS = CutFaces(None, (None, None, None))


OPEN = np.uint8(8)  # bit of a cell that is open to the full, upper faces too


@free_kernel
def _mark_open(columns, V, Ax, Ay, Az, plain):
    """plain = OPEN where the cell and its upper faces are open to the full, else 0, in the columns' cells."""
    for c in range(columns.shape[0]):
        i = U64(columns[c, 0])
        j = U64(columns[c, 1])
        for k in range(U64(columns[c, 2]), U64(columns[c, 3])):
            least = V[i, j, k]
            if Ax is not None:
                least = min(least, Ax[i, j, k])
            if Ay is not None:
                least = min(least, Ay[i, j, k])
            if Az is not None:
                least = min(least, Az[i, j, k])
            plain[i, j, k] = OPEN if least >= 1.0 else np.uint8(0)


@inner
def _clear(plain, i, j, k):
    """OPEN where a cell and its six neighbours are."""
    across = plain[i - ONE, j, k] & plain[i + ONE, j, k] & plain[i, j - ONE, k] & plain[i, j + ONE, k]
    return across & plain[i, j, k] & plain[i, j, k - ONE] & plain[i, j, k + ONE] & OPEN


@inner
def wet_face(F, i, j, k, ci, cj, ck):
    """Whether liquid touches a face; all do without a free surface."""
    if F is None:
        return True
    return max(F[i, j, k], F[i + ci, j + cj, k + ck]) > 0.0


@free_kernel
def _sort_faces(columns, A, ci, cj, ck, bit, plain):
    """Set `bit` of plain faces; returns the number of cut ones."""
    n = np.int64(0)
    for c in range(columns.shape[0]):
        i = U64(columns[c, 0])
        j = U64(columns[c, 1])
        for k in range(U64(columns[c, 2]), U64(columns[c, 3])):
            clear = _clear(plain, i, j, k) & _clear(plain, i + ci, j + cj, k + ck) != 0
            if A[i, j, k] > 0.0:
                plain[i, j, k] |= bit if clear else np.uint8(0)
                n += 0 if clear else 1
    return n


@free_kernel
def _list_cut(columns, A, bit, plain, rows):
    """rows (n, 4): the open faces without `bit`."""
    n = np.int64(0)
    for c in range(columns.shape[0]):
        i, j = columns[c, 0], columns[c, 1]
        for k in range(columns[c, 2], columns[c, 3]):
            if A[i, j, k] > 0.0 and (plain[i, j, k] & bit) == 0:
                rows[n, 0] = i
                rows[n, 1] = j
                rows[n, 2] = k
                rows[n, 3] = k + 1
                n += 1


def find_cut_faces(columns: Array, open: Open) -> CutFaces:
    """Sort the upper faces of all cells in columns (m, 4). Once for solids that stand still."""
    if open.V is None:
        return NO_SOLIDS
    nx, ny, nz = open.V.shape
    i, j = np.meshgrid(np.arange(nx), np.arange(ny), indexing="ij")
    every = np.column_stack([i.ravel(), j.ravel(), np.zeros(nx * ny), np.full(nx * ny, nz)]).astype(np.int32)
    plain = np.empty(open.V.shape, np.uint8)
    _mark_open(every, *open, plain)
    return CutFaces(plain, tuple(None if A is None else _cut(columns, A, c, plain) for c, A in enumerate(open[1:])))


def sort_again(before: CutFaces, open: Open, cells: Array, lines: Array) -> tuple[CutFaces, tuple[Array | None, ...]]:
    """As find_cut_faces of all real cells, where only cells (n, 3) [with ghosts, in C order], their lower faces, and
    the ghosts that are their images have changed since `before`, whose `plain` goes on; and for u, v, w where each row
    was before, -1: it was found anew. lines (nx, ny, 2) int32 zeros: scratch."""
    plain = before.plain
    around = runs_around(cells, plain, lines)
    _mark_open(around, *open, plain)
    inside = _real(around, plain.shape)
    found = [
        (None, None) if A is None else merged(rows, inside, _cut(inside, A, c, plain))
        for c, (A, rows) in enumerate(zip(open[1:], before.rows, strict=True))
    ]
    return CutFaces(plain, tuple(rows for rows, _ in found)), tuple(source for _, source in found)


def _cut(columns: Array, A: Array, c: int, plain: Array) -> Array:
    """The cut faces (n, 4) of component c in the columns, where `plain` gets the bit of the plain ones."""
    bit = np.uint8(1 << c)
    found = np.empty((_sort_faces(columns, A, *STEPS[c], bit, plain), 4), np.int32)
    _list_cut(columns, A, bit, plain, found)
    return found


def _real(columns: Array, shape: tuple[int, ...]) -> Array:
    """What columns hold of the real cells."""
    nx, ny, nz = shape
    out = columns[(columns[:, 0] >= G) & (columns[:, 0] < nx - G) & (columns[:, 1] >= G) & (columns[:, 1] < ny - G)]
    out[:, 2:] = out[:, 2:].clip(G, nz - G)
    return out[out[:, 2] < out[:, 3]]
