"""The smooth surfaces (sheets) that a body's faces are parts of, each going on beyond its edges.

The distance of a body has kinks where two of its faces meet, so that it tells little about a mesh cell with an edge in
it. Its sheets have none: a box has six planes, a cylinder with ends two planes and one round sheet, a mesh the planes
of its triangles. With the sheets, a cell falls into parts that lie wholly inside or outside, and planes are exact.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from flowgmo.geometry.combined import Common, Stretched
from flowgmo.geometry.mesh_solid import MeshSolid
from flowgmo.geometry.primitives import Box, HalfSpace
from flowgmo.geometry.revolved import WHOLE, Revolved
from flowgmo.geometry.solid import Solid
from flowgmo.geometry.transform import Affine
from flowgmo.geometry.turned import half_plane_field

if TYPE_CHECKING:
    from flowgmo.geometry.component import Component
    from flowgmo.geometry.profile import Bound


class Sheets(NamedTuple):
    """Planes n . x = h, n (m, 3) of unit length, h (m,) [length]; low, high (m, 3): each carries surface in this box
    only. curved: distances of smooth sheets, of either sign, and curved_low, curved_high (c, 3) likewise.

    single: the body is where its one sheet is negative.
    """

    n: np.ndarray
    h: np.ndarray
    low: np.ndarray
    high: np.ndarray
    curved: tuple[Callable[[np.ndarray], np.ndarray], ...]
    curved_low: np.ndarray
    curved_high: np.ndarray
    single: bool


def sheets_of(component: Component) -> Sheets:
    """The sheets of all pieces of a body, in space."""
    found = [sheets_of_solid(solid) for solid in component.solids]
    n, h, low, high, curved_low, curved_high = (np.concatenate([s[k] for s in found]) for k in (0, 1, 2, 3, 5, 6))
    curved = tuple(d for s in found for d in s.curved)
    single = component.roles == ("solid",) and len(n) + len(curved) == 1
    return Sheets(n, h, low, high, (component.distance,) if single and curved else curved, curved_low, curved_high,
                  single)  # fmt: skip


def sheets_of_solid(solid: Solid) -> Sheets:
    """The sheets of one piece by itself, in space; none of an empty one."""
    planes: list[tuple] = []
    curved: list[tuple] = []
    low, high = solid.bounds()
    if (low <= high).all():
        _collect(solid.shape, solid.place, low, high, planes, curved)
    n, h, low, high = (np.concatenate(rows) for rows in zip(*planes, _no_planes(), strict=True))
    ends = [np.array([c[k] for c in curved]).reshape(-1, 3) for k in (1, 2)]
    return Sheets(n, h, low, high, tuple(c[0] for c in curved), *ends, len(n) + len(curved) == 1)


def _no_planes() -> tuple:
    nothing = np.zeros((0, 3))
    return nothing, np.zeros(0), nothing, nothing


def _collect(shape: object, place: Affine, low: np.ndarray, high: np.ndarray, planes: list, curved: list) -> None:
    """Append the sheets of a shape whose own frame `place` maps to space; low, high (3,): its box in space."""
    if isinstance(shape, Common | Stretched):
        parts = shape.parts if isinstance(shape, Common) else (shape.solid,)
        outer = place if isinstance(shape, Common) else place.after(Affine(shape.A, np.zeros(3)))
        for part in parts:
            _collect(part.shape, outer.after(part.place), low, high, planes, curved)
    elif isinstance(shape, Box):
        for axis in range(3):
            for end, sign in ((shape.lo[axis], -1.0), (shape.hi[axis], 1.0)):
                if np.isfinite(end):
                    planes.append(_plane(sign * np.eye(3)[axis], sign * end, place, low, high))
    elif isinstance(shape, HalfSpace):
        planes.append(_plane(shape.n, shape.h, place, low, high))
    elif isinstance(shape, MeshSolid):
        planes.append(_facets(place(shape.corners.reshape(-1, 3)).reshape(-1, 3, 3)))
    elif isinstance(shape, Revolved):
        _collect_round(shape, place, low, high, planes, curved)
    else:
        curved.append((_placed(shape, place), low, high))


def _collect_round(
    shape: Revolved, place: Affine, low: np.ndarray, high: np.ndarray, planes: list, curved: list
) -> None:
    """Planes across the axis and along it, and one round sheet for each bound that is neither."""
    for bound in shape.bounds:
        heights = _heights(bound)
        if heights is None:
            alone = Revolved((bound,), half_plane_field((bound,)), WHOLE)
            curved.append((_placed(alone, place), low, high))
            continue
        planes.extend(_plane(np.array([0.0, 0.0, 1.0]), z, place, low, high) for z in heights)
    if not shape.whole:
        for angle in np.radians(shape.angle):
            planes.append(_plane(np.array([-np.sin(angle), np.cos(angle), 0.0]), 0.0, place, low, high))


def _heights(bound: Bound) -> list[float] | None:
    """Where a bound of z alone ends; None for one of r too."""
    if bound.a != 0.0 or bound.k != 0.0:
        return None
    curves = bound.curves() or []
    return [float(curve.at(np.zeros(1))[0, 1]) for curve in curves]


def _plane(n: np.ndarray, h: float, place: Affine, low: np.ndarray, high: np.ndarray) -> tuple:
    """One plane n . y = h of the own frame, in space."""
    columns = place.columns()
    if columns is not None and np.ptp(columns[1]) == 0.0:
        turned, h = columns[0] @ n, columns[1][0] * h  # exact for axes along the mesh
    else:
        turned = np.linalg.solve(place.A.T, n)
        h = h / np.linalg.norm(turned)
        turned = turned / np.linalg.norm(turned)
    return turned[None], np.array([h + turned @ place.b]), low[None], high[None]


def _facets(corners: np.ndarray) -> tuple:
    """Planes of triangles (f, 3, 3) that have an area."""
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(cross, axis=1)
    corners, cross, area = corners[area > 0.0], cross[area > 0.0], area[area > 0.0]
    n = cross / area[:, None]
    return n, np.einsum("ij,ij->i", n, corners.mean(axis=1)), corners.min(axis=1), corners.max(axis=1)


def _placed(shape: object, place: Affine) -> Callable[[np.ndarray], np.ndarray]:
    """Distance in space; of the right sign, and exact on the surface, where the map is no similarity."""
    columns = place.columns()
    if columns is not None and np.ptp(columns[1]) == 0.0:
        return Solid(shape, float(columns[1][0]), columns[0], place.b).distance
    inverse, least = np.linalg.inv(place.A), float(np.linalg.svd(place.A, compute_uv=False)[-1])
    return lambda x: least * shape.distance((x - place.b) @ inverse.T)
