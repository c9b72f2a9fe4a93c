"""Triangles of a whole solid of revolution: rings of vertices, one per point of the outline, joined by quads."""

from __future__ import annotations

import numpy as np

from flowgmo.geometry.profile import Bound, Circle, Outline, outline

JOIN = 1e-8  # in sizes: ends of neighbouring pieces are one point


def ring_faces(pieces: list[Outline], size: float, resolution: int) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (v,3) and outward faces (f,3); `resolution` steps in azimuth, arcs as fine."""
    points, edges = _polygon(pieces, size, resolution)
    on_axis = points[:, 0] < JOIN * size
    phi = 2 * np.pi * np.arange(resolution) / resolution
    rings = np.stack(
        [np.outer(points[:, 0], np.cos(phi)), np.outer(points[:, 0], np.sin(phi)), np.tile(points[:, 1:], resolution)],
        -1,
    )
    number = np.arange(len(points))[:, None] * resolution + np.where(on_axis[:, None], 0, np.arange(resolution))
    quads = []
    for a, b in edges:
        here, there = number[a], number[b]
        quads.append(np.stack([here, np.roll(here, -1), np.roll(there, -1), there], 1))
    quad = np.vstack(quads)
    faces = np.vstack([quad[:, [0, 1, 2]], quad[:, [0, 2, 3]]])
    degenerate = (faces == np.roll(faces, 1, axis=1)).any(1)
    used, faces = np.unique(faces[~degenerate], return_inverse=True)
    return rings.reshape(-1, 3)[used], faces.reshape(-1, 3)


def _polygon(pieces: list[Outline], size: float, resolution: int) -> tuple[np.ndarray, list[tuple[int, int]]]:
    """Points (p,2) and edges from lower to upper end such that the outward normal is (dz, -dr)."""
    points: list[np.ndarray] = []

    def number(q: np.ndarray) -> int:
        for i, known in enumerate(points):
            if np.abs(known - q).max() < JOIN * size:
                return i
        points.append(q)
        return len(points) - 1

    edges = []
    for piece in pieces:
        arc = isinstance(piece.curve, Circle)
        steps = max(2, round(resolution * (piece.t1 - piece.t0) / (2 * np.pi))) if arc else 1
        t = np.linspace(piece.t0, piece.t1, steps + 1)
        chain = [number(q) for q in piece.curve.at(t)]
        # a circle runs counterclockwise, a line has n = (u_z, -u_r): both have n on the right of the way
        pairs = list(zip(chain[:-1], chain[1:], strict=True))
        edges += pairs if piece.outward > 0 else [(b, a) for a, b in pairs]
    return np.array(points), edges


def ball_faces(resolution: int) -> tuple[np.ndarray, np.ndarray]:
    """Triangles of the unit ball about the origin."""
    bound = Bound(a=1.0, e=1.0, c=-1.0)
    arcs = outline([Circle(np.zeros(2), 1.0)], lambda r, z: (bound.value(r, z) <= 0).astype(float))
    return ring_faces(arcs, 1.0, resolution)
