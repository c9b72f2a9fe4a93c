"""What the sides of the domain and the solids that stand still give to the liquid's momentum.

    pressure   on a face of area A S on a side    p_wall A S,    p_wall = p + rho g . (wall - centre of the cell)
               on a solid                         - (p a + rho g lift)                        loads.py
    shear      - mu s (u - u_wall) volume         of faces beside sides and solids            momentum/wall_shear.py
    streams    rho F u (u . n) A S inwards, and the pressure, through open sides

p is that of the step, u that of its end (the shear is the mean of the stages, to first order). Liquid in cells without
an unknown of the pressure equation, films below a tenth of a cell, lies on the side which gravity points at: that bears
its weight. Forces of periodic sides cancel each other.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from flowgmo.flow.favor.cut_faces import STEPS
from flowgmo.flow.fields import G, Grid, Open
from flowgmo.flow.momentum.wall_shear import wall_force
from flowgmo.flow.observe.loads import Wall
from flowgmo.flow.surface.plic import FULL
from flowgmo.flow.team import Team
from flowgmo.kernel import kernel
from flowgmo.mesh import PERIODIC, SYMMETRY, WALL

Array = np.ndarray


class Pressed(NamedTuple):
    """p (mesh) [mass/length/time2] of a step, wet (mesh) not 0 where the pressure equation has a cell, rho, gravity."""

    p: Array
    wet: Array
    rho: float
    gravity: Array


@kernel
def _sum_side(width, height, A, wet, p, F, below, lid):
    """Over the faces (n, m) of a side: sum of area times the pressure p - below on it where the cell is wet (not 0),
    and of area times F where it is not. width (n,), height (m,); A, F (n, m) or None; lid: cells that are not full do
    not pull."""
    force, dry = 0.0, 0.0
    for a in range(len(width)):
        for b in range(len(height)):
            area = width[a] * height[b]
            if A is not None:
                area *= A[a, b]
            if wet[a, b] != 0:
                wall = p[a, b] - below
                if F is not None:
                    if lid and F[a, b] < FULL:
                        wall = max(wall, 0.0)
                force += area * wall
            elif F is not None:
                dry += area * F[a, b]
    return force, dry


def by_sides(
    pressed: Pressed,
    velocity: Sequence[Array | None],
    F: Array | None,
    openings: Open,
    grid: Grid,
    kinds: Sequence[int],
    stream: Sequence[Array | None] | None = None,
) -> tuple[Array, Array]:
    """(3,), (3,) [force]: of the closed and of the open sides on the liquid.

    velocity: which directions are there; stream: the velocity that the liquid comes and goes with, None: pressure
    alone; kinds (6,): of the sides, as in mesh.py; openings: areas of the step.
    """
    closed, opened = np.zeros(3), np.zeros(3)
    for side, kind in enumerate(kinds):
        d, upper = divmod(side, 2)
        if velocity[d] is None or kind == PERIODIC:
            continue
        n, sign = len(grid[d]) - 2 * G, (-1.0 if upper else 1.0)
        cell, face = (n + G - 1, n + G - 1) if upper else (G, G - 1)
        across = [w[G:-G] for e, w in enumerate(grid[:3]) if e != d]
        A = None if openings[1 + d] is None else _layer(openings[1 + d], d, face)
        weight = pressed.rho * float(pressed.gravity[d])  # per volume
        lid = F is not None and weight * sign > 0.0  # under it the surface may lie between centre and side
        layers = (None if a is None else _layer(a, d, cell) for a in (pressed.wet, pressed.p, F))
        force, dry = _sum_side(*across, A, *layers, 0.5 * sign * weight * grid[d][cell], lid)
        force *= sign
        if kind not in (SYMMETRY, WALL):
            opened[d] += force
            if stream is not None:
                area = np.multiply.outer(*across) if A is None else np.multiply.outer(*across) * A
                opened += sign * pressed.rho * _stream(d, area, cell, face, stream, F)
            continue
        if weight * sign < 0.0:
            force -= weight * grid[d][cell] * dry
        closed[d] += force
    return closed, opened


def by_solids(pressed: Pressed, walls: Iterable[Wall]) -> Array:
    """(3,) [force] of the pressure of solids that stand still on the liquid."""
    total = np.zeros(3)
    for wall in walls:
        at = tuple(wall.cells.T)
        wet = (pressed.wet[at] != 0.0)[:, None]
        each = pressed.p[at][:, None] * wall.areas + pressed.rho * pressed.gravity * wall.lifts
        total -= (wet * each).sum(axis=0)
    return total


def by_shear(
    team: Team,
    velocity: Sequence[Array | None],
    F: Array | None,
    grid: Grid,
    mu: float,
    cuts: Sequence[tuple[Array, Array] | None],
    sides: Sequence[tuple[Array, Array, Array] | None],
) -> Array:
    """(3,) [force] of the friction of sides and solids that stand still on the liquid.

    cuts: of each component rows (n, 4) and s (n,) [1/length2] of solids that stand still; sides: rows, s, speed (n,) of
    the sides; None where there are none.
    """
    total = np.zeros(3)
    for c, own in enumerate(velocity):
        for of_wall in (cuts[c], sides[c]):
            if of_wall is None or own is None or not len(of_wall[0]):
                continue
            rows, s, *speed = of_wall
            out = np.empty(len(rows))
            args = (own, F, s, speed[0] if speed else None, mu, grid.dx, grid.dy, grid.dz, out)
            team.run(wall_force, rows, *STEPS[c], *args)
            total[c] -= float(out.sum())
    return total


def _layer(a: Array, d: int, k: int) -> Array:
    """The real part of a layer of an array of mesh size, across direction d."""
    part = [slice(G, -G)] * 3
    part[d] = k
    return a[tuple(part)]


def _stream(d: int, area: Array, cell: int, face: int, velocity: Sequence[Array | None], F: Array | None) -> Array:
    """(3,) [length4/time2]: sum of u u_d F over a side's faces; F of where the liquid comes from."""
    out, inner = np.zeros(3), 1 if face < cell else -1
    normal = _layer(velocity[d], d, face)
    rate = area * normal
    if F is not None:
        inside, outside = _layer(F, d, cell), _layer(F, d, cell - inner)
        rate = rate * np.where(normal * inner > 0.0, outside, inside).clip(0.0, 1.0)
    for c, u in enumerate(velocity):
        if u is not None:
            own = normal if c == d else 0.5 * (_layer(u, d, cell) + _layer(np.roll(u, 1, c), d, cell))
            out[c] = float((rate * own).sum())
    return out
