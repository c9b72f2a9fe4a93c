"""What is left of a cell when fields cut parts of it away: area of a face and volume, exact for planes.

A field is given by its values at the corners of the unit cell (index 4 i + 2 j + k) and kept where it is positive.
The cell is a list of polygons whose surface is closed. A field cuts it:

    every polygon    keep the corners with f > 0; where f changes sign between neighbours a and b,
                     a new corner  a + (b - a) f_a / (f_a - f_b),  a the one that is kept
    the new wall     the cut edges of all polygons form closed loops; the wall is the fan of triangles from the mean
                     of their ends to each of them
    volume           sum of the tetrahedra from the cell's middle to all triangles (divergence theorem)

The result is closed again, so that the next field (another solid, the liquid) cuts it in the same way, and faces and
volume belong to one body: the areas of the open faces and the wall sum to the zero vector. A field is linear between
the corners of a polygon, and trilinear where a new corner needs a value. So planes are exact in any position, also when
several meet in the cell; a smooth surface is replaced by chords, second order in the size of the cell.

Source  Sutherland & Hodgman 1974 (clipping, one polygon after the other); the rest is derived here.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flowgmo.flow.favor.one_cut import area_of_one, volume_of_one
from flowgmo.kernel import inner, kernel

MOST_FIELDS = 5  # that cut one cell one by one; more are joined into the last by their least value
MOST_POLYGONS = 256  # a cut adds at most one triangle for each polygon: 6 x 2^5 = 192
MOST_CORNERS = 32  # a cut makes a ring at most half as long again: 4 x 1.5^5 = 31


class Cutting(NamedTuple):
    """Work space of one thread: polygons (P, C, 3) and their sizes (P,), one ring, values at it, ends of cuts, fields
    (MOST_FIELDS, 8), and the numbers (8,) of the nodes where they are taken."""

    corners: np.ndarray
    sizes: np.ndarray
    ring: np.ndarray
    value: np.ndarray
    ends: np.ndarray
    fields: np.ndarray
    nodes: np.ndarray


@inner
def work_space():
    """A Cutting."""
    return Cutting(
        np.empty((MOST_POLYGONS, MOST_CORNERS, 3)),
        np.empty(MOST_POLYGONS, np.int64),
        np.empty((MOST_CORNERS, 3)),
        np.empty(MOST_CORNERS),
        np.empty((MOST_POLYGONS, 2, 3)),
        np.empty((MOST_FIELDS, 8)),
        np.empty(8, np.int64),
    )


@inner
def interpolated(f, x, y, z):
    """Trilinear value at (x, y, z) in the unit cell of the field with corner values f (8,)."""
    a = (1.0 - z) * f[0] + z * f[1]
    b = (1.0 - z) * f[2] + z * f[3]
    c = (1.0 - z) * f[4] + z * f[5]
    d = (1.0 - z) * f[6] + z * f[7]
    return (1.0 - x) * ((1.0 - y) * a + y * b) + x * ((1.0 - y) * c + y * d)


@inner
def _set(corner, x, y, z):
    corner[0] = x
    corner[1] = y
    corner[2] = z


@inner
def start_cell(work, flat):
    """The unit cell's six faces, counter-clockwise from outside, or only z = 1 where flat; returns their number."""
    for face in range(6):
        axis = face // 2
        side = face % 2
        for v in range(4):
            along = 1.0 if v == 1 or v == 2 else 0.0  # (0,0) (1,0) (1,1) (0,1) on the two other axes
            across = 1.0 if v >= 2 else 0.0
            at = np.int64(0) if flat else np.int64(face)  # the last one is z = 1
            work.corners[at, v, axis] = float(side)
            work.corners[at, v, (axis + 1) % 3] = along if side == 1 else across
            work.corners[at, v, (axis + 2) % 3] = across if side == 1 else along
        work.sizes[face] = 4
    return np.int64(1) if flat else np.int64(6)


@inner
def _crossing(out, kept, lost, f_kept, f_lost):
    """The point of the edge where the field vanishes, always seen from the end that stays: both polygons agree."""
    t = f_kept / (f_kept - f_lost)
    for axis in range(3):
        out[axis] = kept[axis] + t * (lost[axis] - kept[axis])


@inner
def _cut_ring(work, p, size, first, ends):
    """Polygon p without its corners of no positive value, in work.ring; returns its size and the number of ends.

    first: a corner that stays, so that walking on from it an exit always comes before its entry.
    """
    m = np.int64(0)
    leaving = np.int64(0)
    for step in range(size):
        a = (first + step) % size
        b = (a + 1) % size
        if work.value[a] > 0.0:
            if m < MOST_CORNERS:
                _set(work.ring[m], work.corners[p, a, 0], work.corners[p, a, 1], work.corners[p, a, 2])
                m += 1
            if work.value[b] <= 0.0 and m < MOST_CORNERS:
                _crossing(work.ring[m], work.corners[p, a], work.corners[p, b], work.value[a], work.value[b])
                leaving = m
                m += 1
        elif work.value[b] > 0.0 and m < MOST_CORNERS:
            _crossing(work.ring[m], work.corners[p, b], work.corners[p, a], work.value[b], work.value[a])
            if ends < MOST_POLYGONS:
                for axis in range(3):  # the wall runs this edge the other way
                    work.ends[ends, 0, axis] = work.ring[m, axis]
                    work.ends[ends, 1, axis] = work.ring[leaving, axis]
                ends += 1
            m += 1
    return m, ends


@inner
def keep_positive(work, count, f):
    """Cut away from `count` polygons where the field f (8,) is not positive; new count, and number of cut edges."""
    ends = np.int64(0)
    kept = np.int64(0)
    for p in range(count):
        size = work.sizes[p]
        first = np.int64(-1)
        lost = np.int64(0)
        for v in range(size):
            work.value[v] = interpolated(f, work.corners[p, v, 0], work.corners[p, v, 1], work.corners[p, v, 2])
            if work.value[v] <= 0.0:
                lost += 1
            elif first < 0:
                first = v
        if first < 0:
            continue
        if lost > 0:
            size, ends = _cut_ring(work, p, size, first, ends)
        for v in range(size):
            for axis in range(3):
                work.corners[kept, v, axis] = work.ring[v, axis] if lost > 0 else work.corners[p, v, axis]
        work.sizes[kept] = size
        kept += 1
    return kept, ends


@inner
def add_wall(work, kept, ends):
    """Close `kept` polygons by the fan of triangles over their cut edges; new count."""
    for axis in range(3):
        middle = 0.0
        for e in range(ends):
            middle += work.ends[e, 0, axis] + work.ends[e, 1, axis]
        for e in range(min(ends, MOST_POLYGONS - kept)):
            work.corners[kept + e, 0, axis] = 0.5 * middle / ends
            work.corners[kept + e, 1, axis] = work.ends[e, 0, axis]
            work.corners[kept + e, 2, axis] = work.ends[e, 1, axis]
            work.sizes[kept + e] = 3
    return min(kept + ends, MOST_POLYGONS)


@inner
def volume_inside(work, count):
    """Volume inside `count` polygons that close, in unit cells; from the middle, so that mirror images agree."""
    six = 0.0
    for p in range(count):
        ax = work.corners[p, 0, 0] - 0.5
        ay = work.corners[p, 0, 1] - 0.5
        az = work.corners[p, 0, 2] - 0.5
        for v in range(1, work.sizes[p] - 1):
            bx = work.corners[p, v, 0] - 0.5
            by = work.corners[p, v, 1] - 0.5
            bz = work.corners[p, v, 2] - 0.5
            cx = work.corners[p, v + 1, 0] - 0.5
            cy = work.corners[p, v + 1, 1] - 0.5
            cz = work.corners[p, v + 1, 2] - 0.5
            six += ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
    return min(max(six / 6.0, 0.0), 1.0)


@inner
def _extent(f):
    """-1 if no corner value of f (8,) is positive, 1 if all are, else 0."""
    positive = np.int64(0)
    for v in range(8):
        if f[v] > 0.0:
            positive += 1
    return -1 if positive == 0 else (1 if positive == 8 else 0)


@inner
def _like_an_earlier(fields, m):
    """1 if field m has the values of an earlier one, -1 if it has one's negative (what is put in and taken out), or 0.

    A curved surface is no plane, and cutting with it twice, once from each side, would leave splinters.
    """
    for n in range(m):
        same = True
        opposite = True
        for v in range(8):
            same = same and fields[m, v] == fields[n, v]
            opposite = opposite and fields[m, v] == -fields[n, v]
        if same or opposite:
            return 1 if same else -1
    return 0


@inner
def area_inside(work, count):
    """Area of the polygon in the plane z = 1, about the middle of the square; 0 without one."""
    twice = 0.0
    for v in range(work.sizes[0] if count > 0 else 0):
        w = (v + 1) % work.sizes[0]
        twice += (work.corners[0, v, 0] - 0.5) * (work.corners[0, w, 1] - 0.5)
        twice -= (work.corners[0, w, 0] - 0.5) * (work.corners[0, v, 1] - 0.5)
    return min(max(0.5 * twice, 0.0), 1.0)


@inner
def share_where_positive(work, fields, flat):
    """Share of the unit cell, or where flat of its face z = 1, in which all of work.fields[:fields] are positive.

    A field has its 8 corner values at index 4 i + 2 j + k. For a face it does not vary along z.
    """
    cuts = 0
    one = 0
    for m in range(fields):
        extent = _extent(work.fields[m])
        if extent < 0:
            return 0.0
        if extent == 0:
            cuts += 1
            one = m
    if cuts == 0:
        return 1.0
    if cuts == 1:
        return area_of_one(work.fields[one]) if flat else volume_of_one(work.fields[one])
    count = start_cell(work, flat)
    for m in range(fields):
        like = _like_an_earlier(work.fields, m)
        if like < 0:
            return 0.0
        if like == 0 and _extent(work.fields[m]) == 0:
            count, ends = keep_positive(work, count, work.fields[m])
            if not flat:
                count = add_wall(work, count, ends)
    return area_inside(work, count) if flat else volume_inside(work, count)


@kernel
def volumes_where_positive(fields):
    """Shares (n,) of unit cells in which all fields (n, m <= 5, 8) are positive; of the liquid outside a solid:
    fields -phi_liquid and phi_solid."""
    work = work_space()
    out = np.empty(fields.shape[0])
    for c in range(fields.shape[0]):
        for m in range(fields.shape[1]):
            for v in range(8):
                work.fields[m, v] = fields[c, m, v]
        out[c] = share_where_positive(work, fields.shape[1], False)
    return out
