"""Scratch of steps of two sweeps, in meshes of one layer of cells: what carried_flux.py and carried_moments.py need.

A step's planes are found once, at its start. The second sweep asks for planes of its own beside solids only.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flowgmo.flow.fields import G, Grid, Open
from flowgmo.flow.surface.carried_flux import carried_flux
from flowgmo.flow.surface.carried_moments import UNKNOWN, carry_moments, join_periodic, unknown_moments
from flowgmo.flow.surface.carriers import Carrier
from flowgmo.flow.surface.planes import Planes
from flowgmo.flow.team import Team


class Pieces:
    """before (mesh): F [-] at the step's start, which the caller keeps there; moments (mesh, 3): of its end
    (carried_moments.py). 56 bytes per cell, 88 with solids.

    planes: the scene's, found of F at the step's start; periodic (3,): which sides are joined.
    """

    def __init__(self, grid: Grid, planes: Planes, periodic: tuple[bool, bool, bool]) -> None:
        self.planes, self.periodic = planes, periodic
        self.grid = grid
        self.layer = tuple(slice(G, -G) if n == 1 + 2 * G else slice(None) for n in planes.at.shape[:3])
        self.between: Planes | None = None  # after the first sweep, beside solids
        self.before, self.moments = np.zeros(planes.at.shape[:3]), unknown_moments(grid)
        planes.moments = unknown_moments(grid)

    def spread_evenly(self, spread: Sequence[float | None]) -> None:
        """No planes beyond sides through which liquid enters evenly spread (surface_tracking.Spread)."""
        for side, F in enumerate(spread):
            if F is not None:
                np.moveaxis(self.planes.at, side // 2, 0)[-G if side % 2 else G - 1, ..., :3] = 0.0

    def flow_across(
        self,
        team: Team,
        columns: tuple[np.ndarray, np.ndarray],
        order: list[Carrier],
        dt: float,
        F: np.ndarray,
        opened: Open,
        flux: np.ndarray,
    ) -> None:
        """flux [length] of the second sweep. columns: of the faces, and of the cells that may hold liquid now."""
        one, own = order
        lines, anew = self.planes.solid_lines.of(opened), None
        if lines is not None:
            self.between = self.between or Planes(self.grid, self.planes.solid_lines)
            cells, anew = columns[1], self.between.at
            self.between.find_in(team, cells[lines[cells[:, 0], cells[:, 1]] != 0], F, opened)
        found = anew, lines, self.before, self.planes.at, self.periodic[own.way.d]
        team.run_uneven(carried_flux, columns[0], own, one, dt, F, opened.V, opened, *found, flux)

    def find_moments(self, team: Team, wet: np.ndarray, order: list[Carrier], dt: float, F: np.ndarray) -> None:
        """moments of the end of the step in the columns `wet`; F [-] is what it has become."""
        one, own = order
        self.moments[self.layer].fill(UNKNOWN)  # the last but one step's lie there, which no restart knows
        start = self.before, self.planes.at, self.periodic[own.way.d]
        team.run_uneven(carry_moments, wet, own, one, dt, F, *start, self.moments)
        join_periodic(self.moments, self.periodic)

    def keep_moments(self) -> None:
        """The step is made: the moments at its end are those that the next planes are found with."""
        self.planes.moments, self.moments = self.moments, self.planes.moments
