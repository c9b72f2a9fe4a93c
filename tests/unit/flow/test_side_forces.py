"""What sides and solids that stand still give to the liquid's momentum, and what that is."""

import numpy as np
import pytest
from flowgmo_flows import DOWN, GRAVITY, RHO, at_faces, block_of, flow_of, openings_of, still, with_ghosts

from flowgmo.flow.columns import all_columns
from flowgmo.flow.fields import G, Open, grid_of
from flowgmo.flow.observe.loads import find_wall
from flowgmo.flow.observe.measures import total
from flowgmo.flow.observe.side_forces import Pressed, by_shear, by_sides, by_solids
from flowgmo.flow.team import Team
from flowgmo.mesh import PERIODIC, PRESSURE, SYMMETRY, VELOCITY, WALL

NONE = Open(None, None, None, None)
CLOSED = [SYMMETRY, WALL, WALL, SYMMETRY, WALL, WALL]
BOXES = [[[0.23, 0.31, 0.17], [0.61, 0.77, 0.58]], [[0.7, -1.0, -1.0], [0.87, 0.4, 0.33]]]


def centres_of(block):
    return [0.5 * (x[1:] + x[:-1]) for x in map(with_ghosts, block.planes)]


@pytest.mark.parametrize("boxes", [[], BOXES[:1], BOXES[1:]])
def test_sides_and_solids_bear_the_weight_of_still_water(boxes):
    """One under water, one that stands on the floor and at a side; graded mesh: measured 1e-15 of the weight."""
    block = block_of((10, 9, 12))
    opened, walls = openings_of(block, [np.array(b) for b in boxes]) if boxes else (NONE, [])
    flow, grid = still(block, 0.95), grid_of(block)
    pressed = Pressed(flow.p, flow.F >= 0.5, RHO, DOWN)
    closed, streams = by_sides(pressed, flow.velocity, flow.F, opened, grid, CLOSED)
    walls = [find_wall(*wall, grid, opened, centres_of(block)) for wall in walls]
    V = np.ones_like(flow.p) if opened.V is None else opened.V
    volume = float((np.einsum("i,j,k->ijk", *grid[:3]) * V * flow.F)[G:-G, G:-G, G:-G].sum())
    found = closed + by_solids(pressed, walls)
    assert found[2] == pytest.approx(RHO * GRAVITY * volume, rel=1e-13) and not streams.any()
    assert np.abs(found[:2]).max() < 1e-12 * found[2]


def test_a_film_without_pressure_lies_on_the_floor():
    """On the side that gravity points at, whichever it is; what lies elsewhere falls."""
    block = block_of((5, 4, 6))
    for axis, end in ((0, 0), (0, 1), (2, 0), (2, 1)):
        F = np.zeros([n + 2 * G for n in block.shape])
        layer = [slice(None)] * 3
        layer[axis] = G if end == 0 else block.shape[axis] + G - 1
        F[tuple(layer)] = 0.05
        g = (GRAVITY if end else -GRAVITY) * np.eye(3)[axis]
        grid, flow = grid_of(block), flow_of(block, F)
        pressed = Pressed(flow.p, np.zeros(F.shape, bool), RHO, g)
        closed, _ = by_sides(pressed, flow.velocity, F, NONE, grid, CLOSED)
        assert closed[axis] == pytest.approx(-RHO * g[axis] * 0.05 * grid[axis][layer[axis]], rel=1e-13)
        assert np.abs(np.delete(closed, axis)).max() == 0.0


def test_a_stream_brings_in_what_it_takes_out():
    """Uniform flow through open sides, aslant, with a pressure that falls: its difference is what is given."""
    block = block_of((7, 6, 5))
    kinds = [VELOCITY, PRESSURE, VELOCITY, PRESSURE, WALL, WALL]
    u = [np.full([n + 2 * G for n in block.shape], x) for x in (2.0, 0.5, 0.0)]
    x = centres_of(block)[0][:, None, None]
    flow = flow_of(block, None, np.broadcast_to(3.0 - x, u[0].shape).copy(), *u)
    pressed = Pressed(flow.p, np.ones(u[0].shape), RHO, np.zeros(3))
    closed, streams = by_sides(pressed, flow.velocity, None, NONE, grid_of(block), kinds, u)
    ends = centres_of(block)[0][[G, -G - 1]]
    assert streams == pytest.approx([ends[1] - ends[0], 0.0, 0.0], rel=1e-12, abs=1e-9)
    into, _ = by_sides(pressed, flow.velocity, None, NONE, grid_of(block), [VELOCITY, *CLOSED[1:]], u)
    _, one = by_sides(pressed, flow.velocity, None, NONE, grid_of(block), [VELOCITY, *CLOSED[1:]], u)
    assert one == pytest.approx([3.0 - ends[0] + RHO * 4.0, RHO * 1.0, 0.0], rel=1e-12)
    assert into[0] == pytest.approx(-(3.0 - ends[1]), rel=1e-12)
    periodic = by_sides(pressed, flow.velocity, None, NONE, grid_of(block), [PERIODIC] * 4 + [WALL] * 2, u)
    assert not periodic[0].any() and not periodic[1].any()


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_liquid_comes_from_where_it_flows_from(sign):
    """Momentum that enters is counted with F outside, and what leaves with F inside."""
    block = block_of((6, 5, 4))
    shape = [n + 2 * G for n in block.shape]
    F = np.full(shape, 0.8)
    F[:G] = 0.25
    u = [np.full(shape, sign * 2.0), np.zeros(shape), np.zeros(shape)]
    flow = flow_of(block, F, None, *u)
    pressed = Pressed(flow.p, np.ones(shape), RHO, np.zeros(3))
    kinds = [PRESSURE, *CLOSED[1:]]
    streams = by_sides(pressed, flow.velocity, F, NONE, grid_of(block), kinds, u)[1]
    assert streams[0] == pytest.approx(RHO * 4.0 * (0.25 if sign > 0 else 0.8))


def test_friction_on_still_walls_is_against_the_flow():
    """mu s (u - speed) of the volumes of faces, dry ones left out."""
    block = block_of((5, 4, 6))
    grid, shape = grid_of(block), [n + 2 * G for n in block.shape]
    F = np.ones(shape)
    F[4:] = 0.0
    u = [np.full(shape, 3.0), np.full(shape, -1.0), np.zeros(shape)]
    rows = np.array([[2, 3, 4, 5], [3, 3, 2, 3], [5, 3, 2, 3]], dtype=np.int32)
    s, speed = np.array([2.0, 4.0, 8.0]), np.array([1.0, 0.0, 0.0])
    found = by_shear(Team(1), u, F, grid, 0.1, [None, (rows, s), None], [(rows, s, speed), None, None])
    i, j, k = rows[:2, :3].T
    x = 0.5 * (grid.dx[i] + grid.dx[i + 1]) * grid.dy[j] * grid.dz[k]
    y = grid.dx[i] * 0.5 * (grid.dy[j] + grid.dy[j + 1]) * grid.dz[k]
    assert found == pytest.approx([-0.1 * (2.0 * 2.0 * x[0] + 4.0 * 3.0 * x[1]), 0.1 * (s[:2] @ y), 0.0])


def test_momentum_of_liquid():
    """Linear velocities on a graded mesh beside a box: that of the centres, exactly; the box's faces are at rest."""
    block = block_of((9, 8, 7))
    grid, columns = grid_of(block), all_columns(tuple(n + 2 * G for n in block.shape))
    u = at_faces(block, 0, lambda x, y, z: 1.0 + x + 2.0 * y)
    w = at_faces(block, 2, lambda x, y, z: z - 3.0 * x)
    flow = flow_of(block, u=u, w=w)
    found = np.empty(3)
    total(Team(2), columns, grid, NONE, flow, RHO, np.zeros(3), 0.0, found)
    middle = [(grid[d][G:-G] @ centres_of(block)[d][G:-G]) for d in range(3)]
    wanted = [1.0 + middle[0] + 2.0 * middle[1], 0.0, middle[2] - 3.0 * middle[0]]
    assert found == pytest.approx(RHO * np.array(wanted), rel=1e-12)
    opened = openings_of(block, [np.array(BOXES[0])])[0]
    still_ = flow_of(block, u=u * (opened.Ax > 0.0), w=w * (opened.Az > 0.0))
    both = np.empty((2, 3))
    for f, out in zip((flow, still_), both, strict=True):
        total(Team(1), columns, grid, opened, f, RHO, np.zeros(3), 0.0, out)
    assert np.array_equal(*both)
