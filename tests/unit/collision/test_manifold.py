"""Contact points: scenes whose points are known, and identities for random pairs."""

from itertools import combinations

import numpy as np
import pytest
from convex_pieces import NOTHING, bring_to, hole, matrix, one_of_each, piece, separate, touching, two

from flowgmo.collision.shapes import BOX, CAVITY, FRUSTUM, HALF_SPACE, POINT, POLYTOPE

KINDS, VERTICES = one_of_each(np.random.default_rng(0))
UP = (0.0, 0.0, 1.0)
CUBE = piece(BOX, (0.5, 0.5, 0.5))
ROD = piece(FRUSTUM, (0.5, 0.5, 1.0), reach=1.25)
FLOOR = piece(HALF_SPACE)


def axis_turn(axis, angle):
    q = np.zeros(4)
    q[0], q[1 + axis] = np.cos(angle / 2), np.sin(angle / 2)
    return q


def points_of(a, b, n=UP, at=NOTHING, q=(1, 0, 0, 0), q_b=(1, 0, 0, 0), within=1e-3):
    pieces, poses = two(a, b, at=at)
    poses[0, 3:], poses[1, 3:] = q, q_b
    return touching(pieces, VERTICES, poses, n, within)


def rows(c):
    """Points and gaps, sorted, to compare sets."""
    x = np.column_stack([c["point"], c["gap"]])
    return x[np.lexsort(np.round(x, 9).T)]


def test_shifted_boxes_touch_on_the_rectangle_in_common():
    c = points_of(CUBE, CUBE, at=(0.3, -0.2, 1.0 + 1e-5))
    expected = [[x, y, 0.5 + 5e-6, 1e-5] for y in (-0.5, 0.3) for x in (-0.2, 0.5)]
    np.testing.assert_allclose(rows(c), rows_of(expected), atol=1e-15)
    assert len(set(c["feature"])) == 4


def rows_of(x):
    x = np.array(x, float)
    return x[np.lexsort(np.round(x, 9).T)]


def test_turned_boxes_touch_on_an_octagon():
    c = points_of(CUBE, CUBE, at=(0, 0, 1.0), q=axis_turn(2, np.pi / 4))
    assert len(c) == 8
    t = 2**0.5 / 2 - 0.5
    np.testing.assert_allclose(np.sort(abs(c["point"][:, :2]), axis=1), [[t, 0.5]] * 8, atol=1e-15)


def test_bricks_that_lie_exactly_on_each_other_have_four_points():
    """Sides on sides within round-off make no extra corners, and their numbers do not flicker."""
    rng = np.random.default_rng(0)
    seen = set()
    for _ in range(50):
        c = points_of(CUBE, CUBE, at=(*rng.normal(size=2) * 1e-15, 1.0))
        assert len(c) == 4
        seen.add(tuple(sorted(c["feature"])))
    assert len(seen) == 1


@pytest.mark.parametrize(("angle", "count"), [(0.0, 4), (5e-4, 4), (2e-2, 2), (np.pi / 4, 2)])
def test_a_tilted_box_on_the_floor(angle, count):
    """All corners with a gap within 1e-3, each with its own gap."""
    h = 0.5 * (np.sin(angle) + np.cos(angle))
    c = points_of(CUBE, FLOOR, at=(0.2, 0.1, h), q=axis_turn(0, angle))
    assert len(c) == count
    gaps = np.repeat([0.0, np.sin(angle)], 2)[:count]
    np.testing.assert_allclose(np.sort(c["gap"]), gaps, atol=1e-15)
    np.testing.assert_allclose(c["point"][:, 2], c["gap"] / 2, atol=1e-15)


def test_a_box_on_its_edge_and_corner():
    edge = points_of(CUBE, CUBE, at=(0, 0, 0.5 + 0.5**0.5), q=axis_turn(0, np.pi / 4))
    np.testing.assert_allclose(rows(edge), rows_of([[-0.5, 0, 0.5, 0], [0.5, 0, 0.5, 0]]), atol=1e-15)
    q = np.array(
        [np.cos(0.5 * np.arccos(3**-0.5)), *(np.sin(0.5 * np.arccos(3**-0.5)) * np.array([1, -1, 0]) / 2**0.5)]
    )
    down = matrix(q) @ np.ones(3)
    q = q if abs(down[2]) > 1.7 else q * (1, -1, -1, 1)
    corner = points_of(CUBE, CUBE, at=(0, 0, 0.5 + 0.75**0.5), q=q)
    np.testing.assert_allclose(rows(corner), [[0, 0, 0.5, 0]], atol=1e-15)


def test_edges_on_edges():
    """Crossed: one point; parallel: the two ends of what they have in common."""
    turned = axis_turn(0, np.pi / 4)
    crossed = points_of(CUBE, CUBE, at=(0.1, 0.2, 2**0.5), q=turned, q_b=axis_turn(1, np.pi / 4))
    np.testing.assert_allclose(rows(crossed), [[0, 0.2, 0.5**0.5, 0]], atol=1e-15)
    parallel = points_of(CUBE, CUBE, at=(0.3, 0, 2**0.5), q=turned, q_b=turned)
    np.testing.assert_allclose(rows(parallel), rows_of([[-0.2, 0, 0.5**0.5, 0], [0.5, 0, 0.5**0.5, 0]]), atol=1e-15)


@pytest.mark.parametrize("below", ["floor", "box"])
def test_a_cylinder_on_a_plane(below):
    """On its side two points, on its cap eight of the rim, at 45 degrees one."""
    plane, h = (FLOOR, 0.0) if below == "floor" else (piece(BOX, (3.0, 3.0, 0.5)), 0.5)
    side = points_of(ROD, plane, at=(0, 0, h + 0.5), q=axis_turn(0, np.pi / 2))
    np.testing.assert_allclose(rows(side), rows_of([[0, -1, h, 0], [0, 1, h, 0]]), atol=1e-15)
    cap = points_of(ROD, plane, at=(0, 0, h + 1))
    assert len(cap) == 8
    np.testing.assert_allclose(np.linalg.norm(cap["point"][:, :2], axis=1), 0.5, atol=1e-15)
    np.testing.assert_allclose(cap["point"].mean(axis=0), (0, 0, h), atol=1e-15)
    rim = points_of(ROD, plane, at=(0, 0, h + 1.5 * 0.5**0.5), q=axis_turn(0, np.pi / 4))
    np.testing.assert_allclose(rows(rim), [[0, (-1 + 0.5) * -(0.5**0.5), h, 0]], atol=1e-15)


def test_a_cap_that_leans_has_its_deepest_point_first():
    angle = 2e-4
    c = points_of(ROD, FLOOR, at=(0, 0, np.cos(angle) + 0.5 * np.sin(angle)), q=axis_turn(0, angle))
    assert len(c) == 8 and c["feature"][0] == c["feature"][np.argmin(c["gap"])]
    np.testing.assert_allclose(c["gap"], 0.5 * np.sin(angle) * (1 - np.cos(np.arange(8) * np.pi / 4)), atol=1e-15)


def test_cylinders_on_cylinders():
    lying = axis_turn(0, np.pi / 2)
    both = points_of(ROD, ROD, at=(0, 0.5, 1.0), q=lying, q_b=lying)
    np.testing.assert_allclose(rows(both), rows_of([[0, -0.5, 0.5, 0], [0, 1, 0.5, 0]]), atol=1e-15)
    crossed = points_of(ROD, ROD, at=(0.1, 0, 1.0), q=lying, q_b=axis_turn(1, np.pi / 2))
    np.testing.assert_allclose(rows(crossed), [[0.1, 0, 0.5, 0]], atol=1e-15)
    stacked = points_of(ROD, ROD, at=(0, 0, 2.0))
    assert len(stacked) == 8


def test_a_cone_on_its_tip_and_a_ball():
    cone = piece(FRUSTUM, (0.5, 0.0, 0.6), reach=0.8)
    tip = points_of(cone, CUBE, at=(0.1, 0, 1.1), q=axis_turn(0, np.pi))
    np.testing.assert_allclose(rows(tip), [[0.1, 0, 0.5, 0]], atol=1e-15)
    for plane in (CUBE, ROD, FLOOR):
        top = {BOX: 0.5, FRUSTUM: 1.0, HALF_SPACE: 0.0}[int(plane["kind"][0])]
        ball = points_of(piece(POINT, radius=0.3), plane, at=(0.1, 0.2, top + 0.3 + 1e-5))
        np.testing.assert_allclose(rows(ball), [[0.1, 0.2, top + 5e-6, 1e-5]], atol=1e-15)


def test_a_prism_of_many_sides_keeps_eight_points_around():
    """A hundred corners in the face: eight remain, spread around. Measured: 1.2 rad at most from one to the next."""
    phi = 2 * np.pi * np.arange(100) / 100
    v = np.array([[np.cos(p), np.sin(p), z] for z in (-0.3, 0.3) for p in phi])
    pieces, poses = two(piece(POLYTOPE, last=200, reach=1.05), FLOOR, at=(0, 0, 0.3))
    c = touching(pieces, v, poses, UP)
    assert len(c) == 8
    around = np.sort(np.arctan2(c["point"][:, 1], c["point"][:, 0]))
    assert np.diff(np.append(around, around[0] + 2 * np.pi)).max() < np.radians(100)


def test_a_ball_and_a_box_in_holes():
    """In a box one point per ball, the four lowest corners of a box; in a pipe the line of a cylinder that lies."""
    tank = piece(BOX + CAVITY, (3.0, 2.0, 1.0))
    ball = points_of(piece(POINT, radius=0.4), tank, at=(0.5, 0.5, -0.6 + 1e-5))
    np.testing.assert_allclose(rows(ball), [[0.5, 0.5, -1 + 5e-6, 1e-5]], atol=1e-15)
    corners = points_of(CUBE, tank, at=(0.5, 0.5, -0.5))
    assert len(corners) == 4
    np.testing.assert_allclose(corners["point"][:, 2], -1, atol=1e-15)
    pipe = piece(FRUSTUM + CAVITY, (2.0, 2.0, 5.0))
    line = points_of(ROD, pipe, n=(-1.0, 0.0, 0.0), at=(1.5, 0, 0))
    np.testing.assert_allclose(rows(line), rows_of([[2, 0, -1, 0], [2, 0, 1, 0]]), atol=1e-15)
    np.testing.assert_allclose(line["normal"], [(-1, 0, 0)] * 2, atol=1e-15)


NAMES = [k for k in KINDS if k != "floor"]


@pytest.mark.parametrize(("one", "other"), list(combinations(NAMES, 2)))
def test_random_pairs(one, other):
    """A point at least; gaps from that of the pair (1e-9: faces of polytopes that lean by `within`) to `within`;
    numbers below 2^30; exchanged pieces: the same points (measured: 1e-15); lengths times 2^k: the same bits."""
    rng = np.random.default_rng(1)
    for gap in (1e-4, 0.0, -1e-4):
        pieces, poses = two(KINDS[one], KINDS[other], rng)
        n = bring_to(gap, pieces, VERTICES, poses, rng)
        s, n, a, b, certain = separate(pieces, VERTICES, poses, 0, 1, n)
        c = touching(pieces, VERTICES, poses, n)
        assert len(c) >= 1
        assert c["gap"].min() >= s - 1e-12 and c["gap"].max() <= max(1e-3, s) + 1e-12
        if certain:
            assert c["gap"].min() == pytest.approx(s, abs=1e-9)
        assert ((c["feature"] >= 0) & (c["feature"] < 2**30)).all()
        np.testing.assert_array_equal(c["normal"], np.tile(n, (len(c), 1)))
        back = touching(pieces, VERTICES, poses, -np.array(n), i=1, j=0)
        assert len(back) == len(c)
        np.testing.assert_allclose(rows(back), rows(c), atol=1e-12)
        big, far = pieces.copy(), poses.copy()
        for field in ("size", "radius", "reach"):
            big[field] *= 2.0**13
        far[:, :3] *= 2.0**13
        large = touching(big, VERTICES * 2.0**13, far, n, within=1e-3 * 2.0**13)
        np.testing.assert_array_equal(large["point"], c["point"] * 2.0**13)
        np.testing.assert_array_equal(large["feature"], c["feature"])


def test_mirrored_scenes_have_mirrored_points():
    """Two boxes, two bricks on a floor at x and -x, turned to each other's mirror image. Measured: 2e-16."""
    rng = np.random.default_rng(2)
    for _ in range(20):
        at, angle = (*rng.uniform(-0.6, 0.6, 2), 1.0), rng.uniform(0, np.pi)
        left = points_of(CUBE, CUBE, at=at, q=axis_turn(2, angle))
        right = points_of(CUBE, CUBE, at=(-at[0], at[1], at[2]), q=axis_turn(2, -angle))
        mirrored = rows(right)
        mirrored[:, 0] *= -1
        np.testing.assert_allclose(rows_of(mirrored), rows(left), atol=1e-14)


def test_random_calls_end_and_are_finite():
    """Any normal, any within, deep overlaps: at most 8 points, none of them NaN."""
    rng = np.random.default_rng(3)
    everything = np.concatenate([*KINDS.values(), hole(KINDS["box"]), hole(KINDS["can"]), hole(KINDS["ball"])])
    poses = np.zeros((len(everything), 7))
    for _ in range(40):
        poses[:, :3] = rng.normal(size=(len(poses), 3)) * rng.choice([0.0, 0.5, 2.0])
        poses[:, 3:] = rng.normal(size=(len(poses), 4))
        poses[:, 3:] /= np.linalg.norm(poses[:, 3:], axis=1)[:, None]
        for i in range(len(everything)):
            for j in range(len(everything)):
                n = rng.normal(size=3)
                n /= np.linalg.norm(n)
                c = touching(everything, VERTICES, poses, n, within=10.0 ** rng.uniform(-12, 1), i=i, j=j)
                assert np.isfinite(c["point"]).all() and np.isfinite(c["gap"]).all()
