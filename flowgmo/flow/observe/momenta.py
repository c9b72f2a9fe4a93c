"""Momentum of the liquid: rho sum of F V dx dy dz u, with u of a cell the mean of its two faces.

As in measures.py a closed face has no velocity; what bodies that move give it is added apart (beside_bodies.py).
"""

from __future__ import annotations

import math

import numpy as np

from flowgmo.flow.fields import Flow, Grid, Open
from flowgmo.flow.team import Team
from flowgmo.kernel import flow_kernel, inner


@inner
def mean_of_faces(a, A, i, j, k, m, n, o):
    """Mean of a velocity on the two faces of a cell, the lower one at (i - m, j - n, k - o); a None: 0."""
    if a is None:
        return 0.0
    below = a[i - m, j - n, k - o]
    above = a[i, j, k]
    if A is not None:
        below = below if A[i - m, j - n, k - o] > 0.0 else 0.0
        above = above if A[i, j, k] > 0.0 else 0.0
    return 0.5 * (below + above)


@flow_kernel
def sum_momentum(columns, first, last, grid, V, Ax, Ay, Az, F, u, v, w, sums):
    """sums[c] (3,) = sum of F V dx dy dz times the velocity, of each column."""
    for c in range(first, last):
        i = columns[c, 0]
        j = columns[c, 1]
        x, y, z = 0.0, 0.0, 0.0
        for k in range(columns[c, 2], columns[c, 3]):
            part = grid.dz[k]
            if V is not None:
                part *= V[i, j, k]
            if F is not None:
                part *= F[i, j, k]
            if part != 0.0:
                x += part * mean_of_faces(u, Ax, i, j, k, 1, 0, 0)
                y += part * mean_of_faces(v, Ay, i, j, k, 0, 1, 0)
                z += part * mean_of_faces(w, Az, i, j, k, 0, 0, 1)
        area = grid.dx[i] * grid.dy[j]
        sums[c, 0] = area * x
        sums[c, 1] = area * y
        sums[c, 2] = area * z


def momentum_of(team: Team, columns: np.ndarray, grid: Grid, openings: Open, flow: Flow, rho: float) -> np.ndarray:
    """(3,) [mass length/time] of the liquid in the columns' cells."""
    sums = np.empty((len(columns), 3))
    team.run(sum_momentum, columns, grid, *openings, flow.F, *flow.velocity, sums)
    return rho * np.array([math.fsum(column) for column in sums.T])
