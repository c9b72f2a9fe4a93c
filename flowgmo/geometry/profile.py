"""The half-plane (r, z), r >= 0, of a solid of revolution: bounds, the curves they lie on, the pieces of its outline.

    bound    a r² + k r + e z² + l z + c <= 0        a line, a circle, or a pair of lines
    outline  the parts of all curves on whose two sides the membership differs

Radius, height, sphere, and cone limiters, a torus, and the quadrics of revolution with straight or round section are
all such bounds, so that every combination of them has its exact outline: cylinder, tube, frustum, cap, sector, ...
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

SAME = 1e-10  # in sizes of the profile: curves closer than this are one curve
SIDE = 1e-9  # in sizes: step off a curve to ask which side is inside; well above rounding, below any real feature


@dataclass(frozen=True)
class Bound:
    """a r² + k r + e z² + l z + c <= 0."""

    a: float = 0.0
    k: float = 0.0
    e: float = 0.0
    l: float = 0.0  # noqa: E741  the letters follow the equation
    c: float = 0.0

    def value(self, r: np.ndarray, z: np.ndarray) -> np.ndarray:
        """Left side at points (n,)."""
        return (self.a * r + self.k) * r + (self.e * z + self.l) * z + self.c

    def along_axis(self, stretch: float, z0: float, flip: float) -> Bound:
        """The same bound in coordinates r' = stretch r, z' = flip stretch z + z0; flip is ±1."""
        m, q = 1 / stretch, flip / stretch  # r = m r', z = q (z' - z0)
        e, slope = self.e * q * q, self.l * q
        return Bound(self.a * m * m, self.k * m, e, slope - 2 * e * z0, self.c - slope * z0 + e * z0 * z0)

    def scaled(self) -> Bound:
        """The same bound with a leading coefficient of size one."""
        size = max(abs(self.a), abs(self.e)) or max(abs(self.k), abs(self.l)) or 1.0
        return Bound(self.a / size, self.k / size, self.e / size, self.l / size, self.c / size)

    def curves(self) -> list[Line | Circle] | None:
        """What the bound lies on; None when it is another conic."""
        a, k, e, l, c = self.a, self.k, self.e, self.l, self.c  # noqa: E741
        tiny = 1e-12 * max(abs(a), abs(e))  # rounding of coefficients that should be equal
        if a == 0 and e == 0:
            return [] if k == 0 and l == 0 else [Line.normal_form(k, l, c)]
        if abs(a - e) <= tiny:
            centre = np.array([-k, -l]) / (2 * a)
            square = centre @ centre - c / a
            return [Circle(centre, np.sqrt(square))] if square > 0 else []
        if k == 0 and a * e <= 0:
            # a r² + e (z - z0)² = h: two lines when h vanishes (cone), or when one square is absent
            if e == 0 and l == 0:
                return [Line.normal_form(1.0, 0.0, -np.sqrt(-c / a))] if c * a < 0 else []
            if a == 0:
                roots = l * l - 4 * e * c
                ends = (-l + np.array([-1, 1]) * np.sqrt(max(roots, 0))) / (2 * e)
                return [Line.normal_form(0.0, 1.0, -end) for end in ends] if roots > 0 else []
            if e != 0 and abs(c - l * l / (4 * e)) <= 1e-12 * (abs(c) + l * l / abs(4 * e)):
                slope, z0 = np.sqrt(-a / e), -l / (2 * e)
                return [Line.normal_form(slope, 1.0, -z0), Line.normal_form(slope, -1.0, z0)]
        return None


@dataclass(frozen=True, eq=False)
class Line:
    """p + t u, u of unit length; n = u turned by 90°."""

    p: np.ndarray
    u: np.ndarray

    @staticmethod
    def normal_form(k: float, l: float, c: float) -> Line:  # noqa: E741
        """k r + l z + c = 0."""
        n = np.array([k, l]) / np.hypot(k, l)
        return Line(-c / np.hypot(k, l) * n, np.array([-n[1], n[0]]))

    def at(self, t: np.ndarray) -> np.ndarray:
        return self.p + np.multiply.outer(t, self.u)

    def normal(self, t: np.ndarray) -> np.ndarray:
        return np.broadcast_to([self.u[1], -self.u[0]], (*np.shape(t), 2))

    def parameter(self, q: np.ndarray) -> np.ndarray:
        return (q - self.p) @ self.u

    def closed(self) -> bool:
        return False

    def same(self, other: Line | Circle, tol: float) -> bool:
        if not isinstance(other, Line):
            return False
        n = self.normal(0.0)
        return abs(n @ other.u) < SAME and abs(n @ (other.p - self.p)) < tol

    def meets(self, other: Line | Circle) -> np.ndarray:
        """Points (k,2) common with another curve."""
        if isinstance(other, Circle):
            return other.meets(self)
        n = other.normal(0.0)
        slope = n @ self.u
        return self.at(np.array([n @ (other.p - self.p) / slope])) if abs(slope) > 1e-14 else np.empty((0, 2))


@dataclass(frozen=True, eq=False)
class Circle:
    """centre + radius (cos t, sin t)."""

    centre: np.ndarray
    radius: float

    def at(self, t: np.ndarray) -> np.ndarray:
        return self.centre + self.radius * self.normal(t)

    def normal(self, t: np.ndarray) -> np.ndarray:
        return np.stack([np.cos(t), np.sin(t)], -1)

    def parameter(self, q: np.ndarray) -> np.ndarray:
        return np.arctan2(q[..., 1] - self.centre[1], q[..., 0] - self.centre[0])

    def closed(self) -> bool:
        return True

    def same(self, other: Line | Circle, tol: float) -> bool:
        return (
            isinstance(other, Circle)
            and abs(self.radius - other.radius) < tol
            and np.abs(self.centre - other.centre).max() < tol
        )

    def meets(self, other: Line | Circle) -> np.ndarray:
        """Points (k,2) common with another curve."""
        if isinstance(other, Line):
            foot = other.at(other.parameter(self.centre))
            half, along = self.radius**2 - ((foot - self.centre) ** 2).sum(), other.u
        else:
            gap = other.centre - self.centre
            d = np.hypot(*gap)
            if d == 0:
                return np.empty((0, 2))
            x = (d * d + self.radius**2 - other.radius**2) / (2 * d)
            foot, half, along = self.centre + x * gap / d, self.radius**2 - x * x, np.array([-gap[1], gap[0]]) / d
        reach = np.sqrt(max(half, 0))
        return (
            np.array([foot - reach * along, foot + reach * along])
            if half > -SAME * self.radius**2
            else np.empty((0, 2))
        )


AXIS = Line(np.zeros(2), np.array([0.0, 1.0]))


@dataclass(frozen=True, eq=False)
class Outline:
    """One curve between parameters t0 < t1 with outward normal `outward` x the curve's own.

    jump: the weight just inside minus the weight just outside.
    """

    curve: Line | Circle
    t0: float
    t1: float
    outward: float
    jump: float

    def nearest(self, p: np.ndarray, sign: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Distance (n,) of points (n,2) and outward normal (n,2); sign is -1 inside, +1 outside.

        On the open curve the normal is the curve's own, exact at any distance; at an end it is the direction to it.
        """
        t = self.curve.parameter(p)
        if self.curve.closed():
            t = self.t0 + np.mod(t - self.t0, 2 * np.pi)
            over = t > self.t1
            nearer_end = t - self.t1 > self.t0 + 2 * np.pi - t
            ends = np.where(over, np.where(nearer_end, self.t0, self.t1), t)
        else:
            ends = np.clip(t, self.t0, self.t1)
        gap = p - self.curve.at(ends)
        d = np.hypot(gap[:, 0], gap[:, 1])
        normal = self.outward * self.curve.normal(ends)
        clamped = (ends != t) & (d > 0)
        normal = np.where(clamped[:, None], sign[:, None] * gap / np.where(d > 0, d, 1.0)[:, None], normal)
        return d, normal

    def support(self, d: np.ndarray) -> float:
        """Largest d . (r, z) on the piece."""
        t = [self.t0, self.t1]
        if isinstance(self.curve, Circle):
            top = self.t0 + np.mod(np.arctan2(d[1], d[0]) - self.t0, 2 * np.pi)
            return float((self.curve.at(np.array([*t, min(top, self.t1)])) @ d).max())
        slope = self.curve.u @ d
        values = [self.curve.p @ d + (0.0 if abs(slope) < 1e-14 else slope * end) for end in t]
        return float(max(values))

    def finite(self) -> bool:
        return bool(np.isfinite(self.t1 - self.t0))


Field = Callable[[np.ndarray, np.ndarray], np.ndarray]  # weight (n,) at r (n,), z (n,)


def distinct(curves: list[Line | Circle], size: float) -> list[Line | Circle]:
    """The curves without repetitions."""
    kept: list[Line | Circle] = []
    for curve in curves:
        if not any(curve.same(other, SAME * size) for other in kept):
            kept.append(curve)
    return kept


def size_of(curves: list[Line | Circle]) -> float:
    """A length of the order of the profile's."""
    lengths = [np.abs(c.p).max() if isinstance(c, Line) else c.radius + np.abs(c.centre).max() for c in curves]
    crossings = [np.abs(q).max() for i, a in enumerate(curves) for b in curves[:i] for q in [a.meets(b)] if q.size]
    return max([*lengths, *crossings], default=0.0) or 1.0


def outline(curves: list[Line | Circle], field: Field, on_axis: bool = False) -> list[Outline]:
    """Where a weight jumps across the curves; on_axis: the part of the axis that the region touches instead."""
    size = size_of(curves)
    curves = distinct(curves, size)
    pieces = []
    for curve in [AXIS] if on_axis else curves:
        for t0, t1 in _intervals(curve, [*curves, AXIS], size):
            middle = _between(t0, t1, size)
            q, n = curve.at(middle), curve.normal(middle)
            if on_axis:
                n = np.array([-1.0, 0.0])
            elif q[0] <= SIDE * size:
                continue
            sides = np.array([q - SIDE * size * n, q + SIDE * size * n])
            weight = field(np.abs(sides[:, 0]), sides[:, 1]) * ([1, 0] if on_axis else [1, 1])
            if weight[0] != weight[1]:
                outward = 1.0 if abs(weight[0]) > abs(weight[1]) and not on_axis else -1.0
                pieces.append(Outline(curve, t0, t1, outward, outward * (weight[0] - weight[1])))
    return pieces


def _intervals(curve: Line | Circle, others: list[Line | Circle], size: float) -> list[tuple[float, float]]:
    crossings = [curve.meets(other) for other in others if other is not curve]
    t = np.sort(curve.parameter(np.vstack(crossings)) if crossings else np.empty(0))
    t = t[np.r_[True, np.diff(t) > SAME * (1 if curve.closed() else size)]] if len(t) else t
    if not curve.closed():
        ends = np.r_[-np.inf, t, np.inf]
    else:
        ends = np.r_[t, t[0] + 2 * np.pi] if len(t) else np.array([-np.pi, np.pi])
    return [(a, b) for a, b in zip(ends[:-1], ends[1:], strict=True) if b - a > SAME * (1 if curve.closed() else size)]


def _between(t0: float, t1: float, size: float) -> float:
    if np.isinf(t0) and np.isinf(t1):
        return 0.0
    if np.isinf(t0):
        return t1 - size
    return t0 + size if np.isinf(t1) else (t0 + t1) / 2
