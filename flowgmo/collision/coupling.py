"""Contacts that feel each other through the bodies they share: velocities at the contacts, and who answers whom.

Each contact gets axes t1, t2, n (n its normal) and its velocity v of a's point relative to b's in them. An impulse p_j
of contact j changes the velocity of every contact i that shares a movable party with it,

    dv_i = K_ij p_j,    K_ij = Σ over shared parties ± Jᵢ W Jⱼᵀ,    Jᵢ the rows (d, (x_i - c) × d) of the axes d

The blocks K_ij are packed: those of contact j lie in links[first_j : last_j]; parties that answer nothing (walls,
driven bodies) make none. Two contacts with two parties in common have two links; they add up. The own block K_jj stays
with the contact. A frictionless cluster fills only the entry of the two normals.

Everything is divided by the largest speed |v| and the largest K_nn, so that lengths, masses, times scaled by powers of
two give the same bits. Energies are then in v_ref² / K_ref, impulses in v_ref / K_ref.
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.cluster_step import ROUND_OFF
from flowgmo.collision.contact import push, symmetric_times
from flowgmo.collision.frame import tangents
from flowgmo.kernel import inner
from flowgmo.vectors import along, cross, dot, put, scale, sub, triple

#: One contact of a cluster, scaled, in its own axes (rows of `axes`: t1, t2, n). own: K_jj; first … middle … last: its
#: links, those to active contacts first; rate: 1/e² (0: nothing comes back); start, v, end: velocity at the start of
#: all, now, and at the end of the step that is tried; p: impulse so far; dp: of the step that is tried; tilt: dp of the
#: last step; slide: mean slip speed where it slipped last; rise: normal acceleration in the last step; stored: energy
#: E; depth: compression; force: its power; reach: Σ |K_nn| over the active contacts; loss: energy so far; active: acts;
#: near: acts or is pushed by one that does.
SPRING = np.dtype(
    [
        ("axes", "f8", (3, 3)),
        ("own", "f8", (3, 3)),
        ("first", "i8"),
        ("middle", "i8"),
        ("last", "i8"),
        ("rate", "f8"),
        ("mu", "f8"),
        ("start", "f8", 3),
        ("v", "f8", 3),
        ("end", "f8", 3),
        ("p", "f8", 3),
        ("dp", "f8", 3),
        ("tilt", "f8", 3),
        ("slide", "f8"),
        ("rise", "f8"),
        ("stored", "f8"),
        ("depth", "f8"),
        ("force", "f8"),
        ("reach", "f8"),
        ("loss", "f8"),
        ("active", "i8"),
        ("near", "i8"),
    ],
    align=True,
)
#: Rows (t1, t2, n) of J and J W of both sides of a contact, needed for its blocks only.
ROWS = np.dtype([("j", "f8", (2, 3, 6)), ("jw", "f8", (2, 3, 6))], align=True)
#: What an impulse of one contact does to another: dv_to += k p.
LINK = np.dtype([("to", "i8"), ("k", "f8", (3, 3))], align=True)


@inner
def movable(response):
    """Whether a party answers any impulse."""
    for k in range(3):  # the diagonals: positive semi-definite tensors vanish with them
        if response.wt[k] > 0.0 or response.wr[k] > 0.0:
            return True
    return False


@inner
def _place(s, rows, contact, responses, twists, lowest):
    """Axes, velocity, J and J W (axes lowest .. 2) of one contact."""
    n = triple(contact.normal)
    t1, t2 = tangents(n)
    for k in range(3):
        s.axes[0, k] = t1[k]
        s.axes[1, k] = t2[k]
        s.axes[2, k] = n[k]
    s.mu = contact.mu
    s.rate = 1.0 / (contact.e * contact.e) if contact.e > ROUND_OFF else 0.0  # e v is no velocity: plastic
    for side in range(2):
        party = contact.a if side == 0 else contact.b
        response, twist = responses[party], twists[party]
        arm = sub(triple(contact.point), triple(response.centre))
        for r in range(lowest, 3):
            d = scale(1.0 - 2.0 * side, s.axes[r])
            turn = cross(arm, d)
            s.v[r] += dot(d, twist.v) + dot(turn, twist.w)
            dv = symmetric_times(response.wt, d)
            dw = symmetric_times(response.wr, turn)
            for k in range(3):
                rows.j[side, r, k] = d[k]
                rows.j[side, r, 3 + k] = turn[k]
                rows.jw[side, r, k] = dv[k]
                rows.jw[side, r, 3 + k] = dw[k]


@inner
def _add_block(k, one, two, lowest):
    """k += J_one W J_twoᵀ; one, two (3, 6)."""
    for r in range(lowest, 3):
        for c in range(lowest, 3):
            for i in range(6):
                k[r, c] += one[r, i] * two[c, i]


@inner
def _link(contacts, responses, springs, rows, lowest):
    """Links between all pairs of contacts on one movable party, and the own blocks, not yet scaled.

    Sides (2 contact + side) that hold on to one party are chained: newest[party, 0], then before[side], to -1.
    """
    m = contacts.shape[0]
    newest = np.zeros((responses.shape[0] + 2 * m, 2), np.int64)  # the chains of `before` lie behind the parties
    behind = responses.shape[0]
    total = np.int64(0)
    for party in range(behind):
        newest[party, 0] = -1
    for i in range(2 * m):
        party = contacts[i // 2].a if i % 2 == 0 else contacts[i // 2].b
        if movable(responses[party]):
            newest[behind + i, 0] = newest[party, 0]
            newest[party, 0] = i
            total += 2 * newest[party, 1]
            newest[party, 1] += 1
    links = np.zeros(total, LINK)
    filled = np.int64(0)
    for i in range(2 * m):
        s = springs[i // 2]
        party = contacts[i // 2].a if i % 2 == 0 else contacts[i // 2].b
        if i % 2 == 0:
            s.first = filled
        other = newest[party, 0]
        while other >= 0:
            block = s.own
            if other != i:
                links[filled].to = other // 2
                block = links[filled].k
                filled += 1
            _add_block(block, rows[other // 2].j[other % 2], rows[i // 2].jw[i % 2], lowest)
            other = newest[behind + other, 0]
        s.last = filled
    return links


@inner
def couple(contacts, responses, twists, rough):
    """The springs (m,) of a cluster, its links, v_ref and K_ref; rough: whether tangential entries are wanted.

    Springs start uncompressed, with no impulse. v_ref = 0: nothing approaches; K_ref = 0: nothing can move.
    """
    m = contacts.shape[0]
    springs = np.zeros(m, SPRING)
    rows = np.zeros(m, ROWS)
    lowest = 0 if rough else 2
    for i in range(m):
        _place(springs[i], rows[i], contacts[i], responses, twists, lowest)
    links = _link(contacts, responses, springs, rows, lowest)
    v_ref = 0.0
    k_ref = 0.0
    for i in range(m):
        for r in range(3):
            v_ref = max(v_ref, abs(springs[i].v[r]))
        k_ref = max(k_ref, springs[i].own[2, 2])
    v_unit = v_ref if v_ref > 0.0 else 1.0
    size = 0.0
    for i in range(m):  # speeds, not components: alike for any choice of tangents; scaled, for squares may vanish
        x, y, z = springs[i].v[0] / v_unit, springs[i].v[1] / v_unit, springs[i].v[2] / v_unit
        size = max(size, x * x + y * y + z * z)
    v_ref *= np.sqrt(size)
    v_unit = v_ref if v_ref > 0.0 else 1.0
    k_unit = k_ref if k_ref > 0.0 else 1.0
    for i in range(m):
        s = springs[i]
        for r in range(3):
            s.v[r] /= v_unit
            s.start[r] = s.v[r]
            for c in range(3):
                s.own[r, c] /= k_unit
    for i in range(links.shape[0]):
        for r in range(3):
            for c in range(3):
                links[i].k[r, c] /= k_unit
    return springs, links, v_ref, k_ref


@inner
def any_rough(contacts):
    """Whether some contact has friction."""
    for i in range(contacts.shape[0]):
        if contacts[i].mu > 0.0:
            return True
    return False


@inner
def strike(springs, links, j, impulse):
    """Give contact j an impulse (triple, its axes) at once: p, the velocities of all that feel it, and the loss."""
    s = springs[j]
    for r in range(3):
        old = s.v[r]
        s.v[r] += s.own[r, 0] * impulse[0] + s.own[r, 1] * impulse[1] + s.own[r, 2] * impulse[2]
        s.p[r] += impulse[r]
        s.loss -= 0.5 * (old + s.v[r]) * impulse[r]
    for i in range(s.first, s.last):
        k = links[i].k
        other = springs[links[i].to]
        for r in range(3):
            other.v[r] += k[r, 0] * impulse[0] + k[r, 1] * impulse[1] + k[r, 2] * impulse[2]


@inner
def no_gain(springs):
    """Book what is still stored as lost; scale all impulses if round-off raised the energy: (v⁻ + v⁺)·p <= 0."""
    work = 0.0
    itself = 0.0
    for i in range(springs.shape[0]):
        s = springs[i]
        s.loss += s.stored
        s.stored = 0.0
        for r in range(3):
            work += 0.5 * (s.start[r] + s.v[r]) * s.p[r]
            itself += 0.5 * (s.v[r] - s.start[r]) * s.p[r]
    if work > 0.0 and itself > work:
        factor = 1.0 - work / itself  # work(α) = α (work - itself) + α² itself
        for i in range(springs.shape[0]):
            for r in range(3):
                springs[i].p[r] *= factor


@inner
def write_back(springs, contacts, responses, twists, v_ref, k_ref):
    """Impulses and losses of the contacts in space axes and true units, and the twists after the impulses."""
    unit = v_ref / k_ref
    for i in range(springs.shape[0]):
        s, c = springs[i], contacts[i]
        impulse = (0.0, 0.0, 0.0)
        for r in range(3):
            impulse = along(impulse, unit * s.p[r], s.axes[r])
        put(c.impulse, impulse)
        c.loss = s.loss * v_ref * unit
        sign = 1.0
        for party in (c.a, c.b):
            push(responses[party], twists[party], triple(c.point), scale(sign, impulse))
            sign = -1.0
