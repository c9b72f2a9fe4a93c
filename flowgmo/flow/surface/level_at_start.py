"""Level water at the start, as the solver will see it.

F of a cell that several sheets or an edge cut is known exactly (liquid_cells.py), but all that a step knows of the
solid are V and A, from which it takes one plane (surface_at_solids.py). Water that is level by the exact shapes is then
not level to the solver, and moves: by up to sqrt(g h) beside thin plates. Here F of these cells is what makes the
solver find the height that was asked for,

    V F = open volume of the plane's part below the height

which is the same where a plane cuts the cell. Else the liquid differs by what an edge takes from its cell, as V does.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.fields import G, Open
from flowgmo.flow.surface.cut_level import holds_below
from flowgmo.kernel import kernel


@kernel
def _fit(cells, levels, opened, F):
    for c in range(len(cells)):
        i, j, k = np.int64(cells[c, 0]), np.int64(cells[c, 1]), np.int64(cells[c, 2])
        share = holds_below(opened, i, j, k, 2, levels[c], 1.0) / opened.V[i, j, k]
        F[i, j, k] = min(max(share, 0.0), 1.0)


def fit_level(planes: tuple, openings: Open, height: float, cells: np.ndarray, F: np.ndarray) -> None:
    """Set F of those of the cells (n, 3) [with ghosts] that are open and that the plane z = height crosses.

    planes: of the block. Ghosts are left alone. Nothing is done without solids.
    """
    if openings.V is None:
        return
    z = planes[2]
    cells = cells[((cells >= G) & (cells < np.array(F.shape) - G)).all(axis=1)]
    low, high = z[cells[:, 2] - G], z[cells[:, 2] - G + 1]
    there = (low < height) & (height < high) & (openings.V[tuple(cells.T)] > 0.0)
    _fit(cells[there], ((height - low) / (high - low))[there], openings, F)
