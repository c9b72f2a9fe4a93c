"""Solids bounded by a quadric with √(x² + y²) that has no closed outline.

x.Mx + 2 b.x + c + k √(x² + y²) <= 0
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flowgmo.geometry.primitives import quadratic_roots, unit
from flowgmo.geometry.revolved import quartic_roots


@dataclass(frozen=True, eq=False)
class RootQuadricSolid:
    """x.Mx + 2 b.x + c + k √(x² + y²) <= 0 where no closed outline exists.

    The sign of the distance is exact; its size comes from a foot-point iteration (Hartmann 1999), which finds the
    nearest point where the surface is smooth on the scale of the distance, else a nearby one (then it is too large).
    """

    M: np.ndarray
    b: np.ndarray
    c: float
    k: float

    def value(self, x: np.ndarray) -> np.ndarray:
        return ((x @ self.M + 2 * self.b) * x).sum(1) + self.c + self.k * np.hypot(x[:, 0], x[:, 1])

    def gradient(self, x: np.ndarray) -> np.ndarray:
        flat = x * [1.0, 1.0, 0.0]
        return 2 * (x @ self.M + self.b) + self.k * unit(flat, np.zeros(3))

    def inside(self, x: np.ndarray) -> np.ndarray:
        return self.value(x) <= 0

    def _surface_point(self, y: np.ndarray) -> np.ndarray:
        for _ in range(20):  # Newton along the gradient: quadratic, 20 from far away
            g = self.gradient(y)
            square = np.maximum((g * g).sum(1), 1e-300)
            y = y - (self.value(y) / square)[:, None] * g
        return y

    def foot(self, x: np.ndarray) -> np.ndarray:
        """Surface points (n,3) near x: from the best of several starts along the tangent plane towards x."""
        middle = self._surface_point(x)
        starts = [middle, *(self._surface_point(x * share) for share in ([1, 1, 0.5], [0.5, 0.5, 1], [0.1, 0.1, 1]))]
        y = middle
        for start in [*starts, *self._tips(x)]:
            y = np.where(self._nearer(start, y, x)[:, None], start, y)
        for _ in range(
            40
        ):  # linear with the factor distance / radius of curvature, halved steps where that exceeds one
            n = unit(self.gradient(y), np.array([0.0, 0.0, 1.0]))
            slide = x - y - ((x - y) * n).sum(1)[:, None] * n
            moved = False
            for share in (1.0, 0.3, 0.1, 0.01):
                new = self._surface_point(y + share * slide)
                nearer = self._nearer(new, y, x)
                y, moved = np.where(nearer[:, None], new, y), moved or nearer.any()
            if not moved:
                break
        return y

    def _nearer(self, new: np.ndarray, old: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Where a new point is on the surface and nearer to x than the old one."""
        size = np.abs(self.c) + (np.abs(self.M).sum() * np.abs(new) ** 2 + np.abs(self.b) * np.abs(new)).sum(1)
        on_surface = np.abs(self.value(new)) < 1e-9 * size  # what Newton leaves where it has not converged is larger
        return on_surface & (np.linalg.norm(new - x, axis=1) < np.linalg.norm(old - x, axis=1))

    def _tips(self, x: np.ndarray) -> list[np.ndarray]:
        """Points (n,3) on the z axis, where the root has a tip and Newton does not arrive."""
        heights = np.roots([self.M[2, 2], 2 * self.b[2], self.c]) if self.M[2, 2] or self.b[2] else np.empty(0)
        return [np.tile([0.0, 0.0, z.real], (len(x), 1)) for z in heights if np.isreal(z)]

    def distance(self, x: np.ndarray) -> np.ndarray:
        return np.where(self.inside(x), -1.0, 1.0) * np.linalg.norm(x - self.foot(x), axis=1)

    def normal(self, x: np.ndarray) -> np.ndarray:
        return unit(self.gradient(self.foot(x)), np.array([0.0, 0.0, 1.0]))

    def support(self, d: np.ndarray) -> float:
        return np.inf

    def moments(self) -> None:
        return None

    def roots(self, x: np.ndarray, d: np.ndarray) -> np.ndarray:
        a, b = np.full(len(x), d @ self.M @ d), 2 * (x @ self.M + self.b) @ d
        c = self.value(x) - self.k * np.hypot(x[:, 0], x[:, 1])
        square = np.stack([a * a, 2 * a * b, 2 * a * c + b * b, 2 * b * c, c * c])
        across = np.stack([np.full(len(x), d[:2] @ d[:2]), 2 * x[:, :2] @ d[:2], (x[:, :2] ** 2).sum(1)])
        square[2:] -= self.k**2 * across
        flat = quadratic_roots(*square[2:])  # without squares the quartic is a quadratic
        return np.hstack([quartic_roots(square), flat])

    def faces(self, resolution: int) -> None:
        return None

    def describe(self) -> str:
        return "quadric with sqrt(x2 + y2)"
