"""Solids of revolution about the z axis, whole or between two azimuths.

d(x, y, z) = d_outline(√(x² + y²), z)                                         whole turn: exact
between azimuths also the two flat faces: d = √(w² + max(d_outline(ρ, z), 0)²), (ρ, w) along and off the face
∫ f dV = ∮ (∫ f r dr) n_r ds over the outline, times the integral over the azimuth (Green)
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from flowgmo.geometry.moments import Moments
from flowgmo.geometry.primitives import Mesh, linear_roots, quadratic_roots
from flowgmo.geometry.profile import Bound, Circle, Field, Outline, outline, size_of
from flowgmo.geometry.ring_faces import ring_faces

GAUSS = np.polynomial.legendre.leggauss(40)  # exact for straight pieces, to rounding for arcs of a whole turn
WHOLE = (0.0, 360.0)


@dataclass(frozen=True, eq=False)
class Revolved:
    """Region of the half-plane turned about z; angle (lo, hi) in degrees.

    bounds: the curves of all of them may carry surface; field(r, z): density weight, 0 outside.
    """

    bounds: tuple[Bound, ...]
    field: Field
    angle: tuple[float, float] = WHOLE
    label: str = "solid of revolution"

    @cached_property
    def curves(self) -> list:
        return [curve for bound in self.bounds for curve in bound.curves() or []]

    @cached_property
    def size(self) -> float:
        return size_of(self.curves)

    @cached_property
    def pieces(self) -> list[Outline]:
        return outline(self.curves, lambda r, z: (self.field(r, z) != 0).astype(float))

    @cached_property
    def axis_pieces(self) -> list[Outline]:
        return outline(self.curves, lambda r, z: (self.field(r, z) != 0).astype(float), on_axis=True)

    @property
    def whole(self) -> bool:
        return self.angle[1] - self.angle[0] >= 360.0

    @property
    def half_angle(self) -> float:
        return np.radians(self.angle[1] - self.angle[0]) / 2

    def _azimuth(self, x: np.ndarray) -> np.ndarray:
        """Azimuth (n,) from the middle of the range, -π to π."""
        phi = np.arctan2(x[:, 1], x[:, 0]) - np.radians(sum(self.angle) / 2)
        return np.mod(phi + np.pi, 2 * np.pi) - np.pi

    def inside(self, x: np.ndarray) -> np.ndarray:
        within = self.field(np.hypot(x[:, 0], x[:, 1]), x[:, 2]) != 0
        return within if self.whole else within & (np.abs(self._azimuth(x)) <= self.half_angle)

    def distance(self, x: np.ndarray) -> np.ndarray:
        return self._nearest(x)[0]

    def normal(self, x: np.ndarray) -> np.ndarray:
        return self._nearest(x)[1]

    def _nearest(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        r = np.hypot(x[:, 0], x[:, 1])
        sign = np.where(self.inside(x), -1.0, 1.0)
        outward = np.where(r[:, None] > 0, x[:, :2] / np.where(r > 0, r, 1.0)[:, None], [1.0, 0.0])
        d, n = nearest_piece(self.pieces, np.stack([r, x[:, 2]], 1), sign)
        normal = np.column_stack([n[:, :1] * outward, n[:, 1]])
        if not self.whole:
            d = np.where(np.abs(self._azimuth(x)) <= self.half_angle, d, np.inf)
            for side in (-1.0, 1.0):
                df, nf = self._face(x, side, sign)
                normal, d = np.where((df < d)[:, None], nf, normal), np.minimum(d, df)
        return sign * d, normal

    def _face(self, x: np.ndarray, side: float, sign: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Distance (n,) to one flat face and outward normal (n,3)."""
        turn = np.radians(self.angle[1] if side > 0 else self.angle[0])
        along, off = np.array([np.cos(turn), np.sin(turn)]), side * np.array([-np.sin(turn), np.cos(turn)])
        rho, w = x[:, :2] @ along, x[:, :2] @ off
        within = (self.field(np.maximum(rho, 0), x[:, 2]) != 0) & (rho >= 0)
        flat, n = nearest_piece(self.pieces + self.axis_pieces, np.stack([rho, x[:, 2]], 1), np.ones(len(x)))
        flat = np.where(within, 0.0, flat)
        d = np.hypot(w, flat)
        plane = np.append(off, 0.0)
        edge = w[:, None] * plane + flat[:, None] * np.column_stack([n[:, :1] * along, n[:, 1]])
        far = (~within & (d > 0))[:, None]
        return d, np.where(far, sign[:, None] * edge / np.where(d > 0, d, 1.0)[:, None], plane)

    def support(self, d: np.ndarray) -> float:
        across = float(np.hypot(d[0], d[1]))
        pieces = self.pieces
        if not self.whole:
            phi = self._azimuth(np.array([d]))[0]
            across *= float(np.cos(max(abs(phi) - self.half_angle, 0.0)))
            pieces = pieces + self.axis_pieces
        direction = np.array([across, d[2]])
        far = np.array([[1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
        endless = far[self.field(*(1e6 * self.size * far.T)) != 0]  # far beyond every crossing of the curves
        if (endless @ direction > 0).any():
            return np.inf
        return max((piece.support(direction) for piece in pieces), default=-np.inf)

    def moments(self, field: Field | None = None) -> Moments | None:
        """Closed moments of the region, or of a field of densities over it."""
        if not np.isfinite([self.support(e) for e in np.vstack([np.eye(3), -np.eye(3)])]).all():
            return None
        pieces = self.pieces if field is None else outline(self.curves, field)
        s0, s1, sz, szz, srr, s1z = sum((_green(piece) for piece in pieces), np.zeros(6))
        lo, hi = np.radians(self.angle)
        c, s = np.sin(hi) - np.sin(lo), np.cos(lo) - np.cos(hi)
        c2, s2 = (np.sin(2 * hi) - np.sin(2 * lo)) / 4, (np.sin(hi) ** 2 - np.sin(lo) ** 2) / 2
        turn = hi - lo
        if self.whole:
            turn, c, s, c2, s2 = 2 * np.pi, 0.0, 0.0, 0.0, 0.0
        xx, yy, xy, xz, yz = srr * (turn / 2 + c2), srr * (turn / 2 - c2), srr * s2, s1z * c, s1z * s
        second = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, szz * turn]])
        return Moments(float(s0 * turn), np.array([s1 * c, s1 * s, sz * turn]), second)

    def roots(self, x: np.ndarray, d: np.ndarray) -> np.ndarray:
        found = [_bound_roots(bound, x, d) for bound in self.bounds]
        if not self.whole:
            for turn in np.radians(self.angle):
                n = np.array([-np.sin(turn), np.cos(turn), 0.0])
                found.append(linear_roots(np.full(len(x), d @ n), x @ n)[:, None])
        return np.hstack(found) if found else np.empty((len(x), 0))

    def faces(self, resolution: int) -> Mesh | None:
        if not self.whole or not self.pieces or not all(piece.finite() for piece in self.pieces):
            return None
        return ring_faces(self.pieces, self.size, resolution)

    def describe(self) -> str:
        return self.label


def nearest_piece(pieces: list[Outline], p: np.ndarray, sign: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Distance (n,) and outward normal (n,2) of the nearest of several pieces."""
    d, n = np.full(len(p), np.inf), np.tile([1.0, 0.0], (len(p), 1))
    for piece in pieces:
        new, normal = piece.nearest(p, sign)
        n, d = np.where((new < d)[:, None], normal, n), np.minimum(d, new)
    return d, n


def _green(piece: Outline) -> np.ndarray:
    """∫ of 1, x/cos, z, z², r², x z/cos over the half-plane, weighted with r, from one piece of the outline."""
    node, weight = GAUSS
    half = (piece.t1 - piece.t0) / 2
    t = (piece.t1 + piece.t0) / 2 + half * node
    r, z = piece.curve.at(t).T
    speed = piece.curve.radius if isinstance(piece.curve, Circle) else 1.0
    ds = piece.jump * piece.outward * piece.curve.normal(t)[:, 0] * weight * half * speed
    inner = np.stack([r**2 / 2, r**3 / 3, z * r**2 / 2, z**2 * r**2 / 2, r**4 / 4, z * r**3 / 3])
    return inner @ ds


def _bound_roots(bound: Bound, x: np.ndarray, d: np.ndarray) -> np.ndarray:
    """t where the line x + t d meets a bound: a s + k √s + e z² + l z + c = 0, s = x² + y², a quartic when squared."""
    s = np.stack([np.full(len(x), d[:2] @ d[:2]), 2 * x[:, :2] @ d[:2], (x[:, :2] ** 2).sum(1)])
    z2 = np.stack([np.full(len(x), d[2] ** 2), 2 * x[:, 2] * d[2], x[:, 2] ** 2])
    z1 = np.stack([np.zeros(len(x)), np.full(len(x), d[2]), x[:, 2]])
    rest = bound.a * s + bound.e * z2 + bound.l * z1 + np.array([0, 0, bound.c])[:, None]
    if bound.k == 0:
        return quadratic_roots(*rest)
    if bound.a == 0 and bound.e == 0:
        _, b, c = rest
        return quadratic_roots(*(np.stack([b * b, 2 * b * c, c * c]) - bound.k**2 * s))
    a, b, c = rest
    square = np.stack([a * a, 2 * a * b, 2 * a * c + b * b, 2 * b * c, c * c])
    square[2:] -= bound.k**2 * s
    return quartic_roots(square)


def quartic_roots(p: np.ndarray) -> np.ndarray:
    """Real parts (n,4) of the roots of p[0] t⁴ + ... + p[4], p (5,n); of complex pairs they are harmless extra cuts."""
    lead = np.where(np.abs(p[0]) > 1e-14 * np.abs(p).max(0), p[0], np.nan)  # lower degree: no quartic to solve
    companion = np.zeros((p.shape[1], 4, 4))
    companion[:, 0] = np.nan_to_num(-(p[1:] / lead).T)
    companion[:, [1, 2, 3], [0, 1, 2]] = 1.0
    return np.where(np.isnan(lead)[:, None], np.nan, np.linalg.eigvals(companion).real)
