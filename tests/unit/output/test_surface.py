"""The liquid's surface as triangles."""

import numpy as np
import pytest
from flowgmo_flows import DOWN, below, block_of, openings_of, with_ghosts

from flowgmo.output.cells import cells_of, real
from flowgmo.output.surface import liquid_surface


def areas(points, faces):
    a, b, c = (points[faces[:, k]] for k in range(3))
    return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)


@pytest.mark.parametrize("height", [0.003, 0.07, 0.333, 0.61, 0.93, 0.999])
def test_a_level_surface_lies_exactly_at_its_height(height):
    """Graded mesh; single precision. From wall to wall, and nothing along the walls."""
    block = block_of((7, 5, 9), hi=(2.0, 1.0, 1.0))
    points, faces = liquid_surface(real(below(block, height)), None, block.planes, DOWN)
    assert np.allclose(points[:, 2], height, atol=1e-6)
    assert areas(points, faces).sum() == pytest.approx(2.0, rel=1e-6)


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("sign", [-1, 1])
def test_liquid_lies_where_gravity_points(axis, sign):
    """A film of a tenth of a cell on the lowest side, whichever that is."""
    block = block_of((6, 6, 6), ratio=1.0)
    F = np.zeros((6, 6, 6))
    layer = (slice(None),) * axis + (0 if sign < 0 else -1,)
    F[layer] = 0.1
    points, faces = liquid_surface(F, None, block.planes, sign * np.eye(3)[axis])
    assert np.allclose(points[:, axis], 0.1 / 6 if sign < 0 else 1 - 0.1 / 6, atol=1e-6) and len(faces) == 72


def test_a_film_on_a_rock_is_drawn():
    block = block_of((8, 8, 8), ratio=1.0)
    V = real(openings_of(block, [np.array([[-1, -1, -1], [2, 2, 0.5]])])[0].V)
    F = np.zeros((8, 8, 8))
    F[2:6, 2:6, 4] = 0.3
    points, faces = liquid_surface(F, V == 0, block.planes, DOWN)
    inner = np.abs(points[:, :2] - 0.5).max(axis=1) < 0.13
    assert np.allclose(points[inner, 2], 0.5 + 0.3 / 8, atol=1e-6) and inner.sum() > 3


def test_no_surface_in_full_and_in_empty_tanks():
    block = block_of((4, 4, 4))
    for F in (np.zeros((4, 4, 4)), np.ones((4, 4, 4))):
        points, faces = liquid_surface(F, None, block.planes, DOWN)
        assert len(points) == len(faces) == 0


def test_a_solid_leaves_a_hole_of_its_size():
    """A pillar through the surface, off the mesh: the hole is its closed cells, and its cut ones are covered."""
    block = block_of((16, 16, 10), ratio=1.0)
    pillar = [np.array([[0.26, 0.3, -1], [0.7, 0.7, 2]])]
    V = real(openings_of(block, pillar)[0].V)
    F = np.where(V > 0, real(below(block, 0.43)), 0.0)
    points, faces = liquid_surface(F, V == 0, block.planes, DOWN)
    assert np.allclose(points[:, 2], 0.43, atol=1e-6), "F goes on into the pillar as it is beside it"
    closed = ((V == 0).any(axis=2)).sum() / 256
    assert areas(points, faces).sum() == pytest.approx(1.0 - closed, rel=1e-6)


def test_a_sunken_box_makes_no_surface():
    block = block_of((12, 12, 12), ratio=1.0)
    V = real(openings_of(block, [np.array([[0.2, 0.2, -1], [0.8, 0.8, 0.6]])])[0].V)
    points, faces = liquid_surface(np.where(V > 0, real(below(block, 0.8)), 0.0), V == 0, block.planes, DOWN)
    assert len(faces) and np.allclose(points[:, 2], 0.8, atol=1e-6)


def test_a_ball_of_liquid_has_its_area():
    """12 cells across, F by 8^3 points a cell. Measured: area 2.9 % too small, radius 1.1 %: means round it off."""
    block = block_of((20, 20, 20), ratio=1.0)
    fine = (np.arange(160) + 0.5) / 160 - 0.5
    inside = (fine[:, None, None] ** 2 + fine[None, :, None] ** 2 + fine**2 < 0.09).astype(float)
    F = inside.reshape(20, 8, 20, 8, 20, 8).mean(axis=(1, 3, 5))
    points, faces = liquid_surface(F, None, block.planes, DOWN)
    assert areas(points, faces).sum() == pytest.approx(4 * np.pi * 0.09, rel=0.04)
    assert np.linalg.norm(points - 0.5, axis=1).mean() == pytest.approx(0.3, rel=0.02)
    assert len(points) - 3 * len(faces) // 2 + len(faces) == 2, "closed: Euler's number of a sphere"


def test_one_cell_deep():
    block = block_of((9, 1, 7))
    points, faces = liquid_surface(real(below(block, 0.4)), None, block.planes, DOWN)
    assert areas(points, faces).sum() == pytest.approx(1.0, rel=1e-6)


def test_cells_at_their_centres(scenes, wet):
    """Velocity between the faces, graded mesh; void and solids show nothing of what the arrays hold there."""
    model = wet.tank(scenes, n=(12, 6, 8))
    V = wet.solids(model)[0].V
    flow = wet.flow_at(model, 0.4)
    flow.p[flow.F == 0.0] = 7.0
    cells = cells_of(flow, V, 100.0)
    F, open_ = real(flow.F), real(V) > 0
    assert cells.p.dtype == cells.velocity.dtype == np.float32 and cells.velocity.shape == (12, 6, 8, 3)
    assert (cells.velocity[(F == 0) | ~open_] == 0).all() and (cells.p[(F == 0) | ~open_] == 100.0).all()
    u = 0.5 * (flow.u[1:-3, 2:-2, 2:-2] + flow.u[2:-2, 2:-2, 2:-2])
    wetted = (F > 0.1) & open_
    assert np.allclose(cells.velocity[..., 0][wetted], u[wetted], atol=1e-7)
    assert np.allclose(cells.p[wetted], 100.0 + real(flow.p)[wetted], rtol=1e-6)
    assert with_ghosts(model.mesh.blocks[0].x)[2] == 0.0
