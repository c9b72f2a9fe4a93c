"""What bodies win on HELD paths, and what contacts take from them by right (landing.py says why).

By right is the work of friction where it slides, and of a push where the contact really approaches, or closes a gap
that is left. But constant forces leave an error of second order in the velocity of a contact that turns with a body.
With b(v) = (J_mid - J_start) v, half of what v changes at the contact by its turning in a leg, it is about

    |b(v_end) - b(v_start)| + θ |b|         θ: angle of the leg

and a slip or an approach at the start of a leg that is no faster was left by the leg before.

Two things contacts cannot change, whatever their forces: the momentum of an island in directions in which nothing
outside pushes it (along a smooth floor; all, where it touches nothing outside), and the spin of a body whose contacts
push through its centre (smooth balls).
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.paths import kinetic
from flowgmo.kernel import inner, kernel
from flowgmo.vectors import add, along, cross, dot, norm, put, scale, sub, triple, without

SLIDES = 1e-6  # of μ p: what solutions for contact forces leave of the cone's edge
PARALLEL = 1e-6  # rad: what turns less in a leg has errors of 1e-18, the cube of it
SURE = 4.0  # times the error that constant forces leave of a contact's velocity: faster is none


@kernel
def find_gains(bodies, A, M, T, number, common, turned, first, last, gains):
    """Energies (k,) of the bodies (k,): kinetic in M, kinetic in T (n,) of POSE of what contacts can change there (see
    find_common), kinetic + potential won from M to T."""
    for k in range(bodies.size):
        b = bodies[k]
        before, after = kinetic(A[b], M[b]), kinetic(A[b], T[b])
        way = sub(triple(T[b].p), triple(M[b].p))
        first[k] = before
        gains[k] = after - before - A[b].mass * dot(A[b].gravity, way)
        own = sub(triple(T[b].v), common[number[b]])
        last[k] = 0.5 * A[b].mass * dot(own, own)
        if turned[b]:
            last[k] += after - 0.5 * A[b].mass * dot(T[b].v, T[b].v)


@kernel
def find_common(contacts, middle, label, bodies, number, A, T, movable, responses, common, turned):
    """What contacts (m,) that push cannot change of the velocities in T (n,) of POSE, of bodies (k,) without hinges.

    middle, responses (n,) stand in the middle of the leg; label (m,), number (n,): islands. common (islands, 3):
    velocity of each as a whole in the directions in which it has no push from outside, at the start (contacts) or in
    the middle of the leg; turned (n,): 1 where contacts turn the body.
    """
    count = len(common)
    span, rank, mass = np.zeros((count, 3, 3)), np.zeros(count, np.int64), np.zeros(count)
    for c in range(len(contacts)):
        a, b, i = contacts[c].a, contacts[c].b, label[c]
        p, point = triple(middle[c].impulse), triple(middle[c].point)
        for party in (a, b):
            arm = sub(point, triple(responses[party].centre))
            turned[party] |= middle[c].mu > 0.0 or norm(cross(arm, p)) > PARALLEL * norm(arm) * norm(p)
        if movable[a] == 1 and movable[b] == 1:
            continue
        if middle[c].mu > 0.0:
            rank[i] = 3
        _widen(span[i], rank, i, triple(contacts[c].normal))
        _widen(span[i], rank, i, triple(middle[c].normal))
    for i in range(count):
        put(common[i], (0.0, 0.0, 0.0))
    for k in range(bodies.size):
        b = bodies[k]
        mass[number[b]] += A[b].mass
        put(common[number[b]], along(triple(common[number[b]]), A[b].mass, triple(T[b].v)))
    for i in range(count):
        v = scale(1.0 / mass[i], triple(common[i])) if mass[i] > 0.0 and rank[i] < 3 else (0.0, 0.0, 0.0)
        for k in range(min(rank[i], 2)):
            v = without(v, triple(span[i, k]))
        put(common[i], v)


@inner
def _widen(span, rank, i, x):
    """Add a direction (unit) to the orthogonal directions span[: rank[i]]."""
    for k in range(min(rank[i], 2)):
        x = without(x, triple(span[k]))
    if rank[i] < 3 and norm(x) > PARALLEL:
        put(span[rank[i]], scale(1.0 / norm(x), x))
        rank[i] += 1


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
