"""How long a step may be: every term brings its own limit.

flow       sum over directions |u| dt / dx <= CON (<= 1/2: the liquid's directional split needs it)
surface    waves of two cells' length turn by at most one radian a step: sqrt(pi g / dx) dt <= CONFS. The surface is
           moved with the velocities that the pressure of the surface gave; that is stable to two radians
viscosity  explicit only (viscosity.py)
"""

from __future__ import annotations

import math

import numpy as np

from flowgmo.flow.columns import ONE
from flowgmo.flow.fields import G, Grid
from flowgmo.flow.team import Team
from flowgmo.kernel import flow_kernel

MOST_COURANT = 0.5  # bound of the directional split (Weymouth & Yue 2010, section 3)


@flow_kernel
def fastest(columns, first, last, grid, F, least, u, v, w, sums):
    """sums[c] = largest sum over directions of |u| / dx [1/time] in the columns' cells that hold liquid (F > least)."""
    for c in range(first, last):
        i = columns[c, 0]
        j = columns[c, 1]
        largest = 0.0
        for k in range(np.uint64(columns[c, 2]), np.uint64(columns[c, 3])):
            if F is not None:
                if not F[i, j, k] > least:
                    continue
            rate = 0.0
            if u is not None:
                rate += max(abs(u[i - 1, j, k]), abs(u[i, j, k])) / grid.dx[i]
            if v is not None:
                rate += max(abs(v[i, j - 1, k]), abs(v[i, j, k])) / grid.dy[j]
            if w is not None:
                rate += max(abs(w[i, j, k - ONE]), abs(w[i, j, k])) / grid.dz[k]
            largest = max(largest, rate)
        sums[c] = largest


def courant_rate(
    team: Team, columns: np.ndarray, grid: Grid, F: np.ndarray | None, least: float, velocity: list
) -> float:
    """Largest sum over directions of |u| / dx [1/time] where there is liquid: dt times this is the Courant number."""
    sums = np.zeros(len(columns))
    team.run(fastest, columns, grid, F, least, *velocity, sums)
    return float(sums.max(initial=0.0))


def surface_limit(grid: Grid, gravity: np.ndarray, directions: tuple[bool, ...]) -> float:
    """Longest step [time] for waves on the free surface; inf without gravity. directions: those with cells."""
    g = float(np.linalg.norm(gravity))
    sizes = [float(d[G:-G].min()) for d, there in zip(grid[:3], directions, strict=True) if there]
    return math.sqrt(min(sizes) / (math.pi * g)) if g > 0.0 and sizes else math.inf
