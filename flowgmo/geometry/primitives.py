"""Box, ball, half-space and whole space, each in its own frame with exact distance.

    ball        d = |x| - R
    box         d = |max(q, 0)| + min(max q, 0),   q = max(lo - x, x - hi) per axis
    half-space  d = n . x - h

Every shape answers the same calls: distance, normal, inside of points (n,3); support, the largest d . x over the shape;
moments, None without a closed form; roots, the parameters t at which lines x + t d cross the surface (n,k), NaN where
they do not; faces, a closed triangulation or None; describe.
Source  Quilez 2008, distance functions.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from flowgmo.geometry.moments import Moments
from flowgmo.geometry.ring_faces import ball_faces

Mesh = tuple[np.ndarray, np.ndarray]  # vertices (v,3), faces (f,3)


class Shape(Protocol):
    """A solid in its own frame."""

    def distance(self, x: np.ndarray) -> np.ndarray: ...
    def normal(self, x: np.ndarray) -> np.ndarray: ...
    def inside(self, x: np.ndarray) -> np.ndarray: ...
    def support(self, d: np.ndarray) -> float: ...
    def moments(self) -> Moments | None: ...
    def roots(self, x: np.ndarray, d: np.ndarray) -> np.ndarray: ...
    def faces(self, resolution: int) -> Mesh | None: ...
    def describe(self) -> str: ...


def unit(v: np.ndarray, otherwise: np.ndarray) -> np.ndarray:
    """Rows of v (n,3) made unit length; rows without length become those of `otherwise`."""
    length = np.linalg.norm(v, axis=-1, keepdims=True)
    return np.where(length > 0, v / np.where(length > 0, length, 1.0), otherwise)


@dataclass(frozen=True, eq=False)
class Ball:
    """Sphere of given radius about the origin."""

    radius: float

    def distance(self, x: np.ndarray) -> np.ndarray:
        return np.linalg.norm(x, axis=1) - self.radius

    def normal(self, x: np.ndarray) -> np.ndarray:
        return unit(x, np.array([0.0, 0.0, 1.0]))

    def inside(self, x: np.ndarray) -> np.ndarray:
        return self.distance(x) <= 0

    def support(self, d: np.ndarray) -> float:
        return self.radius * float(np.linalg.norm(d))

    def moments(self) -> Moments:
        volume = 4 / 3 * np.pi * self.radius**3
        return Moments(volume, np.zeros(3), volume * self.radius**2 / 5 * np.eye(3))

    def roots(self, x: np.ndarray, d: np.ndarray) -> np.ndarray:
        return quadratic_roots(d @ d, 2 * x @ d, (x * x).sum(1) - self.radius**2)

    def faces(self, resolution: int) -> Mesh:
        vertices, faces = ball_faces(resolution)
        return self.radius * vertices, faces

    def describe(self) -> str:
        return f"sphere, radius {self.radius:.6g}"


@dataclass(frozen=True, eq=False)
class Box:
    """lo <= x <= hi, (3,) each; ±inf where a side is absent."""

    lo: np.ndarray
    hi: np.ndarray

    def distance(self, x: np.ndarray) -> np.ndarray:
        q = np.maximum(self.lo - x, x - self.hi)
        return np.linalg.norm(np.maximum(q, 0), axis=1) + np.minimum(q.max(1), 0)

    def normal(self, x: np.ndarray) -> np.ndarray:
        below, above = self.lo - x, x - self.hi
        q, sign = np.maximum(below, above), np.where(below > above, -1.0, 1.0)
        face = np.eye(3)[q.argmax(1)] * sign
        return unit(np.maximum(q, 0) * sign, face)

    def inside(self, x: np.ndarray) -> np.ndarray:
        return ((x >= self.lo) & (x <= self.hi)).all(1)

    def support(self, d: np.ndarray) -> float:
        ends = np.where(d > 0, self.hi, self.lo)
        return float(np.where(d == 0, 0.0, ends * np.where(d == 0, 1.0, d))[d != 0].sum())

    def moments(self) -> Moments | None:
        size, centre = self.hi - self.lo, (self.hi + self.lo) / 2
        if not np.isfinite(size).all():
            return None
        volume = size.prod()
        return Moments(volume, volume * centre, volume * (np.diag(size**2) / 12 + np.outer(centre, centre)))

    def roots(self, x: np.ndarray, d: np.ndarray) -> np.ndarray:
        with np.errstate(divide="ignore", invalid="ignore"):
            t = np.hstack([(self.lo - x) / d, (self.hi - x) / d])
        return np.where(np.isfinite(t), t, np.nan)

    def faces(self, resolution: int) -> Mesh | None:
        if not np.isfinite(self.hi - self.lo).all():
            return None
        corners = np.array([[i, j, k] for k in (0, 1) for j in (0, 1) for i in (0, 1)])
        quads = np.array([[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]])
        return np.where(corners, self.hi, self.lo), np.vstack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])

    def describe(self) -> str:
        size = self.hi - self.lo
        bounded = np.isfinite(self.lo).sum() + np.isfinite(self.hi).sum()
        if bounded == 0:
            return "whole space"
        if bounded == 1:
            return "half-space"
        return "box, " + " x ".join(f"{length:.6g}" if np.isfinite(length) else "unbounded" for length in size)


@dataclass(frozen=True, eq=False)
class HalfSpace:
    """n . x <= h with n (3,) of unit length."""

    n: np.ndarray
    h: float

    def distance(self, x: np.ndarray) -> np.ndarray:
        return x @ self.n - self.h

    def normal(self, x: np.ndarray) -> np.ndarray:
        return np.broadcast_to(self.n, x.shape).copy()

    def inside(self, x: np.ndarray) -> np.ndarray:
        return self.distance(x) <= 0

    def support(self, d: np.ndarray) -> float:
        along = float(d @ self.n)
        return along * self.h if np.linalg.norm(d - along * self.n) < 1e-12 and along > 0 else np.inf  # rounding

    def moments(self) -> None:
        return None

    def roots(self, x: np.ndarray, d: np.ndarray) -> np.ndarray:
        return linear_roots(np.full(len(x), d @ self.n), self.distance(x))[:, None]

    def faces(self, resolution: int) -> None:
        return None

    def describe(self) -> str:
        return "half-space"


def linear_roots(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """t (n,) with a t + b = 0; NaN where a is 0."""
    return np.where(a != 0, -b / np.where(a != 0, a, 1.0), np.nan)


def quadratic_roots(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Real t (n,2), the smaller first, with a t² + b t + c = 0; NaN where there is none. Press et al. 2007, 5.6."""
    a, b, c = np.broadcast_arrays(a, b, c)
    disc = b * b - 4 * a * c
    q = -(b + np.copysign(np.sqrt(np.maximum(disc, 0)), b)) / 2
    t = np.stack([linear_roots(a, -q), linear_roots(q, -c)], 1)
    return np.sort(np.where((disc >= 0)[:, None], t, np.nan), axis=1)
