"""Hinged and forced bodies from t0 to t1: integrated legs, each to the end or to the first stop.

With stops the interval is cut in slices; where a body passed a stop, or nothing presses a held component any more, the
time is found by bisection.
"""

from __future__ import annotations

import numpy as np

from flowgmo.bodies.driven import place_driven, place_hinged
from flowgmo.bodies.equations import DRIVE, LOADS, SIZE, Q, V, W, X, accelerations, hinge_acceleration
from flowgmo.bodies.integrate import integrate
from flowgmo.bodies.laws import value
from flowgmo.bodies.stops import note_hit
from flowgmo.kernel import inner
from flowgmo.vectors import (
    add,
    dot,
    normalized,
    put,
    put4,
    quad,
    rotate,
    triple,
    unrotate,
)

FROM_PRESCRIBED, FROM_LOADS = 2, 3  # places in State.books
STOP_SLICES = 8  # parts of a step in which a body with stops is watched: what begins and ends within one is missed
FAILED = -1
NO_STOP, FAILED_LEG, LET_GO = -1, -2, -3


@inner
def fly_integrated(body, row, laws, stops, books, t0, t1, hits):
    """Hinged and forced bodies. With stops the interval is cut in slices, and a crossing is located by bisection.

    stops: None where no body of the scene has any, and then there is no code for them.
    """
    if stops is None:
        y = np.empty(SIZE)
        if not _attempt(body, row, laws, t0, t1, y):
            return FAILED
        _finish(body, row, laws, books, y, t0, t1)
        return 0
    return _fly_to_stops(body, row, laws, books, t0, t1, hits)


@inner
def _fly_to_stops(body, row, laws, books, t0, t1, hits):
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
    _finish(body, row, laws, books, y, t0, end)
    return end, k


@inner
def _finish(body, row, laws, books, y, t0, t1):
    """Books and row at t1 from the integrated y: coupled components from it, prescribed ones from exact integrals."""
    books[FROM_LOADS] += y[LOADS]
    books[FROM_PRESCRIBED] += y[DRIVE]
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
    place_driven(body, row, laws, reference, t0, t1)
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
        n = note_hit(hits, n, t, 3, -body.hinge_moment * rate, loss, triple(body.point), books)
        place_hinged(body, row, row.angle, 0.0)
        return n
    row.hold[k] = 1 if row.v[k] > 0.0 else -1
    row.p[k] = body.origin[k] + (body.hi[k] if row.hold[k] > 0 else body.lo[k])
    n = note_hit(hits, n, t, k, -body.mass * row.v[k], 0.5 * body.mass * row.v[k] ** 2, triple(row.p), books)
    row.v[k] = 0.0
    return n
