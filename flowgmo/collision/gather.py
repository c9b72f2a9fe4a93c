"""The contact points of pairs of parties, matched with those that were there before.

A contact is one that touches (gap <= touch), or one that was pressed a moment ago and has not opened since by more
than the slack that the step's rounding of curved paths leaves (KEPT, in reaches of the smaller piece). What was there
before keeps its impulse, the next solution's first guess, and its age; the others are fresh: their approach is an
impact (DESIGN 6: the age of a contact decides, not a velocity).
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.contact import CONTACT, approach, relative_velocity
from flowgmo.collision.sweep import KEPT
from flowgmo.collision.touching import ALIKE, NEAR, is_same, touching_points
from flowgmo.collision.tree import near_pairs
from flowgmo.kernel import inner, kernel
from flowgmo.vectors import dot, norm, put, quad, sub, triple

SAME = 1e-6  # of the reach: contact points of neighbouring triangles this near to each other are one


@kernel
def gather(sh, pairs, count, M, plan, touch, old, first_old, out, room, points):
    """Contacts of pairs (count, 2), the rows of M at one time; they go to `out`, sorted by pair.

    plan (n+6, n+6) of PAIR; touch (n+6, n+6) [length]; old: contacts before, sorted by pair, first_old (count, 2).
    Returns the number of contacts (larger than out.size: enlarge and call again), the largest number of pairs of
    pieces (likewise for room (k, 2)), and the deepest overlap in reaches.
    """
    total = np.int64(0)
    most = np.int64(0)
    deepest = 0.0
    for k in range(count):
        a, b = pairs[k, 0], pairs[k, 1]
        start = total
        size = min(sh.reach[a], sh.reach[b])
        many = near_pairs(
            sh, a, (triple(M[a].p), quad(M[a].q)), b, (triple(M[b].p), quad(M[b].q)), touch[a, b] + KEPT * size, room
        )  # fmt: skip
        most = max(most, many)
        for m in range(min(many, room.shape[0])):
            i, j = room[m, 0], room[m, 1]
            reach = min(sh.pieces[i].reach, sh.pieces[j].reach)
            kept = touch[a, b] + KEPT * reach
            found, _, _ = touching_points(sh, i, M[a], j, M[b], (0.0, 0.0, 0.0), kept, points)
            for c in range(found):
                deepest = max(deepest, -points[c].gap / reach)
                match = _match(points[c], old, first_old[k, 0], first_old[k, 1], NEAR * reach)
                if points[c].gap > touch[a, b] and match < 0:
                    continue
                if _is_double(points[c], out, start, total, SAME * reach):
                    continue
                if total < out.size:
                    _store(points[c], a, b, plan[a, b], old, match, out[total])
                total += 1
    return total, most, deepest


@inner
def _match(point, old, first, last, near):
    """The contact before that a point is the same as; -1: none. The nearest one with the same feature or direction."""
    best = np.int64(-1)
    least = near
    for c in range(first, last):
        if old[c].feature == point.feature:
            return np.int64(c)
        if dot(old[c].normal, point.normal) > ALIKE:
            away = norm(sub(triple(old[c].point), triple(point.point)))
            if away <= least:
                best, least = np.int64(c), away
    return best


@inner
def _is_double(point, out, first, last, near):
    for c in range(first, min(last, out.size)):
        if is_same(triple(point.point), triple(point.normal), out[c], near):
            return True
    return False


@inner
def _store(point, a, b, pair, old, match, row):
    row.a, row.b = a, b
    put(row.point, triple(point.point))
    put(row.normal, triple(point.normal))
    row.gap = point.gap
    row.e, row.mu = pair.e, pair.mu
    row.feature = point.feature
    row.regime = match  # for watch.again; the impact sets it anew
    row.loss = 0.0
    row.fresh = 1
    row.age = 0.0
    put(row.impulse, (0.0, 0.0, 0.0))
    if match >= 0:
        row.fresh = 0
        row.age = old[match].age
        put(row.impulse, triple(old[match].impulse))


@kernel
def approaches(contacts, responses, twists, out):
    """Normal velocities (m,) of contacts (m,), negative where they approach."""
    for c in range(contacts.size):
        out[c] = approach(contacts[c], responses, twists)


@kernel
def relative_velocities(contacts, responses, twists, out):
    """Velocities (m, 3) of a's contact points relative to b's, of contacts (m,), with the centres of responses."""
    for c in range(contacts.size):
        put(out[c], relative_velocity(contacts[c], responses, twists))


@kernel
def islands(contacts, movable, label):
    """Labels (m,) of contacts that are joined through parties that can move: equal within one island, 0, 1, … .

    movable (n+6,): 1 for parties that an impulse can move. Returns the number of islands. Union-find.
    """
    n = movable.size
    parent = np.empty(n, dtype=np.int64)
    for p in range(n):
        parent[p] = p
    for c in range(contacts.size):
        a, b = contacts[c].a, contacts[c].b
        if movable[a] and movable[b]:
            parent[_root(parent, a)] = _root(parent, b)
    number = np.full(n, -1, dtype=np.int64)
    count = np.int64(0)
    for c in range(contacts.size):
        r = _root(parent, contacts[c].a if movable[contacts[c].a] else contacts[c].b)
        if number[r] < 0:
            number[r] = count
            count += 1
        label[c] = number[r]
    return count


@kernel
def mark_joined(contacts, movable, mark):
    """Spread mark (n+6,) from marked parties over contacts (m,) to all joined with them through movable ones."""
    changed = True
    while changed:
        changed = False
        for c in range(contacts.size):
            a, b = contacts[c].a, contacts[c].b
            if movable[a] and movable[b] and mark[a] != mark[b]:
                mark[a] = 1
                mark[b] = 1
                changed = True


@inner
def _root(parent, p):
    while parent[p] != p:
        parent[p] = parent[parent[p]]
        p = parent[p]
    return p


def no_contacts() -> np.ndarray:
    """An empty list of contacts."""
    return np.zeros(0, CONTACT)
