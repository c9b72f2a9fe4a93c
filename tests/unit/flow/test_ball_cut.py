"""What a ball covers of cells, exactly: volumes that add up, faces against quadrature, what it sweeps, images."""

import numpy as np
import pytest
from flow_solids import graded_block

from flowgmo.flow.favor.ball_cut import cover_by_ball, cover_cells, fits, in_parts, moment_of_ball, scratch
from flowgmo.flow.favor.near_surface import node_planes
from flowgmo.kernel import kernel


def covered(block, middle, radius, parts=None):
    """Shares (nx, ny, nz, 7) of all cells of a block, and their volumes."""
    shape = block.shape
    parts = in_parts(radius, tuple(np.diff(x) for x in block.planes)) if parts is None else parts
    cells = np.indices(shape).reshape(3, -1).T.astype(np.int32)
    sheet, out = np.array([*middle, 0.0, 0.0, 0.0, radius]), np.empty((len(cells), 7))
    cover_cells(np.ascontiguousarray(cells), *node_planes(block.planes, 2), sheet, parts, 0.0, out)
    dx, dy, dz = (np.diff(x) for x in block.planes)
    return out.reshape(*shape, 7), dx[:, None, None] * dy[:, None] * dz


class Uniform:
    """n cells of width 1 about 0, in each direction."""

    def __init__(self, n):
        self.planes = (np.arange(n + 1.0) - n / 2,) * 3
        self.shape = (n, n, n)


def test_the_volume_is_the_ball_s():
    """Anywhere in a graded mesh, radii of 1.5 to 5 cells: 4e-15 measured, chords 2e-5."""
    rng, block = np.random.default_rng(5), graded_block(12)
    for _ in range(100):
        radius = rng.uniform(0.15, 0.3)
        shares, volumes = covered(block, rng.uniform(0.35, 0.65, 3), radius)
        assert (shares[..., 6] * volumes).sum() == pytest.approx(4 / 3 * np.pi * radius**3, rel=1e-13)


@pytest.mark.parametrize("radius", [1.0, np.sqrt(2.0), 2.0, np.sqrt(5.0), 3.0, np.sqrt(12.0), 5.0])
@pytest.mark.parametrize("middle", [(0.0, 0.0, 0.0), (0.5, 0.5, 0.0), (0.5, 0.5, 0.5)])
def test_surfaces_that_meet_nodes_edges_and_faces(radius, middle):
    """The ball touches planes, or runs through nodes: volume as ever, and all 48 images of a cell share it: 7e-15."""
    shares, _ = covered(Uniform(12), middle, radius)
    assert shares[..., 6].sum() == pytest.approx(4 / 3 * np.pi * radius**3, rel=1e-13)
    if middle == (0.0, 0.0, 0.0):
        V = shares[..., 6]
        for turned in (V[::-1], V[:, ::-1], V[:, :, ::-1], V.transpose(1, 2, 0), V.swapaxes(0, 1)):
            np.testing.assert_allclose(turned, V, atol=1e-12)


def test_faces_against_quadrature_and_both_their_cells():
    """Discs in rectangles by 20 000 strips: 1e-5 allowed to these; both cells of a face have the same bits."""
    block, middle, radius = graded_block(10), np.array([0.47, 0.52, 0.55]), 0.31
    shares, _ = covered(block, middle, radius)
    np.testing.assert_array_equal(shares[:-1, :, :, 1], shares[1:, :, :, 0])
    np.testing.assert_array_equal(shares[:, :-1, :, 3], shares[:, 1:, :, 2])
    np.testing.assert_array_equal(shares[:, :, :-1, 5], shares[:, :, 1:, 4])
    x, y, z = block.planes
    for i, j, k in ((3, 4, 5), (2, 5, 4), (6, 7, 4), (4, 8, 5), (5, 3, 2), (2, 6, 6)):
        s = y[j] + (y[j + 1] - y[j]) * (np.arange(20000) + 0.5) / 20000
        half = np.sqrt(np.maximum(radius**2 - (x[i] - middle[0]) ** 2 - (s - middle[1]) ** 2, 0.0))
        kept = np.minimum(middle[2] + half, z[k + 1]) - np.maximum(middle[2] - half, z[k])
        assert shares[i, j, k, 0] == pytest.approx(np.maximum(kept, 0.0).mean() / (z[k + 1] - z[k]), abs=1e-5)


def test_volumes_change_by_what_the_faces_let_through():
    """A ball 8 across moves by a tenth of a cell: V1 - V0 is the integral of its shares of faces, 6e-7 of the way with
    256 intervals of Simpson's rule (chords: 5e-3, in the root mean square)."""
    block, way, n = Uniform(12), 0.1, 256
    poses = [covered(block, (0.13 + way * m / n, 0.21, 0.07), 4.0)[0] for m in range(n + 1)]
    weights = np.array([1.0, *np.tile((4.0, 2.0), n // 2)])
    weights[-1] = 1.0
    mean = np.tensordot(weights / (3 * n), np.array(poses), 1)
    grown = poses[0][..., 6] - poses[-1][..., 6]
    off = grown - way * (mean[..., 1] - mean[..., 0])
    assert np.sqrt((off**2).mean()) < 1e-6 * way
    assert abs(off).max() < 1e-4 * way


@pytest.mark.parametrize("across", [0.02, 0.1, 0.3, 0.5, 0.8, 1.0, 1.2, 1.5, 1.7, 2.0, 3.0])
def test_small_balls_keep_their_volume(across):
    """Balls of .02 to 3 cells across at 60 places of a uniform and a graded mesh: 3e-15 measured. By chords between
    nodes one cell across lost .33 to .47 of it, half a cell .92 or more. Both cells of a face have the same bits."""
    rng = np.random.default_rng(7)
    for block, width in ((Uniform(8), 1.0), (graded_block(12), 1.0 / 12)):
        for _ in range(30):
            radius, middle = 0.5 * across * width, 0.5 * (block.planes[0][0] + block.planes[0][-1])
            shares, volumes = covered(block, middle + 1.3 * width * rng.uniform(-1, 1, 3), radius)
            assert (shares[..., 6] * volumes).sum() == pytest.approx(4 / 3 * np.pi * radius**3, rel=1e-13)
            np.testing.assert_array_equal(shares[:-1, :, :, 1], shares[1:, :, :, 0])
            np.testing.assert_array_equal(shares[:, :-1, :, 3], shares[:, 1:, :, 2])
            np.testing.assert_array_equal(shares[:, :, :-1, 5], shares[:, :, 1:, 4])


@pytest.mark.parametrize("across", [0.1, 0.5, 1.0, 1.3, 1.7])
def test_cells_cut_in_parts_are_those_of_smaller_cells_cut_whole(across):
    """Each cell and face is the sum of so many smaller ones that the ball is large among: 4e-15, at random places,
    with the centre in a plane, on an edge and at a corner, and where the ball touches planes."""
    rng, n, fine = np.random.default_rng(8), 3, 20
    places = [*rng.uniform(-0.5, 0.5, (5, 3)), (0.5, 0.1, 0.2), (0.5, 0.5, 0.2), (0.5, 0.5, 0.5), (0.0, 0.0, 0.0),
              (0.5 - 0.5 * across, 0.1, 0.0)]  # fmt: skip
    for middle in places:
        shares, _ = covered(Uniform(n), middle, 0.5 * across, parts=True)
        small = Uniform(n)
        small.planes = tuple(np.linspace(-n / 2, n / 2, n * fine + 1) for _ in range(3))
        small.shape = (n * fine,) * 3
        found = covered(small, middle, 0.5 * across, parts=False)[0]
        whole = found[..., 6].reshape(n, fine, n, fine, n, fine).mean(axis=(1, 3, 5))
        np.testing.assert_allclose(shares[..., 6], whole, atol=1e-13)
        lower = found[::fine, ..., 0].reshape(n, n, fine, n, fine).mean(axis=(2, 4))
        np.testing.assert_allclose(shares[..., 0], lower, atol=1e-13)
        upper = found[:, :, fine - 1 :: fine, 5].reshape(n, fine, n, fine, n).mean(axis=(1, 3))
        np.testing.assert_allclose(shares[..., 5], upper, atol=1e-13)


@kernel
def moments(q, radius, parts, out):
    """out (4,): volume share and first moments of what a ball about 0 covers of a cell q (3, 2)."""
    ball, shares = scratch(), np.empty(7)
    ball.q[:] = q
    cover_by_ball(ball, radius, parts, 0.0, shares)
    out[0] = shares[6]
    for d in range(3):
        out[1 + d] = moment_of_ball(ball, radius, d)


def test_where_the_covered_part_lies():
    """First moments of 40 cells are those of 20^3 small ones at their middles (8e-4 of a moment at most), and the same
    in parts as in one where both can be."""
    rng, n = np.random.default_rng(9), 20
    for _ in range(40):
        q, radius, found = np.sort(rng.uniform(-1, 1, (3, 2)), axis=1), rng.uniform(0.3, 1.2), np.empty(4)
        moments(q, radius, True, found)
        block = Uniform(n)
        block.planes = tuple(np.linspace(a, b, n + 1) for a, b in q)
        shares, volumes = covered(block, np.zeros(3), radius)
        middles = np.meshgrid(*(0.5 * (x[1:] + x[:-1]) for x in block.planes), indexing="ij")
        wanted = [(shares[..., 6] * volumes * x).sum() for x in middles]
        np.testing.assert_allclose(found[1:], wanted, atol=2e-3 * np.prod(q[:, 1] - q[:, 0]))
        if 2.0 * radius > np.linalg.norm(q[:, 1] - q[:, 0]):
            whole = np.empty(4)
            moments(q, radius, False, whole)
            np.testing.assert_allclose(whole, found, atol=1e-14)


def test_what_a_small_ball_sweeps():
    """A ball .8 of a cell across goes through a face: volumes change by what the face lets through, 5e-8 of the way."""
    block, way, n = Uniform(4), 0.9, 4096
    poses = [covered(block, (-0.45 + way * m / n, 0.21, 0.07), 0.4)[0] for m in range(n + 1)]
    weights = np.array([1.0, *np.tile((4.0, 2.0), n // 2)])
    weights[-1] = 1.0
    mean = np.tensordot(weights / (3 * n), np.array(poses), 1)
    off = poses[0][..., 6] - poses[-1][..., 6] - way * (mean[..., 1] - mean[..., 0])
    assert abs(off).max() < 1e-6 * way


def test_which_balls_are_cut_exactly():
    """Those of less than a hundred cells; cells are divided for those of less than half a cell's diagonal."""
    widths = (np.array([1.0, 2.0]), np.array([1.0]), np.array([2.0]))
    assert fits(1e-3, widths)
    assert fits(100.0, widths)
    assert not fits(101.0, widths)
    assert in_parts(1.4, widths)
    assert not in_parts(1.5, widths)
