"""Concave meshes as convex cells, and the sheets of bodies by their pieces."""

import sys
from pathlib import Path

import numpy as np
import pytest

HELPERS = str(Path(__file__).parents[2] / "helpers")
if HELPERS not in sys.path:
    sys.path.insert(0, HELPERS)

from flow_solids import exact_volume  # noqa: E402

from flowgmo.geometry import Component, Limits, Piece, Transform  # noqa: E402
from flowgmo.geometry.convex_cells import convex_cells  # noqa: E402
from flowgmo.geometry.sheets import sheets_of  # noqa: E402
from flowgmo.geometry.stl import StlMesh  # noqa: E402
from flowgmo.geometry.transform import rotation  # noqa: E402


def brick(low, high, role="solid", turn=(0, 0, 0)):
    return Piece(role=role, limits=Limits(*zip(low, high, strict=True)), transform=Transform(rotate=turn))


def prism(xy, z):
    """Vertices and outward faces of a prism over a polygon, counter-clockwise; its ends by ear clipping."""
    xy = np.asarray(xy, float)
    n, ring, ears = len(xy), list(range(len(xy))), []
    while len(ring) > 3:
        for m in range(len(ring)):
            a, b, c = ring[m - 1], ring[m], ring[(m + 1) % len(ring)]
            others = [p for p in ring if p not in (a, b, c)]
            sides = np.array(
                [[cross(xy[q] - xy[p], xy[o] - xy[p]) for p, q in ((a, b), (b, c), (c, a))] for o in others]
            )
            if cross(xy[b] - xy[a], xy[c] - xy[a]) > 0.0 and not (sides >= 0.0).all(axis=1).any():
                ears.append((a, b, c))
                ring.pop(m)
                break
    ears.append(tuple(ring))
    around = [(i, (i + 1) % n, (i + 1) % n + n) for i in range(n)] + [(i, (i + 1) % n + n, i + n) for i in range(n)]
    faces = around + [(a + n, b + n, c + n) for a, b, c in ears] + [(a, c, b) for a, b, c in ears]
    return np.vstack([np.column_stack([xy, np.full(n, h)]) for h in z]), np.array(faces)


def cross(a, b):
    return a[0] * b[1] - a[1] * b[0]


POLYGONS = {
    "L": [(0, 0), (4, 0), (4, 2), (2, 2), (2, 4), (0, 4)],
    "U": [(0, 0), (6, 0), (6, 4), (4, 4), (4, 1), (2, 1), (2, 4), (0, 4)],
    "star": [(r * np.cos(a), r * np.sin(a)) for a, r in zip(np.arange(10) * np.pi / 5, [3.0, 1.2] * 5, strict=True)],
    "arrow": [(0, 0), (3, 1.5), (0, 3), (1, 1.5)],
}


@pytest.mark.parametrize("name", POLYGONS)
def test_cells_fill_the_mesh_once(name):
    """Volumes of the cells, by the dual hull of scipy, sum to the mesh's; a point lies in one cell inside, in none
    outside."""
    rng = np.random.default_rng(1)
    vertices, faces = prism(POLYGONS[name], (-1.0, 1.0))
    vertices = vertices @ rotation((20, 30, 40)).T
    body = Component([Piece(stl=StlMesh(vertices, faces))])
    sheets = sheets_of(body)
    keep = np.unique(np.round(np.column_stack([sheets.n, sheets.h]) * 1e6), axis=0, return_index=True)[1]
    cells = convex_cells(vertices[faces], sheets.n[keep], sheets.h[keep])
    x = rng.uniform(vertices.min(axis=0) - 0.5, vertices.max(axis=0) + 0.5, (4000, 3))
    within = np.array([(x @ n.T < h).all(axis=1) for n, h, _ in cells])
    np.testing.assert_array_equal(within.sum(axis=0), body.inside(x).astype(int))
    total = sum(exact_volume(n, h, (-9.0,) * 3, (9.0,) * 3) for n, h, _ in cells)
    assert total == pytest.approx(body.mass_properties(1.0).volume, rel=1e-9)


def test_sheets_that_pieces_share_are_one():
    """Three touching boxes of a U: nine planes in place of eighteen; a hole that ends flush adds four of six; a rod
    that fills a bore has its round sheet from the other side."""
    u = [brick((-3, -1, -2), (3, 1, -1)), brick((-3, -1, -1), (-2, 1, 2)), brick((2, -1, -1), (3, 1, 2))]
    found = Component(u, Transform(rotate=(10, 20, 30))).sheets_by_piece
    assert found.exact
    assert len(found.h) == 9
    assert (np.abs(found.side).sum(axis=1) == 6).all()
    on = np.flatnonzero((found.side[0] != 0) & (found.side[1] != 0) & (found.side[0] != found.side[1]))
    assert len(on) == 1  # where they touch
    holed = Component([brick((-3, -1, -2), (3, 1, 2)), brick((-1, -1, -1), (1, 1, 1), "hole")]).sheets_by_piece
    assert len(holed.h) == 10
    assert holed.roles.tolist() == [0, 1]
    bore = [Piece(limits=Limits(radius=(1.0, 2.0), z=(-1, 1))), Piece(limits=Limits(radius=(None, 1.0), z=(-3, 0)))]
    rod = Component([*bore, brick((-9, -9, 5), (9, 9, 6))]).sheets_by_piece
    assert rod.exact
    assert len(rod.rounds) == 2
    inner = int(rod.rounds[:, 6].argmin())
    assert rod.side[0, len(rod.h) + inner] == -rod.side[1, len(rod.h) + inner] == 1


def test_what_no_sheets_bound_is_known_by_its_distance():
    """A sector of more than half a turn beside a box: it alone; a mesh of many faces: it too."""
    sector = Piece(limits=Limits(radius=(None, 1.0), z=(0, 1), angle=(0.0, 250.0)))
    found = Component([sector, brick((2, -1, -1), (3, 1, 1))]).sheets_by_piece
    assert not found.exact
    assert len(found.curved) == 1
    assert len(found.h) == 6
    ball = Component([Piece(limits=Limits(sphere=(None, 1.0)))]).triangles(16)
    assert not Component([Piece(stl=StlMesh(*ball))]).sheets_by_piece.exact


def test_all_but_a_box():
    """A tank: the space outside a box, unbounded, and a block in it."""
    tank = Component([brick((-1, -1, -1), (1, 1, 1), "complement"), brick((-0.5, -0.5, -1), (0.5, 0.5, 0))])
    found = tank.sheets_by_piece
    assert found.exact
    assert found.roles.tolist() == [2, 0]
    assert len(found.h) == 11
