"""Convex pieces that surfaces are made of, and what the search asks of each: its support.

    support of a piece in the direction d:   the point of the piece that lies farthest along d

A body is one piece or many (pieces.py); a piece is the sum of a core and a ball of radius `radius` about the origin.
"""

from __future__ import annotations

import numpy as np

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
