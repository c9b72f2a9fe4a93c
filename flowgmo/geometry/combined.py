"""Shapes made of others: what several have in common, and a shape under a map that is no similarity.

all of them   d = max d_k       exact inside; outside a lower bound, exact where one surface is nearest
stretched     x = A y:  d = σ_min(A) d_own(y)     a lower bound of the right sign, exact on the surface
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from flowgmo.geometry.moments import Moments
from flowgmo.geometry.primitives import Mesh, unit
from flowgmo.geometry.transform import Affine

if TYPE_CHECKING:
    from flowgmo.geometry.solid import Solid


@dataclass(frozen=True, eq=False)
class Common:
    """What all parts have in common; lo, hi (3,): a box known to hold it, ±inf where none is known."""

    parts: tuple[Solid, ...]
    lo: np.ndarray
    hi: np.ndarray

    def distance(self, x: np.ndarray) -> np.ndarray:
        return np.max([part.distance(x) for part in self.parts], axis=0)

    def normal(self, x: np.ndarray) -> np.ndarray:
        which = np.argmax([part.distance(x) for part in self.parts], axis=0)
        normals = np.empty((len(x), 3))
        for k, part in enumerate(self.parts):
            normals[which == k] = part.normal(x[which == k])
        return normals

    def inside(self, x: np.ndarray) -> np.ndarray:
        return np.all([part.inside(x) for part in self.parts], axis=0)

    def support(self, d: np.ndarray) -> float:
        ends = np.where(d > 0, self.hi, self.lo)
        box = float((ends[d != 0] * d[d != 0]).sum())
        return min(box, *(part.support(d) for part in self.parts))

    def moments(self) -> None:
        return None

    def roots(self, x: np.ndarray, d: np.ndarray) -> np.ndarray:
        return np.hstack([part.roots(x, d) for part in self.parts])

    def faces(self, resolution: int) -> None:
        return None

    def describe(self) -> str:
        return " cut by ".join(part.describe() for part in self.parts)


@dataclass(frozen=True, eq=False)
class Stretched:
    """The image of a solid under A (3,3)."""

    solid: Solid
    A: np.ndarray

    @cached_property
    def inverse(self) -> np.ndarray:
        return np.linalg.inv(self.A)

    @cached_property
    def least(self) -> float:
        return float(np.linalg.svd(self.A, compute_uv=False)[-1])

    def distance(self, x: np.ndarray) -> np.ndarray:
        return self.least * self.solid.distance(x @ self.inverse.T)

    def normal(self, x: np.ndarray) -> np.ndarray:
        return unit(self.solid.normal(x @ self.inverse.T) @ self.inverse, np.array([0.0, 0.0, 1.0]))

    def inside(self, x: np.ndarray) -> np.ndarray:
        return self.solid.inside(x @ self.inverse.T)

    def support(self, d: np.ndarray) -> float:
        return self.solid.support(self.A.T @ d)

    def moments(self) -> Moments | None:
        own = self.solid.moments()
        return None if own is None else own.moved(Affine(self.A, np.zeros(3)))

    def roots(self, x: np.ndarray, d: np.ndarray) -> np.ndarray:
        own = self.inverse @ d
        length = np.linalg.norm(own)
        return self.solid.roots(x @ self.inverse.T, own / length) / length

    def faces(self, resolution: int) -> Mesh | None:
        mesh = self.solid.faces(resolution)
        if mesh is None:
            return None
        vertices, faces = mesh
        return vertices @ self.A.T, faces if np.linalg.det(self.A) > 0 else faces[:, ::-1]

    def describe(self) -> str:
        return f"{self.solid.describe()}, stretched"
