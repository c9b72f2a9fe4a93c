"""A closed surface of few planes divided into convex cells: binary space partition by the planes of its own faces.

A region, all space at first, is divided by the plane of a face in it; faces that the plane crosses are divided too. A
side without faces lies wholly inside, where the faces in the plane turn their backs to it, or wholly outside. The plane
that crosses fewest faces comes first.

Source  Fuchs, Kedem & Naylor 1980; Thibault & Naylor 1987 (solids).
"""

from __future__ import annotations

import numpy as np

ON = 1e-9  # of the surface's size: corners this near a plane lie in it (flat faces of files are flat to rounding only)
MOST = 64  # cells: more stand for a curved surface

Cell = tuple[np.ndarray, np.ndarray, tuple]


def convex_cells(corners: np.ndarray, n: np.ndarray, h: np.ndarray) -> list[Cell]:
    """Disjoint convex cells whose union the surface holds: planes (m, 3), (m,), n . x < h inside, and no curved ones.

    corners (f, 3, 3) of closed outward oriented triangles; n (p, 3), h (p,): their planes, each once, either way.
    Nothing where there are more than MOST, or triangles that lie in none of the planes.
    """
    size = float(np.ptp(corners.reshape(-1, 3), axis=0).max())
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    faces = []
    for triangle, normal in zip(corners, normals, strict=True):
        away = np.abs(triangle @ n.T - h).max(axis=0)
        plane = int(away.argmin())
        if away[plane] > ON * size:
            return []
        if normal.any():
            faces.append((plane, 1 if normal @ n[plane] > 0.0 else -1, triangle))
    cells: list[list[tuple[int, int]]] = []
    waiting = [(faces, [])]
    while waiting:
        faces, limits = waiting.pop()
        plane = _best(faces, n, h, ON * size)
        sides, facing = _divide(faces, plane, n[plane], h[plane], ON * size)
        for side, others in zip((-1, 1), sides, strict=True):
            if others:
                waiting.append((others, [*limits, (plane, side)]))
            elif facing == -side:
                cells.append([*limits, (plane, side)])
        if len(cells) + len(waiting) > MOST:
            return []
    return [_cell(limits, n, h) for limits in cells]


def _cell(limits: list[tuple[int, int]], n: np.ndarray, h: np.ndarray) -> Cell:
    planes, sides = (np.array(column) for column in zip(*limits, strict=True))
    return -sides[:, None] * n[planes], -sides * h[planes], ()


def _best(faces: list, n: np.ndarray, h: np.ndarray, on: float) -> int:
    """The plane of a face that crosses fewest others; of several the one that has most faces in it, then the first."""
    own = [f[0] for f in faces]
    rank = []
    for plane in sorted(set(own)):
        away = [f[2] @ n[plane] - h[plane] for f in faces if f[0] != plane]
        crossed = sum(bool((d > on).any() and (d < -on).any()) for d in away)
        rank.append((crossed, -own.count(plane), plane))
    return min(rank)[2]


def _divide(faces: list, plane: int, n: np.ndarray, h: float, on: float) -> tuple[tuple[list, list], int]:
    """Faces on the negative and positive side of a plane, and the side to which most of the area in it faces."""
    below, above, facing = [], [], 0.0
    for face in faces:
        if face[0] == plane:
            facing += face[1] * _area(face[2])
            continue
        d = face[2] @ n - h
        d = np.where(np.abs(d) <= on, 0.0, d)
        for side, into in ((-1, below), (1, above)):
            if (side * d > 0.0).any():
                into.append((face[0], face[1], _clip(face[2], side * d)))
    return (below, above), 1 if facing > 0.0 else -1


def _clip(corners: np.ndarray, d: np.ndarray) -> np.ndarray:
    """The part of a polygon (k, 3) where d (k,) is not negative."""
    out = []
    for a in range(len(d)):
        b = (a + 1) % len(d)
        if d[a] >= 0.0:
            out.append(corners[a])
        if d[a] * d[b] < 0.0:
            out.append(corners[a] + d[a] / (d[a] - d[b]) * (corners[b] - corners[a]))
    return np.array(out)


def _area(corners: np.ndarray) -> float:
    return 0.5 * float(np.linalg.norm(np.cross(corners[1:-1] - corners[0], corners[2:] - corners[0]).sum(axis=0)))
