"""The plane of the solid in a cell: exact for plane walls, second order for curved ones."""

import sys
from pathlib import Path

import numpy as np
import pytest

HELPERS = str(Path(__file__).parents[2] / "helpers")
if HELPERS not in sys.path:
    sys.path.insert(0, HELPERS)

from flow_solids import HalfSpace, ball, exact_volume, graded_block, unit_vectors  # noqa: E402

from flowgmo.flow.favor.fractions import open_fractions  # noqa: E402
from flowgmo.flow.favor.solid_planes import depth_of_volume, solid_planes  # noqa: E402
from flowgmo.flow.fields import Open, grid_of  # noqa: E402
from flowgmo.kernel import kernel  # noqa: E402


@kernel
def depths(m, volumes):
    out = np.empty(len(volumes))
    for i in range(len(volumes)):
        out[i] = depth_of_volume(m[i, 0], m[i, 1], m[i, 2], volumes[i])
    return out


def test_depth_of_volume_against_exact_volumes():
    """The plane at the depth cuts off the volume, 4e-15, with one or two components 0 or tiny, at any volume."""
    rng = np.random.default_rng(0)
    m = np.abs(unit_vectors(rng, 120))
    m[:20, 0], m[20:30, :2], m[30:40, 1] = 0.0, 0.0, 1e-9
    m /= m.sum(1)[:, None]
    volumes = rng.uniform(0.0, 1.0, 120)
    volumes[40:50] = 10.0 ** rng.uniform(-6, -2, 10)
    for mi, v, alpha in zip(m, volumes, depths(m, volumes), strict=True):
        assert exact_volume([mi / np.linalg.norm(mi)], [alpha / np.linalg.norm(mi)]) == pytest.approx(v, abs=1e-11)
    np.testing.assert_array_equal(depths(m, np.zeros(120)), 0.0)
    np.testing.assert_array_equal(depths(m, np.ones(120)), 1.0)
    np.testing.assert_allclose(depths(m, np.full(120, 0.5)), 0.5, atol=1e-15)


def test_plane_walls_are_found_exactly():
    """Normal and distance in every cell whose wall is not of rounding size, on a graded mesh: 2e-9 in the smallest."""
    block = graded_block(10, (1.0, 1.2, 0.7))
    middle = [0.5 * (p[1:] + p[:-1]) for p in block.planes]
    for n in [*unit_vectors(np.random.default_rng(2), 4), np.array([0, 0, 1.0]), np.array([0, -1.0, 0])]:
        h = n @ [0.47, 0.63, 0.33]
        fractions = open_fractions(block, [HalfSpace(n, h)], least=0.0, lone=0.0).open
        cells, planes = solid_planes(fractions, grid_of(block))
        assert len(cells) >= 90
        x = np.column_stack([c[cells[:, k] - 2] for k, c in enumerate(middle)])
        V = fractions.V[tuple(cells.T)]
        thick = (V > 1e-6) & (V < 1 - 1e-6)
        np.testing.assert_allclose(planes[thick, :3], np.broadcast_to(n, (thick.sum(), 3)), atol=1e-9)
        np.testing.assert_allclose(planes[thick, 3], (h - x @ n)[thick], atol=1e-10)


def test_planes_of_a_ball_converge():
    """Normals to first order at least, positions to second: measured means 1.3e-2, 6.3e-3 and 1.7e-3, 4.2e-4 of R."""
    errors = []
    for cells in (20, 40):
        block = graded_block(cells)
        at = np.array([0.5, 0.52, 0.49])
        fractions = open_fractions(block, [ball(0.25, at)]).open
        c, planes = solid_planes(fractions, grid_of(block))
        middle = [0.5 * (p[1:] + p[:-1]) for p in block.planes]
        r = np.column_stack([x[c[:, k] - 2] for k, x in enumerate(middle)]) - at
        foot = r + planes[:, 3:] * planes[:, :3]
        radial = r / np.linalg.norm(r, axis=1)[:, None]
        errors.append(
            [np.linalg.norm(planes[:, :3] - radial, axis=1).mean(), np.abs(np.linalg.norm(foot, axis=1) - 0.25).mean()]
        )
    (n1, d1), (n2, d2) = errors
    assert n1 / n2 > 1.8
    assert d1 / d2 > 3.5


def test_none_without_solids():
    assert len(solid_planes(Open(None, None, None, None), grid_of(graded_block(4))).cells) == 0
