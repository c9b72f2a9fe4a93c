"""Magnify, rotate, translate about a centre.

y = R M (x - c) + c + t          M = diag(magnification), R = Rz Ry Rx, x first, axes fixed and right-handed
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from flowgmo.geometry.errors import GeometryError

ORTHOGONAL = 1e-12  # cosine below which two columns count as orthogonal: some rounding errors of a product of rotations


def rotation(degrees: Sequence[float]) -> np.ndarray:
    """R = Rz Ry Rx (3,3) of three angles in degrees; exact for multiples of 90, so that turned boxes stay boxes."""
    (cx, sx), (cy, sy), (cz, sz) = (_cos_sin(angle) for angle in degrees)
    about_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    return about_z @ about_y @ about_x


def _cos_sin(degrees: float) -> tuple[float, float]:
    quarters, rest = divmod(float(degrees), 90.0)
    c, s = np.cos(np.radians(rest)), np.sin(np.radians(rest))
    return [(c, s), (-s, c), (-c, -s), (s, -c)][int(quarters) % 4]


@dataclass(frozen=True)
class Affine:
    """x -> A x + b with A (3,3) and b (3,) in lengths."""

    A: np.ndarray
    b: np.ndarray

    def __call__(self, x: np.ndarray) -> np.ndarray:
        """Points (n,3) moved."""
        return x @ self.A.T + self.b

    def after(self, first: Affine) -> Affine:
        """This map applied after `first`."""
        return Affine(self.A @ first.A, self.A @ first.b + self.b)

    def columns(self) -> tuple[np.ndarray, np.ndarray] | None:
        """A = R diag(s) with R orthogonal (a reflection when A mirrors) and s > 0; None when A shears."""
        s = np.linalg.norm(self.A, axis=0)
        R = self.A / s
        return (R, s) if np.abs(R.T @ R - np.eye(3)).max() < ORTHOGONAL else None


@dataclass(frozen=True)
class Transform:
    """Of one subcomponent or one component.

    magnify is one factor or three, magnify_axes three more that multiply it; rotate in degrees; translate, centre in
    lengths.
    """

    magnify: float | Sequence[float] = 1.0
    magnify_axes: Sequence[float] = (1.0, 1.0, 1.0)
    rotate: Sequence[float] = (0.0, 0.0, 0.0)
    translate: Sequence[float] = (0.0, 0.0, 0.0)
    centre: Sequence[float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        factors = np.asarray(self.magnify, float) * np.asarray(self.magnify_axes, float)
        numbers = np.concatenate([np.ravel(v) for v in (factors, self.rotate, self.translate, self.centre)])
        if not np.isfinite(numbers).all():
            raise GeometryError("a transformation holds a number that is not finite")
        if (factors == 0).any():
            raise GeometryError("a magnification of zero leaves no body: write a factor other than 0")

    @cached_property
    def matrix(self) -> np.ndarray:
        """R M (3,3)."""
        factors = np.broadcast_to(np.asarray(self.magnify, float) * np.asarray(self.magnify_axes, float), 3)
        return rotation(self.rotate) * factors

    @cached_property
    def affine(self) -> Affine:
        """The whole map."""
        centre = np.asarray(self.centre, float)
        return Affine(self.matrix, centre + np.asarray(self.translate, float) - self.matrix @ centre)

    def apply(self, x: np.ndarray) -> np.ndarray:
        """Points (n,3) or one point (3,) from before to after."""
        return self.affine(np.asarray(x, float))

    def inverse(self, x: np.ndarray) -> np.ndarray:
        """Points (n,3) or one point (3,) from after to before."""
        return (np.asarray(x, float) - self.affine.b) @ np.linalg.inv(self.matrix).T
