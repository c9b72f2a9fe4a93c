"""Which contact normals a triangle of a surface really has: no bumps at the inner edges of a mesh.

A triangle taken alone may be touched at its edges and corners under any normal that leaves it. As part of a surface it
has fewer: those of the feature's normal cone, that is the directions under which the feature is the farthest point of
the surface around it.

    inside of the face, flat edge, concave edge    the face's normal
    convex edge                                    the arc between the normals of its two faces
    corner                                         {n : n · e <= 0 for every edge e that leaves it}

For a corner with flat edges only, that is the face's normal; on a straight edge the arc of the edge; at a box's corner
the octant. A normal from the search that lies outside is moved to the nearest one inside. At a corner the boundary of
the cone is made of arcs of convex edges, so the nearest is one of their points or a face's normal; where a concave
corner has none, the triangle's own normal is taken.
Source  notes on "active edges" and Voronoi regions of surfaces: Ericson 2005, 5.1.5; van den Bergen 2003, 3.
"""

from __future__ import annotations

import numpy as np

from flowgmo.kernel import inner
from flowgmo.vectors import add, cross, dot, norm, scale, sub, triple, without

CONVEX, LEVEL, CONCAVE, OPEN = 0, 1, 2, 3  # edges: bent outward, flat, bent inward, with nothing beyond
#: One triangle of a surface, body axes. Of the edge from corner k to k + 1: edge, its kind, across, the normal beyond
#: it; of the corner k: plain, 1 where all its edges are flat, first .. last - 1 its spokes.
FACET = np.dtype(
    [
        ("normal", "f8", 3),
        ("edge", "i8", 3),
        ("across", "f8", (3, 3)),
        ("plain", "i8", 3),
        ("first", "i8", 3),
        ("last", "i8", 3),
    ],
    align=True,
)
#: One edge as seen from a corner: unit direction away from it, kind, normals of the face that has the edge in this
#: direction and of the other one.
SPOKE = np.dtype([("along", "f8", 3), ("edge", "i8"), ("normal", "f8", 3), ("across", "f8", 3)], align=True)
NEAR = 1e-6  # of the triangle's reach: a contact this near to an edge is on it
LEAVE = 1e-12  # cosine: a normal so little outside its cone is inside, rounding
FITS = 1e-6  # cosine: a face's normal belongs to a corner's cone, its edges being flat to 1e-6 rad (surface.FLAT)


def build_facets(surface) -> tuple[np.ndarray, np.ndarray]:
    """FACET (f,) and SPOKE (3 f,) of a geometry.surface.Surface."""
    count = len(surface.faces)
    facets, spokes = np.zeros(count, FACET), np.zeros(3 * count, SPOKE)
    facets["normal"] = surface.normal
    facets["across"] = np.where((surface.across >= 0)[..., None], surface.normal[surface.across], 0.0)
    bend = surface.bend
    kind = np.where(bend > 0, CONVEX, np.where(bend < 0, CONCAVE, LEVEL))
    facets["edge"] = kind = np.where(surface.across < 0, OPEN, kind)
    corners = surface.vertices[surface.faces]
    along = np.roll(corners, -1, axis=1) - corners
    along /= np.linalg.norm(along, axis=2, keepdims=True)
    start = surface.faces.ravel()
    order = np.argsort(start, kind="stable")
    spokes["along"] = along.reshape(-1, 3)[order]
    spokes["edge"] = kind.ravel()[order]
    spokes["normal"] = np.repeat(surface.normal, 3, axis=0)[order]
    spokes["across"] = facets["across"].reshape(-1, 3)[order]
    known = len(surface.vertices)
    bounds = np.searchsorted(start[order], np.arange(known + 1))
    bent = np.bincount(start, kind.ravel() != LEVEL, minlength=known)
    facets["first"], facets["last"] = bounds[surface.faces], bounds[surface.faces + 1]
    facets["plain"] = bent[surface.faces] == 0
    return facets, spokes


@inner
def allowed_normal(shapes, i, x, n):
    """The contact normal n (unit, out of the surface) at the point x of triangle piece i, moved into its cone.

    x from B and n in the axes of the triangle's body; x may lie off the surface along n. Returns a unit triple.
    """
    piece = shapes.pieces[i]
    facet = shapes.facets[i]
    face = triple(facet.normal)
    r = sub(x, triple(piece.centre))
    slack = NEAR * piece.reach
    nearest = np.inf
    side = -1
    corner = -1
    for k in range(3):
        a = triple(shapes.vertices[piece.first + k])
        e = sub(triple(shapes.vertices[piece.first + (k + 1) % 3]), a)
        length = norm(e)
        e = scale(1.0 / length, e)
        g = without(sub(r, a), face)
        if dot(g, cross(face, e)) < slack:
            t = dot(g, e)
            s = min(max(t, 0.0), length)
            d = norm(sub(g, scale(s, e)))
            if d < nearest:
                nearest = d
                side = k
                corner = k if s <= slack else ((k + 1) % 3 if s >= length - slack else -1)
    if side < 0:
        return face
    if corner < 0:
        a = triple(shapes.vertices[piece.first + side])
        e = sub(triple(shapes.vertices[piece.first + (side + 1) % 3]), a)
        return _on_edge(facet.edge[side], scale(1.0 / norm(e), e), face, triple(facet.across[side]), n)
    if facet.plain[corner] == 1:
        return face
    return _at_corner(shapes.spokes, facet.first[corner], facet.last[corner], face, n)


@inner
def _on_edge(kind, e, face, across, n):
    """Nearest normal of an edge: e its unit direction, the face on its left."""
    m = without(n, e)
    size = norm(m)
    if size == 0.0 or kind in (LEVEL, CONCAVE):
        return face
    m = scale(1.0 / size, m)
    if kind == OPEN:
        return m
    if dot(cross(face, m), e) >= 0.0 and dot(cross(m, across), e) >= 0.0 and dot(m, add(face, across)) > 0.0:
        return m
    return face if dot(m, face) >= dot(m, across) else across


@inner
def _outside(spokes, first, last, n):
    """Largest n · e over the edges that leave a corner: 0 or less within its cone."""
    worst = -1.0
    for k in range(first, last):
        worst = max(worst, dot(n, triple(spokes[k].along)))
    return worst


@inner
def _at_corner(spokes, first, last, face, n):
    """Nearest normal of a corner, `face` where it has none."""
    if _outside(spokes, first, last, n) <= LEAVE:
        return n
    best = face
    nearest = -2.0
    for k in range(first, last):
        spoke = spokes[k]
        for choice in range(2):
            m = triple(spoke.normal)
            if choice == 1:
                m = _on_edge(spoke.edge, triple(spoke.along), m, triple(spoke.across), n)
            d = dot(m, n)
            if d > nearest and _outside(spokes, first, last, m) <= FITS:
                nearest = d
                best = m
    return best
