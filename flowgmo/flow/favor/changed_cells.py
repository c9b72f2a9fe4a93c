"""Tables that are kept sorted where open fractions have changed: what lies around changed cells, and nothing else.

Bodies change the cells near their surfaces, some thousands among millions. What was sorted by the open fractions of a
cell and of its neighbours (which faces feel a solid, which lines of cells are joined) stays true elsewhere:

    runs_around     the changed cells and what lies within REACH of them, as columns (columns.py), several in a line
    merge_rows      rows found anew there take the places of the old ones, in the order of a pass over all cells

so that the tables are the same, bit by bit, as if all had been sorted anew. The cost goes with the changed cells and
with the length of the tables.
"""

from __future__ import annotations

import numpy as np

from flowgmo.kernel import free_kernel, inner

Array = np.ndarray

#: Cells in each direction. A cell's own fractions and those of its lower faces (-1) change, and the ghosts that are
#: their images (3 from a cell at most); the faces of the momentum equation look at their two cells and the neighbours
#: of these, faces included (-2 to 2).
REACH = 3
MARKED = np.uint8(16)  # bit of the scratch that is not used otherwise


@free_kernel
def _mark_around(cells, by, marks, lines):
    """Set MARKED in all cells within `by` of cells (n, 3) in C order; lines [i, j] = (k0, k1) that hold them."""
    nx, ny, nz = marks.shape
    n = np.int64(0)
    while n < len(cells):
        i = np.int64(cells[n, 0])
        j = np.int64(cells[n, 1])
        low = np.int64(cells[n, 2])
        high = low + 1
        n += 1
        while n < len(cells) and cells[n, 0] == i and cells[n, 1] == j and cells[n, 2] <= high + by:
            high = np.int64(cells[n, 2]) + 1
            n += 1
        low = max(low - by, 0)
        high = min(high + by, nz)
        for a in range(max(i - by, 0), min(i + by + 1, nx)):
            for b in range(max(j - by, 0), min(j + by + 1, ny)):
                if lines[a, b, 1] == 0:
                    lines[a, b, 0] = low
                    lines[a, b, 1] = high
                else:
                    lines[a, b, 0] = min(lines[a, b, 0], low)
                    lines[a, b, 1] = max(lines[a, b, 1], high)
                for k in range(low, high):
                    marks[a, b, k] |= MARKED


@free_kernel
def _collect(low, past, marks, lines, out):
    """Columns of the marked cells into out (n, 4), as far as it reaches; returns how many there are.

    low, past (2,): lines that may hold any. When all fit, marks and lines are as before the marking.
    """
    count = np.int64(0)
    for i in range(low[0], past[0]):
        for j in range(low[1], past[1]):
            inside = False
            for k in range(lines[i, j, 0], lines[i, j, 1]):
                here = marks[i, j, k] & MARKED != 0
                if here and not inside:
                    count += 1
                    if count <= len(out):
                        out[count - 1, 0] = i
                        out[count - 1, 1] = j
                        out[count - 1, 2] = k
                if here and count <= len(out):
                    out[count - 1, 3] = k + 1
                inside = here
    if count <= len(out):
        for n in range(count):
            for k in range(out[n, 2], out[n, 3]):
                marks[out[n, 0], out[n, 1], k] &= ~MARKED
            lines[out[n, 0], out[n, 1], 0] = 0
            lines[out[n, 0], out[n, 1], 1] = 0
    return count


def runs_around(cells: Array, marks: Array, lines: Array) -> Array:
    """Columns (n, 4) int32, ghosts included, of all cells within REACH of cells (m, 3) [with ghosts] in C order.

    marks (mesh) uint8, lines (nx, ny, 2) int32 zeros: scratch, as they were on return.
    """
    if not len(cells):
        return np.empty((0, 4), np.int32)
    _mark_around(cells, REACH, marks, lines)
    low = np.maximum(cells[:, :2].min(axis=0).astype(np.int64) - REACH, 0)
    past = np.minimum(cells[:, :2].max(axis=0).astype(np.int64) + REACH + 1, marks.shape[:2])
    out = np.empty((2 * int(np.prod(past - low)), 4), np.int32)
    count = _collect(low, past, marks, lines, out)
    if count > len(out):
        out = np.empty((count, 4), np.int32)
        _collect(low, past, marks, lines, out)
    return out[:count].copy()


@inner
def _before(a, b, c, i, j, k):
    """Whether (a, b, c) comes before (i, j, k) in C order."""
    return a < i or (a == i and (b < j or (b == j and c < k)))


@free_kernel
def merge_rows(old, columns, new, out, source):
    """out (m, 4): rows of old (n, 4) outside the columns, and new (k, 4), which lie in them, in C order.

    source (m,): where a row was in old, -1 of new ones. Returns how many there are.
    """
    count = np.int64(0)
    c = np.int64(0)
    n = np.int64(0)
    for r in range(len(old) + 1):
        i = np.int64(old[r, 0]) if r < len(old) else np.int64(2**31)
        j = np.int64(old[r, 1]) if r < len(old) else np.int64(0)
        k = np.int64(old[r, 2]) if r < len(old) else np.int64(0)
        while n < len(new) and _before(new[n, 0], new[n, 1], new[n, 2], i, j, k):
            for part in range(4):
                out[count, part] = new[n, part]
            source[count] = -1
            count += 1
            n += 1
        while c < len(columns) and _before(columns[c, 0], columns[c, 1], columns[c, 3] - 1, i, j, k):
            c += 1
        kept = r < len(old) and not (
            c < len(columns) and columns[c, 0] == i and columns[c, 1] == j and columns[c, 2] <= k
        )
        if kept:
            for part in range(4):
                out[count, part] = old[r, part]
            source[count] = r
            count += 1
    return count


def merged(old: Array, columns: Array, new: Array) -> tuple[Array, Array]:
    """Rows (m, 4) and their source (m,), see merge_rows."""
    out = np.empty((len(old) + len(new), 4), np.int32)
    source = np.empty(len(out), np.int64)
    count = merge_rows(old, columns, new, out, source)
    return out[:count].copy(), source[:count]
