"""Successive over-relaxation (`IGMRES` 0): the pressure solver of the ancestors, kept as the slow reference.

    x += omega (right - A x) / diagonal          red cells, then black ones                (Young 1954)

It takes as many sweeps as there are cells across, or more, where conjugate_gradients.py takes 6 to 10 cycles.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from flowgmo.flow.columns import ONE
from flowgmo.flow.layers import join_cells
from flowgmo.flow.pressure.conjugate_gradients import Solved, residual
from flowgmo.flow.pressure.multigrid_cycle import TWO, first_of
from flowgmo.flow.team import Team
from flowgmo.kernel import flow_kernel

OVER = 1.7  # as in SOLA-VOF (Nichols, Hirt & Hotchkiss 1980, section III.C)
LOOK = 10  # sweeps between two looks at the residual, which costs as much as a sweep
SWEEPS_AN_ITERATION = 100  # what ITMAX counts as one iteration here: it is meant for a cycle of the other solver


@flow_kernel
def relax(columns, first, last, x, right, bx, by, bz, diagonal, colour):
    """One colour of a sweep."""
    for c in range(first, last):
        i = columns[c, 0]
        j = columns[c, 1]
        for k in range(np.uint64(first_of(columns, c, colour)), np.uint64(columns[c, 3]), TWO):
            if diagonal[i, j, k] != 0.0:
                t = right[i, j, k] - diagonal[i, j, k] * x[i, j, k]
                if bx is not None:
                    t += bx[i - 1, j, k] * x[i - 1, j, k] + bx[i, j, k] * x[i + 1, j, k]
                if by is not None:
                    t += by[i, j - 1, k] * x[i, j - 1, k] + by[i, j, k] * x[i, j + 1, k]
                if bz is not None:
                    t += bz[i, j, k - ONE] * x[i, j, k - ONE] + bz[i, j, k] * x[i, j, k + ONE]
                x[i, j, k] += OVER * t / diagonal[i, j, k]


@flow_kernel
def largest(columns, first, last, r, wx, wy, wz, worst):
    """worst[c] = largest |r| / (cell volume) of each column."""
    for c in range(first, last):
        i = columns[c, 0]
        j = columns[c, 1]
        most = 0.0
        for k in range(np.uint64(columns[c, 2]), np.uint64(columns[c, 3])):
            error = abs(r[i, j, k]) / wz[k]
            most = max(most, error if error < np.inf else np.inf)  # a nan is no small error
        worst[c] = most / (wx[i] * wy[j])


class Relaxation:
    """The same signature as conjugate_gradients.ConjugateGradients; one scratch array of mesh size."""

    def __init__(self, shape: tuple[int, ...], widths: tuple[np.ndarray, ...], periodic: tuple, team: Team) -> None:
        self.r = np.zeros(shape)
        self.widths, self.periodic, self.team = widths, periodic, team

    @property
    def unknowns(self) -> tuple[np.ndarray, ...]:
        """Arrays that must be 0 in cells beside the liquid."""
        return ()

    def solve(
        self,
        columns: np.ndarray,
        matrix: tuple,
        right: np.ndarray,
        x: np.ndarray,
        tolerance: float,
        most: int,
        changes: Callable[[float], bool] | None = None,
    ) -> Solved:
        """Improve x until |right - A x| <= tolerance times the volume of each cell; iterations are sweeps.

        changes is not asked: that is the caller's when this has ended.
        """
        before = after = self._error(columns, matrix, right, x)
        sweeps = 0
        while tolerance < after < np.inf and sweeps < most * SWEEPS_AN_ITERATION:
            for _ in range(LOOK):
                for colour in (0, 1):
                    join_cells(x, *self.periodic)
                    self.team.run(relax, columns, x, right, *matrix, colour)
            sweeps += LOOK
            after = self._error(columns, matrix, right, x)
        return Solved(sweeps, before, after, bool(after <= tolerance))

    def _error(self, columns: np.ndarray, matrix: tuple, right: np.ndarray, x: np.ndarray) -> float:
        worst = np.zeros(len(columns))
        join_cells(x, *self.periodic)
        self.team.run(residual, columns, x, right, *matrix, self.r)
        self.team.run(largest, columns, self.r, *self.widths, worst)
        return float(worst.max(initial=0.0))
