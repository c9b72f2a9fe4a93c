"""Open volumes that change during a step, from V0 to V1, as the liquid's motion needs them.

The sweeps (surface_tracking.py) divide V F by V, which must not be nothing. Between them V is the larger one of V0 and
V1, and the way there counts as a sweep of its own:

    before   V0 F + c (V - V0)  is what V holds       c = 1 where F > 1/2, as in the sweeps: a full cell stays full
    after    c (V - V0) is taken back from V F, and V becomes V1
"""

from __future__ import annotations

import numpy as np


class VolumeChange:
    """rows: index of the cells in arrays of mesh size; V0, V1 (n,); V (mesh): the open volumes, the larger one of both
    from now on."""

    def __init__(self, rows: tuple, V0: np.ndarray, V1: np.ndarray, V: np.ndarray) -> None:
        self.rows, self.V0, self.V1, self.V = rows, V0, V1, V
        self.most = np.maximum(V0, V1)
        V[rows] = self.most

    def stretch(self, F: np.ndarray) -> None:
        """Before the sweeps: F (changed) as a share of V."""
        here = F[self.rows]
        self.added = np.where(here > 0.5, self.most - self.V0, 0.0)
        filled = self.V0 * here + self.added
        F[self.rows] = np.divide(filled, self.most, out=np.zeros_like(filled), where=self.most > 0.0)

    def restore(self, liquid: np.ndarray) -> None:
        """After the sweeps: take back from V F what `stretch` added; V is then what it is at the end of the step."""
        liquid[self.rows] -= self.added
        self.V[self.rows] = self.V1
