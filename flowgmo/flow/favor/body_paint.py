"""Cells near a body's surface, and inside it, where its sheets are planes and round ones.

Blocks of 16^3 cells, halved where the surface may pass, as in near_surface.py. For the distance the largest of a
piece's sheets, put together by min and max as pieces are: 0 on the surface, and nowhere steeper than distance, so
never more than it, and nothing is missed.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.favor.body_fold import COMPLEMENT, SOLID
from flowgmo.flow.favor.body_values import plane_value, round_value
from flowgmo.flow.favor.near_surface import LARGEST, ROUNDING
from flowgmo.kernel import free_kernel, inner

DEPTH = 64  # blocks that wait: 7 for each of 5 sizes, and one


@inner
def _least_distance(planes, rounds, side, roles, x, y, z, d):
    """A bound of the body's signed distance; d (s,) is scratch."""
    for m in range(len(planes)):
        d[m] = plane_value(planes[m], x, y, z)
    for m in range(len(rounds)):
        d[len(planes) + m] = round_value(rounds[m], x, y, z)
    least = np.inf
    for p in range(len(roles)):
        most = -np.inf
        for s in range(len(d)):
            if side[p, s] != 0:
                most = max(most, -side[p, s] * d[s])
        if roles[p] == SOLID:
            least = min(least, most)
        elif roles[p] == COMPLEMENT:
            least = min(least, -most)
        else:
            least = max(least, -most)
    return least


@inner
def _visit(planes, rounds, side, roles, x, y, z, low, past, stack, index, values):
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
        middle = 0.5 * (x[i0] + x[i1]), 0.5 * (y[j0] + y[j1]), 0.5 * (z[k0] + z[k1])
        d = _least_distance(planes, rounds, side, roles, middle[0], middle[1], middle[2], values)
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


@free_kernel
def paint_body(planes, rounds, side, roles, x, y, z, low, past, index, counts):
    """Paint index, zeros before: 1 in cells near the surface, 2 inside; planes (m, 4), rounds (q, 7).

    side (p, m + q), roles (p,): geometry/sheets_by_piece.py; x, y, z: planes of the cells; low, past (3,): the cells of
    the box. counts (2,) becomes the number of 1s, and of runs of 2s along z.
    """
    stack = np.empty((DEPTH, 4), np.int64)
    values = np.empty(side.shape[1])
    for i in range(low[0], past[0], LARGEST):
        for j in range(low[1], past[1], LARGEST):
            for k in range(low[2], past[2], LARGEST):
                stack[0, 0] = i
                stack[0, 1] = j
                stack[0, 2] = k
                stack[0, 3] = LARGEST
                _visit(planes, rounds, side, roles, x, y, z, low, past, stack, index, values)
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
