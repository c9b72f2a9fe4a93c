"""How long a step may be: every term brings its own limit.

flow       CON over the largest of, in any cell that holds liquid,

               sum of what comes in, and sum of what goes out, per length
               max over its faces of |u| / dx

           In a stream that goes straight on the sums are that over directions of |u| / dx; where it is stopped and
           turned aside they are less. While both are 1/2 at most no new extremum of velocity arises (advection.py),
           and the split of the liquid's advection is bounded (Weymouth & Yue 2010): with F <= 1/2 a cell's liquid stays
           in the stretching, with F > 1/2 its void does, and what comes is added. What goes out bounds what an empty
           cell may get from several. With CON > 1/2 the flow along each direction is held to .45, and a step in which
           more met than a cell holds is tried again, shorter (stages.py). In a cell that a solid cuts: sum over
           directions of the larger face's A |u| / V, which is what the split moves, if that is less than |u|; there
           momentum is advected upwind (cut_advection.py), which is stable to 1, so that half of the speeds bounds the
           step
surface    waves of two cells' length turn by at most one radian a step: sqrt(pi g / dx) dt <= CONFS. The surface is
           moved with the velocities that the pressure of the surface gave; that is stable to two radians
viscosity  explicit only (viscosity.py)
"""

from __future__ import annotations

import math

import numpy as np

from flowgmo.flow.ahead import ask_ahead
from flowgmo.flow.columns import ONE
from flowgmo.flow.fields import G, Grid, Open
from flowgmo.flow.solid_lines import ask_at_solids
from flowgmo.flow.team import Team
from flowgmo.kernel import flow_kernel, inner

AT_A_CUT = 0.5  # share of the rate of speeds that counts in cut cells, see above


@inner
def _rate(u_low, u_high, A_low, A_high, V):
    """The larger flow through two opposite faces, in open volumes of the cell; no face counts more than its speed."""
    return max(abs(u_low) * min(A_low / V, 1.0), abs(u_high) * min(A_high / V, 1.0))


@inner
def _flow_rates(grid, opened, u, v, w, i, j, k):
    """A |u| / (V dx) [1/time] along each direction of a cell that a solid cuts."""
    x, y, z, V = 0.0, 0.0, 0.0, opened.V[i, j, k]
    if u is not None:
        x = _rate(u[i - 1, j, k], u[i, j, k], opened.Ax[i - 1, j, k], opened.Ax[i, j, k], V) / grid.dx[i]
    if v is not None:
        y = _rate(v[i, j - 1, k], v[i, j, k], opened.Ay[i, j - 1, k], opened.Ay[i, j, k], V) / grid.dy[j]
    if w is not None:
        z = _rate(w[i, j, k - ONE], w[i, j, k], opened.Az[i, j, k - ONE], opened.Az[i, j, k], V) / grid.dz[k]
    return x, y, z


@inner
def _both(low, high, per):
    """The sum of the speeds through two opposite faces, per length."""
    return (abs(low) + abs(high)) * per


@inner
def _larger(low, high, per):
    return max(abs(low), abs(high)) * per


@inner
def _comes(low, high, per):
    """What comes in through two opposite faces, per length."""
    return (max(low, 0.0) + max(-high, 0.0)) * per


@inner
def _whole_cell(u, v, w, per_x, per_y, per_z, i, j, k):
    """Of a cell: the largest speed through a face, the sum of the larger ones, what comes in, per length."""
    x, y, z, comes = 0.0, 0.0, 0.0, 0.0
    if u is not None:
        x = _larger(u[i - 1, j, k], u[i, j, k], per_x)
        comes += _comes(u[i - 1, j, k], u[i, j, k], per_x)
    if v is not None:
        y = _larger(v[i, j - 1, k], v[i, j, k], per_y)
        comes += _comes(v[i, j - 1, k], v[i, j, k], per_y)
    if w is not None:
        z = _larger(w[i, j, k - ONE], w[i, j, k], per_z)
        comes += _comes(w[i, j, k - ONE], w[i, j, k], per_z)
    return max(x, max(y, z)), x + y + z, comes


@inner
def _all_faces(u, v, w, per_x, per_y, per_z, i, j, k):
    """The sum of the speeds through a cell's faces, per length: no rate of it is more."""
    both = 0.0
    if u is not None:
        both += _both(u[i - 1, j, k], u[i, j, k], per_x)
    if v is not None:
        both += _both(v[i, j - 1, k], v[i, j, k], per_y)
    if w is not None:
        both += _both(w[i, j, k - ONE], w[i, j, k], per_z)
    return both


@inner
def _may_be_faster(u, v, w, per_x, per_y, per_z, i, j, k0, k1, bound):
    """Whether a rate of a cell of a column may be above the bound. Without an early end: the loop vectorises."""
    faster = 0
    for k in range(k0, k1):
        faster += 0 if _all_faces(u, v, w, per_x, per_y, per_z[k], i, j, k) <= bound else 1
    return faster > 0


@inner
def _cut_cells(V, i, j, k0, k1):
    """How many cells of a column a solid cuts."""
    cut = 0
    for k in range(k0, k1):
        cut += 1 if (V[i, j, k] > 0.0) & (V[i, j, k] < 1.0) else 0
    return cut


@flow_kernel
def fastest(columns, first, last, grid, per_z, V, opened, lines, F, least, u, v, w, rates):
    """rates[:, c] [1/time] at which liquid (F > least) crosses the columns' cells: in all, along one direction.

    The largest of the columns from `first` to c, so that most cells are passed by. per_z: 1 / grid.dz. V: opened.V,
    told apart so that nothing of solids is compiled where it is None. lines: solid_lines.py.
    """
    summed, along = 0.0, 0.0
    for c in range(first, last):
        ask_ahead(columns, c, last, u, 0, 0)
        ask_ahead(columns, c, last, v, 0, 0)
        ask_ahead(columns, c, last, w, 0, 0)
        ask_at_solids(columns, c, last, V, lines)
        i = columns[c, 0]
        j = columns[c, 1]
        k0, k1 = np.uint64(columns[c, 2]), np.uint64(columns[c, 3])
        per_x, per_y = 1.0 / grid.dx[i], 1.0 / grid.dy[j]
        if _may_be_faster(u, v, w, per_x, per_y, per_z, i, j, k0, k1, min(summed, along)):
            for k in range(k0, k1):
                both = _all_faces(u, v, w, per_x, per_y, per_z[k], i, j, k)
                if both <= min(summed, along):
                    continue
                if F is not None:
                    if not F[i, j, k] > least:
                        continue
                most, larger, comes = _whole_cell(u, v, w, per_x, per_y, per_z[k], i, j, k)
                rate = max(most, max(comes, both - comes))
                if V is not None:
                    if V[i, j, k] < 1.0:
                        rate, most = AT_A_CUT * larger, AT_A_CUT * most
                summed = max(summed, rate)
                along = max(along, most)
        if V is not None:
            if lines[i, j] != 0 and _cut_cells(V, i, j, k0, k1) > 0:
                for k in range(columns[c, 2], columns[c, 3]):
                    if 0.0 < V[i, j, k] < 1.0:
                        if F is None or F[i, j, k] > least:
                            x, y, z = _flow_rates(grid, opened, u, v, w, i, j, k)
                            summed = max(summed, x + y + z)
                            along = max(along, max(x, max(y, z)))
        rates[0, c] = summed
        rates[1, c] = along


def courant_rate(
    team: Team,
    columns: np.ndarray,
    grid: Grid,
    opened: Open,
    lines: np.ndarray | None,
    F: np.ndarray | None,
    least: float,
    velocity: list,
) -> tuple[float, float]:
    """The largest rates [1/time] at which liquid (F > least) crosses a cell, see above: in all, along one direction.
    lines: solid_lines.py."""
    rates = np.zeros((2, len(columns)))
    team.run(fastest, columns, grid, 1.0 / grid.dz, opened.V, opened, lines, F, least, *velocity, rates)
    summed, along = rates.max(axis=1, initial=0.0).tolist()
    return summed, along


def surface_limit(grid: Grid, gravity: np.ndarray, directions: tuple[bool, ...]) -> float:
    """Longest step [time] for waves on the free surface; inf without gravity. directions: those with cells."""
    g = float(np.linalg.norm(gravity))
    sizes = [float(d[G:-G].min()) for d, there in zip(grid[:3], directions, strict=True) if there]
    return math.sqrt(min(sizes) / (math.pi * g)) if g > 0.0 and sizes else math.inf
