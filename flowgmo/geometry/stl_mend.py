"""Makes a closed, outward oriented mesh of loose triangles, or says which facets prevent it.

closed     every edge belongs to exactly two facets, once in each direction
outward    a shell inside an even number of others encloses positive volume, inside an odd number negative (cavity)
"""

from __future__ import annotations

import numpy as np

from flowgmo.geometry.errors import GeometryError

MERGE = 1e-9  # of the mesh's size: float32 files repeat a vertex bit by bit, text files digit by digit
SHOWN = 10  # facet numbers listed in a message


def mend(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray, list[str]]:
    """Vertices (v,3), faces (f,3), and notices from corners (f,3,3); facets are numbered from 1 in their order."""
    vertices, faces = _merge(corners)
    number, notices = np.arange(1, len(faces) + 1), []
    degenerate = _degenerate(vertices, faces)
    if degenerate.any():
        notices.append(f"removed {_facets(number[degenerate])} without area")
        faces, number = faces[~degenerate], number[~degenerate]
    if not len(faces):
        raise GeometryError("no facet has an area")
    _, first = np.unique(np.sort(faces, axis=1), axis=0, return_index=True)
    if len(first) < len(faces):
        keep = np.zeros(len(faces), bool)
        keep[first] = True
        notices.append(f"removed {_facets(number[~keep])} given twice")
        faces, number = faces[keep], number[keep]
    neighbours = _neighbours(faces, number)
    faces, shell, flipped = _orient(vertices, faces, neighbours)
    if flipped.any():
        notices.append(f"turned {_facets(number[flipped])} around: the surface now points outward everywhere")
    used, faces = np.unique(faces, return_inverse=True)
    return vertices[used], faces.reshape(-1, 3), notices


def _facets(numbers: np.ndarray) -> str:
    """ "facets 3, 7, 9" with at most ten numbers, then how many there are."""
    listed = ", ".join(str(n) for n in np.sort(numbers)[:SHOWN])
    if len(numbers) == 1:
        return f"facet {listed}"
    return f"facets {listed}" + (f", ... ({len(numbers)} in all)" if len(numbers) > SHOWN else "")


def _merge(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    points = corners.reshape(-1, 3)
    low, size = points.min(0), np.ptp(points, axis=0).max()
    if size == 0:
        raise GeometryError("all vertices are the same point")
    _, first, which = np.unique(
        np.round((points - low) / (MERGE * size)), axis=0, return_index=True, return_inverse=True
    )
    return points[first], which.reshape(-1, 3)


def _degenerate(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Facets (f,) with a repeated corner. A thin one between distinct corners stays: without it the mesh would open."""
    return (faces == np.roll(faces, 1, axis=1)).any(1)


def _edges(faces: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Edge number (3f,), face (3f,), and direction (3f,) of every side of every face."""
    directed = np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    _, edge = np.unique(np.sort(directed, axis=1), axis=0, return_inverse=True)
    return edge.ravel(), np.tile(np.arange(len(faces)), 3), directed[:, 0] < directed[:, 1]


def _neighbours(faces: np.ndarray, number: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Pairs of faces that share an edge and whether they disagree in direction; refuses open and crowded edges."""
    edge, face, forward = _edges(faces)
    count = np.bincount(edge)
    for wrong, text in (
        (count == 1, "open edges, as a missing facet leaves them"),
        (count > 2, "edges of more than two facets"),
    ):
        if wrong.any():
            at = np.unique(number[face[wrong[edge]]])
            raise GeometryError(f"the surface is not closed: {wrong.sum()} {text}, at {_facets(at)}")
    order = np.argsort(edge, kind="stable")
    a, b = order[0::2], order[1::2]
    return face[a], face[b], forward[a] == forward[b]


def _orient(
    vertices: np.ndarray, faces: np.ndarray, neighbours: tuple[np.ndarray, np.ndarray, np.ndarray]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Faces turned to agree and to point outward, their shell (f,), and which were turned (f,)."""
    shell, turn = _spread(len(faces), *neighbours)
    turned = np.where(turn[:, None], faces[:, ::-1], faces)
    for k in range(shell.max() + 1):
        own = shell == k
        probe = vertices[turned[own][0]].mean(0)
        inside = sum(abs(_winding(probe, vertices[turned[shell == j]])) > 0.5 for j in range(shell.max() + 1) if j != k)
        a, b, c = (vertices[turned[own]] - probe).transpose(1, 0, 2)
        volume = (a * np.cross(b, c)).sum() / 6
        if volume == 0:
            raise GeometryError("the surface encloses no volume")
        if (volume > 0) == bool(inside % 2):
            turned[own], turn[own] = turned[own][:, ::-1], ~turn[own]
    return turned, shell, turn


def _spread(n: int, a: np.ndarray, b: np.ndarray, opposed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Shell (n,) and whether to turn (n,) each face so that neighbours agree, going outward ring by ring."""
    start, end, flip = np.r_[a, b], np.r_[b, a], np.r_[opposed, opposed]
    order = np.argsort(start, kind="stable")
    end, flip = end[order], flip[order]
    offset = np.searchsorted(start[order], np.arange(n + 1))
    shell, turn = np.full(n, -1), np.zeros(n, bool)
    for seed in range(n):
        if shell[seed] >= 0:
            continue
        label, ring = shell.max() + 1, np.array([seed])
        shell[seed] = label
        while len(ring):
            sides = np.concatenate([np.arange(offset[f], offset[f + 1]) for f in ring])
            parent = np.repeat(ring, offset[ring + 1] - offset[ring])
            wanted = turn[parent] ^ flip[sides]
            known = shell[end[sides]] >= 0
            if (turn[end[sides]] != wanted)[known].any():
                raise GeometryError("the surface is one-sided: no orientation of its facets agrees everywhere")
            ring, first = np.unique(end[sides][~known], return_index=True)
            shell[ring], turn[ring] = label, wanted[~known][first]
    return shell, turn


def _winding(p: np.ndarray, corners: np.ndarray) -> float:
    """Solid angle / 4π of triangles (f,3,3) seen from p. Source  Van Oosterom & Strackee 1983."""
    a, b, c = (corners - p).transpose(1, 0, 2)
    la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
    over = (a * np.cross(b, c)).sum(1)
    under = la * lb * lc + (a * b).sum(1) * lc + (b * c).sum(1) * la + (c * a).sum(1) * lb
    return float(np.arctan2(over, under).sum() / (2 * np.pi))
