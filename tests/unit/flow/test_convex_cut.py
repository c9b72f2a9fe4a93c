"""Convex bodies of planes on the mesh, in closed form: as any body is cut, the exact volume, one figure for a face."""

import numpy as np
import pytest
from flow_solids import box, graded_block

from flowgmo.flow.favor.body_cover import CoverMesh, _near_closed, cover_body
from flowgmo.flow.favor.body_sheets import Body
from flowgmo.flow.favor.body_values import cut_body
from flowgmo.flow.favor.convex_cut import cut_convex, open_share
from flowgmo.flow.favor.near_surface import Pose
from flowgmo.flow.fields import G
from flowgmo.geometry.transform import rotation
from flowgmo.kernel import kernel

MIDDLE = (0.0, 0.0, 0.0)


@kernel
def share_of(corners):
    return open_share(corners[0], corners[1], corners[2], corners[3])


SHAPES = {
    "box": (box((0.21, 0.13, 0.17), MIDDLE), 8 * 0.21 * 0.13 * 0.17),
    "plate thinner than a cell": (box((0.24, 0.2, 0.007), MIDDLE), 8 * 0.24 * 0.2 * 0.007),
    "needle": (box((0.01, 0.012, 0.3), MIDDLE), 8 * 0.01 * 0.012 * 0.3),
    "crumb": (box((0.01, 0.012, 0.009), MIDDLE), 8 * 0.01 * 0.012 * 0.009),
}


def covered_by(shape, pose):
    """(cells, by planes, as any) of the cells near a body."""
    mesh = CoverMesh(graded_block(12))
    body = Body(shape).moved(pose)
    cells, _ = _near_closed(mesh, body)
    exact, general = np.empty((len(cells), 7)), np.empty((len(cells), 7))
    cut_convex(cells, *mesh.halves, body.planes, mesh.least, exact)
    no_rows = np.empty((0, len(cells)), np.int32), np.zeros((0, 27), np.int32), np.zeros(0)
    cut_body(cells, *mesh.halves, body.planes, body.rounds, False, body.side, body.roles, mesh.least, *no_rows, general)
    return cells, exact, general


def poses(count):
    rng = np.random.default_rng(3)
    yield Pose(np.eye(3), np.array([0.5, 0.5, 0.5]))
    for n in range(count):
        turn = rng.uniform(-180, 180, 3) * ([0, 0, 1] if n % 2 else [1, 1, 1])
        yield Pose(rotation(turn), 0.5 + rng.uniform(-0.1, 0.1, 3))


@pytest.mark.parametrize("name", SHAPES)
def test_shares_are_those_of_the_general_cut(name):
    shape, _ = SHAPES[name]
    for pose in poses(12):
        _, exact, general = covered_by(shape, pose)
        assert np.abs(exact - general).max() <= 1e-12  # 1.4e-15 measured; APART lets rounding grow a hundredfold
        assert np.array_equal(exact[:, :6] == 0.0, general[:, :6] == 0.0)
        assert np.array_equal(exact[:, :6] == 1.0, general[:, :6] == 1.0)


@pytest.mark.parametrize("name", SHAPES)
def test_the_volume_is_the_body_s_own(name):
    shape, volume = SHAPES[name]
    mesh = CoverMesh(graded_block(12))
    for pose in poses(12):
        assert cover_body(mesh, Body(shape).moved(pose)).volume == pytest.approx(volume, rel=1e-12)


@pytest.mark.parametrize("name", SHAPES)
def test_both_cells_of_a_face_have_one_figure(name):
    shape, _ = SHAPES[name]
    mesh = CoverMesh(graded_block(12))
    for pose in poses(12):
        cover = cover_body(mesh, Body(shape).moved(pose))
        row = {int(n): r for r, n in enumerate(cover.numbers)}
        steps = (mesh.shape[1] * mesh.shape[2], mesh.shape[2], 1)
        pairs = [(r, row[n + s], d) for n, r in row.items() for d, s in enumerate(steps) if n + s in row]
        assert pairs
        for here, beyond, d in pairs:
            assert cover.shares[here, 2 * d + 1] == cover.shares[beyond, 2 * d]


def test_cells_between_runs_and_near_ones_are_free():
    """Near cells and runs hold the whole volume, and what is near is cut: none of it is inside or outside by more."""
    shape, volume = SHAPES["box"]
    mesh = CoverMesh(graded_block(12))
    for pose in poses(6):
        cover = cover_body(mesh, Body(shape).moved(pose))
        assert cover.volume == pytest.approx(volume, rel=1e-12)
        inside = (cover.shares[:, 6] == 1.0).mean()
        assert inside <= 0.02  # of those listed as cut: such as only touch a corner


def test_a_face_in_a_plane_of_the_mesh_is_covered_from_both_sides():
    block = graded_block(12)
    x = block.planes[0]
    half = 0.5 * (x[7] - x[4])
    shape = box((half, 0.13, 0.17), MIDDLE)
    middle = np.array([0.5 * (x[4] + x[7]), 0.5, 0.5])
    mesh = CoverMesh(block)
    cover = cover_body(mesh, Body(shape).moved(Pose(np.eye(3), middle)))
    cells = np.column_stack(np.unravel_index(cover.numbers, mesh.shape)) - G
    within, before = cells[:, 0] == 4, cells[:, 0] == 3
    assert within.any() and before.any()
    assert cover.shares[within, 0].max() == 1.0 and cover.shares[before, 1].max() == 1.0
    assert cover.shares[before, 6].max() == 0.0


@pytest.mark.parametrize(
    ("corners", "share"),
    [
        ((1.0, 1.0, 1.0, 1.0), 1.0),
        ((-1.0, -1.0, -1.0, -1.0), 0.0),
        ((1.0, -1.0, -3.0, -1.0), 0.125),
        ((-1.0, 1.0, 3.0, 1.0), 0.875),
        ((1.0, 1.0, -1.0, -1.0), 0.5),
        ((3.0, 1.0, -1.0, 1.0), 0.875),
    ],
)
def test_open_share_of_a_square(corners, share):
    for turn in range(4):
        assert share_of(np.roll(corners, turn)) == pytest.approx(share, abs=1e-16)
