"""Between two events a ball runs on one leg: a path that needs no more than its start to be known at any time.

    AT_REST   does not move                       FLIGHT    parabola, or constant acceleration on flats underneath
    SERIES    ever smaller bounces on one flat    GENERAL   hinged, driven, loaded balls: motion.fly from the start

A ball's row stands at the start of its leg, LEG.t; nobody is moved before something happens to it.
"""

from __future__ import annotations

import numpy as np

from flowgmo.bodies.motion import fly
from flowgmo.bodies.stops import first_crossing
from flowgmo.collision.balls.distance import box_distance
from flowgmo.collision.balls.resting import friction_loss, plane_leg, series_state
from flowgmo.kernel import inner
from flowgmo.vectors import (
    add,
    along,
    cross,
    dot,
    norm,
    put,
    put4,
    quad,
    rotate,
    scale,
    sub,
    triple,
    turned,
    turned_linearly,
    without,
)

AT_REST, FLIGHT, SERIES, GENERAL = 0, 1, 2, 3
GOES_ON, ROLLS, LEAVES, RESTS = 0, 1, 2, 3  # why a leg ends: cut, slip ends, over the edge of a face, series over
OK, SEVERAL_ROUGH = 0, 1
SEPARATING = 1e-13  # normal speed below this part of |v| + sqrt(g R) is none: round-off of a contact velocity
IN_IMPACTS, IN_FRICTION = 0, 1  # State.books

#: One ball's leg: start t, mode, acceleration, angular acceleration, force of the flats, end and why. A series keeps
#: its flat (-1: none), normal, e, mu; and what its bounces so far add up to.
LEG = np.dtype(
    [
        ("t", "f8"),
        ("mode", "i8"),
        ("acc", "f8", 3),
        ("alp", "f8", 3),
        ("force", "f8", 3),
        ("ground", "f8", 3),
        ("until", "f8"),
        ("why", "i8"),
        ("slides", "i8"),
        ("flat", "i8"),
        ("normal", "f8", 3),
        ("e", "f8"),
        ("mu", "f8"),
        ("impulse", "f8", 3),
        ("loss", "f8"),
        ("bounces", "i8"),
    ],
    align=True,
)


@inner
def speed_tolerance(ball, body, v):
    """Normal speed [length/time] that counts as none for a ball at velocity v."""
    return SEPARATING * (norm(v) + np.sqrt(norm(body.gravity) * ball.radius))


@inner
def start_leg(i, sc, A, M, L, now, end):
    """Choose ball i's leg from its row at `now` in a step until `end`: supports that press stay. Returns a status."""
    ball = sc.balls[i]
    leg = L[i]
    body = A[ball.body]
    row = M[ball.body]
    leg.t = now
    leg.until = np.inf
    leg.why = GOES_ON
    leg.slides = 0
    put(leg.force, (0.0, 0.0, 0.0))
    put(leg.alp, (0.0, 0.0, 0.0))
    put(leg.acc, body.gravity)
    if not ball.parabolic:
        leg.mode = AT_REST if body.motion == 0 else GENERAL
        return OK
    leg.mode = FLIGHT
    count = 0
    for k in range(3):
        if row.support[k] >= 0:
            count += 1
    if count == 0:
        return OK
    normals = np.zeros((3, 3))
    press = np.zeros(3)
    if _pressures(ball, body, row, sc, normals, press) == 0:
        return OK
    pressing = 0
    rough = False
    for k in range(3):
        if press[k] > 0.0:
            n = triple(normals[k])
            pressing += 1
            rough = rough or sc.pairs[ball.body, sc.flats[row.support[k]].party].mu > 0.0
            put(row.v, along(triple(row.v), -dot(row.v, n), n))  # speed left over by round-off
            put(leg.ground, n)
    if pressing > 1 and rough:
        return SEVERAL_ROUGH
    for k in range(3):
        if press[k] > 0.0:
            n = triple(normals[k])
            if pressing == 1:
                mu = sc.pairs[ball.body, sc.flats[row.support[k]].party].mu
                _stand(sc.rough, ball, body, row, leg, n, mu, now, end)
            else:
                put(leg.acc, along(triple(leg.acc), press[k], n))
                put(leg.force, along(triple(leg.force), body.mass * press[k], n))
    for k in range(3):
        if press[k] > 0.0:
            out = now + _time_on_face(row, leg, sc.flats[row.support[k]], triple(normals[k]))
            if out < leg.until:
                leg.until = out
                leg.why = LEAVES
    return OK


@inner
def _stand(rough, ball, body, row, leg, n, mu, now, end):
    """The leg of a ball pressed on one flat with normal n."""
    g = triple(body.gravity)
    if rough is not None:
        acc, alp, force, lasts, slides, rolls = plane_leg(
            triple(row.v), triple(row.w), n, g, mu, ball.radius, body.mass, 1.0 / ball.inverse_inertia, end - now
        )
        put(leg.acc, acc)
        put(leg.alp, alp)
        put(leg.force, force)
        leg.until = now + lasts
        leg.slides = slides
        leg.why = ROLLS if rolls else GOES_ON
        return
    put(leg.acc, without(g, n))
    put(leg.force, scale(-body.mass * dot(g, n), n))


@inner
def _pressures(ball, body, row, sc, normals, press):
    """Smooth supports: press (3,) [length/time²] with g + Σ press n not entering any, by projected Gauss-Seidel.

    Supports that the ball leaves, or that do not press, are taken from the row. Returns how many press.
    """
    tolerance = speed_tolerance(ball, body, row.v)
    for k in range(3):
        if row.support[k] < 0:
            continue
        _, n, _ = box_distance(triple(row.p), sc.flats[row.support[k]])
        if abs(dot(row.v, n)) > tolerance:
            row.support[k] = -1
        else:
            put(normals[k], n)
    for _ in range(200):  # one sweep where the normals are orthogonal; 200 for wedges as narrow as 10 degrees
        change = 0.0
        for k in range(3):
            if row.support[k] < 0:
                continue
            n = triple(normals[k])
            a = dot(body.gravity, n)
            for j in range(3):
                if j != k:
                    a += press[j] * dot(triple(normals[j]), n)
            new = max(0.0, -a)
            change = max(change, abs(new - press[k]))
            press[k] = new
        if change <= 1e-16 * norm(body.gravity):
            break
    count = 0
    for k in range(3):
        if press[k] > 0.0:
            count += 1
        else:
            row.support[k] = -1
    return count


@inner
def _time_on_face(row, leg, flat, n):
    """How long the contact point stays on the face of the flat it stands on [time]."""
    first = np.inf
    for axis in range(3):
        a = triple(flat.axes[axis])
        if abs(dot(a, n)) > 0.5:
            continue
        y = dot(a, sub(triple(row.p), triple(flat.origin)))
        v = dot(a, row.v)
        pull = dot(a, leg.acc)
        if np.isfinite(flat.hi[axis]):
            first = min(first, first_crossing(flat.hi[axis] - y, v, pull))
        if np.isfinite(flat.lo[axis]):
            first = min(first, first_crossing(y - flat.lo[axis], -v, -pull))
    return first


@inner
def run_leg(ball, body, row, leg, laws, rough, books, t, hits):
    """Bring a ball's row from the start of its leg to time t, and book what the leg lost. False: integration failed.

    The leg itself is not changed, but for what its bounces add up to.
    """
    dt = t - leg.t
    mode = leg.mode
    if dt <= 0.0 or mode == AT_REST:
        return True
    if mode == FLIGHT:
        _run_evenly(rough, ball, row, leg, books, dt)
        return True
    if mode == SERIES:
        p, q, v, w, impulse, loss, bounces = series_state(
            triple(row.p), quad(row.q), triple(row.v), triple(row.w), triple(leg.normal), triple(body.gravity),
            leg.e, leg.mu, ball.radius, ball.inverse_mass, ball.inverse_inertia, dt,
        )  # fmt: skip
        put(row.p, p)
        put4(row.q, q)
        put(row.v, v)
        put(row.w, w)
        put(leg.impulse, impulse)
        leg.loss = loss
        leg.bounces = bounces
        books[IN_IMPACTS] += loss
        return True
    if laws is None:  # no ball needs more than closed forms: the code for the others is not even compiled
        return True
    return fly(body, row, laws, books, leg.t, t, hits) >= 0


@inner
def _run_evenly(rough, ball, row, leg, books, dt):
    """dt of constant acceleration; on a rough flat also of constant angular acceleration, with what sliding costs."""
    v, w, acc = triple(row.v), triple(row.w), triple(leg.acc)
    q = quad(row.q)
    put(row.p, along(along(triple(row.p), dt, v), 0.5 * dt * dt, acc))
    put(row.v, along(v, dt, acc))
    if rough is not None:
        alp = triple(leg.alp)
        if leg.slides:
            books[IN_FRICTION] += friction_loss(
                v, w, triple(leg.ground), acc, alp, triple(leg.force), ball.radius, dt
            )  # fmt: skip
        put4(row.q, turned_linearly(q, w, alp, dt))
        put(row.w, along(w, dt, alp))
        return
    put4(row.q, turned(q, scale(dt, w)))


@inner
def middle(i, sc, A, laws, M, L, T, t, hits):
    """Centre and velocity (triples) of ball i's sphere at time t, its row left alone. T: scratch rows like M."""
    ball = sc.balls[i]
    leg = L[i]
    row = M[ball.body]
    if leg.mode == FLIGHT:
        dt = t - leg.t
        v, acc = triple(row.v), triple(leg.acc)
        return along(along(triple(row.p), dt, v), 0.5 * dt * dt, acc), along(v, dt, acc)
    if leg.mode == AT_REST:
        return add(triple(row.p), ball.centre), (0.0, 0.0, 0.0)
    copy = T[ball.body]
    copy_row(copy, row)
    spare = np.zeros(4)
    run_leg(ball, A[ball.body], copy, leg, laws, sc.rough, spare, t, hits)
    arm = rotate(quad(copy.q), ball.centre)
    return add(triple(copy.p), arm), add(triple(copy.v), cross(triple(copy.w), arm))


@inner
def copy_row(to, row):
    """Copy one POSE row into another."""
    put(to.p, row.p)
    put4(to.q, row.q)
    put(to.v, row.v)
    put(to.w, row.w)
    to.angle = row.angle
    for k in range(4):
        to.hold[k] = row.hold[k]
    for k in range(3):
        to.support[k] = row.support[k]
