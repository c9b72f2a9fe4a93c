"""Implicit viscosity: it solves the operator's own equation, at any step, with slivers, walls and air."""

import numpy as np
import pytest
from momentum_scenes import (
    ALONE,
    NOTHING,
    blocks,
    implicit,
    inside,
    mesh,
    operators,
    random_velocity,
    shape_of,
    wrap,
)

from flowgmo.flow.columns import all_columns
from flowgmo.flow.fields import Open
from flowgmo.flow.momentum.viscosity import apply
from flowgmo.flow.team import Team


def periodic(c, q):
    wrap(q)


def scene(kind, seed=0, n=(9, 8, 7), length=1.0):
    rng = np.random.default_rng(seed)
    grid = mesh(n, (length,) * 3, graded=0.3)
    open = Open(*(wrap(a) for a in blocks(grid, rng, 4))) if "solid" in kind else NOTHING
    F = wrap((rng.random(shape_of(grid)) < 0.6).astype(float)) if "air" in kind else None
    velocity = tuple(wrap(q) for q in random_velocity(grid, rng, open))
    return grid, open, F, velocity


@pytest.mark.parametrize("kind", ["plain", "solid", "air", "solid air"])
@pytest.mark.parametrize("step", [0.1, 10.0, 1000.0])
def test_solves_its_equation(kind, step):
    """u - dt nu L u = u*, step in squared cells; energy falls, and no face of a solid or in air changes."""
    grid, open, F, velocity = scene(kind)
    made = operators(grid, open)
    before = [q.copy() for q in velocity]
    nu_dt = step * grid.dx.min() ** 2
    ended = implicit(grid, velocity, nu_dt, made, periodic, open.V, F, (True,) * 3)
    assert all(e.good for e in ended)
    assert max(e.iterations for e in ended) <= {0.1: 16, 10.0: 80, 1000.0: 200}[step]
    for c, (u, old) in enumerate(zip(velocity, before, strict=True)):
        wrap(u)
        back = u.copy()
        apply(ALONE, all_columns(u.shape), c, made[c], u, F, -nu_dt, back, 0.0)
        change = np.abs(inside(u - old)).max()
        assert (
            np.abs(inside(back - old)).max() < 1e-3 * (1 + step) * change
        )  # of the left side's terms, in the largest norm
        size = np.einsum("i,j,k->ijk", *(grid[3 + d] if d == c else grid[d] for d in range(3)))
        V = size if open.V is None else size * 0.5 * (open.V + np.roll(open.V, -1, axis=c))
        assert inside(V * u * u).sum() <= inside(V * old * old).sum()
        fixed = np.zeros(u.shape, bool)
        if open.V is not None:
            fixed |= open[1 + c] == 0
        if F is not None:
            fixed |= np.maximum(F, np.roll(F, -1, axis=c)) == 0
        assert np.array_equal(inside(u)[inside(fixed)], inside(old)[inside(fixed)])


def test_symmetric_operator():
    """(a, L b) = (L a, b) with the open volumes, walls, solids and air: conjugate gradients need it."""
    grid, open, F, a = scene("solid air", 3)
    made = operators(grid, open, (True,) * 6)
    b = scene("solid air", 4)[3]
    for c in range(3):
        size = np.einsum("i,j,k->ijk", *(grid[3 + d] if d == c else grid[d] for d in range(3)))
        M = inside(size * 0.5 * (open.V + np.roll(open.V, -1, axis=c)))
        closed = open[1 + c] == 0
        p, q = (np.where(closed, 0.0, e[c]) for e in (a, b))
        Lp, Lq = np.zeros_like(p), np.zeros_like(q)
        for e, out in ((p, Lp), (q, Lq)):
            apply(ALONE, all_columns(p.shape), c, made[c], wrap(e), F, 1.0, out, 0.0)
        left, right = (M * inside(q * Lp)).sum(), (M * inside(p * Lq)).sum()
        assert abs(left - right) < 1e-11 * np.abs(M * inside(q * Lp)).sum()
        assert (M * inside(p * Lp)).sum() < 0


def test_threads_units_and_nothing_to_do():
    kinds = [scene("solid", 1, (24, 22, 20), s) for s in (1.0, 1.0, 2.0**-6)]
    steps = (1e-2, 1e-2, 1e-2 * 2.0**-12)
    results = []
    for (grid, open, _, velocity), nu_dt, team in zip(kinds, steps, (ALONE, Team(3), ALONE), strict=True):
        made = operators(grid, open, team=team)
        ended = implicit(grid, velocity, nu_dt, made, periodic, open.V, free=(True,) * 3, team=team)
        results.append((ended, velocity))
    for other in results[1:]:
        assert [e.iterations for e in other[0]] == [e.iterations for e in results[0][0]]
        assert all(np.array_equal(a, b) for a, b in zip(results[0][1], other[1], strict=True))
    grid, open, _, velocity = scene("plain")
    still = tuple(np.zeros_like(q) for q in velocity)
    ended = implicit(grid, still, 1.0, operators(grid), periodic, free=(True,) * 3)
    assert all(e.good and e.iterations == 0 for e in ended)


def test_values_that_are_no_numbers_end_and_are_reported():
    grid, _, _, velocity = scene("plain")
    velocity[0][5, 5, 5] = np.nan
    ended = implicit(grid, velocity, 1.0, operators(grid), periodic, free=(True,) * 3)
    assert not ended[0].good and ended[1].good
