"""A body that moves, as the mesh sees it: what its surface is made of, put in its pose.

Most bodies are what lies on the negative side of all their sheets: a box of its six planes, a cylinder of two planes
and a round sheet, a ball of one sheet. Cut by each of them in turn, a cell with an edge of the body in it is exact for
planes, whatever the pose, so that the volume of a box on the mesh does not change as it moves and turns. Whether a body
is of this kind is found once, at points all over it. All others (holes, several pieces, meshes that are not convex)
are cut by their own distance: edges by chords.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flowgmo.flow.favor.near_surface import Distance, Pose, Shape, placed
from flowgmo.flow.favor.sheets import MANY

POINTS = 4096  # at which a body is compared with its sheets: a part that they do not give is smaller than one of these
ALIKE = 1e-9  # of the body's size: two triangles of one flat face have planes that differ by rounding


class Moved(NamedTuple):
    """A body in its pose, where it is negative: all n . x - h, n (m, 3), h (m,) [length], and all `curved`.

    distance, bounds (2, 3): of the body as a whole. exact: it is what its sheets bound; else curved is its distance.
    """

    distance: Distance
    bounds: np.ndarray
    n: np.ndarray
    h: np.ndarray
    curved: tuple[Distance, ...]
    exact: bool


class Body:
    """A shape given in its place at t = 0, to be put into poses."""

    def __init__(self, shape: Shape) -> None:
        self.shape = shape
        self.n, self.h, self.curved = np.zeros((0, 3)), np.zeros(0), (shape.distance,)
        self.exact = False
        found = _sheets(shape)
        if found is not None:
            self.n, self.h, self.curved = found
            self.exact = True

    def moved(self, pose: Pose) -> Moved:
        """The body at x = R x0 + t."""
        distance, bounds = placed(self.shape, pose)
        n = self.n @ pose.R.T
        curved = tuple(_turned(d, pose) for d in self.curved)
        return Moved(distance, bounds, n, self.h + n @ pose.t, curved, self.exact)


def _turned(distance: Distance, pose: Pose) -> Distance:
    return lambda x: distance((x - pose.t) @ pose.R)


def _sheets(shape: Shape) -> tuple[np.ndarray, np.ndarray, tuple] | None:
    """Planes and curved sheets with the body on the negative side of each; None where that is not the body."""
    sheets = getattr(shape, "sheets", None)
    low, high = shape.bounds()
    if sheets is None or not np.isfinite(high - low).all() or not (low < high).all():
        return None
    n, h = _different(sheets.n, sheets.h, 0.5 * (low + high), np.linalg.norm(high - low))
    if len(n) > MANY:
        return None
    x = low + (high - low) * _spread(POINTS)
    inside = shape.distance(x) < 0.0
    if not inside.any():
        return None
    planes = x @ n.T - h
    turn = np.where((planes[inside] > 0.0).mean(axis=0) > 0.5, -1.0, 1.0)
    values = np.column_stack([planes * turn, *(d(x) for d in sheets.curved)])
    if not ((values < 0.0).all(axis=1) == inside).all():
        return None
    return n * turn[:, None], h * turn, tuple(sheets.curved)


def _different(n: np.ndarray, h: np.ndarray, middle: np.ndarray, size: float) -> tuple[np.ndarray, np.ndarray]:
    """Each plane once."""
    kept: list[int] = []
    away = n @ middle - h
    for m in range(len(n)):
        alike = [k for k in kept if abs(n[k] - n[m]).max() <= ALIKE and abs(away[k] - away[m]) <= ALIKE * size]
        if not alike:
            kept.append(m)
        if len(kept) > MANY:
            break
    return n[kept], h[kept]


def _spread(count: int) -> np.ndarray:
    """Points (count, 3) all over the unit cube: additive recurrence with the roots of x^4 = x + 1 (Roberts 2018)."""
    g = 1.22074408460575947536  # the positive root
    return (0.5 + np.arange(1, count + 1)[:, None] * np.array([1 / g, 1 / g**2, 1 / g**3])) % 1.0
