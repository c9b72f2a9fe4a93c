"""All contacts of a group at once: proximal steps, each solved by Newton over the bodies (proximal.py).

A solution is a fixed point of p = clip(p - ρ u(p)) for any ρ > 0, clip being Coulomb's law. With p held at its last
value p_k on the right, and u taken at the new one,

    p = clip(p_k - ρ u(y)),    y = sum Gᵀ p                                                          (1)

is the problem of contacts with the compliance 1/ρ, pre-loaded by p_k. Redundant contacts (four corners of a box) do no
harm to it: what p_k has in directions that change no velocity stays as it is. Repeated, p_k converges to a solution of
the true problem by the factor 1/(1 + ρλ) for a mode with the eigenvalue λ of sum G Gᵀ (Rockafellar 1976). A large ρ
takes few steps, but each is hard from afar, as contacts open, close, and begin to slide in one stride: ρ = stiff/k
starts at SOFT, or where the guess is good at more, rises after each step that came easily, falls after others.
Where (1) is not solved, a few convex steps follow: (1) with the cone's projection, which always can be solved, and with
the slip speed lagged (Cadoux 2009; Acary, Cadoux, Lemaréchal & Malick 2011); they bring the contacts' states near the
true ones, and (1) is tried again.

Where contacts slide λ may be negative, as in a row of blocks that lean on each other and can swing to either side.
Steps with ρ|λ| < 2 then lead away from the solution, tenfold at ρ|λ| = 0.9, and round-off decides where they end; a
stiffer step comes back (ρ|λ| = 3: half the way, with the other sign). A step that ends at REPELS times the least
residual is taken back, and ρ raised past the bad values.

Numbers of parties and contacts enter by round-off only, and a mirrored problem has the mirrored result.

Contradictory problems (two points of one edge that stick, and whose rounded normals or gaps ask for velocities along
it that differ in the eighth digit) have no solution either: the residual falls to that contradiction and stays, or goes
up and down above it. Where STAYS stiff steps at no more than NEARLY tolerances find no smaller one, that is the answer.

Impossible problems (a driven party presses a body against a wall): u converges to the least violation while impulses
grow by ρ times it each step, without end. That is how they are known; persistent.py then solves the problem that has
just that violation allowed.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from flowgmo.collision.links import ROUND_OFF, move, natural_residual, velocity
from flowgmo.collision.proximal import proximal_step
from flowgmo.kernel import inner
from flowgmo.vectors import dot, norm, put, scale, sub, triple

STIFF = 1e6  # most ρ k: a mode with λ/k = 1e-5 loses nine tenths a step
SOFT = 1.0  # first ρ k: as stiff as the contact itself
LEAST = 0.01  # ρ k below which steps lead nowhere
FASTER = 10.0  # change of ρ
EASY = 3  # Newton steps
AGAIN = 5  # easy steps after which a larger ρ is tried again
CONVEX_MOST = 8  # convex steps in a row
STAYS = 3  # steps that find the same violation
NEARLY = 1000.0  # tolerances that a contradiction of the data may leave
SLOW = 0.9  # of the least residual before: what a mode with λ/k = 1e-7 leaves at ρ k = STIFF
REPELS = 2.0  # times the least residual: a step that ends there leads away
PAST = math.sqrt(FASTER)  # change of ρ then: ρ|λ| = 0.9 becomes 2.8, beyond the 2 from which steps come back
REPELLED = 10  # such changes in one solution
CLOSE = 1e-2  # relative residual below which a step that fails is tried with a smaller ρ, not with convex ones
PATIENCE = 40  # Newton steps without a smaller residual after which one of NEARLY tolerances is the answer
CONVERGED, TOO_MANY, IMPOSSIBLE = 0, 1, 2


class Matrix(NamedTuple):
    """Room of one group: a (n, 3 reach + 1), rows, ends, x (n,) as in banded.py; d (3, 3), dg (3, 6); made (1,)."""

    a: np.ndarray
    rows: np.ndarray
    ends: np.ndarray
    x: np.ndarray
    d: np.ndarray
    dg: np.ndarray
    made: np.ndarray
    reach: int


@inner
def start(links, slots, group):
    """y of the impulses."""
    for s in range(group.low, group.high):
        for k in range(6):
            slots[s].y[k] = 0.0
    for c in range(group.first, group.last):
        move(slots, links[c], triple(links[c].p))


@inner
def rebase(links, slots, group):
    """The impulses become the base of the next proximal step, y theirs; returns the largest change of k |p|."""
    most = 0.0
    for c in range(group.first, group.last):
        link = links[c]
        most = max(most, link.k * norm(sub(triple(link.p), triple(link.base))))
        put(link.base, triple(link.p))
    for s in range(group.low, group.high):
        for k in range(6):
            slots[s].y[k] -= slots[s].f[k]
    return most


@inner
def retreat(links, slots, group):
    """Back to the base of the proximal step."""
    for c in range(group.first, group.last):
        put(links[c].p, triple(links[c].base))
    start(links, slots, group)


@inner
def return_to_best(links, slots, group, tolerance):
    """Back to the impulses of the least residual; returns natural_residual there."""
    for c in range(group.first, group.last):
        put(links[c].base, triple(links[c].best))
    retreat(links, slots, group)
    return natural_residual(links, slots, group, tolerance)


@inner
def lag(links, slots, group):
    """Hold μ |u_t| of every contact."""
    for c in range(group.first, group.last):
        link = links[c]
        u = velocity(slots, link)
        n = triple(link.n)
        link.shift = link.mu * norm(sub(u, scale(dot(u, n), n)))


@inner
def newton(links, slots, group, tolerance, most):
    """Proximal steps until the natural map holds. Before: y is that of p. After: too, p pushes and holds the cone.

    Returns Newton steps, relative residual, CONVERGED, TOO_MANY or IMPOSSIBLE.
    """
    n = 6 * (group.high - group.low)
    reach = 6 * group.band + 5
    a = np.empty((n, 3 * reach + 1))
    rows, ends = np.empty(n, np.int64), np.empty(n, np.int64)
    room = Matrix(a, rows, ends, np.empty(n), np.empty((3, 3)), np.empty((3, 6)), np.zeros(1), reach)
    for c in range(group.first, group.last):
        put(links[c].base, triple(links[c].p))
        put(links[c].best, triple(links[c].p))
    relative, worst = natural_residual(links, slots, group, tolerance)
    stiffest = max(min(STIFF, tolerance / ROUND_OFF), SOFT)  # ρ u: its round-off is to stay below the tolerance
    stiff = max(min(SOFT / relative, stiffest), SOFT) if relative > 0.0 else SOFT
    ceiling = stiffest
    easy = np.int64(0)  # steps at a ρ that others failed above
    least = relative
    count = np.int64(0)
    since = np.int64(0)  # Newton steps since the least residual
    stayed = np.int64(0)
    stalls = np.int64(0)
    convex = np.int64(0)  # steps of this kind to come
    failed = np.int64(0)
    repelled = np.int64(0)
    while count < most and relative > tolerance and stayed < STAYS and stalls < STAYS:
        if since > PATIENCE and least <= NEARLY * tolerance:
            break
        if convex > 0:
            lag(links, slots, group)
        steps, done = proximal_step(links, slots, group, room, stiff, convex > 0)
        count += steps
        since += steps
        if not done:
            retreat(links, slots, group)
            stiff = max(stiff / FASTER, LEAST)
            if relative <= CLOSE:
                stiffest = max(stiff, SOFT)
                easy = 0
            elif convex == 0:
                failed += 1
                convex = min(failed, CONVEX_MOST) + 1
        else:
            last = worst
            lowest = least
            grew = rebase(links, slots, group)
            relative, worst = natural_residual(links, slots, group, tolerance)
            if relative < least:
                since = 0
                least = relative
                for c in range(group.first, group.last):
                    put(links[c].best, triple(links[c].p))
            # a violation that stays while ρ times it is added to impulses; a mode that yields to less than a
            # hundred-thousandth of ρ, as at ratios of masses beyond 1e8, is taken for one
            same = stiff == ceiling and abs(worst - last) <= 1e-5 * last and grew > 0.1 * stiff * worst
            stayed = stayed + 1 if same else 0
            slow = stiff == stiffest and convex == 0 and relative > SLOW * lowest
            stalls = stalls + 1 if slow and relative <= NEARLY * tolerance else 0
            if convex == 0 and least <= CLOSE and relative > REPELS * least and repelled < REPELLED:
                repelled += 1
                relative, worst = return_to_best(links, slots, group, tolerance)
                stiff = min(PAST * stiff, ceiling)
                stiffest = max(stiffest, stiff)
                easy = 0
            elif steps <= EASY:
                easy += 1
                if easy > AGAIN:
                    easy = 0
                    stiffest = min(FASTER * stiffest, ceiling)
                stiff = min(FASTER * stiff, stiffest)
        convex = max(convex - 1, 0)
    if stayed >= STAYS and stalls < STAYS:
        return count, relative, IMPOSSIBLE
    if relative > least:
        for c in range(group.first, group.last):
            put(links[c].p, triple(links[c].best))
        start(links, slots, group)
    return count, least, CONVERGED if least <= tolerance or since > PATIENCE or stalls >= STAYS else TOO_MANY
