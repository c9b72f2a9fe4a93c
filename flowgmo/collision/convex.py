"""Signed separation of two pieces: how far apart, along which normal, between which points.

For convex pieces with the support functions h_i, h_j the separation along a unit vector n that points from j to i is

    s(n) = -h_i(-n) - h_j(n)        s = max s(n) over all n,

the distance if they are apart, minus the depth if they overlap. Apart, there is one maximum, found from the nearest
points (Gilbert, Johnson & Keerthi 1988). In contact these coincide and give no direction; overlapping, s(n)
has several local maxima, and the one of the present contact is wanted. Both are cured by one device, the shift: move i
along the present normal m by Δ and find the nearest points of the moved pieces, that is

    next m = argmax s(n) + Δ n·m        a proximal point step for max s(n): s(m) never falls.

With Δ = max(0, near - s(m)) the moved pieces are always `near` apart or more, so that the nearest points are well
conditioned. A fixed point has a - b parallel to n, the condition of a local maximum of s. Where flat parts meet (face,
crossing edges) the fixed point is reached in one or two steps; on smooth parts with the sum of curvature radii R the
error falls by Δ/(R + Δ) in each.

Every direction tried is kept only if it raises the dual bound n·w of the moved distance (w the support difference), so
that round-off in flat simplices cannot spoil the result, and s is returned as s(n): never above the true one.

Radii are added at the end. Balls and half spaces have closed forms (point_distance.py), holes have cavity.py.
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.cavity import inside_cavity
from flowgmo.collision.curved import newton_turn, put_row, refresh
from flowgmo.collision.point_distance import nearest_of_triangle, point_distance
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
    height,
    to_piece,
    to_space,
)
from flowgmo.kernel import inner
from flowgmo.vectors import add, along, cross, dot, norm, scale, sub, triple

NEAR = 2.0**-7  # moved distance over the size: normals are then good to 2^-52/2^-7 = 3e-14
STEPS = 100  # of the search for nearest points; 7 are usual, 40 the most seen
SHIFTS = 30  # proximal steps: 1 from the normal of the contact, up to 5 from none
GAP = 2.0**-50  # relative to the size of the two: a few units of round-off of the supports
ROUGH = 2.0**-30  # the same where Newton's method follows: it starts from normals good to the root, 3e-5
NEWTON = 6  # steps: the error is squared in each, from 3e-5 two are enough
CAP = 2.0**-12  # of a frustum's axis from the normal, for trying the axis itself
TURN = 2.0**-27  # last change of the normal: what is left is NEAR times this, or nothing at flat parts


@inner
def separation(pieces, vertices, i, frame_i, j, frame_j, n0):
    """Separation of the pieces i and j: (s [length], n, a, b, certain).

    frame_i, frame_j: from shapes.place. n0: the normal found last, zeros if none; while pieces overlap s is the local
    maximum near it (near the line of centres if there is none). n: unit, from j to i; a, b: points of the surfaces of
    i and j with a - b = s n, one pair of several where faces are parallel. certain: False where the overlap is deeper
    than NEAR of the size, so that another normal may be the better one, or the search ended at its bound: overlapping,
    a corner or a rim on a rim has no normal of its own, n then drifts slowly and s is right all the same. Two half
    spaces, two cavities: s = inf.
    vertices: (k, 3), or None: there are balls, half spaces, and what a ball meets in closed form only, and the general
    search is not compiled; other pairs then give -inf.
    """
    swap = pieces[i].kind > pieces[j].kind  # the higher kind is the simpler partner: cavity, half space; a ball last
    if swap:
        i, j, frame_i, frame_j, n0 = j, i, frame_j, frame_i, scale(-1.0, n0)
    one, two = pieces[i], pieces[j]
    certain = True
    s, n = -np.inf, (0.0, 0.0, 1.0)
    a, b = centre_of(frame_i), centre_of(frame_j)
    if two.kind >= CAVITY:
        s, n, a = inside_cavity(one, two, vertices, frame_i, frame_j, n0)
        b = along(a, -s, n)
    elif one.kind == POINT and two.kind != POLYTOPE:
        d, n = point_distance(two, vertices, frame_j, a, n0)
        s = d - one.radius - two.radius
        a = along(a, -one.radius, n)
        b = along(a, -s, n)
    elif two.kind == HALF_SPACE:
        n = axis_of(frame_j, 2)
        if one.kind != HALF_SPACE:
            a = along(
                add(a, to_space(frame_i, core_support(one, vertices, to_piece(frame_i, scale(-1.0, n))))),
                -one.radius,
                n,
            )
            s = dot(sub(a, b), n) - two.radius
        else:
            s = np.inf
        b = along(a, -s, n)
    elif vertices is not None:
        s, n, a, b, certain = _search(one, two, vertices, frame_i, frame_j, n0)
    else:
        certain = False
    certain = certain and s >= -NEAR * min(one.reach, two.reach)
    if swap:
        return s, scale(-1.0, n), b, a, certain
    return s, n, a, b, certain


@inner
def support_gap(pieces, vertices, i, frame_i, j, frame_j, n):
    """s(n) [length], the separation along the unit vector n, from j to i: a lower bound of the distance of two convex
    pieces, and equal to it for the normal that `separation` gives.

    A half space has one normal, which is taken for n. For a piece in a cavity: the room between the tangent planes
    across n, an upper bound of the separation.
    """
    one, two = pieces[i], pieces[j]
    if one.kind == HALF_SPACE:
        n = scale(-1.0, axis_of(frame_i, 2))
    elif two.kind == HALF_SPACE:
        n = axis_of(frame_j, 2)
    back = scale(-1.0, n)
    s = dot(sub(centre_of(frame_i), centre_of(frame_j)), n)
    if two.kind >= CAVITY:
        return s + height(two, vertices, frame_j, back) - height(one, vertices, frame_i, back)
    if one.kind >= CAVITY:
        return s + height(one, vertices, frame_i, n) - height(two, vertices, frame_j, n)
    return s - height(one, vertices, frame_i, back) - height(two, vertices, frame_j, n)


@inner
def _supports(one, two, vertices, frame_i, frame_j, c, n):
    """Supports a of i along -n and b of j along n, from the centre of j; c: centre of i from that of j."""
    a = add(c, to_space(frame_i, core_support(one, vertices, to_piece(frame_i, scale(-1.0, n)))))
    return a, to_space(frame_j, core_support(two, vertices, to_piece(frame_j, n)))


@inner
def _start(two, vertices, frame_j, c, n0):
    """First direction: the last normal, else outwards from a triangle, else from centre to centre."""
    if dot(n0, n0) > 0.0:
        return n0
    if two.kind == TRIANGLE:
        a = triple(vertices[two.first])
        face = cross(sub(triple(vertices[two.first + 1]), a), sub(triple(vertices[two.first + 2]), a))
        return scale(1.0 / norm(face), to_space(frame_j, face))
    d = norm(c)
    return scale(1.0 / d, c) if d > 0.0 else (0.0, 0.0, 1.0)


@inner
def _reduce(simplex, count, offset):
    """Nearest point v to the origin of the moved simplex (rows: a, b, weight); rows with no weight are dropped.

    With four rows the newest, which lies nearer than the plane of the others, is a corner of the nearest face.
    """
    last = count - 1
    least = np.inf
    v = (0.0, 0.0, 0.0)
    keep = (last, last, last)
    weights = (1.0, 0.0, 0.0)
    x = _row(simplex, last, offset)
    for k in range(3 if count == 4 else 1):
        p = k if count > 1 else 0
        q = (k + 1) % 3 if count > 2 else p
        y, wx, wp, wq = nearest_of_triangle(x, _row(simplex, p, offset), _row(simplex, q, offset))
        if dot(y, y) < least:
            least, v, keep, weights = dot(y, y), y, (last, p, q), (wx, wp, wq)
    # copied in rising order: no row is overwritten before it is read
    count = np.int64(0)
    for k in range(last + 1):
        weight = (weights[0] if k == keep[0] else 0.0) + (weights[1] if k == keep[1] else 0.0)
        weight += weights[2] if k == keep[2] else 0.0
        if weight > 0.0:
            for m in range(6):
                simplex[count, m] = simplex[k, m]
            simplex[count, 6] = weight
            count += 1
    return v, count


@inner
def _row(simplex, k, offset):
    """a - b + offset of a row."""
    return (
        simplex[k, 0] - simplex[k, 3] + offset[0],
        simplex[k, 1] - simplex[k, 4] + offset[1],
        simplex[k, 2] - simplex[k, 5] + offset[2],
    )


@inner
def _sharpen(one, two, vertices, frame_i, frame_j, c, n, s, simplex, count, noise):
    """Newton's method for the normal from the search's rows (curved.py): n, s, number of rows, and whether it ended."""
    for k in range(2):
        # a cap meets a face along its own axis, where its rim has no direction
        piece, frame = (one, frame_i) if k == 0 else (two, frame_j)
        axis = axis_of(frame, 2)
        if piece.kind == FRUSTUM and norm(cross(axis, n)) < CAP:
            m = scale(np.copysign(1.0, dot(axis, n)), axis)
            a, b = _supports(one, two, vertices, frame_i, frame_j, c, m)
            at = dot(sub(a, b), m)
            if at >= s - noise:
                return m, at, count, True
    last = 2.0**-9  # sharpening only: what turns further is the work of the search
    for _ in range(NEWTON):
        rows = refresh(one, two, frame_i, frame_j, c, n, simplex, count)
        turn, defined = newton_turn(one, two, frame_i, frame_j, c, n, simplex, rows)
        size = norm(turn)
        count = rows
        if not defined or size > 0.5 * last:
            return n, s, count, False
        m = add(n, turn)
        m = scale(1.0 / norm(m), m)
        a, b = _supports(one, two, vertices, frame_i, frame_j, c, m)
        at = dot(sub(a, b), m)
        if at < s - noise:
            return n, s, count, False
        n, s, last = m, at, max(size, TURN)
        if size <= TURN:
            return n, s, count, True
    return n, s, count, False


@inner
def _nearest(one, two, vertices, frame_i, frame_j, c, n, offset, simplex, count, enough):
    """Nearest points of the moved pieces (Gilbert, Johnson & Keerthi 1988), from the rows there are.

    Returns the direction of the best bound, s along it, the number of rows, and whether it ended: the bound is `enough`
    below the distance, or round-off hides what is nearer.
    """
    m, s, best = n, -np.inf, -np.inf
    v, count = _reduce(simplex, count, offset)
    for _ in range(STEPS):
        size = norm(v)
        u = scale(1.0 / size, v) if size > 0.0 else n
        a, b = _supports(one, two, vertices, frame_i, frame_j, c, u)
        along_u = dot(sub(a, b), u)
        bound = along_u + dot(offset, u)
        if bound > best:
            best, m, s = bound, u, along_u
        if size - bound <= enough:
            return m, s, count, True
        put_row(simplex, count, a, b, 0.0)
        v, count = _reduce(simplex, count + 1, offset)
        if norm(v) >= size:
            return m, s, count, True
    return m, s, count, False


@inner
def _search(one, two, vertices, frame_i, frame_j, n0):
    """Separation of two convex cores by proximal steps; see the top of this file."""
    c = sub(centre_of(frame_i), centre_of(frame_j))
    near = NEAR * np.sqrt(one.reach * two.reach)
    noise = GAP * (one.reach + two.reach)
    n = _start(two, vertices, frame_j, c, n0)
    a, b = _supports(one, two, vertices, frame_i, frame_j, c, n)
    s = dot(sub(a, b), n)
    simplex = np.empty((4, 7))
    put_row(simplex, 0, a, b, 1.0)
    count = np.int64(1)
    certain = False
    curved = two.kind == ELLIPSOID or two.kind == FRUSTUM or one.kind == ELLIPSOID or one.kind == FRUSTUM
    enough = ROUGH * (one.reach + two.reach) if curved else noise
    doubt, deep, n_deep = 0, s, n
    for _ in range(SHIFTS):
        delta = 0.0 if doubt == 1 else max(near - s, 0.0)
        offset = scale(delta, n)
        m, s, count, ended = _nearest(one, two, vertices, frame_i, frame_j, c, n, offset, simplex, count, enough)
        if curved:
            m, s, count, sharp = _sharpen(one, two, vertices, frame_i, frame_j, c, m, s, simplex, count, noise)
            enough = enough if sharp else noise
        turn = norm(sub(m, n))
        n = m
        if doubt == 1:
            doubt = 2
            if s <= deep:
                n, s = n_deep, deep
                a, b = _supports(one, two, vertices, frame_i, frame_j, c, n)
                put_row(simplex, 0, a, b, 1.0)
                count = np.int64(1)
                break
        elif delta == 0.0 or turn <= TURN:
            if s >= -near or doubt > 0:
                certain = ended
                break
            doubt, deep, n_deep = 1, s, n  # a deep local maximum from a bad start? without a shift that would show
    if curved:
        count = refresh(one, two, frame_i, frame_j, c, n, simplex, count)
        v, count = _reduce(simplex, count, scale(max(near - s, 0.0), n))  # weights for the sharpened rows
    b = centre_of(frame_j)
    for k in range(count):
        b = along(b, simplex[k, 6], (simplex[k, 3], simplex[k, 4], simplex[k, 5]))
    b = along(b, two.radius, n)
    s -= one.radius + two.radius
    a = along(b, s, n)
    return s, n, a, b, certain
