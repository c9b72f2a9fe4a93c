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

import numpy as np

from flowgmo.flow.boundary import join, join_faces
from flowgmo.flow.columns import ONE, columns_under
from flowgmo.flow.fields import G
from flowgmo.flow.pressure_matrix import clear
from flowgmo.flow.team import Team
from flowgmo.kernel import flow_kernel, inner

SWEEPS = 2  # red-black pairs before and after: with 1, 11 to 17 cycles in place of 6 to 9, and 1.5 times the time
LAST_SWEEPS = 8  # on the coarsest level, there and back: it holds at most 64 cells
SMALLEST = 64  # cells of the coarsest level
TWO = np.uint64(2)
LONG = 1.5  # a direction is coarsened while its cells are shorter than this times the shortest


@inner
def _neighbours(bx, by, bz, p, i, j, k):
    """Sum of b p over the faces of a cell."""
    total = p[i, j, k] * np.float32(0.0)
    if bx is not None:
        total += bx[i - 1, j, k] * p[i - 1, j, k] + bx[i, j, k] * p[i + 1, j, k]
    if by is not None:
        total += by[i, j - 1, k] * p[i, j - 1, k] + by[i, j, k] * p[i, j + 1, k]
    if bz is not None:
        total += bz[i, j, k - ONE] * p[i, j, k - ONE] + bz[i, j, k] * p[i, j, k + ONE]
    return total


@inner
def first_of(columns, c, colour):
    """The lowest cell of a column that has a colour."""
    return columns[c, 2] + ((columns[c, 0] + columns[c, 1] + columns[c, 2] + colour) & 1)


@flow_kernel
def smooth(columns, first, last, p, r, bx, by, bz, inverse, colour):
    """One half of a red-black Gauss-Seidel sweep for sum b (p - p_neighbour) = r."""
    for c in range(first, last):
        i = columns[c, 0]
        j = columns[c, 1]
        for k in range(np.uint64(first_of(columns, c, colour)), np.uint64(columns[c, 3]), TWO):
            p[i, j, k] = inverse[i, j, k] * (r[i, j, k] + _neighbours(bx, by, bz, p, i, j, k))


@flow_kernel
def restrict(columns, first, last, factors, p, r, bx, by, bz, diagonal, coarse):
    """coarse = sum over the fine cells of r - A p. The columns are the coarse ones."""
    fx, fy, fz = factors
    nx, ny, nz = diagonal.shape
    for c in range(first, last):
        m = columns[c, 0]
        n = columns[c, 1]
        i1 = min((m - G) * fx + G + fx, nx - G)
        j1 = min((n - G) * fy + G + fy, ny - G)
        for o in range(columns[c, 2], columns[c, 3]):
            k1 = min((o - G) * fz + G + fz, nz - G)
            total = np.float32(0.0)
            for i in range((m - G) * fx + G, i1):
                for j in range((n - G) * fy + G, j1):
                    for k in range(np.uint64((o - G) * fz + G), np.uint64(k1)):
                        if diagonal[i, j, k] != 0.0:
                            total += r[i, j, k] - diagonal[i, j, k] * p[i, j, k] + _neighbours(bx, by, bz, p, i, j, k)
            coarse[m, n, o] = total


@flow_kernel
def prolong(columns, first, last, factors, coarse, inverse, p):
    """p += coarse value over each liquid cell. The columns are the fine ones."""
    fx, fy, fz = factors
    for c in range(first, last):
        i = columns[c, 0]
        j = columns[c, 1]
        m = (i - G) // fx + G
        n = (j - G) // fy + G
        for k in range(columns[c, 2], columns[c, 3]):
            if inverse[i, j, k] != 0.0:
                p[i, j, k] += coarse[m, n, (k - G) // fz + G]


@flow_kernel
def single(columns, first, last, a, scale, out):
    """out = scale a, in single precision."""
    for c in range(first, last):
        i = columns[c, 0]
        j = columns[c, 1]
        for k in range(np.uint64(columns[c, 2]), np.uint64(columns[c, 3])):
            out[i, j, k] = np.float32(a[i, j, k] * scale)


@flow_kernel
def invert(columns, first, last, diagonal, out):
    """out = 1 / diagonal in liquid cells, 0 elsewhere."""
    for c in range(first, last):
        i = columns[c, 0]
        j = columns[c, 1]
        for k in range(np.uint64(columns[c, 2]), np.uint64(columns[c, 3])):
            d = diagonal[i, j, k]
            out[i, j, k] = 1 / d if d > 0.0 else d * 0


@inner
def _between(b, diagonal, i, j, k, m, n, o):
    """b of a face if both its cells are liquid."""
    return b[i, j, k] if diagonal[i, j, k] != 0.0 and diagonal[m, n, o] != 0.0 else np.float32(0.0)


@flow_kernel
def held_shares(columns, first, last, bx, by, bz, diagonal, surface):
    """surface = sum of the b of a liquid cell's faces to cells that are not liquid."""
    for c in range(first, last):
        i = columns[c, 0]
        j = columns[c, 1]
        for k in range(np.uint64(columns[c, 2]), np.uint64(columns[c, 3])):
            total = np.float32(0.0)
            if diagonal[i, j, k] != 0.0:
                if bx is not None:
                    total += bx[i - 1, j, k] if diagonal[i - 1, j, k] == 0.0 else np.float32(0.0)
                    total += bx[i, j, k] if diagonal[i + 1, j, k] == 0.0 else np.float32(0.0)
                if by is not None:
                    total += by[i, j - 1, k] if diagonal[i, j - 1, k] == 0.0 else np.float32(0.0)
                    total += by[i, j, k] if diagonal[i, j + 1, k] == 0.0 else np.float32(0.0)
                if bz is not None:
                    total += bz[i, j, k - ONE] if diagonal[i, j, k - ONE] == 0.0 else np.float32(0.0)
                    total += bz[i, j, k] if diagonal[i, j, k + ONE] == 0.0 else np.float32(0.0)
            surface[i, j, k] = total


@flow_kernel
def coarsen(columns, first, last, factors, bx, by, bz, diagonal, surface, Bx, By, Bz, whole, held):
    """Coefficients of the coarse columns' upper faces, and their cells' share of the surface; 1 in `whole` is liquid.

    The fine level's bx, by, bz, diagonal, surface; then the coarse level's.
    """
    fx, fy, fz = factors
    nx, ny, nz = diagonal.shape
    for c in range(first, last):
        m = columns[c, 0]
        n = columns[c, 1]
        i1 = min((m - G) * fx + G + fx, nx - G) - 1
        j1 = min((n - G) * fy + G + fy, ny - G) - 1
        for o in range(columns[c, 2], columns[c, 3]):
            k0 = (o - G) * fz + G
            k1 = min(k0 + fz, nz - G) - 1
            x = np.float32(0.0)
            y = np.float32(0.0)
            z = np.float32(0.0)
            s = np.float32(0.0)
            liquid = np.float32(0.0)
            for i in range((m - G) * fx + G, i1 + 1):
                for j in range((n - G) * fy + G, j1 + 1):
                    for k in range(k0, k1 + 1):
                        s += surface[i, j, k]
                        liquid = max(liquid, diagonal[i, j, k])
                        if bx is not None:
                            if i == i1:
                                x += _between(bx, diagonal, i, j, k, i + 1, j, k)
                        if by is not None:
                            if j == j1:
                                y += _between(by, diagonal, i, j, k, i, j + 1, k)
                    if bz is not None:
                        z += _between(bz, diagonal, i, j, k1, i, j, k1 + 1)
            if bx is not None:
                Bx[m, n, o] = x / np.float32(fx)
            if by is not None:
                By[m, n, o] = y / np.float32(fy)
            if bz is not None:
                Bz[m, n, o] = z / np.float32(fz)
            held[m, n, o] = s
            whole[m, n, o] = np.float32(1.0) if liquid > 0.0 else np.float32(0.0)


@flow_kernel
def complete(columns, first, last, bx, by, bz, surface, diagonal):
    """diagonal = surface + sum of the six b, where there is liquid."""
    for c in range(first, last):
        i = columns[c, 0]
        j = columns[c, 1]
        for k in range(np.uint64(columns[c, 2]), np.uint64(columns[c, 3])):
            if diagonal[i, j, k] != 0.0:
                total = surface[i, j, k]
                if bx is not None:
                    total += bx[i - 1, j, k] + bx[i, j, k]
                if by is not None:
                    total += by[i, j - 1, k] + by[i, j, k]
                if bz is not None:
                    total += bz[i, j, k - ONE] + bz[i, j, k]
                diagonal[i, j, k] = total


class Level:
    """One mesh of the hierarchy: coefficients b, their diagonal and its inverse, unknown p, right-hand side r."""

    def __init__(self, shape: tuple[int, ...], present: tuple[bool, ...], finest: bool) -> None:
        self.shape = shape  # with ghosts
        b = [np.zeros(shape, np.float32) if there else None for there in present]
        self.bx, self.by, self.bz = b
        self.diagonal, self.inverse, self.p, self.r = (np.zeros(shape, np.float32) for _ in range(4))
        self.surface = np.zeros(shape, np.float32)
        self.columns = np.zeros((0, 4), np.int32)
        self.faces = self.columns if finest else None
        self.factors = (1, 1, 1)  # towards the next coarser level

    @property
    def coefficients(self) -> tuple:
        return self.bx, self.by, self.bz, self.diagonal, self.surface

    def forget(self, team: Team) -> None:
        """Zero what the columns hold."""
        arrays = (*self.coefficients, self.inverse, self.p, self.r)
        for a in arrays:
            if a is not None:
                team.run(clear, self.columns if self.faces is None else self.faces, a)


class Multigrid:
    """The hierarchy over a mesh of `shape` (with ghosts), cell sizes (3,), periodic directions (3,).

    `rebuild` fits it to the liquid.
    """

    def __init__(self, shape: tuple[int, ...], sizes: tuple, periodic: tuple, team: Team) -> None:
        self.team, self.periodic = team, periodic
        present = tuple(s > 1 + 2 * G for s in shape)  # a direction of one cell has no faces
        self.levels = [Level(shape, present, finest=True)]
        n, h = [s - 2 * G for s in shape], list(sizes)
        while np.prod(n) > SMALLEST and max(n) > 3:
            shortest = min(h[d] for d in range(3) if n[d] > 1)
            factors = tuple(2 if n[d] > 1 and h[d] < LONG * shortest else 1 for d in range(3))
            self.levels[-1].factors = factors
            n = [-(-n[d] // factors[d]) for d in range(3)]
            h = [h[d] * factors[d] for d in range(3)]
            self.levels.append(Level(tuple(m + 2 * G for m in n), present, finest=False))

    def rebuild(self, faces: np.ndarray, columns: np.ndarray, matrix: tuple, scale: float) -> None:
        """Take the matrix (bx, by, bz, diagonal) of the finest mesh times a power of two.

        columns hold its liquid cells; faces, wider by one, all cells whose upper faces have b > 0.
        """
        top, run = self.levels[0], self.team.run
        for level in self.levels:
            level.forget(self.team)
        top.faces, top.columns = faces, columns
        for source, target in zip(matrix, top.coefficients[:4], strict=True):
            if target is not None:
                run(single, faces, source, scale, target)
        self._join(top)
        run(invert, columns, top.diagonal, top.inverse)
        run(held_shares, columns, top.bx, top.by, top.bz, top.diagonal, top.surface)
        for fine, coarse in zip(self.levels[:-1], self.levels[1:], strict=True):
            coarse.columns = columns_under(fine.columns, fine.factors, coarse.shape)
            run(coarsen, coarse.columns, fine.factors, *fine.coefficients, *coarse.coefficients)
            self._join(coarse)
            run(complete, coarse.columns, coarse.bx, coarse.by, coarse.bz, coarse.surface, coarse.diagonal)
            self._join(coarse)
            run(invert, coarse.columns, coarse.diagonal, coarse.inverse)

    def _join(self, level: Level) -> None:
        if any(self.periodic):
            join_faces((level.bx, level.by, level.bz), self.periodic)
            join(level.diagonal, self.periodic)

    def cycle(self) -> np.ndarray:
        """One V-cycle from zero for the right-hand side levels[0].r; returns levels[0].p."""
        self._descend(0)
        return self.levels[0].p

    def _descend(self, depth: int) -> None:
        level, run = self.levels[depth], self.team.run
        run(clear, level.columns, level.p)
        if depth == len(self.levels) - 1:
            self._sweep(level, LAST_SWEEPS, 0)
            self._sweep(level, LAST_SWEEPS, 1)
            return
        self._sweep(level, SWEEPS, 0)
        below = self.levels[depth + 1]
        run(
            restrict, below.columns, level.factors, level.p, level.r, level.bx, level.by, level.bz, level.diagonal,
            below.r,
        )  # fmt: skip
        self._descend(depth + 1)
        run(prolong, level.columns, level.factors, below.p, level.inverse, level.p)
        if any(self.periodic):
            join(level.p, self.periodic)
        self._sweep(level, SWEEPS, 1)

    def _sweep(self, level: Level, times: int, colour: int) -> None:
        """Red-black pairs that begin with a colour."""
        for _ in range(times):
            for c in (colour, 1 - colour):
                self.team.run(
                    smooth, level.columns, level.p, level.r, level.bx, level.by, level.bz, level.inverse, c
                )  # fmt: skip
                if any(self.periodic):
                    join(level.p, self.periodic)
