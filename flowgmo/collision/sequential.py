"""Several contacts that touch, as the report does it: pairs one after another.

The contact that approaches fastest comes first, among equals the one with the lower number; it is resolved as a single
impact (impact_exact.py), the velocities of all others change, and so on until nothing approaches. The order decides
what comes out, so a symmetric scene may end askew: that is what clusters.py is for. Each single impact loses energy or
keeps it; so does their series. Who is fastest is found by a tournament: an impact changes the speeds of its neighbours
only, and only their games are played again.

After a bound on the number of impacts the rest is made plastic (plastic.py).

Source: report 2.1 and the end of its section 1.
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.coupling import any_rough, couple, no_gain, strike, write_back
from flowgmo.collision.impact_exact import impact
from flowgmo.collision.plastic import CLOSE, IN_VAIN, largest_approach, least_violation, settle, sweeps_for
from flowgmo.kernel import inner
from flowgmo.records import SLIP

DONE, UNFINISHED, IMPOSSIBLE = 0, 1, 2  # as in clusters.py
AT_REST = 1e-9  # approach [v_ref] that counts as none: bounces between more than two bodies may never end
TURNS = 200  # impacts a contact before the rest is made plastic: at e = 0.9 a bounce has died out to AT_REST


@inner
def _approach(s):
    """How fast a contact approaches [v_ref], 0 where it does not; what cannot move is left."""
    return -s.v[2] if s.active >= 0 and s.v[2] < 0.0 else 0.0


@inner
def _play(tree, speed, node):
    """The winner of a node: the faster of its two children, among equals the lower number."""
    one, two = tree[2 * node], tree[2 * node + 1]
    tree[node] = two if speed[two] > speed[one] else one


@inner
def _tournament(springs):
    """Tree of winners and the speeds (2 size,) that they play with; tree[1] is the contact that approaches fastest.

    Each contact is a leaf, node size + i; what is behind the last one never wins.
    """
    m = springs.shape[0]
    size = np.int64(1)
    while size < m:
        size *= 2
    tree = np.empty(2 * size, np.int64)
    speed = np.empty(size)
    for i in range(size):
        tree[size + i] = i
        speed[i] = _approach(springs[i]) if i < m else -1.0
    for k in range(size - 1):
        _play(tree, speed, size - 1 - k)
    return tree, speed


@inner
def _replay(tree, speed, springs, i):
    """The games of contact i again, up to where another one won before and now."""
    speed[i] = _approach(springs[i])
    node = (speed.size + i) // 2
    while node >= 1:
        before = tree[node]
        _play(tree, speed, node)
        if before != i and tree[node] != i:
            break
        node //= 2


@inner
def _hit(springs, links, contact, j):
    """Resolve contact j alone. Returns its regime."""
    s = springs[j]
    k = (s.own[0, 0], s.own[1, 1], s.own[2, 2], s.own[0, 1], s.own[0, 2], s.own[1, 2])
    push, regime, _, _ = impact(k, (s.v[0], s.v[1], s.v[2]), contact.e, contact.mu)
    strike(springs, links, j, push)
    if s.v[2] < -AT_REST:  # nothing moves there: to hit it again would not help
        s.active = -1
    return regime


@inner
def resolve(contacts, responses, twists, rest, turns):
    """Resolve contacts (m,) of CONTACT that touch, one after another.

    responses, twists (n,): of the parties; rest [-]: approach that counts as none, of the largest speed there is;
    turns: impacts a contact, on average, after which the rest is made plastic. Writes impulse, regime (of the last
    impact), loss of the contacts and the twists after. Returns status and the largest approach speed that is left
    [length/time].
    """
    m = contacts.shape[0]
    springs, links, v_ref, k_ref = couple(contacts, responses, twists, any_rough(contacts))
    status = DONE
    for i in range(m):
        contacts[i].regime = SLIP
    if k_ref > 0.0:
        tree, speed = _tournament(springs)
        for _ in range(turns * m):
            j = tree[1]
            if not speed[j] > rest:
                break
            contacts[j].regime = _hit(springs, links, contacts[j], j)
            _replay(tree, speed, springs, j)
            for i in range(springs[j].first, springs[j].last):
                _replay(tree, speed, springs, links[i].to)
        if speed[tree[1]] > rest:
            status = UNFINISHED
            settle(springs, links, sweeps_for(m), 0.0, max(CLOSE, 0.1 * rest))
    if rest < IN_VAIN < largest_approach(springs):  # who counts more as rest does not ask whether there is a solution
        status = IMPOSSIBLE
        if k_ref > 0.0:
            least_violation(springs, links)
    no_gain(springs)
    write_back(springs, contacts, responses, twists, v_ref, k_ref if k_ref > 0.0 else 1.0)
    return status, largest_approach(springs) * v_ref
