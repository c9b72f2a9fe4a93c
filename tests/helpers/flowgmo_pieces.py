"""Small bodies, and the pieces of a scene made of them."""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np

from flowgmo.collision.pieces import build_pieces
from flowgmo.geometry import Component, Limits, Piece, mesh_from
from flowgmo.mesh import WALL, Side


@dataclass
class Body:
    shape: Component
    origin: np.ndarray


def scene_of(*components, origin=(0.0, 0.0, 0.0), sides=(), half=5.0):
    """Shapes of a scene in which all can collide, in a domain of side 2 half about the origin."""
    n = len(components)
    allowed = np.ones((n + 6, n + 6), bool)
    allowed[n:] = allowed[:, n:] = False
    for side in sides:
        allowed[n + side, :n] = allowed[:n, n + side] = True
    model = SimpleNamespace(
        bodies=tuple(Body(shape, np.array(origin, float)) for shape in components),
        contacts=SimpleNamespace(allowed=allowed),
        mesh=SimpleNamespace(
            bounds=np.array([[-half] * 3, [half] * 3]), sides=tuple(Side(k, WALL) for k in sides)
        ),
    )  # fmt: skip
    return build_pieces(model)


def box(lo, hi, role="solid", **parts):
    return Piece(role, Limits(*zip(lo, hi, strict=True)), **parts)


def cylinder(radius, lo, hi, role="solid", **parts):
    return Piece(role, Limits(radius=(None, radius), z=(lo, hi)), **parts)


def ball(radius, role="solid", **parts):
    return Piece(role, Limits(sphere=(None, radius)), **parts)


def mesh(*pieces, resolution=24, **parts):
    vertices, faces = Component(pieces).triangles(resolution)
    return Piece(stl=mesh_from(vertices[faces]), **parts)


L_SHAPE = (box((0, 0, 0), (2, 1, 1)), box((0, 0, 0), (1, 2, 1)))
