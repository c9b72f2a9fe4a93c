"""The pieces of all parties of a scene, with a tree over each party's, ready for the contact search.

Bodies are turned into convex parts by geometry/convex_parts.py (what is exact and what is not: the table there), parts
into rows of PIECE:

    ball          POINT with radius         polytope      POLYTOPE, corners in `vertices`
    box           BOX                       half-space    HALF_SPACE
    frustum       FRUSTUM                   mesh          one TRIANGLE each, with its row of FACET
    ellipsoid     ELLIPSOID                 hole in one   kind + CAVITY; the hole of a ball: ELLIPSOID + CAVITY

Exact: all but the triangles of curved surfaces (`error`). What is infinite with more than one face is cut FAR domain
sizes away, which moves its faces by rounding of that length, 1e-13 of the domain. A mesh that is infinite (a plate
with a round hole) is cut half a domain size outside the domain.

A body of several pieces is their union. Where they overlap or meet flush (boxes that fill a body with holes, steps of a
shaft), some of their faces and edges lie inside the body, and the search may find a contact there: seams.exposed tells.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flowgmo.collision.facets import FACET, SPOKE, build_facets
from flowgmo.collision.shapes import BOX, CAVITY, ELLIPSOID, FRUSTUM, HALF_SPACE, PIECE, POINT, POLYTOPE, TRIANGLE
from flowgmo.collision.tree import NODE, build_tree
from flowgmo.geometry.convex_parts import Part, Scene, convex_parts
from flowgmo.model import Model

FAR = 256.0  # domain sizes: no scene reaches so far; a power of two keeps scaled scenes the same bits
KINDS = {
    "ball": POINT,
    "box": BOX,
    "frustum": FRUSTUM,
    "ellipsoid": ELLIPSOID,
    "polytope": POLYTOPE,
    "half-space": HALF_SPACE,
}


class Shapes(NamedTuple):
    """What all parties are made of. Party b owns pieces first_piece[b] .. first_piece[b + 1] - 1, nodes likewise.

    pieces (p,) of PIECE, by party; vertices (k,3) of polytopes and triangles, from the piece's centre, its axes;
    nodes (m,) of tree.NODE, the root first; facets (p,) and spokes of facets.py, (0,) in a scene without triangles;
    reach (parties,): radius [length] of a ball about B that holds a party, inf for half-spaces and cavities, 0 for
    none; error (parties,): distance [length] of triangles from the surface they stand for; size (parties,): largest
    finite extent [length], 0 where there is none.
    """

    pieces: np.ndarray
    vertices: np.ndarray
    first_piece: np.ndarray
    nodes: np.ndarray
    first_node: np.ndarray
    facets: np.ndarray
    spokes: np.ndarray
    reach: np.ndarray
    error: np.ndarray
    size: np.ndarray


class _Rows(NamedTuple):
    """Pieces of one party or part, their vertices, facets, spokes, and boxes (m,2,3)."""

    pieces: np.ndarray
    vertices: np.ndarray
    facets: np.ndarray
    spokes: np.ndarray
    boxes: np.ndarray


NOTHING = _Rows(np.zeros(0, PIECE), np.zeros((0, 3)), np.zeros(0, FACET), np.zeros(0, SPOKE), np.zeros((0, 2, 3)))


def build_pieces(model: Model, allowed: np.ndarray | None = None) -> Shapes:
    """Pieces of every party that can collide, or of those in allowed (n+6, n+6); the others have none."""
    n, allowed = len(model.bodies), model.contacts.allowed if allowed is None else allowed
    scene, rows, trees = _scene(model), [], []
    error, size = np.zeros(n + 6), np.zeros(n + 6)
    for party in range(n + 6):
        own = NOTHING
        if allowed[party].any():
            if party < n:
                body = model.bodies[party]
                parts = convex_parts(body.shape, scene)
                own = _joined([_rows(part, body.origin) for part in parts])
                extent = np.ptp(body.shape.bounds(), axis=0)
                size[party] = extent[np.isfinite(extent)].max(initial=0.0)
                error[party] = max((part.error for part in parts), default=0.0)
            else:
                own = _rows(_side(model.mesh.bounds, party - n), np.zeros(3))
        own.pieces["body"] = party
        nodes = np.zeros(0, NODE)
        if len(own.pieces):
            order, nodes = build_tree(own.boxes[:, 0], own.boxes[:, 1], own.pieces["reach"])
            own = _ordered(own, order)
        rows.append(own)
        trees.append(nodes)
    reach = np.array([_reach_about_origin(own) for own in rows])
    return _assembled(rows, trees, reach, error, size)


def _scene(model: Model) -> Scene:
    """Where infinite parts are cut: by the domain and all finite bodies."""
    bounds = model.mesh.bounds
    middle = (bounds[0] + bounds[1]) / 2
    corners = np.vstack([bounds, *(body.shape.bounds() for body in model.bodies)]) - middle
    largest = float(np.abs(corners[np.isfinite(corners)]).max())
    grown = np.ptp(bounds, axis=0).max() / 2
    return Scene(middle, FAR * largest, np.array([bounds[0] - grown, bounds[1] + grown]))


def _side(bounds: np.ndarray, number: int) -> Part:
    """A side of the domain: the matter lies outside, beyond a plane."""
    k, upper = divmod(number, 2)
    outward = np.zeros(3)
    outward[k] = -1.0 if upper else 1.0
    axes = np.array([np.roll(outward, 1), np.zeros(3), outward])
    axes[1] = np.cross(axes[2], axes[0])
    point = np.zeros(3)
    point[k] = bounds[upper, k]
    return Part("half-space", point, axes, np.zeros(3))


def _rows(part: Part, origin: np.ndarray) -> _Rows:
    """Rows of a part; `origin`: B in space."""
    if part.kind == "mesh":
        return _triangles(part, origin)
    piece = np.zeros(1, PIECE)
    row = piece[0]
    row["kind"], row["centre"], row["axes"], row["size"] = KINDS[part.kind], part.centre - origin, part.axes, part.size
    vertices = np.zeros((0, 3)) if part.vertices is None else part.vertices
    row["last"] = len(vertices)
    if part.kind == "ball":
        row["radius"], row["size"] = (0.0, np.full(3, part.size[0])) if part.hole else (part.size[0], np.zeros(3))
        row["kind"] = ELLIPSOID if part.hole else POINT
    half = _half_box(part)
    r0, r1, h = part.size
    row["reach"] = {
        "ball": r0,
        "box": np.linalg.norm(part.size),
        "frustum": np.hypot(max(r0, r1), h),
        "ellipsoid": part.size.max(),
        "polytope": np.linalg.norm(vertices, axis=1).max(initial=0.0),
        "half-space": np.inf,
    }[part.kind]
    if part.hole:
        row["kind"] += CAVITY
        half = np.full(3, np.inf)
    box = np.array([row["centre"] - half, row["centre"] + half])
    return NOTHING._replace(pieces=piece, vertices=vertices, boxes=box[None])


def _half_box(part: Part) -> np.ndarray:
    """Half edges (3,) of the box around a part's centre."""
    size = part.size
    if part.kind == "ball":
        return np.full(3, size[0])
    if part.kind == "box":
        return np.abs(part.axes).T @ size
    if part.kind == "frustum":
        across = np.sqrt(np.maximum(1.0 - part.axes[2] ** 2, 0.0))
        return np.abs(part.axes[2]) * size[2] + across * max(size[0], size[1])
    if part.kind == "ellipsoid":
        return np.linalg.norm(part.axes * size[:, None], axis=0)
    return np.abs(part.vertices).max(0) if part.kind == "polytope" else np.full(3, np.inf)


def _triangles(part: Part, origin: np.ndarray) -> _Rows:
    """One piece for each face of a surface."""
    corners = part.surface.vertices[part.surface.faces] - origin
    boxes = np.stack([corners.min(1), corners.max(1)], 1)
    centre = (boxes[:, 0] + boxes[:, 1]) / 2
    vertices = corners - centre[:, None]
    pieces = np.zeros(len(corners), PIECE)
    pieces["kind"], pieces["centre"], pieces["axes"] = TRIANGLE, centre, np.eye(3)
    pieces["first"] = 3 * np.arange(len(corners))
    pieces["last"] = pieces["first"] + 3
    pieces["reach"] = np.linalg.norm(vertices, axis=2).max(1)
    return _Rows(pieces, vertices.reshape(-1, 3), *build_facets(part.surface), boxes)


def _joined(rows: list[_Rows]) -> _Rows:
    """All rows one after another. Facets: one for every piece as soon as there is one, empty for other kinds."""
    if not rows:
        return NOTHING
    triangles = any(len(own.facets) for own in rows)
    known = spokes = 0
    shifted = []
    for own in rows:
        facets = own.facets.copy() if len(own.facets) or not triangles else np.zeros(len(own.pieces), FACET)
        pieces = own.pieces.copy()
        for name in ("first", "last"):
            pieces[name] += known
            facets[name] += spokes
        known, spokes = known + len(own.vertices), spokes + len(own.spokes)
        shifted.append(own._replace(pieces=pieces, facets=facets))
    return _Rows(*(np.concatenate(column) for column in zip(*shifted, strict=True)))


def _ordered(own: _Rows, order: np.ndarray) -> _Rows:
    """Rows in another order, vertices too: what is near in the tree is near in memory."""
    pieces = own.pieces[order]
    count = pieces["last"] - pieces["first"]
    last = np.cumsum(count)
    vertices = own.vertices[np.repeat(pieces["first"] - (last - count), count) + np.arange(count.sum())]
    pieces["first"], pieces["last"] = last - count, last
    facets = own.facets[order] if len(own.facets) else own.facets
    return own._replace(pieces=pieces, vertices=vertices, facets=facets, boxes=own.boxes[order])


def _assembled(
    rows: list[_Rows], trees: list[np.ndarray], reach: np.ndarray, error: np.ndarray, size: np.ndarray
) -> Shapes:
    """All parties in one table, their trees' links counted from its start."""
    first_piece = np.r_[0, np.cumsum([len(own.pieces) for own in rows])]
    first_node = np.r_[0, np.cumsum([len(nodes) for nodes in trees])]
    for nodes, piece, node in zip(trees, first_piece, first_node, strict=False):
        nodes["piece"][nodes["piece"] >= 0] += piece
        nodes["right"][nodes["right"] >= 0] += node
        nodes["after"] += node
    whole = _joined(rows)
    nodes = np.concatenate(trees)
    return Shapes(
        whole.pieces, whole.vertices, first_piece, nodes, first_node, whole.facets, whole.spokes, reach, error, size
    )


def _reach_about_origin(own: _Rows) -> float:
    """Radius of a ball about B that holds all pieces: by vertices where there are some, else by balls and boxes."""
    farthest = 0.0
    for piece, box in zip(own.pieces[own.pieces["kind"] != TRIANGLE], own.boxes, strict=False):
        if not np.isfinite(box).all():
            return np.inf
        ball = float(np.linalg.norm(piece["centre"]) + piece["reach"])
        farthest = max(farthest, min(ball, float(np.linalg.norm(np.abs(box).max(0)))))
    three = own.pieces[own.pieces["kind"] == TRIANGLE]
    corners = own.vertices[(three["first"][:, None] + np.arange(3)).ravel()] + np.repeat(three["centre"], 3, axis=0)
    return max(farthest, float(np.linalg.norm(corners, axis=1).max(initial=0.0)))


def describe(shapes: Shapes, party: int) -> str:
    """The pieces of a party in words: "1 box", "2 cylinders", "1284 triangles, 3e-4 of its size off"."""
    own = shapes.pieces[shapes.first_piece[party] : shapes.first_piece[party + 1]]
    names = [_name(piece) for piece in own[own["kind"] != TRIANGLE]] + ["triangle"] * int(
        (own["kind"] == TRIANGLE).sum()
    )
    texts = []
    for name in dict.fromkeys(names):
        count = names.count(name)
        plural = name if count == 1 else name + ("es" if name.endswith("x") else "s")
        texts.append(f"{count} {plural}")
    text = ", ".join(texts) or "nothing"
    if shapes.error[party] > 0 and shapes.size[party] > 0:
        text += f", {shapes.error[party] / shapes.size[party]:.1g} of its size off"
    return text


def _name(piece: np.void) -> str:
    kind, (r0, r1, _) = int(piece["kind"]) % CAVITY, piece["size"]
    name = {
        POINT: "ball",
        BOX: "box",
        FRUSTUM: "cylinder" if r0 == r1 else "truncated cone" if min(r0, r1) > 0 else "cone",
        ELLIPSOID: "ellipsoid",
        POLYTOPE: "polytope",
        HALF_SPACE: "half-space",
    }[kind]
    return f"hollow {name}" if piece["kind"] >= CAVITY else name
