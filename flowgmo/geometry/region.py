"""A region in its own frame: the conditions a subcomponent puts on a point, and their form when stretched per axis."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flowgmo.geometry.errors import GeometryError
from flowgmo.geometry.piece import Limits, Piece, Quadric, Range, Torus

WHOLE_TURN = 360.0


@dataclass(frozen=True, eq=False)
class Region:
    """lo, hi (3,) of the box limiters; radius, sphere, cone [degrees], angle [degrees] as (lower, upper), ±inf where
    unbounded; any number of quadrics; a torus."""

    lo: np.ndarray
    hi: np.ndarray
    radius: tuple[float, float]
    sphere: tuple[float, float]
    cone: tuple[float, float]
    angle: tuple[float, float]
    quadrics: tuple[Quadric, ...] = ()
    torus: Torus | None = None

    def stretched(self, s: np.ndarray) -> Region | None:
        """The region of the points s x, s (3,) > 0; None when its conditions are of no kind known here."""
        if (s == 1).all():
            return self
        sx, sy, sz = s
        turned, even = sx == sy, sx == sy == sz
        if self.torus and not even or any(q.crxy for q in self.quadrics) and not turned:
            return None
        if np.isfinite(self.cone).any() and not turned:
            return None
        quadrics = [_stretched_quadric(q, s) for q in self.quadrics]
        radius, sphere = (sx * self.radius[0], sx * self.radius[1]), (sx * self.sphere[0], sx * self.sphere[1])
        if not even and np.isfinite(self.sphere).any():
            quadrics += _as_quadrics(self.sphere, (sx**-2, sy**-2, sz**-2))
            sphere = (-np.inf, np.inf)
        if not turned and np.isfinite(self.radius).any():
            quadrics += _as_quadrics(self.radius, (sx**-2, sy**-2, 0.0))
            radius = (-np.inf, np.inf)
        return Region(
            self.lo * s,
            self.hi * s,
            radius,
            sphere,
            tuple(_stretched_angle(a, sx, sz) for a in self.cone),
            tuple(_stretched_angle(a, sy, sx) for a in self.angle),
            tuple(quadrics),
            replace(self.torus, inner=self.torus.inner * sx, outer=self.torus.outer * sx) if self.torus else None,
        )


def region_of(piece: Piece) -> Region:
    """The conditions of a piece, checked: none may be empty by itself."""
    limits = piece.limits
    lo, hi = np.array([span(limits.x, "x"), span(limits.y, "y"), span(limits.z, "z")]).T
    radius, sphere = span(limits.radius, "radius"), span(limits.sphere, "sphere radius")
    for value, word in ((radius[1], "radius"), (sphere[1], "sphere radius")):
        if value <= 0:
            raise GeometryError(f"the upper limit {value:g} of the {word} leaves nothing: write a positive one")
    torus = piece.torus
    if torus and not 0 <= torus.inner < torus.outer < np.inf:
        raise GeometryError(
            f"a torus has 0 <= inner radius < outer radius, not {torus.inner:g} and {torus.outer:g}: "
            "the tube spans the radii from inner to outer"
        )
    return Region(
        lo,
        hi,
        tuple(b if b > 0 else -np.inf for b in radius),
        tuple(b if b > 0 else -np.inf for b in sphere),
        _cone(limits),
        _angle(limits),
        (piece.quadric,) if piece.quadric else (),
        torus,
    )


def span(limits: Range | None, word: str) -> tuple[float, float]:
    """Lower and upper bound, ±inf where there is none."""
    lo, hi = limits or (None, None)
    lo, hi = -np.inf if lo is None else float(lo), np.inf if hi is None else float(hi)
    if not lo < hi:
        raise GeometryError(f"the limits {lo:g} to {hi:g} of {word} leave nothing: the lower must be below the upper")
    return lo, hi


def _cone(limits: Limits) -> tuple[float, float]:
    lo, hi = span(limits.cone, "the cone angle")
    if np.isfinite(lo) and not 0 <= lo < 180 or np.isfinite(hi) and not 0 < hi <= 180:
        raise GeometryError(f"a cone angle is counted from the +z axis, 0 to 180 degrees, not {lo:g} to {hi:g}")
    return (lo if lo > 0 else -np.inf, hi if hi < 180 else np.inf)


def _angle(limits: Limits) -> tuple[float, float]:
    """A missing end is 0 or 360 degrees; a whole turn counts as unbounded."""
    lo, hi = span(limits.angle, "the azimuth")
    if np.isinf(lo) and np.isinf(hi):
        return lo, hi
    lo = min(0.0, hi - WHOLE_TURN) if np.isinf(lo) and hi <= 0 else 0.0 if np.isinf(lo) else lo
    hi = (WHOLE_TURN if lo < WHOLE_TURN else lo + WHOLE_TURN) if np.isinf(hi) else hi
    return (lo, hi) if hi - lo < WHOLE_TURN else (-np.inf, np.inf)


def _stretched_quadric(q: Quadric, s: np.ndarray) -> Quadric:
    sx, sy, sz = s
    return Quadric(
        q.c, q.cx / sx, q.cy / sy, q.cz / sz, q.cxy / sx / sy, q.cxz / sx / sz, q.cyz / sy / sz,
        q.cx2 / sx / sx, q.cy2 / sy / sy, q.cz2 / sz / sz, q.crxy / sx,
    )  # fmt: skip


def _as_quadrics(bounds: tuple[float, float], squares: tuple[float, float, float]) -> list[Quadric]:
    """Lower and upper bound of √(Σ squares x²)."""
    (lo, hi), (a, b, c) = bounds, squares
    found = []
    if np.isfinite(hi):
        found.append(Quadric(-1.0, cx2=a / hi**2, cy2=b / hi**2, cz2=c / hi**2))
    if np.isfinite(lo):
        found.append(Quadric(1.0, cx2=-a / lo**2, cy2=-b / lo**2, cz2=-c / lo**2))
    return found


def _stretched_angle(degrees: float, opposite: float, adjacent: float) -> float:
    """The angle whose tangent is (opposite / adjacent) times the old one, in the same quadrant and turn."""
    if np.isinf(degrees) or opposite == adjacent:
        return degrees
    a = np.radians(degrees)
    new = np.degrees(np.arctan2(opposite * np.sin(a), adjacent * np.cos(a)))
    return float(new + WHOLE_TURN * np.round((degrees - new) / WHOLE_TURN))
