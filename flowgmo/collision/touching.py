"""Contact points of two pieces as the rest of the model sees them: true normals, features numbered over all pieces.

The convex search knows one piece of a body at a time. What it finds at an edge between two triangles of one surface, or
between two boxes of one body, gets the normal that the surface really has there (facets.py), or is left out where the
place lies inside the body (seams.py).
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.convex import separation
from flowgmo.collision.facets import allowed_normal
from flowgmo.collision.manifold import contact_points
from flowgmo.collision.seams import exposed
from flowgmo.collision.shapes import TRIANGLE, place
from flowgmo.kernel import inner
from flowgmo.vectors import dot, norm, put, quad, rotate, scale, sub, triple, unrotate

MOST_POINTS = 16  # contact points of two pieces
NEAR = 0.1  # a contact point this near to another, in reaches of the smaller piece, with its direction, is that one
ALIKE = 0.99  # cosine of the angle between two normals up to which they count as one direction
PIECES = 1 << 16  # pieces of a scene; two numbers and a feature below 2³¹ fit one integer
FEATURES = 1 << 31


@inner
def touching_points(sh, i, row_a, j, row_b, n0, within, points):
    """Contact points of pieces i and j, rows of POSE of their bodies, with gap <= within [length].

    points (MOST_POINTS,) of CONTACT get point, normal, gap, feature; n0: a normal near the right one, or zeros.
    Returns how many, the distance of the two, and the normal of the search.
    """
    fi = place(sh.pieces[i], triple(row_a.p), quad(row_a.q))
    fj = place(sh.pieces[j], triple(row_b.p), quad(row_b.q))
    s, n, _, _, _ = separation(sh.pieces, sh.vertices, i, fi, j, fj, n0)
    if s > within:
        return np.int64(0), s, n
    count = contact_points(sh.pieces, sh.vertices, i, fi, j, fj, n, within, points)
    pair = (i * PIECES + j) * FEATURES
    kept = np.int64(0)
    for k in range(count):
        x, m = triple(points[k].point), triple(points[k].normal)
        m, seen_j = _true_normal(sh, j, row_b, x, m)
        m, seen_i = _true_normal(sh, i, row_a, x, scale(-1.0, m))
        if not (seen_i and seen_j):
            continue
        put(points[kept].point, x)
        put(points[kept].normal, scale(-1.0, m))
        points[kept].gap = points[k].gap
        points[kept].feature = points[k].feature + pair
        kept += 1
    return kept, s, n


@inner
def _true_normal(sh, i, row, x, n):
    """The normal n (unit, out of piece i) at x as the whole surface of its body has it; and whether x is on that."""
    party = sh.pieces[i].body
    if sh.first_piece[party + 1] - sh.first_piece[party] == 1:
        return n, True
    q = quad(row.q)
    y = unrotate(q, sub(x, triple(row.p)))
    m = unrotate(q, n)
    if sh.pieces[i].kind == TRIANGLE:
        return rotate(q, allowed_normal(sh, i, y, m)), True
    return n, exposed(sh, i, y, m)


@inner
def is_same(point, normal, other, near):
    """Whether a contact is at the point (triple) with the normal (triple), within `near` [length]."""
    return norm(sub(triple(other.point), point)) <= near and dot(other.normal, normal) > ALIKE
