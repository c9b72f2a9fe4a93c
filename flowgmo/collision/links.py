"""Contacts prepared for a solve: scaled coordinates, and how far impulses are from a solution.

Scaled coordinates. With the response of a party written as W_t = L_t L_tᵀ and W_r = L_r L_rᵀ the twist is

    v = v_free + L_t y_t      ω = ω_free + L_r y_r      |y|²/2 the kinetic energy of the change

A driven direction is a zero column of L, nothing else about it is special; bodies of 1 g and 1 t have y of one size.
The relative velocity of a contact and the change of y by its impulse are

    u = u_0 + G_a y_a + G_b y_b       y_a += G_aᵀ p,   y_b += G_bᵀ p       K = G_a G_aᵀ + G_b G_bᵀ

with G_a = (L_t, -[x - c]× L_r), G_b the negative of the same of b, u_0 the free relative velocity plus the bias.
Masses are taken in a unit of the group's own, a power of two: p and y are velocities, the roots that L takes have no
unit of mass, and a problem with all masses doubled gives the same bits.
"""

from __future__ import annotations

import math

import numpy as np

from flowgmo.kernel import inner
from flowgmo.vectors import add, cross, dot, norm, put, scale, sub, triple

#: One contact of a solve. contact: its row; a, b: slots of its parties, -1 immovable; kk: K xx yy zz xy xz yz; k: a
#: third of its trace; size: the velocities that u is a difference of; p: impulse; base: that of the last proximal step;
#: best: that of the least residual so far; shift: μ |u_t| at the base; state: OPEN, STICKS, SLIDES; matrix: the state
#: that the last matrix was made for.
LINK = np.dtype(
    [
        ("contact", "i8"),
        ("a", "i8"),
        ("b", "i8"),
        ("mu", "f8"),
        ("k", "f8"),
        ("size", "f8"),
        ("shift", "f8"),
        ("n", "f8", 3),
        ("u0", "f8", 3),
        ("u", "f8", 3),
        ("p", "f8", 3),
        ("base", "f8", 3),
        ("best", "f8", 3),
        ("kk", "f8", 6),
        ("ga", "f8", (3, 6)),
        ("gb", "f8", (3, 6)),
        ("state", "i8"),
        ("matrix", "i8"),
    ],
    align=True,
)
#: One movable party of a solve. party: its row; y, and what changes it in a Newton step: f, step.
SLOT = np.dtype([("party", "i8"), ("y", "f8", 6), ("f", "f8", 6), ("step", "f8", 6)], align=True)


OPEN, STICKS, SLIDES = 0, 1, 2
MU_MOST = 1e8  # steeper cones are the same in double precision: 1/μ² is below its round-off
ROUND_OFF = 1e-15  # of a velocity or a tensor entry that is a sum of a few terms


@inner
def factor_tensor(s, unit, low):
    """Write L (3, 3) with L Lᵀ = s/unit (s: xx yy zz xy xz yz), semi-definite: largest pivot first, rank found."""
    m = np.empty((3, 3))
    m[0, 0], m[1, 1], m[2, 2] = s[0] / unit, s[1] / unit, s[2] / unit
    m[0, 1], m[0, 2], m[1, 2] = s[3] / unit, s[4] / unit, s[5] / unit
    m[1, 0], m[2, 0], m[2, 1] = m[0, 1], m[0, 2], m[1, 2]
    least = 16.0 * ROUND_OFF * (m[0, 0] + m[1, 1] + m[2, 2])  # what cancels leaves this much
    for k in range(3):
        j = 0
        for i in range(1, 3):
            if m[i, i] > m[j, j]:
                j = i
        root = np.sqrt(m[j, j]) if m[j, j] > least else 0.0
        for i in range(3):
            low[i, k] = m[i, j] / root if root > 0.0 else 0.0
        for i in range(3):
            for q in range(3):
                m[i, q] -= low[i, k] * low[q, k]
        m[j, j] = 0.0


@inner
def fill_half(g, sign, response, lt, lr, x):
    """Write G (3, 6) of one party, seen from the point x."""
    r = sub(x, triple(response.centre))
    for k in range(3):
        c = cross((lr[0, k], lr[1, k], lr[2, k]), r)
        for i in range(3):
            g[i, k] = sign * lt[i, k]
            g[i, 3 + k] = sign * c[i]


@inner
def clip(z, n, mu):
    """Nearest of the impulses that push and hold Coulomb's cone in the sense of Alart & Curnier 1991:

    normal part max(0, z_n), then the tangential part shortened to μ times it. Returns it and the state.
    """
    zn = dot(z, n)
    if zn <= 0.0:
        return (0.0, 0.0, 0.0), OPEN
    t = sub(z, scale(zn, n))
    size = norm(t)
    if size <= mu * zn:
        return z, STICKS
    return add(scale(zn, n), scale(mu * zn / size, t)), SLIDES


@inner
def add_impulse(y, g, p):
    """y (6,) += Gᵀ p."""
    for k in range(6):
        y[k] += g[0, k] * p[0] + g[1, k] * p[1] + g[2, k] * p[2]


@inner
def move(slots, link, p):
    """Change y of both parties by the impulse p (triple)."""
    if link.a >= 0:
        add_impulse(slots[link.a].y, link.ga, p)
    if link.b >= 0:
        add_impulse(slots[link.b].y, link.gb, p)


@inner
def velocity(slots, link):
    """Relative velocity (triple) of a contact, its bias added."""
    x, y, z = link.u0[0], link.u0[1], link.u0[2]
    for s, g in ((link.a, link.ga), (link.b, link.gb)):
        if s >= 0:
            v = slots[s].y
            for k in range(6):
                x += g[0, k] * v[k]
                y += g[1, k] * v[k]
                z += g[2, k] * v[k]
    return (x, y, z)


@inner
def reference_speed(links, group, tolerance):
    """What residuals of a group are relative to: the largest free normal velocity, which all impulses come from.

    But not less than round-off of k p and u permits to resolve at this tolerance.
    """
    free = 0.0
    size = 0.0
    for c in range(group.first, group.last):
        link = links[c]
        free = max(free, abs(dot(triple(link.u0), triple(link.n))))
        size = max(size, link.k * norm(triple(link.p)), link.size)
    return max(free, ROUND_OFF / tolerance * size)


@inner
def natural_map(link, slots):
    """k |p - clip(p - u/k)| of one contact [length/time], zero exactly at a solution."""
    u = velocity(slots, link)
    p = triple(link.p)
    n = triple(link.n)
    if link.k > 0.0:
        z, _ = clip(sub(p, scale(1.0 / link.k, u)), n, link.mu)
        return link.k * norm(sub(p, z))
    return max(-dot(u, n), 0.0)


@inner
def natural_residual(links, slots, group, tolerance):
    """How far a group is from a solution: the largest natural map relative to reference_speed, and as it is."""
    free = reference_speed(links, group, tolerance)
    worst = 0.0
    for c in range(group.first, group.last):
        worst = max(worst, natural_map(links[c], slots))
    return worst / free if worst > 0.0 else 0.0, worst


@inner
def is_solved(links, slots, group, tolerance):
    """Whether natural_residual is no more than the tolerance: the first contact that exceeds it tells."""
    free = reference_speed(links, group, tolerance)
    for c in range(group.first, group.last):
        r = natural_map(links[c], slots)
        if r > 0.0 and r / free > tolerance:
            return False
    return True


@inner
def mass_unit(contacts, order, group, responses):
    """A power of two [1/mass] near the largest trace of K that a contact of a group has from one of its parties.

    Each group has its own: roots of odd powers of two round, and what is far away must not change the last bit.
    """
    most = 0.0
    for i in range(group.first, group.last):
        contact = contacts[order[i]]
        x = triple(contact.point)
        for party in (contact.a, contact.b):
            t, s = responses[party].wt, responses[party].wr
            r = sub(x, triple(responses[party].centre))
            across = (s[1] + s[2]) * r[0] * r[0] + (s[0] + s[2]) * r[1] * r[1] + (s[0] + s[1]) * r[2] * r[2]
            across -= 2.0 * (s[3] * r[0] * r[1] + s[4] * r[0] * r[2] + s[5] * r[1] * r[2])
            most = max(most, t[0] + t[1] + t[2] + across)
    _, e = math.frexp(most)
    return math.ldexp(1.0, e)


@inner
def prepare_slots(slots, group, queue, responses, unit, lt, lr):
    """The slots of a group, all but y; and L_t, L_r (s, 3, 3) in its unit of mass."""
    for s in range(group.low, group.high):
        slots[s].party = queue[s]
        factor_tensor(responses[queue[s]].wt, unit, lt[s])
        factor_tensor(responses[queue[s]].wr, unit, lr[s])


@inner
def prepare_link(link, contact, bias, k, responses, twists, lt, lr, unit):
    """All of a link but its parties' slots, which are known; its bias is row k of bias (m, 3)."""
    link.mu = min(contact.mu, MU_MOST)
    x = triple(contact.point)
    n = triple(contact.normal)
    put(link.n, n)
    u = (bias[k, 0], bias[k, 1], bias[k, 2])
    link.size = norm(u)
    for party, sign in ((contact.a, 1.0), (contact.b, -1.0)):
        v = triple(twists[party].v)
        turn = cross(triple(twists[party].w), sub(x, triple(responses[party].centre)))
        u = add(u, scale(sign, add(v, turn)))
        link.size += norm(v) + norm(turn)
    put(link.u0, u)
    if link.a >= 0:
        fill_half(link.ga, 1.0, responses[contact.a], lt[link.a], lr[link.a], x)
    if link.b >= 0:
        fill_half(link.gb, -1.0, responses[contact.b], lt[link.b], lr[link.b], x)
    fill_answer(link)
    guess(link, contact, unit)


@inner
def guess(link, contact, unit):
    """Start from the impulse that the contact holds."""
    p, _ = clip(scale(unit, triple(contact.impulse)), triple(link.n), link.mu)
    put(link.p, p)


@inner
def fill_answer(link):
    """K and its mean k from G."""
    for i in range(6):
        link.kk[i] = 0.0
    for s, g in ((link.a, link.ga), (link.b, link.gb)):
        if s >= 0:
            for k in range(6):
                link.kk[0] += g[0, k] * g[0, k]
                link.kk[1] += g[1, k] * g[1, k]
                link.kk[2] += g[2, k] * g[2, k]
                link.kk[3] += g[0, k] * g[1, k]
                link.kk[4] += g[0, k] * g[2, k]
                link.kk[5] += g[1, k] * g[2, k]
    link.k = (link.kk[0] + link.kk[1] + link.kk[2]) / 3.0
