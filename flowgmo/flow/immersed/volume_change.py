"""Open volumes that change during a step, from V0 to V1, as the liquid's motion needs them.

The sweeps (surface_tracking.py) divide V F by V, which must not be nothing. Between them V is the larger one of V0 and
V1, and the way there counts as a sweep of its own:

    before   V0 F + c (V - V0)  is what V holds       c = 1 where F > 1/2, as in the sweeps: a full cell stays full
    after    c (V - V0) is taken back from V F, and V becomes V1
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.fields import G, Grid, Open

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

        What is left in cells that close, and have no open face to a cell that stays open (spill_over.py), goes to the
        nearest cells that are open, to each as it has room.
        """
        liquid[self.rows] -= self.added
        self.V[self.rows] = self.V1
        closing = (self.V1 == 0.0) & (liquid[self.rows] != 0.0)
        for cell in np.column_stack(self.rows)[closing]:
            if not self._has_way_out(cell, liquid, opened):
                self._move_on(cell, liquid, grid)

    def _has_way_out(self, cell: np.ndarray, liquid: np.ndarray, opened: Open) -> bool:
        """Whether an open face leads to an open cell, with liquid where some is missing."""
        missing = liquid[tuple(cell)] < 0.0
        for d, A in enumerate(opened[1:]):
            step = np.eye(3, dtype=np.int64)[d]
            for face, other in ((cell, cell + step), (cell - step, cell - step)):
                inside = G <= other[d] < A.shape[d] - G
                if inside and A[tuple(face)] > 0.0 and self.V[tuple(other)] > 0.0:
                    if not missing or liquid[tuple(other)] > 0.0:
                        return True
        return False

    def _move_on(self, cell: np.ndarray, liquid: np.ndarray, grid: Grid) -> None:
        """The liquid of a cell to the nearest open ones; what is missing comes from the nearest that have some."""
        sizes = [d[k] for d, k in zip(grid[:3], cell, strict=True)]
        amount = float(liquid[tuple(cell)] * np.prod(sizes))
        for reach in range(1, max(liquid.shape)):
            low = np.maximum(cell - reach, G)
            high = np.minimum(cell + reach + 1, np.array(liquid.shape) - G)
            box = tuple(slice(a, b) for a, b in zip(low, high, strict=True))
            V = self.V[box]
            room = np.maximum(V - liquid[box], 0.0) + ANYWAY * V if amount > 0.0 else np.maximum(liquid[box], 0.0)
            room[V == 0.0] = 0.0
            if room.any():
                volumes = np.multiply.outer(np.multiply.outer(grid.dx[box[0]], grid.dy[box[1]]), grid.dz[box[2]])
                liquid[box] += amount * room / float((room * volumes).sum())
                liquid[tuple(cell)] = 0.0
                return
