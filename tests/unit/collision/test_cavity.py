"""Pieces inside holes: the least room against that of all their points."""

import numpy as np
import pytest
from convex_pieces import HOLES, NOTHING, hole, matrix, one_of_each, separate, two
from scipy.optimize import minimize

from flowgmo.collision.shapes import BOX, ELLIPSOID, FRUSTUM, POINT

KINDS, VERTICES = one_of_each(np.random.default_rng(0))


def room(hole_piece, pose, x):
    """Least distance of points (k, 3) from the surface of a hole, by its definition (box, cylinder, cone, ball)."""
    y = (x - pose[:3]) @ matrix(pose[3:])
    size, kind = hole_piece["size"], hole_piece["kind"] % 16
    if kind == POINT:
        return (hole_piece["radius"] - np.linalg.norm(y, axis=1)).min()
    if kind == BOX:
        return (size - abs(y)).min()
    if kind == FRUSTUM:
        c, s = np.array([2 * size[2], size[0] - size[1]]) / np.hypot(2 * size[2], size[0] - size[1])
        side = -(c * (np.hypot(y[:, 0], y[:, 1]) - size[0]) + s * (y[:, 2] + size[2]))
        return min(side.min(), (size[2] - abs(y[:, 2])).min())
    worst = y[np.argmax(np.sum((y / size) ** 2, axis=1))]
    start = worst / np.linalg.norm(worst / size)
    p = minimize(
        lambda v: np.sum((v - worst) ** 2),
        start,
        constraints={"type": "eq", "fun": lambda v: np.sum((v / size) ** 2) - 1},
        options={"ftol": 1e-16},
    )
    return np.sqrt(p.fun)


def surface(p, pose, rng, n=20_000):
    """Points of the surface of a piece: corners, rims, or a fine cloud."""
    r = matrix(pose[3:])
    size, kind = p["size"], p["kind"]
    if kind == FRUSTUM:
        phi = np.linspace(0, 2 * np.pi, n // 2)
        y = np.vstack(
            [
                np.stack([q * np.cos(phi), q * np.sin(phi), np.full(n // 2, z)], 1)
                for q, z in ((size[0], -size[2]), (size[1], size[2]))
            ]
        )
    elif kind == ELLIPSOID:
        y = rng.normal(size=(10 * n, 3))
        y = size * y / np.linalg.norm(y, axis=1)[:, None]
    elif kind == BOX:
        y = size * np.array([[a, b, c] for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)])
    elif kind == POINT:
        y = np.zeros((1, 3))
    else:
        y = VERTICES[p["first"] : p["last"]]
    return pose[:3] + y @ r.T


@pytest.mark.parametrize("inside", ["ball", "brick", "triangle", "rock", "can", "cone", "lens"])
@pytest.mark.parametrize("name", list(HOLES))
def test_a_piece_in_a_hole(name, inside):
    """Least room of the piece's points, against all of them (corners exact; rims and ellipsoids by 2e4 and 2e5 points,
    so that the found one is a little less). A wrong local minimum would leave s too large."""
    rng = np.random.default_rng(10)
    for _ in range(3):
        pieces, poses = two(KINDS[inside], hole(HOLES[name]), rng)
        poses[0, :3] = rng.uniform(-0.8, 0.8, 3)
        s, n, a, b, certain = separate(pieces, VERTICES, poses, 0, 1, NOTHING)
        cloud = surface(pieces[0], poses[0], rng)
        if name == "egg":
            low = np.inf
            for x in cloud[rng.permutation(len(cloud))[:1] if len(cloud) > 20 else slice(None)]:
                low = min(low, room(pieces[1], poses[1], x[None]))
            assert s + pieces[0]["radius"] < low + 1e-6
        else:
            low = room(pieces[1], poses[1], cloud)
            fine = 2e-4 if len(cloud) > 20 else 1e-13
            assert low - fine < s + pieces[0]["radius"] < low + 1e-13
        assert certain
        np.testing.assert_allclose(np.array(a) - b, s * np.array(n), atol=1e-13)
