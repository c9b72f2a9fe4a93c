"""Viscous acceleration, implicit (`IMPVIS` > 0): stable at any step.

    (1 - dt nu L) u = u*        L: laplacian with open areas and walls (viscosity.py)

is solved for each component alone, as its change e = u - u*:

    (1 - dt nu L0) e = dt nu L u*        L0: L with all walls and given velocities at rest

u* is not what the other accelerations a make of the velocity, but what the last pressure p leaves of that; only the
change is added (stages.predict):

    u* = u0 + dt (a - grad p / rho),    u1 = u0 + dt a + e - dt grad p1 / rho      p1: of the projection
    so that u1 = u0 + dt (a + nu L u - grad p1 / rho),    u = u1 + dt grad (p1 - p) / rho

(van Kan 1986, A second-order accurate pressure-correction scheme; Guermond, Minev and Shen 2006, An overview of
projection methods, 3.2). Liquid at rest has u* = 0; what is steady does not depend on dt. Without the pressure
viscosity would see liquid that falls by g dt and walls that hold it: what it takes there the projection cannot give
back. Three things have to go with it:

* grad p is that of the pressure equation of the present surface and faces (first_stage.py); beyond them u* continues
  what the pressure acts on.
* Walls that bodies move see the bodies in the same way, with the load of p (WetBodies._foreseen), or a body as heavy as
  the liquid would fall through it.
* p has to be known in every cell. One that a body has just uncovered has that of its surroundings (immersed.py): with 0
  beside -430 Pa the liquid of one sliver had .4 m/s in a step, which friction took to the wall: a sphere in oil was
  stopped at every cell that it crossed. At t = 0 it is that of liquid at rest (build.py).

The left side times the faces' open volumes M is symmetric and positive definite. Conjugate gradients in the product
(a, b) = sum M a b, preconditioned by the diagonal (Shewchuk 1994, An introduction to the conjugate gradient method,
B3). Every iterate lies closer to the solution than the one before (in energy), so that a solve that ends early does no
harm. Condition number about 1 + 4 dt nu / width^2 times the number of directions: few iterations unless the step is
hundreds of explicit ones.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from flowgmo.flow.favor.cut_faces import STEPS, U64
from flowgmo.flow.fields import G, Grid
from flowgmo.flow.momentum.cut_viscosity import CutViscosity
from flowgmo.flow.momentum.viscosity import Velocity, Viscosity, apply
from flowgmo.flow.team import Team
from flowgmo.kernel import flow_kernel

Array = np.ndarray

TOLERANCE = 1e-6  # of the change: a step's error of time is far larger (first order: dt / T of it)
MOST = 200  # iterations; the condition number that takes more, 1e3 to 1e4, belongs to steps that resolve nothing


class Solved(NamedTuple):
    """How one component's solve ended: iterations, what remains relative to the start; good: within TOLERANCE."""

    iterations: int
    remaining: float
    good: bool


@flow_kernel
def add_change(columns, first, last, change, u):
    """u += change on the columns' upper faces."""
    for c in range(first, last):
        i = U64(columns[c, 0])
        j = U64(columns[c, 1])
        for k in range(U64(columns[c, 2]), U64(columns[c, 3])):
            u[i, j, k] += change[i, j, k]


@flow_kernel
def start(columns, first, last, x, y, z, factor, r, inverse):
    """r = 0; inverse = 1 / diagonal as on plain faces; x, y, z: Conduct, None where absent."""
    for c in range(first, last):
        i = U64(columns[c, 0])
        j = U64(columns[c, 1])
        across = 0.0
        if x is not None:
            across += x.lower[i] + x.upper[i]
        if y is not None:
            across += y.lower[j] + y.upper[j]
        for k in range(U64(columns[c, 2]), U64(columns[c, 3])):
            total = across
            if z is not None:
                total += z.lower[k] + z.upper[k]
            r[i, j, k] = 0.0
            inverse[i, j, k] = 1.0 / (1.0 + factor * total)


@flow_kernel
def diagonal_cut(rows, first, last, c, V, s, factor, inverse):
    """inverse on cut faces (c given), or with a side's s added (c None)."""
    for n in range(first, last):
        i = U64(rows[n, 0])
        j = U64(rows[n, 1])
        k = U64(rows[n, 2])
        if c is None:
            inverse[i, j, k] = 1.0 / (1.0 / inverse[i, j, k] + factor * s[n])
        else:
            total = s[n]
            for m in range(6):
                total += c[n, m]
            inverse[i, j, k] = V[n] / (V[n] + factor * total) if V[n] > 0.0 else 1.0


@flow_kernel
def advance(columns, first, last, ci, cj, ck, V, mx, my, mz, alpha, p, Ap, u, r, inverse, sums):
    """u += alpha p, r -= alpha Ap; sums (n,): sum of M r r / diagonal per column. p None: only the sums."""
    for c in range(first, last):
        i = U64(columns[c, 0])
        j = U64(columns[c, 1])
        total = 0.0
        for k in range(U64(columns[c, 2]), U64(columns[c, 3])):
            if p is not None:
                u[i, j, k] += alpha * p[i, j, k]
                r[i, j, k] -= alpha * Ap[i, j, k]
            share = mz[k] * inverse[i, j, k]
            if V is not None:
                share *= 0.5 * (V[i, j, k] + V[i + ci, j + cj, k + ck])
            total += share * (r[i, j, k] * r[i, j, k])
        sums[c] = total * (mx[i] * my[j])


@flow_kernel
def direct(columns, first, last, beta, r, inverse, p):
    """p = r / diagonal + beta p."""
    for c in range(first, last):
        i = U64(columns[c, 0])
        j = U64(columns[c, 1])
        for k in range(U64(columns[c, 2]), U64(columns[c, 3])):
            p[i, j, k] = r[i, j, k] * inverse[i, j, k] + beta * p[i, j, k]


@flow_kernel
def copy(columns, first, last, p, Ap):
    """Ap = p."""
    for c in range(first, last):
        i = U64(columns[c, 0])
        j = U64(columns[c, 1])
        for k in range(U64(columns[c, 2]), U64(columns[c, 3])):
            Ap[i, j, k] = p[i, j, k]


@flow_kernel
def product(columns, first, last, ci, cj, ck, V, mx, my, mz, p, Ap, sums):
    """sums (n,): sum of M p Ap per column."""
    for c in range(first, last):
        i = U64(columns[c, 0])
        j = U64(columns[c, 1])
        total = 0.0
        for k in range(U64(columns[c, 2]), U64(columns[c, 3])):
            share = mz[k]
            if V is not None:
                share *= 0.5 * (V[i, j, k] + V[i + ci, j + cj, k + ck])
            total += share * (p[i, j, k] * Ap[i, j, k])
        sums[c] = total * (mx[i] * my[j])


def inner_faces(columns: Array, shape: tuple[int, ...], c: int) -> Array:
    """columns without the faces of component c on the domain's upper side."""
    last = shape[c] - G - 1
    if c < 2:
        return columns[columns[:, c] < last]
    shorter = columns.copy()
    shorter[:, 3] = np.minimum(shorter[:, 3], last)
    return shorter[shorter[:, 2] < shorter[:, 3]]


def add_implicit_viscosity(
    team: Team,
    columns: Array,
    grid: Grid,
    V: Array | None,
    operators: tuple[Viscosity | None, ...],
    velocity: Velocity,
    F: Array | None,
    nu: float,
    dt: float,
    scratch: tuple[Array, Array, Array, Array],
    fill_change: Callable[[int, Array], None],
    free: tuple[bool, bool, bool] = (False, False, False),
    by: str = "all",
) -> list[Solved]:
    """Change the velocity (u, v, w) on the columns' upper faces by dt nu laplacian of what it becomes.

    velocity with its ghosts filled (mirrored at walls); they are not filled again. V [-] open volumes or None.
    scratch: four arrays of mesh size, any content. fill_change(c, e) fills the ghosts, and the joined side, of a change
    of component c: mirrored, continued, periodic, or 0 where the velocity is given. free: whether the faces on the
    upper side along x, y, z are unknown (periodic, pressure); else they stay. by: "all", or "walls": what a velocity
    that has had its viscosity gains when the walls of bodies are faster by CutViscosity.speed.
    Returns one Solved for each component that is there.
    """
    ended = []
    for c, (operator, u) in enumerate(zip(operators, velocity, strict=True)):
        if operator is not None:
            inside = columns if free[c] else inner_faces(columns, u.shape, c)
            ended.append(_solve(team, inside, c, grid, V, operator, u, F, nu * dt, scratch, fill_change, by))
    return ended


def _solve(
    team: Team, columns: Array, c: int, grid: Grid, V: Array | None, operator: Viscosity, u: Array, F: Array | None,
    factor: float, scratch: tuple[Array, ...], fill_change: Callable[[int, Array], None], by: str,
) -> Solved:  # fmt: skip
    """One component; factor = nu dt."""
    r, inverse, p, Ap = scratch
    if not len(columns):
        return Solved(0, 0.0, True)
    widths = tuple(grid[3 + d] if d == c else grid[d] for d in range(3))
    sums = np.empty(len(columns))
    p.fill(0.0)
    steps = (*STEPS[c], V, *widths)
    team.run(start, columns, *operator.conducts, factor, r, inverse)
    if operator.cut is not None:
        team.run(diagonal_cut, operator.cut.rows, operator.cut.c, operator.cut.V, operator.cut.s, factor, inverse)
    if operator.sides is not None:
        team.run(diagonal_cut, operator.sides.rows, None, None, operator.sides.s, factor, inverse)
    if by == "all":
        apply(team, columns, c, operator, u, F, factor, r, 0.0)
    else:
        _push(operator.cut, c, F, factor, r)
    team.run(advance, columns, *steps, 0.0, None, None, None, r, inverse, sums)
    rho = begin = float(sums.sum())
    beta = 0.0
    for iteration in range(MOST):
        if not rho > TOLERANCE**2 * begin:
            return Solved(iteration, _relative(rho, begin), rho <= TOLERANCE**2 * begin)
        team.run(direct, columns, beta, r, inverse, p)
        fill_change(c, p)
        team.run(copy, columns, p, Ap)
        apply(team, columns, c, operator, p, F, -factor, Ap, 0.0, moving=False)
        team.run(product, columns, *steps, p, Ap, sums)
        curvature = float(sums.sum())
        if not curvature > 0.0 or not np.isfinite(rho):
            break
        team.run(advance, columns, *steps, rho / curvature, p, Ap, u, r, inverse, sums)
        before, rho = rho, float(sums.sum())
        beta = rho / before
    return Solved(iteration + 1, _relative(rho, begin), rho <= TOLERANCE**2 * begin)


def _push(cut: CutViscosity | None, c: int, F: Array | None, factor: float, r: Array) -> None:
    """r = factor s speed / V on wet cut faces of component c; r is 0 before."""
    if cut is None or cut.speed is None:
        return
    low = tuple(cut.rows[:, :3].T)
    high = tuple((cut.rows[:, :3] + np.eye(3, dtype=cut.rows.dtype)[c]).T)
    some = cut.V > 0.0
    if F is not None:
        some &= np.maximum(F[low], F[high]) > 0.0
    r[low] = np.where(some, factor * cut.s * cut.speed / np.where(some, cut.V, 1.0), 0.0)


def _relative(rho: float, begin: float) -> float:
    return float(np.sqrt(rho / begin)) if begin > 0.0 else 0.0
