"""The surface's planes of all mixed cells, found once for each F.

A plane is asked for by the energy at the end of a step, by the pressure equation and its lids, and by the first sweep
of the step after: all of the same F. Each later sweep has planes of its own. They lie in one array of mesh size, of
which only what mixed cells touch is ever written or read, the first layer of ghosts included: liquid flows from there
too.

Where bodies move, the open fractions are others each of these times, and so is F in a few cells. A plane is of what 27
cells hold, so that those of other lines along z stay: only lines are looked at again that solids come near, now or when
planes were last found (solid_lines.py), and what is `touch`ed.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.fields import Grid, Open
from flowgmo.flow.solid_lines import SolidLines, mark_lines, spread
from flowgmo.flow.surface.liquid_sweep import columns_within, look_for_liquid
from flowgmo.flow.surface.surface_normals import find_planes, find_planes_at_solids, steps_of
from flowgmo.flow.team import Team


class Planes:
    """at (mesh, 4): m and alpha (plic.py) of mixed cells, in others nothing that counts. columns (n, 4): of the cells
    that hold liquid when `find` was last called, the first layer of ghosts among them. solid_lines: the scene's.
    moments (mesh, 3) of F, None where none are known (carried_moments.py). 32 bytes per cell.

    Tables (mesh without z) int8 of lines: _near, those that solids came near when planes were last found; _others,
    where the open fractions may be others now; _written, where F is."""

    def __init__(self, grid: Grid, solid_lines: SolidLines | None = None) -> None:
        shape = tuple(len(d) for d in grid[:3])
        self.at, self.steps = np.zeros((*shape, 4)), steps_of(grid)
        self.columns, self._bounds = np.zeros((0, 4), np.int32), np.zeros((*shape[:2], 2), np.int32)
        self._known: np.ndarray | None = None
        self.solid_lines = solid_lines or SolidLines()
        self.moments: np.ndarray | None = None
        self._every = np.ones(shape[:2], np.int8)
        self._near, self._others, self._written = (np.zeros(shape[:2], np.int8) for _ in range(3))
        self._outdated = False

    def find(self, team: Team, F: np.ndarray, opened: Open) -> None:
        """Of all liquid; F [-] with ghosts filled. Nothing is done where they are known."""
        if self.are_of(F):
            return
        lines = self.solid_lines.of(opened)
        if self.columns_are_of(F):
            if lines is not None:
                self._others |= lines
            spread(self._written, self._others)
            some = self._others[self.columns[:, 0], self.columns[:, 1]] != 0
            self._find(team, self.columns[some], F, opened, lines)
        else:
            look_for_liquid(F, self._every, self._bounds)
            self.columns = columns_within(self._bounds)
            self._find(team, self.columns, F, opened, lines)
        self.forget()
        self._known = F
        self._near.fill(0) if lines is None else np.copyto(self._near, lines)

    def find_in(self, team: Team, columns: np.ndarray, F: np.ndarray, opened: Open) -> None:
        """Of the columns' cells, whatever is known; nothing is known of F after."""
        self.forget()
        self._find(team, columns, F, opened, self.solid_lines.of(opened))

    def _find(self, team: Team, columns: np.ndarray, F: np.ndarray, opened: Open, lines: np.ndarray | None) -> None:
        team.run_uneven(find_planes, columns, F, opened.V, self.steps, lines, self.moments, self.at)
        if lines is not None:
            near = columns[lines[columns[:, 0], columns[:, 1]] != 0]
            team.run_uneven(find_planes_at_solids, near, F, opened, self.steps, self.at)

    def are_of(self, F: np.ndarray) -> bool:
        """Whether they were found for this F, and nothing has been forgotten since."""
        return F is self._known and not self._outdated

    def columns_are_of(self, F: np.ndarray) -> bool:
        """Whether `columns` holds all liquid of F, now that lines of which it was written are looked at again."""
        if F is self._known and self._outdated:
            look_for_liquid(F, self._written, self._bounds)
            self.columns = columns_within(self._bounds)
        return F is self._known

    def outdate(self) -> None:
        """The open fractions are others now, where solids come near or came near before; F is the same."""
        self._others |= self._near
        self._outdated = True

    def touch(self, cells: np.ndarray) -> None:
        """F of cells (n, 3) [with ghosts] is another now."""
        if len(cells):
            mark_lines(cells, self._written)
            self._outdated = True

    def pass_on(self, F: np.ndarray, to: np.ndarray) -> None:
        """What is known of F holds of its copy `to`."""
        self._known = to if F is self._known else None

    def forget(self) -> None:
        """F is another now, or the open fractions anywhere."""
        self._known, self._outdated = None, False
        self._others.fill(0)
        self._written.fill(0)
