"""Small displacements of bodies given as twists: translation of the centre of response, rotation about it."""

from __future__ import annotations

from flowgmo.bodies.driven import place_hinged
from flowgmo.kernel import kernel
from flowgmo.vectors import add, cross, dot, put, put4, quad, rotate, sub, triple, turned


@kernel
def shift_all(which, A, M, responses, shifts):
    """Move the poses M (n,) of the bodies `which` by shifts (n,) of TWIST [length, rad]; velocities keep their size.

    The velocity of a body on a fixed axis or point turns with it.
    """
    for k in range(which.size):
        b = which[k]
        body, row = A[b], M[b]
        turn = triple(shifts[b].w)
        if body.hinge == 1:
            row.angle += dot(turn, body.axis)
            place_hinged(body, row, row.angle, dot(row.w, body.axis))
            continue
        arm = sub(triple(row.p), triple(responses[b].centre))
        q = turned(quad(row.q), turn)
        put4(row.q, q)
        if body.hinge == 2:
            put(row.p, add(triple(body.point), rotate(q, triple(body.arm))))
            put(row.v, cross(triple(row.w), sub(triple(row.p), triple(body.point))))
            continue
        put(row.p, add(add(triple(row.p), triple(shifts[b].v)), cross(turn, arm)))
