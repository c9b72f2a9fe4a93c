"""What one sheet leaves of a cell: all six faces and the volume at once, in one box or in eight halves of it.

As one_cut.py has it for each part by itself, but every square between two boxes, and every face, is cut once only. The
squares that the sheet does not touch cost nothing. Values d (27,) at the nodes of halves, index 9 i + 3 j + k; open is
where d > 0. In a square across an axis, a runs along the next axis and b along the one after it.
"""

from __future__ import annotations

from flowgmo.flow.favor.one_cut import cut_square
from flowgmo.kernel import inner


@inner
def node_across(axis, level, a, b):
    """Number of the node at (a, b) of the plane `level` across an axis."""
    if axis == 0:
        return 9 * level + 3 * a + b
    if axis == 1:
        return 9 * b + 3 * level + a
    return 9 * a + 3 * b + level


@inner
def open_square(d, axis, level, a, b, step):
    """cut_square of the square from (a, b) to (a + step, b + step), with answers at once where nothing is cut."""
    f0 = d[node_across(axis, level, a, b)]
    f1 = d[node_across(axis, level, a + step, b)]
    f2 = d[node_across(axis, level, a + step, b + step)]
    f3 = d[node_across(axis, level, a, b + step)]
    if f0 > 0.0 and f1 > 0.0 and f2 > 0.0 and f3 > 0.0:
        return 1.0, 0, 0.0, 0.0, 0.0, 0.0, 0.0
    if f0 <= 0.0 and f1 <= 0.0 and f2 <= 0.0 and f3 <= 0.0:
        return 0.0, 0, 0.0, 0.0, 0.0, 0.0, 0.0
    return cut_square(f0, f1, f2, f3)


@inner
def open_face(d, face, step):
    """Open share of face 0 .. 5, in squares of `step` nodes."""
    total = 0.0
    for a in range(0, 2, step):
        for b in range(0, 2, step):
            total += open_square(d, face // 2, 2 * (face % 2), a, b, step)[0]
    return total if step == 2 else 0.25 * total


@inner
def _add(sums, box, axis, side, square):
    """Add a square to the sums of the box that it bounds: areas, cuts, sum of e cross x, sum of ends."""
    area, cuts, turn, along, across, sum_a, sum_b = square
    sums[box, 0] += area
    if cuts == 0:
        return
    a = (axis + 1) % 3
    b = (axis + 2) % 3
    sums[box, 1] += cuts
    sums[box, 2 + axis] += turn if side == 1 else -turn
    sums[box, 2 + a] += 0.5 * across
    sums[box, 2 + b] += 0.5 * along
    sums[box, 5 + axis] += cuts if side == 1 else -cuts
    sums[box, 5 + a] += sum_a
    sums[box, 5 + b] += sum_b


@inner
def open_parts(d, step, sums, out):
    """out (7,): open shares of the six faces and the volume, cut in boxes of `step` nodes; sums (8, 8) is scratch."""
    boxes = 8 if step == 1 else 1
    for box in range(boxes):
        for v in range(8):
            sums[box, v] = 0.0
    for axis in range(3):
        for level in range(0, 3, step):
            total = 0.0
            for a in range(0, 2, step):
                for b in range(0, 2, step):
                    square = open_square(d, axis, level, a, b, step)
                    total += square[0]
                    if level > 0:
                        _add(sums, _box(axis, level - step, a, b), axis, 1, square)
                    if level < 2:
                        _add(sums, _box(axis, level, a, b), axis, 0, square)
            if level != 1:
                out[2 * axis + level // 2] = total if step == 2 else 0.25 * total
    volume = 0.0
    for box in range(boxes):
        wall = 0.0
        if sums[box, 1] > 0.0:
            wall = sums[box, 5] * sums[box, 2] + sums[box, 6] * sums[box, 3] + sums[box, 7] * sums[box, 4]
            wall /= 2.0 * sums[box, 1]
        volume += min(max((sums[box, 0] + wall) / 6.0, 0.0), 1.0)
    out[6] = volume if step == 2 else 0.125 * volume


@inner
def _box(axis, level, a, b):
    """Number 4 i + 2 j + k of the box at (level, a, b) of an axis."""
    if axis == 0:
        return 4 * level + 2 * a + b
    if axis == 1:
        return 4 * b + 2 * level + a
    return 4 * a + 2 * b + level
