"""Groups of contacts that depend on each other, and an order of their parties.

Contacts joined through movable parties depend on each other, others do not. The parties of a group are numbered by
breadth from one at its rim (Cuthill & McKee 1969): parties in contact get numbers close together. A stack of boxes is
a chain, and the matrices of contact_newton.py have a narrow band.
"""

from __future__ import annotations

import numpy as np

from flowgmo.kernel import inner

#: One group: links first .. last - 1, slots low .. high - 1, band: largest difference of slots in contact.
GROUP = np.dtype([("first", "i8"), ("last", "i8"), ("low", "i8"), ("high", "i8"), ("band", "i8")], align=True)


@inner
def movable(response):
    """Whether a party answers any impulse."""
    s = response.wt[0] + response.wt[1] + response.wt[2] + response.wr[0] + response.wr[1] + response.wr[2]
    return s > 0.0


@inner
def spread(seed, seen, mark, contacts, responses, starts, around, queue, tail):
    """Breadth-first from a party: queue it and all it reaches that has seen != mark; returns the queue's new end."""
    head = tail
    queue[tail] = seed
    seen[seed] = mark
    tail += 1
    while head < tail:
        party = queue[head]
        head += 1
        for i in range(starts[party], starts[party + 1]):
            c = around[i]
            other = contacts[c].a + contacts[c].b - party
            if seen[other] < mark and movable(responses[other]):
                seen[other] = mark
                queue[tail] = other
                tail += 1
    return tail


@inner
def around_parties(contacts, responses):
    """The contacts of every movable party: around[starts[party] : starts[party + 1]]."""
    n = len(responses)
    starts = np.zeros(n + 2, np.int64)
    for c in range(len(contacts)):
        starts[contacts[c].a + 2] += 1
        starts[contacts[c].b + 2] += 1
    for i in range(n):
        starts[i + 2] += starts[i + 1]
    around = np.empty(2 * len(contacts), np.int64)
    for c in range(len(contacts)):
        for party in (contacts[c].a, contacts[c].b):
            around[starts[party + 1]] = c
            starts[party + 1] += 1
    return starts, around


@inner
def find_groups(contacts, responses):
    """Groups of all contacts that have a movable party.

    Returns groups (n,) and how many, queue (n,): the party of each slot, and how many, slot_of (n,): the slot of each
    party or -1, order (m,): contacts in the order of the groups, and how many.
    """
    n = len(responses)
    starts, around = around_parties(contacts, responses)
    seen = np.zeros(n, np.int64)
    queue = np.empty(n, np.int64)
    slot_of = np.empty(n, np.int64)
    for party in range(n):
        slot_of[party] = -1
    order = np.empty(len(contacts), np.int64)
    taken = np.zeros(len(contacts), np.int64)
    groups = np.empty(n, GROUP)
    count = np.int64(0)
    tail = np.int64(0)
    placed = np.int64(0)
    for party in range(n):
        if seen[party] == 0 and starts[party + 1] > starts[party] and movable(responses[party]):
            seed = np.int64(party)
            end = tail
            for mark in range(1, 3):  # the last that the first pass reaches lies at the rim
                end = spread(seed, seen, mark, contacts, responses, starts, around, queue, tail)
                seed = queue[end - 1]
            groups[count].low, groups[count].high, groups[count].first = tail, end, placed
            for s in range(tail, end):
                slot_of[queue[s]] = s
            band = np.int64(0)
            for s in range(tail, end):
                for i in range(starts[queue[s]], starts[queue[s] + 1]):
                    c = around[i]
                    if taken[c] == 0:
                        taken[c] = 1
                        order[placed] = c
                        placed += 1
                        one, two = slot_of[contacts[c].a], slot_of[contacts[c].b]
                        if one >= 0 and two >= 0:
                            band = max(band, abs(one - two))
            groups[count].last = placed
            groups[count].band = band
            count += 1
            tail = end
    return groups, count, queue, tail, slot_of, order, placed
