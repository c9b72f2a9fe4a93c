"""The pressure equation and its solvers: exact solutions, symmetry, iteration counts that do not grow with the mesh."""

import numpy as np
import pytest
from flowgmo_pressure import NO_SOLIDS, RHO, block_of, g, level_pool, net_outflow, projector

from flowgmo.flow.boundary import Sides
from flowgmo.flow.columns import columns_where, widen
from flowgmo.flow.fields import G, Open, grid_of, zeros
from flowgmo.flow.pressure.projection import Projector
from flowgmo.flow.pressure.sealed import PressedTogether
from flowgmo.flow.team import Team
from flowgmo.flow_plan import SidePlan
from flowgmo.mesh import PERIODIC, PRESSURE, WALL


def random_flow(block, sides, seed=0):
    rng = np.random.default_rng(seed)
    velocity = [rng.standard_normal(zeros(block).shape) if n > 1 else None for n in block.shape]
    sides.fill_velocity(velocity)
    return velocity


@pytest.mark.parametrize("height", [0.301, 0.35, 0.4999, 0.5, 0.52])
def test_hydrostatic_pressure_is_exact_wherever_the_surface_lies(height):
    """p = rho g (h - z) in every liquid cell, whatever part of its cell the surface fills (second order condition).

    Measured 2e-11 of the bottom pressure. With the surface at faces only it would be wrong by up to half a cell.
    """
    block = block_of((6, 5, 20))
    P = projector(block)
    F = level_pool(block, height)
    P.sides.fill_fraction(F)
    P.set_surface(F)
    dt = 1e-3
    velocity = [zeros(block), zeros(block), zeros(block)]
    velocity[2][...] = -g * dt
    P.sides.fill_velocity(velocity)
    p = zeros(block)
    assert P.project(velocity, p, F, dt, 1e-12, 40).converged
    z = 0.5 * (block.z[1:] + block.z[:-1])
    liquid = F[4, 4, G:-G] >= 0.5
    exact = RHO * g * (height - z)
    assert np.abs(p[4, 4, G:-G] - exact)[liquid].max() < 1e-9 * RHO * g * height
    inside = (slice(G, -G),) * 3
    assert np.abs(velocity[2][inside][F[inside] > 0.5]).max() < 1e-12 * 0.07 / dt  # tolerance of 1e-12 of a cell


@pytest.mark.parametrize(
    "kinds", [(WALL,) * 6, (PERIODIC,) * 4 + (WALL,) * 2, (PERIODIC,) * 6, (PRESSURE,) * 2 + (WALL,) * 4]
)
@pytest.mark.parametrize("shape", [(24, 16, 20), (21, 1, 18), (13, 7, 1)])
def test_every_cell_lets_out_what_it_lets_in(shape, kinds):
    """After the projection of a random flow no full cell gains or loses more than the tolerance asks for."""
    block = block_of(shape)
    P = projector(block, kinds)
    velocity = random_flow(block, P.sides)
    P.set_surface(None)
    p, dt = zeros(block), 0.01
    solved = P.project(velocity, p, None, dt, 1e-8, 60)
    P.sides.fill_velocity(velocity)
    volume = np.einsum("i,j,k->ijk", *(np.diff(a) for a in block.planes))
    assert solved.converged
    assert solved.iterations <= 20  # eight digits; measured 8 to 19, most with pressure sides
    assert np.abs(net_outflow(block, velocity) / volume).max() * dt <= 1.001e-8


def test_projecting_twice_changes_nothing():
    """A flow that fits stays as it is, but for what is left of the tolerance: a share of a cell's width in a step."""
    block, dt, tolerance = block_of((12, 10, 8)), 0.01, 1e-8
    P = projector(block)
    velocity = random_flow(block, P.sides)
    P.set_surface(None)
    assert P.project(velocity, zeros(block), None, dt, tolerance, 60).converged
    before = [a.copy() for a in velocity]
    again = P.project(velocity, zeros(block), None, dt, 1.01 * tolerance, 60)
    assert again.iterations <= 1
    widest = max(np.diff(planes).max() for planes in block.planes)
    change = max(np.abs(a - b).max() for a, b in zip(before, velocity, strict=True))
    assert change <= 2.0 * tolerance * widest / dt  # measured 0.4 of it


def test_the_projection_never_adds_energy():
    """sum A S h u2 falls: the projection is orthogonal in the norm of the kinetic energy."""
    block = block_of((14, 12, 10))
    P = projector(block)
    F = level_pool(block, 0.63)
    P.sides.fill_fraction(F)
    P.set_surface(F)
    for seed in range(5):
        velocity = random_flow(block, P.sides, seed)
        weights = [1.0 / np.where(b > 0, b, np.inf) for b in P.matrix.b]
        areas = [np.einsum("i,j,k->ijk", *a) for a in P.areas]
        energy = lambda: sum((w * (s * u) ** 2).sum() for w, s, u in zip(weights, areas, velocity, strict=True))  # noqa: B023, E731
        before = energy()
        assert P.project(velocity, zeros(block), F * 0 + np.minimum(F, 1.0), 0.01, 1e-10, 60).converged
        assert energy() <= before * (1 + 1e-12)


@pytest.mark.parametrize("cells", [16, 32, 64])
def test_iterations_do_not_grow_with_the_mesh(cells):
    """Cycles to 1e-6 of a cell from a zero guess, dam with an obstacle: 6 to 9 at every size."""
    block = block_of((cells * 2, cells, cells), (2.0, 1.0, 1.0), graded=False)
    V = np.ones_like(zeros(block))
    A = [np.ones_like(V) for _ in range(3)]
    solid = (slice(G + cells, G + cells + cells // 4), slice(G + cells // 4, G + cells // 2), slice(G, G + cells // 4))
    V[solid] = 0.0
    for d, a in enumerate(A):
        a[(V == 0.0) | (np.roll(V, -1, d) == 0.0)] = 0.0
    P = projector(block, openings=Open(V, *A))
    F = zeros(block)
    F[G : G + cells, :, G : G + cells // 2] = 1.0
    F[G + cells : -G, :, G : G + cells // 3] = 1.0
    F[V == 0.0] = 0.0
    P.sides.fill_fraction(F)
    P.set_surface(F)
    rng = np.random.default_rng(1)
    velocity = [rng.standard_normal(V.shape) * a for a in A]
    P.sides.fill_velocity(velocity)
    dt = 0.1 / cells
    solved = P.project(velocity, zeros(block), F, dt, 1e-6, 40)
    assert solved.converged
    assert solved.iterations <= 10


def test_threads_change_no_bit():
    block = block_of((40, 30, 20), graded=False)
    found = []
    for threads in (1, 2):
        P = projector(block, threads=threads)
        F = level_pool(block, 0.71)
        P.sides.fill_fraction(F)
        P.set_surface(F)
        velocity = random_flow(block, P.sides)
        p = zeros(block)
        P.project(velocity, p, F, 0.01, 1e-6, 40)
        found.append([*velocity, p])
    assert all(np.array_equal(a, b) for a, b in zip(*found, strict=True))


def test_plain_relaxation_finds_the_same_pressure():
    block = block_of((10, 8, 12))
    F = level_pool(block, 0.55)
    found = []
    for plain in (False, True):
        P = projector(block, plain=plain)
        P.sides.fill_fraction(F)
        P.set_surface(F)
        p = zeros(block)
        assert P.project(random_flow(block, P.sides), p, F, 0.01, 1e-11, 60).converged
        found.append(p)
    assert np.abs(found[0] - found[1]).max() < 1e-7 * np.abs(found[0]).max()


def test_regions_that_are_shut_in_are_balanced_apart():
    """A wall cuts the box in two full rooms: both have their own constant, and no flow crosses the wall."""
    block = block_of((24, 8, 10), graded=False)
    V = np.ones_like(zeros(block))
    A = [np.ones_like(V) for _ in range(3)]
    V[10] = 0.0
    A[0][9:11] = 0.0
    A[1][10] = A[2][10] = 0.0
    P = projector(block, openings=Open(V, *A))
    assert list(P.sealed.cells) == [8 * 80, 15 * 80]
    velocity = random_flow(block, P.sides)
    velocity = [a * b for a, b in zip(velocity, A, strict=True)]
    P.set_surface(None)
    assert P.project(velocity, zeros(block), None, 0.01, 1e-8, 40).converged


def test_liquid_that_is_pressed_together_is_an_error():
    """A closed box that is full, and a side that pushes liquid in: no pressure answers that."""
    block = block_of((8, 8, 8))
    one = np.zeros(1)
    plans = [SidePlan(k, WALL, one) for k in range(6)]
    plans[0] = SidePlan(0, 6, one, velocity=np.array([[1.0, 0.0, 0.0]]), fraction=np.ones(1))
    grid = grid_of(block)
    P = Projector(grid, NO_SOLIDS, Sides(plans, grid, block.z, RHO, np.zeros(3)), Team(1), RHO)
    P.set_surface(None)
    velocity = [zeros(block) for _ in range(3)]
    P.sides.fill_velocity(velocity)
    with pytest.raises(PressedTogether, match="pressed together"):
        P.project(velocity, zeros(block), None, 0.01, 1e-6, 40)


def test_columns_hold_what_is_marked():
    rng = np.random.default_rng(3)
    marked = np.zeros((12, 11, 13))
    marked[G:-G, G:-G, G:-G] = rng.random((8, 7, 9)) > 0.9
    columns = columns_where(marked, 0.0)
    held = np.zeros_like(marked)
    for i, j, k0, k1 in columns:
        held[i, j, k0:k1] = 1
        assert marked[i, j, k0] and marked[i, j, k1 - 1]
    assert (held >= marked).all()
    wide = np.zeros_like(marked)
    for i, j, k0, k1 in widen(columns, 1, marked.shape, np.zeros((12, 11, 2), np.int32)):
        wide[i, j, k0:k1] = 1
    for i, j, k in np.argwhere(marked):
        assert wide[max(i - 1, G) : min(i + 2, 10), max(j - 1, G) : min(j + 2, 9), max(k - 1, G) : min(k + 2, 11)].all()
