"""A plane in a cell: volumes against sampling and each other, both ends, distances, the polygon."""

import numpy as np
import pytest

from flowgmo.flow.surface import plic
from flowgmo.kernel import kernel


@kernel
def offsets(m, F, alpha, back):
    for i in range(len(F)):
        n = (m[i, 0], m[i, 1], m[i, 2])
        alpha[i] = plic.plane_offset(n, F[i])
        back[i] = plic.volume_under(n, alpha[i])


@kernel
def slab(m, alpha, d, low, high):
    return plic.share_of_slab(m, alpha, d, low, high)


@kernel
def distance(m, alpha, widths, point):
    return plic.signed_distance(m, alpha, widths, point)


@kernel
def cross(m, alpha, d):
    return plic.crossing(m, alpha, d)


@kernel
def corners(m, alpha, out):
    return plic.polygon(m, alpha, out)


def vectors(n, seed=3):
    """Normals of all kinds: any direction, along axes and planes, equal components, 18 decades between components."""
    rng = np.random.default_rng(seed)
    m = rng.normal(size=(n, 3))
    m[: n // 2] *= 10.0 ** rng.uniform(-18, 0, (n // 2, 3))
    m[::10, 0] = 0.0
    m[::15, 1] = 0.0
    m[3::20, 2] = m[3::20, 1]
    m[4::20] = np.sign(m[4::20])
    return m


def test_offset_and_volume_are_inverse_to_round_off():
    """4.4e-16 measured over 1e6. A formula as printed loses 1e-8 where one component is small."""
    rng = np.random.default_rng(1)
    m = vectors(20000)
    F = np.concatenate(
        [rng.uniform(size=10000), 10.0 ** rng.uniform(-17, 0, 5000), 1 - 10.0 ** rng.uniform(-15, 0, 5000)]
    )
    rng.shuffle(F)
    F[:2] = 0.0, 1.0
    alpha, back = np.empty_like(F), np.empty_like(F)
    offsets(m, F, alpha, back)
    assert np.abs(back - F).max() <= 1e-15
    assert (back[F == 0] == 0).all() and (back[F == 1] == 1).all()


def test_small_fractions_keep_their_digits():
    """All components positive: nothing is mirrored, and F of 1e-300 comes back to 1e-13 of itself."""
    m = np.abs(vectors(3000)[::2]) + 1e-3
    F = 10.0 ** np.random.default_rng(2).uniform(-250, -1, len(m))
    alpha, back = np.empty_like(F), np.empty_like(F)
    offsets(m, F, alpha, back)
    assert np.abs(back / F - 1).max() <= 1e-13


def test_volume_is_the_one_of_points_under_the_plane():
    """Midpoints, 40^3: within 1e-3 of the sampled share (its own error, 6e-4 measured)."""
    m = vectors(60)[30:]
    F = np.random.default_rng(5).uniform(size=len(m))
    alpha, back = np.empty_like(F), np.empty_like(F)
    offsets(m, F, alpha, back)
    x = (np.arange(40) + 0.5) / 40
    X = np.stack(np.meshgrid(x, x, x, indexing="ij"), -1).reshape(-1, 3)
    generic = np.abs(m).min(1) > 1e-2
    for n, a, f in zip(m[generic], alpha[generic], F[generic], strict=True):
        assert (X @ n <= a).mean() == pytest.approx(f, abs=3e-3)


def test_slabs_add_up_to_the_cell_and_follow_the_plane():
    rng = np.random.default_rng(7)
    for m in vectors(200)[100:]:
        m = tuple(m)
        alpha, back = np.empty(1), np.empty(1)
        offsets(np.array([m]), rng.uniform(size=1), alpha, back)
        d, cut = rng.integers(3), rng.uniform()
        parts = cut * slab(m, alpha[0], d, 0.0, cut) + (1 - cut) * slab(m, alpha[0], d, cut, 1.0)
        assert parts == pytest.approx(back[0], abs=2e-15)
    # level water to .3 of the cell: none in the upper half, all in the lower fifth, .6 of the lower half
    assert slab((0.0, 0.0, 1.0), 0.3, 2, 0.5, 1.0) == 0.0
    assert slab((0.0, 0.0, 1.0), 0.3, 2, 0.0, 0.2) == 1.0
    assert slab((0.0, 0.0, 2.0), 0.6, 2, 0.0, 0.5) == pytest.approx(0.6, abs=1e-15)
    assert slab((0.0, 0.0, -1.0), -0.3, 2, 0.0, 0.5) == pytest.approx(0.4, abs=1e-15)


def test_distance_is_in_space_whatever_the_shape_of_the_cell():
    """A plane through a corner of a 1 x 2 x 4 cell with unit normal (2, -3, 6)/7."""
    n, widths, point = np.array([2, -3, 6]) / 7, np.array([1.0, 2.0, 4.0]), np.array([0.3, 1.1, 2.0])
    there = np.array([0.5, 0.5, 3.0])
    got = distance(tuple(n * widths), float(n @ point), tuple(widths), tuple(there))
    assert got == pytest.approx(n @ (there - point), abs=1e-15)
    assert distance((0.0, 0.0, 0.0), 0.0, (1.0, 1.0, 1.0), (0.0, 0.0, 0.0)) == np.inf


def test_crossing_lies_on_the_plane():
    m, alpha = (0.3, -0.5, 0.2), 0.1
    for d in range(3):
        at = np.full(3, 0.5)
        at[d] += cross(m, alpha, d)
        assert np.dot(m, at) == pytest.approx(alpha, abs=1e-15)
    assert cross((1.0, 0.0, 0.0), 0.3, 1) == np.inf
    assert cross((0.0, 0.0, -1.0), -0.25, 2) == -0.25


def test_polygon_has_the_plane_the_cell_and_the_slope_of_the_volume():
    """Corners on the plane and in the cell; area / |m| is dF/dalpha (finite difference, 1e-6)."""
    rng, out = np.random.default_rng(4), np.empty((8, 3))
    for m in rng.normal(size=(300, 3)):
        F = rng.uniform(0.02, 0.98, 1)
        alpha, back = np.empty(1), np.empty(1)
        offsets(m[None], F, alpha, back)
        n = corners(tuple(m), alpha[0], out)
        p = out[:n]
        assert 3 <= n <= 6
        assert np.abs(p @ m - alpha[0]).max() <= 1e-13
        assert p.min() >= -1e-14 and p.max() <= 1 + 1e-14
        area = 0.5 * np.linalg.norm(sum(np.cross(p[i] - p[0], p[i + 1] - p[0]) for i in range(1, n - 1)))
        e = 1e-5
        slope = (slab(tuple(m), alpha[0] + e, 0, 0.0, 1.0) - slab(tuple(m), alpha[0] - e, 0, 0.0, 1.0)) / (2 * e)
        assert area / np.linalg.norm(m) == pytest.approx(slope, rel=2e-4)
    assert corners((1.0, 2.0, 0.5), 9.0, out) == 0


def test_scaling_by_powers_of_two_changes_no_bit():
    m, F = vectors(500), np.random.default_rng(6).uniform(size=500)
    a, b, back, again = (np.empty(500) for _ in range(4))
    offsets(m, F, a, back)
    offsets(m * 2.0**40, F, b, again)
    assert (b == a * 2.0**40).all() and (back == again).all()
