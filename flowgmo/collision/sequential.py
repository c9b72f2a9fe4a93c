"""Several contacts that touch, as the report does it: pairs one after another.

The contact that approaches fastest comes first, among equals the one with the lower number; it is resolved as a single
impact (impact_exact.py), the velocities of all others change, and so on until nothing approaches. The order decides
what comes out, so a symmetric scene may end askew: that is what clusters.py is for. Each single impact loses energy or
keeps it; so does their series.

After a bound on the number of impacts the rest is made plastic (plastic.py).

Source: report 2.1 and the end of its section 1.
"""

from __future__ import annotations

from flowgmo.collision.coupling import any_rough, couple, no_gain, strike, write_back
from flowgmo.collision.impact_exact import impact
from flowgmo.collision.plastic import CLOSE, IN_VAIN, largest_approach, least_violation, settle, sweeps_for
from flowgmo.kernel import inner
from flowgmo.records import SLIP

DONE, UNFINISHED, IMPOSSIBLE = 0, 1, 2  # as in clusters.py
AT_REST = 1e-9  # approach [v_ref] that counts as none: bounces between more than two bodies may never end
TURNS = 200  # impacts a contact before the rest is made plastic: at e = 0.9 a bounce has died out to AT_REST


@inner
def _fastest(springs, rest):
    """Number of the contact that approaches fastest, -1: none by more than rest [v_ref]. What cannot move is left."""
    first = -1
    speed = rest
    for i in range(springs.shape[0]):
        s = springs[i]
        if s.active >= 0 and -s.v[2] > speed:
            first = i
            speed = -s.v[2]
    return first


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
        for _ in range(turns * m):
            j = _fastest(springs, rest)
            if j < 0:
                break
            contacts[j].regime = _hit(springs, links, contacts[j], j)
        if _fastest(springs, rest) >= 0:
            status = UNFINISHED
            settle(springs, links, sweeps_for(m), 0.0, max(CLOSE, 0.1 * rest))
    if rest < IN_VAIN < largest_approach(springs):  # who counts more as rest does not ask whether there is a solution
        status = IMPOSSIBLE
        if k_ref > 0.0:
            least_violation(springs, links)
    no_gain(springs)
    write_back(springs, contacts, responses, twists, v_ref, k_ref if k_ref > 0.0 else 1.0)
    return status, largest_approach(springs) * v_ref
