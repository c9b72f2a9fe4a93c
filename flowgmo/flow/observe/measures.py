"""What the liquid amounts to as a whole: volume, energies, and how well its volume is kept.

    volume      sum of F V dx dy dz
    kinetic     rho / 2 sum of F V dx dy dz (u^2 + v^2 + w^2)       u^2 the mean over the cell's two faces
    potential   - rho sum of F V dx dy dz  g . (x - x0)            x0 the corner of the domain that g points at

The mean of the two faces' squares is the trapezoidal rule, second order, and it is each face's energy over half of
either neighbour, which is what the projection lowers. A closed face has no velocity.

x is where the liquid of the cell is, not the cell's centre: a surface that rises by half a cell would else move no
energy at first. Liquid that fills the part F of a cell leans away from the void, along each direction by

    - (1 - F) / 2  dx  m_x |m_x| / (m_x^2 + m_y^2 + m_z^2),    m_x = F of the lower - F of the upper neighbour

which is exact for a surface along the mesh, and second order otherwise (squares: a slight tilt of the surface changes
the height of what is below it by the square of the tilt). A closed neighbour counts as equal.

Sums are taken column by column and added without rounding (math.fsum), so that the error of the volume tells what the
method loses and not how it was counted.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from flowgmo.flow.fields import Flow, G, Grid, Open
from flowgmo.flow.team import Team
from flowgmo.kernel import flow_kernel, inner

#: smallest square of F's change that tells a direction: F is known to 1e-16. Dust of 1e-155 gave 0 / 0 here
NO_DROP = 1e-32


class Totals(NamedTuple):
    """volume [length3], kinetic and potential [energy]; wet: how many cells hold liquid."""

    volume: float
    kinetic: float
    potential: float
    wet: int


@inner
def drop(F, V, i, j, k, m, n, o):
    """F of the lower - F of the upper neighbour along the direction (m, n, o)."""
    below = F[i - m, j - n, k - o]
    above = F[i + m, j + n, k + o]
    if V is not None:
        below = below if V[i - m, j - n, k - o] > 0.0 else F[i, j, k]
        above = above if V[i + m, j + n, k + o] > 0.0 else F[i, j, k]
    return below - above


@inner
def lean(F, V, i, j, k, grid, g):
    """g . (place of the liquid in its cell - the cell's centre) [length2/time2]; g (3,) [length/time2]."""
    mx = drop(F, V, i, j, k, 1, 0, 0)
    my = drop(F, V, i, j, k, 0, 1, 0)
    mz = drop(F, V, i, j, k, 0, 0, 1)
    size = mx * mx + my * my + mz * mz
    if not size > NO_DROP:
        return 0.0
    away = 0.5 * (1.0 - max(F[i, j, k], 0.0)) / size  # cells that close may lack a little for a step
    return -away * (
        g[0] * grid.dx[i] * mx * abs(mx) + g[1] * grid.dy[j] * my * abs(my) + g[2] * grid.dz[k] * mz * abs(mz)
    )


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


@flow_kernel
def sum_columns(columns, first, last, grid, V, Ax, Ay, Az, F, u, v, w, hx, hy, hz, g, least, sums):
    """sums[c] = volume, its kinetic and potential energy / rho, and the cells with F > least, of each column.

    hx, hy, hz (n + 4,) [length2/time2]: -g . x of cell centres along each direction.
    """
    for c in range(first, last):
        i = columns[c, 0]
        j = columns[c, 1]
        volume = 0.0
        kinetic = 0.0
        potential = 0.0
        wet = 0.0
        for k in range(columns[c, 2], columns[c, 3]):
            part = grid.dz[k]
            height = hx[i] + hy[j] + hz[k]
            if V is not None:
                part *= V[i, j, k]
            if F is not None:
                if F[i, j, k] == 0.0:
                    continue
                part *= F[i, j, k]
                if F[i, j, k] < 1.0:
                    height -= lean(F, V, i, j, k, grid, g)
            square = mean_square(u, Ax, i, j, k, 1, 0, 0)
            square += mean_square(v, Ay, i, j, k, 0, 1, 0)
            square += mean_square(w, Az, i, j, k, 0, 0, 1)
            volume += part
            kinetic += 0.5 * part * square
            potential += part * height
            if F is None:
                wet += 1.0 if part > 0.0 else 0.0
            else:
                wet += 1.0 if F[i, j, k] > least and part > 0.0 else 0.0
        area = grid.dx[i] * grid.dy[j]
        sums[c, 0] = area * volume
        sums[c, 1] = area * kinetic
        sums[c, 2] = area * potential
        sums[c, 3] = wet


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
) -> Totals:
    """Totals of the liquid in the columns' cells; F with ghosts filled. least: F of a cell that counts as wet."""
    sums = np.empty((len(columns), 4))
    g = tuple(float(x) for x in gravity)
    team.run(
        sum_columns, columns, grid, *openings, flow.F, *flow.velocity, *heights(grid, gravity), g, least, sums
    )  # fmt: skip
    volume, kinetic, potential, wet = (math.fsum(column) for column in sums.T)
    return Totals(volume, rho * kinetic, rho * potential, int(wet))


def volume_error(volume: float, start: float, passed: np.ndarray) -> float:
    """What is too much (> 0) or missing, as part of what should be there [-].

    start [length3]: the volume at t = 0; passed (6,) [length3]: what came in through each side since (> 0 inwards).
    Where nothing should be there, as part of all that came in; 0 where there never was any.
    """
    should = math.fsum([start, *passed])
    size = max(abs(should), 1e-6 * (start + float(np.abs(passed).sum())))  # 1e-6: a tank that has run dry; a choice
    return (volume - should) / size if size > 0.0 else 0.0
