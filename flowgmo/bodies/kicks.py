"""What loads do to a body's velocity within a step of the liquid, in which it otherwise flies freely.

    U* = U + dt (accelerations by gravity and control loads at the middle of the step)

The turning of the body by itself (w x I w) is left to the free flight that follows, so that it counts once. Components
that the deck prescribes have the velocity of their law at the end of the step, those that a stop holds have none: their
inverse masses are 0 too (inverse_masses.py), so that the pressure has a wall there that does not move. Source:
symplectic Euler; first order, as the liquid that the body displaces is moved with the velocity of the end of the step.
"""

from __future__ import annotations

from flowgmo.bodies.arrays import BALLISTIC, FORCED, HINGED
from flowgmo.bodies.equations import accelerations, control_loads, hinge_acceleration
from flowgmo.bodies.laws import value
from flowgmo.kernel import kernel
from flowgmo.vectors import cross, put, quad, rotate, scale, triple


@kernel
def kick(which, A, laws, M, t0, t1):
    """Velocities v [length/time] and w [rad/time] of bodies `which` (k,) of M (n,) POSE become U*. A (n,) BODY."""
    for b in which:
        if A[b].motion == BALLISTIC:
            for k in range(3):
                M[b].v[k] += A[b].gravity[k] * (t1 - t0)
        elif laws is not None:
            _kick_by_laws(A[b], laws, laws.hinged, laws.forced, M[b], t0, t1)
        _stay_at_stops(M[b])


@kernel
def _stay_at_stops(row):
    """What is held at a stop does not move; an angle that is held: the whole body."""
    for k in range(3):
        if row.hold[k] != 0 or row.hold[3] != 0:
            row.v[k] = 0.0
        if row.hold[3] != 0:
            row.w[k] = 0.0


@kernel
def _kick_by_laws(body, laws, hinged, forced, row, t0, t1):
    dt = t1 - t0
    middle = 0.5 * (t0 + t1)
    q = quad(row.q)
    if hinged is not None:
        if body.motion == HINGED:
            bend, _ = hinge_acceleration(body, laws, middle, row.angle)
            a = (body.axis[0], body.axis[1], body.axis[2])
            for k in range(3):
                row.w[k] += dt * bend * a[k]
            put(row.v, cross(triple(row.w), rotate(q, triple(body.arm))))
    if forced is not None:
        if body.motion == FORCED:
            dv, dw, _, _, _, _ = accelerations(body, laws, middle, q, (0.0, 0.0, 0.0), body.coupled, True)
            turn = rotate(q, scale(dt, dw))
            for k in range(3):
                row.v[k] = row.v[k] + dt * dv[k] if body.coupled[k] != 0 else value(laws, body.drive[k], t1)
                row.w[k] += turn[k]
            if body.hinge == 2:
                put(row.v, cross(triple(row.w), rotate(q, triple(body.arm))))


@kernel
def control_loads_at(which, A, laws, M, t, out):
    """out (n, 6): control force and moment about B, space axes, of bodies `which` (k,) at time t; 0 where none."""
    for b in which:
        for k in range(6):
            out[b, k] = 0.0
        if laws is not None:
            q = quad(M[b].q)
            f, m = control_loads(A[b], laws, t, q)
            m = rotate(q, m)
            for k in range(3):
                out[b, k] = f[k]
                out[b, 3 + k] = m[k]
