"""No-slip walls: Couette and Poiseuille flow between domain sides, and between solids' walls anywhere in the cells."""

import numpy as np
import pytest
from momentum_scenes import (
    ALONE,
    NOTHING,
    implicit,
    inside,
    layer,
    mesh,
    mirror,
    operators,
    shape_of,
    upper_planes,
    viscous,
    wrap,
)

from flowgmo.flow.favor.cut_faces import STEPS
from flowgmo.flow.fields import Grid, Open
from flowgmo.flow.momentum.wall_shear import wall_force

G_ACCELERATION, NU = 0.7, 0.2


def periodic_in_x(c, q):
    wrap(q, (0, 1))
    if c != 2:
        mirror(q, 2)


def channel(n, graded=0.0, open_between=None):
    grid = mesh((3, 1, n), (0.3, 0.1, 1.0), 0.0)
    fine = mesh((3, 1, n), (0.3, 0.1, 1.0), graded)
    grid = Grid(grid.dx, grid.dy, fine.dz, grid.hx, grid.hy, fine.hz)
    return grid, NOTHING if open_between is None else layer(grid, *open_between)


def stream(grid, open, made, force):
    """The steady flow along x by implicit steps; returns the velocity arrays."""
    n = shape_of(grid)
    u = np.zeros(n)
    w = np.zeros(n)
    moving = open.Ax > 0 if open.Ax is not None else np.ones(n, bool)
    for dt in [1.0] * 16:  # each leaves 1 / (1 + nu pi^2 dt) = 1 / 3 of what is not steady
        u[moving] += dt * force
        periodic_in_x(0, u)
        ended = implicit(grid, (u, None, w), NU * dt, made, periodic_in_x, open.V, free=(True, False, False))
        assert all(e.good for e in ended)
        periodic_in_x(0, u)
    assert not w.any()
    return u, w


@pytest.mark.parametrize("graded", [0.0, 0.3])
def test_couette_between_domain_sides(graded):
    """The sides move at -1 and 3: the profile is linear to the solver's tolerance, and stays to round-off."""
    grid, open = channel(9, graded)
    speeds = np.zeros((6, 3))
    speeds[4, 0], speeds[5, 0] = -1.0, 3.0
    made = operators(grid, open, (False,) * 4 + (True, True), speeds)
    u, _ = stream(grid, open, made, 0.0)
    z = upper_planes(grid.dz)[1]
    assert np.abs(inside(u - (4 * z - 1))).max() < 1e-6
    exact = np.zeros(shape_of(grid)) + (4 * z - 1)
    periodic_in_x(0, exact)
    assert np.abs(inside(viscous(grid, (exact, None, np.zeros_like(exact)), NU, 1e-3, made)[0])).max() < 1e-12


@pytest.mark.parametrize("floor", [0.0, 3 / 9, 3.5 / 9, 3.2 / 9, 3.9 / 9])
def test_couette_above_a_floor_inside_the_mesh(floor):
    """Linear in the middle of each cell's open part, wherever the floor cuts the cells."""
    grid, open = channel(9, 0.0, (floor, None))
    speeds = np.zeros((6, 3))
    speeds[5, 0] = 2.0
    made = operators(grid, open, (False,) * 4 + (True, True), speeds)
    u, w = stream(grid, open, made, 0.0) if floor else (None, None)
    z = upper_planes(grid.dz)[0]
    middle = 0.5 * (z + np.maximum(z - grid.dz, floor))
    exact = np.where(open.Ax > 0, 2 * (middle - floor) / (1 - floor), 0.0)
    if floor:
        assert np.abs(inside(u - exact)).max() < 1e-6
    periodic_in_x(0, exact)
    assert np.abs(inside(viscous(grid, (exact, None, 0 * exact), NU, 0.0, made)[0])).max() < 1e-11


def profile_error(n, bottom, top):
    """Largest difference from the parabola at the middle of the open parts, relative to its peak."""
    between = None if (bottom, top) == (0, n) else (bottom / n, top / n)
    grid, open = channel(n, 0.0, between)
    made = operators(grid, open, (False,) * 4 + (True, True))
    u, _ = stream(grid, open, made, G_ACCELERATION)
    a, b = bottom / n, top / n
    z = upper_planes(grid.dz)[0]
    middle = 0.5 * (np.minimum(z, b) + np.maximum(z - grid.dz, a))
    exact = G_ACCELERATION / (2 * NU) * (middle - a) * (b - middle)
    open_cells = inside(u) != 0
    assert open_cells.sum() == (shape_of(grid)[0] - 4) * (int(np.ceil(top)) - int(bottom))
    return np.abs(inside(u - exact))[open_cells], G_ACCELERATION / (8 * NU) * (b - a) ** 2


@pytest.mark.parametrize(("low", "high"), [(0, 0), (1, 1), (0.5, 0.5), (0.3, 1.8), (0.95, 1.5)])
def test_poiseuille_second_order(low, high):
    """Walls `low` and `high` cells inside the domain: measured order 1.99 to 2.1.

    With whole cells the difference is the constant g d^2 / (8 nu) everywhere: the wall's layer is half a cell.
    """
    errors = []
    for n in (8, 16, 32):
        error, peak = profile_error(n, low, n - high)
        errors.append(error.max() / peak)
        if low == int(low) and high == int(high):
            assert np.abs(error - G_ACCELERATION / (8 * NU * n**2)).max() < 1e-5 * peak
    assert np.log2(errors[1] / errors[2]) > 1.9


@pytest.mark.parametrize("walls", [None, (0.25, 0.8), (0.31, 0.74)])
def test_walls_carry_the_whole_force(walls):
    """Steady: the shear on all walls is the body force on all liquid."""
    n, rho = 12, 3.0
    grid, open = channel(n, 0.0, walls)
    made = operators(grid, open, (False,) * 4 + (True, True))
    u, _ = stream(grid, open, made, G_ACCELERATION)
    a, b = walls or (0.0, 1.0)
    total = 0.0
    for part in (made[0].sides, made[0].cut):
        if part is not None and len(part.rows):
            out = np.empty(len(part.rows))
            sizes = grid[:3]
            ALONE.run(wall_force, part.rows, *STEPS[0], u, None, part.s, None, rho * NU, *sizes, out)
            total += out.sum()
    assert total == pytest.approx(rho * G_ACCELERATION * 0.3 * 0.1 * (b - a), rel=1e-6)


def test_gap_of_one_cell_feels_both_walls():
    """Closed below and above: s = 2 walls / (half a cell * cell), which the closure of areas alone would miss."""
    grid, open = channel(9, 0.0, (4 / 9, 5 / 9))
    cut = operators(grid, open)[0].cut
    assert np.allclose(cut.s, 4 * 81, rtol=1e-12) and (cut.rows[:, 2] == 6).all()


def oblique(n):
    """A channel at 45 degrees in x-z, periodic, n / (2 sqrt 2) cells wide; its walls cut cells in half."""
    grid = mesh((n, 1, n))
    shape = shape_of(grid)
    i, k = np.arange(shape[0])[:, None, None], np.arange(shape[2])[None, None, :]
    m = (k - i) % n  # cells 0 and n / 2 are cut, those between open
    full = np.ones(shape)
    half = n // 2
    V = np.where((m == 0) | (m == half), 0.5, np.where(m < half, 1.0, 0.0)) * full
    # open above the first diagonal, below the second
    Ax = np.where((m >= 1) & (m <= half), 1.0, 0.0) * full  # the upper x-face of cell m lies between m and m - 1
    Az = np.where(m < half, 1.0, 0.0) * full
    return grid, Open(V, Ax, V.copy(), Az)


def test_poiseuille_oblique():
    """Walls at 45 degrees, 11 and 23 cells across: flow rate 1.7 % and 1.05 % low; first order: d is rough there."""
    errors = []
    for n in (32, 64):
        grid, open = oblique(n)
        made = operators(grid, open)
        u, w = (np.zeros(shape_of(grid)) for _ in range(2))

        def fill(c, q):
            wrap(q)

        for dt in [1.0] * 8:
            u[open.Ax > 0] += dt * G_ACCELERATION
            w[open.Az > 0] += dt * G_ACCELERATION
            wrap(u), wrap(w)
            implicit(grid, (u, None, w), NU * dt, made, fill, open.V, free=(True, True, True))
            wrap(u), wrap(w)
        width = 0.5 / np.sqrt(2)
        flow = inside(u)[n // 2].sum() / n  # through a plane of constant x: the channel is half as high as the box
        exact = G_ACCELERATION / (12 * NU) * width**2 * 0.5
        errors.append(abs(flow / exact - 1))
    assert errors[0] < 0.02 and errors[1] < 0.7 * errors[0]
