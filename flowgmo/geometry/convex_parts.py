"""What a component is made of for the contact search: convex parts, and meshes where there is no other way.

| component                                                            | parts                               |
|----------------------------------------------------------------------|-------------------------------------|
| sphere, box, half-space, ellipsoid, convex mesh, planar limiters     | one, exact                          |
| cylinder, cone, frustum; several on one axis without a bore          | frustums, exact                     |
| union of solids                                                      | those of each                       |
| all but a solid (tank, pipe)                                         | the solid's one part, as a hole     |
| boxes with common axes and holes                                     | disjoint boxes, exact               |
| concave mesh                                                         | its triangles, exact                |
| all else: torus, sector, other quadrics, anything else with holes    | triangles, `error` measured         |

Where parts of one body overlap or meet flush, some of their faces lie inside it: a contact there is none of the body.
What is infinite is cut at `far`, triangles of infinite bodies at `clip`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from flowgmo.geometry.combined import Common, Stretched
from flowgmo.geometry.component import Component
from flowgmo.geometry.lattice import Lattice
from flowgmo.geometry.mesh_solid import MeshSolid
from flowgmo.geometry.piece import Piece
from flowgmo.geometry.primitives import Ball, Box, HalfSpace
from flowgmo.geometry.profile import Line
from flowgmo.geometry.quadrics import QuadricSolid
from flowgmo.geometry.refine import refined
from flowgmo.geometry.revolved import Revolved
from flowgmo.geometry.solid import Solid
from flowgmo.geometry.surface import Surface, convex_corners, surface_of

BALL, BOX, FRUSTUM, ELLIPSOID, POLYTOPE, HALF_SPACE, MESH = (
    "ball", "box", "frustum", "ellipsoid", "polytope", "half-space", "mesh",
)  # fmt: skip
SAME = 1e-9  # of the size: ends of outlines and corners that are one (profile.SIDE)
ACROSS = 1e-12  # cosine that counts as none: rounding of rotations
DIGITS = 2.0**-20  # of the largest coordinate: seven digits of text files; binary ones hold 24 bits
Planes = tuple[np.ndarray, np.ndarray]  # normals (n,3), unit, and heights (n,): n . x <= h


@dataclass(frozen=True, eq=False)
class Part:
    """centre (3,); axes (3,3), unit rows, right-handed; size (3,) by kind; hole: the matter is outside.

    ball: size[0] radius · box: half edges · frustum: radius at -size[2], at +size[2], half height, along axes[2] ·
    ellipsoid: half axes · polytope: vertices (k,3) from the centre · half-space: below the plane through the centre,
    outward axes[2] · mesh: surface in space, `error` [length] its measured distance from the true one.
    """

    kind: str
    centre: np.ndarray
    axes: np.ndarray
    size: np.ndarray
    hole: bool = False
    vertices: np.ndarray | None = None
    surface: Surface | None = None
    error: float = 0.0


@dataclass(frozen=True, eq=False)
class Scene:
    """middle (3,), far: beyond this distance from it [length] nothing is; clip (2,3): box that meshes are cut to.

    accuracy: of curved surfaces, in sizes of the body; most: triangles of one body.
    """

    middle: np.ndarray
    far: float
    clip: np.ndarray
    accuracy: float = 1e-3
    most: int = 20_000


def convex_parts(component: Component, scene: Scene) -> list[Part]:
    """Parts whose union has the component's surface, see above."""
    if "hole" in component.roles:
        parts = None if component.merged is None else _of_solid(component.merged, scene)
        return [_mesh(component, scene)] if parts is None else parts
    found = []
    for role, solid, piece in zip(component.roles, component.solids, component.pieces, strict=True):
        parts = _of_mesh(component, piece, solid) if piece.stl is not None else _of_solid(solid, scene)
        if role == "complement" and parts is not None:
            parts = [_hollow(parts[0])] if len(parts) == 1 else None
        found += [_mesh(Component([piece], component.transform), scene)] if parts is None else parts
    return found


def _hollow(part: Part) -> Part:
    """All but a part."""
    if part.kind == HALF_SPACE:
        return _half_space(-part.axes[2], part.centre)
    if part.kind == MESH:
        return replace(part, surface=part.surface.inside_out())
    return replace(part, hole=True)


def _of_solid(solid: Solid, scene: Scene) -> list[Part] | None:
    """Exact convex parts of a solid; None where it has none."""
    shape, s = solid.shape, solid.scale
    if isinstance(shape, Ball):
        return [Part(BALL, solid.b, np.eye(3), np.array([s * shape.radius, 0.0, 0.0]))]
    if isinstance(shape, Box):
        return _box(solid, shape, scene)
    if isinstance(shape, Lattice):
        return [part for box in shape.boxes for part in _box(solid, box, scene)]
    if isinstance(shape, HalfSpace):
        normal = solid.R @ shape.n
        return [_half_space(normal, solid.b + s * shape.h * normal)]
    if isinstance(shape, Revolved) and (frustums := _frustums(solid, shape, scene)):
        return frustums
    if isinstance(shape, QuadricSolid) and (place := shape.ellipsoid()) is not None:
        return [_ellipsoid(s * solid.R @ place.A, solid.place(place.b))]
    if isinstance(shape, Stretched) and isinstance(shape.solid.shape, Ball):
        ball = shape.solid
        return [_ellipsoid(s * ball.scale * ball.shape.radius * solid.R @ shape.A, solid.place(shape.A @ ball.b))]
    planes = _planes(solid)
    return None if planes is None else [_polytope(_corners(planes, scene))]


def _of_mesh(component: Component, piece: Piece, solid: Solid) -> list[Part] | None:
    """The polytope or the triangles of a mesh from a file; None when limiters cut it."""
    if not isinstance(solid.shape, MeshSolid):
        return None
    place = component.transform.affine.after(piece.transform.affine)
    rounding = DIGITS * np.abs(piece.stl.vertices).max() * np.linalg.norm(place.A, 2)
    surface = surface_of(solid.place(solid.shape.vertices), solid.shape.triangles, rounding)
    corners = convex_corners(surface, rounding)
    return [_polytope(corners) if corners is not None else _surface(surface, 0.0)]


def _right_handed(axes: np.ndarray) -> np.ndarray:
    """Axes (3,3) with the first one turned around if they mirror: all parts are symmetric along it."""
    return axes * np.array([[np.sign(np.linalg.det(axes))], [1.0], [1.0]])


def _box(solid: Solid, box: Box, scene: Scene) -> list[Part]:
    lo, hi = solid.scale * box.lo, solid.scale * box.hi
    finite = np.isfinite(np.stack([lo, hi]))
    if not finite.any():
        return []
    if finite.sum() == 1:
        side, k = np.argwhere(finite)[0]
        normal = (1.0 if side else -1.0) * solid.R[:, k]
        return [_half_space(normal, solid.b + (hi if side else lo)[k] * solid.R[:, k])]
    middle = (scene.middle - solid.b) @ solid.R
    open_lo = np.where(finite[1], hi - 2 * scene.far, middle - scene.far)
    lo = np.where(finite[0], lo, open_lo)
    hi = np.where(finite[1], hi, lo + 2 * scene.far)
    return [Part(BOX, solid.b + solid.R @ ((lo + hi) / 2), _right_handed(solid.R.T), (hi - lo) / 2)]


def _half_space(normal: np.ndarray, point: np.ndarray) -> Part:
    first = np.roll(np.eye(3)[np.abs(normal).argmax()], 1)
    first = first - (first @ normal) * normal
    first /= np.linalg.norm(first)
    axes = np.stack([first, np.cross(normal, first), normal])
    return Part(HALF_SPACE, point, axes, np.zeros(3))


def _ellipsoid(A: np.ndarray, centre: np.ndarray) -> Part:
    """The image of the unit ball under A (3,3)."""
    U, size, _ = np.linalg.svd(A)
    return Part(ELLIPSOID, centre, _right_handed(U.T), size)


def _polytope(corners: np.ndarray) -> Part:
    centre = (corners.min(0) + corners.max(0)) / 2
    return Part(POLYTOPE, centre, np.eye(3), np.zeros(3), vertices=corners - centre)


def _frustums(solid: Solid, shape: Revolved, scene: Scene) -> list[Part] | None:
    """One for each slanted line of the outline, when they follow one another along the axis with nothing hollow."""
    if not shape.whole:
        return None
    far, sides = scene.far / solid.scale, []
    for piece in shape.pieces:
        if not isinstance(piece.curve, Line):
            return None
        outward = piece.outward * piece.curve.normal(0.0)[0]
        if outward < -ACROSS or outward <= ACROSS and not piece.finite():
            return None
        if outward > ACROSS:
            ends = piece.curve.at(np.clip([piece.t0, piece.t1], -far, far))
            sides.append(ends[np.argsort(ends[:, 1])])
    sides.sort(key=lambda ends: ends[0, 1])
    if not sides or any(b[0, 1] < a[1, 1] - SAME * shape.size for a, b in zip(sides[:-1], sides[1:], strict=True)):
        return None
    axes, found = _right_handed(solid.R.T), []
    for (r0, z0), (r1, z1) in sides:
        tip = SAME * shape.size  # radii of rounding size are 0
        size = solid.scale * np.array([r0 if r0 > tip else 0.0, r1 if r1 > tip else 0.0, (z1 - z0) / 2])
        found.append(Part(FRUSTUM, solid.place(np.array([0.0, 0.0, (z0 + z1) / 2])), axes, size))
    return found


def _planes(solid: Solid) -> Planes | None:
    """Planes that bound a solid, in space; None where it has other surfaces."""
    shape = solid.shape
    if isinstance(shape, Box):
        normals, heights = np.vstack([-np.eye(3), np.eye(3)]), np.r_[-shape.lo, shape.hi]
        own = normals[np.isfinite(heights)], heights[np.isfinite(heights)]
    elif isinstance(shape, HalfSpace):
        own = shape.n[None], np.array([shape.h])
    elif isinstance(shape, Common):
        every = [_planes(part) for part in shape.parts]
        if any(planes is None for planes in every):
            return None
        own = np.vstack([n for n, _ in every]), np.concatenate([h for _, h in every])
    elif isinstance(shape, Stretched):
        inner = _planes(shape.solid)
        if inner is None:
            return None
        normals = inner[0] @ shape.inverse
        length = np.linalg.norm(normals, axis=1)
        own = normals / length[:, None], inner[1] / length
    elif isinstance(shape, Revolved) and not shape.whole and shape.half_angle <= np.pi / 2:
        if any(bound.a or bound.k or bound.e for bound in shape.bounds):
            return None
        turns = np.radians(shape.angle)
        wedge = [[side * -np.sin(a), side * np.cos(a), 0.0] for a, side in zip(turns, (-1, 1), strict=True)]
        flats = [[0.0, 0.0, np.sign(bound.l)] for bound in shape.bounds]
        heights = [-bound.c / abs(bound.l) for bound in shape.bounds]
        own = np.array(wedge + flats), np.array([0.0, 0.0, *heights])
    else:
        return None
    normals = own[0] @ solid.R.T
    return normals, solid.scale * own[1] + normals @ solid.b


def _corners(planes: Planes, scene: Scene) -> np.ndarray:
    """Corners (k,3) of the polytope below all planes, cut at the far box: where three planes meet below the others."""
    walls = np.vstack([np.eye(3), -np.eye(3)])
    normals = np.vstack([planes[0], walls])
    heights = np.r_[planes[1] - planes[0] @ scene.middle, np.full(6, scene.far)]
    triples = np.array(list(combinations(range(len(normals)), 3)))
    matrix = normals[triples]
    cut = np.abs(np.linalg.det(matrix)) > SAME  # planes without a common point
    points = np.linalg.solve(matrix[cut], heights[triples[cut]][..., None])[..., 0]
    size = np.abs(points[(points @ normals.T <= heights + SAME * scene.far).all(1)]).max()
    points = points[(points @ normals.T <= heights + SAME * size).all(1)]
    _, first = np.unique(np.round(points / (SAME * size)), axis=0, return_index=True)
    kept: list[np.ndarray] = []
    for point in points[np.sort(first)]:
        if all(np.abs(point - other).max() > 4 * SAME * size for other in kept):  # 4: either side of a rounding step
            kept.append(point)
    return np.array(kept) + scene.middle


def _surface(surface: Surface, error: float) -> Part:
    return Part(MESH, np.zeros(3), np.eye(3), np.zeros(3), surface=surface, error=error)


def _mesh(component: Component, scene: Scene) -> Part:
    mesh, error = refined(component, scene.accuracy, scene.most, scene.clip)
    return _surface(surface_of(*mesh), error)
