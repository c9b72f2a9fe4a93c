"""Prescribed motion in closed form: integrals of the laws, and bodies on a fixed axis placed by their angle."""

from __future__ import annotations

import numpy as np

from flowgmo.bodies.laws import integral, next_turn, value
from flowgmo.kernel import inner
from flowgmo.vectors import (
    add,
    cross,
    put,
    put4,
    quad,
    rotate,
    same_sign,
    scale,
    sub,
    triple,
    turned,
)

_UNTURNED = (1.0, 0.0, 0.0, 0.0)


@inner
def travel(laws, k, t0, t1, at, lo, hi):
    """Where a prescribed coordinate at `at` comes to; it waits at a stop until the law turns. Second: is it waiting?"""
    if not (np.isfinite(lo) or np.isfinite(hi)):
        return at + integral(laws, k, t0, t1), False
    t = t0
    waiting = False
    while t < t1:
        stop = min(t1, next_turn(laws, k, t))
        aim = at + integral(laws, k, t, stop)
        waiting = aim > hi or aim < lo
        at = min(max(aim, lo), hi)
        t = stop
    return at, waiting


@inner
def drive(body, row, laws, t0, t1):
    """Prescribed motion in closed form: translation of the driven point, turn about one body axis or a fixed axis."""
    if body.hinge == 1:
        k = body.drive[3]
        row.angle, waiting = travel(laws, k, t0, t1, row.angle, body.lo[3], body.hi[3])
        place_hinged(body, row, row.angle, 0.0 if waiting else value(laws, k, t1))
        return
    q = quad(row.q)
    reference = add(triple(row.p), rotate(q, body.reference))
    turn = (
        integral(laws, body.drive[3], t0, t1),
        integral(laws, body.drive[4], t0, t1),
        integral(laws, body.drive[5], t0, t1),
    )
    rates = (value(laws, body.drive[3], t1), value(laws, body.drive[4], t1), value(laws, body.drive[5], t1))
    q = turned(q, rotate(q, turn))  # one axis only (arrays.py), so the order of turns does not matter
    put4(row.q, q)
    put(row.w, rotate(q, rates))
    place_driven(body, row, laws, reference, t0, t1)


@inner
def place_driven(body, row, laws, reference, t0, t1):
    """p and v of a prescribed body: its driven point was at `reference` at t0, its q and w are those at t1."""
    q, w = quad(row.q), triple(row.w)
    if body.hinge == 2:
        arm = rotate(q, body.arm)
        put(row.p, add(body.point, arm))
        put(row.v, cross(w, arm))
        return
    for k in range(3):
        start = body.origin[k] + body.reference[k]
        away, waiting = travel(laws, body.drive[k], t0, t1, reference[k] - start, body.lo[k], body.hi[k])
        row.p[k] = start + away
        row.v[k] = 0.0 if waiting else value(laws, body.drive[k], t1)
    arm = rotate(q, body.reference)
    put(row.p, sub(triple(row.p), arm))
    put(row.v, sub(triple(row.v), cross(w, arm)))


@inner
def place_hinged(body, row, angle, rate):
    """Pose and velocity of a body on a fixed axis from its angle [rad] and rate."""
    axis = triple(body.axis)
    q = turned(_UNTURNED, scale(angle, axis))
    arm = rotate(q, body.arm)
    w = scale(rate, axis)
    put4(row.q, same_sign(q, quad(row.q)))
    put(row.w, w)
    put(row.p, add(body.point, arm))
    put(row.v, cross(w, arm))
