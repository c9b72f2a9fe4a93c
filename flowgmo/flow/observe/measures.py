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

from flowgmo.flow.ahead import ask_ahead
from flowgmo.flow.columns import ONE, columns_among
from flowgmo.flow.face_bits import LAST, NO_BIT, first_bit, start_of, words_of
from flowgmo.flow.fields import Flow, G, Grid, Open
from flowgmo.flow.observe.places_of_liquid import lean
from flowgmo.flow.solid_lines import SolidLines, ask_at_solids
from flowgmo.flow.surface.planes import Planes
from flowgmo.flow.surface.plic import is_mixed
from flowgmo.flow.team import Team
from flowgmo.kernel import flow_kernel, inlined, inner

NO = np.uint64(0)  # no step along a direction; unsigned as ONE


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


@inner
def _ask_for_faces(columns, c, last, u, A, lines):
    """Ask ahead for velocities and open areas of the columns' upper faces."""
    if u is not None:
        ask_ahead(columns, c, last, u, 0, 0)
        ask_at_solids(columns, c, last, A, lines)


@inner
def _wet_part(F, i, j, k0, k1):
    """(k0, k1) of the cells of a column with F other than 0, dust and negative remainders among them; k0 = k1: none."""
    if F is None:
        return np.uint64(k0), np.uint64(k1)
    low, high = np.uint64(k1), np.uint64(k0)
    for k in range(np.uint64(k0), np.uint64(k1)):  # without an early end: the loop vectorises
        there = F[i, j, k] != 0.0
        low = min(low, k if there else low)
        high = max(high, k + ONE if there else high)
    return min(low, high), high


@inner
def _leaning(cut, start, grid, opened, V, planes, F, g, i, j):
    """What the potential energy of mixed and cut cells, bits of a word from cell `start` on, is less than that of their
    centres: / rho, and by area."""
    total = 0.0
    while cut != NO_BIT:
        k = np.int64(start + first_bit(cut))
        cut &= cut - ONE
        weights = (g[0] * grid.dx[i], g[1] * grid.dy[j], g[2] * grid.dz[k])
        total += grid.dz[k] * lean(F, V, opened, planes, i, j, k, weights)
    return total


@inlined
def _sums(grid, V, Ax, Ay, Az, F, u, v, w, hx, hy, hz, least, momenta, i, j, k0, k1, start):
    """Of the cells k0 <= k < k1 of a column, per area: volume, kinetic and potential energy / rho, cells that count as
    wet, momentum / rho; and bits, from `start` on, of those in which the liquid may lie unevenly. V and A are None
    where they are 1. Without branches: few are foreseen."""
    volume, kinetic, potential, wet, cut = 0.0, 0.0, 0.0, 0.0, NO_BIT
    mx, my, mz = 0.0, 0.0, 0.0
    for k in range(k0, k1):
        part = grid.dz[k]
        apart = False
        if V is not None:
            part *= V[i, j, k]
            apart = V[i, j, k] < 1.0
        if F is not None:
            part *= F[i, j, k]
            apart = apart | is_mixed(F[i, j, k])
        if hx is not None:
            potential += part * (hx[i] + hy[j] + hz[k])
            cut |= ONE << (k - start) if apart & (part > 0.0) else NO_BIT
        square = mean_square(u, Ax, i, j, k, ONE, NO, NO)
        square += mean_square(v, Ay, i, j, k, NO, ONE, NO)
        square += mean_square(w, Az, i, j, k, NO, NO, ONE)
        volume += part
        kinetic += 0.5 * part * square
        if momenta is not None:
            mx += part * mean_of_faces(u, Ax, i, j, k, ONE, NO, NO)
            my += part * mean_of_faces(v, Ay, i, j, k, NO, ONE, NO)
            mz += part * mean_of_faces(w, Az, i, j, k, NO, NO, ONE)
        counted = part > 0.0
        if F is not None:
            counted = counted & (F[i, j, k] > least)
        wet += 1.0 if counted else 0.0
    return volume, kinetic, potential, wet, mx, my, mz, cut


@flow_kernel
def sum_columns(columns, first, last, grid, opened, V, lines, planes, F, u, v, w, hx, hy, hz, g, least, sums, momenta):
    """sums[c] = volume, its kinetic and potential energy / rho, and the cells with F > least, of each column; momenta
    (n, 3): momentum / rho, or None.

    opened: Open, V: opened.V (by itself, since None must be an argument to be pruned); lines: solid_lines.py; planes
    (mesh, 4) of F.
    hx, hy, hz (n + 4,) [length2/time2]: -g . x of cell centres along each direction; g (3,) [length/time2]. None
    without gravity.
    """
    for c in range(first, last):
        i = np.uint64(columns[c, 0])
        j = np.uint64(columns[c, 1])
        _ask_for_faces(columns, c, last, u, opened.Ax, lines)
        _ask_for_faces(columns, c, last, v, opened.Ay, lines)
        _ask_for_faces(columns, c, last, w, opened.Az, lines)
        ask_at_solids(columns, c, last, V, lines)
        ask_ahead(columns, c, last, F, 0, 0)
        volume, kinetic, potential, wet = 0.0, 0.0, 0.0, 0.0
        mx, my, mz = 0.0, 0.0, 0.0
        free = True
        if V is not None:
            free = lines[i, j] == 0
        k0, k1 = _wet_part(F, i, j, columns[c, 2], columns[c, 3])
        for word in range(*words_of(k0, k1)):
            start = start_of(word)
            ends, scene = (max(k0, start), min(k1, start + LAST + ONE)), (F, u, v, w, hx, hy, hz, least, momenta, i, j)
            if free:
                part = _sums(grid, None, None, None, None, *scene, *ends, start)
            else:
                part = _sums(grid, V, opened.Ax, opened.Ay, opened.Az, *scene, *ends, start)
            volume += part[0]
            kinetic += part[1]
            potential += part[2]
            wet += part[3]
            mx += part[4]
            my += part[5]
            mz += part[6]
            cut = part[7]
            if hx is not None:
                potential -= _leaning(cut, start, grid, opened, V, planes, F, g, np.int64(i), np.int64(j))
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
    solid_lines: SolidLines | None = None,
) -> Totals:
    """Totals of the liquid in the columns' cells; F with ghosts filled. least: F of a cell that counts as wet; momentum
    (3,) [mass length/time]: becomes that of the liquid. planes: the scene's, found here unless they are known; where
    they are, only columns that hold liquid are looked at. solid_lines: the scene's."""
    g, where = None, (None, None, None)
    if np.any(gravity):
        g, where = tuple(float(x) for x in gravity), heights(grid, gravity)
    at = None
    if g is not None and flow.F is not None:
        planes = planes or Planes(grid)
        planes.find(team, flow.F, openings)
        at, columns = planes.at, columns_among(planes.columns, flow.F, -np.inf)
    sums, momenta = np.empty((len(columns), 4)), None if momentum is None else np.empty((len(columns), 3))
    opened = openings, openings.V, (solid_lines or SolidLines()).of(openings)
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
