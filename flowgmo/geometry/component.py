"""A whole body: its pieces applied in order, then the component's transform.

    solid        S <- S or P           d <- min(d, d_P)
    hole         S <- S without P      d <- max(d, -d_P)
    complement   S <- S or not P       d <- min(d, -d_P)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from flowgmo.geometry.errors import GeometryError
from flowgmo.geometry.moments import NOTHING, MassProperties, mass_properties_from
from flowgmo.geometry.piece import ROLES, Piece
from flowgmo.geometry.primitives import Ball, Box, Mesh
from flowgmo.geometry.recognise import recognise
from flowgmo.geometry.solid import Solid
from flowgmo.geometry.transform import Transform


@dataclass(frozen=True, eq=False)
class OrientedBox:
    """lo <= axes @ (x - origin) <= hi; axes (3,3) has unit rows; lo, hi (3,) may be ±inf."""

    origin: np.ndarray
    axes: np.ndarray
    lo: np.ndarray
    hi: np.ndarray


class Component:
    """A body in space coordinates at t = 0."""

    def __init__(self, pieces: Sequence[Piece], transform: Transform | None = None) -> None:
        if not pieces:
            raise GeometryError("the component has no subcomponent")
        whole = (transform or Transform()).affine
        self.pieces = tuple(pieces)
        self.solids: tuple[Solid, ...] = tuple(recognise(piece, whole) for piece in pieces)
        if any(piece.role not in ROLES for piece in pieces):
            raise GeometryError(f"a role is one of {', '.join(ROLES)}")

    def distance(self, x: np.ndarray) -> np.ndarray:
        """Signed distance (n,) of points (n,3), negative inside."""
        return self._nearest(x)[0]

    def normal(self, x: np.ndarray) -> np.ndarray:
        """Outward unit normal (n,3) of the surface nearest to points (n,3)."""
        _, which, sign = self._nearest(x)
        normals = np.empty((len(which), 3))
        for k, solid in enumerate(self.solids):
            normals[which == k] = solid.normal(x[which == k])
        return sign[:, None] * normals

    def _nearest(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        d, which, sign = np.full(len(x), np.inf), np.zeros(len(x), int), np.ones(len(x))
        for k, (piece, solid) in enumerate(zip(self.pieces, self.solids, strict=True)):
            outward = 1.0 if piece.role == "solid" else -1.0
            new = outward * solid.distance(x)
            better = new > d if piece.role == "hole" else new < d
            d, which, sign = np.where(better, new, d), np.where(better, k, which), np.where(better, outward, sign)
        return d, which, sign

    def inside(self, x: np.ndarray) -> np.ndarray:
        """Membership (n,) of points (n,3); the surface belongs to the body."""
        return self.distance(x) <= 0

    def bounds(self) -> np.ndarray:
        """Box (2,3) that holds the body; ±inf where unbounded."""
        boxes = np.array([s.bounds() for p, s in zip(self.pieces, self.solids, strict=True) if p.role == "solid"])
        return np.array([boxes[:, 0].min(0), boxes[:, 1].max(0)])

    def mass_properties(self, density: float | None = None) -> MassProperties:
        """Mass, centre, inertia; `density` holds for pieces without their own."""
        volume, weighted = 0.0, NOTHING
        for piece, solid in zip(self.pieces, self.solids, strict=True):
            moments = solid.moments()
            volume += moments.m0
            weighted = weighted.plus(moments.times(piece.density or density))
        return mass_properties_from(volume, weighted)

    def triangles(self, resolution: int = 48, clip: np.ndarray | None = None) -> Mesh:
        """Closed surface, outward oriented."""
        raise NotImplementedError

    def as_sphere(self) -> tuple[np.ndarray, float] | None:
        """Centre and radius when the body is exactly one sphere."""
        solid = self.solids[0]
        if len(self.solids) > 1 or not isinstance(solid.shape, Ball) or self.pieces[0].role != "solid":
            return None
        return solid.b.copy(), solid.scale * solid.shape.radius

    def as_boxes(self) -> list[OrientedBox] | None:
        """Boxes whose union the body exactly is."""
        if any(p.role != "solid" or not isinstance(s.shape, Box) for p, s in zip(self.pieces, self.solids, strict=True)):
            return None
        return [OrientedBox(s.b, s.R.T, s.scale * s.shape.lo, s.scale * s.shape.hi) for s in self.solids]

    def describe(self) -> str:
        """In words."""
        return self.solids[0].describe()
