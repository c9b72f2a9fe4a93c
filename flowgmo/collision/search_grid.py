"""Contact search on the mesh, the report's section 3.1: kept to compare with, and to show what it costs and saves.

For every pair whose bounding boxes share cells, among the mesh nodes that lie inside both bodies, in boundary cells of
both (no deeper than a cell's diagonal): the node with approaching velocity and the largest sum of depths below the two
surfaces is the contact point; the normal is that of the flatter surface there, turned from b to a. One point a pair.

Nothing is found before a node lies in both bodies: thin bodies are missed, and the contact comes late by up to a cell.
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.convex import separation
from flowgmo.collision.shapes import ELLIPSOID, FRUSTUM, POINT, axis_of, place
from flowgmo.kernel import inner, kernel
from flowgmo.vectors import add, cross, dot, norm, put, quad, scale, sub, triple

SIDE = 0.5  # |cosine| of a frustum's normal with its axis below which the contact is on its round side


@inner
def _depth(sh, pieces, party, row, x):
    """Signed distance of the point x from a party (union of its pieces), outward normal, curvature [1/length]."""
    least = np.inf
    n = (0.0, 0.0, 1.0)
    curvature = 0.0
    probe = pieces.size - 1
    at = (x[0], x[1], x[2], 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    for j in range(sh.first_piece[party], sh.first_piece[party + 1]):
        frame = place(pieces[j], triple(row.p), quad(row.q))
        s, m, _, _, _ = separation(pieces, sh.vertices, probe, at, j, frame, (0.0, 0.0, 0.0))
        if s < least:
            least, n = s, m
            curvature = _curvature(pieces[j], frame, m)
    return least, n, curvature


@inner
def _curvature(piece, frame, n):
    """Larger curvature of a piece where its normal is n; of an ellipsoid the mean over its half axes."""
    if piece.kind == POINT:
        return 1.0 / piece.radius
    if piece.kind == ELLIPSOID:
        return 3.0 / (piece.size[0] + piece.size[1] + piece.size[2])
    if piece.kind == FRUSTUM and abs(dot(axis_of(frame, 2), n)) < SIDE:
        return 2.0 / (piece.size[0] + piece.size[1])
    return 0.0


@inner
def _first_node(planes, x):
    """Number of the first node that is not below x."""
    lo, hi = 0, planes.size
    while lo < hi:
        mid = (lo + hi) // 2
        if planes[mid] < x:
            lo = mid + 1
        else:
            hi = mid
    return lo


@kernel
def grid_contacts(sh, pieces, pairs, count, boxes, M, plan, px, py, pz, out):
    """Contacts (at most one a pair) of pairs (count, 2) with the rows M at one time; returns their number.

    pieces (p + 1,) of PIECE: those of sh and a ball without radius, the probe; boxes (n, 6) of the parties; px, py, pz:
    planes of the mesh [length]; out (count,) of CONTACT: gap is minus the sum of the depths.
    """
    total = np.int64(0)
    for k in range(count):
        a, b = pairs[k, 0], pairs[k, 1]
        deepest = 0.0
        for i in range(_first_node(px, max(boxes[a, 0], boxes[b, 0])), px.size):
            if px[i] > min(boxes[a, 3], boxes[b, 3]):
                break
            for j in range(_first_node(py, max(boxes[a, 1], boxes[b, 1])), py.size):
                if py[j] > min(boxes[a, 4], boxes[b, 4]):
                    break
                for m in range(_first_node(pz, max(boxes[a, 2], boxes[b, 2])), pz.size):
                    if pz[m] > min(boxes[a, 5], boxes[b, 5]):
                        break
                    x = (px[i], py[j], pz[m])
                    diagonal = _diagonal(px, i, py, j, pz, m)
                    deepest = _try_node(sh, pieces, a, b, M, x, diagonal, deepest, plan, out[total])
        if deepest > 0.0:
            total += 1
    return total


@inner
def _diagonal(px, i, py, j, pz, m):
    """Largest diagonal of the cells around a node [length]."""
    return norm((_width(px, i), _width(py, j), _width(pz, m)))


@inner
def _width(planes, i):
    below = planes[i] - planes[i - 1] if i > 0 else 0.0
    above = planes[i + 1] - planes[i] if i + 1 < planes.size else 0.0
    return max(below, above)


@inner
def _try_node(sh, pieces, a, b, M, x, diagonal, deepest, plan, row):
    """Take node x as the contact of parties a, b if it is a better one; returns the largest sum of depths so far."""
    da, na, ka = _depth(sh, pieces, a, M[a], x)
    if da > 0.0 or da < -diagonal:
        return deepest
    db, nb, kb = _depth(sh, pieces, b, M[b], x)
    if db > 0.0 or db < -diagonal or -da - db <= deepest:
        return deepest
    n = nb if kb <= ka else scale(-1.0, na)
    u = add(triple(M[a].v), cross(triple(M[a].w), sub(x, triple(M[a].p))))
    w = add(triple(M[b].v), cross(triple(M[b].w), sub(x, triple(M[b].p))))
    if dot(sub(u, w), n) >= 0.0:
        return deepest
    row.a, row.b = a, b
    put(row.point, x)
    put(row.normal, n)
    row.gap = da + db
    row.e, row.mu = plan[a, b].e, plan[a, b].mu
    put(row.impulse, (0.0, 0.0, 0.0))
    row.feature = 0
    row.fresh = 1
    row.age = 0.0
    return -da - db
