"""Walls thinner than a cell separate, whatever their thickness, place and direction."""

import sys
from pathlib import Path

import numpy as np
import pytest

HELPERS = str(Path(__file__).parents[2] / "helpers")
if HELPERS not in sys.path:
    sys.path.insert(0, HELPERS)

from flow_solids import ball, box, connected, graded_block, middles  # noqa: E402

from flowgmo.flow.favor.cut_pairs import cut_pairs  # noqa: E402
from flowgmo.flow.favor.fractions import open_fractions  # noqa: E402
from flowgmo.flow.favor.near_surface import near_cells  # noqa: E402
from flowgmo.flow.favor.shares import wall_areas  # noqa: E402
from flowgmo.flow.fields import grid_of  # noqa: E402
from flowgmo.geometry import Component, Limits, Piece, Transform  # noqa: E402

CELL = 1 / 12


@pytest.mark.parametrize("pieces", [1, 2])
@pytest.mark.parametrize("thickness", [1e-6, 0.05, 0.3, 0.6, 0.9, 1.2, 1.6])
def test_a_plate_does_not_leak(thickness, pieces):
    """Straight along the mesh, at 45 degrees, and in any direction: both sides are never joined by open faces.

    Of the 8 plates of each row, without the search for crossed edges 4 to 8 leak up to 0.9 (pieces 1) or 0.3 (2), and
    without the groups of nodes 5 to 8 of every thickness.
    """
    rng = np.random.default_rng(7)
    block = graded_block(12)
    x, divided = middles(block), 0
    turns = [(0, 0, 0), (0, 90, 0), (0, 45, 0), (35.264, 0, 45), *rng.uniform(-90, 90, (4, 3))]
    for turn in turns:
        at = 0.5 + rng.uniform(-0.5, 0.5, 3) * CELL
        plate = box((3, 3, 0.5 * thickness * CELL), at, turn)
        solids = open_fractions(block, [plate], pieces)
        label, side = connected(solids.open), (x - at) @ plate.solids[0].R[:, 2]
        far = (1.2 + 0.5 * thickness) * CELL * 1.3  # the widest cells are 1.3 times as wide
        above, below = label[side > far], label[side < -far]
        assert len(above)
        assert len(below)
        assert not np.intersect1d(above, below).size
        divided += solids.lost.divided
    assert divided > 0


@pytest.mark.parametrize("pieces", [1, 2])
@pytest.mark.parametrize("thickness", [0.01, 0.05, 0.3, 0.7])
def test_a_shell_holds_its_inside(thickness, pieces):
    """A hollow ball 5 cells in radius: curved, so that the first guess of where it crosses an edge may miss it.

    Its walls close as well: constant pressure inside and outside give no force, 2e-16.
    """
    block, at = graded_block(16), np.array([0.5, 0.51, 0.49])
    limits = Limits(sphere=(0.3 - thickness / 32, 0.3 + thickness / 32))
    shell = Component([Piece(limits=limits, transform=Transform(translate=tuple(at)))])
    solids = open_fractions(block, [shell], pieces)
    label, r = connected(solids.open), np.linalg.norm(middles(block) - at, axis=-1)
    assert not np.intersect1d(label[r < 0.2], label[r > 0.4]).size
    assert np.abs(wall_areas(solids.shares[0], grid_of(block)).sum(0)).max() < 1e-15
    inside = wall_areas(solids.shares[0], grid_of(block))[connected_cells(solids, label, r < 0.2)]
    assert len(inside)
    assert np.abs(inside.sum(0)).max() < 1e-15


def connected_cells(solids, label, where):
    """Of the first solid's cells those that are joined to the cells `where`."""
    return np.isin(label[tuple(solids.shares[0].cells.T - 2)], np.unique(label[where]))


@pytest.mark.parametrize("pieces", [1, 2])
def test_smooth_solids_are_not_divided(pieces):
    """A ball in four places: one cell, where it pokes through an edge, is divided; it loses 1e-7 of the domain."""
    rng = np.random.default_rng(1)
    for _ in range(4):
        solids = open_fractions(graded_block(14), [ball(0.3, rng.uniform(0.4, 0.6, 3))], pieces)
        assert solids.lost.divided <= 1
        assert abs(solids.lost.thin) < 1e-6


def test_every_open_cell_and_face_is_still_whole():
    """Where a plate stands on the mesh: V and A in range, shares and open parts sum to one."""
    solids = open_fractions(graded_block(12), [box((3, 3, 0.3 * CELL), (0.5, 0.5, 0.5), (20, 30, 0))])
    V, *areas = solids.open
    s = solids.shares[0]
    at = tuple(s.cells.T)
    for axis, A in enumerate(areas):
        np.testing.assert_allclose(A[at] + s.faces[:, 2 * axis + 1], 1.0, atol=1e-15)
        np.testing.assert_allclose(np.roll(A, 1, axis)[at] + s.faces[:, 2 * axis], 1.0, atol=1e-15)
    assert ((V >= 0) & (V <= 1)).all()


def test_a_face_of_two_pockets_is_one_share():
    """A slanting plate: a divided cell and its neighbour leave the same of their face open, 1e-14, though each keeps
    its own side; closed where they keep opposite sides, and no more than the plate itself leaves anywhere."""
    plate, block = box((3, 3, 0.15 * CELL), (0.5, 0.51, 0.49), (20, 30, 0)), graded_block(12)
    near = near_cells(plate.distance, block.planes, plate.bounds())
    cut = cut_pairs(block, [plate.distance], [near.cells], 2, shapes=[plate])
    bare = cut_pairs(block, [plate.distance], [near.cells], 2, thin=False, shapes=[plate])
    assert cut.divided > 50
    assert (cut.opened <= bare.opened + 1e-12).all()
    at = {tuple(cell): row for row, cell in enumerate(cut.cells.tolist())}
    divided = cut.opened[:, 6] < bare.opened[:, 6] - 1e-9
    shares = []
    for cell, row in at.items():
        for axis in range(3):
            other = at.get(tuple(x + (a == axis) for a, x in enumerate(cell)), row)
            if divided[row] and divided[other] and other != row:
                shares.append((cut.opened[row, 2 * axis + 1], cut.opened[other, 2 * axis]))
    one, two = np.array(shares).T
    assert len(one) > 50
    np.testing.assert_allclose(one, two, atol=1e-14)
    assert (one == 0.0).any()
    assert ((one > 0.0) & (one < 1.0)).any()


@pytest.mark.parametrize("turn", [(0, 0, 0), (0, 0, 30), (20, 30, 40), (-50, 70, 10)])
def test_two_boxes_that_touch_are_one(turn):
    """No notch where they meet, within cells: V and A of both are those of the whole box, 6e-15."""
    block, at = graded_block(12), np.array([0.47, 0.53, 0.51])
    whole = box((0.3, 0.2, 0.15), at, turn)
    along = whole.solids[0].R[:, 0]
    for cut in (-0.11, 0.0, 0.043):
        parts = [box(((0.3 - s * cut) / 2, 0.2, 0.15), at + along * (cut + s * 0.3) / 2, turn) for s in (1, -1)]
        for one, two in zip(open_fractions(block, [whole]).open, open_fractions(block, parts).open, strict=True):
            np.testing.assert_allclose(two, one, atol=1e-13)
