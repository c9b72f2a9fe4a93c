"""Open volumes that change during a step, from V0 to V1, as the liquid's motion needs them.

The sweeps (surface_tracking.py) divide V F by V, which must not be nothing. Between them V is the larger one of V0 and
V1, and the way there counts as a sweep of its own:

    before   V0 F + c (V - V0)  is what V holds       c = 1 where F > 1/2, as in the sweeps: a full cell stays full
    after    c (V - V0) is taken back from V F, and V becomes V1
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.fields import G, Grid, Open

HARDLY = 1e-3  # of a cell that is open: what such a cell holds too much is thousands of times what it can hold
ANYWAY = 1e-6  # of its open volume that a full cell takes: only where none has room does it count (spill_over.py)


class VolumeChange:
    """rows: index of the cells in arrays of mesh size; V0, V1 (n,); V (mesh): the open volumes, the larger one of both
    from now on."""

    def __init__(self, rows: tuple, V0: np.ndarray, V1: np.ndarray, V: np.ndarray) -> None:
        self.rows, self.V0, self.V1, self.V = rows, V0, V1, V
        self.most = np.maximum(np.maximum(V0, V1), V[rows])  # V: of where the body was expected
        V[rows] = self.most

    def stretch(self, F: np.ndarray) -> None:
        """Before the sweeps: F (changed) as a share of V."""
        here = F[self.rows]
        self.added = np.where(here > 0.5, self.most - self.V0, 0.0)
        filled = self.V0 * here + self.added
        F[self.rows] = np.divide(filled, self.most, out=np.zeros_like(filled), where=self.most > 0.0)

    def restore(self, liquid: np.ndarray, opened: Open, grid: Grid) -> None:
        """After the sweeps: take back from V F what `stretch` added; V is then what it is at the end of the step.

        Cells that close, or nearly, cannot hold what the sweeps left in them. Where no neighbour through an open face
        can take it (spill_over.py), it goes to the nearest cells that are open, to each as it has room.
        """
        liquid[self.rows] -= self.added
        self.V[self.rows] = self.V1
        excess = liquid[self.rows] - np.clip(liquid[self.rows], 0.0, self.V1)
        off = (self.V1 <= HARDLY) & (np.abs(excess) > 0.0)
        for cell, much in zip(np.column_stack(self.rows)[off], excess[off], strict=True):
            if not self._has_way_out(cell, float(much), liquid, opened):
                self._move_on(cell, float(much), liquid, grid)

    def _has_way_out(self, cell: np.ndarray, much: float, liquid: np.ndarray, opened: Open) -> bool:
        """Whether open faces lead to cells that can take the excess `much` [-], or have what is missing (< 0)."""
        found = 0.0
        for d, A in enumerate(opened[1:]):
            step = np.eye(3, dtype=np.int64)[d]
            for face, other in ((cell, cell + step), (cell - step, cell - step)):
                inside = G <= other[d] < A.shape[d] - G
                if inside and A[tuple(face)] > 0.0 and self.V[tuple(other)] > HARDLY:
                    found += self.V[tuple(other)] if much > 0.0 else max(float(liquid[tuple(other)]), 0.0)
        return found > abs(much)

    def _move_on(self, cell: np.ndarray, much: float, liquid: np.ndarray, grid: Grid) -> None:
        """A cell's excess to the nearest open ones; what is missing comes from the nearest that have some."""
        sizes = [d[k] for d, k in zip(grid[:3], cell, strict=True)]
        amount = much * float(np.prod(sizes))
        for reach in range(1, max(liquid.shape)):
            low = np.maximum(cell - reach, G)
            high = np.minimum(cell + reach + 1, np.array(liquid.shape) - G)
            box = tuple(slice(a, b) for a, b in zip(low, high, strict=True))
            V = self.V[box]
            room = np.maximum(V - liquid[box], 0.0) + ANYWAY * V if amount > 0.0 else np.maximum(liquid[box], 0.0)
            room[V <= HARDLY] = 0.0
            volumes = np.multiply.outer(np.multiply.outer(grid.dx[box[0]], grid.dy[box[1]]), grid.dz[box[2]])
            whole = float((room * volumes).sum())
            if whole > 0.0 and (amount > 0.0 or whole > -amount):
                liquid[box] += amount * room / whole
                liquid[tuple(cell)] -= much
                return
