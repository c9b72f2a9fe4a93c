"""Planes of the mesh, sides, bounds."""

import numpy as np
import pytest

from flowgmo.mesh import CONTINUATIVE, SYMMETRY, WALL, Block, Mesh, Side, graded_planes


def test_uniform_cells_through_several_anchors():
    planes = graded_planes(np.array([0.0, 1.0, 4.0]), [4, 3], [None, None, None])
    np.testing.assert_allclose(planes, [0, 0.25, 0.5, 0.75, 1, 2, 3, 4], atol=1e-15)


@pytest.mark.parametrize("n, first, last", [(7, 0.1, 0.4), (20, 0.5, 0.02), (2, 0.3, 0.6)])
def test_both_sizes_given_keep_their_ratio(n, first, last):
    """Geometric: constant ratio of neighbours, whole length exact, end cells in the ratio asked for."""
    planes = graded_planes(np.array([-1.0, 2.0]), [n], [first, last])
    widths = np.diff(planes)
    assert planes[0] == -1.0 and planes[-1] == 2.0 and len(widths) == n
    np.testing.assert_allclose(widths[-1] / widths[0], last / first, rtol=1e-9)
    np.testing.assert_allclose(widths[1:] / widths[:-1], widths[1] / widths[0], rtol=1e-9)


@pytest.mark.parametrize("given", ["first", "last"])
@pytest.mark.parametrize("size", [0.01, 0.1, 0.3])
def test_one_size_given_is_met(given, size):
    """Measured: 1e-12."""
    sizes = [size, None] if given == "first" else [None, size]
    widths = np.diff(graded_planes(np.array([0.0, 1.0]), [8], sizes))
    assert widths[0 if given == "first" else -1] == pytest.approx(size, rel=1e-9)
    assert widths.sum() == pytest.approx(1.0, rel=1e-14)
    assert np.all(widths > 0)


def test_bounds_cells_and_sides():
    sides = tuple(Side(k, kind) for k, kind in enumerate((SYMMETRY, WALL, CONTINUATIVE, 5, 6, 8)))
    block = Block(np.array([0.0, 1.0, 3.0]), np.array([-1.0, 1.0]), np.array([2.0, 3.0, 4.0, 5.0]), neighbours=sides)
    mesh = Mesh((block,), sides)
    assert block.shape == (2, 1, 3) and mesh.cells == 6
    np.testing.assert_array_equal(mesh.bounds, [[0, -1, 2], [3, 1, 5]])
    assert [side.stops_bodies for side in sides] == [True, True, False, False, False, False]
    assert sides[4].name == "Zmin"
