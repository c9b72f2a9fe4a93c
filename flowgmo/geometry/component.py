"""A whole body: its pieces applied in order, then the component's transform.

    solid        S <- S or P           d <- min(d, d_P)
    hole         S <- S without P      d <- max(d, -d_P)
    complement   S <- S or not P       d <- min(d, -d_P)

Pieces that are together one exact shape (merge.py) are that shape. Else |d| is exact where the nearest surface of a
piece is part of the body's surface, and a lower bound elsewhere: inside overlaps of a union, outside near the rim of a
hole or of limiters that cut a quadric. The sign is always right. So stepping by |d| never crosses the surface, but for
general quadrics with √(x² + y²) (root_quadric.py), whose distance may be too large.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from flowgmo.geometry.errors import GeometryError
from flowgmo.geometry.lattice import Lattice
from flowgmo.geometry.mass import mass_properties
from flowgmo.geometry.merge import merge
from flowgmo.geometry.moments import MassProperties
from flowgmo.geometry.piece import ROLES, Piece
from flowgmo.geometry.primitives import Ball, Box, Mesh
from flowgmo.geometry.recognise import recognise
from flowgmo.geometry.revolved import WHOLE, Revolved
from flowgmo.geometry.sheets import Sheets, sheets_of
from flowgmo.geometry.sheets_by_piece import PieceSheets, sheets_by_piece
from flowgmo.geometry.solid import Solid
from flowgmo.geometry.transform import Affine, Transform
from flowgmo.geometry.triangulate import triangles


@dataclass(frozen=True, eq=False)
class OrientedBox:
    """lo <= axes @ (x - origin) <= hi; axes (3,3) has unit rows; lo, hi (3,) may be ±inf."""

    origin: np.ndarray
    axes: np.ndarray
    lo: np.ndarray
    hi: np.ndarray


class Component:
    """A body in space coordinates at t = 0, made of pieces in their order and one transform of the whole."""

    def __init__(self, pieces: Sequence[Piece], transform: Transform | None = None) -> None:
        self.pieces, self.transform = tuple(pieces), transform or Transform()
        self.roles = tuple(piece.role for piece in self.pieces)
        if any(role not in ROLES for role in self.roles):
            raise GeometryError(f"the role of a subcomponent is one of {', '.join(ROLES)}")
        if all(role == "hole" for role in self.roles):
            raise GeometryError("the component has no solid subcomponent, so there is nothing that a hole could cut")
        whole = self.transform.affine
        self.solids: tuple[Solid, ...] = tuple(_recognise(piece, whole) for piece in self.pieces)
        self.merged = merge(self.roles, self.solids)
        if self.merged is not None and not (self.bounds()[0] < self.bounds()[1]).all():
            raise GeometryError("nothing is left of the component: the holes cut away all that is solid")

    def __reduce__(self) -> tuple:
        """Copied and stored as what it was made of."""
        return Component, (self.pieces, self.transform)

    def distance(self, x: np.ndarray) -> np.ndarray:
        """Signed distance (n,) of points (n,3), negative inside; exact or a lower bound of the size, see above."""
        x = np.asarray(x, float)
        return self.merged.distance(x) if self.merged is not None else self._fold(x)[0]

    def normal(self, x: np.ndarray) -> np.ndarray:
        """Outward unit normal (n,3) of the surface nearest to points (n,3)."""
        x = np.asarray(x, float)
        if self.merged is not None:
            return self.merged.normal(x)
        _, which, sign = self._fold(x)
        normals = np.empty((len(x), 3))
        for k in np.unique(which):
            normals[which == k] = self.solids[k].normal(x[which == k])
        return sign[:, None] * normals

    def _fold(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Distance (n,), the piece it is to (n,), and +1 where that piece's own normal points outward (n,)."""
        d, which, sign = np.full(len(x), np.inf), np.zeros(len(x), int), np.ones(len(x))
        for k, (role, solid) in enumerate(zip(self.roles, self.solids, strict=True)):
            outward = 1.0 if role == "solid" else -1.0
            new = outward * solid.distance(x)
            better = new > d if role == "hole" else new < d
            d, which, sign = np.where(better, new, d), np.where(better, k, which), np.where(better, outward, sign)
        return d, which, sign

    @cached_property
    def sheets(self) -> Sheets:
        """The smooth surfaces that its faces are parts of."""
        return sheets_of(self)

    @cached_property
    def sheets_by_piece(self) -> PieceSheets:
        """The same by pieces, each of them convex: which side of which sheet it lies on."""
        return sheets_by_piece(self)

    def owner(self, x: np.ndarray) -> np.ndarray:
        """Number (n,) of the piece that fills points (n,3), the later one where two overlap; -1 outside the body."""
        number = np.full(len(x), -1)
        for k, (role, solid) in enumerate(zip(self.roles, self.solids, strict=True)):
            within = solid.inside(x) ^ (role == "complement")
            number[within] = -1 if role == "hole" else k
        return number

    def inside(self, x: np.ndarray) -> np.ndarray:
        """Membership (n,) of points (n,3), exact; a point on the surface may count either way."""
        x = np.asarray(x, float)
        return self.merged.inside(x) if self.merged is not None else self.owner(x) >= 0

    def bounds(self) -> np.ndarray:
        """Box (2,3) that holds the body, tight for exact shapes and unions of them; ±inf where unbounded."""
        if self.merged is not None:
            return self.merged.bounds()
        if "complement" in self.roles:
            return np.array([[-np.inf] * 3, [np.inf] * 3])
        boxes = np.array([s.bounds() for role, s in zip(self.roles, self.solids, strict=True) if role == "solid"])
        return np.array([boxes[:, 0].min(0), boxes[:, 1].max(0)])

    def mass_properties(self, density: float | None = None) -> MassProperties:
        """Mass, volume, centre, and inertia about it; `density` holds for pieces without their own.

        Where pieces overlap, the density of the later one holds. GeometryError when the body is unbounded.
        """
        return mass_properties(self, density)

    def triangles(self, resolution: int = 48, clip: np.ndarray | None = None) -> Mesh:
        """Closed, outward oriented surface: vertices (v,3), faces (f,3).

        `resolution` steps around a circle or along the longest side; clip (2,3): a box that bounds infinite bodies.
        """
        return triangles(self, resolution, clip)

    def as_sphere(self) -> tuple[np.ndarray, float] | None:
        """Centre (3,) and radius when the body is exactly one sphere."""
        solid = self.merged
        if solid is None or not isinstance(solid.shape, Ball):
            return None
        return solid.b.copy(), float(solid.scale * solid.shape.radius)

    def as_revolved(self) -> tuple[np.ndarray, np.ndarray] | None:
        """A point (3,) of the axis and its direction (3,) when the body is exactly one whole solid of revolution."""
        solid = self.merged
        if solid is None or not isinstance(solid.shape, Revolved) or solid.shape.angle != WHOLE:
            return None
        return solid.b.copy(), solid.R[:, 2].copy()

    def as_boxes(self) -> list[OrientedBox] | None:
        """Boxes whose union the body exactly is: its own when all are solid, else disjoint ones that fill it."""
        if all(role == "solid" and isinstance(s.shape, Box) for role, s in zip(self.roles, self.solids, strict=True)):
            return [_oriented(solid, solid.shape) for solid in self.solids]
        if self.merged is not None and isinstance(self.merged.shape, Lattice):
            return [_oriented(self.merged, box) for box in self.merged.shape.boxes]
        return None

    def describe(self) -> str:
        """The body in words."""
        boxes, solid = self.as_boxes(), self.roles == ("solid",) * len(self.roles)
        if len(self.pieces) == 1 and solid:
            return self.solids[0].describe()
        if solid and boxes:
            return f"union of {len(boxes)} boxes"
        names = {"solid": "", "hole": "minus ", "complement": "all but "}
        parts = [names[role] + s.describe() for role, s in zip(self.roles, self.solids, strict=True)]
        shown = "; ".join(parts) if len(parts) <= 4 else "; ".join(parts[:3]) + f"; and {len(parts) - 3} more"
        return f"{len(parts)} pieces: {shown}" if len(parts) > 1 else shown


def _recognise(piece: Piece, whole: Affine) -> Solid:
    try:
        return recognise(piece, whole)
    except GeometryError as error:
        raise GeometryError(f"subcomponent {piece.name}: {error}" if piece.name else str(error)) from None


def _oriented(solid: Solid, box: Box) -> OrientedBox:
    return OrientedBox(solid.b.copy(), solid.R.T.copy(), solid.scale * box.lo, solid.scale * box.hi)
