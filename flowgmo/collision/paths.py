"""Between two events a body runs on a path that needs no more than its start to be known at any time.

    FREE     nothing touches it: exact flight, prescribed motion, hinge (bodies/motion.py)
    HELD     contact forces act, constant over the path: acceleration of the centre and of the turning are constant,
             v = v0 + a t,  x = x0 + v0 t + a t²/2,  and so for ω; about a fixed axis or point only ω counts
    ASLEEP   does not move

A row of POSE stands at the start of its path, PATH.t.

Constant forces with v linear in time are the trapezoidal rule: if a contact does not approach at the start and at the
end, it does not in between (as far as its normal keeps its direction), and a body that slides straight is exact. Where
contacts turn, the end of such a path is beside the surfaces by a part of third order. landing.py finds the small
displacement d (of the centre; likewise a rotation) that brings it there, and the place gets it as

    d (3 s² - 2 s³),   s = t/h

so that nothing jumps. It is no motion: the velocity v0 + a t knows nothing of it, nor does kinetic energy, also where
an event cuts the path half way. The turn is made after that of constant acceleration, so that it ends where it should.

What the contacts take from a body on a HELD path is what it loses and neither gravity, loads nor drives explain: the
books close at every time. What loads and drives give is Simpson's sum of their power: exact for constant forces.
"""

from __future__ import annotations

import numpy as np

from flowgmo.bodies.arrays import FORCED, HINGED, STILL
from flowgmo.bodies.driven import place_hinged
from flowgmo.bodies.equations import accelerations, hinge_acceleration
from flowgmo.bodies.motion import fly
from flowgmo.bodies.stops import first_crossing
from flowgmo.kernel import inner, kernel
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
    times,
    triple,
    turned,
    turned_linearly,
    unrotate,
)

FREE, HELD, ASLEEP = 0, 1, 2
LOST_IN_FRICTION, FROM_PRESCRIBED, FROM_LOADS = 1, 2, 3  # places in State.books
#: One body's path: its start t [time], mode, acceleration of B, angular acceleration; force: mean of the contacts;
#: lift, twist: displacement and rotation d (module) of a path that began [time] and had the length span [time];
#: excess, debt [energy]: won so far beyond what contacts take by right, and by a shift before the path (landing.py).
PATH = np.dtype(
    [
        ("t", "f8"),
        ("mode", "i8"),
        ("acc", "f8", 3),
        ("alp", "f8", 3),
        ("force", "f8", 3),
        ("lift", "f8", 3),
        ("twist", "f8", 3),
        ("began", "f8"),
        ("span", "f8"),
        ("excess", "f8"),
        ("debt", "f8"),
    ],
    align=True,
)
#: One stop: body, component (0 1 2, 3 the angle), side (1: hi, -1: lo).
STOP = np.dtype([("body", "i8"), ("k", "i8"), ("side", "i8")], align=True)


@inner
def copy_pose(to, row):
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


@inner
def run_path(body, row, path, laws, books, t, hits):
    """Bring a row of POSE from the start of its path to time t. Returns stops met, or -1 when integration failed."""
    dt = t - path.t
    if dt <= 0.0 or path.mode == ASLEEP or body.motion == STILL:
        return 0
    if path.mode == FREE:
        return fly(body, row, laws, books, path.t, t, hits)
    _run_held(body, row, path, dt)
    return 0


@inner
def _run_held(body, row, path, dt):
    w, alp = triple(row.w), triple(path.alp)
    if body.hinge == 1:
        axis = triple(body.axis)
        rate, gain = dot(w, axis), dot(alp, axis)
        row.angle += (rate + 0.5 * gain * dt) * dt
        place_hinged(body, row, row.angle, rate + gain * dt)
        return
    put4(row.q, turned_linearly(quad(row.q), w, alp, dt))
    w = along(w, dt, alp)
    put(row.w, w)
    if body.hinge == 2:
        arm = rotate(quad(row.q), body.arm)
        put(row.p, add(body.point, arm))
        put(row.v, cross(w, arm))
        return
    v, acc = triple(row.v), triple(path.acc)
    put(row.p, along(along(triple(row.p), dt, v), 0.5 * dt * dt, acc))
    put(row.v, along(v, dt, acc))
    if path.span > 0.0:
        part = _part(path, path.t + dt) - _part(path, path.t)
        put(row.p, along(triple(row.p), part, triple(path.lift)))
        put4(row.q, turned(quad(row.q), scale(part, triple(path.twist))))


@inner
def _part(path, t):
    """Part of the displacement of a path that is made by time t: 3 s² - 2 s³."""
    s = (t - path.began) / path.span
    return s * s * (3.0 - 2.0 * s)


@inner
def drift(path):
    """Bounds on the speeds [length/time, rad/time] of a path's displacement, which is no part of the velocities."""
    if path.mode != HELD or path.span == 0.0:
        return 0.0, 0.0
    fastest = 1.5 / path.span  # of 3 s² - 2 s³, half way
    return fastest * norm(triple(path.lift)), fastest * norm(triple(path.twist))


@inner
def run_and_book(body, row, path, laws, books, t, hits):
    """run_path, and books (4,): what the loads and drives of a HELD path give, and what its contacts take (module)."""
    if path.mode != HELD or t <= path.t:
        return run_path(body, row, path, laws, books, t, hits)
    loads, drives = _given(body, row, path, laws, t)
    before, place = kinetic(body, row), triple(row.p)
    found = run_path(body, row, path, laws, books, t, hits)
    gained = kinetic(body, row) - before - body.mass * dot(body.gravity, sub(triple(row.p), place))
    books[FROM_LOADS] += loads
    books[FROM_PRESCRIBED] += drives
    books[LOST_IN_FRICTION] += loads + drives - gained
    return found


@inner
def kinetic(body, row):
    """Kinetic energy of a body: ½ m v² + ½ w·I w, ½ J θ'² about a fixed axis."""
    if body.hinge == 1:
        return 0.5 * body.hinge_moment * dot(row.w, row.w)
    w = unrotate(quad(row.q), triple(row.w))
    return 0.5 * (body.mass * dot(row.v, row.v) + dot(w, times(body.inertia, w)))


@inner
def _given(body, row, path, laws, t):
    """Work of control loads and of drives on a HELD path from its start, where the row stands, to time t: Simpson."""
    dt = t - path.t
    loads, drives = 0.0, 0.0
    if laws is not None and (body.motion == FORCED or body.motion == HINGED):
        for k in range(3):  # Simpson's weights 1 4 1
            weight = dt * (4.0 if k == 1 else 1.0) / 6.0
            load, drive = _powers(body, row, path, laws, laws.hinged, laws.forced, 0.5 * k * dt)
            loads += weight * load
            drives += weight * drive
    return loads, drives


@inner
def _powers(body, row, path, laws, hinged, forced, dt):
    """Power of control loads and of drives, dt after the start of a HELD path."""
    w, alp = triple(row.w), triple(path.alp)
    if hinged is not None:
        if body.motion == HINGED:
            rate, gain = dot(w, body.axis), dot(alp, body.axis)
            _, given = hinge_acceleration(body, laws, path.t + dt, row.angle + (rate + 0.5 * gain * dt) * dt)
            return given * (rate + gain * dt), 0.0
    if forced is not None:
        if body.motion == FORCED and body.mass > 0.0:
            q = turned_linearly(quad(row.q), w, alp, dt)
            w_B = unrotate(q, along(w, dt, alp))
            v = along(triple(row.v), dt, path.acc)
            _, _, held, kept, f, m = accelerations(body, laws, path.t + dt, q, w_B, body.coupled, True)
            return dot(f, v) + dot(m, w_B), dot(held, v) + dot(kept, w_B)
    return 0.0, 0.0


@inner
def pose_at(body, row, path, laws, t, spare, hits):
    """Copy of a row of POSE brought to time t, in `spare`; the row itself is left alone."""
    copy_pose(spare, row)
    books = np.zeros(4)
    run_path(body, spare, path, laws, books, t, hits)


@kernel
def bring(which, A, M, P, laws, books, t, hits, hit_body):
    """Bring the bodies `which` (k,) to time t; their paths go on from there.

    A (n,) BODY, M (n,) POSE and P (n,) PATH changed, books (4,) added to. Stops met go to hits (m, 7), hit_body (m,).
    Returns the number of hits, and the body whose integration failed or -1.
    """
    found = np.int64(0)
    for k in range(which.size):
        b = which[k]
        lost = books[LOST_IN_FRICTION]
        n = run_and_book(A[b], M[b], P[b], laws, books, t, hits[found:])
        P[b].excess += lost - books[LOST_IN_FRICTION]
        if n < 0:
            return found, b
        for j in range(found, min(found + n, hits.shape[0])):
            hit_body[j] = b
        found = min(found + n, hits.shape[0])
        P[b].t = max(t, P[b].t)
    return found, np.int64(-1)


@kernel
def poses_at(which, A, M, P, laws, t, out, books, hits):
    """Poses of the bodies `which` at time t into out (n,) of POSE; books (4,) get what the paths lose until then."""
    for k in range(which.size):
        b = which[k]
        copy_pose(out[b], M[b])
        run_and_book(A[b], out[b], P[b], laws, books, t, hits)


@inner
def motion_bounds(body, row, path, bound, span):
    """Bounds over the coming span [time]: |ω|, |dω/dt|, |acceleration of B| of a body at the start of its path.

    |ω| has the turning of the displacement in it; its translation is besides (drift).

    Where a body was lately brought to a later time of its path, its row is the state then, and span counts from it.
    """
    if body.motion == STILL or path.mode == ASLEEP:
        return 0.0, 0.0, 0.0
    rate = norm(triple(row.w))
    if path.mode == HELD:
        alpha = norm(triple(path.alp))
        rate += alpha * span + drift(path)[1]
        lever = 0.0
        if body.hinge > 0:
            lever = norm(triple(body.arm))
        return rate, alpha, norm(triple(path.acc)) + lever * (alpha + rate * rate)
    rate = bound.spread * rate + bound.turn_gain * span
    alpha = bound.turn_gain + bound.unevenness * rate * rate
    return rate, alpha, bound.gain + bound.lever * (alpha + rate * rate)


@kernel
def stop_times(stops, A, M, P, times):
    """Times (m,) [time] at which HELD bodies first reach their stops (m,) of STOP; infinity where they do not."""
    for i in range(stops.size):
        b, k, side = stops[i].body, stops[i].k, stops[i].side
        times[i] = np.inf
        if P[b].mode != HELD:
            continue
        if k == 3:
            at, v, acc = M[b].angle, dot(M[b].w, A[b].axis), dot(P[b].alp, A[b].axis)
        else:
            at, v, acc = M[b].p[k] - A[b].origin[k], M[b].v[k], P[b].acc[k]
        gap = A[b].hi[k] - at if side > 0 else at - A[b].lo[k]
        times[i] = P[b].t + first_crossing(gap, side * v, side * acc)
