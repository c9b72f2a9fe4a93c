"""Which contacts of a body of several pieces are contacts of the body: where pieces overlap or meet flush, none is.

The search looks at one piece at a time. At the seam of two boxes that form one floor it may find the upper edge of the
hidden side of one box, with a normal along the floor. A contact of the piece P at x with the normal n is one of the
body when the feature that it touches,

    F = {y in P : n · (y - x) = 0}    a face, an edge, a line, or x alone

has, however near to x, points that no other piece of the body holds. On a flush floor the hidden side has none and the
upper edge neither, the upper face has; in the corner of an L the wall has, right down to the floor.
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.shapes import BOX, ELLIPSOID, FRUSTUM, HALF_SPACE, POINT
from flowgmo.kernel import inner
from flowgmo.vectors import add, norm, scale, sub, times, triple, without

SLACK = 1e-9  # of the reach: a point so near to a piece is in it; surface points are found to 1e-12
STEP = 1e-4  # of the reach: near to x; normals within SLACK / STEP = 1e-5 rad of a face's count as the face's
CLEAR = 0.1  # of the step: how far it must lead out of the other pieces, or it runs along the seam


@inner
def _holds(piece, x, slack):
    """Whether x (body axes, from B) is in a piece, or about `slack` from it; never in a triangle or a polytope."""
    r = times(piece.axes, sub(x, triple(piece.centre)))
    kind = piece.kind
    if kind == POINT:
        return norm(r) <= piece.radius + slack
    if kind == BOX:
        s = piece.size
        return abs(r[0]) <= s[0] + slack and abs(r[1]) <= s[1] + slack and abs(r[2]) <= s[2] + slack
    if kind == FRUSTUM:
        h = piece.size[2]
        t = min(max(0.5 * (r[2] / h + 1.0), 0.0), 1.0)
        radius = piece.size[0] + t * (piece.size[1] - piece.size[0])
        return abs(r[2]) <= h + slack and np.sqrt(r[0] * r[0] + r[1] * r[1]) <= radius + slack
    if kind == ELLIPSOID:
        s = piece.size
        return norm((r[0] / (s[0] + slack), r[1] / (s[1] + slack), r[2] / (s[2] + slack))) <= 1.0
    return kind == HALF_SPACE and r[2] <= slack


@inner
def _in_another(shapes, i, x, slack):
    """Whether a piece other than i of the same body holds x."""
    party = shapes.pieces[i].body
    k = shapes.first_node[party]
    end = shapes.first_node[party + 1]
    while k < end:
        node = shapes.nodes[k]
        apart = False
        for m in range(3):
            apart = apart or abs(x[m] - node.centre[m]) > node.half[m] + slack
        if apart:
            k = node.after
            continue
        if node.piece >= 0 and node.piece != i and _holds(shapes.pieces[node.piece], x, slack):
            return True
        k += 1
    return False


@inner
def exposed(shapes, i, x, n):
    """Whether a contact of piece i at its surface point x with the normal n (from B, body axes) is one of its body.

    True for every contact of a body of one piece; hidden by boxes, balls, frustums, ellipsoids, and half-spaces only.
    Where True is returned for a seam by rounding, a contact too many is found, never one too few.
    """
    party = shapes.pieces[i].body
    if shapes.first_piece[party + 1] - shapes.first_piece[party] == 1:
        return True
    piece = shapes.pieces[i]
    reach = piece.reach if piece.reach < np.inf else norm(sub(x, triple(piece.centre)))
    slack = SLACK * reach
    if not _in_another(shapes, i, x, slack):
        return True
    if piece.kind != BOX and piece.kind != FRUSTUM and piece.kind != HALF_SPACE:
        return not _in_another(shapes, i, x, -slack)  # on the crease of two curved pieces both are touched
    for code in range(27):  # the ways to go from x along the piece's axes, those that stay on the feature count
        d = (0.0, 0.0, 0.0)
        for k in range(3):
            part = code // (1 if k == 0 else 3 if k == 1 else 9) % 3 - 1
            d = add(d, scale(float(part), triple(piece.axes[k])))
        d = without(d, n)
        length = norm(d)
        if length < 0.1:  # along n: no direction of the feature
            continue
        y = add(x, scale(STEP * reach / length, d))
        if _holds(piece, y, slack) and not _in_another(shapes, i, y, CLEAR * STEP * reach):
            return True
    return False
