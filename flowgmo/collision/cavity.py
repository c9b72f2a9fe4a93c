"""A convex piece inside a hole: the least depth of its points below the hole's surface.

A CAVITY piece is the hole left free by its core and a ball of its `radius` (a spherical hole is a POINT with a radius).
With the signed distance d of the core (point_distance.py) a point x of the hole is radius - d(x) away from the matter,
the normal there is -∇d. In a convex hole this room is a concave function of x, so that its least value over a convex
piece lies at a corner, a rim, or the surface of an ellipsoid:

    ball                        its centre, less its radius                                        exact
    box, polytope, triangle     the corners                                                       exact
    frustum, ellipsoid          x <- the piece's support along ∇d(x), from several starts: each lowers the room, since a
                                concave function lies below its tangents. Ends where the normal at x is the hole's.
                                The supports along the hole's axes are starts too: exact for a box. A deeper minimum
                                that no start leads to would be missed

The normal n0 of the last call is a start as well.
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.point_distance import point_distance
from flowgmo.collision.shapes import (
    CAVITY,
    ELLIPSOID,
    FRUSTUM,
    HALF_SPACE,
    POINT,
    POLYTOPE,
    TRIANGLE,
    axis_of,
    centre_of,
    core_support,
    to_piece,
    to_space,
)
from flowgmo.kernel import inner
from flowgmo.vectors import add, along, dot, scale, triple

DESCENT = 200  # steps from the best start; they shorten slowly only where the curvatures, hence all rooms, are alike
STARTS = 12  # of a frustum, six around each rim; an ellipsoid has the six ends of its axes
FEW = 3  # steps from each start, enough to see which basin is the deepest


@inner
def start_point(piece, vertices, k):
    """Point k (piece axes) of the core where a search for its least room starts; corners for cores that have them."""
    kind = piece.kind & 15
    size = piece.size
    if vertices is not None:
        if kind == POLYTOPE or kind == TRIANGLE:
            return triple(vertices[piece.first + k])
    if kind == FRUSTUM:
        phi = np.pi / 3.0 * (k // 2)
        r = size[0] if k % 2 == 0 else size[1]
        return (r * np.cos(phi), r * np.sin(phi), -size[2] if k % 2 == 0 else size[2])
    if kind == ELLIPSOID:
        sign = 1.0 if k % 2 == 0 else -1.0
        axis = k // 2 % 3
        return (
            sign * size[0] if axis == 0 else 0.0,
            sign * size[1] if axis == 1 else 0.0,
            sign * size[2] if axis == 2 else 0.0,
        )
    return (size[0] if k & 1 else -size[0], size[1] if k & 2 else -size[1], size[2] if k & 4 else -size[2])


@inner
def inside_cavity(one, two, vertices, frame_i, frame_j, n0):
    """Room s [length] of the piece i in the hole j, the normal (unit, from the matter to the piece), and i's point.

    one, two: the pieces, two the cavity. A half space or another cavity: s = inf, they do not meet. A hole made of a
    polytope or a triangle is not computed: s = -inf.
    """
    c = centre_of(frame_i)
    if one.kind >= HALF_SPACE:
        return np.inf, (0.0, 0.0, 1.0), c
    if two.kind == CAVITY + POLYTOPE or two.kind == CAVITY + TRIANGLE:
        return -np.inf, (0.0, 0.0, 1.0), c
    back = scale(-1.0, n0)
    if one.kind == POINT:
        starts = 1
    elif one.kind == POLYTOPE or one.kind == TRIANGLE:
        starts = one.last - one.first
    else:
        starts = STARTS if one.kind == FRUSTUM else (6 if one.kind == ELLIPSOID else 8)
    curved = one.kind == FRUSTUM or one.kind == ELLIPSOID
    # each start goes down a few steps (none for corners), the best of them to its end
    each = 1 + FEW if curved else 1
    chains = starts + 6 if curved else starts
    s, n, x = np.inf, (0.0, 0.0, 1.0), c
    out = back
    for k in range(chains * each + (DESCENT if curved else 0)):
        start, last = k // each, k >= chains * each
        if last:
            out = scale(-1.0, n) if k > chains * each or dot(n0, n0) == 0.0 else back
        elif k % each == 0 and start >= starts:
            out = scale(1.0 if start % 2 == 0 else -1.0, axis_of(frame_j, (start - starts) // 2))
        if one.kind == POINT:
            y = c
        elif k % each == 0 and start < starts:
            y = add(c, to_space(frame_i, start_point(one, vertices, start)))
        else:
            y = add(c, to_space(frame_i, core_support(one, vertices, to_piece(frame_i, out))))
        d, out = point_distance(two, vertices, frame_j, y, back)
        if two.radius - d < s:
            s, n, x = two.radius - d, scale(-1.0, out), y
        elif last and k > chains * each:
            break
    return s - one.radius, n, along(x, -one.radius, n)
