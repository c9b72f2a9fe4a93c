"""Open fractions: exact for planes, orders for curved solids, shares that close, poses, scales, mirror images."""

import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

HELPERS = str(Path(__file__).parents[2] / "helpers")
if HELPERS not in sys.path:
    sys.path.insert(0, HELPERS)

from flow_solids import (  # noqa: E402
    INNER,
    HalfSpace,
    ball,
    box,
    cylinder,
    exact_volume,
    graded_block,
    middles,
    unit_vectors,
)

from flowgmo.flow.favor.cut_pairs import cell_volumes  # noqa: E402
from flowgmo.flow.favor.fractions import cover, open_fractions  # noqa: E402
from flowgmo.flow.favor.near_surface import Pose  # noqa: E402
from flowgmo.flow.favor.shares import wall_areas  # noqa: E402
from flowgmo.flow.fields import Open, grid_of  # noqa: E402
from flowgmo.geometry import Component, Limits, Piece  # noqa: E402
from flowgmo.geometry.transform import rotation  # noqa: E402
from flowgmo.mesh import Block  # noqa: E402

RAW = {"least": 0.0, "lone": 0.0}
SOLIDS = {
    "ball": (ball(0.25, (0.5, 0.52, 0.49)), 4 / 3 * np.pi * 0.25**3),
    "box": (box((0.2, 0.15, 0.25), (0.5, 0.5, 0.5), (20, 30, 40)), 8 * 0.2 * 0.15 * 0.25),
    "cylinder": (cylinder(0.2, 0.25, (0.5, 0.5, 0.5), (20, 30, 40)), np.pi * 0.04 * 0.5),
}


def cell_bounds(block, cell):
    i, j, k = cell
    return np.array([[p[a], p[a + 1]] for p, a in zip(block.planes, (i, j, k), strict=True)]).T


@pytest.mark.parametrize("pieces", [1, 2])
def test_planes_are_exact_in_every_cell(pieces):
    """Volumes and face areas of an oblique half-space against the dual hull of scipy: measured 6e-15."""
    rng = np.random.default_rng(pieces)
    block = graded_block(6, (1.0, 1.3, 0.8))
    for n in unit_vectors(rng, 4):
        h = n @ rng.uniform(0.3, 0.7, 3)
        solids = open_fractions(block, [HalfSpace(n, h)], pieces, **RAW)
        V, Ax, Ay, Az = solids.open
        for cell in rng.integers(0, 5, (40, 3)):
            low, high = cell_bounds(block, cell)
            volume = exact_volume([-n], [-h], low, high)
            i, j, k = cell + 2
            assert V[i, j, k] * np.prod(high - low) == pytest.approx(volume, abs=1e-14)
            for axis, A in enumerate((Ax, Ay, Az)):  # a thin slab of cells behind the face has the face's share
                across = np.delete(np.arange(3), axis)
                flat = -n[across], -(h - n[axis] * high[axis])
                size = np.linalg.norm(flat[0])
                lo, hi = np.append(low[across], 0.0), np.append(high[across], 1.0)
                area = exact_volume([np.append(flat[0], 0.0) / size], [flat[1] / size], lo, hi)
                assert A[i, j, k] * np.prod(high[across] - low[across]) == pytest.approx(area, abs=1e-13)


@pytest.mark.parametrize(("pieces", "grade"), [(1, 0.0), (1, 0.3), (2, 0.0), (2, 0.3)])
@pytest.mark.parametrize("name", SOLIDS)
def test_volumes_of_solids_converge(name, pieces, grade):
    """Error at 20 cells and order from 10 to 40 cells across the domain.

    The box is exact, edges and corners too: 7e-16; cut off by chords it missed 1.2e-3. The others: with pieces 1
    1.6e-2 to 3.2e-2, order 1.95 to 2.05 (chords); with 2: the ball exact, the cylinder to 8.5e-5, at 40 below 9e-6.
    """
    shape, volume = SOLIDS[name]
    errors = []
    for n in (10, 20, 40):
        errors.append(abs(open_fractions(graded_block(n, grade=grade), [shape], pieces, **RAW).covered[0] / volume - 1))
    if name == "box" or (name == "ball" and pieces == 2):
        assert max(errors) < 1e-13
    elif pieces == 1:
        assert np.log2(errors[0] / errors[2]) / 2 > 1.9
        assert errors[1] < 0.035
    else:
        assert errors[1] < 1.2e-4
        assert errors[2] < 1.2e-5


@pytest.mark.parametrize("pieces", [1, 2])
def test_wall_area_of_a_ball_converges(pieces):
    """Sum of |a_b| against 4 pi R^2: measured 8.7e-3 and 2.2e-3 at 20, 2.2e-3 and 5.2e-4 at 40, order 2.0."""
    errors = []
    for n in (20, 40):
        block = graded_block(n)
        shares = open_fractions(block, [SOLIDS["ball"][0]], pieces, **RAW).shares[0]
        area = np.linalg.norm(wall_areas(shares, grid_of(block)), axis=1).sum()
        errors.append(abs(area / (4 * np.pi * 0.25**2) - 1))
    assert errors[1] < (2.4e-3 if pieces == 1 else 6e-4)
    assert errors[0] / errors[1] > 3.7


def shares_on_faces(solids, shape):
    """Sum of all shares (…, 6) in each cell."""
    total = np.zeros((*shape, 6))
    for s in solids.shares:
        total[tuple(s.cells.T)] += s.faces
    return total


OVERLAPPING = [
    box((0.3, 0.2, 0.25), (0.4, 0.4, 0.4), (20, 30, 40)),
    ball(0.2, (0.55, 0.6, 0.5)),
    cylinder(0.1, 0.4, (0.5, 0.5, 0.6), (80, 10, 0)),
]


@pytest.mark.parametrize("clean", [RAW, {}, {"least": 0.02, "lone": 0.2}])
def test_open_and_covered_shares_sum_to_one(clean):
    """Three solids that overlap, before and after cleaning up (which closes faces that nothing covers): 3e-16."""
    solids = open_fractions(graded_block(16), OVERLAPPING, **clean)
    V, *areas = solids.open
    total = shares_on_faces(solids, V.shape)
    is_open = V[INNER] > 0.0
    for axis, A in enumerate(areas):
        lower = np.roll(A, 1, axis)
        for side, open_share in enumerate((lower, A)):
            np.testing.assert_allclose((open_share + total[..., 2 * axis + side])[INNER][is_open], 1.0, atol=1e-15)
        assert (A[INNER][~is_open] == 0.0).all()
        assert (lower[INNER][~is_open] == 0.0).all()
        assert np.isfinite(A).all()
    for s in solids.shares:
        assert ((s.faces >= 0.0) & (s.faces <= 1.0 + 1e-15)).all()


def test_both_cells_of_a_face_see_the_same_shares():
    """Of each solid by itself, also where a face was closed though nothing covered it: to the bit."""
    rng = np.random.default_rng(0)
    for clean in (RAW, {}, {"least": 0.1, "lone": 0.4}, {"least": 0.3, "lone": 0.9}):
        solids = [ball(rng.uniform(0.1, 0.3), rng.uniform(0, 1, 3)) for _ in range(3)]
        solids += [box(rng.uniform(0.003, 0.3, 3), rng.uniform(0, 1, 3), rng.uniform(-90, 90, 3)) for _ in range(3)]
        found = open_fractions(graded_block(14), solids, **clean)
        V = found.open.V
        for s in found.shares:
            dense = np.zeros((*V.shape, 6))
            dense[tuple(s.cells.T)] = s.faces
            for axis in range(3):
                lower, upper = (np.delete(dense[INNER], end, axis) for end in (-1, 0))
                both = np.delete(V[INNER], -1, axis) * np.delete(V[INNER], 0, axis) > 0.0
                np.testing.assert_array_equal(lower[both][:, 2 * axis + 1], upper[both][:, 2 * axis])
        total = shares_on_faces(found, V.shape)
        for axis, A in enumerate(found.open[1:]):
            is_open = V[INNER] > 0.0
            np.testing.assert_allclose((A + total[..., 2 * axis + 1])[INNER][is_open], 1.0, atol=1e-14)
            assert ((A[INNER] == 0.0) | is_open).all()


def test_constant_pressure_gives_no_force():
    """Wall areas of each body that lies free sum to zero: 3e-16 of its surface; a share that differs in the two cells
    of a face would leave a face's worth, 1e-3."""
    block = graded_block(20)
    solids = open_fractions(block, [SOLIDS["box"][0], box((0.05, 0.1, 0.06), (0.15, 0.2, 0.2), (9, 8, 7))])
    for s in solids.shares:
        assert np.abs(wall_areas(s, grid_of(block)).sum(0)).max() < 1e-15


def test_hydrostatic_pressure_lifts_by_the_volume():
    """Sum of p a_b with p = -z at cell centres is the ball's volume: measured 1.3e-4 of it at 20 cells across."""
    block = graded_block(40, grade=0.0)
    s = open_fractions(block, [SOLIDS["ball"][0]]).shares[0]
    z = 0.5 * (block.z[1:] + block.z[:-1])
    lift = (wall_areas(s, grid_of(block)) * -z[s.cells[:, 2] - 2][:, None]).sum(0)
    assert lift[2] == pytest.approx(SOLIDS["ball"][1], rel=1e-3)
    assert np.abs(lift[:2]).max() < 1e-15


def test_none_without_solids_in_the_domain():
    solids = open_fractions(graded_block(8), [ball(0.2, (3, 3, 3))])
    assert solids.open == Open(None, None, None, None)
    assert open_fractions(graded_block(8), []).open.V is None
    assert len(solids.shares) == 1
    assert not len(solids.shares[0].cells)


def test_a_solid_that_fills_the_mesh_is_refused():
    with pytest.raises(ValueError, match="fill the whole mesh"):
        open_fractions(graded_block(8), [ball(5.0, (0.5, 0.5, 0.5))])
    with pytest.raises(ValueError, match="fill the whole mesh"):
        open_fractions(graded_block(8), [HalfSpace([0, 0, 1], 0.5), HalfSpace([0, 0, -1], -0.5)])


def test_a_box_on_mesh_planes_is_all_or_nothing():
    """Its surface runs through nodes: V and A are 0 or 1 to the bit, and its floor against the domain's side closed."""
    block = graded_block(10, grade=0.0)
    x, y, z = block.planes
    half = np.array([x[7] - x[3], y[6] - y[2], z[4] - z[0]]) / 2
    at = np.array([x[7] + x[3], y[6] + y[2], z[4] + z[0]]) / 2
    V, Ax, Ay, Az = open_fractions(block, [box(half, at)]).open
    expected = np.ones((10, 11, 9))
    expected[3:7, 2:6, 0:4] = 0.0
    np.testing.assert_array_equal(V[INNER], expected)
    for A in (Ax, Ay, Az):
        assert set(np.unique(A)) == {0.0, 1.0}
    assert Ax[4, 4, 2] == 0.0  # the face where the box begins
    assert Ax[3, 4, 2] == 1.0
    assert Az[5, 4, 1] == 0.0  # on the domain's side


def test_a_solid_that_only_touches_a_side_from_outside_closes_it():
    """Flush with the domain's floor: the floor's faces are closed and its share is there, nothing else changes."""
    solids = open_fractions(graded_block(6, grade=0.0), [box((0.2, 0.25, 0.5), (0.5, 0.5, -0.5))], **RAW)
    assert (solids.open.V == 1.0).all()
    assert solids.open.Az[5, 5, 1] < 1.0
    assert solids.shares[0].faces[:, 4].max() == 1.0


def test_ghosts_are_mirror_images():
    block = graded_block(8)
    V, Ax, Ay, Az = open_fractions(block, [ball(0.3, (0.1, 0.9, 0.5))]).open
    np.testing.assert_array_equal(V[1], V[2])
    np.testing.assert_array_equal(V[0], V[3])
    np.testing.assert_array_equal(V[-1], V[-4])
    np.testing.assert_array_equal(Ax[0], Ax[2])
    np.testing.assert_array_equal(Ax[-2], Ax[-4])  # u[nx + 2] is the image of u[nx], about the side at nx + 1
    np.testing.assert_array_equal(Ax[-1], Ax[-5])
    np.testing.assert_array_equal(Ax[:, 1], Ax[:, 2])
    np.testing.assert_array_equal(Az[:, :, 0], Az[:, :, 2])
    np.testing.assert_array_equal(Ay[:, -2], Ay[:, -4])


@pytest.mark.parametrize("cells", [(1, 9, 8), (9, 1, 8), (9, 8, 1)])
def test_one_cell_in_a_direction(cells):
    """A two-dimensional scene: a cylinder across it, area to 3e-4."""
    axis = cells.index(1)
    planes = [np.linspace(0, 1 if n > 1 else 0.1, n + 1) for n in cells]
    turn = [(0, 90, 0), (90, 0, 0), (0, 0, 0)][axis]
    at = [0.05 if k == axis else 0.5 for k in range(3)]
    block = Block(*planes, graded_block(4).neighbours)
    solids = open_fractions(block, [cylinder(0.3, 1.0, at, turn)])
    assert (solids.open.V[INNER] * cell_volumes(block)).sum() / 0.1 == pytest.approx(1 - np.pi * 0.09, abs=1e-3)
    assert all(np.isfinite(a).all() for a in solids.open)


def test_mirrored_scene():
    """x -> 1 - x: fractions mirrored to round-off."""
    block = graded_block(12)
    mirrored = Block(1.0 - block.x[::-1], block.y, block.z, block.neighbours)
    one = open_fractions(block, [box((0.2, 0.15, 0.25), (0.43, 0.5, 0.5), (0, 0, 40)), ball(0.1, (0.8, 0.8, 0.8))])
    two = open_fractions(mirrored, [box((0.2, 0.15, 0.25), (0.57, 0.5, 0.5), (0, 0, -40)), ball(0.1, (0.2, 0.8, 0.8))])
    np.testing.assert_allclose(two.open.V[::-1], one.open.V, atol=1e-13)
    np.testing.assert_allclose(two.open.Ay[::-1], one.open.Ay, atol=1e-13)
    np.testing.assert_allclose(two.open.Ax[1:-2][::-1], one.open.Ax[1:-2], atol=1e-13)


def test_length_scaled_by_a_power_of_two_gives_the_same_bits():
    block = graded_block(12)
    scaled = Block(*(1024 * p for p in block.planes), block.neighbours)
    one = open_fractions(block, [box((0.2, 0.15, 0.25), (0.43, 0.5, 0.5), (10, 20, 40)), ball(0.2, (0.7, 0.7, 0.7))])
    two = open_fractions(
        scaled,
        [
            box(1024 * np.array([0.2, 0.15, 0.25]), 1024 * np.array([0.43, 0.5, 0.5]), (10, 20, 40)),
            ball(0.2 * 1024, 1024 * np.array([0.7, 0.7, 0.7])),
        ],
    )
    for a, b in zip(one.open, two.open, strict=True):
        np.testing.assert_array_equal(a, b)
    assert two.lost.thin == 1024.0**3 * one.lost.thin


def test_cover_in_a_pose_is_the_solid_put_there():
    """The same box given in place, and given elsewhere with a pose; then only a part of the mesh."""
    block = graded_block(14)
    R, t = rotation((20, 30, 40)), np.array([0.5, 0.45, 0.55])
    there = cover(box((0.2, 0.15, 0.25), t, (20, 30, 40)), block)
    posed = cover(box((0.2, 0.15, 0.25), (0, 0, 0)), block, Pose(R, t))
    a, b = np.zeros((18, 19, 17)), np.zeros((18, 19, 17))
    a[tuple(there.cells.T)], b[tuple(posed.cells.T)] = there.volume, posed.volume
    for field, c in ((a, there), (b, posed)):
        for low, high in c.inside:
            field[low[0] : high[0], low[1] : high[1], low[2] : high[2]] = 1.0
    np.testing.assert_allclose(a, b, atol=1e-12)
    limits = np.array([[4, 4, 4], [8, 9, 7]])
    part = cover(box((0.2, 0.15, 0.25), (0, 0, 0)), block, Pose(R, t), limits)
    within = ((posed.cells >= limits[0] + 2) & (posed.cells < limits[1] + 2)).all(1)
    np.testing.assert_array_equal(part.cells, posed.cells[within])
    np.testing.assert_array_equal(part.faces, posed.faces[within])


def test_cover_is_what_open_fractions_leave():
    """One ball, known by its distance only: V + its volume share is 1 in every cell, in both ways to the bit."""
    block, one = graded_block(14), SOLIDS["ball"][0]
    shape = SimpleNamespace(distance=one.distance, bounds=one.bounds)
    c = cover(shape, block, pieces=2)
    V = open_fractions(block, [shape], **RAW).open.V
    np.testing.assert_array_equal(V[tuple(c.cells.T)], 1.0 - c.volume)
    assert len(c.inside) > 0
    for low, high in c.inside:
        assert (V[low[0] : high[0], low[1] : high[1], low[2] : high[2]] == 0.0).all()


def test_abutting_solids_leave_no_slit():
    """Two boxes that share a face inside cells: the cells along it are closed, and their volumes are one box's.

    Measured 4e-16 of the box.
    """
    pair = [box((0.1, 0.2, 0.2), (0.4, 0.5, 0.5)), box((0.1, 0.2, 0.2), (0.6, 0.5, 0.5))]
    block = graded_block(26)
    V = open_fractions(block, pair).open.V[INNER]
    centre = np.abs(middles(block) - 0.5).max(-1)
    assert (V[centre < 0.12] == 0.0).all()
    assert 1 - (V * cell_volumes(block)).sum() == pytest.approx(0.4**3, rel=1e-12)


def hull_volume(*boxes):
    """What boxes, in any directions, have in common: shares no code with the cuts."""
    n, h = (np.concatenate([getattr(b.sheets, name) for b in boxes]) for name in "nh")
    return exact_volume(n, h)


@pytest.mark.parametrize("cells", [11, 20])
def test_solids_that_meet_or_overlap_are_exact(cells):
    """Two boxes with an oblique face in common, and two across each other: 2e-15 of their union, 2e-2 with chords.

    Where a body fills the middle of a cell, the smaller pocket beside it is closed: that volume is reported.
    """
    R = rotation((20, 30, 40))
    one = box((0.2, 0.2, 0.15), (0.4, 0.5, 0.4), (20, 30, 40))
    beside = box((0.1, 0.2, 0.15), np.array([0.4, 0.5, 0.4]) + R @ [0.3, 0, 0], (20, 30, 40))
    across = box((0.15, 0.25, 0.2), (0.55, 0.6, 0.45), (-10, 50, 70))
    block = graded_block(cells)
    for other in (beside, across):
        exact = hull_volume(one) + hull_volume(other)
        exact -= hull_volume(one, other) if other is across else 0.0
        solids = open_fractions(block, [one, other], **RAW)
        covered = 1 - (solids.open.V[INNER] * cell_volumes(block)).sum()
        assert covered - solids.lost.thin == pytest.approx(exact, rel=1e-12)
        assert 0.0 <= solids.lost.thin < 1e-4


def test_a_solid_with_a_hole_and_faces_on_mesh_planes():
    """A block with a notch, faces on planes of a graded mesh and in between: V exact in every cell, A on planes too."""
    block = graded_block(10)
    x, y, z = block.planes
    lo, hi = np.array([x[3], y[2], z[0]]), np.array([x[8], y[9], 0.71])
    notch_lo, notch_hi = np.array([x[5], y[4], 0.33]), np.array([x[7], 0.61, 2.0])
    pieces = [
        Piece(limits=Limits(*zip(lo, hi, strict=True))),
        Piece(role="hole", limits=Limits(*zip(notch_lo, notch_hi, strict=True))),
    ]
    V, Ax, Ay, Az = open_fractions(block, [Component(pieces)], **RAW).open

    def shares(planes, a, b):
        return np.clip((np.minimum(planes[1:], b) - np.maximum(planes[:-1], a)) / np.diff(planes), 0.0, 1.0)

    def filled(a, b):
        return np.einsum(
            "i,j,k->ijk", *(shares(p, *ends) for p, ends in zip(block.planes, zip(a, b, strict=True), strict=True))
        )

    exact = 1.0 - filled(lo, hi) + filled(notch_lo, np.minimum(notch_hi, hi))
    np.testing.assert_allclose(V[INNER], exact, atol=1e-13)
    assert (V[INNER][np.isclose(exact, 1.0, atol=1e-12)] == 1.0).all()
    assert (Ax[4, 5:10, 2:6] == 0.0).all()  # the lower x face of the block
    assert (Ax[9, 5:10, 2:6] == 0.0).all()
