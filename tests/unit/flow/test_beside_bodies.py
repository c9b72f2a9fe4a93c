"""What the walls of moving bodies give to the kinetic energy and momentum of the liquid beside them."""

from types import SimpleNamespace

import numpy as np
import pytest
from flowgmo_flows import RHO, block_of, flow_of, openings_of, with_ghosts

from flowgmo.flow.columns import all_columns
from flowgmo.flow.fields import G, grid_of
from flowgmo.flow.observe.beside_bodies import beside_bodies, beside_body
from flowgmo.flow.observe.measures import total
from flowgmo.flow.team import Team

SPEED = 2.0


def plug(low, high, axis=0, F=None, moving=SPEED):
    """A box that spans the tank between two planes across `axis`, and liquid that moves with it on both sides."""
    n = list(np.roll((9, 5, 6), axis))
    block = block_of(n)
    box = np.array([[-1.0] * 3, [2.0] * 3])
    box[:, axis] = low, high
    opened, walls = openings_of(block, [box])
    shape = opened.V.shape
    u = [np.zeros(shape) for _ in range(3)]
    u[axis][opened[1 + axis] > 0.0] = moving
    flow = flow_of(block, F, None, *u)
    cells, faces = walls[0]
    cover = SimpleNamespace(
        numbers=np.ravel_multi_index(tuple(cells.T), shape), shares=np.column_stack([faces, 0 * faces[:, 0]])
    )
    centres = [0.5 * (x[1:] + x[:-1]) for x in map(with_ghosts, block.planes)]
    U = np.zeros(6)
    U[axis] = SPEED
    return block, flow, opened, cover, centres, U


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("low", [0.31, 0.34, 0.37, 0.43])
def test_liquid_that_moves_with_a_plug_has_its_energy_wherever_the_plug_is(low, axis):
    """Through open ends. Measured 1e-15; with closed faces at rest half of the energy of the cut cells is missing."""
    block, flow, opened, cover, centres, U = plug(low, low + 0.26, axis)
    grid, columns = grid_of(block), all_columns(opened.V.shape)
    gained, momentum = beside_body(cover, flow, opened, grid, centres, np.zeros(3), U)
    kinetic = total(Team(1), columns, grid, opened, flow, RHO, np.zeros(3), 1e-9).kinetic + RHO * gained
    assert kinetic == pytest.approx(0.5 * RHO * SPEED**2 * (1.0 - 0.26), rel=1e-13)
    assert momentum[axis] == pytest.approx(gained / (0.5 * SPEED), rel=1e-13) and np.count_nonzero(momentum) == 1


@pytest.mark.parametrize("moving", [0.0, -1.0, 0.5 * SPEED])
def test_liquid_that_does_not_go_with_the_wall_counts_by_its_own_speed(moving):
    """At rest, or against it: nothing; half as fast: half."""
    whole = beside_body(*_args(plug(0.34, 0.6)))
    part = beside_body(*_args(plug(0.34, 0.6, moving=moving)))
    share = max(moving / SPEED, 0.0)
    assert part[0] == pytest.approx(share * whole[0], rel=1e-13, abs=0.0)
    assert part[1] == pytest.approx(share * whole[1], rel=1e-13, abs=0.0)


def test_dry_cells_and_turns():
    """Void beside a wall has nothing; a turn about B moves the wall by w x r."""
    block, flow, opened, cover, centres, U = plug(0.34, 0.6, F=np.zeros([9 + 2 * G, 5 + 2 * G, 6 + 2 * G]))
    assert beside_body(cover, flow, opened, grid_of(block), centres, np.zeros(3), U)[0] == 0.0
    args = list(_args(plug(0.34, 0.6)))
    args[-2], args[-1] = np.array([0.0, -1e6, 0.0]), np.array([0.0, 0, 0, 0, 0, -SPEED / 1e6])
    straight = beside_body(*_args(plug(0.34, 0.6)))
    assert beside_body(*args)[0] == pytest.approx(straight[0], rel=1e-5)
    cover, flow, opened, grid, centres, place, U = args
    both = beside_bodies([cover] * 2, flow, opened, grid, centres, [place] * 2, [U] * 2, [None] * 2)
    assert both[0] == pytest.approx(2.0 * beside_body(*args)[0]) and both[1].shape == (3,)


def test_the_spin_of_a_ball_carries_nothing_along():
    args = _args(plug(0.34, 0.6))
    ball = np.array([0.47, 0.5, 0.5])
    assert beside_body(*args[:-2], ball, np.array([0.0, 0, 0, 5.0, 7.0, -3.0]), np.zeros(3))[0] == 0.0


def _args(made):
    block, flow, opened, cover, centres, U = made
    return cover, flow, opened, grid_of(block), centres, np.zeros(3), U
