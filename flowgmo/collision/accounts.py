"""What bodies win on HELD paths, and what contacts take from them by right (landing.py says why).

By right is the work of friction where it slides, and of a push where the contact really approaches, or closes a gap
that is left. But constant forces leave an error of second order in the velocity of a contact that turns with a body.
With b(v) = (J_mid - J_start) v, half of what v changes at the contact by its turning in a leg, it is about

    |b(v_end) - b(v_start)| + θ |b|         θ: angle of the leg

and a slip or an approach at the start of a leg that is no faster was left by the leg before.
"""

from __future__ import annotations

from flowgmo.collision.paths import kinetic
from flowgmo.kernel import inner, kernel
from flowgmo.vectors import add, along, cross, dot, norm, scale, sub, triple, without

SLIDES = 1e-6  # of μ p: what solutions for contact forces leave of the cone's edge
SURE = 4.0  # times the error that constant forces leave of a contact's velocity: faster is none


@kernel
def find_gains(bodies, A, M, T, first, last, gains):
    """Energies (k,) of the bodies (k,): kinetic in M and in T (n,) of POSE, kinetic + potential won from M to T."""
    for k in range(bodies.size):
        b = bodies[k]
        first[k] = kinetic(A[b], M[b])
        last[k] = kinetic(A[b], T[b])
        way = sub(triple(T[b].p), triple(M[b].p))
        gains[k] = last[k] - first[k] - A[b].mass * dot(A[b].gravity, way)


@kernel
def find_due(contacts, middle, M, reach, movable, responses, start, ends, span, touch, due):
    """Power (m, 2) that contacts (m,) take by right at the start and the end of a leg [energy/time], else zero.

    contacts stand at the start, as M (n,) of POSE of bodies without hinges; middle with the impulses in the middle, as
    responses (n,); start, ends (n,) of TWIST; reach (n,) [length], movable (n,) 1 or 0; touch (n, n) [length].
    """
    for c in range(len(contacts)):
        due[c, 0] = 0.0
        due[c, 1] = 0.0
        row, a, b = middle[c], contacts[c].a, contacts[c].b
        n, p = triple(row.normal), triple(row.impulse)
        push = dot(p, n)
        if push <= 0.0:
            continue
        rub = along(p, -push, n)
        arms = (
            sub(triple(row.point), triple(responses[a].centre)),
            sub(triple(row.point), triple(responses[b].centre)),
        )
        u = (_velocity(start, a, b, arms), _velocity(ends, a, b, arms))
        point = triple(contacts[c].point)
        before = (sub(point, triple(M[a].p)), sub(point, triple(M[b].p)))
        first, last = _velocity(start, a, b, before), _velocity(ends, a, b, before)
        b0, b1 = sub(u[0], first), sub(u[1], last)
        turn = span * max(
            _rate(reach[a] * movable[a], start[a], ends[a]), _rate(reach[b] * movable[b], start[b], ends[b])
        )
        left = SURE * (norm(sub(b1, b0)) + turn * max(norm(b0), norm(b1)))
        slip = without(scale(0.5, add(u[0], u[1])), n)
        if norm(rub) >= (1.0 - SLIDES) * row.mu * push or norm(slip) > left:
            _add(due[c], rub, u, span)
        gap, sinks = contacts[c].gap, -0.5 * span * dot(add(u[0], u[1]), n)
        if dot(first, contacts[c].normal) < -left or (0.0 < gap <= touch[a, b] and sinks <= 2.0 * gap):
            _add(due[c], scale(push, n), u, span)


@inner
def _velocity(twists, a, b, arms):
    """Velocity of a's contact point relative to b's."""
    one = add(triple(twists[a].v), cross(triple(twists[a].w), arms[0]))
    return sub(one, add(triple(twists[b].v), cross(triple(twists[b].w), arms[1])))


@inner
def _add(due, impulse, u, span):
    """Add the power that an impulse takes, where it takes any on the whole."""
    first, last = -dot(impulse, u[0]) / span, -dot(impulse, u[1]) / span
    if first + last > 0.0:
        due[0] += first
        due[1] += last


@inner
def _rate(reach, start, end):
    """Largest rate of turning [rad/time] of a body, or of the direction to a point that it passes at its reach."""
    if reach == 0.0:
        return 0.0
    first = norm(triple(start.v)) / reach + norm(triple(start.w))
    return max(first, norm(triple(end.v)) / reach + norm(triple(end.w)))
