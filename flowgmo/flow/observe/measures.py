"""What the liquid amounts to as a whole: volume, energies, momentum, and how well its volume is kept.

    volume      sum of F V dx dy dz
    kinetic     rho / 2 sum of F V dx dy dz (u^2 + v^2 + w^2)       u^2 the mean over the cell's two faces
    potential   - rho sum of F V dx dy dz  g . (x - x0)            x0 the corner of the domain that g points at
    momentum    rho sum of F V dx dy dz  u                         u the mean over the cell's two faces

The mean of the two faces' squares is the trapezoidal rule, second order, and it is each face's energy over half of
either neighbour, which is what the projection lowers. A closed face has no velocity; what bodies that move give it is
added apart (beside_bodies.py). Momentum is asked for only where bodies move (momentum_book.py), and found in the same
pass: all of the time goes into reading the velocities.

x is where the liquid of the cell is, not the cell's centre (places_of_liquid.py): a surface that rises by half a cell
would else move no energy at first, nor a body that passes half of one. Without gravity nothing of this is computed.

Sums are taken column by column, and those of the volume added without rounding (math.fsum), so that its error tells
what the method loses and not how it was counted.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from flowgmo.flow.fields import Flow, G, Grid, Open
from flowgmo.flow.observe.places_of_liquid import lean
from flowgmo.flow.surface.planes import Planes
from flowgmo.flow.surface.plic import is_mixed
from flowgmo.flow.team import Team
from flowgmo.kernel import flow_kernel, inner


class Totals(NamedTuple):
    """volume [length3], kinetic and potential [energy]; wet: how many cells hold liquid."""

    volume: float
    kinetic: float
    potential: float
    wet: int


@inner
def mean_square(a, A, i, j, k, m, n, o):
    """Mean square of a velocity on the two faces of a cell, the lower one at (i - m, j - n, k - o); a None: 0."""
    if a is None:
        return 0.0
    below = a[i - m, j - n, k - o]
    above = a[i, j, k]
    if A is not None:
        below = below if A[i - m, j - n, k - o] > 0.0 else 0.0
        above = above if A[i, j, k] > 0.0 else 0.0
    return 0.5 * (below * below + above * above)


@inner
def mean_of_faces(a, A, i, j, k, m, n, o):
    """Mean of a velocity on the two faces of a cell, as mean_square."""
    if a is None:
        return 0.0
    below = a[i - m, j - n, k - o]
    above = a[i, j, k]
    if A is not None:
        below = below if A[i - m, j - n, k - o] > 0.0 else 0.0
        above = above if A[i, j, k] > 0.0 else 0.0
    return 0.5 * (below + above)


@flow_kernel
def sum_columns(columns, first, last, grid, opened, V, planes, F, u, v, w, hx, hy, hz, g, least, sums, momenta):
    """sums[c] = volume, its kinetic and potential energy / rho, and the cells with F > least, of each column; momenta
    (n, 3): momentum / rho, or None.

    opened: Open, V: opened.V (by itself, since None must be an argument to be pruned); planes (mesh, 4) of F.
    hx, hy, hz (n + 4,) [length2/time2]: -g . x of cell centres along each direction; g (3,) [length/time2]. None
    without gravity.
    """
    for c in range(first, last):
        i = columns[c, 0]
        j = columns[c, 1]
        volume = 0.0
        kinetic = 0.0
        potential = 0.0
        wet = 0.0
        mx, my, mz = 0.0, 0.0, 0.0
        for k in range(columns[c, 2], columns[c, 3]):
            part = grid.dz[k]
            cut = False
            if V is not None:
                part *= V[i, j, k]
                cut = V[i, j, k] < 1.0
            if F is not None:
                if F[i, j, k] == 0.0:
                    continue
                part *= F[i, j, k]
                cut = cut or is_mixed(F[i, j, k])
            if hx is not None:
                potential += part * (hx[i] + hy[j] + hz[k])
                if cut and part > 0.0:
                    weights = (g[0] * grid.dx[i], g[1] * grid.dy[j], g[2] * grid.dz[k])
                    potential -= grid.dz[k] * lean(F, V, opened, planes, i, j, k, weights)
            square = mean_square(u, opened.Ax, i, j, k, 1, 0, 0)
            square += mean_square(v, opened.Ay, i, j, k, 0, 1, 0)
            square += mean_square(w, opened.Az, i, j, k, 0, 0, 1)
            volume += part
            kinetic += 0.5 * part * square
            if momenta is not None:
                mx += part * mean_of_faces(u, opened.Ax, i, j, k, 1, 0, 0)
                my += part * mean_of_faces(v, opened.Ay, i, j, k, 0, 1, 0)
                mz += part * mean_of_faces(w, opened.Az, i, j, k, 0, 0, 1)
            if F is None:
                wet += 1.0 if part > 0.0 else 0.0
            else:
                wet += 1.0 if F[i, j, k] > least and part > 0.0 else 0.0
        area = grid.dx[i] * grid.dy[j]
        sums[c, 0] = area * volume
        sums[c, 1] = area * kinetic
        sums[c, 2] = area * potential
        sums[c, 3] = wet
        if momenta is not None:
            momenta[c, 0] = area * mx
            momenta[c, 1] = area * my
            momenta[c, 2] = area * mz


def heights(grid: Grid, gravity: np.ndarray) -> list[np.ndarray]:
    """-g . (x - x0) [length2/time2] of cell centres, a part (n + 4,) for each direction; ghosts 0."""
    parts = []
    for d, g in zip(grid[:3], gravity, strict=True):
        inside = d[G:-G]
        centre = np.cumsum(inside) - 0.5 * inside
        part = np.zeros(len(d))
        part[G:-G] = -g * centre if g <= 0.0 else g * (inside.sum() - centre)
        parts.append(part)
    return parts


def total(
    team: Team,
    columns: np.ndarray,
    grid: Grid,
    openings: Open,
    flow: Flow,
    rho: float,
    gravity: np.ndarray,
    least: float,
    momentum: np.ndarray | None = None,
    planes: Planes | None = None,
) -> Totals:
    """Totals of the liquid in the columns' cells; F with ghosts filled. least: F of a cell that counts as wet; momentum
    (3,) [mass length/time]: becomes that of the liquid. planes: the scene's, found here unless they are known."""
    sums, momenta = np.empty((len(columns), 4)), None if momentum is None else np.empty((len(columns), 3))
    g, where = None, (None, None, None)
    if np.any(gravity):
        g, where = tuple(float(x) for x in gravity), heights(grid, gravity)
    at = None
    if g is not None and flow.F is not None:
        planes = planes or Planes(grid)
        planes.find(team, flow.F, openings)
        at = planes.at
    opened = openings, openings.V
    team.run_uneven(
        sum_columns, columns, grid, *opened, at, flow.F, *flow.velocity, *where, g, least, sums, momenta
    )  # fmt: skip
    volume = math.fsum(sums[:, 0].tolist())
    kinetic, potential, wet = sums[:, 1:].sum(axis=0).tolist()
    if momentum is not None:
        momentum[:] = rho * momenta.sum(axis=0)
    return Totals(volume, rho * kinetic, rho * potential, int(wet))


def volume_error(volume: float, start: float, passed: np.ndarray) -> float:
    """What is too much (> 0) or missing, as part of what should be there [-].

    start [length3]: the volume at t = 0; passed (6,) [length3]: what came in through each side since (> 0 inwards).
    Where nothing should be there, as part of all that came in; 0 where there never was any.
    """
    should = math.fsum([start, *passed])
    size = max(abs(should), 1e-6 * (start + float(np.abs(passed).sum())))  # 1e-6: a tank that has run dry; a choice
    return (volume - should) / size if size > 0.0 else 0.0
