"""The edges of a closed triangle mesh: which face lies beyond each, and how far the surface bends there.

    bend = angle from the face's normal to the normal beyond the edge, positive where convex, negative where concave

Flat is what is coplanar to 1e-6 rad, or to the rounding of the file that a mesh was read from: in single precision the
small faces of a plane differ by more than 1e-6 rad. Faces joined by flat edges are a patch. They share one normal, the
mean by area, so that whatever slides over the plane meets the same normal, bit by bit, on all of its triangles.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

THIN = 1e-9  # of the mesh's size: lower triangles have no normal; vertices so close are one (stl_mend.MERGE)
FLAT = 1e-6  # rad: bends that count as none
SLIGHT = 1e-2  # rad: more bend is never rounding, however small the faces
CHUNK = 10_000_000  # numbers at once: 80 MB


class Surface(NamedTuple):
    """vertices (v,3); faces (f,3), outward; normal (f,3), unit.

    across, bend (f,3): of the edge from corner k to corner k + 1 the face beyond it, -1 where the mesh is open or has
    more than two faces, and the bend [rad], 0 where flat; patch (f,): number of the plane that a face is part of.
    """

    vertices: np.ndarray
    faces: np.ndarray
    normal: np.ndarray
    across: np.ndarray
    bend: np.ndarray
    patch: np.ndarray

    @property
    def size(self) -> float:
        """Largest extent [length]."""
        return float(np.ptp(self.vertices, axis=0).max())

    def inside_out(self) -> Surface:
        """The same surface with the matter on its other side."""
        order = [1, 0, 2]  # corners c b a: their edges are the old ones b c, a b, c a
        across, bend = self.across[:, order], 0.0 - self.bend[:, order]
        return Surface(self.vertices, self.faces[:, ::-1], -self.normal, across, bend, self.patch)


def surface_of(vertices: np.ndarray, faces: np.ndarray, rounding: float = 0.0) -> Surface:
    """The surface of a mesh: vertices (v,3), faces (f,3) outward. Faces too thin to have a normal are left out.

    rounding [length]: how far its points may be off.
    """
    faces = faces[(faces != np.roll(faces, 1, axis=1)).all(1)]
    corners = vertices[faces]
    sides = np.roll(corners, -1, axis=1) - corners
    area = np.cross(sides[:, 0], sides[:, 1])
    doubled = np.linalg.norm(area, axis=1)
    size = float(np.ptp(vertices, axis=0).max())
    thin = doubled <= THIN * size * np.linalg.norm(sides, axis=2).max(1)
    across = _past_thin(_across(faces), faces, vertices, thin)
    kept = np.flatnonzero(~thin)
    number = np.full(len(faces) + 1, -1)  # the last entry is that of -1, no face
    number[kept] = np.arange(len(kept))
    faces, across, area, sides = faces[kept], number[across[kept]], area[kept], sides[kept]
    normal = area / doubled[kept, None]
    bend = _bend(normal, across, sides)
    off = _height_off(vertices, faces, normal, across) <= 2 * rounding  # 2: the point's and the plane's
    flat = (across >= 0) & ((np.abs(bend) <= FLAT) | (np.abs(bend) <= SLIGHT) & off)
    bend[flat] = 0.0
    patch = _patches(across, flat)
    slack = max(THIN * size, 2 * rounding)
    return Surface(vertices, faces, _plane_normals(vertices, faces, normal, area, patch, slack), across, bend, patch)


def _across(faces: np.ndarray) -> np.ndarray:
    """Face beyond each edge (f,3), -1 unless exactly two faces share it in opposite directions."""
    start, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    key = np.minimum(start, end) * (int(faces.max(initial=0)) + 1) + np.maximum(start, end)
    order = np.argsort(key, kind="stable")
    same = key[order][1:] == key[order][:-1]
    pair = same & ~np.r_[False, same[:-1]] & ~np.r_[same[1:], False]
    a, b = order[:-1][pair], order[1:][pair]
    a, b = a[start[a] == end[b]], b[start[a] == end[b]]
    across = np.full(faces.size, -1)
    across[a], across[b] = b // 3, a // 3
    return across.reshape(-1, 3)


def _past_thin(across: np.ndarray, faces: np.ndarray, vertices: np.ndarray, thin: np.ndarray) -> np.ndarray:
    """`across` with thin faces skipped: beyond a short side lies what is beyond the long one, and the reverse."""
    if not thin.any():
        return across
    length = np.linalg.norm(np.roll(vertices[faces], -1, axis=1) - vertices[faces], axis=2)
    order = np.argsort(length, axis=1)
    exit_side = np.empty_like(faces)
    np.put_along_axis(exit_side, order, np.stack([order[:, 2], order[:, 2], order[:, 1]], axis=1), axis=1)
    across = across.copy()
    for face, side in np.argwhere((across >= 0) & thin[across] & ~thin[:, None]):
        came, here = face, across[face, side]
        for _ in range(len(faces)):
            if here < 0 or not thin[here]:
                break
            entry = int(np.argmax(across[here] == came))
            came, here = here, across[here, exit_side[here, entry]]
        across[face, side] = here if here < 0 or not thin[here] else -1
    return across


def _bend(normal: np.ndarray, across: np.ndarray, sides: np.ndarray) -> np.ndarray:
    """Signed angle (f,3) to the normal beyond each edge; 0 where there is none."""
    along = sides / np.linalg.norm(sides, axis=2, keepdims=True)
    other = normal[across]
    sine = (np.cross(normal[:, None], other) * along).sum(2)
    return np.where(across >= 0, np.arctan2(sine, (normal[:, None] * other).sum(2)), 0.0)


def _height_off(vertices: np.ndarray, faces: np.ndarray, normal: np.ndarray, across: np.ndarray) -> np.ndarray:
    """Distance (f,3) of two faces from one plane: of the corners of either from the other's plane, the smaller one."""
    h = (vertices[faces[:, 0]] * normal).sum(1)
    there = np.abs(np.einsum("fkcx,fx->fkc", vertices[faces[across]], normal) - h[:, None, None]).max(2)
    back = np.abs(np.einsum("fcx,fkx->fkc", vertices[faces], normal[across]) - h[across][..., None]).max(2)
    return np.minimum(there, back)


def _patches(across: np.ndarray, flat: np.ndarray) -> np.ndarray:
    """Number (f,) of the patch of each face: faces joined by flat edges."""
    from scipy.sparse import coo_matrix  # only scenes with meshes pay for loading it
    from scipy.sparse.csgraph import connected_components

    face, side = np.nonzero(flat)
    n = len(across)
    graph = coo_matrix((np.ones(len(face), bool), (face, across[face, side])), shape=(n, n))
    return connected_components(graph, directed=False)[1]


def _plane_normals(
    vertices: np.ndarray, faces: np.ndarray, normal: np.ndarray, area: np.ndarray, patch: np.ndarray, slack: float
) -> np.ndarray:
    """Normals (f,3): the mean of the patch where its corners lie on one plane, else the face's own."""
    total = np.stack([np.bincount(patch, area[:, k]) for k in range(3)], axis=1)
    mean = (total / np.linalg.norm(total, axis=1, keepdims=True))[patch]
    first = np.zeros(patch.max(initial=0) + 1, int)
    first[patch[::-1]] = faces[::-1, 0]
    gap = vertices[faces] - vertices[first[patch]][:, None]
    off = np.abs((gap * mean[:, None]).sum(2)).max(1)
    worst = np.zeros(len(first))
    np.maximum.at(worst, patch, off)
    return np.where((worst <= slack)[patch, None], mean, normal)


def convex_corners(surface: Surface, rounding: float = 0.0) -> np.ndarray | None:
    """Corners (k,3) of the polytope that a surface bounds; None when it is not convex.

    Convex: no edge is open or concave, and every vertex lies below every face plane to 1e-9 of the size or the rounding
    [length] of points. Vertices inside faces or straight edges are left out: a corner touches three planes.
    """
    if (surface.across < 0).any() or (surface.bend < 0).any():
        return None
    _, one = np.unique(surface.patch, return_index=True)
    used = np.unique(surface.faces)
    vertices, normal = surface.vertices[used] - surface.vertices[used].mean(0), surface.normal[one]
    h = (surface.vertices[surface.faces[one, 0]] * normal).sum(1) - normal @ surface.vertices[used].mean(0)
    slack = max(THIN * surface.size, 2 * rounding)
    step = max(1, CHUNK // len(vertices))
    for k in range(0, len(one), step):
        if ((vertices @ normal[k : k + step].T).max(0) > h[k : k + step] + slack).any():
            return None
    pairs = np.unique(np.stack([surface.faces.ravel(), np.repeat(surface.patch, 3)]), axis=1)
    return surface.vertices[np.bincount(pairs[0], minlength=len(surface.vertices)) >= 3]
