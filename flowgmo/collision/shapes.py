"""Convex pieces that surfaces are made of, and what the search asks of each: its support.

    support of a piece in the direction d:   the point of the piece that lies farthest along d

A body is one piece or many (pieces.py); a piece is the sum of a core and a ball of radius `radius` about the origin.
"""

from __future__ import annotations

import numpy as np

from flowgmo.kernel import inner
from flowgmo.vectors import add, along, dot, norm, triple

# kinds of cores; sizes in the piece's own axes, about its centre
POINT = 0  # nothing but its place: with a radius, a ball
BOX = 1  # size: half edges
FRUSTUM = 2  # size: radius at z = -size[2], radius at z = +size[2], half height; axis z. Cylinders and cones
ELLIPSOID = 3  # size: half axes
POLYTOPE = 4  # convex hull of vertices first .. last - 1 of Shapes.vertices (piece axes, from the centre)
TRIANGLE = 5  # three vertices of a surface whose outside is on the side of (v1 - v0) × (v2 - v0)
HALF_SPACE = 6  # points with z <= 0: a domain side, a solid with one face
CAVITY = 16  # added to a kind: the surface is that of a hole, the matter is outside the core

#: One piece. body: party; centre from B, body axes; axes: rows are the piece's axes in body axes; radius is added to
#: the core (subtracted in a cavity); reach: radius of a ball about the centre that holds the piece.
PIECE = np.dtype(
    [
        ("body", "i8"),
        ("kind", "i8"),
        ("centre", "f8", 3),
        ("axes", "f8", (3, 3)),
        ("size", "f8", 3),
        ("radius", "f8"),
        ("first", "i8"),
        ("last", "i8"),
        ("reach", "f8"),
    ],
    align=True,
)
AXIAL = 2.0**-40  # sine below which a direction is a frustum's axis but for round-off: its rims have no support then


@inner
def place(piece, p, q):
    """Frame of a piece in space: 12 floats, the centre and the three rows of its axes.

    p (triple): its body's B [length], q (w x y z): turns body components into space components.
    """
    w, x, y, z = q
    r0 = (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y))
    r1 = (2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x))
    r2 = (2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y))
    c = triple(piece.centre)
    a, b, d = triple(piece.axes[0]), triple(piece.axes[1]), triple(piece.axes[2])
    return (
        p[0] + dot(r0, c),
        p[1] + dot(r1, c),
        p[2] + dot(r2, c),
        dot(r0, a),
        dot(r1, a),
        dot(r2, a),
        dot(r0, b),
        dot(r1, b),
        dot(r2, b),
        dot(r0, d),
        dot(r1, d),
        dot(r2, d),
    )


@inner
def centre_of(frame):
    """Centre (triple) of a frame."""
    return (frame[0], frame[1], frame[2])


@inner
def axis_of(frame, k):
    """Axis k (unit triple, space components) of a frame."""
    if k == 0:
        return (frame[3], frame[4], frame[5])
    return (frame[6], frame[7], frame[8]) if k == 1 else (frame[9], frame[10], frame[11])


@inner
def to_piece(frame, d):
    """Direction in space axes -> piece axes."""
    return (
        frame[3] * d[0] + frame[4] * d[1] + frame[5] * d[2],
        frame[6] * d[0] + frame[7] * d[1] + frame[8] * d[2],
        frame[9] * d[0] + frame[10] * d[1] + frame[11] * d[2],
    )


@inner
def to_space(frame, x):
    """Direction in piece axes -> space axes."""
    return (
        frame[3] * x[0] + frame[6] * x[1] + frame[9] * x[2],
        frame[4] * x[0] + frame[7] * x[1] + frame[10] * x[2],
        frame[5] * x[0] + frame[8] * x[1] + frame[11] * x[2],
    )


@inner
def core_support(piece, vertices, d):
    """Support of the core in the direction d; both in piece axes, from the centre. vertices None: no polytopes here.

    Where a whole face faces d exactly, one of its points: a corner, the middle of a frustum's cap.
    """
    kind = piece.kind & 15
    if kind == BOX:
        return (np.copysign(piece.size[0], d[0]), np.copysign(piece.size[1], d[1]), np.copysign(piece.size[2], d[2]))
    if kind == FRUSTUM:
        across = np.sqrt(d[0] * d[0] + d[1] * d[1])
        top = (piece.size[1] - piece.size[0]) * across + 2.0 * piece.size[2] * d[2] > 0.0
        r = piece.size[1] if top else piece.size[0]
        per = r / across if across > 0.0 else 0.0
        return (per * d[0], per * d[1], piece.size[2] if top else -piece.size[2])
    if kind == ELLIPSOID:
        s = (piece.size[0] * d[0], piece.size[1] * d[1], piece.size[2] * d[2])
        size = norm(s)
        per = 1.0 / size if size > 0.0 else 0.0
        return (piece.size[0] * s[0] * per, piece.size[1] * s[1] * per, piece.size[2] * s[2] * per)
    if vertices is not None:
        if kind == POLYTOPE or kind == TRIANGLE:
            best, far = piece.first, -np.inf
            for k in range(piece.first, piece.last):
                h = vertices[k, 0] * d[0] + vertices[k, 1] * d[1] + vertices[k, 2] * d[2]
                if h > far:
                    best, far = k, h
            return (vertices[best, 0], vertices[best, 1], vertices[best, 2])
    return (0.0, 0.0, 0.0)


@inner
def support(piece, vertices, frame, d):
    """Point (triple, space) of the piece, its radius included, that lies farthest along the unit vector d."""
    x = to_space(frame, core_support(piece, vertices, to_piece(frame, d)))
    return along(add(centre_of(frame), x), piece.radius, d)


@inner
def height(piece, vertices, frame, d):
    """How far the piece extends from its centre along the unit vector d: its support function about the centre."""
    e = to_piece(frame, d)
    return dot(core_support(piece, vertices, e), e) + piece.radius


@inner
def feature_support(piece, x, d):
    """Support in the direction d of that feature alone to which the support point x belongs; all in piece axes.

    The features are corners, a frustum's two rims (and the middle of its caps), the ellipsoid's surface.
    """
    kind = piece.kind & 15
    if kind == ELLIPSOID:
        s = (piece.size[0] * d[0], piece.size[1] * d[1], piece.size[2] * d[2])
        per = 1.0 / norm(s)
        return (piece.size[0] * s[0] * per, piece.size[1] * s[1] * per, piece.size[2] * s[2] * per)
    across = np.sqrt(d[0] * d[0] + d[1] * d[1])
    if kind != FRUSTUM or (x[0] == 0.0 and x[1] == 0.0) or across <= AXIAL:
        return x
    r = piece.size[1] if x[2] > 0.0 else piece.size[0]
    return (r / across * d[0], r / across * d[1], x[2])


@inner
def feature_turn(piece, x, d, e):
    """Change of feature_support when the unit vector d changes by e (e across d): curvature radii [length] times e."""
    kind = piece.kind & 15
    if kind == ELLIPSOID:
        a, b, c = piece.size[0] ** 2, piece.size[1] ** 2, piece.size[2] ** 2
        hh = a * d[0] * d[0] + b * d[1] * d[1] + c * d[2] * d[2]
        h = np.sqrt(hh)
        f = (a * d[0] * e[0] + b * d[1] * e[1] + c * d[2] * e[2]) / hh
        return (a * (e[0] - f * d[0]) / h, b * (e[1] - f * d[1]) / h, c * (e[2] - f * d[2]) / h)
    across = np.sqrt(d[0] * d[0] + d[1] * d[1])
    if kind != FRUSTUM or (x[0] == 0.0 and x[1] == 0.0) or across <= AXIAL:
        return (0.0, 0.0, 0.0)
    r = piece.size[1] if x[2] > 0.0 else piece.size[0]
    t = r * (d[0] * e[1] - d[1] * e[0]) / (across * across * across)
    return (-t * d[1], t * d[0], 0.0)
