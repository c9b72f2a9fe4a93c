"""Solids bounded by a general quadric, with exact distance, and by one with √(x² + y²), with a foot-point iteration.

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
from flowgmo.geometry.profile import Bound, Circle
from flowgmo.geometry.revolved import quartic_roots
from flowgmo.geometry.ring_faces import ring_faces
from flowgmo.geometry.transform import Affine

FLAT = 1e-13  # of the largest coefficient: eigenvalues smaller than this are rounding
STEPS = 100  # of the safeguarded Newton iteration; bisection alone needs 62 to resolve log δ in [-740, 0]


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


def ball_faces(resolution: int) -> Mesh:
    """Triangles of the unit ball about the origin."""
    from flowgmo.geometry.profile import outline

    bound = Bound(a=1.0, e=1.0, c=-1.0)
    arcs = outline([Circle(np.zeros(2), 1.0)], lambda r, z: (bound.value(r, z) <= 0).astype(float))
    return ring_faces(arcs, 1.0, resolution)


def _foot(p: np.ndarray, m: np.ndarray, beta: np.ndarray, c: float, sign: float) -> np.ndarray:
    """y - p (n,3) for points on one side (sign of q), everything along the eigenvectors.

    λ = sign (1 - δ) / |m_ref| up to the pole at δ = 0, or sign (1/δ - 1) / |m_ref| where no pole bounds it;
    u = log δ resolves both the surface (u -> 0) and the pole (u -> -inf).
    """
    pole = (sign * m < 0).any()
    ref = np.argmin(sign * m) if pole else np.argmax(np.abs(m))
    ratio = sign * m / abs(m[ref])
    slope = p * m + beta
    value0 = ((m * p + 2 * beta) * p).sum(1) + c

    def at(u: np.ndarray, k: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """q(y), dq/du, y - p."""
        delta = np.exp(u)[:, None]
        grown = -np.expm1(u)[:, None] / (1.0 if pole else delta)
        below = (1 + ratio) - ratio * (1 - grown) if not pole else (1 + ratio) - ratio * delta
        move = -sign * grown / abs(m[ref]) * slope[k] / below
        value = value0[k] + ((2 * slope[k] + m * move) * move).sum(1)
        dlam = -sign * (delta if pole else 1 / delta) / abs(m[ref])
        return value, (-2 * (slope[k] + m * move) ** 2 / below * dlam).sum(1), move

    low, high, u = np.full(len(p), -700.0), np.zeros(len(p)), np.full(len(p), -0.5)  # exp(-700) is the smallest float
    live = np.arange(len(p))
    for _ in range(STEPS):
        value, rate, _ = at(u[live], live)
        beyond = value * sign <= 0  # past the surface: the root has a larger u
        low[live] = np.where(beyond, u[live], low[live])
        high[live] = np.where(beyond, high[live], u[live])
        with np.errstate(divide="ignore", invalid="ignore"):
            newton = u[live] - value / rate
        good = (newton > low[live]) & (newton < high[live])
        new = np.where(good, newton, (low[live] + high[live]) / 2)
        moving = np.abs(new - u[live]) > 4e-16 * np.abs(u[live])  # two units in the last place
        u[live], live = new, live[moving]
        if not len(live):
            break
    value, _, move = at(u, np.arange(len(p)))
    stuck = (value * sign > 1e-9 * np.abs(value0)) & pole  # on a symmetry plane: the pole is reached before the surface
    move[stuck, ref] += np.sqrt(np.maximum(-value[stuck] / m[ref], 0))
    return move


@dataclass(frozen=True, eq=False)
class RootQuadricSolid:
    """x.Mx + 2 b.x + c + k √(x² + y²) <= 0 where no closed outline exists.

    The sign of the distance is exact; its size comes from a foot-point iteration (Hartmann 1999), which finds the
    nearest point where the surface is smooth on the scale of the distance.
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
        """Surface points (n,3) near x."""
        y = self._surface_point(x)
        for _ in range(30):  # foot points on tangent planes: linear with the factor distance / radius of curvature
            n = unit(self.gradient(y), np.array([0.0, 0.0, 1.0]))
            tangent = x - ((x - y) * n).sum(1)[:, None] * n
            new = self._surface_point((y + tangent) / 2)
            nearer = np.linalg.norm(new - x, axis=1) < np.linalg.norm(y - x, axis=1)
            if not nearer.any():
                break
            y = np.where(nearer[:, None], new, y)
        return y

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


def tighten(lo: np.ndarray, hi: np.ndarray, quadrics: list[QuadricSolid | RootQuadricSolid]) -> tuple[np.ndarray, np.ndarray]:
    """A smaller box (3,), (3,) around box and quadrics without mixed products, by interval propagation.

    m_i x_i² + 2 b_i x_i <= -(c + sum over j of the least m_j x_j² + 2 b_j x_j);  k √(x²+y²) >= -|k| (|x| + |y|).
    Source  Benhamou et al. 1999 (HC4).
    """
    lo, hi = lo.copy(), hi.copy()
    for _ in range(4):  # each pass can use the bounds that the one before found; three variables
        for q in quadrics:
            if np.abs(q.M - np.diag(np.diag(q.M))).max() > 0:
                continue
            drop = max(-getattr(q, "k", 0.0), 0.0) * np.array([1, 1, 0])
            least = [_least(q.M[j, j], 2 * q.b[j], drop[j], lo[j], hi[j]) for j in range(3)]
            for i in range(3):
                rest = q.c + sum(least[j] for j in range(3) if j != i)
                if np.isfinite(rest):
                    reach = _reach(q.M[i, i], 2 * q.b[i], drop[i], rest)
                    lo[i], hi[i] = max(lo[i], reach[0]), min(hi[i], reach[1])
    return lo, hi


def _least(m: float, b: float, k: float, lo: float, hi: float) -> float:
    """Least m x² + b x - k |x| for lo <= x <= hi."""
    tips = [(k - b) / (2 * m), -(k + b) / (2 * m)] if m > 0 else []
    ends = [x for x in (lo, hi, 0.0, *tips) if lo <= x <= hi and np.isfinite(x)]
    values = [m * x * x + b * x - k * abs(x) for x in ends]
    for x, slope in ((lo, -b - k), (hi, b - k)):
        if np.isinf(x) and (m < 0 or (m == 0 and slope < 0)):
            return -np.inf
    return min(values)


def _reach(m: float, b: float, k: float, rest: float) -> tuple[float, float]:
    """Interval of x with m x² + b x - k |x| + rest <= 0, or all."""
    if m < 0 or (m == 0 and b == 0):
        return -np.inf, np.inf
    if m == 0:
        bound = -rest / b
        return (-np.inf, np.inf) if k else ((-np.inf, bound) if b > 0 else (bound, np.inf))
    ends = [root for slope in (b - k, b + k) for root in np.roots([m, slope, rest]) if np.isreal(root)]
    return (min(ends).real, max(ends).real) if ends else (0.0, 0.0)
