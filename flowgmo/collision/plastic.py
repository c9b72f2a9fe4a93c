"""Normal velocities made free of approach without any rebound: what is left to do when nothing better can be done.

    minimise ½ pᵀ K p + vᵀ p + ½ ε pᵀ diag(K) p   over p >= 0

by sweeps (projected Gauss-Seidel, over-relaxed where there are many): each lowers the sum, so the kinetic energy
cannot rise. With ε = 0 and a solution
the contacts end with v >= 0. Where none exists (a driven body presses a free one against a wall: some q >= 0 has
K q = 0, v·q < 0) a small ε gives the velocities of least violation, in the sense of least squares.
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.coupling import strike
from flowgmo.kernel import inner

IN_VAIN = 1e-3  # approach [v_ref] left by `settle` that says that there is no solution
SOFT = 1e-3  # ε where there is no solution: within that of the least violation
CLOSE = 1e-13  # change of a velocity [v_ref] at which the sweeps end: round-off
MANY = 64  # contacts above which sweeps end at
CLOSE_ENOUGH = 1e-10  # below what a caller takes for rest (strike.SETTLED)
FEW = 8  # contacts above which sweeps are over-relaxed: 60 of a row of dominoes then end at round-off, not at the bound
RELAX = 1.8  # over-relaxation: 500 spheres settle in a third of the sweeps; below 2 each sweep still lowers the sum


@inner
def largest_approach(springs):
    """Largest approach speed [v_ref]; zero where nothing approaches, infinite where a velocity is no number."""
    worst = 0.0
    total = 0.0
    for i in range(springs.shape[0]):
        v = springs[i].v
        worst = max(worst, -v[2])
        total += abs(v[0]) + abs(v[1]) + abs(v[2])
    return worst if total < np.inf else np.inf


@inner
def sweeps_for(m):
    """Bound on the sweeps over m contacts: ill-conditioned pairs need 1e4; a last resort may cost a millisecond."""
    return 1000 + 100_000 // m


@inner
def start_again(springs):
    """Velocities as at the start, no impulses, no losses, nothing stored."""
    for i in range(springs.shape[0]):
        s = springs[i]
        for r in range(3):
            s.v[r] = s.start[r]
            s.p[r] = 0.0
        s.loss = 0.0
        s.stored = 0.0


@inner
def settle(springs, links, sweeps, epsilon, close):
    """Remove the approach from v by normal impulses, added to p. Returns the largest approach left [v_ref].

    sweeps: at most so many; close: change of a velocity [v_ref] at which they end (CLOSE_ENOUGH above MANY contacts).
    """
    m = springs.shape[0]
    relax = RELAX if m > FEW else 1.0
    if m > MANY:
        close = max(close, CLOSE_ENOUGH)
    for i in range(m):
        springs[i].dp[2] = 0.0
    for _ in range(sweeps):
        change = 0.0
        for j in range(m):
            s = springs[j]
            k = s.own[2, 2] * (1.0 + epsilon)
            if k == 0.0:
                continue
            z = max(-relax * (s.v[2] + epsilon * s.own[2, 2] * s.dp[2]) / k, -s.dp[2])
            if z != 0.0:
                change = max(change, k * abs(z))
                s.dp[2] += z
                strike(springs, links, j, (0.0, 0.0, z))
        if change <= close:
            break
    return largest_approach(springs)


@inner
def least_violation(springs, links):
    """From the start again, the velocities that approach least, for contacts that cannot all be satisfied."""
    start_again(springs)
    settle(springs, links, sweeps_for(springs.shape[0]), SOFT, CLOSE)
