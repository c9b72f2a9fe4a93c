"""The solid inside a closed triangle mesh, in space coordinates.

    |d| = distance to the nearest triangle,  inside where a line from x crosses the surface an odd number of times
    normal on the surface: of the face, the sum of both faces at an edge, the angle-weighted sum at a vertex
    V = Σ a.(b x c) / 6  and the like for the first and second moments

Source  Bærentzen & Aanæs 2005 (pseudo-normals); Eberly 2003, polyhedral mass properties; Ericson 2005, 5.1.5 (nearest
point).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from flowgmo.geometry.boxes_tree import BoxTree
from flowgmo.geometry.moments import Moments
from flowgmo.geometry.primitives import Mesh, unit
from flowgmo.geometry.shadow import SKEW, Shadow, padded
from flowgmo.geometry.transform import Affine

if TYPE_CHECKING:
    from flowgmo.geometry.stl import StlMesh

CHUNK = 20_000  # points at once: keeps the lists of candidate pairs at some ten MB


@dataclass(frozen=True, eq=False)
class MeshSolid:
    """Vertices (v,3) and outward oriented faces (f,3) of a closed mesh without open edges."""

    vertices: np.ndarray
    triangles: np.ndarray
    name: str = ""

    @staticmethod
    def of(mesh: StlMesh, place: Affine) -> MeshSolid:
        """A mesh moved to its place."""
        faces = mesh.faces if np.linalg.det(place.A) > 0 else mesh.faces[:, ::-1]
        return MeshSolid(place(mesh.vertices), faces, mesh.name)

    @cached_property
    def corners(self) -> np.ndarray:
        """Corners (f,3,3) of the triangles."""
        return self.vertices[self.triangles]

    @cached_property
    def tree(self) -> BoxTree:
        return BoxTree.over(self.corners.min(1), self.corners.max(1))

    @cached_property
    def pseudo_normals(self) -> np.ndarray:
        """Normals (f,7,3) of a face at its corners a b c, its edges bc ca ab, and its inside; unit length."""
        corners, f = self.corners, self.triangles
        face = unit(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), np.array([0.0, 0.0, 1.0]))
        at_vertex = np.zeros_like(self.vertices)
        for k in range(3):
            u, v = corners[:, k - 2] - corners[:, k], corners[:, k - 1] - corners[:, k]
            angle = np.arctan2(np.linalg.norm(np.cross(u, v), axis=1), (u * v).sum(1))
            np.add.at(at_vertex, f[:, k], angle[:, None] * face)
        edges = np.sort(np.vstack([f[:, [1, 2]], f[:, [2, 0]], f[:, [0, 1]]]), axis=1)
        _, which = np.unique(edges, axis=0, return_inverse=True)
        at_edge = np.zeros((which.max() + 1, 3))
        np.add.at(at_edge, which.ravel(), np.tile(face, (3, 1)))
        of_edges = at_edge[which.ravel()].reshape(3, -1, 3).transpose(1, 0, 2)
        normals = np.concatenate([at_vertex[f], of_edges, face[:, None]], axis=1)
        return unit(normals, face[:, None])

    def _nearest(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Signed distance (n,) and outward normal (n,3)."""
        d, n = np.empty(len(x)), np.empty((len(x), 3))
        for start in range(0, len(x), CHUNK):
            part = slice(start, start + CHUNK)
            d[part], n[part] = self._nearest_part(x[part])
        return d, n

    def _nearest_part(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        point, face = self.tree.near(x, self.vertices[self.triangles[:, 0]])
        nearest, feature = nearest_on_triangle(x[point], self.corners[face])
        gap = x[point] - nearest
        square = (gap * gap).sum(1)
        order = np.lexsort((square, point))
        first = order[np.r_[True, np.diff(point[order]) > 0]]
        gap, d = gap[first], np.sqrt(square[first])
        pseudo = self.pseudo_normals[face[first], feature[first]]
        side = np.where(self.inside(x), -1.0, 1.0)
        flat = (feature[first] == 6) | (d <= 1e-14 * np.abs(self.vertices).max())  # rounding: no direction left
        normal = np.where(flat[:, None], pseudo, unit(side[:, None] * gap, pseudo))
        return side * d, normal

    def distance(self, x: np.ndarray) -> np.ndarray:
        return self._nearest(x)[0]

    def normal(self, x: np.ndarray) -> np.ndarray:
        return self._nearest(x)[1]

    def inside(self, x: np.ndarray) -> np.ndarray:
        low, high = self.vertices.min(0), self.vertices.max(0)
        near = np.flatnonzero(((x >= low) & (x <= high)).all(1))
        line, t = self.shadow.crossings(x[near])
        result = np.zeros(len(x), bool)
        result[near] = np.bincount(line[t > 0], minlength=len(near)) % 2 == 1
        return result

    def support(self, d: np.ndarray) -> float:
        return float((self.vertices @ d).max())

    def moments(self) -> Moments:
        origin = self.vertices.mean(0)
        a, b, c = (self.corners - origin).transpose(1, 0, 2)
        volume = (a * np.cross(b, c)).sum(1) / 6
        total = a + b + c
        first = (volume[:, None] * total).sum(0) / 4
        second = sum(np.einsum("f,fi,fj->ij", volume, p, p) for p in (a, b, c, total)) / 20
        return Moments(float(volume.sum()), first, second).moved(Affine(np.eye(3), origin))

    @cached_property
    def shadow(self) -> Shadow:
        return Shadow.of(self.corners, SKEW)

    def roots(self, x: np.ndarray, d: np.ndarray) -> np.ndarray:
        """Crossings along d, padded with NaN to the largest number on one line."""
        shadow = self.shadow if np.array_equal(d, SKEW) else Shadow.of(self.corners, d)
        return padded(*shadow.crossings(x), len(x))

    def faces(self, resolution: int) -> Mesh:
        return self.vertices, self.triangles

    def describe(self) -> str:
        return f"mesh of {len(self.triangles)} triangles" + (f" from {self.name}" if self.name else "")


def nearest_on_triangle(p: np.ndarray, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Nearest points (n,3) of triangles (n,3,3) to points (n,3), and the feature (n,): 0-2 corner a b c, 3-5 edge bc ca
    ab, 6 inside."""
    a, b, c = corners.transpose(1, 0, 2)
    ab, ac, ap = b - a, c - a, p - a
    d1, d2 = (ab * ap).sum(1), (ac * ap).sum(1)
    d3, d4 = d1 - (ab * ab).sum(1), d2 - (ab * ac).sum(1)
    d5, d6 = d1 - (ab * ac).sum(1), d2 - (ac * ac).sum(1)
    va, vb, vc = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2
    conditions = [
        (d1 <= 0) & (d2 <= 0),
        (d3 >= 0) & (d4 <= d3),
        (d6 >= 0) & (d5 <= d6),
        (vc <= 0) & (d1 >= 0) & (d3 <= 0),
        (vb <= 0) & (d2 >= 0) & (d6 <= 0),
        (va <= 0) & (d4 - d3 >= 0) & (d5 - d6 >= 0),
    ]
    feature = np.select(conditions, [0, 1, 2, 5, 4, 3], 6)
    with np.errstate(divide="ignore", invalid="ignore"):
        total = va + vb + vc
        v = np.select(
            [feature == k for k in range(7)],
            [0, 1, 0, 1 - (d4 - d3) / (d4 - d3 + d5 - d6), 0, d1 / (d1 - d3), vb / total],
        )
        w = np.select(
            [feature == k for k in range(7)], [0, 0, 1, (d4 - d3) / (d4 - d3 + d5 - d6), d2 / (d2 - d6), 0, vc / total]
        )
    return a + v[:, None] * ab + w[:, None] * ac, feature
