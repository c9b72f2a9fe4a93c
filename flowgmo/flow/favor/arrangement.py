"""A cell divided by all sheets that run through it into parts that lie on one side of each.

A sheet is a smooth field by its values at the nodes of the cell; it cuts where it changes sign. m sheets divide the
cell into up to 2^m parts, told apart by the side of each sheet on which they lie,

    part(mask) = points where  s_n f_n > 0  for all n,     s_n = -1 where bit n of mask is set, else 1

and each is cut from the cell as in cut_cell.py. What fills a part is asked at its centroid (cell_shares.py): so any
number of bodies that meet, overlap, or have edges in the cell are told apart without a rule for each case, and the
volumes are exact where the sheets are planes. Sheets that are the same in a cell, from either side, cut once.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.favor.cell_parts import corner_node
from flowgmo.flow.favor.cut_cell import (
    MOST_FIELDS,
    add_wall,
    area_inside,
    keep_positive,
    start_cell,
    volume_inside,
    work_space,
)
from flowgmo.kernel import inner, kernel

SAME = 1e-10  # of a sheet's largest value in the cell: closer sheets are one; a tenth of the 1e-9 asked of volumes
NOTHING = 1e-15  # of the cell: a smaller part is rounding
NEVER, ALWAYS = -1, -2  # a sheet that does not cut: negative nowhere, or everywhere


@inner
def _sign(values, p, nodes, flat):
    """1 if row p changes sign at the eight nodes, else NEVER or ALWAYS negative; a face in it is behind it."""
    above = False
    below = False
    for corner in range(8):
        value = values[p, nodes[corner]]
        above = above or value > 0.0
        below = below or value < 0.0
    if above and below:
        return 1
    return ALWAYS if below or (flat and not above) else NEVER


@inner
def _same(values, p, q, nodes):
    """1 if rows p and q are one sheet, -1 if they are it from both sides, up to their scale; 0 else."""
    largest = 0.0
    other = 0.0
    for corner in range(8):
        largest = max(largest, abs(values[p, nodes[corner]]))
        other = max(other, abs(values[q, nodes[corner]]))
    along = 0.0
    against = 0.0
    for corner in range(8):
        a = values[p, nodes[corner]] / largest
        b = values[q, nodes[corner]] / other
        along = max(along, abs(a - b))
        against = max(against, abs(a + b))
    return 1 if along <= SAME else (-1 if against <= SAME else 0)


@inner
def find_cuts(values, first, last, nodes, cuts, slot, flat):
    """Which rows first .. last - 1 cut: cuts (MOST_FIELDS,) their numbers, the count is returned, -1 if there are more.

    slot (2, last - first) of each row: number of its cut, or NEVER, ALWAYS; 1 where it is that cut's negative.
    """
    count = np.int64(0)
    more = False
    for p in range(first, last):
        r = p - first
        slot[1, r] = 0
        slot[0, r] = _sign(values, p, nodes, flat)
        if slot[0, r] < 0:
            continue
        slot[0, r] = count
        for n in range(count):
            like = _same(values, p, cuts[n], nodes)
            if like != 0:
                slot[0, r] = n
                slot[1, r] = 1 if like < 0 else 0
                break
        if slot[0, r] < count:
            continue
        if count == MOST_FIELDS:
            more = True
            slot[0, r] = NEVER
            continue
        cuts[count] = p
        count += 1
    return np.int64(-1) if more else count


@inner
def cut_part(work, values, cuts, count, mask, flat):
    """Cut the part `mask` out of the cell, or of its face z = 1 where flat; returns its number of polygons, 0: none."""
    polygons = start_cell(work, flat)
    for n in range(count):
        negative = (mask >> n) & 1
        for corner in range(8):
            value = values[cuts[n], work.nodes[corner]]
            work.fields[n, corner] = -value if negative else value
        polygons, ends = keep_positive(work, polygons, work.fields[n])
        if polygons == 0:
            return polygons
        if not flat:
            polygons = add_wall(work, polygons, ends)
    return polygons


@inner
def _centroid(work, polygons, flat, at):
    """at (3,) = centroid, reckoned from the mean corner, so that it lies within a part however thin that is."""
    for axis in range(3):
        corners = np.int64(0)
        at[axis] = 0.0
        for p in range(polygons):
            for v in range(work.sizes[p]):
                at[axis] += work.corners[p, v, axis]
            corners += work.sizes[p]
        at[axis] /= corners
    whole = 0.0
    x = 0.0
    y = 0.0
    z = 0.0
    for p in range(polygons):
        for v in range(1, work.sizes[p] - 1):
            ax = work.corners[p, 0, 0] - at[0]
            ay = work.corners[p, 0, 1] - at[1]
            az = work.corners[p, 0, 2] - at[2]
            bx = work.corners[p, v, 0] - at[0]
            by = work.corners[p, v, 1] - at[1]
            bz = work.corners[p, v, 2] - at[2]
            cx = work.corners[p, v + 1, 0] - at[0]
            cy = work.corners[p, v + 1, 1] - at[1]
            cz = work.corners[p, v + 1, 2] - at[2]
            if flat:
                piece = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
            else:
                piece = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
            whole += piece
            x += piece * (ax + bx + cx)
            y += piece * (ay + by + cy)
            z += piece * (az + bz + cz)
    share = (
        1.0 / 3.0 if flat else 0.25
    )  # of a triangle's and of a tetrahedron's corners, the last of which is the origin
    if whole > 0.0:
        at[0] += share * x / whole
        at[1] += share * y / whole
        at[2] += share * z / whole


@inner
def set_nodes(work, part, box, step, pieces):
    """work.nodes: the corners of box number `box` among the (pieces / step)^2 or ^3 of a part of the cell."""
    n = pieces // step
    i = step * (box // (n * n)) if part == 6 else step * (box // n)
    j = step * (box // n % n) if part == 6 else step * (box % n)
    k = step * (box % n) if part == 6 else 0
    for corner in range(8):
        work.nodes[corner] = corner_node(
            part, i + step * (corner // 4), j + step * (corner // 2 % 2), k + step * (corner % 2), pieces
        )
    return i, j, k


@inner
def _place(part, side, i, j, k, step, pieces, inner, at):
    """at (3,) = point in unit cells, from the one `inner` (3,) in the box at (i, j, k)."""
    a = (i + step * inner[0]) / pieces
    b = (j + step * inner[1]) / pieces
    if part == 6:
        at[0] = a
        at[1] = b
        at[2] = (k + step * inner[2]) / pieces
        return
    axis = part // 2
    at[axis] = side
    at[0 if axis > 0 else 1] = a
    at[2 if axis < 2 else 1] = b


@kernel
def measure_below(starts, values, cell, where, step, pieces, low, size, up, height, below):
    """below (q,): share of the cell that parts (cell, where: as of divide_cells) hold below the plane up . x = height.

    low, size (c, 3) [length]: lowest corner and widths of cells.
    """
    work = work_space()
    cuts = np.empty(MOST_FIELDS, np.int64)
    plane = np.empty(8)
    most = np.int64(1)
    for c in range(len(starts) - 1):
        most = max(most, starts[c + 1] - starts[c])
    slot = np.empty((2, most), np.int64)
    n = pieces // step
    for q in range(len(cell)):
        c = cell[q]
        i, j, k = set_nodes(work, 6, where[q, 0], step, pieces)
        count = find_cuts(values, starts[c], starts[c + 1], work.nodes, cuts, slot, False)
        count = np.int64(MOST_FIELDS) if count < 0 else count
        polygons = cut_part(work, values, cuts, count, where[q, 1], False)
        for corner in range(8):
            x = low[c, 0] + size[c, 0] * (i + step * (corner // 4)) / pieces
            y = low[c, 1] + size[c, 1] * (j + step * (corner // 2 % 2)) / pieces
            z = low[c, 2] + size[c, 2] * (k + step * (corner % 2)) / pieces
            plane[corner] = height - (up[0] * x + up[1] * y + up[2] * z)
        polygons, ends = keep_positive(work, polygons, plane)
        below[q] = 0.0
        if polygons > 0:
            polygons = add_wall(work, polygons, ends)
            below[q] = volume_inside(work, polygons) / (n * n * n)


@kernel
def count_parts(starts, values, part, step, pieces, counts):
    """counts (c, boxes): parts that each box of each cell may have, 2^cuts; -1 where more than MOST_FIELDS cut."""
    work = work_space()
    cuts = np.empty(MOST_FIELDS, np.int64)
    most = np.int64(1)
    for c in range(len(starts) - 1):
        most = max(most, starts[c + 1] - starts[c])
    slot = np.empty((2, most), np.int64)
    for c in range(counts.shape[0]):
        for box in range(counts.shape[1]):
            set_nodes(work, part, box, step, pieces)
            found = find_cuts(values, starts[c], starts[c + 1], work.nodes, cuts, slot, part != 6)
            counts[c, box] = np.int64(1) << found if found >= 0 else -1


@kernel
def divide_cells(starts, values, part, step, pieces, slots, cell, where, share, centre, inside, signs):
    """All parts (q) of cells: cell (q,), share (q,) of the cell's part, centre (q, 3) in unit cells; returns how many.

    where (q, 2): number of its box, and its mask.

    starts (c + 1,), values (p, nodes): the sheets of each cell. slots (p,): -1, or the bit of `inside` (q,) that tells
    whether the part lies where the sheet is negative; signs (q,): the same for all sheets of the cell, bit by bit in
    their order, as far as an int64 goes. More than MOST_FIELDS cuts: the first ones.
    """
    work = work_space()
    cuts = np.empty(MOST_FIELDS, np.int64)
    within = np.empty(3)
    most = np.int64(1)
    for c in range(len(starts) - 1):
        most = max(most, starts[c + 1] - starts[c])
    slot = np.empty((2, most), np.int64)
    n = pieces // step
    boxes = n * n * n if part == 6 else n * n
    found = np.int64(0)
    for c in range(len(starts) - 1):
        for box in range(boxes):
            i, j, k = set_nodes(work, part, box, step, pieces)
            count = find_cuts(values, starts[c], starts[c + 1], work.nodes, cuts, slot, part != 6)
            count = np.int64(MOST_FIELDS) if count < 0 else count
            for mask in range(1 << count):
                polygons = cut_part(work, values, cuts, count, mask, part != 6)
                if polygons == 0:
                    continue
                measure = volume_inside(work, polygons) if part == 6 else area_inside(work, polygons)
                if not measure > NOTHING:
                    continue
                _centroid(work, polygons, part != 6, within)
                cell[found] = c
                where[found, 0] = box
                where[found, 1] = mask
                share[found] = measure / boxes
                _place(part, float(part % 2), i, j, k, step, pieces, within, centre[found])
                inside[found] = 0
                signs[found] = 0
                for p in range(starts[c], starts[c + 1]):
                    r = p - starts[c]
                    negative = slot[0, r] == ALWAYS
                    if slot[0, r] >= 0:
                        negative = ((mask >> slot[0, r]) & 1) != slot[1, r]
                    if negative and slots[p] >= 0:
                        inside[found] |= np.int64(1) << slots[p]
                    if negative and r < 62:
                        signs[found] |= np.int64(1) << r
                found += 1
    return found
