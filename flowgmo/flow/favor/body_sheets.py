"""A body that moves, as the mesh sees it: what its surface is made of, put in its pose.

Most bodies are what lies on the negative side of all their sheets: a box of its six planes, a cylinder of two planes
and a round sheet, a ball of one sheet. Cut by each of them in turn, a cell with an edge of the body in it is exact for
planes, whatever the pose, so that the volume of a box on the mesh does not change as it moves and turns. Others are
made of several such pieces, and what these have in common is found in the same way (body_fold.py). The rest (curved
pieces with inward edges, meshes of many faces) are cut by their own distance: edges by chords.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flowgmo.flow.favor.body_fold import HOLE, SOLID
from flowgmo.flow.favor.body_values import ROUND
from flowgmo.flow.favor.near_surface import Distance, Pose, Shape, placed, turned

ALIGNED = 1.0 - 1e-6  # cosine: a face that lies on another, but for a thousandth of a radian


class Moved(NamedTuple):
    """A body in its pose: planes (m, 4), rounds (q, 7) of body_values.py, curved (c); side (p, m + q + c) int8, roles
    (p,): its pieces by the sides of these sheets (geometry/sheets_by_piece.py).

    distance, bounds (2, 3): of the body as a whole.
    """

    distance: Distance
    bounds: np.ndarray
    planes: np.ndarray
    rounds: np.ndarray
    curved: tuple[Distance, ...]
    side: np.ndarray
    roles: np.ndarray


class Body:
    """A shape given in its place at t = 0, to be put into poses.

    n, h, rounds, curved, side, roles: its sheets by pieces (geometry/sheets_by_piece.py) where the shape tells them,
    else its distance, one sheet. exact: no piece is known by its distance only.
    """

    def __init__(self, shape: Shape) -> None:
        self.shape = shape
        self._bounds = shape.bounds()
        found = getattr(shape, "sheets_by_piece", None)
        self.exact = found is not None and found.exact
        if found is None:
            self.n, self.h, self.rounds = np.zeros((0, 3)), np.zeros(0), np.zeros((0, ROUND))
            self.curved, self.side, self.roles = (shape.distance,), np.array([[-1]], np.int8), np.array([SOLID])
        else:
            self.n, self.h, self.rounds, self.curved, self.side, self.roles = found[:6]
        of = self.side[:, : len(self.h)] * np.where(np.asarray(self.roles) == HOLE, -1, 1)[:, None]
        self._inwards = (of > 0).any(axis=0) * 1.0 - (of < 0).any(axis=0)  # which way planes stand back: along their
        # normal, against it, 0 of planes that pieces share

    def distance(self, x: np.ndarray) -> np.ndarray:
        """Signed distance (n,) of points (n, 3), in its place at t = 0."""
        return self.shape.distance(x)

    def bounds(self) -> np.ndarray:
        """Box (2, 3), in its place at t = 0."""
        return self._bounds

    def faces_towards(self, R: np.ndarray, directions: np.ndarray) -> tuple[bool, ...]:
        """Which of its planes, turned by R, face any of the directions (k, 3) of unit length; of a body without planes
        all that it is, if there are any."""
        if not len(directions):
            return ()
        if not len(self.h):
            return (True,)
        outward = -self._inwards[:, None] * (self.n @ R.T)
        return tuple((outward @ directions.T > ALIGNED).any(axis=1).tolist())

    def moved(self, pose: Pose) -> Moved:
        """The body at x = R x0 + t."""
        distance, bounds = placed(self, pose)
        n = self.n @ pose.R.T
        back = pose.back * self._inwards * pose.set_back if len(pose.set_back) == len(n) else 0.0
        planes = np.column_stack([n, self.h + n @ pose.t + back])
        rounds = self.rounds.copy()
        rounds[:, :3] = self.rounds[:, :3] @ pose.R.T + pose.t
        rounds[:, 3:6] = self.rounds[:, 3:6] @ pose.R.T
        whole = pose if len(n) == 0 else pose._replace(set_back=())
        curved = tuple(turned(d, whole) for d in self.curved)
        return Moved(distance, bounds, planes, rounds, curved, self.side, self.roles)
