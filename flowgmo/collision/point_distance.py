"""Signed distance of a point from the core of a piece, with its gradient: all that a ball needs to know about it.

    d(x) = min |x - y| over the surface, negative inside;   grad d = the outward unit normal at the nearest point y

Box, frustum (a trapezoid in the half plane of x and the axis) and triangle: by regions. Ellipsoid: the nearest point is
y_k = a_k² x_k / (t + a_k²) where t solves

    F(t) = Σ (a_k x_k / (t + a_k²))² - 1 = 0,   t > -a_min²

F falls and is convex there, so that Newton's steps from a point left of the root never pass it (Eberly 2013, "Distance
from a point to an ellipse, an ellipsoid, or a hyperellipsoid"). Then d = t |(x_k / (t + a_k²))|.
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.shapes import (
    BOX,
    ELLIPSOID,
    FRUSTUM,
    HALF_SPACE,
    TRIANGLE,
    axis_of,
    centre_of,
    to_piece,
    to_space,
)
from flowgmo.kernel import inner
from flowgmo.vectors import along, cross, dot, norm, scale, sub, triple

NEWTON = 60  # steps; 3 to 6 are usual, more where the root lies near a pole and each step goes half as far again


@inner
def point_distance(piece, vertices, frame, x, n0):
    """Signed distance d [length] of the point x (space) from a core (no polytope), and its gradient n (unit, space).

    n0: the normal found last, or zeros: where several points are nearest (x in a centre) n is n0, if it is a choice. A
    triangle has no inside: d >= 0, but d < 0 for a point that has sunk into it with n0 on its outer side.
    Exact to a few units of round-off of the size.
    """
    kind = piece.kind & 15
    y = to_piece(frame, sub(x, centre_of(frame)))
    if kind == HALF_SPACE:
        return y[2], axis_of(frame, 2)
    if kind == BOX:
        d, m = _box(piece.size, y)
    elif kind == FRUSTUM:
        d, m = _frustum(piece.size, y)
    elif kind == ELLIPSOID:
        d, m = _ellipsoid(piece.size, y)
    else:
        m0 = to_piece(frame, n0)
        if vertices is not None and kind == TRIANGLE:
            d, m = _triangle(vertices, piece.first, y, m0)
        else:
            d = norm(y)
            m = scale(1.0 / d, y) if d > 0.0 else (m0 if dot(m0, m0) > 0.0 else (0.0, 0.0, 1.0))
    return d, to_space(frame, m)


@inner
def _box(size, y):
    """Outside: the vector from the clamped point. Inside: the nearest face."""
    over = (abs(y[0]) - size[0], abs(y[1]) - size[1], abs(y[2]) - size[2])
    out = (max(over[0], 0.0), max(over[1], 0.0), max(over[2], 0.0))
    d = norm(out)
    if d > 0.0:
        m = (out[0] / d, out[1] / d, out[2] / d)
    elif over[0] >= over[1] and over[0] >= over[2]:
        d, m = over[0], (1.0, 0.0, 0.0)
    elif over[1] >= over[2]:
        d, m = over[1], (0.0, 1.0, 0.0)
    else:
        d, m = over[2], (0.0, 0.0, 1.0)
    return d, (np.copysign(m[0], y[0]), np.copysign(m[1], y[1]), np.copysign(m[2], y[2]))


@inner
def _frustum(size, y):
    """In the half plane (distance from the axis, height): a trapezoid with two caps and a side."""
    r0, r1, h = size[0], size[1], size[2]
    q = np.sqrt(y[0] * y[0] + y[1] * y[1])
    length = np.sqrt((r1 - r0) ** 2 + 4.0 * h * h)
    eq, ez = (r1 - r0) / length, 2.0 * h / length  # along the side, upwards; its outward normal is (ez, -eq)
    side = ez * (q - r0) - eq * (y[2] + h)
    cap = abs(y[2]) - h
    mq, mz, d = 0.0, np.copysign(1.0, y[2]), cap
    if side <= 0.0 and cap <= 0.0:
        if side > cap:
            mq, mz, d = ez, -eq, side
    elif cap < 0.0 or q > (r1 if y[2] > 0.0 else r0):
        t = eq * (q - r0) + ez * (y[2] + h)
        if t < 0.0 or t > length:
            dq, dz = (q - r0, y[2] + h) if t < 0.0 else (q - r1, y[2] - h)
            d = np.sqrt(dq * dq + dz * dz)
            mq, mz = dq / d, dz / d
        else:
            mq, mz, d = ez, -eq, side
    return d, ((mq * y[0] / q, mq * y[1] / q, mz) if q > 0.0 else (mq, 0.0, mz))


@inner
def _ellipsoid(size, y):
    """Root of F by Newton's method from the left; a point of the middle plane whose root is the pole, apart."""
    a, b, c = size[0] * size[0], size[1] * size[1], size[2] * size[2]
    u, v, w = abs(size[0] * y[0]), abs(size[1] * y[1]), abs(size[2] * y[2])
    least = min(a, b, c)
    t = max(u - a, v - b, w - c)  # one term of F alone is 1 here and the others at most 1: 0 <= F <= 2
    if t <= -least:
        # in the plane of the longer axes: if F < 0 at the pole, the nearest points lie off it, on either side
        p = size[0] * y[0] / (a - least) if a > least else 0.0
        q = size[1] * y[1] / (b - least) if b > least else 0.0
        r = size[2] * y[2] / (c - least) if c > least else 0.0
        rest = 1.0 - p * p - q * q - r * r
        if rest >= 0.0:
            if a == least:
                p = np.copysign(np.sqrt(rest), y[0])
            elif b == least:
                q = np.copysign(np.sqrt(rest), y[1])
            else:
                r = np.copysign(np.sqrt(rest), y[2])
            g = (p / size[0], q / size[1], r / size[2])
            length = norm(g)
            return -least * length, scale(1.0 / length, g)
        t = np.nextafter(-least, np.inf)
    for _ in range(NEWTON):
        p, q, r = u / (t + a), v / (t + b), w / (t + c)
        slope = p * p / (t + a) + q * q / (t + b) + r * r / (t + c)
        step = 0.5 * (p * p + q * q + r * r - 1.0) / slope
        if not t + step > t:
            break
        t += step
    g = (y[0] / (t + a), y[1] / (t + b), y[2] / (t + c))
    length = norm(g)
    return t * length, scale(1.0 / length, g)


@inner
def nearest_of_triangle(a, b, c):
    """Nearest point to the origin of the triangle a, b, c (it may be a segment or a point), and its three weights.

    In the plane: v = n (n·a)/(n·n), n = (b - a) × (c - a), weights n·((b - v) × (c - v))/(n·n) and so on, taken from
    differences to v so that small triangles lose nothing. If one is negative, the nearest point of the three sides.
    """
    n = cross(sub(b, a), sub(c, a))
    nn = dot(n, n)
    if nn > 0.0:
        v = scale(dot(n, a) / nn, n)
        av, bv, cv = sub(a, v), sub(b, v), sub(c, v)
        p, q, r = dot(n, cross(bv, cv)) / nn, dot(n, cross(cv, av)) / nn, dot(n, cross(av, bv)) / nn
        if p > 0.0 and q > 0.0 and r > 0.0:
            return v, p, q, r
    least = np.inf
    v, p, q, r = a, 1.0, 0.0, 0.0
    s, e = a, b
    for k in range(3):
        if k == 1:
            s, e = b, c
        elif k == 2:
            s, e = c, a
        d = sub(e, s)
        dd = dot(d, d)
        t = min(max(-dot(s, d) / dd, 0.0), 1.0) if dd > 0.0 else 0.0
        x = along(s, t, d) if t < 1.0 else e
        if dot(x, x) < least:
            least, v = dot(x, x), x
            p = 1.0 - t if k == 0 else (t if k == 2 else 0.0)
            q = t if k == 0 else (1.0 - t if k == 1 else 0.0)
            r = t if k == 1 else (1.0 - t if k == 2 else 0.0)
    return v, p, q, r


@inner
def _triangle(vertices, first, y, m0):
    """From the nearest point; a point behind the face, with m0 in front, lies -d deep."""
    a, b, c = triple(vertices[first]), triple(vertices[first + 1]), triple(vertices[first + 2])
    face = cross(sub(b, a), sub(c, a))
    face = scale(1.0 / norm(face), face)
    v, p, q, r = nearest_of_triangle(sub(a, y), sub(b, y), sub(c, y))
    d = norm(v)
    behind = dot(face, v) >= 0.0 and p > 0.0 and q > 0.0 and r > 0.0
    if d == 0.0 or (behind and dot(face, m0) > 0.0):
        return -d, face
    return d, scale(-1.0 / d, v)
