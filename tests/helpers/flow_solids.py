"""Meshes, solids, and exact volumes for the tests of open fractions and of the liquid at the start."""

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import ConvexHull, HalfspaceIntersection

from flowgmo.geometry import Component, Limits, Piece, Transform
from flowgmo.mesh import Block, Side

INNER = (slice(2, -2),) * 3


def graded_block(n, lengths=(1.0, 1.0, 1.0), grade=0.3, low=(0.0, 0.0, 0.0)):
    """n, n + 1, n - 1 cells; widths vary by a factor (1 + grade) / (1 - grade) within the mesh."""
    planes = []
    for cells, length, start in zip((n, n + 1, n - 1), lengths, low, strict=True):
        s = np.linspace(0, 1, cells + 1)
        planes.append(start + length * (s + grade * np.sin(2 * np.pi * s) / (2 * np.pi)))
    return Block(*planes, tuple(Side(i, 1) for i in range(6)))


def ball(radius, at):
    return Component([Piece(limits=Limits(sphere=(None, radius)), transform=Transform(translate=at))])


def box(half, at, turn=(0, 0, 0)):
    limits = Limits(*[(-a, a) for a in half])
    return Component([Piece(limits=limits, transform=Transform(rotate=turn, translate=at))])


def cylinder(radius, half, at, turn=(0, 0, 0)):
    limits = Limits(radius=(None, radius), z=(-half, half))
    return Component([Piece(limits=limits, transform=Transform(rotate=turn, translate=at))])


class HalfSpace:
    """n . x < h is solid; known by its distance only."""

    def __init__(self, normal, h):
        self.n, self.h = np.asarray(normal, float) / np.linalg.norm(normal), h

    def distance(self, x):
        return x @ self.n - self.h

    def bounds(self):
        return np.array([[-np.inf] * 3, [np.inf] * 3])


def unit_vectors(rng, n):
    v = rng.normal(size=(n, 3))
    return v / np.linalg.norm(v, axis=1)[:, None]


def exact_volume(normals, offsets, low=(0, 0, 0), high=(1, 1, 1)):
    """Volume of {x in the box: n . x <= h for all}, by the dual hull of scipy: shares no code with flowgmo."""
    from scipy.optimize import linprog

    n = np.vstack([np.eye(3), -np.eye(3), normals])
    h = np.concatenate([high, -np.asarray(low, float), offsets])
    best = linprog([0, 0, 0, -1], np.column_stack([n, np.linalg.norm(n, axis=1)]), h, bounds=[(None, None)] * 4)
    if best.x[3] < 1e-9:
        return 0.0
    return ConvexHull(HalfspaceIntersection(np.column_stack([n, -h]), best.x[:3]).intersections).volume


def connected(open_):
    """Label of each real cell: cells that open faces join have the same."""
    V = open_.V[INNER]
    number = np.arange(V.size).reshape(V.shape)
    faces = (open_.Ax[2:-3, 2:-2, 2:-2], open_.Ay[2:-2, 2:-3, 2:-2], open_.Az[2:-2, 2:-2, 2:-3])
    pairs = []
    for axis, area in enumerate(faces):
        lower, upper = np.delete(number, -1, axis), np.delete(number, 0, axis)
        pairs.append(np.stack([lower[area > 0], upper[area > 0]]))
    a, b = np.concatenate(pairs, axis=1)
    graph = coo_matrix((np.ones(len(a)), (a, b)), shape=(V.size, V.size))
    return connected_components(graph, directed=False)[1].reshape(V.shape)


def middles(block):
    """(nx, ny, nz, 3) centres of the cells."""
    return np.stack(np.meshgrid(*[0.5 * (p[1:] + p[:-1]) for p in block.planes], indexing="ij"), axis=-1)
