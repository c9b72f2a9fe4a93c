"""What one body covers of the cells near its surface, cut by all its sheets one after the other.

    covered   where all sheets are negative; of a face or of the volume
    a sheet that is nowhere positive at the nodes of a part does not cut it; one that is nowhere negative, and not zero
    all over, leaves nothing covered (a body's face in the plane of a cell's face covers that face)

Planes are exact with the corners as nodes. Parts that a curved sheet cuts are summed over the eight halves of the cell
and extrapolated (cell_parts.py). What is computed of a face depends on its own nodes only: both its cells agree.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.favor.cell_parts import extrapolated
from flowgmo.flow.favor.clip_square import area_of, clip, start_square
from flowgmo.flow.favor.cut_cell import add_wall, keep_positive, start_cell, volume_inside
from flowgmo.flow.favor.cut_halves import node_across, open_face, open_parts
from flowgmo.flow.favor.one_cut import volume_of_one
from flowgmo.kernel import inner

NODES = 27  # of a cell in halves


@inner
def part_node(face, a, b):
    """Node (a, b) of a face 0 .. 5."""
    return node_across(face // 2, 2 * (face % 2), a, b)


@inner
def _set_nodes(nodes, i, j, k, step):
    """The corners of the box of `step` nodes at (i, j, k)."""
    for corner in range(8):
        nodes[corner] = 9 * (i + step * (corner // 4)) + 3 * (j + step * (corner // 2 % 2)) + k + step * (corner % 2)


@inner
def _cutting_box(values, count, nodes):
    """How many sheets cut a box, -1 where nothing of it is covered, and the last of them."""
    cuts = np.int64(0)
    last = np.int64(0)
    for s in range(count):
        positive = False
        negative = False
        for corner in range(8):
            positive |= values[s, nodes[corner]] > 0.0
            negative |= values[s, nodes[corner]] < 0.0
        if positive and not negative:
            return np.int64(-1), last
        if positive:
            cuts += 1
            last = np.int64(s)
    return cuts, last


@inner
def _cut_box(work, values, count):
    """Covered share of the box of work.nodes, cut by one sheet after the other."""
    polygons = start_cell(work, False)
    for s in range(count):
        cuts = False
        for corner in range(8):
            work.fields[0, corner] = -values[s, work.nodes[corner]]
            cuts |= work.fields[0, corner] < 0.0
        if cuts:
            polygons, ends = keep_positive(work, polygons, work.fields[0])
            polygons = add_wall(work, polygons, ends)
    return volume_inside(work, polygons)


@inner
def _volume_by(work, values, count, step):
    """Covered share of the volume, cut by several sheets in boxes of `step` nodes."""
    total = 0.0
    for i in range(0, 2, step):
        for j in range(0, 2, step):
            for k in range(0, 2, step):
                _set_nodes(work.nodes, i, j, k, step)
                cuts, last = _cutting_box(values, count, work.nodes)
                if cuts == 0:
                    total += 1.0
                elif cuts == 1:
                    for corner in range(8):  # what is open, so that zeros count as covered
                        work.fields[0, corner] = values[last, work.nodes[corner]]
                    total += 1.0 - volume_of_one(work.fields[0])
                elif cuts > 0:
                    total += _cut_box(work, values, count)
    return total if step == 2 else 0.125 * total


@inner
def _square_by(ring, values, count, face, a, b, step):
    """Covered share of a square of a face, from node (a, b) on, cut by several sheets."""
    size = start_square(ring)
    here = 0
    for s in range(count):
        f00 = -values[s, part_node(face, a, b)]
        f10 = -values[s, part_node(face, a + step, b)]
        f11 = -values[s, part_node(face, a + step, b + step)]
        f01 = -values[s, part_node(face, a, b + step)]
        if f00 >= 0.0 and f10 >= 0.0 and f11 >= 0.0 and f01 >= 0.0:
            continue
        if f00 <= 0.0 and f10 <= 0.0 and f11 <= 0.0 and f01 <= 0.0:
            return 0.0
        size = clip(ring, here, size, f00, f10, f11, f01)
        here = 1 - here
    return area_of(ring, here, size)


@inner
def _face_by(ring, values, count, face, step):
    """Covered share of a face, cut by several sheets in squares of `step` nodes."""
    total = 0.0
    for a in range(0, 2, step):
        for b in range(0, 2, step):
            total += _square_by(ring, values, count, face, a, b, step)
    return total if step == 2 else 0.25 * total


@inner
def signs_volume(d, step):
    """Whether values (NODES,) are positive, and negative, at any node."""
    positive = False
    negative = False
    for i in range(0, 3, step):
        for j in range(0, 3, step):
            for k in range(0, 3, step):
                positive |= d[9 * i + 3 * j + k] > 0.0
                negative |= d[9 * i + 3 * j + k] < 0.0
    return positive, negative


@inner
def signs_face(d, face, step):
    """Whether values (NODES,) are positive, and negative, at any node of a face."""
    positive = False
    negative = False
    for a in range(0, 3, step):
        for b in range(0, 3, step):
            positive |= d[part_node(face, a, b)] > 0.0
            negative |= d[part_node(face, a, b)] < 0.0
    return positive, negative


@inner
def _cutting(values, planes, count, part):
    """How many sheets cut a part, -1 where nothing is covered; the last of them; whether one of them is curved.

    Planes are asked at the corners.
    """
    cuts = np.int64(0)
    last = np.int64(0)
    bent = False
    for s in range(count):
        step = 2 if s < planes else 1
        if part == 6:
            positive, negative = signs_volume(values[s], step)
        else:
            positive, negative = signs_face(values[s], part, step)
        if positive and not negative:
            return np.int64(-1), last, False
        if positive:
            cuts += 1
            last = np.int64(s)
            bent |= s >= planes
    return cuts, last, bent


@inner
def _joined(fine, coarse):
    """Covered share from both cuts; 0 and 1 stay."""
    return fine if fine == 0.0 or fine == 1.0 else 1.0 - extrapolated(1.0 - fine, 1.0 - coarse)


@inner
def cover_part(work, ring, values, planes, count, part):
    """Covered share of a part of a cell: where all values (count, NODES) are negative, the first `planes` of them of
    planes; ring (2, MOST, 3) is scratch."""
    cuts, last, bent = _cutting(values, planes, count, part)
    if cuts < 0:
        return 0.0
    if cuts == 0:
        return 1.0
    coarse = 0.0
    share = 0.0
    for twice in range(2):  # one call in a loop is compiled once
        step = 2 - twice
        if part == 6:
            share = _volume_by(work, values, count, step)
        elif cuts == 1:  # as the cell beyond sees it, which no other sheet may reach
            share = 1.0 - open_face(values[last], part, step)
        else:
            share = _face_by(ring, values, count, part, step)
        if not bent:
            break
        if twice == 0:
            coarse = share
    return _joined(share, coarse) if bent else share


@inner
def cover_by_one(values, planes, count, sums, fine, coarse, out):
    """out (7,): covered shares of the faces and the volume of a cell that one sheet cuts, values (1, NODES), or none.

    planes: 1 where it is a plane. sums (8, 8), fine (7,), coarse (7,): scratch.
    """
    if count == 0:
        for part in range(7):
            out[part] = 1.0
        return
    open_parts(values[0], 2, sums, coarse)
    if planes == 0:
        open_parts(values[0], 1, sums, fine)
    for part in range(7):
        out[part] = _joined(1.0 - fine[part], 1.0 - coarse[part]) if planes == 0 else 1.0 - coarse[part]
