"""Open volumes that change during a step, from V0 to V1, as the liquid's motion needs them.

The sweeps (surface_tracking.py) divide V F by V, which must not be nothing. Between them V is the larger one of V0 and
V1, and the way there counts as a sweep of its own:

    before   V0 F + c (V - V0)  is what V holds       c = 1 where F > 1/2, as in the sweeps: a full cell stays full
    after    c (V - V0) is taken back from V F, and V becomes V1

A cell that is closed before and after may still have open faces: a body was expected to leave it and an impact held it,
or it opens and closes within the step. What comes in by the first sweep must still be there for the next one, so that
V is HARDLY in such a cell; after the sweeps it holds too much like others that close.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.fields import G, Grid, Open
from flowgmo.kernel import inner, kernel

HARDLY = 1e-3  # of a cell that is open: what such a cell holds too much is thousands of times what it can hold
ANYWAY = 1e-6  # of its open volume that a full cell takes: only where none has room does it count (spill_over.py)


@inner
def _way_out(much, liquid, V, A, face, other):
    """What a cell beside another can take of its excess `much` [-], or has of what it lacks (< 0); indices of the face
    between them and of that cell."""
    if not (A[face] > 0.0 and V[other] > HARDLY):
        return 0.0
    return V[other] if much > 0.0 else max(liquid[other], 0.0)


@kernel
def next_shut_in(cells, much, n, liquid, V, Ax, Ay, Az):
    """The first of cells[n:] (m, 3) whose open faces do not lead to cells that can take the excess much (m,) [-], or
    have what is missing (< 0); m if there is none."""
    nx, ny, nz = V.shape
    while n < len(cells):
        i, j, k = cells[n, 0], cells[n, 1], cells[n, 2]
        found = 0.0
        for d in range(3):
            A = Ax if d == 0 else (Ay if d == 1 else Az)
            di, dj, dk = np.int64(d == 0), np.int64(d == 1), np.int64(d == 2)
            at, size = (i, nx) if d == 0 else ((j, ny) if d == 1 else (k, nz))
            lower = (i - di, j - dj, k - dk)
            if at + 1 < size - G:
                found += _way_out(much[n], liquid, V, A, (i, j, k), (i + di, j + dj, k + dk))
            if at - 1 >= G:
                found += _way_out(much[n], liquid, V, A, lower, lower)
        if not found > abs(much[n]):
            return n
        n += 1
    return n


class VolumeChange:
    """rows: index of the cells in arrays of mesh size; V0, V1 (n,); V (mesh): the open volumes, the larger one of both
    from now on."""

    def __init__(self, rows: tuple, V0: np.ndarray, V1: np.ndarray, V: np.ndarray) -> None:
        self.rows, self.V0, self.V1, self.V = rows, V0, V1, V
        self.most = np.maximum(np.maximum(V0, V1), V[rows])  # V: of where the body was expected
        V[rows] = self.most

    def stretch(self, F: np.ndarray) -> None:
        """Before the sweeps: F (changed) as a share of V."""
        shut = (self.V0 <= 0.0) & (self.V1 <= 0.0)
        self.most = np.where(shut, np.maximum(self.most, HARDLY), self.most)
        self.V[self.rows] = self.most
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
        cells, much, n = np.column_stack(self.rows)[off].astype(np.int64), excess[off], 0
        while (n := int(next_shut_in(cells, much, n, liquid, self.V, *opened[1:]))) < len(cells):
            self._move_on(cells[n], float(much[n]), liquid, grid)
            n += 1

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
