"""The surface's planes of all mixed cells, found once for each F.

A plane is asked for by the energy at the end of a step, by the pressure equation and its lids, and by the first sweep
of the step after: all of the same F. Each later sweep has planes of its own. They lie in one array of mesh size, of
which only what mixed cells touch is ever written or read, the first layer of ghosts included: liquid flows from there
too.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.fields import Grid, Open
from flowgmo.flow.solid_lines import SolidLines
from flowgmo.flow.surface.liquid_sweep import wet_columns
from flowgmo.flow.surface.surface_normals import find_planes, find_planes_at_solids, steps_of
from flowgmo.flow.team import Team


class Planes:
    """at (mesh, 4): m and alpha (plic.py) of mixed cells, in others nothing that counts. columns (n, 4): of the cells
    that hold liquid when `find` was last called, the first layer of ghosts among them. solid_lines: the scene's.
    32 bytes per cell."""

    def __init__(self, grid: Grid, solid_lines: SolidLines | None = None) -> None:
        shape = tuple(len(d) for d in grid[:3])
        self.at, self.steps = np.zeros((*shape, 4)), steps_of(grid)
        self.columns, self._bounds = np.zeros((0, 4), np.int32), np.zeros((*shape[:2], 2), np.int32)
        self._known: np.ndarray | None = None
        self.solid_lines = solid_lines or SolidLines()

    def find(self, team: Team, F: np.ndarray, opened: Open) -> None:
        """Of all liquid; F [-] with ghosts filled. Nothing is done where they are known."""
        if not self.are_of(F):
            self.columns = wet_columns(F, self._bounds)
            self.find_in(team, self.columns, F, opened)
            self._known = F

    def find_in(self, team: Team, columns: np.ndarray, F: np.ndarray, opened: Open) -> None:
        """Of the columns' cells, whatever is known; nothing is known of F after."""
        self._known = None
        lines = self.solid_lines.of(opened)
        team.run_uneven(find_planes, columns, F, opened.V, self.steps, lines, self.at)
        if lines is not None:
            team.run_uneven(find_planes_at_solids, columns, F, opened, self.steps, lines, self.at)

    def are_of(self, F: np.ndarray) -> bool:
        """Whether they were found for this F, and nothing has been forgotten since."""
        return F is self._known

    def forget(self) -> None:
        """F or the open fractions are others now."""
        self._known = None
