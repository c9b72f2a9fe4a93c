"""A shape put in its place: x = s R y + b, y in the shape's own frame.

d(x) = s d_own(Rᵀ (x - b) / s)          exact under a similarity (rotation, reflection, one magnification)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flowgmo.geometry.moments import Moments
from flowgmo.geometry.primitives import Mesh, Shape
from flowgmo.geometry.transform import Affine


@dataclass(frozen=True, eq=False)
class Solid:
    """A shape, its scale s, orthogonal axes R (3,3), and origin b (3,)."""

    shape: Shape
    scale: float
    R: np.ndarray
    b: np.ndarray

    @property
    def place(self) -> Affine:
        """Own frame to space."""
        return Affine(self.scale * self.R, self.b)

    def own(self, x: np.ndarray) -> np.ndarray:
        """Points (n,3) of space in the own frame."""
        return (x - self.b) @ self.R / self.scale

    def distance(self, x: np.ndarray) -> np.ndarray:
        return self.scale * self.shape.distance(self.own(x))

    def normal(self, x: np.ndarray) -> np.ndarray:
        return self.shape.normal(self.own(x)) @ self.R.T

    def inside(self, x: np.ndarray) -> np.ndarray:
        return self.shape.inside(self.own(x))

    def support(self, d: np.ndarray) -> float:
        """Largest d . x over the solid; inf when unbounded that way."""
        return self.scale * self.shape.support(tidy(d @ self.R)) + float(d @ self.b)

    def bounds(self) -> np.ndarray:
        """Smallest box (2,3) along the axes of space; lo > hi where nothing is inside."""
        axes = np.eye(3)
        return np.array([[-self.support(-e) for e in axes], [self.support(e) for e in axes]])

    def moments(self) -> Moments | None:
        own = self.shape.moments()
        return None if own is None else own.moved(self.place)

    def roots(self, x: np.ndarray, d: np.ndarray) -> np.ndarray:
        return self.scale * self.shape.roots(self.own(x), d @ self.R)

    def faces(self, resolution: int) -> Mesh | None:
        mesh = self.shape.faces(resolution)
        if mesh is None:
            return None
        vertices, faces = mesh
        return self.place(vertices), faces if np.linalg.det(self.R) > 0 else faces[:, ::-1]

    def describe(self) -> str:
        if self.scale == 1:
            return self.shape.describe()
        return f"{self.shape.describe()}, magnified {self.scale:.6g} times"


def tidy(v: np.ndarray) -> np.ndarray:
    """Components that rotations left at rounding size become 0, so that an unbounded axis does not bound none."""
    return np.where(np.abs(v) < 1e-13 * np.abs(v).max(), 0.0, v)
