"""Columns: which cells a kernel visits.

One row (i, j, k0, k1) for each vertical line of cells in which anything is marked, from the lowest to above the
highest marked cell. Water lies in few long vertical runs, so that the loop over k stays long and without branches, and
dry air costs nothing. Cells in between that are not marked have zero coefficients, or are tested by the kernel.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.fields import G
from flowgmo.kernel import flow_kernel, inner, kernel

#: A loop over k runs with unsigned k: numba then needs no test for negative indices, and LLVM vectorises. Neighbours
#: are k - ONE and k + ONE, since unsigned and plain numbers together would be floats.
ONE = np.uint64(1)


@kernel
def columns_where(marked, lowest):
    """Columns (n, 4) int32 of the real cells with marked[i, j, k] > lowest."""
    nx, ny, nz = marked.shape
    out = np.empty(((nx - 2 * G) * (ny - 2 * G), 4), np.int32)
    n = np.int64(0)
    for i in range(G, nx - G):
        for j in range(G, ny - G):
            bottom, top = np.int64(nz), np.int64(-1)
            for k in range(G, nz - G):  # without an early end: the loop vectorises, and most columns are dry
                found = marked[i, j, k] > lowest
                bottom = min(bottom, k if found else nz)
                top = max(top, k if found else -1)
            if top >= 0:
                out[n, 0] = i
                out[n, 1] = j
                out[n, 2] = bottom
                out[n, 3] = top + 1
                n += 1
    return out[:n].copy()


@kernel
def columns_among(columns, marked, lowest):
    """The same of real cells that given columns hold, some of which may be ghosts: where no others can be marked.

    From both ends of each column to the first marked cell: most are marked.
    """
    nx, ny, nz = marked.shape
    out = np.empty((len(columns), 4), np.int32)
    n = np.int64(0)
    for c in range(len(columns)):
        i = columns[c, 0]
        j = columns[c, 1]
        if i < G or i >= nx - G or j < G or j >= ny - G:
            continue
        bottom, top = max(np.int64(columns[c, 2]), G), min(np.int64(columns[c, 3]), nz - G)
        while bottom < top and not marked[i, j, bottom] > lowest:
            bottom += 1
        while bottom < top and not marked[i, j, top - 1] > lowest:
            top -= 1
        if bottom < top:
            out[n, 0] = i
            out[n, 1] = j
            out[n, 2] = bottom
            out[n, 3] = top
            n += 1
    return out[:n].copy()


@kernel
def widen(columns, by, shape, out):
    """Columns that also hold all cells within `by` cells (in each direction) of the given ones.

    shape (3,) of the arrays with ghosts; out (shape[0], shape[1], 2) int32: [i, j] becomes (k0, k1), k1 <= k0 where
    there is none. Real cells only.
    """
    return _widened(columns, by, shape, np.int64(G), out)


@kernel
def widen_beyond(columns, by, shape, out):
    """The same with the first layer of ghosts."""
    return _widened(columns, by, shape, np.int64(G - 1), out)


@inner
def _widened(columns, by, shape, border, out):
    """As `widen`, of all cells but `border` layers at each side.

    A table of (-k0, k1) makes both ends a largest value, along j and then along i.
    """
    nx, ny, nz = shape
    along, across = np.empty((nx, 2 * ny), np.int32), out.reshape((nx, 2 * ny))
    for i in range(nx):
        for m in range(0, 2 * ny, 2):
            across[i, m] = -nz
            across[i, m + 1] = 0
    for c in range(columns.shape[0]):
        across[columns[c, 0], 2 * columns[c, 1]] = -max(columns[c, 2] - by, border)
        across[columns[c, 0], 2 * columns[c, 1] + 1] = min(columns[c, 3] + by, nz - border)
    for i in range(nx):
        for m in range(2 * ny):
            along[i, m] = across[i, m]
        for step in range(2, 2 * by + 1, 2):
            for m in range(2 * ny - step):
                along[i, m] = max(along[i, m], across[i, m + step])
            for m in range(step, 2 * ny):
                along[i, m] = max(along[i, m], across[i, m - step])
    n = np.int64(0)
    for i in range(nx):
        inside = border <= i and i < nx - border
        for m in range(0, 2 * ny, 2):
            across[i, m] = -nz
            across[i, m + 1] = 0
        for near in range(max(i - by, 0), min(i + by + 1, nx) if inside else 0):
            for m in range(2 * border, 2 * (ny - border)):
                across[i, m] = max(across[i, m], along[near, m])
        for m in range(0, 2 * ny, 2):
            across[i, m] *= -1
            n += across[i, m] < across[i, m + 1]
    wide = np.empty((n, 4), np.int32)
    n = np.int64(0)
    for i in range(nx):
        for j in range(ny):
            if out[i, j, 0] < out[i, j, 1]:
                wide[n, 0] = i
                wide[n, 1] = j
                wide[n, 2] = out[i, j, 0]
                wide[n, 3] = out[i, j, 1]
                n += 1
    return wide


def all_columns(shape: tuple[int, int, int]) -> np.ndarray:
    """Columns of every real cell of arrays with this shape (with ghosts)."""
    i, j = np.meshgrid(np.arange(G, shape[0] - G), np.arange(G, shape[1] - G), indexing="ij")
    ends = np.broadcast_to([G, shape[2] - G], (i.size, 2))
    return np.column_stack([i.ravel(), j.ravel(), ends]).astype(np.int32)


def cells_in(columns: np.ndarray) -> int:
    """Number of cells that the columns hold."""
    return int((columns[:, 3] - columns[:, 2]).sum())


@kernel
def extent_of(columns, shape):
    """(3, 2) int64: the first and one past the last cell of the columns along each direction; shape (3,) of the mesh
    with ghosts, in place of the first where there are none."""
    ends = np.zeros((3, 2), np.int64)
    ends[:, 0] = shape
    for c in range(columns.shape[0]):
        for d in range(3):
            low = columns[c, d]
            high = columns[c, 3] if d == 2 else low + 1
            ends[d, 0], ends[d, 1] = min(ends[d, 0], low), max(ends[d, 1], high)
    return ends


@kernel
def columns_under(columns, factors, ends):
    """Columns of the coarse cells that hold the given fine ones; factors (fx, fy, fz).

    ends (nx, ny, 2) int32 of the coarse mesh: [i, j] becomes (k0, k1), the same as a table; (0, 0) where there is none.
    """
    fx, fy, fz = factors
    nx, ny, _ = ends.shape
    ends[...] = 0
    n = np.int64(0)
    for c in range(columns.shape[0]):
        i = (columns[c, 0] - G) // fx + G
        j = (columns[c, 1] - G) // fy + G
        bottom = (columns[c, 2] - G) // fz + G
        top = (columns[c, 3] - 1 - G) // fz + G + 1
        if ends[i, j, 1] == 0:
            n += 1
            ends[i, j, 0] = bottom
            ends[i, j, 1] = top
        else:
            ends[i, j, 0] = min(ends[i, j, 0], bottom)
            ends[i, j, 1] = max(ends[i, j, 1], top)
    out = np.empty((n, 4), np.int32)
    n = np.int64(0)
    for i in range(nx):
        for j in range(ny):
            if ends[i, j, 1] > 0:
                out[n, 0] = i
                out[n, 1] = j
                out[n, 2] = ends[i, j, 0]
                out[n, 3] = ends[i, j, 1]
                n += 1
    return out


@kernel
def tabulate(columns, ends):
    """ends [i, j] = (k0, k1) of the columns; (0, 0) where there is none."""
    ends[...] = 0
    for c in range(columns.shape[0]):
        ends[columns[c, 0], columns[c, 1], 0] = columns[c, 2]
        ends[columns[c, 0], columns[c, 1], 1] = columns[c, 3]


@flow_kernel
def clear_left(columns, first, last, ends, a):
    """Zero in those of the columns' cells that new columns do not hold; ends [i, j] = (k0, k1) of these."""
    for c in range(first, last):
        i = columns[c, 0]
        j = columns[c, 1]
        low = columns[c, 2]
        high = columns[c, 3]
        for k in range(low, max(min(high, ends[i, j, 0]), low) if ends[i, j, 1] > ends[i, j, 0] else high):
            a[i, j, k] = 0.0
        for k in range(max(low, ends[i, j, 1]), high):
            a[i, j, k] = 0.0
