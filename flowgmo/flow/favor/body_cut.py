"""What one body covers of the cells near its surface, cut by all its sheets one after the other.

    covered   where all sheets are negative; of a face or of the volume
    a sheet that is nowhere positive at the nodes of a part does not cut it; one that is nowhere negative, and not zero
    all over, leaves nothing covered (a body's face in the plane of a cell's face covers that face)

Planes are exact with the corners as nodes. Parts that a curved sheet cuts are summed over the eight halves of the cell
and extrapolated (cell_parts.py). What is computed of a face depends on its own nodes only: both its cells agree.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.favor.cell_parts import extrapolated, node
from flowgmo.flow.favor.cut_cell import MOST_FIELDS, share_where_positive, work_space
from flowgmo.flow.favor.one_cut import area_of_one, volume_of_one
from flowgmo.kernel import inner, kernel

PIECES = 2  # halves of a cell in each direction, for curved sheets
NODES = 27  # of a cell in halves


@inner
def _part_node(part, i, j, k):
    """Node (i, j, k) of the cell (part 6), or (i, j) of one of its faces, whatever k."""
    level = PIECES * (part % 2)
    if part == 6:
        return node(i, j, k, PIECES)
    if part // 2 == 0:
        return node(level, i, j, PIECES)
    if part // 2 == 1:
        return node(i, level, j, PIECES)
    return node(i, j, level, PIECES)


@inner
def _load(work, values, count, part, i, j, k, step):
    """Put the sheets that cut the box of `step` nodes at (i, j, k) into the work space, with the covered side positive.

    Returns their number, -1 where nothing is covered.
    """
    cuts = np.int64(0)
    for corner in range(8):
        work.nodes[corner] = _part_node(
            part, i + step * (corner // 4), j + step * (corner // 2 % 2), k + step * (corner % 2)
        )
    for s in range(count):
        positive = np.int64(0)
        negative = np.int64(0)
        for corner in range(8):
            d = values[s, work.nodes[corner]]
            if d > 0.0:
                positive += 1
            elif d < 0.0:
                negative += 1
        if positive == 0:
            continue
        if negative == 0:
            return np.int64(-1)
        row = min(cuts, MOST_FIELDS - 1)
        for corner in range(8):
            inside = -values[s, work.nodes[corner]]
            work.fields[row, corner] = inside if cuts < MOST_FIELDS else min(inside, work.fields[row, corner])
        cuts += 1
    return min(cuts, MOST_FIELDS)


@inner
def _covered_by(work, values, count, part, step):
    """Covered share of a part, cut in boxes of `step` nodes."""
    total = 0.0
    for i in range(0, PIECES, step):
        for j in range(0, PIECES, step):
            for k in range(0, PIECES if part == 6 else step, step):
                cuts = _load(work, values, count, part, i, j, k, step)
                if cuts == 0:
                    total += 1.0
                elif cuts == 1:
                    for corner in range(8):  # what is open, so that zeros count as covered
                        work.fields[0, corner] = -work.fields[0, corner]
                    total += 1.0 - (volume_of_one(work.fields[0]) if part == 6 else area_of_one(work.fields[0]))
                elif cuts > 1:
                    total += share_where_positive(work, cuts, part != 6)
    n = PIECES // step
    return total / (n * n * n if part == 6 else n * n)


@inner
def _bent(values, planes, count, part):
    """Whether a curved sheet changes sign at the nodes of a part."""
    for s in range(planes, count):
        positive = False
        negative = False
        for i in range(PIECES + 1):
            for j in range(PIECES + 1):
                for k in range(PIECES + 1 if part == 6 else 1):
                    d = values[s, _part_node(part, i, j, k)]
                    positive |= d > 0.0
                    negative |= d < 0.0
        if positive and negative:
            return True
    return False


@inner
def _load_planes(values, n, h, x, y, z, cell, least):
    """Values (NODES,) of the planes that are positive somewhere in a cell; returns their number."""
    count = np.int64(0)
    for m in range(len(h)):
        positive = False
        for i in range(PIECES + 1):
            a = x[PIECES * cell[0] + i]
            for j in range(PIECES + 1):
                b = y[PIECES * cell[1] + j]
                for k in range(PIECES + 1):
                    d = n[m, 0] * a + n[m, 1] * b + n[m, 2] * z[PIECES * cell[2] + k] - h[m]
                    d = 0.0 if abs(d) <= least else d
                    values[count, node(i, j, k, PIECES)] = d
                    positive |= d > 0.0
        if positive:
            count += 1
    return count


@kernel
def number_nodes(cells, chosen, low, index, at, points):
    """Number the nodes of cells[chosen] (c, 3), each once; returns how many.

    low (3,): the node at index[0, 0, 0]; index: zeros, and zeros again on return; at (n, NODES) int32 becomes the number
    of each node of each chosen cell, points (m, 3) int32 where it lies among the planes of half cells.
    """
    count = np.int64(0)
    for n in range(len(chosen)):
        a = PIECES * cells[chosen[n], 0] - low[0]
        b = PIECES * cells[chosen[n], 1] - low[1]
        c = PIECES * cells[chosen[n], 2] - low[2]
        for v in range(NODES):
            i = a + v // 9
            j = b + v // 3 % 3
            k = c + v % 3
            if index[i, j, k] == 0:
                points[count, 0] = i + low[0]
                points[count, 1] = j + low[1]
                points[count, 2] = k + low[2]
                count += 1
                index[i, j, k] = count
            at[n, v] = index[i, j, k] - 1
    for m in range(count):
        index[points[m, 0] - low[0], points[m, 1] - low[1], points[m, 2] - low[2]] = 0
    return count


@kernel
def cut_body(cells, x, y, z, n, h, least, rows, at, values, covered):
    """covered (c, 7) of cells (c, 3) [without ghosts]: six faces, then volume [-].

    x, y, z: planes of half cells; n (m, 3), h (m,): planes of the body; least [length]: a distance that counts as 0.
    rows (q, c): for each curved sheet the row of each cell in at (p, NODES), numbers of its nodes in values (v,)
    [length]; -1 where the sheet is far beyond the cell, -2 where the cell is far beyond the sheet.
    """
    work = work_space()
    field = np.empty((len(h) + len(rows) + 1, NODES))
    for c in range(len(cells)):
        planes = _load_planes(field, n, h, x, y, z, cells[c], least)
        count = planes
        out = False
        for q in range(len(rows)):
            row = rows[q, c]
            out |= row == -2
            if row >= 0:
                for v in range(NODES):
                    d = values[at[row, v]]
                    field[count, v] = 0.0 if abs(d) <= least else d
                count += 1
        for part in range(7):
            if out:
                covered[c, part] = 0.0
                continue
            share = _covered_by(work, field, count, part, PIECES)
            if count > planes and _bent(field, planes, count, part):
                fine = _covered_by(work, field, count, part, 1)
                share = fine if fine == 0.0 or fine == 1.0 else 1.0 - extrapolated(1.0 - fine, 1.0 - share)
            covered[c, part] = share
