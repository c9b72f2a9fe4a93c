"""Shear of the liquid on stationary solids, body by body, for the loads that are recorded.

The momentum equation takes from the liquid beside a wall, on each face of component c (wall_shear.py),

    mu s (u - u_wall) volume

Its reaction is the force on the wall along c. A face's wall belongs to the solids that cover its two cells, in
proportion to the areas they cover there. What walls of the domain take (A closed with no solid) belongs to no body.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from flowgmo.flow.favor.cut_faces import STEPS
from flowgmo.flow.fields import Flow, G, Grid
from flowgmo.flow.momentum.wall_shear import wall_force
from flowgmo.flow.team import Team

if TYPE_CHECKING:
    from flowgmo.flow.liquid import Liquid

Walls = Mapping[int, tuple[np.ndarray, np.ndarray]]  # number of a body -> cells (m, 3) [with ghosts], shares (m, 6)


@dataclass(frozen=True)
class Part:
    """Faces of component c beside one body: rows (n, 4), s (n,) [1/length2], share (n,) of the wall that is the
    body's, places (n, 3) [length]."""

    c: int
    rows: np.ndarray
    s: np.ndarray
    share: np.ndarray
    places: np.ndarray


@dataclass(frozen=True)
class BodyShear:
    """Called with a Flow: places (n, 3) [length] and forces (n, 3) of the liquid on the wall of one body at rest."""

    parts: tuple[Part, ...]
    grid: Grid
    mu: float
    team: Team

    def __call__(self, flow: Flow) -> tuple[np.ndarray, np.ndarray]:
        places, forces = [np.zeros((0, 3))], [np.zeros((0, 3))]
        for part in self.parts:
            along = np.empty(len(part.rows))
            q, grid = flow.velocity[part.c], self.grid
            self.team.run(
                wall_force, part.rows, *STEPS[part.c], q, flow.F, part.s, None, self.mu, grid.dx, grid.dy, grid.dz,
                along,
            )  # fmt: skip
            force = np.zeros((len(along), 3))
            force[:, part.c] = part.share * along
            places.append(part.places)
            forces.append(force)
        return np.concatenate(places), np.concatenate(forces)


def shear_of_solids(liquid: Liquid, planes: Sequence[np.ndarray]) -> dict[int, BodyShear]:
    """One for each body in liquid.walls that holds the liquid; none where solids do not (`IWSH` 0, no viscosity).

    planes: those of the mesh, an array [length] for each direction.
    """
    operators = liquid.momentum.operators
    if operators is None or not liquid.plan.no_slip:
        return {}
    covered = {number: _covered_area(*wall, liquid.grid) for number, wall in liquid.walls.items()}
    total = np.zeros(liquid.shape)
    for number, (cells, _) in liquid.walls.items():
        total[tuple(cells.T)] += covered[number]
    found = {}
    for number, (cells, _) in liquid.walls.items():
        own = np.zeros(liquid.shape)
        own[tuple(cells.T)] = covered[number]
        parts = [
            _part(c, operator.cut.rows, operator.cut.s, own, total, planes)
            for c, operator in enumerate(operators)
            if operator is not None and operator.cut is not None
        ]
        found[number] = BodyShear(tuple(parts), liquid.grid, liquid.plan.mu, liquid.team)
    return found


def _covered_area(cells: np.ndarray, shares: np.ndarray, grid: Grid) -> np.ndarray:
    """(m,) [length2]: how much of the faces of its cells a body covers."""
    dx, dy, dz = (d[cells[:, e]] for e, d in enumerate(grid[:3]))
    return (shares * np.repeat(np.column_stack([dy * dz, dz * dx, dx * dy]), 2, axis=1)).sum(axis=1)


def _part(
    c: int, rows: np.ndarray, s: np.ndarray, own: np.ndarray, total: np.ndarray, planes: Sequence[np.ndarray]
) -> Part:
    """The cut faces of component c that feel the body whose covered areas are `own`, of all bodies' `total`."""
    low = tuple(rows[:, :3].T)
    high = tuple((rows[:, :3] + np.eye(3, dtype=rows.dtype)[c]).T)
    mine, all_of_it = own[low] + own[high], total[low] + total[high]
    kept = (mine > 0.0) & (s > 0.0)
    rows = np.ascontiguousarray(rows[kept])
    return Part(c, rows, s[kept], mine[kept] / all_of_it[kept], _places(rows, c, planes))


def _places(rows: np.ndarray, c: int, planes: Sequence[np.ndarray]) -> np.ndarray:
    """(n, 3) [length]: middles of the faces."""
    low, high = (
        np.column_stack([x[rows[:, d] - G + up] for d, x in enumerate(planes)]).reshape(-1, 3) for up in (0, 1)
    )
    places = 0.5 * (low + high)
    places[:, c] = high[:, c]
    return places
