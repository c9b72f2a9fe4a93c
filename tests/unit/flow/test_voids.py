"""Voids beside closed faces (lids.py, pockets.py): liquid at rest, filling, leaving, and what the bound promises."""

import numpy as np
import pytest
from flowgmo_pressure import NO_SOLIDS, RHO, block_of, g, net_outflow, projector

from flowgmo.flow.boundary import Sides
from flowgmo.flow.fields import G, Open, grid_of, zeros
from flowgmo.flow.pressure.lids import SHARE
from flowgmo.flow.pressure.pockets import pocket_flows
from flowgmo.flow.pressure.projection import Projector
from flowgmo.flow.pressure.sealed import PressedTogether
from flowgmo.flow.team import Team
from flowgmo.flow_plan import SidePlan
from flowgmo.mesh import VELOCITY, WALL

INSIDE = (slice(G, -G),) * 3
STEP = SHARE  # of much room
DT = 1e-3


def solid_free(block, closed=()):
    """Open fractions of a block in which cells (indices with ghosts) are closed."""
    V = np.ones_like(zeros(block))
    for cells in closed:
        V[cells] = 0.0
    A = [np.where((V == 0.0) | (np.roll(V, -1, d) == 0.0), 0.0, 1.0) for d in range(3)]
    return Open(V, *A)


def filled_up(block, axis, upper, F_last):
    """F of a box that is full but for the layer at one side, which holds F_last."""
    F = zeros(block)
    F[INSIDE] = 1.0
    layer = [slice(G, -G)] * 3
    layer[axis] = slice(-G - 1, -G) if upper else slice(G, G + 1)
    F[tuple(layer)] = F_last
    return F


def pushed(block, P, F, acceleration, dt=DT, tolerance=1e-13):
    """(velocity, p) of liquid at rest that an acceleration (3,) acts on for dt."""
    velocity = [
        None if n == 1 else np.full(zeros(block).shape, a * dt) for n, a in zip(block.shape, acceleration, strict=True)
    ]
    if P.openings.V is not None:
        velocity = [a * A for a, A in zip(velocity, P.openings[1:], strict=True)]
    P.sides.fill_velocity(velocity)
    P.sides.fill_fraction(F)
    P.set_surface(F)
    p = zeros(block)
    assert P.project(velocity, p, F, dt, tolerance, 60).converged
    return velocity, p


@pytest.mark.parametrize("F_last", [0.502, 0.6, 0.9, 0.999, 1.0 - 2e-6])
@pytest.mark.parametrize(("axis", "upper"), [(0, False), (0, True), (1, True), (2, False), (2, True)])
def test_liquid_rests_under_a_lid_on_every_side(axis, upper, F_last):
    """p = rho g (depth below the surface) in all cells, whatever is left under the lid.

    Measured: 1e-10 of the largest pressure. Taken for full, the layer has a pressure up to a constant.
    """
    block = block_of((7, 6, 9))
    P = projector(block, gravity=(0.0, 0.0, 0.0))
    F = filled_up(block, axis, upper, F_last)
    planes = block.planes[axis]
    side, width = (planes[-1], planes[-1] - planes[-2]) if upper else (planes[0], planes[1] - planes[0])
    surface = side - (1.0 if upper else -1.0) * (1.0 - F_last) * width
    a = [0.0, 0.0, 0.0]
    a[axis] = -g if upper else g
    velocity, p = pushed(block, P, F, a)
    assert len(P.voids.lids.cells) == F[INSIDE].size / block.shape[axis]
    depth = np.abs(surface - 0.5 * (planes[1:] + planes[:-1]))
    exact = RHO * g * depth * np.sign((surface - 0.5 * (planes[1:] + planes[:-1])) * (1.0 if upper else -1.0) + 1e-12)
    found = np.moveaxis(p[INSIDE], axis, -1)
    assert np.abs(found - exact).max() <= 1e-9 * exact.max()
    assert max(np.abs(u[INSIDE]).max() for u in velocity) <= 1e-12 * width / DT * 3.0  # the solution's tolerance


def test_a_cell_that_becomes_liquid_changes_nothing_at_once():
    """F = 1/2 -+ 1e-6 in the top row: the pressures below differ by as little. Before lids they differed by all."""
    block = block_of((5, 4, 8))
    found = []
    for F_last in (0.5 - 1e-6, 0.5 + 1e-6):
        P = projector(block)
        velocity, p = pushed(block, P, filled_up(block, 2, True, F_last), (0.0, 0.0, g))  # upwards: it fills
        found.append((p[4, 4, G:-G][:-1], velocity[2][4, 4, G:-G][:-1]))
    for a, b in zip(*found, strict=True):
        assert np.abs(a - b).max() <= 1e-3 * max(np.abs(a).max(), g * DT)  # measured 2e-4: NEAREST


def test_a_lid_inside_is_a_lid_of_the_domain():
    """A solid that fills the top rows, and a domain that ends below it."""
    tall, low = block_of((6, 5, 9), graded=False), block_of((6, 5, 7), (1.0, 1.0, 7.0 / 9.0), graded=False)
    roof = (slice(None), slice(None), slice(G + 7, None))
    F = filled_up(low, 2, True, 0.0)
    F[G:-G, G:-G, G + 6] = np.random.default_rng(1).uniform(0.55, 0.95)
    P, Q = projector(tall, openings=solid_free(tall, [roof])), projector(low)
    above = zeros(tall)
    above[:, :, : G + 7] = F[:, :, : G + 7]
    a, p = pushed(tall, P, above, (0.3, 0.0, -g))
    b, q = pushed(low, Q, F, (0.3, 0.0, -g))
    assert len(P.voids.lids.cells) == len(Q.voids.lids.cells) == 30
    real = (slice(G, -G), slice(G, -G), slice(G, G + 6))
    assert np.abs(p[real] - q[real]).max() <= 1e-9 * np.abs(q).max()
    assert np.abs(a[2][real] - b[2][real]).max() <= 1e-9 * g * DT


def thrown(block, P, F, seed, speed):
    """A random flow towards the lid; (velocity, Solved)."""
    rng = np.random.default_rng(seed)
    velocity = [speed * rng.standard_normal(zeros(block).shape) for _ in range(3)]
    velocity[2] += speed
    P.sides.fill_velocity(velocity)
    P.sides.fill_fraction(F)
    P.set_surface(F)
    return velocity


@pytest.mark.parametrize("seed", range(4))
def test_either_the_bound_or_the_pressure(seed):
    """Complementarity: what flows into a void is at most its bound; where it is less the void has no pressure, and
    where it is reached none below zero. 1e-8 of a cell is the tolerance of the solution."""
    block, dt, tolerance = block_of((12, 10, 8)), 0.01, 1e-8
    P = projector(block)
    F = filled_up(block, 2, True, 1.0)
    F[G:-G, G:-G, -G - 1] = np.random.default_rng(seed).uniform(0.5, 1.0, (12, 10))
    velocity = thrown(block, P, F, seed, 1.0)
    before = [a.copy() for a in velocity]
    p = zeros(block)
    assert P.project(velocity, p, F, dt, tolerance, 80).converged
    voids = P.voids
    q = p * (dt / RHO)
    lids, n = voids.lids, len(voids.lids.cells)
    slack = 3.0 * tolerance / dt * lids.volume
    inflow = -net_outflow(block, velocity)[tuple((lids.cells - G).T)]
    assert 0 < voids.shut_lids.sum() < n
    assert (inflow <= voids.most + slack)[~voids.shut_lids].all()
    assert np.abs(inflow - voids.taken[:n])[voids.shut_lids].max() <= slack.max()
    free = voids.predicted + lids.conductance * q[lids.at]  # what an open lid lets through
    shut = voids.shut_lids
    assert np.abs(inflow - free)[~shut].max() <= slack.max()
    assert (free >= voids.taken[:n] - slack)[shut].all()  # the void's pressure is what is missing: not negative
    assert (np.abs(net_outflow(block, velocity)) <= 3.0 * tolerance / dt)[F[INSIDE] == 1.0].all()
    weights = [np.where(b > 0, np.einsum("i,j,k->ijk", *s) ** 2 / np.where(b > 0, b, 1.0), 0.0) for b, s in
               zip(P.matrix.b, P.areas, strict=True)]  # fmt: skip

    def energy(u):
        return sum((w * (a * a)).sum() for w, a in zip(weights, u, strict=True))

    def in_lids(flow):
        return (flow**2 / lids.conductance).sum()

    assert energy(velocity) + in_lids(inflow) <= (energy(before) + in_lids(voids.predicted)) * (1 + 1e-9)


def test_what_leaves_the_lid_falls_freely():
    """Liquid that hangs by a void under the lid, with void below, gains g dt everywhere, and has no pressure."""
    block = block_of((8, 7, 9))
    P = projector(block)
    F = filled_up(block, 2, True, 0.7)
    F[:, :, : G + 3] = 0.0
    velocity, p = pushed(block, P, F, (0.0, 0.0, -g))
    held = P.matrix.b[2][INSIDE] > 0.0
    assert len(P.voids.lids.cells) == 56
    assert np.abs(velocity[2][INSIDE][held] + g * DT).max() <= 1e-9 * g * DT
    assert np.abs(p).max() <= 1e-9 * RHO * g


@pytest.mark.parametrize("seed", range(20))
def test_what_a_body_closes_takes_room_first(seed):
    """A pocket amid full cells: with R, and what it grows by (< 0: it is being closed), it holds what it then can hold
    at most; all of that where a body takes more than was void, so that the rest has to leave."""
    rng = np.random.default_rng(seed)
    block, dt = block_of((5, 5, 5)), 10.0 ** rng.uniform(-4, -1)
    P = projector(block)
    shape = zeros(block).shape
    V0, F_own = rng.uniform(0.05, 1.0, 2)
    cell = np.array([[G + 2] * 3], np.int32)
    opened, F = Open(np.ones(shape), *(np.ones(shape) for _ in range(3))), np.ones(shape)
    at = tuple(cell[0])
    opened.V[at], F[at] = V0, F_own
    volume = float(np.prod([d[k] for d, k in zip(P.grid[:3], at, strict=True)]))
    velocity = [rng.normal(size=shape) for _ in range(3)]
    b = tuple(np.ones(shape) for _ in range(3))
    for change in (rng.uniform(-V0, 0.0), -V0 * (1.0 - F_own) * 1.1, rng.uniform(0.0, 1.0 - V0)):
        change = max(change, -V0)
        grown = np.array([change * volume / dt])
        of = velocity, b, np.zeros(shape), dt, np.array([V0]), grown
        most = pocket_flows(cell, F, opened, P.planes.steps, P.grid, *of)[0, 2] * dt / volume
        held, room = F_own * V0 + most + change, V0 + change
        assert held <= room + 1e-12
        if V0 * (1.0 - F_own) + change <= 0.0:
            assert held == pytest.approx(room, abs=1e-12)


def test_the_bound_keeps_a_cell_from_overflowing():
    """A column rises faster than what is left lets it: a share of the room is filled, and the column goes no faster."""
    block, dt = block_of((1, 1, 10), graded=False), 0.05
    P = projector(block)
    F = filled_up(block, 2, True, 0.8)
    F[:, :, G : G + 3] = 0.0  # void below: it may move
    velocity = [None, None, np.full(zeros(block).shape, 1.0)]
    P.sides.fill_velocity(velocity)
    P.sides.fill_fraction(F)
    P.set_surface(F)
    assert P.project(velocity, zeros(block), F, dt, 1e-12, 40).converged
    assert np.abs(velocity[2][G, G, G + 3 : -G - 1] - STEP * 0.2 * 0.1 / dt).max() <= 1e-9


def cut_wall(block, share):
    """Openings of a wall x = const that leaves a share of the first cells open."""
    opened = solid_free(block)
    opened.V[G] = share
    for A in opened[2:]:
        A[G] = share
    opened.Ax[G - 1] = 0.0
    return opened


@pytest.mark.parametrize("share", [0.05, 0.3, 0.7])
def test_a_front_fills_a_cut_cell_before_it_stops(share):
    """Liquid runs against a wall inside a cell: a share of what is open there flows in, whatever the speed; the cell
    has a pressure then. Unbound, all comes in and is stopped in the next step: 50 kPa on the box of dam_break."""
    block, dt = block_of((10, 1, 6), graded=False), 0.04
    P = projector(block, openings=cut_wall(block, share), gravity=(0.0, 0.0, 0.0))
    F = zeros(block)
    F[G + 1 : G + 6, G, G:-G] = 1.0
    velocity = [np.full(zeros(block).shape, -1.0), None, zeros(block)]
    P.sides.fill_velocity(velocity)
    P.sides.fill_fraction(F)
    P.set_surface(F)
    p = zeros(block)
    assert P.project(velocity, p, F, dt, 1e-12, 60).converged
    inflow = -velocity[0][G, G, G:-G] * dt / 0.1  # in shares of a cell; all of it liquid
    bound = STEP * share
    if bound < 0.4:  # what would come in
        assert P.voids.shut_pockets.all() and len(P.voids.pockets) == 6
        assert np.abs(inflow - bound).max() <= 1e-9
        assert (p[G, G, G:-G] > 0.0).all()
    else:
        assert np.abs(inflow - 0.4).max() <= 1e-9


def inflow_side(block, speed):
    """A closed box into which a side pushes liquid."""
    one = np.zeros(1)
    plans = [SidePlan(k, WALL, one) for k in range(6)]
    plans[0] = SidePlan(0, VELOCITY, one, velocity=np.array([[speed, 0.0, 0.0]]), fraction=np.ones(1))
    grid = grid_of(block)
    return Projector(grid, NO_SOLIDS, Sides(plans, grid, block.z, RHO, np.zeros(3)), Team(1), RHO)


def fill(P, block, F, dt):
    velocity = [zeros(block) for _ in range(3)]
    P.sides.fill_velocity(velocity)
    P.sides.fill_fraction(F)
    P.set_surface(F)
    assert P.project(velocity, zeros(block), F, dt, 1e-9, 60).converged
    return -net_outflow(block, velocity)


@pytest.mark.parametrize("where", [(5, 5, 7), (3, 4, 5)])
def test_the_last_void_takes_what_flows_in(where):
    """One cell of a closed box is left, under the lid (a surface that pressure acts on) or amid full ones."""
    block, dt = block_of((8, 8, 8), graded=False), 0.01
    F = zeros(block)
    F[INSIDE] = 1.0
    F[tuple(k + G for k in where)] = 0.6
    room, speed = 0.4 / 512, 0.01
    P = inflow_side(block, speed)
    gained = fill(P, block, F, dt)
    expected = np.zeros((8, 8, 8))
    expected[where] = speed
    assert speed * dt < STEP * room
    assert np.abs(gained - expected).max() <= 3e-9 / dt


def test_more_than_the_void_holds_is_an_error():
    block = block_of((8, 8, 8), graded=False)
    F = zeros(block)
    F[INSIDE] = 1.0
    F[5 + G, 5 + G, 7 + G] = 0.6
    with pytest.raises(PressedTogether, match="closed space of 512 cells is pressed together"):
        fill(inflow_side(block, 0.2), block, F, 0.01)
    F[INSIDE] = 1.0
    with pytest.raises(PressedTogether, match="pulled apart"):
        fill(inflow_side(block, -0.2), block, F, 0.01)


@pytest.mark.parametrize("seed", range(3))
def test_a_changed_void_mends_the_matrix_of_the_cycle(seed):
    """The finest level is what a new hierarchy would have, coarser ones hold at least as much; one more solution takes
    no more iterations than the first (a hierarchy without what opened would not converge)."""
    block, dt = block_of((24, 20, 12)), 0.01
    P = projector(block)
    F = filled_up(block, 2, True, 1.0)
    F[G:-G, G:-G, -G - 1] = np.random.default_rng(seed).uniform(0.5, 1.0, (24, 20))
    velocity, p = thrown(block, P, F, seed, 1.0), zeros(block)
    solved = P.project(velocity, p, F, dt, 1e-8, 80)
    assert solved.converged and P.solves > 1
    assert solved.iterations <= 12 * P.solves  # 6 to 10 each
    mended = [(level.diagonal.copy(), level.inverse.copy()) for level in P.multigrid.levels]
    P._set_matrix(dt)
    for depth, ((diagonal, inverse), level) in enumerate(zip(mended, P.multigrid.levels, strict=True)):
        if depth == 0:
            assert np.array_equal(diagonal, level.diagonal) and np.array_equal(inverse, level.inverse)
        assert (diagonal >= level.diagonal * (1.0 - 1e-6)).all()  # round-off of single precision
