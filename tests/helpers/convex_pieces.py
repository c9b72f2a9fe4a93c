"""Pieces for the tests of the contact search: one of every kind, random poses, their geometry in plain numpy."""

import numpy as np

from flowgmo.collision.contact import CONTACT
from flowgmo.collision.convex import separation, support_gap
from flowgmo.collision.manifold import contact_points
from flowgmo.collision.shapes import (
    BOX,
    CAVITY,
    ELLIPSOID,
    FRUSTUM,
    HALF_SPACE,
    PIECE,
    POINT,
    POLYTOPE,
    TRIANGLE,
    place,
)
from flowgmo.kernel import kernel

NOTHING = (0.0, 0.0, 0.0)


@kernel
def frames(pieces, poses, i, j):
    a, b = poses[i], poses[j]
    return (
        place(pieces[i], (a[0], a[1], a[2]), (a[3], a[4], a[5], a[6])),
        place(pieces[j], (b[0], b[1], b[2]), (b[3], b[4], b[5], b[6])),
    )


@kernel
def separate(pieces, vertices, poses, i, j, n0):
    one, two = frames(pieces, poses, i, j)
    return separation(pieces, vertices, i, one, j, two, n0)


@kernel
def gap_along(pieces, vertices, poses, i, j, n):
    one, two = frames(pieces, poses, i, j)
    return support_gap(pieces, vertices, i, one, j, two, n)


@kernel
def manifold(pieces, vertices, poses, i, j, n, within, out):
    one, two = frames(pieces, poses, i, j)
    return contact_points(pieces, vertices, i, one, j, two, n, within, out)


def piece(kind, size=NOTHING, radius=0.0, first=0, last=0, reach=None):
    """One PIECE at its body's B, axes parallel."""
    p = np.zeros(1, PIECE)
    p["kind"], p["size"], p["radius"], p["first"], p["last"], p["axes"] = kind, size, radius, first, last, np.eye(3)
    p["reach"] = (np.linalg.norm(size) if reach is None else reach) + radius
    return p


def cube_and_others(rng):
    """Vertices: a triangle, a cube's corners, 12 random points of a sphere."""
    cube = 0.5 * np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    ball = rng.normal(size=(12, 3))
    ball *= 0.7 / np.linalg.norm(ball, axis=1)[:, None]
    return np.vstack([[[1.0, 0, 0], [0, 1.0, 0], [-0.3, -0.2, 0.2]], cube, ball])


def one_of_each(rng):
    """Pieces by name, and the vertices. Lengths about 1."""
    kinds = {
        "box": piece(BOX, (1.0, 0.7, 0.5)),
        "brick": piece(BOX, (0.4, 0.6, 0.9)),
        "round box": piece(BOX, (0.4, 0.3, 0.2), radius=0.2),
        "egg": piece(ELLIPSOID, (1.0, 0.7, 0.5), reach=1.0),
        "lens": piece(ELLIPSOID, (0.4, 0.8, 0.6), reach=0.8),
        "cylinder": piece(FRUSTUM, (0.5, 0.5, 0.9), reach=np.hypot(0.5, 0.9)),
        "can": piece(FRUSTUM, (0.6, 0.6, 0.3), reach=np.hypot(0.6, 0.3)),
        "bucket": piece(FRUSTUM, (0.4, 0.7, 0.6), reach=np.hypot(0.7, 0.6)),
        "cone": piece(FRUSTUM, (0.5, 0.0, 0.6), reach=np.hypot(0.5, 0.6)),
        "triangle": piece(TRIANGLE, first=0, last=3, reach=1.0),
        "cube": piece(POLYTOPE, first=3, last=11, reach=0.75**0.5),
        "rock": piece(POLYTOPE, first=11, last=23, reach=0.7),
        "ball": piece(POINT, radius=0.5),
        "floor": piece(HALF_SPACE),
    }
    return kinds, cube_and_others(rng)


def hole(p):
    """The piece as a cavity."""
    q = p.copy()
    q["kind"] += CAVITY
    return q


def turn(rng):
    q = rng.normal(size=4)
    return q / np.linalg.norm(q)


def two(a, b, rng=None, at=NOTHING):
    """Pieces and poses: a at `at`, b at the origin; turned at random, or not."""
    poses = np.zeros((2, 7))
    poses[:, 3] = 1.0
    poses[0, :3] = at
    if rng is not None:
        poses[0, 3:], poses[1, 3:] = turn(rng), turn(rng)
    return np.concatenate([a, b]), poses


def matrix(q):
    w, x, y, z = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def reference_support(p, vertices, pose, d):
    """Support of a piece in the direction d, written down once more, from its definition."""
    r = matrix(pose[3:])
    e = r.T @ d
    size, kind = p["size"], p["kind"]
    if kind == BOX:
        y = size * np.where(e > 0, 1, -1)
    elif kind == ELLIPSOID:
        y = size**2 * e / np.linalg.norm(size * e)
    elif kind == FRUSTUM:
        u = e[:2] / max(np.hypot(*e[:2]), 1e-300)
        rims = [np.array([*(size[k] * u), z]) for k, z in ((0, -size[2]), (1, size[2]))]
        y = max(rims, key=lambda x: x @ e)
    elif kind in (POLYTOPE, TRIANGLE):
        v = vertices[p["first"] : p["last"]]
        y = v[np.argmax(v @ e)]
    else:
        y = np.zeros(3)
    return pose[:3] + r @ y + p["radius"] * d


def bring_to(gap, pieces, vertices, poses, rng):
    """Move piece 0 until it is `gap` from piece 1 along the normal of contact. Returns that normal."""
    d = rng.normal(size=3)
    poses[0, :3] = poses[1, :3] + 4.0 * d / np.linalg.norm(d)
    n = NOTHING
    for _ in range(200):
        s, n, *_ = separate(pieces, vertices, poses, 0, 1, n)
        if abs(s) < 1e-15:
            break
        poses[0, :3] -= s * np.array(n)
    poses[0, :3] += gap * np.array(n)
    return n


def touching(pieces, vertices, poses, n, within=1e-3, i=0, j=1):
    """Contact points as a structured array."""
    out = np.zeros(8, CONTACT)
    count = manifold(pieces, vertices, poses, i, j, tuple(n), within, out)
    return out[:count]


#: Sizes of holes, to be given to `hole`.
HOLES = {
    "ball": piece(POINT, radius=3.0),
    "box": piece(BOX, (3.0, 2.5, 2.0)),
    "pipe": piece(FRUSTUM, (2.5, 2.5, 4.0), reach=5),
    "funnel": piece(FRUSTUM, (1.8, 3.5, 3.0), reach=5),
    "egg": piece(ELLIPSOID, (3.0, 2.6, 2.4), reach=3.0),
}
