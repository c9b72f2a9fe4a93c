"""The energy that liquid brings through open sides, and that the pressure outside gives it as it passes.

    given = sum over faces of open sides, inwards, of    volume * (p_wall + rho |u|^2 / 2 - rho g . (x - x0))

volume: of the liquid that passed in the step; x0 as in the potential energy (measures.py). Heights and pressures are
those of the centres of the side's cells, moved to the side: where the liquid is hydrostatic p_wall - rho g . x does not
depend on where in its cell it lies. p_wall is what is given on pressure sides; elsewhere that of the cell, with what
gravity and the change of the velocity across the side in the step make of it over half a cell,

    p_wall = p + rho (g - (u1 - u0) / dt) . (wall - centre of the cell)

What enters has the velocities of the ghosts along the side, what leaves those of the cell.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flowgmo.flow.boundary import Sides
from flowgmo.flow.fields import G
from flowgmo.flow.observe.measures import heights
from flowgmo.mesh import PERIODIC, PRESSURE, SYMMETRY, WALL

Array = np.ndarray
CLOSED = (SYMMETRY, WALL, PERIODIC)


def is_open(kind: int) -> bool:
    """Whether liquid comes and goes through a side of this kind (mesh.py), and not back through the other one."""
    return kind not in CLOSED


def energy_heads(
    sides: Sides, old: Sequence[Array | None], new: Sequence[Array | None], p: Array, q: Array, wet: Array, dt: float
) -> list[Array | None]:
    """Of each side (6) the energy that a volume of what passes gives the domain [mass/length/time2], on all faces of
    the side, ghosts too; None of sides where nothing passes.

    old, new: velocities before the step and of its end, ghosts filled; p (mesh) of the step, q = p dt / rho with what
    pressure sides held in its ghosts; wet (mesh): not 0 where the pressure equation has a cell.
    """
    centres, of = heights(sides.grid, sides.gravity), (new, p, q, wet, dt)
    passes = [is_open(plan.kind) and new[side // 2] is not None for side, plan in enumerate(sides.plans)]
    return [_head(sides, side, old[side // 2], *of, centres) if yes else None for side, yes in enumerate(passes)]


def _head(
    sides: Sides,
    side: int,
    before: Array,
    new: Sequence[Array | None],
    p: Array,
    q: Array,
    wet: Array,
    dt: float,
    centres: list[Array],
) -> Array:
    """See energy_heads; before: the velocity across the side at the start of the step."""
    d, upper = divmod(side, 2)
    sign, n = (1.0 if upper else -1.0), sides.n[d]
    cell, face, ghost = (n + G - 1, n + G - 1, n + G) if upper else (G, G - 1, G - 1)
    rho, g, half = sides.rho, float(sides.gravity[d]), 0.5 * sides.widths[d][cell]
    normal = _layer(new[d], d, face)
    inwards = -sign * normal
    square = normal**2
    for c, u in enumerate(new):
        if c != d and u is not None:
            at = np.where(inwards > 0.0, _centred(u, c, d, ghost), _centred(u, c, d, cell))
            square = square + at**2
    if sides.plans[side].kind == PRESSURE:
        wall = _layer(q, d, ghost) * (rho / dt)
    else:
        gained = (normal - _layer(before, d, face)) / dt
        wall = _layer(p, d, cell) + rho * (g - gained) * sign * half
        wall = np.where(_layer(wet, d, cell) != 0, wall, 0.0)
    place = centres[d][cell] - g * sign * half
    e, f = (k for k in range(3) if k != d)
    place = place + np.add.outer(centres[e], centres[f])
    return wall + rho * (0.5 * square + place)


def _centred(u: Array, c: int, d: int, k: int) -> Array:
    """The mean over both faces of the cells of layer k along d, of the velocity along c; of the lowest ghosts their
    upper face."""
    layer, along = _layer(u, d, k), c if c < d else c - 1
    lower = np.concatenate([layer.take([0], along), layer.take(range(layer.shape[along] - 1), along)], along)
    return 0.5 * (layer + lower)


def _layer(a: Array, d: int, k: int) -> Array:
    """The layer k along direction d, a view."""
    return a[(slice(None),) * d + (k,)]
