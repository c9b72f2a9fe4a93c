"""Open fractions among moving bodies: shares that sum to one and close, poses, overlaps, meshes, and what it costs."""

import numpy as np
import pytest
from flow_solids import INNER, ball, box, cylinder, graded_block, unit_vectors

from flowgmo.flow.favor import body_cover, body_sheets, covered_cells
from flowgmo.flow.favor.cut_pairs import cell_volumes, cut_pairs
from flowgmo.flow.favor.fractions import mirror_ghosts, open_fractions
from flowgmo.flow.favor.moving_openings import MovingOpenings
from flowgmo.flow.favor.near_surface import Pose, near_cells
from flowgmo.flow.favor.shares import wall_areas
from flowgmo.flow.fields import G, grid_of
from flowgmo.geometry import Component, Limits, Piece
from flowgmo.geometry.mesh_solid import MeshSolid
from flowgmo.geometry.stl import StlMesh
from flowgmo.geometry.transform import rotation
from flowgmo.mesh import Block

RAW = {"least": 0.0, "lone": 0.0}
BED = [box((3.0, 3.0, 0.2), (0.5, 0.5, -0.013), (4, 3, 0)), ball(0.12, (0.75, 0.25, 0.2))]
AWAY = (9.0, 9.0, 9.0)


def pose(t, degrees=(0, 0, 0)):
    return Pose(rotation(degrees), np.array(t, float))


def uniform(n, length=1.0):
    """n cells of equal width in each direction; n one number or three."""
    n = np.broadcast_to(n, 3)
    return Block(*(np.linspace(0.0, length * m / max(n), m + 1) for m in n), graded_block(4).neighbours)


def start(block, solids, shapes, poses, **clean):
    still = open_fractions(block, solids, **clean)
    return MovingOpenings(block, still, solids, shapes, poses), still


def dense(swept, shape):
    """Shares (bodies, …, 6) as arrays of mesh size."""
    out = np.zeros((len(swept.shares), *shape, 6))
    for b, s in enumerate(swept.shares):
        out[b][tuple(s.cells.T)] = s.faces
    return out


def faces(open_, axis, side):
    """The lower (side 0) or upper face of each cell across an axis."""
    return np.roll(open_[1 + axis], 1 - side, axis)


def check_identities(moving, swept, still, overlap=False):
    """Sums, agreement of both cells of a face, closed cells, ranges, and ghosts."""
    shape = moving.open.V.shape
    every, shares = np.zeros(shape, bool), dense(swept, shape)
    every[tuple(swept.cells.T)] = True
    for axis in range(3):
        for side in range(2):
            S, A = shares[..., 2 * axis + side], faces(moving.mean, axis, side)
            total = A + S.sum(axis=0)
            fixed = 1.0 if still.open.V is None else faces(still.open, axis, side)
            if overlap and still.open.V is not None:  # a stationary solid's share depends on what it overlaps with
                assert (total[every] <= 1.0 + 1e-14).all()
            else:
                np.testing.assert_allclose((total - fixed)[every], 0.0, atol=1e-14)
            assert (S >= 0.0).all()
        lower, upper = np.delete(every, -1, axis), np.delete(every, 0, axis)
        a = np.delete(shares[..., 2 * axis + 1], -1, axis + 1)[:, lower & upper]
        np.testing.assert_array_equal(a, np.delete(shares[..., 2 * axis], 0, axis + 1)[:, lower & upper])
    index = np.lexsort(swept.cells.T[::-1])
    np.testing.assert_array_equal(index, np.arange(len(index)))
    for s in swept.shares:
        assert every[tuple(s.cells.T)].all()
    np.testing.assert_array_equal(moving.open.V[tuple(swept.cells.T)], swept.V0)
    assert moving.mean.V is not moving.open.V  # the step's own
    check_closed(moving.open)
    for fields in (moving.open, moving.mean):
        for axis, a in enumerate(fields):
            mirrored = a.copy()
            mirror_ghosts(mirrored, axis - 1)
            np.testing.assert_array_equal(mirrored, a)


def check_closed(open_):
    """A cell without volume has no open face; all are shares."""
    full = open_.V[INNER] == 0.0
    for axis in range(3):
        for side in range(2):
            assert (faces(open_, axis, side)[INNER][full] == 0.0).all()
    for a in open_:
        assert ((a >= 0.0) & (a <= 1.0)).all()


SHAPES = [ball(0.15, (0, 0, 0)), box((0.1, 0.15, 0.1), (0, 0, 0)), cylinder(0.08, 0.2, (0, 0, 0))]


def random_poses(rng, spread):
    return [Pose(rotation(rng.uniform(-180, 180, 3)), c + rng.uniform(-spread, spread, 3)) for c in AT]


AT = [np.array(c) for c in ((0.3, 0.3, 0.45), (0.7, 0.65, 0.42), (0.3, 0.72, 0.7))]


def test_identities_among_stationary_solids():
    """Random poses, small and large moves, on a graded mesh: sums to 1e-14, one share a face to the bit."""
    rng = np.random.default_rng(1)
    moving, still = start(graded_block(18), BED, SHAPES, random_poses(rng, 0.03))
    spreads = (0.03, 0.03, 0.03, 0.6, 0.6, 0.03)
    for last, spread in zip(spreads[:-1], spreads[1:], strict=True):
        before = [a.copy() for a in moving.open]
        swept = moving.sweep(random_poses(rng, spread))
        for a, b in zip(before, moving.open, strict=True):
            np.testing.assert_array_equal(a, b)
        check_identities(moving, swept, still, overlap=max(last, spread) > 0.1)
        now = [a.copy() for a in moving.open[1:]]
        mean = [a.copy() for a in moving.mean[1:]]
        moving.settle()
        np.testing.assert_array_equal(moving.open.V[tuple(swept.cells.T)], swept.V1)
        for a, b, c, d in zip(now, moving.open[1:], mean, moving.mean[1:], strict=True):
            np.testing.assert_array_equal(0.5 * (a + b), c)
            np.testing.assert_array_equal(b, d)
        check_closed(moving.open)


def test_bodies_alone_close_and_keep_their_volume():
    """Inside the mesh wall areas sum to 1e-15 of the domain's side; a ball, a box and a cylinder 14 to 20 cells across
    keep their volume: 2.4e-5, 2e-15, 3.0e-5 of it (chords: 6e-3). Closure: 1.4e-16."""
    rng = np.random.default_rng(2)
    block = graded_block(48)
    moving, still = start(block, [], SHAPES, random_poses(rng, 0.03))
    exact = [4 / 3 * np.pi * 0.15**3, 8 * 0.1 * 0.15 * 0.1, np.pi * 0.08**2 * 0.4]
    for _ in range(3):
        swept = moving.sweep(random_poses(rng, 0.03))
        check_identities(moving, swept, still)
        for s in swept.shares:
            assert np.abs(wall_areas(s, grid_of(block)).sum(axis=0)).max() < 1e-15
        error = np.abs(swept.volume / np.array(exact)[:, None] - 1.0).max(axis=1)
        assert (error < [6e-5, 1e-13, 8e-5]).all(), error
        open_volume = (moving.open.V[INNER] * cell_volumes(block)).sum()
        assert 1.0 - open_volume == pytest.approx(swept.volume[:, 0].sum(), rel=1e-13)
        volumes = cell_volumes(block)[tuple((swept.cells - G).T)]
        gained = ((swept.V1 - swept.V0) * volumes).sum()
        assert gained == pytest.approx(swept.volume[:, 0].sum() - swept.volume[:, 1].sum(), abs=1e-15)
        moving.settle()


def uncut(block, shapes):
    """V (nx, ny, nz) that shapes leave, all cut at once, without the search for thin walls."""
    near = [near_cells(s.distance, block.planes, s.bounds()) for s in shapes]
    cut = cut_pairs(block, [s.distance for s in shapes], [n.cells for n in near], 2, thin=False, shapes=shapes)
    V = np.ones(block.shape)
    V[tuple(cut.cells.T)] = cut.opened[:, 6]
    for n in near:
        for low, high in n.inside:
            V[low[0] : high[0], low[1] : high[1], low[2] : high[2]] = 0.0
    return V


def test_a_body_that_stands_is_a_stationary_solid():
    """Each at rest against the cut of stationary solids, which shares only the cut of a part: 1e-13."""
    block = graded_block(16)
    for shape in (ball(0.2, (0.45, 0.5, 0.55)), box((0.2, 0.15, 0.1), (0.5, 0.5, 0.5), (20, 30, 40)),
                  cylinder(0.2, 0.2, (0.45, 0.5, 0.55), (20, 30, 40))):  # fmt: skip
        moving, _ = start(block, [], [shape], [pose((0, 0, 0))])
        np.testing.assert_allclose(moving.open.V[INNER], uncut(block, [shape]), atol=1e-13)


def test_a_box_on_mesh_planes_is_all_or_nothing():
    """Its surface runs through nodes: V and A are 0 or 1 to the bit, closed where it lies flush with a face."""
    block = uniform(16)
    moving, still = start(block, [], [box((0.125, 0.1875, 0.25), (0, 0, 0))], [pose((0.5, 0.4375, 0.25))])
    expected = np.ones(block.shape)
    expected[6:10, 4:10, 0:8] = 0.0
    np.testing.assert_array_equal(moving.open.V[INNER], expected)
    for A in moving.open[1:]:
        assert set(np.unique(A)) == {0.0, 1.0}
    assert moving.open.Ax[7, 6, 2] == 0.0  # the face where the box begins
    assert moving.open.Ax[6, 6, 2] == 1.0
    assert moving.open.Az[9, 7, 1] == 0.0  # on the domain's side
    swept = moving.sweep([pose((0.5, 0.4375, 0.3125))])
    check_identities(moving, swept, still)
    assert set(np.unique(moving.mean.Az)) == {0.0, 0.5, 1.0}


def test_bodies_that_leave_leave_no_trace():
    """Through each side and back in: `open` and `mean` have the stationary solids' bits, ghosts too; back, the same."""
    block = graded_block(12)
    moving, still = start(block, BED, SHAPES[:2], [pose(AWAY), pose(AWAY)])
    for a, b, c in zip(moving.open, moving.mean, still.open, strict=True):
        np.testing.assert_array_equal(a, c)
        np.testing.assert_array_equal(b, c)
    for axis in range(3):
        for end in (0.0, 1.0):
            t = np.array([0.5, 0.5, 0.6])
            t[axis] = end
            swept = moving.sweep([pose(t, (10, 20, 30)), pose(AWAY)])
            assert swept.volume[0, 1] > 0.0
            check_identities(moving, swept, still, overlap=True)
            moving.settle()
            first = [a.copy() for a in moving.open]
            assert moving.sweep([pose(AWAY), pose(AWAY)]).volume[0, 1] == 0.0
            moving.settle()
            for a, b, c in zip(moving.open, moving.mean, still.open, strict=True):
                np.testing.assert_array_equal(a, c)
                np.testing.assert_array_equal(b, c)
            moving.sweep([pose(t, (10, 20, 30)), pose(AWAY)])
            moving.settle()
            for a, b in zip(first, moving.open, strict=True):
                np.testing.assert_array_equal(a, b)


def test_settle_after_two_sweeps():
    """Only the newest poses count: the same bits as without the first sweep."""
    block = graded_block(12)
    poses = [[pose((0.3, 0.4, 0.5 + s), (s * 90, 0, 9)), pose((0.7, 0.6, 0.5 - s))] for s in (0.0, 0.3, 0.04)]
    one, _ = start(block, BED, SHAPES[:2], poses[0])
    two, still = start(block, BED, SHAPES[:2], poses[0])
    one.sweep(poses[1])
    a, b = one.sweep(poses[2]), two.sweep(poses[2])
    check_identities(one, a, still)
    for x, y in zip((*one.mean, *a[:3], a.volume), (*two.mean, *b[:3], b.volume), strict=True):
        np.testing.assert_array_equal(x, y)
    one.settle()
    one.settle()
    two.settle()
    for x, y in zip((*one.open, *one.mean), (*two.open, *two.mean), strict=True):
        np.testing.assert_array_equal(x, y)


def test_bodies_at_rest_cost_nothing(monkeypatch):
    """No distance is asked for a body whose pose has the same bits; the others' is asked near their surface only."""
    block = graded_block(16)
    poses = [pose((0.3, 0.3, 0.5)), pose((0.7, 0.6, 0.5))]
    moving, _ = start(block, BED, SHAPES[:2], poses)
    asked = []
    real = body_cover.cover_bodies
    monkeypatch.setattr("flowgmo.flow.favor.moving_openings.cover_bodies", lambda m, b: asked.extend(b) or real(m, b))
    swept = moving.sweep(poses)
    assert not asked
    assert (swept.V0 == swept.V1).all()
    assert moving.sweep([Pose(p.R.copy(), p.t.copy()) for p in poses]) is swept
    moving.settle()
    moving.sweep([poses[0], pose((0.7, 0.6, 0.51))])
    assert len(asked) == 1
    moving.sweep([poses[0], pose((0.7, 0.6, 0.52))])
    moving.settle()
    assert len(asked) == 2


def test_poses_that_change_in_place():
    """The caller may keep one array for a pose and write into it."""
    one = pose((0.4, 0.5, 0.5))
    moving, _ = start(graded_block(12), [], SHAPES[:1], [one])
    before = moving.open.V.copy()
    one.t[0] += 0.1
    swept = moving.sweep([one])
    assert (swept.V0 != swept.V1).any()
    one.t[0] += 0.1
    assert moving.sweep([one]) is not swept
    moving.settle()
    assert (before != moving.open.V).any()


@pytest.mark.parametrize("shape", [*SHAPES, cylinder(0.2, 0.1, (0.1, 0.2, -0.1), (30, 40, 50))])
def test_balls_and_cylinders_are_found_by_their_distance(shape, monkeypatch):
    """Their closed forms give the shares that their distances at nodes give: 4.7e-14 of a face measured."""
    block, at = graded_block(15), pose((0.5, 0.5, 0.5), (20, 30, 40))
    monkeypatch.setattr(
        body_cover, "cut_of_balls", lambda *a: body_cover.BY_CHORDS
    )  # exact cuts are not those of values at nodes
    found = body_sheets.Body(shape)
    assert found.exact
    assert not found.curved
    closed = body_cover.cover_body(body_cover.CoverMesh(block), found.moved(at))
    monkeypatch.setattr("flowgmo.geometry.sheets_by_piece.round_sheet", lambda *a: None)
    asked = body_sheets.Body(Component(shape.pieces, shape.transform))
    assert not len(asked.rounds)
    numbered = body_cover.cover_body(body_cover.CoverMesh(block), asked.moved(at))
    np.testing.assert_array_equal(closed.numbers, numbered.numbers)
    np.testing.assert_allclose(closed.shares, numbered.shares, atol=1e-12)
    assert closed.volume == pytest.approx(numbered.volume, rel=1e-12)


def test_runs_apart():
    """Against sets, over random runs."""
    rng = np.random.default_rng(3)
    for _ in range(200):
        runs = [np.sort(rng.choice(40, 2 * rng.integers(0, 6), replace=False)).reshape(-1, 2) for _ in range(2)]
        one, two = ({n for a, b in r for n in range(a, b)} for r in runs)
        found = covered_cells.runs_apart(*(r.astype(np.int64) for r in runs))
        assert sorted(found.tolist()) == sorted(one ^ two)


def test_translation_by_whole_cells():
    """By powers of two of a uniform mesh's width: the same numbers, shifted; measured 0, a mesh width is 2^-4."""
    block = uniform(16)
    shapes = SHAPES[:2]
    at = [np.array([0.375, 0.3125, 0.5]), np.array([0.6875, 0.625, 0.4375])]
    steps = np.array([1, 2, -3])
    first, _ = start(block, [], shapes, [pose(t, (20, 30, 40)) for t in at])
    a = first.sweep([pose(t + 0.0078125, (20, 30, 40)) for t in at])
    shifted, _ = start(block, [], shapes, [pose(t + steps / 16, (20, 30, 40)) for t in at])
    b = shifted.sweep([pose(t + 0.0078125 + steps / 16, (20, 30, 40)) for t in at])
    np.testing.assert_array_equal(a.cells + steps, b.cells)
    np.testing.assert_allclose(a.V1, b.V1, atol=1e-13)
    np.testing.assert_allclose(a.volume, b.volume, rtol=1e-13)
    for s, r in zip(a.shares, b.shares, strict=True):
        np.testing.assert_array_equal(s.cells + steps, r.cells)
        np.testing.assert_allclose(s.faces, r.faces, atol=1e-13)


def test_lengths_scaled_by_a_power_of_two_give_the_same_bits():
    block = graded_block(14)
    scaled = Block(*(1024 * p for p in block.planes), block.neighbours)
    bodies = [lambda s: ball(0.15 * s, (0, 0, 0)), lambda s: cylinder(0.08 * s, 0.2 * s, (0, 0, 0))]
    found = []
    for mesh, s in ((block, 1.0), (scaled, 1024.0)):
        moving, _ = start(mesh, [], [b(s) for b in bodies], [pose(s * AT[0], (9, 8, 7)), pose(s * AT[1], (5, 40, 7))])
        swept = moving.sweep([pose(s * (AT[0] + 0.02), (9, 8, 7)), pose(s * (AT[1] - 0.02), (5, 30, 7))])
        found.append((*moving.mean, *swept[:3], *(x.faces for x in swept.shares), swept.volume / s**3))
    for a, b in zip(*found, strict=True):
        np.testing.assert_array_equal(a, b)


def test_mirrored_scene():
    """x -> 1 - x: to round-off, 1e-13."""
    block = graded_block(14)
    mirrored = Block(1.0 - block.x[::-1], block.y, block.z, block.neighbours)
    found = []
    for mesh, m in ((block, 1.0), (mirrored, -1.0)):

        def at(x, degrees, m=m):
            return pose(((1 - m) / 2 + m * x[0], x[1], x[2]), (degrees[0], m * degrees[1], m * degrees[2]))

        bed = [box((3.0, 3.0, 0.2), (0.5, 0.5, -0.013))]
        moving, _ = start(mesh, bed, SHAPES, [at(x, (10, 20, 30)) for x in AT])
        moving.sweep([at(x + 0.02, (12, 25, 30)) for x in AT])
        found.append(moving.mean)
    one, two = found
    np.testing.assert_allclose(two.V[::-1], one.V, atol=1e-13)
    np.testing.assert_allclose(two.Ay[::-1], one.Ay, atol=1e-13)
    np.testing.assert_allclose(two.Az[::-1], one.Az, atol=1e-13)
    np.testing.assert_allclose(two.Ax[1:-2][::-1], one.Ax[1:-2], atol=1e-13)


def test_resting_on_a_bed_and_on_each_other():
    """Two boxes one on the other on a bed whose top cuts cells: what is covered adds up, nothing overlaps."""
    block = graded_block(16)
    bed = [box((2.0, 2.0, 0.13), (0.5, 0.5, 0.0))]
    shapes = [box((0.11, 0.12, 0.1), (0, 0, 0))] * 2
    poses = [pose((0.5, 0.5, 0.23), (0, 0, 30)), pose((0.52, 0.5, 0.43), (0, 0, 10))]
    moving, still = start(block, bed, shapes, poses)
    swept = moving.sweep(poses)
    check_identities(moving, swept, still)
    open_volume = (moving.open.V[INNER] * cell_volumes(block)).sum()
    assert 1.0 - open_volume == pytest.approx(0.13 + 2 * 8 * 0.11 * 0.12 * 0.1, rel=1e-12)
    # up for the lower box: what the bed and the upper box do not touch; no open cell is missing in its sums
    lift = [wall_areas(s, grid_of(block)).sum(axis=0)[2] for s in swept.shares]
    assert abs(lift[0]) < 4 * 0.11 * 0.12 + 1e-12


def test_a_flap_that_pierces_the_floor_is_cut_exactly():
    """Oblique box through the floor: the union's volume to 1e-12 (it is cut by planes alone), not the sum's (1e-2)."""
    block = graded_block(15)
    bed = [box((2.0, 2.0, 0.23), (0.5, 0.5, 0.0))]
    flap = box((0.05, 0.2, 0.3), (0, 0, 0))
    turned = pose((0.5, 0.5, 0.4), (0, 30, 0))
    moving, still = start(block, bed, [flap], [turned], **RAW)
    swept = moving.sweep([turned])
    check_identities(moving, swept, still, overlap=True)
    c, s = np.cos(np.pi / 6), np.sin(np.pi / 6)
    above = 0.05 * 2 * 0.4 * (0.3 + (0.4 - 0.23) / c)  # a slanted strip cut level: its length at the middle line
    assert 0.17 / c - 0.05 * s / c < 0.3  # the cut leaves the box through its long sides only
    covered = 1.0 - (moving.open.V[INNER] * cell_volumes(block)).sum()
    assert covered == pytest.approx(0.23 + above, rel=1e-12)
    assert swept.volume[0, 0] == pytest.approx(8 * 0.05 * 0.2 * 0.3, rel=1e-12)


def test_hinged_bodies_that_overlap():
    """Two boxes across each other: their union, also in cells where the sum is less than there is; both orders."""
    block = graded_block(15)
    shapes = [box((0.25, 0.1, 0.06), (0, 0, 0))] * 2
    poses = [pose((0.45, 0.5, 0.5), (0, 20, 0)), pose((0.6, 0.5, 0.5), (0, -30, 0))]
    moving, still = start(block, [], shapes, poses)
    check_identities(moving, moving.sweep(poses), still, overlap=True)
    both = [box((0.25, 0.1, 0.06), p.t, (0, d, 0)) for p, d in zip(poses, (20, -30), strict=True)]
    np.testing.assert_allclose(moving.open.V[INNER], uncut(block, both), atol=1e-13)
    other, _ = start(block, [], shapes, poses[::-1])
    for a, b in zip(moving.open, other.open, strict=True):
        np.testing.assert_allclose(a, b, atol=1e-13)


@pytest.mark.parametrize("cells", [(1, 19, 18), (19, 1, 18), (19, 18, 1)])
def test_one_cell_in_a_direction(cells):
    """A cylinder that reaches out on both sides of a two-dimensional mesh: its area to 1.1e-4 at 3.8 cells' radius."""
    axis = cells.index(1)
    block = uniform(cells)
    turn = [(0, 90, 0), (90, 0, 0), (0, 0, 0)][axis]
    shape = cylinder(0.2, 1.0, (0, 0, 0), turn)
    t = np.full(3, 0.47)
    t[axis] = 0.02
    moving, still = start(block, [], [shape], [pose(t)])
    swept = moving.sweep([pose(t + 0.01)])
    check_identities(moving, swept, still)
    depth = 1.0 / max(cells)
    np.testing.assert_allclose(swept.volume / depth, np.pi * 0.04, rtol=2.5e-4)


def test_a_body_that_spans_the_mesh():
    """A plate through all sides of the mesh: cells inside it are found although no surface is near them."""
    block = graded_block(12)
    moving, still = start(block, [], [box((3, 3, 0.2), (0, 0, 0))], [pose((0.5, 0.5, 0.5), (0, 3, 0))])
    swept = moving.sweep([pose((0.5, 0.5, 0.52), (0, 3, 0))])
    check_identities(moving, swept, still)
    covered = 1.0 - (moving.open.V[INNER] * cell_volumes(block)).sum()
    assert covered == pytest.approx(0.4 / np.cos(np.radians(3)), rel=1e-12)
    everywhere, _ = start(block, [], [box((3, 3, 3), (0, 0, 0))], [pose((0.5, 0.5, 0.5))])
    assert (everywhere.open.V[INNER] == 0.0).all()


def l_shape(size=1.0):
    """0.4 wide and high, 0.2 deep, without a quarter."""
    notch = Piece(role="hole", limits=Limits((0.0, 0.3 * size), (-0.3 * size, 0.3 * size), (0.0, 0.3 * size)))
    half = np.array([0.2, 0.1, 0.2]) * size
    return Component([Piece(limits=Limits(*((-a, a) for a in half))), notch])


def mesh_box(half):
    """A box made of twelve triangles, as read from a file."""
    vertices, triangles = box(half, (0, 0, 0)).triangles()
    solid = MeshSolid(np.asarray(vertices, float), np.asarray(triangles))
    return ByDistance(solid.distance, np.array([solid.vertices.min(axis=0), solid.vertices.max(axis=0)]))


class ByDistance:
    """A shape that is known by its distance only."""

    def __init__(self, distance, bounds):
        self.distance, self.bounds = distance, lambda: bounds


def of_distance(shape):
    return ByDistance(shape.distance, shape.bounds())


@pytest.mark.parametrize(("shape", "volume"), [(of_distance(l_shape()), 0.024), (mesh_box((0.2, 0.15, 0.1)), 0.024)])
def test_bodies_known_by_their_distance(shape, volume):
    """An L and a triangle mesh: identities as all others; volume by chords, 1.8e-3 and 1.4e-3 of it, 8 cells across."""
    rng = np.random.default_rng(5)
    block = graded_block(20)
    moving, still = start(block, BED, [shape], [pose((0.4, 0.5, 0.55), (10, 20, 30))])
    for turn in rng.uniform(-180, 180, (2, 3)):
        swept = moving.sweep([pose((0.45, 0.55, 0.55), turn)])
        check_identities(moving, swept, still)
        np.testing.assert_allclose(swept.volume, volume, rtol=4e-3)
        moving.settle()


def test_a_convex_mesh_is_cut_by_the_planes_of_its_triangles():
    """A six-sided prism of triangles as read from a file: its volume to 1e-12 in any pose; by chords 1e-3."""
    prism = cylinder(0.2, 0.15, (0, 0, 0)).triangles(6)
    shape = Component([Piece(stl=StlMesh(*prism))])
    volume = shape.mass_properties(1.0).volume
    rng = np.random.default_rng(6)
    block = graded_block(20)
    moving, still = start(block, BED, [shape], [pose((0.5, 0.5, 0.55))])
    for turn in rng.uniform(-180, 180, (3, 3)):
        swept = moving.sweep([pose((0.5, 0.52, 0.55), turn)])
        check_identities(moving, swept, still)
        np.testing.assert_allclose(swept.volume, volume, rtol=1e-12)
        moving.settle()


def test_a_sweep_makes_no_pass_over_the_mesh():
    """The same body in a mesh of 0.3 and of 2 million cells: distances asked, and memory taken, are the same."""
    import tracemalloc

    figures = []
    for n in (64, 128):
        block = Block(*[np.linspace(0.0, n, n + 1)] * 3, graded_block(4).neighbours)
        shape = of_distance(l_shape(25.0))
        c = np.full(3, n / 2 + 0.3)
        moving, _ = start(block, [], [shape], [pose(c, (20, 0, 20))])
        moving.sweep([pose(c + 0.1, (20, 0, 20))])
        moving.settle()
        asked = [0]
        real = moving._bodies[0].curved[0]

        def counted(x, asked=asked, real=real):
            asked[0] += len(x)
            return real(x)

        moving._bodies[0].curved = (counted,)
        tracemalloc.start()
        swept = moving.sweep([pose(c + 0.2, (21, 0, 20))])
        moving.settle()
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        figures.append((len(swept.cells), asked[0], peak))
    assert figures[0][:2] == figures[1][:2]
    assert figures[1][2] == pytest.approx(figures[0][2], rel=0.05)


def test_random_planes_between_bodies():
    """Ten random bodies in a box, many in each other's cells: sums, agreement, ranges, and never nan."""
    rng = np.random.default_rng(7)
    block = graded_block(14)
    shapes = [SHAPES[b % 3] for b in range(10)]
    turns = unit_vectors(rng, 20) * 180

    def poses(turns):
        return [Pose(rotation(d), rng.uniform(0.1, 0.9, 3)) for d in turns]

    moving, still = start(block, BED, shapes, poses(turns[:10]))
    for _ in range(4):
        swept = moving.sweep(poses(turns[10:]))
        check_identities(moving, swept, still, overlap=True)
        assert all(np.isfinite(s.faces).all() for s in swept.shares)
        moving.settle()
        check_closed(moving.open)
