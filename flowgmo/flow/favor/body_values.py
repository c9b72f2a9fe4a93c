"""Cells near a body, and what it covers of them, in one go where its sheets are planes and round ones.

    plane    d = n . x - h
    round    d = s (|w| - r),  w = x - c - a (a . (x - c))      a cylinder about the axis a; a ball with a = 0

The cells: blocks of 16^3, halved where the body's surface may pass, as in near_surface.py, with the largest of all
sheets for its distance (never more than it, so that nothing is missed).
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.favor.body_cut import MOST_SHEETS, NODES, cover_cell
from flowgmo.flow.favor.clip_square import MOST
from flowgmo.flow.favor.cut_cell import work_space
from flowgmo.flow.favor.near_surface import LARGEST, ROUNDING
from flowgmo.kernel import free_kernel, inner, kernel

PLANE = 4  # numbers of a plane: n (3), h
ROUND = 8  # numbers of a round sheet: c (3), a (3), r, s
FAR_WITHIN, FAR_BEYOND = -1, -2  # in place of a row: the sheet is farther from a cell than its corners
DEPTH = 64  # blocks that wait: 7 for each of 5 sizes, and one


@inner
def plane_value(sheet, x, y, z):
    """Distance to a plane."""
    return sheet[0] * x + sheet[1] * y + sheet[2] * z - sheet[3]


@inner
def round_value(sheet, x, y, z):
    """Distance to a round sheet."""
    wx = x - sheet[0]
    wy = y - sheet[1]
    wz = z - sheet[2]
    along = wx * sheet[3] + wy * sheet[4] + wz * sheet[5]
    wx -= along * sheet[3]
    wy -= along * sheet[4]
    wz -= along * sheet[5]
    return sheet[7] * (np.sqrt(wx * wx + wy * wy + wz * wz) - sheet[6])


@inner
def _largest(planes, rounds, x, y, z):
    """Largest value of all sheets."""
    most = -np.inf
    for m in range(len(planes)):
        most = max(most, plane_value(planes[m], x, y, z))
    for m in range(len(rounds)):
        most = max(most, round_value(rounds[m], x, y, z))
    return most


@inner
def _visit(planes, rounds, x, y, z, low, past, stack, index):
    """Paint blocks on the stack (DEPTH, 4), the top one first, and their halves: 1 near the surface, 2 inside.

    low, past (3,): cells at the first and beyond the last entry of index.
    """
    top = np.int64(1)
    while top > 0:
        top -= 1
        size = stack[top, 3]
        i0 = stack[top, 0]
        j0 = stack[top, 1]
        k0 = stack[top, 2]
        i1 = min(i0 + size, past[0])
        j1 = min(j0 + size, past[1])
        k1 = min(k0 + size, past[2])
        dx = x[i1] - x[i0]
        dy = y[j1] - y[j0]
        dz = z[k1] - z[k0]
        radius = 0.5 * ROUNDING * np.sqrt(dx * dx + dy * dy + dz * dz)
        d = _largest(planes, rounds, 0.5 * (x[i0] + x[i1]), 0.5 * (y[j0] + y[j1]), 0.5 * (z[k0] + z[k1]))
        if d > radius:
            continue
        if d < -radius:
            for i in range(i0 - low[0], i1 - low[0]):
                for j in range(j0 - low[1], j1 - low[1]):
                    for k in range(k0 - low[2], k1 - low[2]):
                        index[i, j, k] = 2
        elif size == 1:
            index[i0 - low[0], j0 - low[1], k0 - low[2]] = 1
        else:
            half = size // 2
            for part in range(8):
                i = i0 + half * (part // 4)
                j = j0 + half * (part // 2 % 2)
                k = k0 + half * (part % 2)
                if i < past[0] and j < past[1] and k < past[2]:
                    stack[top, 0] = i
                    stack[top, 1] = j
                    stack[top, 2] = k
                    stack[top, 3] = half
                    top += 1


@kernel
def paint_body(planes, rounds, x, y, z, low, past, index, counts):
    """Paint index, zeros before: 1 in cells near the surface, 2 inside; planes (m, 4), rounds (m, 8).

    x, y, z: planes of the cells; low, past (3,): the cells of the box. counts (2,) becomes the number of 1s, and of
    runs of 2s along z.
    """
    stack = np.empty((DEPTH, 4), np.int64)
    for i in range(low[0], past[0], LARGEST):
        for j in range(low[1], past[1], LARGEST):
            for k in range(low[2], past[2], LARGEST):
                stack[0, 0] = i
                stack[0, 1] = j
                stack[0, 2] = k
                stack[0, 3] = LARGEST
                _visit(planes, rounds, x, y, z, low, past, stack, index)
    count_painted(index, counts)


@inner
def count_painted(index, counts):
    """counts (2,): the number of 1s, and of runs of 2s along the last direction."""
    near = np.int64(0)
    runs = np.int64(0)
    for i in range(index.shape[0]):
        for j in range(index.shape[1]):
            before = 0
            for k in range(index.shape[2]):
                here = index[i, j, k]
                near += here == 1
                runs += here == 2 and before != 2
                before = here
    counts[0] = near
    counts[1] = runs


@inner
def _reaching(planes, rounds, x, y, z, cell, reached):
    """Numbers of the sheets that may be positive in a cell into reached (m,): planes, then rounds; how many of each."""
    i = 2 * cell[0] + 1
    j = 2 * cell[1] + 1
    k = 2 * cell[2] + 1
    hx = x[i + 1] - x[i]
    hy = y[j + 1] - y[j]
    hz = z[k + 1] - z[k]
    flat = np.int64(0)
    for m in range(len(planes)):
        p = planes[m]
        reach = abs(p[0]) * hx + abs(p[1]) * hy + abs(p[2]) * hz
        if plane_value(p, x[i], y[j], z[k]) >= -ROUNDING * reach:
            reached[flat] = m
            flat += 1
    count = flat
    reach = np.sqrt(hx * hx + hy * hy + hz * hz)
    for m in range(len(rounds)):
        if round_value(rounds[m], x[i], y[j], z[k]) >= -ROUNDING * reach:
            reached[count] = m
            count += 1
    return flat, count - flat


@inner
def _sheet_values(sheets, is_plane, x, y, z, cell, least, step, reached, first, last, values, count):
    """Append values (., NODES) of sheets reached[first:last] that are positive somewhere in a cell; the new count.

    step: 2 for nodes at the corners only.
    """
    for n in range(first, last):
        sheet = sheets[reached[n]]
        positive = False
        for i in range(0, 3, step):
            a = x[2 * cell[0] + i]
            for j in range(0, 3, step):
                b = y[2 * cell[1] + j]
                for k in range(0, 3, step):
                    c = z[2 * cell[2] + k]
                    d = plane_value(sheet, a, b, c) if is_plane else round_value(sheet, a, b, c)
                    d = 0.0 if abs(d) <= least else d
                    values[count, 9 * i + 3 * j + k] = d
                    positive |= d > 0.0
        count += positive
    return count


@inner
def _known_values(rows, at, known, c, least, values, count):
    """Append values (., NODES) of the sheets known at numbered nodes that are positive somewhere in cell c.

    Returns the new count, -1 where one of them is positive all over and far beyond.
    """
    for q in range(len(rows)):
        if rows[q, c] == FAR_BEYOND:
            return np.int64(-1)
        if rows[q, c] >= 0:
            positive = False
            for v in range(NODES):
                d = known[at[rows[q, c], v]]
                values[count, v] = 0.0 if abs(d) <= least else d
                positive |= values[count, v] > 0.0
            count += positive
    return count


@free_kernel
def cut_body(cells, x, y, z, planes, rounds, least, rows, at, known, covered):
    """covered (c, 7) of cells (c, 3) [without ghosts]: six faces, then volume [-].

    x, y, z: planes of half cells; least [length]: a distance that counts as 0. rows (q, c): for each sheet that is
    neither plane nor round the row of each cell in at (p, NODES), numbers of its nodes in known (v,) [length];
    FAR_WITHIN where the cell lies far on its negative side, FAR_BEYOND on the other.
    """
    work = work_space()
    values = np.empty((MOST_SHEETS, NODES))
    reached = np.empty(MOST_SHEETS, np.int64)
    ring = np.empty((2, MOST, 3))
    sums = np.empty((8, 8))
    fine = np.empty(7)
    coarse = np.empty(7)
    for c in range(len(cells)):
        a, b = _reaching(planes, rounds, x, y, z, cells[c], reached)
        step = 1 if b > 0 or len(rows) > 0 else 2
        flat = _sheet_values(planes, True, x, y, z, cells[c], least, step, reached, 0, a, values, np.int64(0))
        count = _sheet_values(rounds, False, x, y, z, cells[c], least, step, reached, a, a + b, values, flat)
        count = _known_values(rows, at, known, c, least, values, count)
        if count < 0:
            for part in range(7):
                covered[c, part] = 0.0
        else:
            cover_cell(work, ring, values, flat, count, sums, fine, coarse, covered[c])
