"""One body from t0 to t1, by the cheapest way that is exact for it; stops included.

    ballistic   p + v t + g t²/2, free top                      (top.py)
    driven      integrals of the laws; one axis of rotation     (laws.py)
    hinged, forced   equations of motion integrated             (forced.py)

A stop is a plastic impact with a partner that cannot move: the velocity component that runs into it becomes zero and
stays so while the loads (or the prescribed velocity) push against the stop; then the body is free to return.
`fly` changes the body's rows of the state arrays in place and reports the stops it hit.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from flowgmo.bodies.arrays import BALLISTIC, DRIVEN, FORCED, HINGED, STILL
from flowgmo.bodies.forced import (
    DRIVE,
    LOADS,
    SIZE,
    Q,
    V,
    W,
    X,
    accelerations,
    hinge_acceleration,
    integrate,
)
from flowgmo.bodies.laws import integral, next_turn, value
from flowgmo.bodies.rotation import along, cross, rotate, turned, unrotate
from flowgmo.bodies.top import spin_freely

FROM_PRESCRIBED, FROM_LOADS, IN_IMPACTS = 2, 3, 0  # places in State.books
STOP_SLICES = 8  # parts of a step in which a forced body with stops is watched: a crossing and return within one is missed
FAILED = -1


@njit(cache=True)
def fly(b, A, laws, p, q, v, w, angle, hold, books, t0, t1, hits):
    """Move body b from t0 to t1 [time]; p, q, v, w, angle, hold, books are the State's arrays.

    hits (m, 4): rows (time, component 0-2 or 3 for the angle, momentum taken by the stop, energy lost) are filled as
    far as there is room. Returns the number of hits, or FAILED when an integration gave up.
    """
    motion = A.motion[b]
    if motion == STILL or t1 <= t0:
        return 0
    if motion == BALLISTIC:
        return _ballistic(b, A, p, q, v, w, hold, books, t0, t1, hits)
    if laws is not None:
        if motion == DRIVEN:
            _driven(b, A, laws, p, q, v, w, angle, t0, t1)
            return 0
        if motion == HINGED or motion == FORCED:
            return _integrated(b, A, laws, p, q, v, w, angle, hold, books, t0, t1, hits)
    return 0


@njit(cache=True)
def _ballistic(b, A, p, q, v, w, hold, books, t0, t1, hits):
    """Components of the flight are independent: each runs to its own stop, if it has one, and is held there."""
    h = t1 - t0
    n = 0
    for k in range(3):
        g = A.gravity[k]
        if hold[b, k] != 0:
            if g * hold[b, k] >= 0.0 and v[b, k] == 0.0:
                continue
            hold[b, k] = 0
        away = p[b, k] - A.origin[b, k]
        left = h
        for side in (1.0, -1.0):
            stop = A.hi[b, k] if side > 0.0 else A.lo[b, k]
            if not np.isfinite(stop):
                continue
            at = _crossing(side * (stop - away), side * v[b, k], side * g)
            if at <= left:
                left = at
                hold[b, k] = 1 if side > 0.0 else -1
        if hold[b, k] == 0:
            p[b, k] += v[b, k] * h + 0.5 * g * h * h
            v[b, k] += g * h
        else:
            speed = v[b, k] + g * left
            p[b, k] = A.origin[b, k] + (A.hi[b, k] if hold[b, k] > 0 else A.lo[b, k])
            n = _hit(hits, n, t0 + left, k, -A.mass[b] * speed, 0.5 * A.mass[b] * speed * speed, books)
            v[b, k] = 0.0
            if g * hold[b, k] < 0.0:  # gravity pulls it back for the rest of the interval
                rest = h - left
                hold[b, k] = 0
                p[b, k] += 0.5 * g * rest * rest
                v[b, k] = g * rest
    qb, wb = spin_freely(q[b].copy(), w[b].copy(), A.moments[b], A.axes[b], h)
    q[b] = qb
    w[b] = wb
    return n


@njit(cache=True)
def _crossing(gap, v, a):
    """First t >= 0 at which v t + a t²/2 exceeds gap >= 0 (infinity: never); stable for small a."""
    if gap <= 0.0 and (v > 0.0 or (v == 0.0 and a > 0.0)):
        return 0.0
    under = v * v + 2.0 * a * gap
    if under < 0.0:
        return np.inf
    root = np.sqrt(under)
    if v >= 0.0:
        return 2.0 * gap / (v + root) if v + root > 0.0 else np.inf
    return (root - v) / a if a > 0.0 else np.inf


@njit(cache=True)
def _hit(hits, n, t, k, impulse, loss, books):
    if n < hits.shape[0]:
        hits[n, 0] = t
        hits[n, 1] = k
        hits[n, 2] = impulse
        hits[n, 3] = loss
    books[IN_IMPACTS] += loss
    return n + 1


@njit(cache=True)
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


@njit(cache=True)
def _driven(b, A, laws, p, q, v, w, angle, t0, t1):
    if A.hinge[b] == 1:
        k = A.drive[b, 3]
        turned_to, waiting = _travel(laws, k, t0, t1, angle[b], A.lo[b, 3], A.hi[b, 3])
        angle[b] = turned_to
        _place_hinged(b, A, p, q, v, w, angle[b], 0.0 if waiting else value(laws, k, t1))
        return
    reference = p[b] + rotate(q[b], A.reference[b])
    speed = np.zeros(3)
    for k in range(3):
        start = A.origin[b, k] + A.reference[b, k]
        away, waiting = _travel(laws, A.drive[b, k], t0, t1, reference[k] - start, A.lo[b, k], A.hi[b, k])
        reference[k] = start + away
        speed[k] = 0.0 if waiting else value(laws, A.drive[b, k], t1)
    rates = np.zeros(3)
    turn = np.zeros(3)
    for k in range(3):
        turn[k] = integral(laws, A.drive[b, 3 + k], t0, t1)
        rates[k] = value(laws, A.drive[b, 3 + k], t1)
    if A.hinge[b] == 2:
        speed[:] = 0.0
        reference = A.point[b] + rotate(q[b], A.reference[b] + A.arm[b])
    q[b] = turned(q[b].copy(), rotate(q[b], turn))  # one axis only (arrays.py), so the order of turns does not matter
    w[b] = rotate(q[b], rates)
    if A.hinge[b] == 2:
        arm = rotate(q[b], A.arm[b])
        p[b] = A.point[b] + arm
        v[b] = cross(w[b], arm)
        return
    arm = rotate(q[b], A.reference[b])
    p[b] = reference - arm
    v[b] = speed - cross(w[b], arm)


@njit(cache=True)
def _place_hinged(b, A, p, q, v, w, angle, rate):
    """Pose and velocity of a body on a fixed axis from its angle [rad] and rate."""
    qb = turned(np.array([1.0, 0.0, 0.0, 0.0]), angle * A.axis[b])
    q[b] = along(qb, q[b])
    arm = rotate(qb, A.arm[b])
    w[b] = rate * A.axis[b]
    p[b] = A.point[b] + arm
    v[b] = cross(w[b], arm)


@njit(cache=True)
def _load_vector(b, A, p, q, v, w):
    y = np.zeros(SIZE)
    y[Q : Q + 4] = q[b]
    y[V : V + 3] = v[b]
    y[W : W + 3] = unrotate(q[b], w[b])
    return y


@njit(cache=True)
def _integrated(b, A, laws, p, q, v, w, angle, hold, books, t0, t1, hits):
    """Hinged and forced bodies. With stops the interval is cut in slices, and a crossing is located by bisection."""
    stopped = False
    for k in range(4):
        stopped = stopped or np.isfinite(A.lo[b, k]) or np.isfinite(A.hi[b, k])
    n = 0
    t = t0
    slices = STOP_SLICES if stopped else 1
    for s in range(slices):
        end = t1 if s == slices - 1 else t0 + (t1 - t0) * (s + 1) / slices
        for _ in range(64):  # stops met in one slice; more would be a chatter that holding has ended
            if t >= end:
                break
            if stopped:
                _let_go(b, A, laws, q, w, angle, hold, t)
            reached, k = _one_leg(b, A, laws, p, q, v, w, angle, hold, books, t, end)
            if reached < 0.0 and k == FAILED:
                return FAILED
            t = reached
            if k >= 0:
                n = _stop_component(b, A, p, q, v, w, angle, hold, books, t, k, hits, n)
    return n


@njit(cache=True)
def _let_go(b, A, laws, q, w, angle, hold, t):
    """Release the components that nothing presses against their stop any more."""
    if A.hinge[b] == 1:
        if hold[b, 3] != 0:
            push, _ = hinge_acceleration(b, A, laws, t, angle[b])
            if push * hold[b, 3] < 0.0:
                hold[b, 3] = 0
        return
    if A.mass[b] == 0.0:
        return
    free = A.coupled[b].copy()
    dv, _, _, _ = accelerations(b, A, laws, t, q[b], unrotate(q[b], w[b]), free, True)
    for k in range(3):
        if hold[b, k] != 0 and A.coupled[b, k] and dv[k] * hold[b, k] < 0.0:
            hold[b, k] = 0


@njit(cache=True)
def _attempt(b, A, laws, p, q, v, w, angle, hold, t0, t1):
    """y at t1, from the state at t0, with held components kept at rest."""
    y = _load_vector(b, A, p, q, v, w)
    free = A.coupled[b].copy()
    if A.hinge[b] == 1:
        y[V] = 0.0
        for k in range(3):
            y[V] += w[b, k] * A.axis[b, k]
        if hold[b, 3] != 0:
            y[V] = 0.0
            return y, True
    ok = integrate(b, A, laws, t0, t1, y, angle[b], free)
    return y, ok


@njit(cache=True)
def _beyond(b, A, p, angle, hold, y):
    """The component that is farthest beyond a stop, and how far; -1 if none."""
    worst, which = 0.0, -1
    if A.hinge[b] == 1:
        at = angle[b] + y[X]
        over = max(at - A.hi[b, 3], A.lo[b, 3] - at)
        if over > worst and hold[b, 3] == 0:
            return over, 3
        return worst, which
    for k in range(3):
        if hold[b, k] == 0:
            at = p[b, k] - A.origin[b, k] + y[X + k]
            over = max(at - A.hi[b, k], A.lo[b, k] - at)
            if over > worst:
                worst, which = over, k
    return worst, which


@njit(cache=True)
def _one_leg(b, A, laws, p, q, v, w, angle, hold, books, t0, t1):
    """Integrate to t1 or to the first stop, and store. Returns the time reached and the stop's component (-1: none)."""
    y, ok = _attempt(b, A, laws, p, q, v, w, angle, hold, t0, t1)
    if not ok:
        return -1.0, FAILED
    end = t1
    over, k = _beyond(b, A, p, angle, hold, y)
    if k >= 0:
        lo, hi = t0, t1
        for _ in range(60):  # halves the interval to round-off
            mid = 0.5 * (lo + hi)
            if mid <= lo or mid >= hi:
                break
            y_mid, ok = _attempt(b, A, laws, p, q, v, w, angle, hold, t0, mid)
            over_mid, k_mid = _beyond(b, A, p, angle, hold, y_mid)
            if k_mid >= 0:
                hi, k = mid, k_mid
            else:
                lo = mid
        end = hi
        y, ok = _attempt(b, A, laws, p, q, v, w, angle, hold, t0, end)
    books[FROM_LOADS] += y[LOADS]
    books[FROM_PRESCRIBED] += y[DRIVE]
    if A.hinge[b] == 1:
        angle[b] += y[X]
        if k == 3:
            angle[b] = min(max(angle[b], A.lo[b, 3]), A.hi[b, 3])
        _place_hinged(b, A, p, q, v, w, angle[b], y[V])
        return end, k
    reference = p[b] + rotate(q[b], A.reference[b])
    qb = y[Q : Q + 4] / np.sqrt(np.sum(y[Q : Q + 4] ** 2))
    q[b] = qb
    rates = y[W : W + 3].copy()
    if laws is not None:
        for i in range(3):
            if not A.coupled[b, 3 + i]:
                rates[i] = value(laws, A.drive[b, 3 + i], end)
    w[b] = rotate(qb, rates)
    if A.hinge[b] == 2:
        arm = rotate(qb, A.arm[b])
        p[b] = A.point[b] + arm
        v[b] = cross(w[b], arm)
        return end, k
    _store_translation(b, A, laws, p, q, v, w, reference, y, t0, end, hold)
    return end, k


@njit(cache=True)
def _store_translation(b, A, laws, p, q, v, w, reference, y, t0, t1, hold):
    """Coupled components from the integration, prescribed ones from their exact integrals.

    reference (3,): the driven point at t0. It is B itself wherever a component is coupled.
    """
    speed = np.zeros(3)
    for i in range(3):
        if A.coupled[b, i]:
            if hold[b, i] == 0:
                reference[i] += y[X + i]
                speed[i] = y[V + i]
        else:
            start = A.origin[b, i] + A.reference[b, i]
            away, waiting = _travel(laws, A.drive[b, i], t0, t1, reference[i] - start, A.lo[b, i], A.hi[b, i])
            reference[i] = start + away
            speed[i] = 0.0 if waiting else value(laws, A.drive[b, i], t1)
    arm = rotate(q[b], A.reference[b])
    p[b] = reference - arm
    v[b] = speed - cross(w[b], arm)


@njit(cache=True)
def _stop_component(b, A, p, q, v, w, angle, hold, books, t, k, hits, n):
    """The plastic impact with stop k: its velocity component becomes zero and is held."""
    if k == 3:
        rate = w[b, 0] * A.axis[b, 0] + w[b, 1] * A.axis[b, 1] + w[b, 2] * A.axis[b, 2]
        hold[b, 3] = 1 if rate > 0.0 else -1
        n = _hit(hits, n, t, 3, -A.hinge_moment[b] * rate, 0.5 * A.hinge_moment[b] * rate * rate, books)
        _place_hinged(b, A, p, q, v, w, angle[b], 0.0)
        return n
    hold[b, k] = 1 if v[b, k] > 0.0 else -1
    n = _hit(hits, n, t, k, -A.mass[b] * v[b, k], 0.5 * A.mass[b] * v[b, k] ** 2, books)
    p[b, k] = A.origin[b, k] + (A.hi[b, k] if hold[b, k] > 0 else A.lo[b, k])
    v[b, k] = 0.0
    return n
