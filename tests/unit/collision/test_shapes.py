"""Frames, supports, and facing parts of pieces, against their definitions."""

import numpy as np
import pytest
from convex_pieces import matrix, one_of_each, piece, reference_support, turn

from flowgmo.collision.faces import ROWS, support_face
from flowgmo.collision.shapes import BOX, ELLIPSOID, FRUSTUM, feature_support, feature_turn, height, place, support
from flowgmo.kernel import kernel

KINDS, VERTICES = one_of_each(np.random.default_rng(0))
BOUNDED = [k for k in KINDS if k != "floor"]


@kernel
def frame_of(pieces, p, q):
    return place(pieces[0], p, q)


@kernel
def support_of(pieces, vertices, p, q, d):
    frame = place(pieces[0], p, q)
    return support(pieces[0], vertices, frame, d), height(pieces[0], vertices, frame, d)


@kernel
def face_of(pieces, vertices, p, q, d, tolerance, out):
    return support_face(pieces[0], vertices, place(pieces[0], p, q), d, tolerance, out)


@kernel
def feature_of(pieces, x, d, e):
    return feature_support(pieces[0], x, d), feature_turn(pieces[0], x, d, e)


def unit(rng):
    d = rng.normal(size=3)
    return d / np.linalg.norm(d)


def test_a_frame_carries_centre_and_axes_along():
    """Piece to body to space. Measured: 4e-16."""
    rng = np.random.default_rng(1)
    for _ in range(50):
        p = piece(BOX, (1, 2, 3))
        axes, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        centre, at, q = rng.normal(size=3), rng.normal(size=3), turn(rng)
        p["axes"], p["centre"] = axes, centre
        f = np.array(frame_of(p, tuple(at), tuple(q)))
        np.testing.assert_allclose(f[:3], at + matrix(q) @ centre, atol=1e-14)
        np.testing.assert_allclose(f[3:].reshape(3, 3), axes @ matrix(q).T, atol=1e-14)


@pytest.mark.parametrize("name", BOUNDED)
def test_support_is_the_farthest_point(name):
    """Against its definition, and its height above the centre. Measured: 4e-16."""
    rng = np.random.default_rng(2)
    for _ in range(50):
        at, q, d = rng.normal(size=3), turn(rng), unit(rng)
        x, h = support_of(KINDS[name], VERTICES, tuple(at), tuple(q), tuple(d))
        np.testing.assert_allclose(x, reference_support(KINDS[name][0], VERTICES, np.array([*at, *q]), d), atol=1e-14)
        assert h == pytest.approx((np.array(x) - at) @ d, abs=1e-14)
        assert np.linalg.norm(np.array(x) - at) <= KINDS[name]["reach"][0] * (1 + 1e-14)


@pytest.mark.parametrize("name", BOUNDED)
def test_a_facing_part_lies_within_its_tolerance(name):
    """Every point is one of the piece, no lower than the tolerance, and one of them the highest; boxes' and polytopes'
    corners are taken axis by axis."""
    rng = np.random.default_rng(3)
    out = np.zeros((ROWS, 4))
    for _ in range(100):
        at, q, tolerance = rng.normal(size=3), turn(rng), 10.0 ** rng.uniform(-9, -1)
        near_axis = np.eye(3)[rng.integers(3)] * rng.choice([-1, 1]) + rng.normal(size=3) * 10.0 ** rng.uniform(-10, 0)
        d = matrix(q) @ (near_axis / np.linalg.norm(near_axis))
        count = face_of(KINDS[name], VERTICES, tuple(at), tuple(q), tuple(d), tolerance, out)
        assert 1 <= count <= 8
        top = reference_support(KINDS[name][0], VERTICES, np.array([*at, *q]), d) @ d
        heights = out[:count, :3] @ d
        assert heights.max() == pytest.approx(top, abs=1e-14)
        sides = 2 if name in ("box", "brick", "round box") else 1  # a box's corners are taken axis by axis
        assert heights.min() >= top - sides * tolerance - 1e-14
        for m in (unit(rng) for _ in range(10)):
            h = reference_support(KINDS[name][0], VERTICES, np.array([*at, *q]), m) @ m
            assert (out[:count, :3] @ m).max() <= h + 1e-14
        assert len(set(out[:count, 3])) == count


@pytest.mark.parametrize(
    ("size", "tilt", "count"), [((0.5, 0.5, 1), 0, 8), ((0.5, 0.0, 1), 0, 1), ((0.5, 0.5, 1), 90, 2)]
)
def test_caps_tips_and_lines(size, tilt, count):
    """Up the axis a cylinder shows eight points of its rim, evenly spread, a cone its tip; across, a line."""
    out = np.zeros((ROWS, 4))
    d = (np.sin(np.radians(tilt)), 0.0, np.cos(np.radians(tilt)))
    assert face_of(piece(FRUSTUM, size), VERTICES, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0), d, 1e-6, out) == count
    if count == 8:
        steps = np.linalg.norm(np.roll(out[:8, :3], 1, axis=0) - out[:8, :3], axis=1)
        np.testing.assert_allclose(steps, 2 * 0.5 * np.sin(np.pi / 8), atol=1e-15)


@pytest.mark.parametrize("kind", [ELLIPSOID, FRUSTUM])
def test_curvature_is_the_change_of_the_support(kind):
    """feature_turn against central differences of feature_support. Measured: 2e-8, the differences' own error."""
    rng = np.random.default_rng(4)
    p = piece(kind, (0.6, 0.9, 0.4))
    for _ in range(50):
        d = unit(rng)
        e = np.cross(d, unit(rng))
        x = tuple(reference_support(p[0], VERTICES, np.array([0, 0, 0, 1.0, 0, 0, 0]), d))
        _, change = feature_of(p, x, tuple(d), tuple(e))
        ends = []
        for h in (1e-5, -1e-5):
            m = d + h * e
            ends.append(np.array(feature_of(p, x, tuple(m / np.linalg.norm(m)), tuple(e))[0]))
        np.testing.assert_allclose(change, (ends[0] - ends[1]) / 2e-5, atol=1e-7)
