"""The part of a piece's surface that faces a direction: a corner, an edge, a face, a rim, a line of a cylinder's side.

A point faces the direction d if it lies no more than `tolerance` lower along d than the highest point. The facing part
of a polytope is the outline of its facing corners seen along d (gift wrapping, Jarvis 1973), of a box the corners
reached by turning those axes that lie nearly across d; a cap is given by eight points of its rim.
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.curved import across
from flowgmo.collision.shapes import BOX, FRUSTUM, POLYTOPE, TRIANGLE, centre_of, core_support, to_piece, to_space
from flowgmo.kernel import inner
from flowgmo.vectors import add, along, cross, dot, norm, sub, triple

ROWS = 32  # rows that `out` needs: outlines are found in full before they are thinned
MOST = 8  # points of one face


@inner
def support_face(piece, vertices, frame, d, tolerance, out):
    """Points of the piece (radius included) that face the unit vector d within tolerance [length]. Returns how many.

    out (ROWS, 4): x, y, z, feature number; at most MOST rows are used, in order around the face. Numbers: a box's
    corner (bit k: positive side of axis k), 8 cap + k for point k of a frustum's rim, the deepest first, else a vertex'
    place in the piece. Half space: none.
    """
    e = to_piece(frame, d)
    if piece.kind & 15 == BOX:
        count = _box_face(piece.size, e, tolerance, out)
    elif piece.kind & 15 == FRUSTUM:
        count = _frustum_face(piece.size, e, tolerance, out)
    elif vertices is not None and (piece.kind & 15 == POLYTOPE or piece.kind & 15 == TRIANGLE):
        count = thin(out, _outline(piece.first, piece.last, vertices, e, tolerance, out), MOST, 1.0)
    else:
        x = core_support(piece, vertices, e)
        count = _add(out, np.int64(0), x[0], x[1], x[2], 0)
    shift = along(centre_of(frame), piece.radius, d)
    for k in range(count):
        x = add(shift, to_space(frame, (out[k, 0], out[k, 1], out[k, 2])))
        out[k, 0], out[k, 1], out[k, 2] = x[0], x[1], x[2]
    return count


@inner
def _add(out, count, x, y, z, number):
    out[count, 0], out[count, 1], out[count, 2], out[count, 3] = x, y, z, number
    return count + 1


@inner
def _box_face(size, e, tolerance, out):
    """Two axes, one, or none lie across e within the tolerance; never the one nearest to it."""
    x, y, z = abs(e[0]), abs(e[1]), abs(e[2])
    up = 0 if x >= y and x >= z else (1 if y >= z else 2)
    a, b = (up + 1) % 3, (up + 2) % 3
    free_a = 2.0 * size[a] * abs(e[a]) <= tolerance
    free_b = 2.0 * size[b] * abs(e[b]) <= tolerance
    count = np.int64(0)
    corner = (1 if e[0] > 0.0 else 0) + (2 if e[1] > 0.0 else 0) + (4 if e[2] > 0.0 else 0)
    for k in range(4):
        # around the face: a, then b, then a back, then b back
        flip_a, flip_b = k == 1 or k == 2, k >= 2
        if (flip_a and not free_a) or (flip_b and not free_b):
            continue
        c = corner ^ ((1 << a) if flip_a else 0) ^ ((1 << b) if flip_b else 0)
        count = _add(
            out,
            count,
            size[0] if c & 1 else -size[0],
            size[1] if c & 2 else -size[1],
            size[2] if c & 4 else -size[2],
            c,
        )
    return count


@inner
def _frustum_face(size, e, tolerance, out):
    """A cap, a line of the side, or the deepest point of a rim."""
    tilt = np.sqrt(e[0] * e[0] + e[1] * e[1])
    u, v = (e[0] / tilt, e[1] / tilt) if tilt > 0.0 else (1.0, 0.0)
    rise = 2.0 * size[2] * e[2] + (size[1] - size[0]) * tilt  # of the upper rim over the lower
    top = 1 if rise > 0.0 else 0
    r = size[top]
    h = size[2] if top == 1 else -size[2]
    count = np.int64(0)
    if 2.0 * r * tilt <= tolerance and abs(e[2]) > tilt and r > 0.0:
        for k in range(MOST):
            c, s = np.cos(0.25 * np.pi * k), np.sin(0.25 * np.pi * k)
            count = _add(out, count, r * (c * u - s * v), r * (c * v + s * u), h, MOST * top + k)
        return count
    if abs(rise) <= tolerance:
        count = _add(out, count, size[0] * u, size[0] * v, -size[2], 0)
        return _add(out, count, size[1] * u, size[1] * v, size[2], MOST)
    return _add(out, count, r * u, r * v, h, MOST * top)


@inner
def _outline(first, last, vertices, e, tolerance, out):
    """Corners of the outline, seen along e, of the vertices within tolerance of the highest, in order around it."""
    highest = -np.inf
    for k in range(first, last):
        highest = max(highest, dot(triple(vertices[k]), e))
    t1, t2 = across(e)
    start = -1
    for k in range(first, last):
        x = triple(vertices[k])
        if highest - dot(x, e) <= tolerance:
            if start < 0 or dot(sub(x, triple(vertices[start])), t1) < 0.0:
                start = k
    p = start
    count = np.int64(0)
    for _ in range(last - first):
        x = triple(vertices[p])
        if count == ROWS:  # a rim of very many corners
            count = thin(out, ROWS, ROWS // 2, 1.0)
        count = _add(out, count, x[0], x[1], x[2], p - first)
        best, far = -1, (0.0, 0.0, 0.0)
        for k in range(first, last):
            if k == p or highest - dot(triple(vertices[k]), e) > tolerance:
                continue
            y = sub(triple(vertices[k]), x)
            turn = dot(e, cross(far, y))
            line = 2.0**-40 * norm(far) * norm(y)  # on one line but for round-off: the farther one is the corner
            if best < 0 or turn < -line or (turn <= line and norm(y) > norm(far)):
                best, far = k, y
        if best < 0 or best == start:
            break
        p = best
    return count


@inner
def thin(rows, count, most, depth):
    """Drop points (columns 0, 1, depth times 2) of a closed outline until `most` are left. Returns how many.

    Each time the one that cuts off least; of several that do, the first in the outline's order.
    """
    while count > most:
        least, drop = np.inf, 0
        for k in range(count):
            b, c = (k + 1) % count, (k + 2) % count
            e = (rows[b, 0] - rows[k, 0], rows[b, 1] - rows[k, 1], depth * (rows[b, 2] - rows[k, 2]))
            f = (rows[c, 0] - rows[k, 0], rows[c, 1] - rows[k, 1], depth * (rows[c, 2] - rows[k, 2]))
            area = norm(cross(e, f))
            if area < least:
                least, drop = area, (k + 1) % count
        count -= 1
        for k in range(drop, count):
            for m in range(rows.shape[1]):
                rows[k, m] = rows[k + 1, m]
    return count
