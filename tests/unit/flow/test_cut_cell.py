"""Cutting a cell: exact for planes, closed, and the two ways (closed form, polygons) are one."""

import sys
from pathlib import Path

import numpy as np
import pytest

HELPERS = str(Path(__file__).parents[2] / "helpers")
if HELPERS not in sys.path:
    sys.path.insert(0, HELPERS)

from flow_solids import exact_volume, unit_vectors  # noqa: E402

from flowgmo.flow.favor.cut_cell import volumes_where_positive  # noqa: E402

CORNERS = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)], float)


def fields(normals, offsets):
    """Values (planes, 8) of h - n . x at the corners of the unit cell."""
    return offsets[:, None] - normals @ CORNERS.T


@pytest.mark.parametrize("planes", [1, 2, 3, 5])
def test_planes_are_exact(planes):
    """Measured 9e-16 against the dual hull of scipy: a wrong wall, or a cut in the wrong order, gives 1e-2."""
    rng = np.random.default_rng(planes)
    for _ in range(40):
        n = unit_vectors(rng, planes)
        h = (n * rng.uniform(0.2, 0.8, (planes, 3))).sum(1)
        found = volumes_where_positive(fields(n, h)[None])[0]
        assert found == pytest.approx(exact_volume(n, h), abs=1e-13)


def test_planes_through_corners_edges_and_faces():
    """Values of exactly 0 at the corners: halves, sixths, nothing, everything."""
    cases = [
        ([1, 0, 0], 0.5, 1 / 2), ([1, 0, 0], 1.0, 1.0), ([1, 0, 0], 0.0, 0.0), ([1, 1, 0], 1.0, 1 / 2),
        ([1, 1, 1], 1.0, 1 / 6), ([1, 1, 1], 2.0, 5 / 6), ([1, 1, 1], 1.5, 1 / 2), ([1, 0, -1], 0.0, 1 / 2),
        ([0, 1, 1], 0.0, 0.0), ([0, -1, 1], 1.0, 1.0),
    ]  # fmt: skip
    for n, h, volume in cases:
        f = fields(np.array([n], float), np.array([h]))
        assert volumes_where_positive(f[None])[0] == pytest.approx(volume, abs=1e-15)
        twice = np.concatenate([f, f])[None]
        assert volumes_where_positive(twice)[0] == pytest.approx(volume, abs=1e-15)


def test_closed_form_and_polygons_are_the_same_figure():
    """Any corner values, also those whose surface is no plane; a second field makes the general way run. 7e-16."""
    rng = np.random.default_rng(3)
    f = rng.normal(size=(3000, 1, 8))
    nearly_all = np.full((3000, 1, 8), 2.0)
    nearly_all[:, 0, 1] = -1e-13
    np.testing.assert_allclose(
        volumes_where_positive(f), volumes_where_positive(np.concatenate([f, nearly_all], axis=1)), atol=1e-12
    )


def test_liquid_and_what_is_not_liquid_fill_the_open_part():
    """|a > 0, b > 0| + |a > 0, b < 0| = |a > 0| for planes a and b, and mirrored cells have the same volume: 4e-16."""
    rng = np.random.default_rng(4)
    n = unit_vectors(rng, 1000).reshape(500, 2, 3)
    h = (n * rng.uniform(0.2, 0.8, n.shape)).sum(2)
    f = h[:, :, None] - n @ CORNERS.T
    both = volumes_where_positive(f)
    rest = volumes_where_positive(f * np.array([1.0, -1.0])[:, None])
    np.testing.assert_allclose(both + rest, volumes_where_positive(f[:, :1]), atol=2e-15)
    for order in ([4, 5, 6, 7, 0, 1, 2, 3], [2, 3, 0, 1, 6, 7, 4, 5], [1, 0, 3, 2, 5, 4, 7, 6]):
        np.testing.assert_allclose(volumes_where_positive(f[:, :, order]), both, atol=2e-15)
    np.testing.assert_array_equal(volumes_where_positive(1024.0 * f), both)


def test_any_values_give_a_share():
    """Alternating signs, five fields, infinities of size: within 0 and 1, never NaN."""
    rng = np.random.default_rng(5)
    f = rng.normal(size=(2000, 5, 8)) * 10.0 ** rng.integers(-200, 200, (2000, 5, 1))
    f[:500] = np.where((np.indices((2, 2, 2)).sum(0).ravel() % 2).astype(bool), 1.0, -1.0) * np.abs(f[:500])
    v = volumes_where_positive(f)
    assert ((v >= 0.0) & (v <= 1.0)).all()
