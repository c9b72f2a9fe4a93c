"""Where in a cell the part is that a convex body of planes covers: its volume and first moments, exact.

The cell is cut by one plane after the other (cut_cell.py), and by a level, which leaves polygons that close. With
corners a, b, c of their triangles, seen from the middle of the cell,

    integral of xi - 1/2  =  sum of (a . b x c) / 6  (a + b + c) / 4         xi in 0 .. 1 along each direction
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.favor.cut_cell import MOST_FIELDS, add_wall, keep_positive, start_cell
from flowgmo.kernel import inner


@inner
def planes_through(planes, low, size, found):
    """How many of the planes (m, 4), n (3) and h, cut the cell between low and low + size, triples [length]; found
    (MOST_FIELDS,): their numbers, of no more than it holds. -1 of a cell that is nowhere on the inner side of one."""
    count = np.int64(0)
    for m in range(len(planes)):
        d = -planes[m, 3]
        reach = 0.0
        for e in range(3):
            half = 0.5 * size[e] * planes[m, e]
            d += planes[m, e] * low[e] + half
            reach += abs(half)
        if d >= reach:
            return np.int64(-1)
        if d > -reach:
            if count < MOST_FIELDS:
                found[count] = m
            count += 1
    return count


@inner
def _cut(work, polygons, m):
    """The polygons where work.fields[m] is positive; how many."""
    kept, ends = keep_positive(work, polygons, work.fields[m])
    return add_wall(work, kept, ends)


@inner
def cut_by_planes(work, planes, which, count, low, size):
    """Polygons in `work` around where all of planes[which[:count]] are negative, in a cell; how many. low, size: as
    above; count: up to MOST_FIELDS."""
    polygons = start_cell(work, False)
    for m in range(count):
        plane = planes[which[m]]
        for corner in range(8):
            d = plane[3] - plane[0] * low[0] - plane[1] * low[1] - plane[2] * low[2]
            d -= (corner // 4) * plane[0] * size[0]
            d -= (corner // 2 % 2) * plane[1] * size[1] + (corner % 2) * plane[2] * size[2]
            work.fields[m, corner] = d
        polygons = _cut(work, polygons, m)
    return polygons


@inner
def cut_by_level(work, polygons, d, up, h):
    """What of these polygons lies below the height h (of a cell, from its bottom) along direction d, up: 1 or -1; how
    many are left."""
    for corner in range(8):
        at = corner // 4 if d == 0 else (corner // 2 % 2 if d == 1 else corner % 2)
        work.fields[0, corner] = h - (at if up > 0.0 else 1 - at)
    return _cut(work, polygons, 0)


@inner
def moment_within(work, polygons, out):
    """out (3,) [-]: integral of xi - 1/2 over what is inside polygons that close."""
    out[0], out[1], out[2] = 0.0, 0.0, 0.0
    for p in range(polygons):
        ax, ay, az = work.corners[p, 0, 0] - 0.5, work.corners[p, 0, 1] - 0.5, work.corners[p, 0, 2] - 0.5
        for v in range(1, work.sizes[p] - 1):
            bx, by, bz = work.corners[p, v, 0] - 0.5, work.corners[p, v, 1] - 0.5, work.corners[p, v, 2] - 0.5
            cx, cy, cz = (
                work.corners[p, v + 1, 0] - 0.5,
                work.corners[p, v + 1, 1] - 0.5,
                work.corners[p, v + 1, 2] - 0.5,
            )
            part = (ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)) / 24.0
            out[0] += part * (ax + bx + cx)
            out[1] += part * (ay + by + cy)
            out[2] += part * (az + bz + cz)
