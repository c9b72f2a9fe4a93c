"""Contact points of two pieces for a given normal: where the parts of their surfaces that face each other overlap.

A box on a floor, a cylinder on its side, two stacked bricks touch along faces and lines; one point would let them tip.
The parts of both surfaces within reach of the contact (faces.py) are seen along the normal n and clipped against each
other (clipping.py). Over each point (u, v) of the overlap the two parts stand at the heights

    z(u, v) = z0 + g·((u, v) - (u0, v0))      g: slope of the face's plane (Newell's normal), of the edge, or zero

and z_i - z_j is the gap, the point halfway between is the contact point. Box on box gives up to eight points, edge on
face two, crossed edges one, a cylinder lying two, standing up to eight.
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.clipping import CORNER, PART, PIECE_BITS, clip, nearest, overlap
from flowgmo.collision.convex import support_gap
from flowgmo.collision.curved import across
from flowgmo.collision.faces import MOST, ROWS, support_face, thin
from flowgmo.collision.point_distance import point_distance
from flowgmo.collision.shapes import CAVITY, HALF_SPACE, POINT, POLYTOPE, axis_of, centre_of
from flowgmo.kernel import inner
from flowgmo.vectors import add, along, cross, dot, put, scale, sub

SLACK = 2.0**-40  # of the sizes: round-off of corners, 100 times
LEVEL = 2.0**-30  # of the sizes: faces that are level but for the round-off of n count as facing, whatever `within`


@inner
def contact_points(pieces, vertices, i, frame_i, j, frame_j, n, within, out):
    """Contact points of the pieces i and j for the unit normal n (from j to i) of `separation`. Returns how many.

    Those with a gap along n of no more than within [length] are listed, at most 8: in out (CONTACT, 8 or more rows,
    from the first) point (halfway between the surfaces), normal, gap, feature (below 2^30) are written, nothing else.
    A point in a cavity has the hole's own normal. Two pieces with a gap of `within` or less have at least one.
    Mirrored pieces give mirrored points; exchanging i and j gives the same ones with the other normal.
    vertices None: as in `separation`; faces are then met by half spaces and balls only.
    """
    high, low = max(pieces[i].kind, pieces[j].kind), min(pieces[i].kind, pieces[j].kind)
    if high >= HALF_SPACE or (low == POINT and high != POLYTOPE):
        return _apart(pieces, vertices, i, frame_i, j, frame_j, n, within, out)
    if vertices is not None:
        return _between(pieces, vertices, i, frame_i, j, frame_j, n, within, out)
    return np.int64(0)


@inner
def _between(pieces, vertices, i, frame_i, j, frame_j, n, within, out):
    """The general case: faces across n, clipped against each other."""
    one, two = pieces[i], pieces[j]
    size = min(one.reach, two.reach)
    gap = support_gap(pieces, vertices, i, frame_i, j, frame_j, n)
    tolerance = max(within - gap, 0.0) + LEVEL * size
    faces = np.empty((2, ROWS, 4))
    counts = (np.int64(0), np.int64(0))
    planes = np.empty((2, 5))
    origin = centre_of(frame_j)
    t1, t2 = across(n)
    for k in range(2):
        piece, frame, d = (one, frame_i, scale(-1.0, n)) if k == 0 else (two, frame_j, n)
        count = support_face(piece, vertices, frame, d, tolerance, faces[k])
        _see(faces[k], count, origin, t1, t2, n, planes[k])
        counts = (count, counts[1]) if k == 0 else (counts[0], count)
    work = np.empty((2, 24, 4))
    slack = SLACK * (one.reach + two.reach)
    now, swap = np.int64(0), counts[1] < 3
    count = np.int64(0)
    if counts[0] > 2 or counts[1] > 2:
        a = 1 if swap else 0
        now, count = clip(faces[a], counts[a], faces[1 - a], counts[1 - a], slack, work)
    else:
        swap = False
        if counts[0] == 2 and counts[1] == 2:
            count = overlap(faces[0], faces[1], within, slack, work)
    if count == 0:
        now, swap = 0, False
        count = nearest(faces, counts, work)
    count = _measure(work[now], count, planes, swap, max(within, gap), slack)
    count = thin(work[now], count, MOST, 0.0)
    for k in range(count):
        row = work[now, k]
        a, b = _above(planes[0], row[0], row[1]), _above(planes[1], row[0], row[1])
        x = along(along(along(origin, row[0], t1), row[1], t2), 0.5 * (a + b), n)
        _write(out[k], x, n, a - b, np.int64(row[2]))
    return count


@inner
def _write(row, x, n, gap, feature):
    put(row.point, x)
    put(row.normal, n)
    row.gap = gap
    row.feature = feature


@inner
def _see(face, count, origin, t1, t2, n, plane):
    """Points of a face in coordinates along t1, t2, n from the origin; its plane (u0, v0, w0, slopes along u and v)."""
    u0, v0, w0, normal = 0.0, 0.0, 0.0, (0.0, 0.0, 0.0)
    for k in range(count):
        x = sub((face[k, 0], face[k, 1], face[k, 2]), origin)
        face[k, 0], face[k, 1], face[k, 2] = dot(x, t1), dot(x, t2), dot(x, n)
        u0, v0, w0 = u0 + face[k, 0] / count, v0 + face[k, 1] / count, w0 + face[k, 2] / count
    gu, gv = 0.0, 0.0
    if count == 2:
        du, dv, dw = face[1, 0] - face[0, 0], face[1, 1] - face[0, 1], face[1, 2] - face[0, 2]
        dd = du * du + dv * dv
        gu, gv = (dw * du / dd, dw * dv / dd) if dd > 0.0 else (0.0, 0.0)
    elif count > 2:
        for k in range(count):
            m = (k + 1) % count
            p = (face[k, 0] - u0, face[k, 1] - v0, face[k, 2] - w0)
            normal = add(normal, cross(p, (face[m, 0] - u0, face[m, 1] - v0, face[m, 2] - w0)))
        nu, nv, nw = normal
        gu, gv = (-nu / nw, -nv / nw) if abs(nw) > abs(nu) + abs(nv) else (0.0, 0.0)  # a facing part is no steeper
    plane[0], plane[1], plane[2], plane[3], plane[4] = u0, v0, w0, gu, gv


@inner
def _above(plane, u, v):
    """Height of a face's plane over (u, v)."""
    return plane[2] + plane[3] * (u - plane[0]) + plane[4] * (v - plane[1])


@inner
def _measure(rows, count, planes, swap, within, slack):
    """Keep the rows with a gap of no more than within, each place once; the parts in the order i, j."""
    kept = np.int64(0)
    for k in range(count):
        u, v, part = rows[k, 0], rows[k, 1], np.int64(rows[k, 2])
        if _above(planes[0], u, v) - _above(planes[1], u, v) > within + slack:
            continue
        known = False
        for m in range(kept):
            known = known or abs(rows[m, 0] - u) + abs(rows[m, 1] - v) <= 4.0 * slack
        if not known:
            rows[kept, 0], rows[kept, 1] = u, v
            rows[kept, 2] = part % PIECE_BITS * PIECE_BITS + part // PIECE_BITS if swap else part
            kept += 1
    return kept


@inner
def _apart(pieces, vertices, i, frame_i, j, frame_j, n, within, out):
    """Half spaces and cavities, where each facing point of the other piece has its own distance, and balls."""
    flip = pieces[i].kind > pieces[j].kind
    if flip:
        i, j, frame_i, frame_j, n = j, i, frame_j, frame_i, scale(-1.0, n)
    one, two = pieces[i], pieces[j]
    if one.kind >= HALF_SPACE:
        return np.int64(0)
    if two.kind == HALF_SPACE:
        n = axis_of(frame_j, 2)
    face = np.empty((ROWS, 4))
    count, radius = np.int64(1), 0.0
    if one.kind == POINT:
        put(face[0], centre_of(frame_i))
        face[0, 3], radius = 0, one.radius
    else:
        gap = support_gap(pieces, vertices, i, frame_i, j, frame_j, n)
        tolerance = max(within - gap, 0.0) + LEVEL * one.reach
        count = support_face(one, vertices, frame_i, scale(-1.0, n), tolerance, face)
    kept = np.int64(0)
    for k in range(count):
        x = (face[k, 0], face[k, 1], face[k, 2])
        d, m = point_distance(two, vertices, frame_j, x, n)
        d -= two.radius
        if two.kind >= CAVITY:
            d, m = -d, scale(-1.0, m)
        x = along(x, -radius, m)
        d -= radius
        if d <= within:
            part = CORNER + np.int64(face[k, 3]) % PART
            middle = along(x, -0.5 * d, m)
            _write(out[kept], middle, scale(-1.0, m) if flip else m, d, part if flip else part * PIECE_BITS)
            kept += 1
    return kept
