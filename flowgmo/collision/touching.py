"""Contact points of two pieces as the rest of the model sees them: features numbered over all pieces."""

from __future__ import annotations

from flowgmo.collision.convex import separation
from flowgmo.collision.manifold import contact_points
from flowgmo.kernel import inner

MOST_POINTS = 16  # contact points of two pieces
NEAR = 0.1  # a contact point this near to another, in reaches of the smaller piece, with its direction, is that one
ALIKE = 0.99  # cosine of the angle between two normals up to which they count as one direction
PIECES = 1 << 16  # pieces of a scene; two numbers and a feature below 2³¹ fit one integer
FEATURES = 1 << 31


@inner
def touching_points(sh, i, fi, j, fj, n0, within, points):
    """Contact points of pieces i and j (frames fi, fj) with gap <= within [length]: their number, distance, normal.

    points (MOST_POINTS,) of CONTACT get point, normal, gap, feature; n0: a normal near the right one, zeros: none known.
    """
    s, n, _, _, _ = separation(sh.pieces, sh.vertices, i, fi, j, fj, n0)
    if s > within:
        return 0, s, n
    count = contact_points(sh.pieces, sh.vertices, i, fi, j, fj, n, within, points)
    pair = (i * PIECES + j) * FEATURES
    for k in range(count):
        points[k].feature += pair
    return count, s, n
