"""Solids bounded by a general quadric, with exact distance.

    q(x) = x.Mx + 2 b.x + c <= 0
    nearest surface point of p:   y = (1 + λM)⁻¹ (p - λ b)  with  q(y) = 0  and  1 + λM positive semi-definite

On that range of λ the function q(y(λ)) falls monotonically, so its one root is the global minimum, never a local one.
Source  Moré 1993, Generalizations of the trust region problem, theorem 3.2.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from flowgmo.geometry.moments import Moments
from flowgmo.geometry.piece import Quadric
from flowgmo.geometry.primitives import Ball, Mesh, quadratic_roots, unit
from flowgmo.geometry.ring_faces import ball_faces
from flowgmo.geometry.transform import Affine

FLAT = 1e-13  # of the largest coefficient: eigenvalues smaller than this are rounding
ROUND = 1e-15  # of the sum of its terms: q of a point on the surface. Beside an eigenvalue of 1e-14 the steps would end
# 3e-6 from it
LOWEST = -230.0  # of log δ: 1e-100, whose square and inverse are still numbers
HALVINGS, STEPS = 14, 150  # first narrow log δ to 0.014, then Newton: near the pole alone it would creep, and where
# eigenvalues are 1e-14 of others it needs up to some hundred steps (60: .7 % of 6000 such points 1e-6 and more off)


def matrices(q: Quadric) -> tuple[np.ndarray, np.ndarray, float]:
    """M (3,3), b (3,), c of a quadric."""
    M = np.array([[q.cx2, q.cxy / 2, q.cxz / 2], [q.cxy / 2, q.cy2, q.cyz / 2], [q.cxz / 2, q.cyz / 2, q.cz2]], float)
    return M, np.array([q.cx, q.cy, q.cz], float) / 2, float(q.c)


@dataclass(frozen=True, eq=False)
class QuadricSolid:
    """x.Mx + 2 b.x + c <= 0 with M (3,3) symmetric, not zero."""

    M: np.ndarray
    b: np.ndarray
    c: float

    @cached_property
    def eigen(self) -> tuple[np.ndarray, np.ndarray]:
        """Eigenvalues (3,), those of rounding size set to 0, and eigenvectors (3,3) as columns."""
        m, V = np.linalg.eigh(self.M)
        return np.where(np.abs(m) < FLAT * np.abs(m).max(), 0.0, m), V

    @cached_property
    def centre(self) -> tuple[np.ndarray, float] | None:
        """Point where the gradient vanishes and q there; None for paraboloids and parabolic cylinders."""
        m, V = self.eigen
        beta = V.T @ self.b
        if (np.abs(beta[m == 0]) > 1e-12 * np.linalg.norm(self.b)).any():  # rounding of the rotation V
            return None
        y = np.where(m != 0, -beta / np.where(m != 0, m, 1.0), 0.0)
        return V @ y, self.c - float((m * y * y).sum())

    def value(self, x: np.ndarray) -> np.ndarray:
        return ((x @ self.M + 2 * self.b) * x).sum(1) + self.c

    def inside(self, x: np.ndarray) -> np.ndarray:
        return self.value(x) <= 0

    def distance(self, x: np.ndarray) -> np.ndarray:
        gap, _ = self._to_surface(x)
        return np.where(self.inside(x), -1.0, 1.0) * np.linalg.norm(gap, axis=1)

    def normal(self, x: np.ndarray) -> np.ndarray:
        gap, gradient = self._to_surface(x)
        outward = np.where(self.inside(x), 1.0, -1.0)[:, None] * gap  # where the gradient vanishes: the tip of a cone
        return unit(gradient, unit(outward, np.array([0.0, 0.0, 1.0])))

    def _to_surface(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Vector (n,3) from each point to the nearest surface point, and half the gradient of q there."""
        m, V = self.eigen
        p, beta = x @ V, self.b @ V
        gap, y = np.zeros_like(p), p.copy()
        value = (m * p * p + 2 * beta * p).sum(1) + self.c
        for sign in (-1.0, 1.0):
            chosen = value * sign > 0
            if chosen.any():
                gap[chosen] = _foot(p[chosen], m, beta, self.c, sign)
        y += gap
        return gap @ V.T, (m * y + beta) @ V.T

    def support(self, d: np.ndarray) -> float:
        m, V = self.eigen
        if self.centre is None or (m < 0).any():
            return np.inf
        along = V.T @ d
        if (np.abs(along[m == 0]) > 1e-13 * np.abs(along).max()).any():  # rounding of the rotation V
            return np.inf
        middle, depth = self.centre
        live = m > 0
        return float(middle @ d + np.sqrt(max(-depth, 0) * (along[live] ** 2 / m[live]).sum()))

    def ellipsoid(self) -> Affine | None:
        """The map that makes this solid from the unit ball."""
        m, V = self.eigen
        if self.centre is None or not (m > 0).all():
            return None
        middle, depth = self.centre
        return Affine(V * np.sqrt(-depth / m), middle)

    def moments(self) -> Moments | None:
        place = self.ellipsoid()
        return None if place is None else Ball(1.0).moments().moved(place)

    def roots(self, x: np.ndarray, d: np.ndarray) -> np.ndarray:
        return quadratic_roots(d @ self.M @ d, 2 * (x @ self.M + self.b) @ d, self.value(x))

    def faces(self, resolution: int) -> Mesh | None:
        place = self.ellipsoid()
        if place is None:
            return None
        vertices, faces = ball_faces(resolution)
        return place(vertices), faces if np.linalg.det(place.A) > 0 else faces[:, ::-1]

    def describe(self) -> str:
        place = self.ellipsoid()
        if place is None:
            return "quadric"
        return "ellipsoid, half axes " + ", ".join(f"{a:.6g}" for a in np.linalg.norm(place.A, axis=0))


@dataclass(frozen=True, eq=False)
class _Paths:
    """The curves y(λ) from points on one side of the surface (sign of q), along the eigenvectors.

    λ = sign (1 - δ) / |m_ref| up to the pole at δ = 0, or sign (1/δ - 1) / |m_ref| where no pole bounds it;
    u = log δ resolves both the surface (u -> 0) and the pole (u -> -inf).
    value: q at the points (n,), slope: half its gradient there (n,3).
    """

    m: np.ndarray
    sign: float
    value: np.ndarray
    slope: np.ndarray

    @cached_property
    def pole(self) -> bool:
        return bool((self.sign * self.m < 0).any())

    @cached_property
    def ref(self) -> int:
        return int(np.argmin(self.sign * self.m) if self.pole else np.argmax(np.abs(self.m)))

    def at(self, u: np.ndarray, k: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """q(y), dq/du (n,), and y - p (n,3) of the curves k (n,) at u (n,)."""
        slope, size = self.slope[k], abs(self.m[self.ref])
        ratio, delta = self.sign * self.m / size, np.exp(u)[:, None]
        grown = -np.expm1(u)[:, None] / (1.0 if self.pole else delta)
        below = (1 + ratio) - ratio * delta if self.pole else 1 + ratio * grown
        move = -self.sign * grown / size * slope / below
        value = self.value[k] + ((2 * slope + self.m * move) * move).sum(1)
        dlam = -self.sign * (delta if self.pole else 1 / delta) / size
        return value, (-2 * (slope + self.m * move) ** 2 / below * dlam).sum(1), move


def _foot(p: np.ndarray, m: np.ndarray, beta: np.ndarray, c: float, sign: float) -> np.ndarray:
    """y - p (n,3) for points p (n,3) on one side of the surface, in eigenvector coordinates."""
    paths = _Paths(m, sign, ((m * p + 2 * beta) * p).sum(1) + c, p * m + beta)
    low, high, u = np.full(len(p), LOWEST), np.zeros(len(p)), np.full(len(p), -0.5)
    live = np.arange(len(p))
    for step in range(STEPS):
        value, rate, _ = paths.at(u[live], live)
        beyond = value * sign <= 0  # past the surface: the root has a larger u
        low[live] = np.where(beyond, u[live], low[live])
        high[live] = np.where(beyond, high[live], u[live])
        with np.errstate(divide="ignore", invalid="ignore"):
            newton = u[live] - value / rate
        good = (step >= HALVINGS) & (newton > low[live]) & (newton < high[live])
        new = np.where(good, newton, (low[live] + high[live]) / 2)
        moving = np.abs(new - u[live]) > 4e-16 * np.abs(u[live])  # two units in the last place
        u[live], live = new, live[moving]
        if not len(live):
            break
    value, _, move = paths.at(u, np.arange(len(p)))
    far = np.linalg.norm(p, axis=1)  # rotated, each coordinate is off by rounding of all of them
    rounding = ROUND * (np.abs(m).sum() * far**2 + 2 * np.abs(beta).sum() * far + abs(c))
    stuck = paths.pole & (value * sign > 1e-9 * np.abs(paths.value))  # on a symmetry plane the pole comes first
    move[stuck, paths.ref] += np.sqrt(np.maximum(-value[stuck] / m[paths.ref], 0))
    move[np.abs(paths.value) <= rounding] = 0.0  # on the surface
    return move
