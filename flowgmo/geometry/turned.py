"""Names of solids of revolution, and quadrics of revolution about any axis.

x.Mx + 2 b.x + c with eigenvalues (a, a, e):   a r² + e z² + 2 b_z z + c about the axis of the single eigenvalue
"""

from __future__ import annotations

import numpy as np

from flowgmo.geometry.primitives import Ball
from flowgmo.geometry.profile import Bound, Field
from flowgmo.geometry.quadrics import QuadricSolid
from flowgmo.geometry.revolved import Revolved
from flowgmo.geometry.solid import Solid

EQUAL = 1e-12  # relative difference of eigenvalues that counts as none: rounding of the eigenvalue solver


def half_plane_field(bounds: tuple[Bound, ...], weight: float = 1.0) -> Field:
    """Weight where all bounds hold, else 0."""

    def field(r: np.ndarray, z: np.ndarray) -> np.ndarray:
        within = np.ones(np.shape(r), bool)
        for bound in bounds:
            within &= bound.value(r, z) <= 0
        return np.where(within, weight, 0.0)

    return field


def height_bounds(z: tuple[float, float]) -> list[Bound]:
    """z >= z[0] and z <= z[1], each where finite."""
    low, high = Bound(l=-1.0, c=float(z[0])), Bound(l=1.0, c=-float(z[1]))
    return [bound for bound, end in zip((low, high), z, strict=True) if np.isfinite(end)]


def turned_quadric(quadric: QuadricSolid, lo: np.ndarray, hi: np.ndarray) -> Solid | None:
    """Sphere, cylinder, or cone about any axis; box limits lo, hi (3,) along its axis are used up (set to ±inf)."""
    (m, V), centre = quadric.eigen, quadric.centre
    if centre is None:
        return None
    size = np.abs(m).max()
    pairs = [(i, j) for i, j in ((0, 1), (1, 2)) if abs(m[i] - m[j]) <= EQUAL * size]
    middle, depth = centre
    if len(pairs) == 2:
        radius = np.sqrt(-depth / m[0]) if m[0] > 0 else None
        return Solid(Ball(float(radius)), 1.0, np.eye(3), middle) if radius else None
    if len(pairs) != 1:
        return None
    single = 3 - sum(pairs[0])
    axis = V[:, single] * np.sign(V[np.abs(V[:, single]).argmax(), single])
    bound = Bound(a=m[pairs[0][0]], e=m[single], c=0.0 if abs(depth) <= EQUAL * abs(quadric.c) else depth)
    if not bound.curves():
        return None
    along = int(np.abs(axis).argmax())
    heights, z = [], (-np.inf, np.inf)
    if 1 - abs(axis[along]) < EQUAL:
        axis = np.eye(3)[along]
        z = (lo[along] - middle[along], hi[along] - middle[along])
        heights = height_bounds(z)
        lo[along], hi[along] = -np.inf, np.inf
    bounds = (bound, *heights)
    shape = Revolved(bounds, half_plane_field(bounds), label=label([bound], z, (0.0, 360.0)))
    return Solid(shape, 1.0, _frame(axis), middle)


def _frame(axis: np.ndarray) -> np.ndarray:
    """Right-handed axes (3,3) as columns with the given third one; a permutation for a coordinate axis."""
    first = np.roll(np.eye(3)[np.abs(axis).argmax()], 1)
    first = first - (first @ axis) * axis
    first /= np.linalg.norm(first)
    return np.column_stack([first, np.cross(axis, first), axis])


def label(bounds: list[Bound], z: tuple[float, float], angle: tuple[float, float]) -> str:
    """The name of the solid of revolution of bounds, height limits, and azimuth limits."""
    lengths = f"height {z[1] - z[0]:.6g}" if np.isfinite(z[1] - z[0]) else "unbounded"
    name = _name([bound.scaled() for bound in bounds], z, lengths)
    if angle[1] - angle[0] < 360:
        name += f", azimuth {angle[0]:.6g} to {angle[1]:.6g} degrees"
    return name


def _name(bounds: list[Bound], z: tuple[float, float], lengths: str) -> str:
    walls = sorted(-b.c / b.k for b in bounds if b.k and not (b.a or b.e or b.l))
    walls += sorted(np.sqrt(-b.c / b.a) for b in bounds if b.a and not (b.k or b.e or b.l) and b.c * b.a < 0)
    balls = sorted(np.sqrt(-b.c / b.a) for b in bounds if b.a and b.a == b.e and not (b.k or b.l) and b.c * b.a < 0)
    rings = [b for b in bounds if b.a and b.a == b.e and b.k]
    if len(walls) == len(bounds) == 1:
        return f"cylinder, radius {walls[0]:.6g}, {lengths}"
    if len(walls) == len(bounds) == 2:
        return f"tube, radii {min(walls):.6g} and {max(walls):.6g}, {lengths}"
    if len(balls) == len(bounds) == 2:
        return f"spherical shell, radii {balls[0]:.6g} and {balls[1]:.6g}" + (", cut" if np.isfinite(z).any() else "")
    if len(balls) == len(bounds) == 1:
        return f"sphere, radius {balls[0]:.6g}, cut"
    if len(rings) == len(bounds) == 1:
        middle = -rings[0].k / (2 * rings[0].a)
        return f"torus, radii {middle:.6g} and {np.sqrt(middle**2 - rings[0].c / rings[0].a):.6g}"
    if len(bounds) == 1 and bounds[0].curves() and not bounds[0].a * bounds[0].e > 0:
        return f"cone or frustum, {lengths}"
    return "solid of revolution"
