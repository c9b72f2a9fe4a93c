"""The preconditioner: one V-cycle of geometric multigrid over the liquid's columns, in single precision.

A coarse cell is 2 × 2 × 2 cells, or fewer where cells are long: a direction is coarsened only while its cells are the
short ones (semi-coarsening), so that flat cells converge like cubes. Values go up as sums and down as constants. The
coefficient of a coarse face is that of a mesh twice as wide: the sum of the fine ones between liquid cells, divided by
the factor of coarsening across it. Faces to the free surface go into the diagonal (`surface`). Smoothing is
Gauss-Seidel, red and black; after the coarse correction in mirrored order, so that the whole cycle is symmetric, as
conjugate gradients need it (Tatebe 1993; McAdams, Sifakis & Teran 2010). Single precision halves the traffic: the
cycle only steers, the residual is kept in double precision by conjugate_gradients.py.

Measured (zero first guess, 1e-6 of the residual): 6 to 9 cycles for 4000 to 1.3 million liquid cells, free surface and
23 spheres; 13 for cells 20:1.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from flowgmo.flow.boundary import join_faces
from flowgmo.flow.columns import cells_in, clear_left, columns_under, tabulate
from flowgmo.flow.fields import G
from flowgmo.flow.layers import join_cells
from flowgmo.flow.pressure.multigrid_cycle import SWEEPS, WORDS, begin, cycle_below, prolong, restrict, smooth
from flowgmo.flow.pressure.multigrid_matrix import coarsen, complete, held_shares, invert, single
from flowgmo.flow.team import Team

FEW = 8000  # cells of a level, with all below it, that are one call
SMALLEST = 64  # cells of the coarsest level
LONG = 1.5  # a direction is coarsened while its cells are shorter than this times the shortest


class Level:
    """One mesh of the hierarchy: coefficients b, their diagonal and its inverse, unknown p, right-hand side r.

    arrays: bx, by, bz (None where absent), diagonal, surface, inverse, p, r, float32 of `shape` (with ghosts), zero.
    """

    def __init__(self, shape: tuple[int, ...], arrays: tuple) -> None:
        self.shape = shape
        self.bx, self.by, self.bz, self.diagonal, self.surface, self.inverse, self.p, self.r = arrays
        self.columns = self.held = np.zeros((0, 4), np.int32)  # of liquid cells; of faces with b > 0
        self.factors = (1, 1, 1)  # towards the next coarser level
        self.alone = 1  # 1: no cell has a neighbour of its own colour, not even across joined sides

    @property
    def coefficients(self) -> tuple:
        return self.bx, self.by, self.bz, self.diagonal, self.surface

    def take(self, columns: np.ndarray, ends: np.ndarray, team: Team, faces: tuple | None = None) -> None:
        """Fit to new columns: zero what these do not hold. ends [i, j] = (k0, k1): the columns as a table.

        faces: (columns, table) of all cells whose upper faces have b > 0, None where these are the same. Little is
        zeroed: sharing it among threads would take longer.
        """
        wider, table = faces or (columns, ends)
        for a in (self.bx, self.by, self.bz, self.diagonal):
            if a is not None:
                clear_left(self.held, 0, len(self.held), table, a)
        for a in (self.surface, self.inverse, self.p, self.r):
            clear_left(self.columns, 0, len(self.columns), ends, a)
        self.columns, self.held = columns, wider


class Multigrid:
    """The hierarchy over a mesh of `shape` (with ghosts), cell sizes (3,), periodic directions (3,).

    `rebuild` fits it to the liquid.
    """

    def __init__(self, shape: tuple[int, ...], sizes: tuple, periodic: tuple, team: Team) -> None:
        self.team, self.periodic = team, tuple(bool(joined) for joined in periodic)
        present = tuple(s > 1 + 2 * G for s in shape)  # a direction of one cell has no faces
        there = (*present, True, True, True, True, True)
        shapes, factors = _hierarchy([s - 2 * G for s in shape], list(sizes))
        size = sum(int(np.prod(s)) for s in shapes)
        self.flat = [np.zeros(size, np.float32) if t else None for t in there]  # all levels but the finest
        self.levels = [Level(tuple(shape), tuple(np.zeros(shape, np.float32) if t else None for t in there))]
        self.offsets, start = [0], 0
        for s in shapes:
            end = start + int(np.prod(s))
            self.levels.append(Level(s, tuple(None if a is None else a[start:end].reshape(s) for a in self.flat)))
            self.offsets.append(start)
            start = end
        for level, f in zip(self.levels, factors, strict=False):
            level.factors = f
        for level in self.levels:
            odd = [joined and n % 2 == 1 for joined, n in zip(self.periodic, level.shape, strict=True)]
            level.alone = int(not any(odd))
        self.ends = [np.zeros((*level.shape[:2], 2), np.int32) for level in self.levels]
        self.small = len(self.levels)  # first of the levels that one call does
        self.table = np.zeros((0, WORDS), np.int64)
        self.small_columns = np.zeros((0, 4), np.int32)

    def rebuild(
        self,
        faces: np.ndarray,
        columns: np.ndarray,
        ends: np.ndarray,
        matrix: tuple,
        scale: float,
        hold: Callable[[np.ndarray, float], None] | None = None,
    ) -> None:
        """Take the matrix (bx, by, bz, diagonal) of the finest mesh times a power of two.

        columns hold its liquid cells; faces, wider by one, all cells whose upper faces have b > 0; ends [i, j] = (k0,
        k1) the same, as a table. hold(surface, scale) adds to the held shares what the diagonal has besides its faces.
        """
        top, run = self.levels[0], self.team.run
        tabulate(columns, self.ends[0])
        top.take(columns, self.ends[0], self.team, (faces, ends))
        for source, target in zip(matrix, top.coefficients[:4], strict=True):
            if target is not None:
                run(single, faces, source, scale, target)
        self._join(top)
        run(invert, columns, top.diagonal, top.inverse)
        run(held_shares, columns, top.bx, top.by, top.bz, top.diagonal, top.surface)
        if hold is not None:
            hold(top.surface, scale)
        for fine, coarse, table in zip(self.levels[:-1], self.levels[1:], self.ends[1:], strict=True):
            under = columns_under(fine.columns, fine.factors, table)
            coarse.take(under, table, self.team)
            run(coarsen, under, fine.factors, *fine.coefficients, *coarse.coefficients)
            self._join(coarse)
            run(complete, under, coarse.bx, coarse.by, coarse.bz, coarse.surface, coarse.diagonal)
            self._join(coarse)
            run(invert, under, coarse.diagonal, coarse.inverse)
        self._gather()

    def mend(self, cells: np.ndarray, diagonal: np.ndarray, more: np.ndarray, scale: float) -> None:
        """The diagonal of a few of the finest cells (n, 3) is another one, times scale: 0 where it is none any more.

        more (n,): how much more they are held than before. Coarser levels take that, so that what nothing else holds
        is held there, too; what is held less they leave as it is, which is enough of a preconditioner for one step
        (the same iterations as with `rebuild`).
        """
        top, at = self.levels[0], tuple(cells.T)
        top.diagonal[at] = scale * diagonal
        top.inverse[at] = _inverse(top.diagonal[at])
        more = (scale * np.maximum(more, 0.0)).astype(np.float32)
        for fine, coarse in zip(self.levels[:-1], self.levels[1:], strict=True):
            cells = (cells - G) // np.array(fine.factors) + G
            at = tuple(cells.T)
            np.add.at(coarse.diagonal, at, np.where(coarse.diagonal[at] > 0.0, more, 0.0))
            coarse.inverse[at] = _inverse(coarse.diagonal[at])

    def _gather(self) -> None:
        """The table of the levels that are too small for threads."""
        n = len(self.levels)
        self.small = next((d for d in range(1, n) if cells_in(self.levels[d].columns) < FEW), n)
        small = self.levels[self.small :]
        rows = np.cumsum([0] + [len(level.columns) for level in small])
        self.table = np.array(
            [
                (o, *level.shape, a, b, *level.factors, level.alone)
                for o, level, a, b in zip(self.offsets[self.small :], small, rows[:-1], rows[1:], strict=True)
            ],
            np.int64,
        ).reshape(-1, WORDS)
        self.small_columns = np.concatenate([level.columns for level in small] or [self.small_columns[:0]])

    def _join(self, level: Level) -> None:
        if any(self.periodic):
            join_faces((level.bx, level.by, level.bz), self.periodic)
            join_cells(level.diagonal, *self.periodic)

    def cycle(self) -> np.ndarray:
        """One V-cycle from zero for the right-hand side levels[0].r; returns levels[0].p."""
        self._descend(0)
        return self.levels[0].p

    def _descend(self, depth: int) -> None:
        if depth == self.small:
            bx, by, bz, diagonal, _, inverse, p, r = self.flat
            cycle_below(self.table, self.small_columns, p, r, bx, by, bz, inverse, diagonal, self.periodic)
            return
        level, run = self.levels[depth], self.team.run
        run(begin, level.columns, level.p, level.r, level.inverse, 0)
        self._join_unknown(level)
        self._sweep(level, 0, begun=1)
        if depth + 1 < len(self.levels):
            below = self.levels[depth + 1]
            run(
                restrict, below.columns, *level.factors, level.alone, level.p, level.r, level.bx, level.by, level.bz,
                level.diagonal, below.r,
            )  # fmt: skip
            self._descend(depth + 1)
            run(prolong, level.columns, *level.factors, level.alone, below.p, level.inverse, level.p)
            self._join_unknown(level)
        self._sweep(level, 1)

    def _sweep(self, level: Level, colour: int, begun: int = 0) -> None:
        """Red-black pairs that begin with a colour, without the `begun` first halves."""
        for n in range(begun, 2 * SWEEPS):
            self.team.run(
                smooth, level.columns, level.p, level.r, level.bx, level.by, level.bz, level.inverse, (colour + n) & 1
            )  # fmt: skip
            self._join_unknown(level)

    def _join_unknown(self, level: Level) -> None:
        if any(self.periodic):
            join_cells(level.p, *self.periodic)


def _inverse(diagonal: np.ndarray) -> np.ndarray:
    """1 / diagonal, 0 where that is 0."""
    return np.where(diagonal > 0.0, 1.0 / np.where(diagonal > 0.0, diagonal, 1.0), 0.0)


def _hierarchy(n: list[int], h: list[float]) -> tuple[list[tuple[int, ...]], list[tuple[int, ...]]]:
    """Shapes (with ghosts) of the levels below a mesh of n cells of sizes h, and the factors from each level to the
    next, the finest level's first."""
    shapes, factors = [], []
    while np.prod(n) > SMALLEST and max(n) > 3:
        shortest = min(h[d] for d in range(3) if n[d] > 1)
        factors.append(tuple(2 if n[d] > 1 and h[d] < LONG * shortest else 1 for d in range(3)))
        n = [-(-n[d] // factors[-1][d]) for d in range(3)]
        h = [h[d] * factors[-1][d] for d in range(3)]
        shapes.append(tuple(m + 2 * G for m in n))
    return shapes, factors
