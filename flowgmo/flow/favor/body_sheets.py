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

from flowgmo.flow.favor.body_cut import MOST_SHEETS
from flowgmo.flow.favor.body_values import ROUND
from flowgmo.flow.favor.near_surface import Distance, Pose, Shape, placed
from flowgmo.flow.favor.sheets import MANY

POINTS = 4096  # at which a body is compared with its sheets: a part that they do not give is smaller than one of these
FITTED = 64  # points where a curved sheet is compared with a ball and a cylinder
FIT = 1e-13  # of the body's size: what both may differ by
ALIKE = 1e-9  # of the body's size: two triangles of one flat face have planes that differ by rounding


class Moved(NamedTuple):
    """A body in its pose, where all its sheets are negative: planes (m, 4), rounds (q, 8) of body_values.py, curved.

    distance, bounds (2, 3): of the body as a whole.
    """

    distance: Distance
    bounds: np.ndarray
    planes: np.ndarray
    rounds: np.ndarray
    curved: tuple[Distance, ...]


class Body:
    """A shape given in its place at t = 0, to be put into poses.

    n (m, 3), h (m,): its planes; rounds (q, 8); curved: its other sheets. exact: it is what its sheets bound; else its
    distance stands for them.
    """

    def __init__(self, shape: Shape) -> None:
        self.shape = shape
        self.n, self.h, self.curved = np.zeros((0, 3)), np.zeros(0), (shape.distance,)
        found = _sheets(shape)
        self.exact = found is not None
        if found is not None:
            self.n, self.h, self.curved = found
        self._bounds = shape.bounds()
        middle, half = _box(self._bounds)
        fitted = [round_sheet(d, middle, half) for d in self.curved]
        self.curved = tuple(d for d, f in zip(self.curved, fitted, strict=True) if f is None)
        self.rounds = np.array([f for f in fitted if f is not None]).reshape(-1, ROUND)

    def distance(self, x: np.ndarray) -> np.ndarray:
        """Signed distance (n,) of points (n, 3), in its place at t = 0."""
        return self.shape.distance(x)

    def bounds(self) -> np.ndarray:
        """Box (2, 3), in its place at t = 0."""
        return self._bounds

    def moved(self, pose: Pose) -> Moved:
        """The body at x = R x0 + t."""
        distance, bounds = placed(self, pose)
        n = self.n @ pose.R.T
        planes = np.column_stack([n, self.h + n @ pose.t])
        rounds = self.rounds.copy()
        rounds[:, :3] = self.rounds[:, :3] @ pose.R.T + pose.t
        rounds[:, 3:6] = self.rounds[:, 3:6] @ pose.R.T
        return Moved(distance, bounds, planes, rounds, tuple(_turned(d, pose) for d in self.curved))


def _turned(distance: Distance, pose: Pose) -> Distance:
    return lambda x: distance((x - pose.t) @ pose.R)


def _box(bounds: np.ndarray) -> tuple[np.ndarray, float]:
    """Middle (3,) and half the diagonal of bounds (2, 3); those of a unit box where there are none."""
    low, high = bounds
    if not np.isfinite(high - low).all():
        return np.zeros(3), 1.0
    return 0.5 * (low + high), 0.5 * float(np.linalg.norm(high - low))


def round_sheet(distance: Distance, middle: np.ndarray, size: float) -> np.ndarray | None:
    """Numbers (8,) of the ball or cylinder whose distance this is, but for rounding; None for all others.

    d = s (|w| - r) with w = P y - c, P = I - a a, gives   d^2 = y . P y - 2 c . y - 2 s r d + (c . c - r^2),   linear
    in what is sought: P, c, s r. The axis a is where P is 0; a ball has none.
    """
    y = 2.0 * _spread(FITTED) - 1.0
    d = distance(middle + size * y) / size
    if not np.isfinite(d).all():
        return None
    squares = y[:, [0, 1, 2, 1, 0, 0]] * y[:, [0, 1, 2, 2, 2, 1]]
    terms = np.column_stack([squares, -2.0 * y, -2.0 * d, np.ones(len(y))])
    xx, yy, zz, yz, xz, xy, cx, cy, cz, sr, _ = np.linalg.lstsq(terms, d * d, rcond=None)[0]
    along, axes = np.linalg.eigh(np.array([[xx, xy / 2, xz / 2], [xy / 2, yy, yz / 2], [xz / 2, yz / 2, zz]]))
    axis = axes[:, 0] if along[0] < 0.5 else np.zeros(3)
    axis = np.where(np.abs(axis) < FIT, 0.0, axis)
    c = np.array([cx, cy, cz])
    c -= axis * (c @ axis)
    r, s = abs(sr), np.sign(sr)
    across = y - np.outer(y @ axis, axis)
    if r == 0.0 or not np.abs(s * (np.linalg.norm(across - c, axis=1) - r) - d).max() <= FIT:
        return None
    return np.concatenate([middle + size * c, axis, [size * r, s]])


def _sheets(shape: Shape) -> tuple[np.ndarray, np.ndarray, tuple] | None:
    """Planes and curved sheets with the body on the negative side of each; None where that is not the body."""
    sheets = getattr(shape, "sheets", None)
    low, high = shape.bounds()
    if sheets is None or not np.isfinite(high - low).all() or not (low < high).all():
        return None
    n, h = _different(sheets.n, sheets.h, 0.5 * (low + high), np.linalg.norm(high - low))
    if len(n) > MANY or len(n) + len(sheets.curved) > MOST_SHEETS:
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
