"""Which shape a piece is: the simplest one that its conditions make, so that the exact formulas apply.

box limiters alone                                  Box
sphere limiter alone, quadric with equal squares    Ball
radius, sphere, cone, z, azimuth limiters, torus,
quadrics with a straight or round section           Revolved
any other quadric                                   QuadricSolid, RootQuadricSolid
several of these                                    Common
"""

from __future__ import annotations

import numpy as np

from flowgmo.geometry.combined import Common, Stretched
from flowgmo.geometry.errors import GeometryError
from flowgmo.geometry.mesh_solid import MeshSolid
from flowgmo.geometry.piece import Piece, Quadric
from flowgmo.geometry.primitives import Ball, Box, HalfSpace
from flowgmo.geometry.profile import Bound
from flowgmo.geometry.quadrics import QuadricSolid, matrices
from flowgmo.geometry.region import Region, region_of
from flowgmo.geometry.revolved import Revolved
from flowgmo.geometry.root_quadric import RootQuadricSolid
from flowgmo.geometry.solid import Solid
from flowgmo.geometry.tighten import tighten
from flowgmo.geometry.transform import Affine
from flowgmo.geometry.turned import half_plane_field, height_bounds, label, turned_quadric

EVEN = 1e-12  # relative difference of magnifications that counts as none: some rounding errors


def recognise(piece: Piece, component: Affine) -> Solid:
    """The solid that a piece is, in space, `component` being the map applied after the piece's own."""
    total = component.after(piece.transform.affine)
    region, columns = region_of(piece), total.columns()
    stretched = None
    if columns is not None:
        R, s = columns
        s = np.full(3, s[0]) if np.ptp(s) <= EVEN * s[0] else s
        stretched = region.stretched(s)
    if stretched is not None:
        shape, place = _shape(stretched), (1.0, R, total.b)
    else:
        shape = _shape(region)
        shape, place = Stretched(shape, total.A) if shape else None, (1.0, np.eye(3), total.b)
    parts = [Solid(shape, *place)] if shape else []
    if piece.stl is not None:
        parts.append(Solid(MeshSolid.of(piece.stl, total), 1.0, np.eye(3), np.zeros(3)))
    if not parts:
        return Solid(Box(np.full(3, -np.inf), np.full(3, np.inf)), 1.0, np.eye(3), total.b)
    if len(parts) == 1:
        return _flattened(parts[0])
    return Solid(Common(tuple(parts), np.full(3, -np.inf), np.full(3, np.inf)), 1.0, np.eye(3), np.zeros(3))


def _flattened(solid: Solid) -> Solid:
    """A solid whose shape is itself a placed solid becomes one solid."""
    inner = solid.shape
    if not isinstance(inner, Solid):
        return solid
    return Solid(inner.shape, solid.scale * inner.scale, solid.R @ inner.R, solid.place(inner.b))


def _shape(region: Region) -> Solid | None:
    """The region as a solid in its own frame; None when it is the whole space."""
    lo, hi = region.lo.copy(), region.hi.copy()
    bounds, rest = _round_limits(region), []
    for quadric in region.quadrics:
        kind = _sort(quadric, lo, hi)
        if isinstance(kind, Bound):
            bounds.append(kind)
        elif kind is not None:
            rest.append(kind)
    if (lo >= hi).any():
        raise GeometryError("the limiters and the quadric have nothing in common")
    parts: list[Solid] = []
    if bounds or np.isfinite(region.angle).any():
        parts.append(_revolved(bounds, (lo[2], hi[2]), region.angle))
        lo[2], hi[2] = -np.inf, np.inf
    elif len(rest) == 1 and isinstance(rest[0], QuadricSolid) and (solid := turned_quadric(rest[0], lo, hi)):
        parts, rest = [solid], []
    if np.isfinite(lo).any() or np.isfinite(hi).any():
        parts.append(_here(Box(lo, hi)))
    parts += [_here(shape) for shape in rest]
    if len(parts) < 2 and not any(isinstance(shape, RootQuadricSolid) for shape in rest):
        return parts[0] if parts else None
    corners = np.array([part.bounds() for part in parts if not isinstance(part.shape, RootQuadricSolid)] or [[lo, hi]])
    conditions = [
        QuadricSolid(np.zeros((3, 3)), shape.n / 2, -shape.h) if isinstance(shape, HalfSpace) else shape
        for shape in rest
    ]
    box = tighten(corners[:, 0].max(0), corners[:, 1].min(0), conditions + _azimuth_planes(region.angle))
    return _here(Common(tuple(parts), *box))


def _azimuth_planes(angle: tuple[float, float]) -> list[QuadricSolid]:
    """The two planes of an azimuth range of at most 180 degrees, n . x <= 0 as quadrics without squares."""
    if not angle[1] - angle[0] <= 180:
        return []
    normals = [(side * -np.sin(a), side * np.cos(a), 0.0) for a, side in zip(np.radians(angle), (-1, 1), strict=True)]
    return [QuadricSolid(np.zeros((3, 3)), np.array(n) / 2, 0.0) for n in normals]


def _here(shape: object) -> Solid:
    return Solid(shape, 1.0, np.eye(3), np.zeros(3))


def _round_limits(region: Region) -> list[Bound]:
    """Bounds in (r, z) of the radius, sphere, and cone limiters and the torus."""
    bounds = []
    (r0, r1), (s0, s1), cone = region.radius, region.sphere, np.radians(region.cone)
    if np.isfinite(r1):
        bounds.append(Bound(k=1.0, c=-r1))
    if np.isfinite(r0):
        bounds.append(Bound(k=-1.0, c=r0))
    if np.isfinite(s1):
        bounds.append(Bound(a=1.0, e=1.0, c=-(s1**2)))
    if np.isfinite(s0):
        bounds.append(Bound(a=-1.0, e=-1.0, c=s0**2))
    for angle, side in zip(cone, (-1.0, 1.0), strict=True):
        if np.isfinite(angle):  # polar angle <= θ  <=>  r cos θ - z sin θ <= 0
            bounds.append(Bound(k=side * np.cos(angle), l=-side * np.sin(angle)))
    if region.torus:
        middle, tube = (region.torus.inner + region.torus.outer) / 2, (region.torus.outer - region.torus.inner) / 2
        bounds.append(Bound(a=1.0, k=-2 * middle, e=1.0, c=middle**2 - tube**2))
    return bounds


def _sort(q: Quadric, lo: np.ndarray, hi: np.ndarray) -> Bound | HalfSpace | QuadricSolid | RootQuadricSolid | None:
    """What a quadric is; planes across an axis go into lo, hi (3,) and give None, as does one that holds everywhere."""
    M, b, c = matrices(q)
    numbers = np.array([*M.ravel(), *b, c, q.crxy])
    if not np.isfinite(numbers).all():
        raise GeometryError("the quadric has a coefficient that is not a finite number")
    if q.crxy == 0 and not M.any():
        return _plane(2 * b, c, lo, hi)
    diagonal = np.array_equal(M, np.diag(np.diag(M)))
    if diagonal and M[0, 0] == M[1, 1] and b[0] == 0 == b[1]:
        bound = Bound(a=M[0, 0], k=q.crxy, e=M[2, 2], l=2 * b[2], c=c)
        _check_not_empty(M, b, c, q.crxy)
        if bound.curves():
            return bound
    if q.crxy:
        return RootQuadricSolid(M, b, c, q.crxy)
    return None if _check_not_empty(M, b, c, 0.0) else QuadricSolid(M, b, c)


def _plane(n: np.ndarray, c: float, lo: np.ndarray, hi: np.ndarray) -> HalfSpace | None:
    if not n.any():
        if c > 0:
            raise GeometryError(
                f"the quadric is the constant {c:g} > 0, so nothing is inside: write CC <= 0, or coefficients"
            )
        return None
    if np.count_nonzero(n) == 1:
        axis = int(np.flatnonzero(n)[0])
        if n[axis] > 0:
            hi[axis] = min(hi[axis], -c / n[axis])
        else:
            lo[axis] = max(lo[axis], -c / n[axis])
        return None
    return HalfSpace(n / np.linalg.norm(n), -c / np.linalg.norm(n))


def _check_not_empty(M: np.ndarray, b: np.ndarray, c: float, k: float) -> bool:
    """Raise when no point, or only points without volume, satisfy the quadric; True when every point does."""
    solid = QuadricSolid(M, b, c)
    if k != 0 or not M.any() or solid.centre is None:
        return False
    m, least = solid.eigen[0], solid.centre[1]
    if (m >= 0).all() and least >= 0:
        raise GeometryError(
            f"the quadric is nowhere negative (least value {least:g}), so nothing is inside: check the sign of CC"
        )
    return bool((m <= 0).all() and least <= 0)


def _revolved(bounds: list[Bound], z: tuple[float, float], angle: tuple[float, float]) -> Solid:
    """A ball, or the solid of revolution of all bounds."""
    whole = not np.isfinite(angle).any()
    heights = height_bounds(z)
    if whole and len(bounds) == 1 and not heights and bounds[0].a > 0 and bounds[0].a == bounds[0].e:
        (circle,) = bounds[0].curves()
        if circle.centre[0] == 0:
            return Solid(Ball(float(circle.radius)), 1.0, np.eye(3), np.array([0.0, 0.0, circle.centre[1]]))
    everything = (*bounds, *heights)
    turn = (0.0, 360.0) if whole else angle
    shape = Revolved(everything, half_plane_field(everything), turn, label(bounds, z, turn))
    if not shape.pieces and whole and not shape.field(np.array([1e6 * shape.size]), np.array([0.0]))[0]:
        raise GeometryError("the limiters, the quadric, and the torus have nothing in common")
    return _here(shape)
