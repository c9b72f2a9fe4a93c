"""Separation of two pieces: against closed forms, separating axes, bounds from both sides, and its own symmetries."""

from itertools import combinations

import numpy as np
import pytest
from convex_pieces import (
    HOLES,
    NOTHING,
    bring_to,
    gap_along,
    hole,
    matrix,
    one_of_each,
    piece,
    reference_support,
    separate,
    turn,
    two,
)

from flowgmo.collision.shapes import BOX, ELLIPSOID, FRUSTUM, HALF_SPACE, POINT

KINDS, VERTICES = one_of_each(np.random.default_rng(0))
CORNERED = ("box", "brick", "cube", "rock", "triangle")
BOUNDED = tuple(k for k in KINDS if k != "floor")
PAIRS = [(a, b) for a, b in combinations(BOUNDED, 2) if "ball" not in (a, b)]


def support_gap(pieces, poses, n):
    a = reference_support(pieces[0], VERTICES, poses[0], -n)
    return (a - reference_support(pieces[1], VERTICES, poses[1], n)) @ n


def best_axis(pieces, poses):
    """The largest gap over the face normals and the cross products of the edges of two boxes, and the next."""
    a, b = matrix(poses[0, 3:]).T, matrix(poses[1, 3:]).T
    axes = [*a, *b, *(np.cross(x, y) for x in a for y in b)]
    axes = [s * m / np.linalg.norm(m) for m in axes for s in (1, -1)]
    gaps = [support_gap(pieces, poses, m) for m in axes]
    order = np.argsort(gaps)
    return gaps[order[-1]], axes[order[-1]], gaps[order[-2]]


def test_boxes_against_all_separating_axes():
    """Gaps at which faces and edges decide, warm and cold. Measured: normal 7e-16, s 6e-16. Larger errors
    would be badly conditioned nearest points."""
    rng = np.random.default_rng(1)
    compared = 0
    for _ in range(60):
        pieces, poses = two(KINDS["box"], KINDS["brick"], rng)
        n = bring_to(0.0, pieces, VERTICES, poses, rng)
        start = poses[0, :3].copy()
        for gap in (1e-5, 1e-10, 1e-15, 0.0, -1e-15, -1e-8, -1e-5, -1e-3):
            poses[0, :3] = start + gap * np.array(n)
            s0, m, second = best_axis(pieces, poses)
            if s0 - second < 3e-3:
                continue  # two normals are as good
            compared += 1
            s, found, a, b, certain = separate(pieces, VERTICES, poses, 0, 1, n)
            assert certain
            assert np.linalg.norm(np.array(found) - m) < 1e-13
            assert abs(s - s0) < 1e-14
            np.testing.assert_allclose(np.array(a) - b, s * np.array(found), atol=1e-14)
    assert compared > 100


@pytest.mark.parametrize(("one", "other"), PAIRS)
def test_distance_is_the_least_one(one, other):
    """Apart: s(n) <= distance <= |a - b| for any n and any points of the two, so that both sides agreeing is a proof.
    a, b are points of the pieces: no support lies below them. Measured: 2e-15."""
    rng = np.random.default_rng(2)
    for _ in range(10):
        pieces, poses = two(KINDS[one], KINDS[other], rng)
        d = rng.normal(size=3)
        poses[0, :3] = rng.uniform(3, 6) * d / np.linalg.norm(d)
        s, n, a, b, certain = separate(pieces, VERTICES, poses, 0, 1, NOTHING)
        assert certain and s > 0
        assert abs(np.linalg.norm(np.array(a) - b) - s) < 1e-13
        assert abs(support_gap(pieces, poses, np.array(n)) - s) < 1e-13
        for m in rng.normal(size=(20, 3)):
            m /= np.linalg.norm(m)
            assert (reference_support(pieces[0], VERTICES, poses[0], m) - a) @ m > -1e-12
            assert (reference_support(pieces[1], VERTICES, poses[1], m) - b) @ m > -1e-12


@pytest.mark.parametrize(("one", "other"), PAIRS)
def test_a_normal_stays_the_same_through_contact(one, other):
    """Moved along their normal the pieces keep it, and s changes by the way. Measured: s 7e-14, normal 2e-12,
    but for corners and rims on rims a gap of 1e-8 tells the normal to 1e-8 only. A jump would be another local maximum
    or a normal lost where the nearest points coincide."""
    rng = np.random.default_rng(3)
    for _ in range(10):
        pieces, poses = two(KINDS[one], KINDS[other], rng)
        n = bring_to(0.1, pieces, VERTICES, poses, rng)
        s, n, *_ = separate(pieces, VERTICES, poses, 0, 1, n)
        start, m = poses[0, :3].copy(), n
        for way in (0.0, 0.09, 0.099, 0.0999, 0.1, 0.1 + 1e-8, 0.1 + 1e-5, 0.1 + 1e-4):
            poses[0, :3] = start - way * np.array(n)
            found, m, _, _, certain = separate(pieces, VERTICES, poses, 0, 1, m)
            gap = s - way
            assert abs(found - gap) < 1e-12
            assert certain or gap <= 0.0  # overlapping, a corner or rim on a rim has no normal of its own
            if gap > 1e-9:
                assert np.linalg.norm(np.array(m) - n) < 1e-10 + 1e-14 / gap


def test_ellipsoids_meet_with_one_normal():
    """n is the normal of both surfaces at a and b: the gradients of their equations. Measured: 3e-15."""
    rng = np.random.default_rng(4)
    for _ in range(100):
        pieces, poses = two(KINDS["egg"], KINDS["lens"], rng)
        n = bring_to(rng.choice([0.1, 1e-6, 0.0, -1e-6, -1e-3]), pieces, VERTICES, poses, rng)
        s, n, a, b, certain = separate(pieces, VERTICES, poses, 0, 1, n)
        assert certain
        for x, k, sign in ((a, 0, -1), (b, 1, 1)):
            r = matrix(poses[k, 3:])
            y = r.T @ (np.array(x) - poses[k, :3])
            assert abs(np.sum((y / pieces[k]["size"]) ** 2) - 1) < 1e-13
            g = r @ (y / pieces[k]["size"] ** 2)
            assert np.linalg.norm(sign * g / np.linalg.norm(g) - n) < 1e-12


def test_crossed_cylinders():
    """Normal across both axes, s the distance of the axes less the radii; gaps from 1e-1 to -1e-3. Measured: 7e-16."""
    rng = np.random.default_rng(5)
    rod = piece(FRUSTUM, (0.3, 0.3, 2.0), reach=2.1)
    for _ in range(50):
        pieces, poses = two(rod, rod, rng)
        x, y = matrix(poses[0, 3:])[:, 2], matrix(poses[1, 3:])[:, 2]
        n = np.cross(x, y)
        n /= np.linalg.norm(n)
        if abs(x @ y) > 0.8:
            continue
        for gap in (0.1, 1e-3, 1e-8, 0.0, -1e-8, -1e-3):
            poses[0, :3] = 0.3 * x - 0.2 * y + (0.6 + gap) * n
            for warm in (NOTHING, tuple(n)):
                s, m, *_ = separate(pieces, VERTICES, poses, 0, 1, warm)
                assert abs(s - gap) < 1e-14
                assert np.linalg.norm(m - n) < 1e-13


def test_cone_against_the_edge_of_a_box():
    """The normal of a cone's side, (2 h cos φ, 2 h sin φ, r0 - r1) / length, stands across the edge for two φ; the one
    that points down is the contact's, and any point of that line may touch. Measured: normal 3e-16, s 8e-16."""
    rng = np.random.default_rng(6)
    cone, box = piece(FRUSTUM, (0.8, 0.2, 1.0), reach=1.4), piece(BOX, (3.0, 1.0, 1.0), reach=3.4)
    length = np.hypot(2.0, 0.6)
    for angle in np.linspace(-0.6, 0.6, 20):
        pieces, poses = two(cone, box)
        poses[0, 3:] = np.cos(angle / 2), 0, np.sin(angle / 2), 0
        poses[1, 3:] = np.cos(np.pi / 8), np.sin(np.pi / 8), 0, 0  # an edge along x on top, the faces at 45 degrees
        r = matrix(poses[0, 3:])
        x, y, z = r[0]
        phi = np.arctan2(y, x) + np.array([1, -1]) * np.arccos(-0.3 * z / np.hypot(x, y))
        side = (r @ np.array([2 * np.cos(phi), 2 * np.sin(phi), [0.6, 0.6]]) / length).T
        k = np.argmin(side[:, 2])
        n, t = -side[k], rng.uniform(-0.8, 0.8)
        radius = 0.5 - 0.3 * t
        spot = matrix(poses[0, 3:]) @ np.array([radius * np.cos(phi[k]), radius * np.sin(phi[k]), t])
        # a box turned about x so that its edge points along n
        up = np.arctan2(n[2], n[1]) - np.pi / 4
        poses[1, 3:] = np.cos(up / 2), np.sin(up / 2), 0, 0
        corner = matrix(poses[1, 3:]) @ np.array([0, 1.0, 1.0])
        for gap in (1e-3, 0.0, -1e-4):
            poses[0, :3] = corner - spot + gap * n
            for warm in (tuple(n), NOTHING):
                s, m, *_ = separate(pieces, VERTICES, poses, 0, 1, warm)
                assert abs(s - gap) < 1e-13
                assert np.linalg.norm(m - n) < 1e-12


@pytest.mark.parametrize("other", [k for k in BOUNDED if k not in ("cube", "rock")])
def test_a_ball_against_the_general_search(other):
    """The closed forms of the ball against a sphere given as an ellipsoid. Measured: 3e-15."""
    rng = np.random.default_rng(7)
    ball, sphere = KINDS["ball"], piece(ELLIPSOID, (0.5, 0.5, 0.5), reach=0.5)
    for _ in range(30):
        pieces, poses = two(ball, KINDS[other], rng)
        bring_to(rng.choice([1.0, 0.1, 1e-9, -1e-4]), pieces, VERTICES, poses, rng)
        s, n, a, b, certain = separate(pieces, VERTICES, poses, 0, 1, NOTHING)
        pieces[0] = sphere[0]
        t, m, *_ = separate(pieces, VERTICES, poses, 0, 1, n)
        assert certain and abs(s - t) < 1e-13
        assert np.linalg.norm(np.array(n) - m) < 1e-11
        np.testing.assert_allclose(np.array(a) - b, s * np.array(n), atol=1e-14)


@pytest.mark.parametrize("other", [k for k in KINDS if k not in ("ball", "triangle", "rock", "cube")])
def test_a_ball_inside_has_the_depth_of_its_centre(other):
    """Signed distance of points inside, against the largest support gap along any direction. Measured: 5e-15."""
    rng = np.random.default_rng(8)
    small = piece(POINT, radius=1e-3)
    for _ in range(10):
        pieces, poses = two(small, KINDS[other], rng)
        u = rng.normal(size=3)
        poses[0, :3] = rng.uniform(0, 0.15) * u / np.linalg.norm(u) - (0, 0, 0.5 if other == "floor" else 0)
        s, n, *_ = separate(pieces, VERTICES, poses, 0, 1, NOTHING)
        assert abs(gap_along(pieces, VERTICES, poses, 0, 1, n) - s) < 1e-13
        if other != "floor":
            for m in rng.normal(size=(200, 3)):
                assert support_gap(pieces, poses, m / np.linalg.norm(m)) < s + 1e-13


@pytest.mark.parametrize("other", [k for k in KINDS if k != "floor"])
def test_a_half_space(other):
    """s is the height of the lowest point. Measured: 4e-16."""
    rng = np.random.default_rng(9)
    for _ in range(20):
        pieces, poses = two(KINDS[other], piece(HALF_SPACE), rng, at=rng.normal(size=3))
        n = matrix(poses[1, 3:])[:, 2]
        low = reference_support(pieces[0], VERTICES, poses[0], -n) @ n
        s, m, a, b, _ = separate(pieces, VERTICES, poses, 0, 1, NOTHING)
        np.testing.assert_allclose((*m, s), (*n, low), atol=1e-14)
        assert abs(np.dot(b, n)) < 1e-14 and abs(np.dot(a, n) - low) < 1e-14


@pytest.mark.parametrize(("one", "other"), [*PAIRS, ("ball", "box"), ("ball", "cone"), ("egg", "floor")])
def test_exchanged_and_scaled(one, other):
    """Exchanged, only the sign of n changes (measured: s 4e-15, n 3e-14); lengths times 2^k give the same bits."""
    rng = np.random.default_rng(11)
    for gap in (0.3, 1e-4, -1e-4):
        pieces, poses = two(KINDS[one], KINDS[other], rng)
        n = bring_to(gap, pieces, VERTICES, poses, rng)
        s, m, a, b, _ = separate(pieces, VERTICES, poses, 0, 1, n)
        t, back, c, d, _ = separate(pieces, VERTICES, poses, 1, 0, tuple(-np.array(n)))
        assert abs(s - t) < 1e-12
        assert np.linalg.norm(np.array(m) + back) < 1e-9
        for power in (-20, 7, 30):
            big, far = pieces.copy(), poses.copy()
            for field in ("size", "radius", "reach", "centre"):
                big[field] *= 2.0**power
            far[:, :3] *= 2.0**power
            u, v, e, f, _ = separate(big, VERTICES * 2.0**power, far, 0, 1, n)
            assert (u * 2.0**-power, v) == (s, m)
            assert tuple(np.array(e) * 2.0**-power) == a and tuple(np.array(f) * 2.0**-power) == b


@pytest.mark.parametrize("one", [k for k in BOUNDED if k != "ball"])
def test_pieces_apart_are_found_apart_from_any_start(one):
    """A last normal that points anywhere, a triangle seen from behind: the deep local maxima are left. Measured: same
    to 2e-15."""
    rng = np.random.default_rng(13)
    for other in (k for k in BOUNDED if k != "ball"):
        for _ in range(20):
            pieces, poses = two(KINDS[one], KINDS[other], rng)
            d = rng.normal(size=3)
            poses[0, :3] = 3.0 * d / np.linalg.norm(d)
            u = rng.normal(size=3)
            s, *_, sure = separate(pieces, VERTICES, poses, 0, 1, NOTHING)
            t, *_, certain = separate(pieces, VERTICES, poses, 0, 1, tuple(u / np.linalg.norm(u)))
            assert s > 0 and sure and certain
            assert abs(s - t) < 1e-13


@pytest.mark.parametrize("ratio", [1e-3, 1e-2])
@pytest.mark.parametrize("name", ["brick", "can", "cone", "egg", "rock"])
def test_small_on_large_and_thin(name, ratio):
    """A piece a thousand times smaller above the face of a thin plate keeps the face's normal. Measured: 3e-15."""
    rng = np.random.default_rng(14)
    small, plate = KINDS[name].copy(), piece(BOX, (1.0, 1.0, 0.005))
    small["size"] *= ratio
    small["reach"] *= ratio
    vertices = VERTICES * ratio
    for _ in range(20):
        pieces, poses = two(small, plate, rng)
        r = matrix(poses[1, 3:])
        n = r[:, 2]
        poses[0, :3] = 0.0
        low = [matrix(poses[0, 3:]) @ v for v in vertices[small["first"][0] : small["last"][0]]]
        low = min(low, key=lambda v: v @ n) if low else reference_support(small[0], vertices, poses[0], -n)
        for gap in (1e-1 * ratio, 1e-8 * ratio, 0.0, -1e-8 * ratio, -1e-4 * ratio):
            poses[0, :3] = r @ np.array([0.3, -0.2, 0.005 + gap]) - low
            s, m, *_, certain = separate(pieces, vertices, poses, 0, 1, tuple(n))
            assert certain
            assert abs(s - gap) < 1e-14
            assert np.linalg.norm(m - n) < 1e-12


def test_without_vertices_there_are_balls_and_half_spaces():
    """Closed forms give the same bits; a pair that needs the general search is refused."""
    rng = np.random.default_rng(15)
    for other in ("ball", "box", "can", "egg", "floor"):
        pieces, poses = two(KINDS["ball"], KINDS[other], rng, at=(0.9, 1.1, 0.3))
        assert separate(pieces, None, poses, 0, 1, NOTHING) == separate(pieces, VERTICES, poses, 0, 1, NOTHING)
    pieces, poses = two(KINDS["box"], KINDS["egg"], rng)
    s, *_, certain = separate(pieces, None, poses, 0, 1, NOTHING)
    assert s == -np.inf and not certain


def test_a_hundred_thousand_random_calls():
    """All kinds, holes too, apart, touching, deep in each other, warm and cold, thin and fat: finite, and n unit."""
    rng = np.random.default_rng(12)
    everything = np.concatenate([*KINDS.values(), *(hole(h) for h in HOLES.values())])
    thin = everything.copy()
    thin["size"] *= (1.0, 1e-3, 1e-3)
    thin["size"][[k for k in range(len(thin)) if thin["kind"][k] % 16 == FRUSTUM]] *= (1.0, 1e3, 1.0)
    everything = np.concatenate([everything, thin])
    poses = np.zeros((len(everything), 7))
    for _ in range(70):
        poses[:, :3] = rng.normal(size=(len(poses), 3)) * rng.choice([0.0, 1e-9, 0.3, 1.0, 3.0])
        poses[:, 3:] = [turn(rng) if rng.random() < 0.8 else (1, 0, 0, 0) for _ in poses]
        for i in range(len(everything)):
            for j in range(len(everything)):
                n0 = NOTHING
                if rng.random() < 0.5:
                    u = rng.normal(size=3)
                    n0 = tuple(u / np.linalg.norm(u))
                s, n, a, b, _ = separate(everything, VERTICES, poses, i, j, n0)
                assert abs(np.linalg.norm(n) - 1) < 1e-14
                assert s == np.inf or np.isfinite([s, *a, *b]).all(), (i, j)
