"""One body from t0 to t1, by the cheapest way that is exact for it; stops included.

    ballistic   p + v t + g t²/2, free top                      (top.py)
    driven      integrals of the laws; one axis of rotation     (laws.py)
    hinged, forced   equations of motion integrated             (forced.py)

A stop is a plastic impact with a partner that cannot move: the velocity component that runs into it becomes zero and
stays so while the loads (or the prescribed velocity) push against the stop; then the body is free to return.
`fly` changes the body's row in place and reports the stops it hit.
"""

from __future__ import annotations

import numpy as np

from flowgmo.bodies.arrays import BALLISTIC, DRIVEN, HINGED, STILL
from flowgmo.bodies.forced import DRIVE, LOADS, SIZE, Q, V, W, X, accelerations, hinge_acceleration, integrate
from flowgmo.bodies.laws import integral, next_turn, value
from flowgmo.bodies.top import spin_freely
from flowgmo.kernel import inner
from flowgmo.vectors import (
    add,
    cross,
    dot,
    normalized,
    put,
    put4,
    quad,
    rotate,
    same_sign,
    scale,
    sub,
    triple,
    turned,
    unrotate,
)

FROM_PRESCRIBED, FROM_LOADS, IN_IMPACTS = 2, 3, 0  # places in State.books
STOP_SLICES = 8  # parts of a step in which a forced body with stops is watched: what happens within one is missed
FAILED = -1
NO_STOP, FAILED_LEG, LET_GO = -1, -2, -3
_UNTURNED = (1.0, 0.0, 0.0, 0.0)


@inner
def fly(body, row, laws, books, t0, t1, hits):
    """Move one body from t0 to t1 [time]: body of dtype BODY, row of dtype POSE (changed), books (4,) added to.

    hits (m, 7): rows (time, component 0-2 or 3 for the angle, momentum taken by the stop, energy lost, B then) are
    filled as far as there is room. Returns the number of hits, or FAILED when an integration gave up.
    """
    motion = body.motion
    if motion == STILL or t1 <= t0:
        return 0
    if motion == BALLISTIC:
        n = _fall(body, row, books, t0, t1, hits) if body.stopped else _parabola(body, row, t1 - t0)
        q, w = spin_freely(quad(row.q), triple(row.w), body.moments, body.axes, t1 - t0)
        put4(row.q, q)
        put(row.w, w)
        return n
    if laws is not None:
        return _by_laws(body, row, laws, laws.hinged, laws.forced, books, t0, t1, hits)
    return 0


@inner
def _by_laws(body, row, laws, hinged, forced, books, t0, t1, hits):
    if body.motion == DRIVEN:
        _drive(body, row, laws, t0, t1)
        return 0
    if hinged is not None:
        if body.motion == HINGED:
            return _integrated(body, row, laws, books, t0, t1, hits)
    if forced is not None:
        return _integrated(body, row, laws, books, t0, t1, hits)
    return 0


@inner
def _parabola(body, row, h):
    for k in range(3):
        g = body.gravity[k]
        row.p[k] += row.v[k] * h + 0.5 * g * h * h
        row.v[k] += g * h
    return 0


@inner
def _fall(body, row, books, t0, t1, hits):
    """Parabola with stops. Components are independent: each runs to its own stop, if it has one, and is held there."""
    n = np.int64(0)
    start, speed_then = triple(row.p), triple(row.v)
    for k in range(3):
        g = body.gravity[k]
        t = t0
        while t < t1:
            if row.hold[k] != 0:
                if g * row.hold[k] >= 0.0:  # it stays: nothing but gravity acts
                    break
                row.hold[k] = 0
            away = row.p[k] - body.origin[k]
            up = first_crossing(body.hi[k] - away, row.v[k], g)
            down = first_crossing(away - body.lo[k], -row.v[k], -g)
            dt = min(up, down)
            if not t + dt <= t1:
                dt = t1 - t
                row.p[k] += row.v[k] * dt + 0.5 * g * dt * dt
                row.v[k] += g * dt
                break
            t += dt
            speed = row.v[k] + g * dt
            row.hold[k] = 1 if up < down else -1
            row.p[k] = body.origin[k] + (body.hi[k] if up < down else body.lo[k])
            row.v[k] = 0.0
            place = (
                _fallen(body, 0, start, speed_then, t - t0),
                _fallen(body, 1, start, speed_then, t - t0),
                _fallen(body, 2, start, speed_then, t - t0),
            )
            n = _hit(hits, n, t, k, -body.mass * speed, 0.5 * body.mass * speed * speed, place, books)
    return n


@inner
def _fallen(body, k, start, speed, t):
    """Coordinate k of B after t of free fall, no farther than its stops."""
    away = start[k] - body.origin[k] + (speed[k] + 0.5 * body.gravity[k] * t) * t
    return body.origin[k] + min(max(away, body.lo[k]), body.hi[k])


@inner
def first_crossing(gap, v, a):
    """First t >= 0 at which v t + a t²/2 reaches gap >= 0 on the way up; infinity: never. Stable for small a."""
    gap = max(gap, 0.0)
    if gap == 0.0 and (v > 0.0 or (v == 0.0 and a > 0.0)):
        return 0.0
    under = v * v + 2.0 * a * gap
    if under < 0.0:
        return np.inf
    root = np.sqrt(under)
    if v >= 0.0:
        return 2.0 * gap / (v + root) if v + root > 0.0 else np.inf
    return (root - v) / a if a > 0.0 else np.inf


@inner
def _hit(hits, n, t, k, impulse, loss, place, books):
    if n < hits.shape[0]:
        put(hits[n, 4:7], place)
        hits[n, 0] = t
        hits[n, 1] = k
        hits[n, 2] = impulse
        hits[n, 3] = loss
    books[IN_IMPACTS] += loss
    return n + 1


@inner
def _travel(laws, k, t0, t1, at, lo, hi):
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
def _drive(body, row, laws, t0, t1):
    """Prescribed motion in closed form: translation of the driven point, turn about one body axis or a fixed axis."""
    if body.hinge == 1:
        k = body.drive[3]
        row.angle, waiting = _travel(laws, k, t0, t1, row.angle, body.lo[3], body.hi[3])
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
    _place_driven(body, row, laws, reference, t0, t1)


@inner
def _place_driven(body, row, laws, reference, t0, t1):
    """p and v of a prescribed body: its driven point was at `reference` at t0, its q and w are those at t1."""
    q, w = quad(row.q), triple(row.w)
    if body.hinge == 2:
        arm = rotate(q, body.arm)
        put(row.p, add(body.point, arm))
        put(row.v, cross(w, arm))
        return
    for k in range(3):
        start = body.origin[k] + body.reference[k]
        away, waiting = _travel(laws, body.drive[k], t0, t1, reference[k] - start, body.lo[k], body.hi[k])
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


@inner
def _integrated(body, row, laws, books, t0, t1, hits):
    """Hinged and forced bodies. With stops the interval is cut in slices, and a crossing is located by bisection."""
    n = np.int64(0)
    t = t0
    slices = STOP_SLICES if body.stopped else 1
    for s in range(slices):
        end = t1 if s == slices - 1 else t0 + (t1 - t0) * (s + 1) / slices
        for _ in range(64):  # stops met in one slice; more would be a chatter that holding has ended
            if t >= end:
                break
            if body.stopped:
                _let_go(body, row, laws, t)
            t, k = _leg(body, row, laws, books, t, end)
            if k == FAILED_LEG:
                return FAILED
            if k >= 0:
                n = _stop_component(body, row, books, t, k, hits, n)
    return n


@inner
def _let_go(body, row, laws, t):
    """Release the components that nothing presses against their stop any more."""
    pushes = _pushes(body, row, laws, t, quad(row.q), unrotate(quad(row.q), triple(row.w)))
    for k in range(4):
        if row.hold[k] != 0 and pushes[k] * row.hold[k] < 0.0:
            row.hold[k] = 0


@inner
def _pushes(body, row, laws, t, q, w_B):
    """Accelerations (x, y, z, angle) that loads would give the components that are held; zero for the others."""
    if body.hinge == 1:
        push = 0.0
        if row.hold[3] != 0:
            push, _ = hinge_acceleration(body, laws, t, row.angle)
        return (0.0, 0.0, 0.0, push)
    return _pushes_free(body, row, laws, laws.forced, t, q, w_B)


@inner
def _pushes_free(body, row, laws, forced, t, q, w_B):
    if forced is None:
        return (0.0, 0.0, 0.0, 0.0)
    held = row.hold[0] != 0 or row.hold[1] != 0 or row.hold[2] != 0
    if not held or body.mass == 0.0:
        return (0.0, 0.0, 0.0, 0.0)
    dv, _, _, _, _, _ = accelerations(body, laws, t, q, w_B, body.coupled, True)
    return (dv[0], dv[1], dv[2], 0.0)


@inner
def _attempt(body, row, laws, t0, t1, y):
    """y (SIZE,) at t1 from the row at t0. False: the integration gave up. A held angle does not move."""
    w_B = unrotate(quad(row.q), triple(row.w))
    for k in range(SIZE):
        y[k] = 0.0
    for k in range(4):
        y[Q + k] = row.q[k]
    for k in range(3):
        y[V + k] = row.v[k]
        y[W + k] = w_B[k]
    if body.hinge == 1:
        y[V] = dot(row.w, body.axis)
        if row.hold[3] != 0:
            y[V] = 0.0
            return True
    free = body.coupled.copy()
    for k in range(3):
        if row.hold[k] != 0:
            free[k] = 0  # as if driven, with velocity zero
    return integrate(body, laws, t0, t1, y, row.angle, free)


@inner
def _beyond(body, row, laws, t, y):
    """What y at time t is too late for: a component beyond a stop, LET_GO if a held one is pressed no more; NO_STOP."""
    q = normalized((y[Q], y[Q + 1], y[Q + 2], y[Q + 3]))
    pushes = _pushes(body, row, laws, t, q, (y[W], y[W + 1], y[W + 2]))
    for k in range(4):
        if row.hold[k] != 0 and pushes[k] * row.hold[k] < 0.0:
            return LET_GO
    if body.hinge == 1:
        at = row.angle + y[X]
        return 3 if row.hold[3] == 0 and (at > body.hi[3] or at < body.lo[3]) else NO_STOP
    worst, which = 0.0, NO_STOP
    for k in range(3):
        if row.hold[k] == 0 and body.coupled[k]:
            at = row.p[k] - body.origin[k] + y[X + k]
            over = max(at - body.hi[k], body.lo[k] - at)
            if over > worst:
                worst, which = over, k
    return which


@inner
def _leg(body, row, laws, books, t0, t1):
    """Integrate to t1 or to the first stop, and store. Returns the time reached and the stop met (or NO_STOP)."""
    y = np.empty(SIZE)
    if not _attempt(body, row, laws, t0, t1, y):
        return t0, FAILED_LEG
    end = t1
    k = NO_STOP
    if body.stopped:
        k = _beyond(body, row, laws, t1, y)
        if k != NO_STOP:
            lo, hi = t0, t1
            for _ in range(60):  # halves the interval to round-off
                mid = 0.5 * (lo + hi)
                if mid <= lo or mid >= hi:
                    break
                _attempt(body, row, laws, t0, mid, y)
                beyond = _beyond(body, row, laws, mid, y)
                if beyond != NO_STOP:
                    hi, k = mid, beyond
                else:
                    lo = mid
            end = hi
            _attempt(body, row, laws, t0, end, y)
    books[FROM_LOADS] += y[LOADS]
    books[FROM_PRESCRIBED] += y[DRIVE]
    _store(body, row, laws, y, t0, end)
    return end, k


@inner
def _store(body, row, laws, y, t0, t1):
    """The row at t1 from the integrated y: coupled components from it, prescribed ones from their exact integrals."""
    if body.hinge == 1:
        row.angle = min(max(row.angle + y[X], body.lo[3]), body.hi[3])
        place_hinged(body, row, row.angle, y[V])
        return
    _store_free(body, row, laws, laws.forced, y, t0, t1)


@inner
def _store_free(body, row, laws, forced, y, t0, t1):
    if forced is None:
        return
    reference = add(triple(row.p), rotate(quad(row.q), body.reference))
    q = normalized((y[Q], y[Q + 1], y[Q + 2], y[Q + 3]))
    rates = (
        y[W] if body.coupled[3] else value(laws, body.drive[3], t1),
        y[W + 1] if body.coupled[4] else value(laws, body.drive[4], t1),
        y[W + 2] if body.coupled[5] else value(laws, body.drive[5], t1),
    )
    put4(row.q, q)
    put(row.w, rotate(q, rates))
    before = triple(row.p)
    _place_driven(body, row, laws, reference, t0, t1)
    if body.hinge == 2:
        return
    for k in range(3):  # a body with a coupled translation is driven at B itself, so the components are apart
        if body.coupled[k]:
            held = row.hold[k] != 0
            row.p[k] = before[k] + (0.0 if held else y[X + k])
            row.v[k] = 0.0 if held else y[V + k]


@inner
def _stop_component(body, row, books, t, k, hits, n):
    """The plastic impact with stop k: its velocity component becomes zero and is held."""
    if k == 3:
        rate = dot(row.w, body.axis)
        row.hold[3] = 1 if rate > 0.0 else -1
        loss = 0.5 * body.hinge_moment * rate * rate
        n = _hit(hits, n, t, 3, -body.hinge_moment * rate, loss, triple(body.point), books)
        place_hinged(body, row, row.angle, 0.0)
        return n
    row.hold[k] = 1 if row.v[k] > 0.0 else -1
    row.p[k] = body.origin[k] + (body.hi[k] if row.hold[k] > 0 else body.lo[k])
    n = _hit(hits, n, t, k, -body.mass * row.v[k], 0.5 * body.mass * row.v[k] ** 2, triple(row.p), books)
    row.v[k] = 0.0
    return n
