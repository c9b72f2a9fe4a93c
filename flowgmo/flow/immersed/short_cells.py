"""Cells amid liquid that hold a little less than their volume, beside bodies that move: no voids, but a debt.

What the pressure could not know (how far a body turns within the step, what an impact does to it) leaves cells a little
over- or underfull. Taken for voids, the underfull ones would have the void's pressure, in the middle of the liquid. So
where a cell lacks less than SMALL of a cell's volume, and so does every neighbour through an open face, it is full for
the pressure equation, and what it lacks flows in, half of it in each step, as what others hold too much flows out.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.ahead import ask_ahead
from flowgmo.flow.fields import G
from flowgmo.flow.team import Team
from flowgmo.kernel import flow_kernel, inner, kernel

SMALL = 0.02  # of a cell's volume: what steps of a body's motion leave; a void by which a surface shows is larger

NOTICED = 1e-7  # [-] 1 - F: less is below what the solver's tolerance leaves, and no void for lids.py either


@inner
def _lacks(F, V, i, j, k):
    """What a cell lacks [-], in volumes of cells."""
    return (1.0 - F[i, j, k]) * V[i, j, k]


@flow_kernel
def _list_short(columns, first, last, F, V, Ax, Ay, Az, lines, most, starts, numbers, counts):
    """Numbers of the cells of each column that are to be full, counts[c] of them from numbers[starts[c]] on. lines:
    solid_lines.py."""
    nx, ny, nz = F.shape
    for c in range(first, last):
        ask_ahead(columns, c, last, F, 0, 0)
        i = np.int64(columns[c, 0])
        j = np.int64(columns[c, 1])
        counts[c] = 0
        some = False
        if lines[i, j] == 0:  # many columns have none: a loop that vectorises says so
            for k in range(np.uint64(columns[c, 2]), np.uint64(columns[c, 3])):
                some |= (1.0 - F[i, j, k] > NOTICED) & (1.0 - F[i, j, k] < most)
        else:
            for k in range(np.uint64(columns[c, 2]), np.uint64(columns[c, 3])):
                some |= (1.0 - F[i, j, k] > NOTICED) & (_lacks(F, V, i, j, k) < most)
        if not some:
            continue
        for k in range(np.int64(columns[c, 2]), np.int64(columns[c, 3])):
            if not (1.0 - F[i, j, k] > NOTICED and 0.0 < _lacks(F, V, i, j, k) < most):
                continue
            deep = True
            for d in range(3):
                di, dj, dk = np.int64(d == 0), np.int64(d == 1), np.int64(d == 2)
                A = Ax if d == 0 else (Ay if d == 1 else Az)
                at, n = (i, nx) if d == 0 else ((j, ny) if d == 1 else (k, nz))
                if at < n - G - 1 and A[i, j, k] > 0.0 and _lacks(F, V, i + di, j + dj, k + dk) >= most:
                    deep = False
                if at > G and A[i - di, j - dj, k - dk] > 0.0 and _lacks(F, V, i - di, j - dj, k - dk) >= most:
                    deep = False
            if deep:
                numbers[starts[c] + counts[c]] = (i * ny + j) * nz + k
                counts[c] += 1


@kernel
def _together(starts, numbers, counts, out):
    """The listed numbers one after the other."""
    n = np.int64(0)
    for c in range(len(counts)):
        for m in range(starts[c], starts[c] + counts[c]):
            out[n] = numbers[m]
            n += 1


class ShortCells:
    """Those of one step: numbers (n,), flat index of arrays of mesh size, and what they lack (n,) [-]. Voids are void
    until `restore`: what little they hold is no liquid for the pressure, wherever it lies."""

    def __init__(
        self, team: Team, columns: np.ndarray, F: np.ndarray, V: np.ndarray, areas: tuple, lines: np.ndarray,
        voids: np.ndarray,
    ) -> None:  # fmt: skip
        """Find them in columns, and make F full there until `restore`. lines: solid_lines.py; voids: numbers of cells
        that are empty."""
        ends = np.cumsum(columns[:, 3] - columns[:, 2])
        counts, room = np.empty(len(columns), np.int64), np.empty(int(ends[-1]) if len(ends) else 0, np.int64)
        starts = ends - (columns[:, 3] - columns[:, 2])
        team.run(_list_short, columns, F, V, *areas, lines, SMALL, starts, room, counts)
        self.numbers, self.F = np.empty(int(counts.sum()), np.int64), F.reshape(-1)
        _together(starts, room, counts, self.numbers)
        if len(voids):
            self.numbers = self.numbers[~np.isin(self.numbers, voids)]
        self.changed = np.concatenate([self.numbers, voids])
        self.held = self.F[self.changed]
        self.lack = 1.0 - self.F[self.numbers]
        self.F[self.numbers], self.F[voids] = 1.0, 0.0

    def restore(self) -> None:
        """F as it is."""
        self.F[self.changed] = self.held
