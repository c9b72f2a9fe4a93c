"""What a body that is one convex piece bounded by planes covers of cells near it: a box, a wedge, a prism.

As body_values.py has it for any body, in closed form where one or two planes cut a cell, which are nearly all cells.

A face that one plane cuts is open by a triangle, a quadrangle or what a triangle leaves, told by the signs of the plane
at its corners. Of a cell the covered part C is convex, with faces of areas a in the cell's, and of areas A_s in the
planes'. In units of the cell, with plane s where e_s + g_s . (xi - middle) = 0 (negative inside the body),

    sum over its faces of (outer normal) area = 0     so that   sum of l_s g_s = -(a[x+] - a[x-], ..), l_s = A_s / |g_s|
    3 |C| = sum of (distance from the middle) area    so that   |C| = (sum of a) / 6 - (sum of l_s e_s) / 3

One plane has l from the projection on g; two have both from the normal equations, but where they are nearly parallel
(APART), as the sides of a thin plate in one cell. Those and cells of three planes are cut as any are (body_cut.py).
What is computed of a face depends on the planes at its own corners only: both its cells agree.

Which cells are cut is told line by line: with r half the cell's extent along the normal of plane s, all cells beyond
d_s > r of one plane are free of the body, and those with d_s < -r of all planes are inside.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.favor.body_cut import NODES, cover_part
from flowgmo.flow.favor.body_paint import count_painted
from flowgmo.flow.favor.clip_square import MOST, area_of, clip, start_square
from flowgmo.flow.favor.cut_cell import work_space
from flowgmo.flow.favor.cut_halves import node_across
from flowgmo.flow.favor.near_surface import ROUNDING
from flowgmo.flow.favor.one_cut import cut_square
from flowgmo.kernel import free_kernel, inner

APART = 0.01  # [-] squared sine of the angle between two planes: with less, rounding grows a hundredfold


@inner
def _corner_share(f, after, before):
    """Share of a square where a linear value is positive: at one corner only, f, with neighbours after and before."""
    return 0.5 * (f / (f - after)) * (f / (f - before))


@inner
def open_share(f0, f1, f2, f3):
    """Share of the unit square where a linear value is positive, from its corners in turn."""
    p0, p1, p2, p3 = f0 > 0.0, f1 > 0.0, f2 > 0.0, f3 > 0.0
    n = np.int64(p0) + np.int64(p1) + np.int64(p2) + np.int64(p3)
    if n == 0:
        return 0.0
    if n == 4:
        return 1.0
    if n == 1:
        if p0:
            return _corner_share(f0, f1, f3)
        if p1:
            return _corner_share(f1, f2, f0)
        return _corner_share(f2, f3, f1) if p2 else _corner_share(f3, f0, f2)
    if n == 3:
        if not p0:
            return 1.0 - _corner_share(f0, f1, f3)
        if not p1:
            return 1.0 - _corner_share(f1, f2, f0)
        return 1.0 - (_corner_share(f2, f3, f1) if not p2 else _corner_share(f3, f0, f2))
    if p0 and p1:
        return 0.5 * (f0 / (f0 - f3) + f1 / (f1 - f2))
    if p1 and p2:
        return 0.5 * (f1 / (f1 - f0) + f2 / (f2 - f3))
    if p2 and p3:
        return 0.5 * (f2 / (f2 - f1) + f3 / (f3 - f0))
    if p3 and p0:
        return 0.5 * (f3 / (f3 - f2) + f0 / (f0 - f1))
    return cut_square(f0, f1, f2, f3)[0]  # opposite corners, by rounding


@inner
def _corners_of_face(values, s, face):
    """Values of plane s at the corners of a face, in turn."""
    axis, level = face // 2, 2 * (face % 2)
    return (
        values[s, node_across(axis, level, 0, 0)],
        values[s, node_across(axis, level, 2, 0)],
        values[s, node_across(axis, level, 2, 2)],
        values[s, node_across(axis, level, 0, 2)],
    )


@inner
def _covered_face(values, count, face, ring):
    """Covered share of a face by `count` planes."""
    cuts, last = np.int64(0), np.int64(0)
    for s in range(count):
        f = _corners_of_face(values, s, face)
        positive = f[0] > 0.0 or f[1] > 0.0 or f[2] > 0.0 or f[3] > 0.0
        if positive and not (f[0] < 0.0 or f[1] < 0.0 or f[2] < 0.0 or f[3] < 0.0):
            return 0.0
        if positive:
            cuts, last = cuts + 1, np.int64(s)
    if cuts == 0:
        return 1.0
    if cuts == 1:
        return _covered_by_one(*_corners_of_face(values, last, face))
    size, here = start_square(ring), 0
    for s in range(count):
        f = _corners_of_face(values, s, face)
        if f[0] > 0.0 or f[1] > 0.0 or f[2] > 0.0 or f[3] > 0.0:
            size = clip(ring, here, size, -f[0], -f[1], -f[2], -f[3])
            here = 1 - here
    return area_of(ring, here, size)


@inner
def _covered_by_one(f0, f1, f2, f3):
    """Covered share of a face by a plane, from its values at the corners in turn."""
    if f0 <= 0.0 and f1 <= 0.0 and f2 <= 0.0 and f3 <= 0.0:
        return 1.0
    if f0 >= 0.0 and f1 >= 0.0 and f2 >= 0.0 and f3 >= 0.0:
        return 0.0
    return 1.0 - open_share(f0, f1, f2, f3)


@inner
def _cover_by_one(f, out):
    """out[:6]: covered shares of a cell's faces by the only plane, f (NODES,) at the corners; returns their sum."""
    f000, f001, f010, f011 = f[0], f[2], f[6], f[8]
    f100, f101, f110, f111 = f[18], f[20], f[24], f[26]
    out[0] = _covered_by_one(f000, f010, f011, f001)
    out[1] = _covered_by_one(f100, f110, f111, f101)
    out[2] = _covered_by_one(f000, f001, f101, f100)
    out[3] = _covered_by_one(f010, f011, f111, f110)
    out[4] = _covered_by_one(f000, f100, f110, f010)
    out[5] = _covered_by_one(f001, f101, f111, f011)
    return out[0] + out[1] + out[2] + out[3] + out[4] + out[5]


@inner
def _wall_of_one(g, e, b):
    """l e of a cell's only plane; b (3,): sum of l_s g_s."""
    return e * (b[0] * g[0] + b[1] * g[1] + b[2] * g[2]) / (g[0] * g[0] + g[1] * g[1] + g[2] * g[2])


@inner
def _walls_of_two(g, e, b):
    """Whether the two planes are far from parallel, and then the sum of their l e."""
    aa = g[0, 0] * g[0, 0] + g[0, 1] * g[0, 1] + g[0, 2] * g[0, 2]
    cc = g[1, 0] * g[1, 0] + g[1, 1] * g[1, 1] + g[1, 2] * g[1, 2]
    ac = g[0, 0] * g[1, 0] + g[0, 1] * g[1, 1] + g[0, 2] * g[1, 2]
    det = aa * cc - ac * ac
    if not det > APART * (aa * cc):
        return False, 0.0
    p = b[0] * g[0, 0] + b[1] * g[0, 1] + b[2] * g[0, 2]
    q = b[0] * g[1, 0] + b[1] * g[1, 1] + b[2] * g[1, 2]
    return True, (e[0] * (p * cc - q * ac) + e[1] * (q * aa - p * ac)) / det


@inner
def _load(plane, ends, least, values, row, g, e):
    """values[row] (NODES,) at the corners of a cell, g[row] (3,), e[row]; whether it is positive, and negative, at one.

    ends (3, 2) [length]: lower and upper planes of the cell.
    """
    positive, negative, total = False, False, 0.0
    for i in range(2):
        for j in range(2):
            for k in range(2):
                d = plane[0] * ends[0, i] + plane[1] * ends[1, j] + plane[2] * ends[2, k] - plane[3]
                d = 0.0 if abs(d) <= least else d
                values[row, 18 * i + 6 * j + 2 * k] = d
                positive |= d > 0.0
                negative |= d < 0.0
                total += d
    for d in range(3):
        g[row, d] = plane[d] * (ends[d, 1] - ends[d, 0])
    e[row] = 0.125 * total
    return positive, negative


@free_kernel
def paint_convex(planes, x, y, z, low, past, index, counts):
    """Paint index, zeros before: 1 in cells that planes (m, 4) of a convex body may cut, 2 inside.

    x, y, z: planes of the cells; low, past (3,): the cells of the box. counts (2,) becomes the number of 1s, and of
    runs of 2s along z.
    """
    n = past[2] - low[2]
    middle, half = np.empty(n), np.empty(n)
    beyond, within = np.empty(n), np.empty(n)  # the largest d_s - r and d_s + r
    for k in range(n):
        middle[k] = 0.5 * (z[low[2] + k] + z[low[2] + k + 1])
        half[k] = 0.5 * (z[low[2] + k + 1] - z[low[2] + k])
    for i in range(low[0], past[0]):
        for j in range(low[1], past[1]):
            a, b = 0.5 * (x[i] + x[i + 1]), 0.5 * (y[j] + y[j + 1])
            for k in range(n):
                beyond[k] = within[k] = -np.inf
            for s in range(len(planes)):
                p = planes[s]
                d = p[0] * a + p[1] * b - p[3]
                r = 0.5 * ROUNDING * (abs(p[0]) * (x[i + 1] - x[i]) + abs(p[1]) * (y[j + 1] - y[j]))
                up, rise = p[2], ROUNDING * abs(p[2])
                for k in range(n):
                    beyond[k] = max(beyond[k], d + up * middle[k] - (r + rise * half[k]))
                    within[k] = max(within[k], d + up * middle[k] + (r + rise * half[k]))
            for k in range(n):
                if beyond[k] <= 0.0:
                    index[i - low[0], j - low[1], k] = 2 if within[k] < 0.0 else 1
    count_painted(index, counts)


@free_kernel
def cut_convex(cells, x, y, z, planes, least, covered):
    """covered (c, 7) of cells (c, 3) [without ghosts]: six faces, then volume [-], of a body where all planes (m, 4)
    are negative. x, y, z, least: of body_values.cut_body."""
    work, ring = work_space(), np.empty((2, MOST, 3))
    m = len(planes)
    values, g, e = np.zeros((m, NODES)), np.empty((m, 3)), np.empty(m)
    ends, b = np.empty((3, 2)), np.empty(3)
    for c in range(len(cells)):
        i, j, k = 2 * cells[c, 0], 2 * cells[c, 1], 2 * cells[c, 2]
        ends[0, 0], ends[0, 1] = x[i], x[i + 2]
        ends[1, 0], ends[1, 1] = y[j], y[j + 2]
        ends[2, 0], ends[2, 1] = z[k], z[k + 2]
        hx, hy, hz = x[i + 2] - x[i + 1], y[j + 2] - y[j + 1], z[k + 2] - z[k + 1]
        count, free = np.int64(0), False  # free: the body ends in the plane of a face
        for s in range(m):
            p = planes[s]
            d = p[0] * x[i + 1] + p[1] * y[j + 1] + p[2] * z[k + 1] - p[3]
            reach = ROUNDING * (abs(p[0]) * hx + abs(p[1]) * hy + abs(p[2]) * hz)
            if d > reach:
                count = np.int64(-1)
                break
            if d >= -reach:
                positive, negative = _load(p, ends, least, values, count, g, e)
                count += np.int64(positive)
                free |= positive and not negative
        out = covered[c]
        if count < 1:
            for part in range(7):
                out[part] = 0.0 if count < 0 else 1.0
            continue
        total = 0.0
        if count == 1:
            total = _cover_by_one(values[0], out)
        else:
            for face in range(6):
                out[face] = _covered_face(values, count, face, ring)
                total += out[face]
        b[0], b[1], b[2] = out[0] - out[1], out[2] - out[3], out[4] - out[5]
        known, walls = count == 1, 0.0
        if free:
            out[6] = 0.0
            continue
        if count == 1:
            walls = _wall_of_one(g[0], e[0], b)
        elif count == 2:
            known, walls = _walls_of_two(g, e, b)
        if known:
            out[6] = min(max(total / 6.0 - walls / 3.0, 0.0), 1.0)
        else:
            out[6] = cover_part(work, ring, values, count, count, 6)
