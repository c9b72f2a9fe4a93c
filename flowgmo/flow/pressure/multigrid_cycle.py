"""The work of one V-cycle on its levels: smooth, restrict, prolong; and all of it where levels are small.

Calling a kernel and waking threads costs some 10 µs, as much as smoothing some thousand cells: `cycle_below` goes down
and up the small levels in one call. They lie one behind the other in flat arrays.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.ahead import ask_ahead
from flowgmo.flow.columns import ONE
from flowgmo.flow.fields import G
from flowgmo.flow.layers import join_cells
from flowgmo.kernel import flow_kernel, inlined, inner

SWEEPS = 2  # red-black pairs before and after: with 1, 11 to 17 cycles in place of 6 to 9, and 1.5 times the time
LAST_SWEEPS = 8  # on the coarsest level, there and back: it holds at most 64 cells
TWO = np.uint64(2)
OFFSET, NX, NY, NZ, FIRST, LAST, FX, FY, FZ, ALONE = range(10)  # of a row of `table`
WORDS = 10


@inner
def _neighbours(bx, by, bz, p, i, j, k):
    """Sum of b p over the faces of a cell."""
    total = p[i, j, k] * np.float32(0.0)
    if bx is not None:
        total += bx[i - 1, j, k] * p[i - 1, j, k] + bx[i, j, k] * p[i + 1, j, k]
    if by is not None:
        total += by[i, j - 1, k] * p[i, j - 1, k] + by[i, j, k] * p[i, j + 1, k]
    if bz is not None:
        total += bz[i, j, k - ONE] * p[i, j, k - ONE] + bz[i, j, k] * p[i, j, k + ONE]
    return total


@inner
def first_of(columns, c, colour):
    """The lowest cell of a column that has a colour."""
    return columns[c, 2] + ((columns[c, 0] + columns[c, 1] + columns[c, 2] + colour) & 1)


@inlined
def _begin(columns, c, p, r, inverse, colour):
    """`begin` in one column."""
    i = columns[c, 0]
    j = columns[c, 1]
    for k in range(np.uint64(first_of(columns, c, colour)), np.uint64(columns[c, 3]), TWO):
        p[i, j, k] = inverse[i, j, k] * r[i, j, k]


@inlined
def _smooth(columns, c, p, r, bx, by, bz, inverse, colour):
    """`smooth` in one column."""
    i = columns[c, 0]
    j = columns[c, 1]
    for k in range(np.uint64(first_of(columns, c, colour)), np.uint64(columns[c, 3]), TWO):
        p[i, j, k] = inverse[i, j, k] * (r[i, j, k] + _neighbours(bx, by, bz, p, i, j, k))


@flow_kernel
def begin(columns, first, last, p, r, inverse, colour):
    """The first half sweep from p = 0: r over the diagonal in cells of a colour; the others are set by the second."""
    for c in range(first, last):
        ask_ahead(columns, c, last, p, 0, 0)
        ask_ahead(columns, c, last, r, 0, 0)
        ask_ahead(columns, c, last, inverse, 0, 0)
        _begin(columns, c, p, r, inverse, colour)


@flow_kernel
def smooth(columns, first, last, p, r, bx, by, bz, inverse, colour):
    """One half of a red-black Gauss-Seidel sweep for sum b (p - p_neighbour) = r."""
    for c in range(first, last):
        _smooth(columns, c, p, r, bx, by, bz, inverse, colour)


@flow_kernel
def restrict(columns, first, last, fx, fy, fz, alone, p, r, bx, by, bz, diagonal, coarse):
    """coarse = sum over the fx × fy × fz fine cells of r - A p. The columns are the coarse ones.

    alone: no cell has a neighbour of its own colour (as across joined sides an odd number of cells apart). Then only
    those of colour 0 count: the last half sweep has left nothing in the others.
    """
    nx, ny, nz = diagonal.shape
    for c in range(first, last):
        m = columns[c, 0]
        n = columns[c, 1]
        o0, o1 = np.uint64(columns[c, 2]), np.uint64(columns[c, 3])
        for o in range(o0, o1):
            coarse[m, n, o] = 0.0
        for i in range((m - G) * fx + G, min((m - G) * fx + G + fx, nx - G)):
            for j in range((n - G) * fy + G, min((n - G) * fy + G + fy, ny - G)):
                if alone and fz == 2:
                    _add_colour(m, n, o0, o1, i, j, p, r, bx, by, bz, diagonal, coarse)
                    continue
                for o in range(columns[c, 2], columns[c, 3]):
                    k0 = (o - G) * fz + G
                    k1 = min(k0 + fz, nz - G)
                    begin_k = np.uint64(k0 + ((i + j + k0) & 1) if alone else k0)
                    for k in range(begin_k, np.uint64(k1), TWO if alone else ONE):
                        if diagonal[i, j, k] != 0.0:
                            left = r[i, j, k] - diagonal[i, j, k] * p[i, j, k]
                            coarse[m, n, o] += left + _neighbours(bx, by, bz, p, i, j, k)


@inlined
def _add_colour(m, n, o0, o1, i, j, p, r, bx, by, bz, diagonal, coarse):
    """coarse += what one of the two fine cells of each coarse one in a fine column leaves, the one of colour 0.

    Beyond the mesh, where the last coarse cell may have one only, the diagonal is 0.
    """
    low = np.uint64(G + ((i + j + G) & 1))
    for o in range(o0, o1):
        k = (o - np.uint64(G)) * TWO + low
        left = r[i, j, k] - diagonal[i, j, k] * p[i, j, k] + _neighbours(bx, by, bz, p, i, j, k)
        coarse[m, n, o] += left if diagonal[i, j, k] != 0.0 else np.float32(0.0)


@flow_kernel
def prolong(columns, first, last, fx, fy, fz, alone, coarse, inverse, p):
    """p += coarse value over each liquid cell; alone: of colour 0, the next half sweep sets the others.

    The columns are the fine ones.
    """
    for c in range(first, last):
        i = columns[c, 0]
        j = columns[c, 1]
        m = (i - G) // fx + G
        n = (j - G) // fy + G
        for k in range(first_of(columns, c, 0) if alone else columns[c, 2], columns[c, 3], 2 if alone else 1):
            if inverse[i, j, k] != 0.0:
                p[i, j, k] += coarse[m, n, (k - G) // fz + G]


@inner
def _level(table, depth, flat):
    """A level's part of a flat array, as an array of its mesh; None of None, decided when compiled."""
    if flat is None:
        return None
    nx, ny, nz = table[depth, NX], table[depth, NY], table[depth, NZ]
    start = table[depth, OFFSET]
    return flat[start : start + nx * ny * nz].reshape((nx, ny, nz))


@inner
def _sweeps(times, begun, columns, first, last, p, r, bx, by, bz, inverse, colour, joined):
    """Half sweeps number `begun` to 2 times - 1, of which the first has a colour."""
    for n in range(begun, 2 * times):
        for c in range(first, last):
            _smooth(columns, c, p, r, bx, by, bz, inverse, (colour + n) & 1)
        join_cells(p, joined[0], joined[1], joined[2])


@flow_kernel
def cycle_below(table, columns, P, R, BX, BY, BZ, inverse, diagonal, joined):
    """The part of a V-cycle from the table's first level on: P of that level, for its R.

    table (levels, 10) int64: offset into the flat arrays, shape, rows of its columns, factors to the next level, alone.
    BX, BY, BZ: None in directions of one cell. joined (3,): periodic.
    """
    n = table.shape[0]
    for turn in range(2 * n - 1):  # down to n - 1, and up again
        down = turn < n
        at = turn if down else 2 * (n - 1) - turn
        p, r, d, v = _level(table, at, P), _level(table, at, R), _level(table, at, diagonal), _level(table, at, inverse)
        bx = _level(table, at, BX)
        by = _level(table, at, BY)
        bz = _level(table, at, BZ)
        first, last = table[at, FIRST], table[at, LAST]
        fx, fy, fz, alone = table[at, FX], table[at, FY], table[at, FZ], table[at, ALONE]
        if down:
            for c in range(first, last):
                _begin(columns, c, p, r, v, 0)
            join_cells(p, joined[0], joined[1], joined[2])
            _sweeps(LAST_SWEEPS if at == n - 1 else SWEEPS, 1, columns, first, last, p, r, bx, by, bz, v, 0, joined)
            if at < n - 1:
                below = _level(table, at + 1, R)
                restrict(
                    columns, table[at + 1, FIRST], table[at + 1, LAST], fx, fy, fz, alone, p, r, bx, by, bz, d, below
                )
        else:
            prolong(columns, first, last, fx, fy, fz, alone, _level(table, at + 1, P), v, p)
            join_cells(p, joined[0], joined[1], joined[2])
        if at == n - 1 or not down:
            _sweeps(LAST_SWEEPS if at == n - 1 else SWEEPS, 0, columns, first, last, p, r, bx, by, bz, v, 1, joined)
