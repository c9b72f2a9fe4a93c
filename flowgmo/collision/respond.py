"""Responses and twists of many parties in one call, and their velocities set from twists."""

from __future__ import annotations

import numpy as np

from flowgmo.bodies.arrays import DRIVEN, STILL
from flowgmo.bodies.driven import place_hinged
from flowgmo.bodies.equations import inertia_about, tensor_times
from flowgmo.collision.contact import symmetric_times
from flowgmo.collision.inverse_mass import respond, set_velocities, twist_of
from flowgmo.collision.paths import FREE, HELD, copy_pose, run_path
from flowgmo.kernel import kernel
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
    unrotate,
)


@kernel
def respond_all(which, A, M, responses, twists):
    """Fill the rows `which` of responses (n,) RESPONSE and twists (n,) TWIST from poses (n,) POSE."""
    for k in range(which.size):
        b = which[k]
        respond(A[b], M[b], responses[b])
        twist_of(A[b], M[b], responses[b], twists[b])


@kernel
def set_all(which, A, M, responses, twists):
    """Velocities of poses M (n,) from twists, for the parties `which`."""
    for k in range(which.size):
        b = which[k]
        set_velocities(A[b], M[b], responses[b], twists[b])


@kernel
def free_twists(which, A, M, P, laws, T, end, out, books, hits):
    """Twists at time `end` of the parties `which` if nothing touched them from now on; out (n,) TWIST.

    Rows of M stand at now; their paths are FREE from here (P changed), T (n,) of POSE gets the poses then.
    books (n, 4): what control loads would do.
    """
    for k in range(which.size):
        b = which[k]
        P[b].mode = FREE
        copy_pose(T[b], M[b])
        for j in range(4):
            books[b, j] = 0.0
        run_path(A[b], T[b], P[b], laws, books[b], end, hits)
        put(out[b].v, (0.0, 0.0, 0.0))  # the centre of a hinged body does not move
        if A[b].hinge == 0:
            put(out[b].v, triple(T[b].v))  # that of another goes with it
        put(out[b].w, triple(T[b].w))


@kernel
def set_paths(which, pressed, A, M, P, ends, now, end):
    """Paths of the parties `which` from now to `end`: HELD with the end twists `ends` where pressed (n,), else FREE."""
    span = end - now
    for k in range(which.size):
        b = which[k]
        P[b].t = now
        P[b].mode = FREE
        put(P[b].force, (0.0, 0.0, 0.0))
        if pressed[b] == 0 or A[b].motion == STILL:
            continue
        P[b].mode = HELD
        put(P[b].acc, (0.0, 0.0, 0.0))
        if A[b].hinge == 0:
            put(P[b].acc, scale(1.0 / span, sub(triple(ends[b].v), triple(M[b].v))))
        put(P[b].alp, scale(1.0 / span, sub(triple(ends[b].w), triple(M[b].w))))


@kernel
def coast(which, A, M, P, laws, span, T, hits):
    """Poses T (n,) of POSE of the parties `which` after the span [time] with the velocities of M; driven ones exactly.

    Their paths (P) start where M stands.
    """
    books = np.zeros(4)
    for k in range(which.size):
        b = which[k]
        copy_pose(T[b], M[b])
        if A[b].motion == DRIVEN:
            run_path(A[b], T[b], P[b], laws, books, P[b].t + span, hits)
        elif A[b].motion != STILL:
            if A[b].hinge == 1:
                rate = dot(T[b].w, A[b].axis)
                T[b].angle += rate * span
                place_hinged(A[b], T[b], T[b].angle, rate)
            else:
                put4(T[b].q, turned(quad(T[b].q), scale(span, triple(T[b].w))))
                if A[b].hinge == 2:
                    put(T[b].p, add(triple(A[b].point), rotate(quad(T[b].q), triple(A[b].arm))))
                else:
                    put(T[b].p, along(triple(T[b].p), span, triple(T[b].v)))


@kernel
def gyroscopic(which, A, M, responses, free, ends, span, out):
    """What contact impulses change the turning by indirectly, within the span [time]: to be added to the free twists.

    free, ends, out (n,) of TWIST: w without and with the impulses, and the correction; M stands at the start. With
    d = w(end) - w(free) growing linearly, the torque -w × I w gains -(d × I w + w × I d) t/h on the way:

        correction = -(h/2) I⁻¹ (d × I w + w × I d)

    Returns the largest |correction| over the largest |d|.
    """
    most, size = 0.0, 0.0
    for k in range(which.size):
        b = which[k]
        put(out[b].w, (0.0, 0.0, 0.0))
        d = sub(triple(ends[b].w), triple(free[b].w))
        if A[b].motion == STILL or A[b].motion == DRIVEN or A[b].hinge == 1 or norm(d) == 0.0:
            continue
        q = quad(M[b].q)
        i = inertia_about(A[b])
        w = triple(M[b].w)
        iw = rotate(q, tensor_times(i, unrotate(q, w)))
        spin = rotate(q, tensor_times(i, unrotate(q, d)))
        c = scale(-0.5 * span, symmetric_times(responses[b].wr, add(cross(d, iw), cross(w, spin))))
        put(out[b].w, c)
        most, size = max(most, norm(c)), max(size, norm(d))
    return most / size if size > 0.0 else 0.0
