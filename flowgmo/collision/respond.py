"""Responses and twists of many parties in one call, and their velocities set from twists."""

from __future__ import annotations

from flowgmo.bodies.arrays import STILL
from flowgmo.collision.inverse_mass import respond, set_velocities, twist_of
from flowgmo.collision.paths import FREE, HELD, copy_pose, run_path
from flowgmo.kernel import kernel
from flowgmo.vectors import put, scale, sub, triple


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
def set_paths(which, pressed, A, M, P, responses, ends, now, end):
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
