"""Conjugate gradients for the pressure equation, with one multigrid cycle as preconditioner.

    x (n+1) = x + alpha d,  r = b - A x,  z = M r,  d = z + beta d          (Hestenes & Stiefel 1952)

All over the liquid's columns. Dot products are summed per column, then by numpy in one order: the same bits for any
number of threads. beta is that of Polak and Ribière, which forgives a preconditioner that rounds (Notay 2000).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from flowgmo.flow.ahead import ask_ahead
from flowgmo.flow.columns import ONE
from flowgmo.flow.immersed.coupling import Coupling
from flowgmo.flow.layers import join_cells
from flowgmo.flow.pressure.multigrid import Multigrid
from flowgmo.flow.team import Team
from flowgmo.kernel import flow_kernel, inner

#: One iteration is made at least, unless the first guess is this much better than asked for: in still water residuals
#: below the tolerance would else add up until they reach it.
SETTLED = 1e-6
EARLY = 1e3  # times the tolerance: by then it is known which voids are full: 7.8 iterations a step, with 1e5 8.0


@flow_kernel
def residual(columns, first, last, x, right, bx, by, bz, diagonal, r):
    """r = right - A x; x in cells without liquid is a held value (0 at the surface, given at pressure sides)."""
    for c in range(first, last):
        ask_ahead(columns, c, last, x, 1, 0)
        ask_ahead(columns, c, last, right, 0, 0)
        ask_ahead(columns, c, last, bx, 0, 0)
        ask_ahead(columns, c, last, by, 0, 0)
        ask_ahead(columns, c, last, bz, 0, 0)
        ask_ahead(columns, c, last, diagonal, 0, 0)
        ask_ahead(columns, c, last, r, 0, 0)
        i = columns[c, 0]
        j = columns[c, 1]
        for k in range(np.uint64(columns[c, 2]), np.uint64(columns[c, 3])):
            t = right[i, j, k] - diagonal[i, j, k] * x[i, j, k]
            if bx is not None:
                t += bx[i - 1, j, k] * x[i - 1, j, k] + bx[i, j, k] * x[i + 1, j, k]
            if by is not None:
                t += by[i, j - 1, k] * x[i, j - 1, k] + by[i, j, k] * x[i, j + 1, k]
            if bz is not None:
                t += bz[i, j, k - ONE] * x[i, j, k - ONE] + bz[i, j, k] * x[i, j, k + ONE]
            r[i, j, k] = t if diagonal[i, j, k] != 0.0 else 0.0


@flow_kernel
def product(columns, first, last, d, bx, by, bz, diagonal, q, sums):
    """q = A d in liquid cells (d is 0 elsewhere); sums[c] = d . q of each column."""
    for c in range(first, last):
        ask_ahead(columns, c, last, d, 1, 0)
        ask_ahead(columns, c, last, bx, 0, 0)
        ask_ahead(columns, c, last, by, 0, 0)
        ask_ahead(columns, c, last, bz, 0, 0)
        ask_ahead(columns, c, last, diagonal, 0, 0)
        ask_ahead(columns, c, last, q, 0, 0)
        i = columns[c, 0]
        j = columns[c, 1]
        for k in range(np.uint64(columns[c, 2]), np.uint64(columns[c, 3])):
            t = diagonal[i, j, k] * d[i, j, k]
            if bx is not None:
                t -= bx[i - 1, j, k] * d[i - 1, j, k] + bx[i, j, k] * d[i + 1, j, k]
            if by is not None:
                t -= by[i, j - 1, k] * d[i, j - 1, k] + by[i, j, k] * d[i, j + 1, k]
            if bz is not None:
                t -= bz[i, j, k - ONE] * d[i, j, k - ONE] + bz[i, j, k] * d[i, j, k + ONE]
            q[i, j, k] = t if diagonal[i, j, k] != 0.0 else 0.0
        total = 0.0
        for k in range(np.uint64(columns[c, 2]), np.uint64(columns[c, 3])):  # apart: sums do not vectorise
            total += q[i, j, k] * d[i, j, k]
        sums[c] = total


@flow_kernel
def advance(columns, first, last, alpha, d, q, x, r, scale, target, weight_x, weight_y, weight_z, worst):
    """x += alpha d, r -= alpha q, then hand r over."""
    for c in range(first, last):
        ask_ahead(columns, c, last, d, 0, 0)
        ask_ahead(columns, c, last, q, 0, 0)
        ask_ahead(columns, c, last, x, 0, 0)
        ask_ahead(columns, c, last, r, 0, 0)
        ask_ahead(columns, c, last, target, 0, 0)
        i = columns[c, 0]
        j = columns[c, 1]
        for k in range(np.uint64(columns[c, 2]), np.uint64(columns[c, 3])):
            x[i, j, k] += alpha * d[i, j, k]
            r[i, j, k] -= alpha * q[i, j, k]
        worst[c] = _hand_over(columns, c, r, scale, target, weight_z) / (weight_x[i] * weight_y[j])


@inner
def _hand_over(columns, c, r, scale, target, weight_z):
    """target = scale r in single precision; returns the largest |r| / weight_z of a column."""
    i = columns[c, 0]
    j = columns[c, 1]
    largest = 0.0
    for k in range(np.uint64(columns[c, 2]), np.uint64(columns[c, 3])):
        target[i, j, k] = np.float32(r[i, j, k] * scale)
        largest = max(largest, abs(r[i, j, k]) * weight_z[k])
    return largest


@flow_kernel
def hand_over(columns, first, last, r, scale, target, weight_x, weight_y, weight_z, worst):
    """target = scale r in single precision; worst[c] = largest |r| / (cell volume) of each column.

    weight_x, weight_y: widths of cells; weight_z: 1 / their heights.
    """
    for c in range(first, last):
        ask_ahead(columns, c, last, r, 0, 0)
        ask_ahead(columns, c, last, target, 0, 0)
        worst[c] = _hand_over(columns, c, r, scale, target, weight_z) / (
            weight_x[columns[c, 0]] * weight_y[columns[c, 1]]
        )


@flow_kernel
def dots(columns, first, last, z, r, q, sums):
    """sums[:, c] = (z . r, z . q) of each column."""
    for c in range(first, last):
        ask_ahead(columns, c, last, z, 0, 0)
        ask_ahead(columns, c, last, r, 0, 0)
        ask_ahead(columns, c, last, q, 0, 0)
        i = columns[c, 0]
        j = columns[c, 1]
        one = 0.0
        two = 0.0
        for k in range(np.uint64(columns[c, 2]), np.uint64(columns[c, 3])):
            one += z[i, j, k] * r[i, j, k]
            two += z[i, j, k] * q[i, j, k]
        sums[0, c] = one
        sums[1, c] = two


@flow_kernel
def turn(columns, first, last, beta, z, d):
    """d = z + beta d."""
    for c in range(first, last):
        ask_ahead(columns, c, last, z, 0, 0)
        ask_ahead(columns, c, last, d, 0, 0)
        i = columns[c, 0]
        j = columns[c, 1]
        for k in range(np.uint64(columns[c, 2]), np.uint64(columns[c, 3])):
            d[i, j, k] = z[i, j, k] + beta * d[i, j, k]


@dataclass
class Solved:
    """How a solution went: iterations, the largest |r| / cell volume before and after, and whether that is enough.

    interrupted: it ended early, since the matrix is to be another one.
    """

    iterations: int
    before: float
    after: float
    converged: bool
    interrupted: bool = False


class ConjugateGradients:
    """Scratch arrays of mesh size (3 of float64) and the loop."""

    def __init__(
        self, shape: tuple[int, ...], widths: tuple[np.ndarray, ...], multigrid: Multigrid, team: Team
    ) -> None:
        self.r, self.d, self.q = (np.zeros(shape) for _ in range(3))
        self.widths, self.multigrid, self.team = widths, multigrid, team
        self.weights = (widths[0], widths[1], 1.0 / widths[2])

    @property
    def unknowns(self) -> tuple[np.ndarray, ...]:
        """Arrays that must be 0 in cells beside the liquid."""
        return (self.d,)

    def solve(
        self,
        columns: np.ndarray,
        matrix: tuple,
        right: np.ndarray,
        x: np.ndarray,
        tolerance: float,
        most: int,
        changes: Callable[[float], bool] | None = None,
        coupling: Coupling | None = None,
    ) -> Solved:
        """Improve x until |right - A x| <= tolerance times the volume of each cell, `most` iterations at most.

        changes(slack) is asked once, when the residual is below slack = EARLY tolerance: whether x so far calls for
        another matrix. Then this is the end of it.
        matrix: bx, by, bz, diagonal (float64, as multigrid.rebuild was given); coupling: what bodies that the pressure
        moves add to it, unknown to the preconditioner. right may be this solver's own r.
        """
        run, r, d, q, periodic = self.team.run, self.r, self.d, self.q, self.multigrid.periodic
        top = self.multigrid.levels[0]
        worst, sums, both = np.zeros(len(columns)), np.zeros(len(columns)), np.zeros((2, len(columns)))
        join_cells(x, *periodic)
        run(residual, columns, x, right, *matrix, r)
        if coupling is not None:
            coupling.add(x, -1.0, r)
        run(hand_over, columns, r, 0.0, top.r, *self.weights, worst)
        before = after = float(worst.max(initial=0.0))
        scale, alpha, old = 1.0, 0.0, 1.0
        for iteration in range(most + 1):
            if not after > (tolerance if iteration else SETTLED * tolerance):
                return Solved(iteration, before, after, bool(np.isfinite(after)))
            if iteration == most or not np.isfinite(after):
                break
            if changes is not None and after <= EARLY * tolerance:
                if changes(EARLY * tolerance):
                    return Solved(iteration, before, after, True, interrupted=True)
                changes = None
            if iteration == 0:
                scale = self._scale(before, columns)
                run(hand_over, columns, r, scale, top.r, *self.weights, worst)
            z = self.multigrid.cycle()
            run(dots, columns, z, r, q, both)
            new, crossed = both.sum(axis=1)
            beta = 0.0 if iteration == 0 else -alpha * crossed / old  # z . (r - r_before) = -alpha z . q
            run(turn, columns, beta, z, d)
            join_cells(d, *periodic)
            run(product, columns, d, *matrix, q, sums)
            curvature = float(sums.sum())
            if coupling is not None:
                curvature += coupling.add(d, 1.0, q)
            if not curvature > 0.0:
                break
            alpha, old = float(new) / curvature, float(new)
            run(advance, columns, alpha, d, q, x, r, scale, top.r, *self.weights, worst)
            after = float(worst.max(initial=0.0))
        return Solved(iteration, before, after, False)

    def _scale(self, size: float, columns: np.ndarray) -> float:
        """A power of two that brings residuals of a size [1/time] into the middle of single precision."""
        volume = np.prod([w[len(w) // 2] for w in self.widths])
        return 2.0 ** -np.frexp(size * volume)[1]
