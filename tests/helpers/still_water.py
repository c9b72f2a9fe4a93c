"""Water at rest around bodies that are held, in a cube of 16 cells."""

import numpy as np

from flowgmo.flow.favor.fractions import open_fractions
from flowgmo.flow.favor.moving_openings import MovingOpenings
from flowgmo.flow.favor.near_surface import Pose
from flowgmo.flow.surface.level_at_start import fit_level
from flowgmo.mesh import Block, Side

CELLS, WIDE = 16, 1.0 / 16
BLOCK = Block(*(np.linspace(0.0, 1.0, CELLS + 1),) * 3, tuple(Side(i, 1) for i in range(6)))
CENTRES = [(np.arange(CELLS + 4) - 1.5) * WIDE] * 3
HERE = Pose(np.eye(3), np.zeros(3))
RHO, G = 1000.0, 8.0


def openings(shape):
    return MovingOpenings(BLOCK, open_fractions(BLOCK, []), [], [shape], [HERE])


def water(moving, level):
    """F (mesh): level water, with ghosts, as the solver sees it in cut cells (level_at_start.py)."""
    F = np.empty((CELLS + 4,) * 3)
    F[:] = np.clip((level - CENTRES[2]) / WIDE + 0.5, 0.0, 1.0)
    every = np.ascontiguousarray(np.indices(F.shape).reshape(3, -1).T.astype(np.int32))
    fit_level(BLOCK.planes, moving.open, level, every, F)
    return F
