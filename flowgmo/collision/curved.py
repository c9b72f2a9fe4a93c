"""Newton's method for the normal of two pieces, one of them curved: sharpens what the search for nearest points found.

Near its maximum s(n) is the smallest of a few smooth functions, one for each pair of features that touches (corner,
rim, ellipsoid): s_k(n) = n·w_k(n), w_k = a_k - b_k their support points, ∇s_k = w_k, and w_k changes by -H_k δ when n
turns by δ (H_k: sum of the curvature radii, a tensor across n). At the maximum, with weights λ_k >= 0 of sum one,

    all s_k are equal,     Σ λ_k w_k ∥ n

Newton's step δ across n, with d_k = w_k - w_0 across n, Q = Σ λ_k H_k + s:

    one pair        Q δ = w_0
    two pairs       d_1·δ = s_0 - s_1;  and along q, across n and d_1:  q·Q δ = q·w_0
    three pairs     d_1·δ = s_0 - s_1,  d_2·δ = s_0 - s_2

The error is squared in each step, where the nearest points alone give the normal of a curved surface to no better than
the root of round-off. A step counts only if s does not fall.
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.shapes import feature_support, feature_turn, to_piece, to_space
from flowgmo.kernel import inner
from flowgmo.vectors import add, along, cross, dot, norm, scale, sub


@inner
def across(n):
    """Two unit vectors t1, t2 across the unit vector n; -n gives t1 and -t2."""
    x, y, z = abs(n[0]), abs(n[1]), abs(n[2])
    e = (1.0, 0.0, 0.0) if x <= y and x <= z else ((0.0, 1.0, 0.0) if y <= z else (0.0, 0.0, 1.0))
    t = along(e, -dot(e, n), n)
    t = scale(1.0 / norm(t), t)
    return t, cross(n, t)


@inner
def put_row(simplex, k, a, b, weight):
    """Write row k of a simplex."""
    simplex[k, 0], simplex[k, 1], simplex[k, 2] = a
    simplex[k, 3], simplex[k, 4], simplex[k, 5] = b
    simplex[k, 6] = weight


@inner
def refresh(one, two, frame_i, frame_j, c, n, simplex, count):
    """Support points of the rows' features for the normal n; rows that become the same are joined. Returns how many.

    simplex: rows a, b (triples, space, from the centre of j), weight. c: centre of i from that of j.
    """
    di, dj = to_piece(frame_i, scale(-1.0, n)), to_piece(frame_j, n)
    kept = np.int64(0)
    for k in range(count):
        x = to_piece(frame_i, sub((simplex[k, 0], simplex[k, 1], simplex[k, 2]), c))
        a = add(c, to_space(frame_i, feature_support(one, x, di)))
        y = to_piece(frame_j, (simplex[k, 3], simplex[k, 4], simplex[k, 5]))
        b = to_space(frame_j, feature_support(two, y, dj))
        weight = simplex[k, 6]
        same = kept
        for m in range(kept):
            p = (simplex[m, 0], simplex[m, 1], simplex[m, 2])
            q = (simplex[m, 3], simplex[m, 4], simplex[m, 5])
            if norm(sub(a, p)) + norm(sub(b, q)) <= 2.0**-40 * (one.reach + two.reach):  # equal but for round-off
                same = m
        if same < kept:
            simplex[same, 6] += weight
        else:
            put_row(simplex, kept, a, b, weight)
            kept += 1
    return kept


@inner
def _curvature(one, two, frame_i, frame_j, c, n, simplex, count, t1, t2):
    """Q11, Q12, Q22 in the directions t1, t2 across n, but for the term s: weighted sum of the curvature radii."""
    q11, q12, q22 = 0.0, 0.0, 0.0
    for k in range(2 * count):
        row = k // 2
        if k % 2 == 0:
            piece, frame, d, x = (
                one,
                frame_i,
                scale(-1.0, n),
                sub((simplex[row, 0], simplex[row, 1], simplex[row, 2]), c),
            )
        else:
            piece, frame, d, x = two, frame_j, n, (simplex[row, 3], simplex[row, 4], simplex[row, 5])
        y, e, p1, p2 = to_piece(frame, x), to_piece(frame, d), to_piece(frame, t1), to_piece(frame, t2)
        turn1, turn2 = feature_turn(piece, y, e, p1), feature_turn(piece, y, e, p2)
        q11 += simplex[row, 6] * dot(turn1, p1)
        q12 += simplex[row, 6] * dot(turn1, p2)
        q22 += simplex[row, 6] * dot(turn2, p2)
    return q11, q12, q22


@inner
def newton_turn(one, two, frame_i, frame_j, c, n, simplex, count):
    """Newton's step δ (triple, across n) from fresh rows (at most three), and whether it is defined."""
    t1, t2 = across(n)
    w0 = sub((simplex[0, 0], simplex[0, 1], simplex[0, 2]), (simplex[0, 3], simplex[0, 4], simplex[0, 5]))
    s = dot(w0, n)
    flat = 2.0**-30 * (one.reach + two.reach)  # curvature radii and distances below it are corners, not curves
    far, d1, s1, area, d2, s2 = 0.0, w0, s, 0.0, w0, s
    for k in range(1, count):
        w = sub((simplex[k, 0], simplex[k, 1], simplex[k, 2]), (simplex[k, 3], simplex[k, 4], simplex[k, 5]))
        d = sub(w, w0)
        d = along(d, -dot(d, n), n)
        if norm(d) > far:
            d2, s2 = d1, s1
            far, d1, s1 = norm(d), d, dot(w, n)
        else:
            d2, s2 = d, dot(w, n)
    if count == 3:
        area = dot(n, cross(d1, d2))
    if abs(area) > 2.0**-20 * far * norm(d2) and count == 3:  # three on one line say no more than two
        return scale(1.0 / area, add(scale(s - s1, cross(d2, n)), scale(s - s2, cross(n, d1)))), True
    if far > flat:
        t1 = scale(1.0 / far, d1)
        t2 = cross(n, t1)
    q11, q12, q22 = _curvature(one, two, frame_i, frame_j, c, n, simplex, count, t1, t2)
    q11, q22 = q11 + s, q22 + s
    if far > flat:
        if q22 <= flat:
            return (0.0, 0.0, 0.0), False
        x = (s - s1) / far
        return add(scale(x, t1), scale((dot(w0, t2) - q12 * x) / q22, t2)), True
    det = q11 * q22 - q12 * q12
    if det <= flat * flat or q11 <= flat:
        return (0.0, 0.0, 0.0), False
    x, y = dot(w0, t1), dot(w0, t2)
    return add(scale((q22 * x - q12 * y) / det, t1), scale((q11 * y - q12 * x) / det, t2)), True
