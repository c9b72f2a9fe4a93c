"""Cells divided by sheets: parts that fill the cell, volumes and faces against hulls, what is asked once."""

import sys
from pathlib import Path

import numpy as np
import pytest

HELPERS = str(Path(__file__).parents[2] / "helpers")
if HELPERS not in sys.path:
    sys.path.insert(0, HELPERS)

from flow_solids import HalfSpace, ball, box, cylinder, exact_volume, graded_block, unit_vectors  # noqa: E402

from flowgmo.flow.favor.cell_shares import cut, divide, gather  # noqa: E402
from flowgmo.flow.favor.near_surface import near_cells, pairs_of  # noqa: E402
from flowgmo.flow.favor.sheets import is_plain, rows_of  # noqa: E402
from flowgmo.flow.favor.solid_shares import solid_shares  # noqa: E402
from flowgmo.geometry import Component, Piece, StlMesh  # noqa: E402


def gathered(block, shapes, pieces=2):
    """(Near, cells) of all cells near the shapes."""
    near = [near_cells(s.distance, block.planes, s.bounds()).cells for s in shapes]
    numbers, starts, which = pairs_of(near, block.shape)
    cells = np.column_stack(np.unravel_index(numbers, block.shape)).astype(np.int32)
    return gather(block, shapes, cells, starts, which, pieces)


@pytest.mark.parametrize("pieces", [1, 2])
@pytest.mark.parametrize("planes", [1, 2, 3, 4, 5])
def test_parts_fill_the_cell_and_its_faces(planes, pieces):
    """Random planes through one region of a graded mesh: shares of each cell and face sum to 1, measured 4e-15."""
    rng = np.random.default_rng(planes)
    block = graded_block(4, (1.0, 1.3, 0.8))
    n = unit_vectors(rng, planes)
    shapes = [HalfSpace(a, a @ rng.uniform(0.35, 0.5, 3)) for a in n]
    near = gathered(block, shapes, pieces)
    for part in range(7):
        for step in {1, pieces}:
            cell, _, share, _, _, _ = cut(near, part, step, pieces)
            np.testing.assert_allclose(np.bincount(cell, share, len(near.cells)), 1.0, atol=1e-13)
            assert (share > 0.0).all()


def test_parts_have_the_volume_of_their_hull():
    """Four planes in every cell that they reach: each part's volume against scipy's dual hull, 1e-13 of the cell."""
    rng = np.random.default_rng(3)
    block = graded_block(3)
    n = unit_vectors(rng, 4)
    shapes = [HalfSpace(a, a @ [0.5, 0.45, 0.55]) for a in n]
    near = gathered(block, shapes, 1)
    parts = divide(block, shapes, near, 6, 1, 1)
    for q in np.flatnonzero(parts.share > 1e-6)[::3]:
        i, j, k = near.cells[parts.cell[q]]
        low = np.array([block.x[i], block.y[j], block.z[k]])
        high = np.array([block.x[i + 1], block.y[j + 1], block.z[k + 1]])
        pairs = np.arange(parts.first[q], parts.first[q + 1])
        which = near.which[parts.pair[pairs]]
        side = np.where(parts.inside[pairs], 1.0, -1.0)
        h = np.array([shapes[b].h for b in which])
        exact = exact_volume(side[:, None] * n[which], side * h, low, high)
        assert parts.share[q] == pytest.approx(exact / np.prod(high - low), abs=1e-12)


@pytest.mark.parametrize("name", ["box", "cylinder", "mesh"])
def test_both_cells_of_a_face_see_the_same(name):
    """What a body covers of a face, from either cell, to 1e-13: also where other sheets run through the second one.

    Asked at centroids of chords alone, a rim gave 0 from one side and .5 from the other.
    """
    block = graded_block(9)
    shape = {
        "box": box((0.2, 0.15, 0.25), (0.5, 0.5, 0.5), (20, 30, 40)),
        "cylinder": cylinder(0.1, 0.3, (0.6, 0.5, 0.5), (50, 10, 0)),
        "mesh": Component([Piece(stl=StlMesh(*cylinder(0.2, 0.3, (0.6, 0.5, 0.5), (50, 10, 0)).triangles(6)))]),
    }[name]
    near = gathered(block, [shape])
    covered, opened = solid_shares(block, [shape], near, 2)
    assert ((covered >= 0.0) & (covered <= 1.0)).all()
    np.testing.assert_allclose(opened, 1.0 - covered, atol=1e-13)
    place = {tuple(cell): p for p, cell in enumerate(near.cells.tolist())}
    seen = 0
    for (i, j, k), p in place.items():
        for axis, (di, dj, dk) in enumerate(np.eye(3, dtype=int)):
            other = place.get((i + di, j + dj, k + dk))
            if other is not None:
                assert covered[p, 2 * axis + 1] == pytest.approx(covered[other, 2 * axis], abs=1e-13)
                seen += 1
    assert seen > 100


def test_sheets_of_bodies():
    """A ball is its own sheet; a box is six planes; a cylinder one round sheet and two planes; a mesh its facets, until
    there are too many in a cell."""
    block = graded_block(6)
    cells = np.array([[2, 3, 2], [3, 3, 2]], np.int32)
    assert is_plain(ball(0.3, (0.5, 0.5, 0.5)))
    assert is_plain(HalfSpace([1, 0, 0], 0.5))
    shape = box((0.2, 0.1, 0.3), (0.5, 0.5, 0.5), (10, 20, 30))
    assert len(shape.sheets.h) == 6
    assert not shape.sheets.curved
    np.testing.assert_allclose(np.linalg.norm(shape.sheets.n, axis=1), 1.0)
    round_one = cylinder(0.2, 0.3, (0.5, 0.5, 0.5), (10, 20, 30))
    assert len(round_one.sheets.h) == 2
    assert len(round_one.sheets.curved) == 1
    found = []
    for count in (8, 96):
        mesh = Component([Piece(stl=StlMesh(*ball(0.25, (0.5, 0.52, 0.49)).triangles(count)))])
        near = near_cells(mesh.distance, block.planes, mesh.bounds()).cells
        found.append(rows_of(mesh, block, near, 2).alone.mean())
    assert found[0] < 0.1
    assert found[1] > 0.7
    assert len(rows_of(shape, block, cells, 2).cell) > 0
