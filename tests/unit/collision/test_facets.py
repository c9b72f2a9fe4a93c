"""Edges of meshes: what bends where, and which normals a triangle, or a piece of many, really has."""

import numpy as np
import pytest
from flowgmo_pieces import L_SHAPE, box, cylinder, mesh, scene_of
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from flowgmo.collision.facets import CONCAVE, CONVEX, LEVEL, allowed_normal
from flowgmo.collision.pieces import Shapes, _ordered, _triangles
from flowgmo.collision.seams import exposed
from flowgmo.collision.shapes import POLYTOPE, TRIANGLE
from flowgmo.collision.tree import build_tree
from flowgmo.geometry import Component, Limits, Piece, Transform, mesh_from
from flowgmo.geometry.convex_parts import MESH, Part
from flowgmo.geometry.surface import convex_corners, surface_of
from flowgmo.kernel import kernel


@kernel
def allowed(shapes, i, x, n):
    return allowed_normal(shapes, i, x, n)


@kernel
def is_exposed(shapes, i, x, n):
    return exposed(shapes, i, x, n)


def fine_box(cells, size=(1.0, 2.0, 3.0)):
    """Vertices and faces of a box whose sides have cells x cells squares of two triangles."""
    grid = np.linspace(0, 1, cells + 1)
    corners = []
    for k in range(3):
        for side in (0.0, 1.0):
            for i in range(cells):
                for j in range(cells):
                    quad = np.empty((4, 3))
                    quad[:, k] = side
                    quad[:, (k + 1) % 3] = grid[[i, i + 1, i + 1, i]]
                    quad[:, (k + 2) % 3] = grid[[j, j, j + 1, j + 1]]
                    quad = quad if side else quad[::-1]
                    corners += [quad[[0, 1, 2]], quad[[0, 2, 3]]]
    return np.array(corners) * size


def surface(corners):
    stl = mesh_from(corners)
    return surface_of(stl.vertices, stl.faces)


def edge_lengths(found, kind):
    """Total length of the edges with bend of a sign, each counted once."""
    corners = found.vertices[found.faces]
    length = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    return length[np.sign(found.bend) == kind].sum() / 2


def single(corners):
    """Shapes of one mesh about the origin, kept as triangles even where it is convex."""
    part = Part(MESH, np.zeros(3), np.eye(3), np.zeros(3), surface=surface(corners))
    own = _triangles(part, np.zeros(3))
    order, nodes = build_tree(own.boxes[:, 0], own.boxes[:, 1], own.pieces["reach"])
    own = _ordered(own, order)
    none = np.zeros(1)
    return Shapes(
        own.pieces, own.vertices, np.array([0, len(order)]), nodes, np.array([0, len(nodes)]), own.facets, own.spokes,
        none, none, none,
    )  # fmt: skip


def corners_of(shapes):
    return shapes.vertices.reshape(-1, 3, 3) + shapes.pieces["centre"][:, None]


def test_only_the_real_edges_of_a_box_are_convex():
    found = surface(fine_box(5))
    assert edge_lengths(found, 1) == pytest.approx(4 * (1 + 2 + 3))
    assert edge_lengths(found, -1) == 0
    assert np.allclose(found.bend[found.bend > 0], np.pi / 2) and (found.across >= 0).all()
    assert len(np.unique(found.patch)) == 6
    corners = convex_corners(found)
    assert len(corners) == 8 and ConvexHull(corners).volume == pytest.approx(6.0)


def test_the_inner_edge_of_an_l_is_concave():
    part = mesh(*L_SHAPE)
    found = surface_of(part.stl.vertices, part.stl.faces)
    assert edge_lengths(found, -1) == pytest.approx(1.0)
    assert edge_lengths(found, 1) == pytest.approx(2 * 8 + 5)
    assert convex_corners(found) is None


def test_convex_meshes_are_told_from_others():
    """Random hulls are convex, all their corners are kept; one corner pushed in, or two bodies in one file, are not."""
    rng = np.random.default_rng(0)
    for _ in range(10):
        points = rng.normal(size=(40, 3))
        hull = ConvexHull(points)
        found = surface(points[hull.simplices])
        corners = convex_corners(found)
        assert {tuple(c) for c in corners} == {tuple(points[k]) for k in hull.vertices}
        moved = points.copy()
        moved[hull.vertices[0]] *= 0.3
        dented = surface(moved[hull.simplices])
        assert convex_corners(dented) is None
    assert convex_corners(surface(np.vstack([fine_box(1), fine_box(1) + 5.0]))) is None


def test_single_precision_does_not_bend_a_plane():
    """A turned box as a binary STL holds it: coordinates rounded to 2^-24. Its sides stay planes, it stays convex, and
    the normals are those of the box to 1e-6."""
    turn = Rotation.from_euler("xyz", [10, 20, 30], degrees=True)
    corners = turn.apply(fine_box(20).reshape(-1, 3) + 3.0).reshape(-1, 3, 3)
    stl = mesh_from(corners.astype(np.float32).astype(float))
    assert scene_of(Component([Piece(stl=stl)])).pieces["kind"] == [POLYTOPE]
    found = surface_of(stl.vertices, stl.faces, 2.0**-20 * 6)
    assert edge_lengths(found, -1) == 0 and edge_lengths(found, 1) == pytest.approx(24, rel=1e-5)
    normal = turn.inv().apply(found.normal)
    assert np.abs(np.abs(normal).max(1) - 1).max() < 1e-12 and len(np.unique(found.normal, axis=0)) == 6
    assert len(convex_corners(found, 2.0**-20 * 6)) == 8


def test_thin_triangles_are_passed_over():
    """Slivers without a normal, as T-junctions leave them: the faces on both their sides become neighbours."""
    a, b, c, d, m = (np.array(p, float) for p in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (0.5, 0, 0)))
    faces = [(a, c, b), (a, m, d), (m, b, d), (a, d, c), (b, c, d), (a, b, m)]  # a, m, b on one line
    vertices = np.array([a, b, c, d, m])
    number = {tuple(p): k for k, p in enumerate(vertices)}
    found = surface_of(vertices, np.array([[number[tuple(p)] for p in f] for f in faces]))
    assert len(found.faces) == 5 and (found.across >= 0).all()
    assert edge_lengths(found, 1) == pytest.approx(3 + 3 * np.sqrt(2))


def test_a_flat_patch_has_one_normal():
    """Whatever the search says at faces, inner edges, and inner corners of a turned plane: the same normal, bit by bit.
    A different one is the bump that a sliding body would feel."""
    turn = Rotation.from_euler("xyz", [10, 20, 30], degrees=True)
    shapes = single(turn.apply(fine_box(6).reshape(-1, 3)).reshape(-1, 3, 3))
    top = turn.apply([0.0, 0.0, 1.0])
    rng, seen = np.random.default_rng(0), set()
    for i, corners in enumerate(corners_of(shapes)):
        if shapes.facets["normal"][i] @ top < 0.9:
            continue
        for weights in np.vstack([np.eye(3), (1 - np.eye(3)) / 2, rng.dirichlet(np.ones(3), 3)]):
            x = weights @ corners
            own = turn.inv().apply(x)
            if min(own[0], 1 - own[0], own[1], 2 - own[1]) < 1e-9:
                continue
            n = top + 0.5 * rng.normal(size=3)
            seen.add(allowed(shapes, i, tuple(x), tuple(n / np.linalg.norm(n))))
    assert len(seen) == 1
    assert np.abs(np.array(seen.pop()) - top).max() < 1e-12


def nearest_in_octant(n, x, size):
    """Nearest normal of a box at its surface point x: the signs of its sides at x, nothing elsewhere."""
    allowed_signs = [[s for s, at in ((-1, 0.0), (1, size[k])) if abs(x[k] - at) < 1e-9] for k in range(3)]
    best = np.array(
        [max(n[k] * s, 0) * s if (s := (signs or [0])[0]) else 0.0 for k, signs in enumerate(allowed_signs)]
    )
    if not best.any():
        k = max((k for k in range(3) if allowed_signs[k]), key=lambda k: n[k] * allowed_signs[k][0])
        best[k] = allowed_signs[k][0]
    return best / np.linalg.norm(best)


def test_normals_of_a_fine_box():
    """At every kind of point of a box of 600 triangles: face, edge, corner, and the inner ones. Against the octant."""
    size = np.array([1.0, 2.0, 3.0])
    shapes, rng = single(fine_box(10)), np.random.default_rng(1)
    assert set(shapes.facets["edge"].ravel()) == {CONVEX, LEVEL} and (shapes.pieces["kind"] == TRIANGLE).all()
    for i, corners in enumerate(corners_of(shapes)):
        for weights in np.vstack([np.eye(3), (1 - np.eye(3)) / 2, rng.dirichlet(np.ones(3), 1)]):
            x = weights @ corners
            n = rng.normal(size=3)
            n *= np.sign(n @ (x - size / 2))
            n /= np.linalg.norm(n)
            got = np.array(allowed(shapes, i, tuple(x), tuple(n)))
            wanted = nearest_in_octant(n, x, size)
            if wanted @ n > 0:  # else more than a right angle off: any normal of the feature will do
                np.testing.assert_allclose(got, wanted, atol=1e-12)
            assert np.linalg.norm(got) == pytest.approx(1, abs=1e-12)
            again = np.array(allowed(shapes, i, tuple(x), tuple(got)))
            np.testing.assert_allclose(again, got, atol=1e-12)  # what is in the cone stays


def test_a_concave_edge_is_never_touched():
    """Along the inner edge of an L the normals are those of the two walls, and a face's middle has its own."""
    part = mesh(*L_SHAPE)
    shapes = single(part.stl.vertices[part.stl.faces])
    assert (shapes.facets["edge"] == CONCAVE).sum() == 2
    rng, met = np.random.default_rng(0), 0
    for i, corners in enumerate(corners_of(shapes)):
        face = shapes.facets["normal"][i]
        for k in np.flatnonzero(shapes.facets["edge"][i] == CONCAVE):
            for t in (0.2, 0.7):
                x = (1 - t) * corners[k] + t * corners[(k + 1) % 3]
                n = np.array([1.0, 1.0, 0.0]) + 0.1 * rng.normal(size=3)
                got = allowed(shapes, i, tuple(x), tuple(n / np.linalg.norm(n)))
                assert np.array_equal(got, face) and abs(face[2]) < 1e-15
                met += 1
        middle = corners.mean(0)
        assert np.array_equal(allowed(shapes, i, tuple(middle), (0.6, 0.0, 0.8)), face)
    assert met == 4
    top = [k for k in range(len(shapes.pieces)) if shapes.facets["normal"][k][2] > 0.9]
    for i in top:  # the end of the inner edge lies in the plane of the top: no tilt
        for k in range(3):
            x = corners_of(shapes)[i, k]
            if np.abs(x - [1, 1, 1]).max() < 1e-9:
                got = allowed(shapes, i, tuple(x), (0.6, 0.0, 0.8))
                np.testing.assert_allclose(got, [0, 0, 1], atol=1e-12)


def test_all_but_a_concave_mesh():
    """The matter is outside: what was concave is convex, and triangles face the other way."""
    shapes = scene_of(Component([mesh(*L_SHAPE, role="complement")]))
    outside = scene_of(Component([mesh(*L_SHAPE)]))
    for kind, other in ((CONCAVE, CONVEX), (CONVEX, CONCAVE), (LEVEL, LEVEL)):
        assert (shapes.facets["edge"] == kind).sum() == (outside.facets["edge"] == other).sum()
    corners = corners_of(shapes)
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    assert ((area * shapes.facets["normal"]).sum(1) > 0).all()
    assert (area * corners[:, 0]).sum() / 3 == pytest.approx(-3.0)
    again = surface_of(*(lambda f: (f.vertices, f.faces))(surface(fine_box(2)).inside_out()))
    assert np.array_equal(again.bend, surface(fine_box(2)).inside_out().bend)


def test_a_point_off_the_surface_counts_for_its_edge():
    """The search gives the middle between two surfaces: beyond a convex edge it lies beside the triangle."""
    shapes = single(fine_box(1, (1.0, 1.0, 1.0)))
    n = np.array([0.6, 0.0, 0.8])
    for i in range(len(shapes.pieces)):
        if shapes.facets["normal"][i][2] > 0.9 and (corners_of(shapes)[i, :, 0] > 0.5).sum() == 2:
            got = allowed(shapes, i, tuple(np.array([1.0, 0.4, 1.0]) + 0.01 * n), tuple(n))
            np.testing.assert_allclose(got, n, atol=1e-12)


def test_any_call_gives_a_unit_normal():
    """Points on and far off the triangles, any direction, thin triangles too: never NaN, always a unit vector."""
    rng = np.random.default_rng(5)
    part = mesh(cylinder(1.0, 0.0, 0.01), cylinder(0.5, -1.0, 1.0, "hole"), resolution=80)
    shapes = single(part.stl.vertices[part.stl.faces])
    corners = corners_of(shapes)
    for i in rng.integers(len(corners), size=5000):
        x = rng.dirichlet(np.full(3, 0.3)) @ corners[i] + rng.choice([0.0, 1e-9, 1e-3, 1.0]) * rng.normal(size=3)
        n = rng.normal(size=3)
        got = np.array(allowed(shapes, i, tuple(x), tuple(n / np.linalg.norm(n))))
        assert np.linalg.norm(got) == pytest.approx(1.0, abs=1e-12)


def test_scaled_by_powers_of_two_the_same_normals():
    rng = np.random.default_rng(0)
    one, two = single(fine_box(3)), single(8 * fine_box(3))
    for i, corners in enumerate(corners_of(one)):
        for x in (corners[0], corners[:2].mean(0), corners.mean(0)):
            n = tuple(rng.normal(size=3))
            assert allowed(one, i, tuple(x), n) == allowed(two, i, tuple(8 * x), n)


def floor_of_boxes():
    """A flush floor of two boxes with a wall on its left: pieces in the order found."""
    floor = [box((0, -1, -1), (1, 1, 0)), box((1, -1, -1), (2, 1, 0)), box((-1, -1, -1), (0, 1, 2))]
    shapes = scene_of(Component(floor))
    place = {tuple(np.round(p["centre"], 3)): k for k, p in enumerate(shapes.pieces)}
    return shapes, place[0.5, 0, -0.5], place[1.5, 0, -0.5], place[-0.5, 0, 0.5]


@pytest.mark.parametrize(
    "piece, x, n, real",
    [
        ("right", (1.0, 0.3, 0.0), (-1.0, 0.0, 0.0), False),  # upper edge of the hidden side
        ("right", (1.0, 0.3, 0.0), (-0.6, 0.0, 0.8), False),
        ("right", (1.0, 0.3, 0.0), (-3e-5, 0.0, 1.0), False),
        ("right", (1.0, 0.3, -0.4), (-1.0, 0.0, 0.0), False),
        ("right", (1.0, 0.3, 0.0), (0.0, 0.0, 1.0), True),  # the floor itself, at the seam
        ("left", (1.0, 0.3, 0.0), (0.0, 0.0, 1.0), True),
        ("right", (1.0, 1.0, 0.0), (0.0, 0.0, 1.0), True),  # the seam's end
        ("right", (1.0, 1.0, 0.0), (0.0, 0.6, 0.8), True),  # outer edges run on
        ("right", (1.0, 1.0, 0.0), (-0.6, 0.0, 0.8), False),
        ("right", (2.0, 0.3, 0.0), (0.6, 0.0, 0.8), True),
        ("wall", (0.0, 0.3, 0.0), (1.0, 0.0, 0.0), True),  # the wall right above the floor
        ("wall", (0.0, 0.3, -0.2), (1.0, 0.0, 0.0), False),
        ("left", (0.0, 0.3, 0.0), (0.0, 0.0, 1.0), True),  # the floor right before the wall
        ("left", (0.0, 0.3, 0.0), (-0.6, 0.0, 0.8), False),
    ],
)
def test_seams_of_flush_boxes(piece, x, n, real):
    shapes, left, right, wall = floor_of_boxes()
    i = {"left": left, "right": right, "wall": wall}[piece]
    n = np.array(n) / np.linalg.norm(n)
    assert is_exposed(shapes, i, x, tuple(n)) == real


def test_seams_of_round_pieces():
    """A shaft with a step: the shoulder is real, the hidden cap of the thin end is not. Overlapping balls likewise."""
    shaft = scene_of(Component([cylinder(1.0, -1.0, 0.0), cylinder(0.5, 0.0, 1.0)]))
    thin = int(np.argmin(shaft.pieces["size"][:, 0]))
    assert is_exposed(shaft, 1 - thin, (0.8, 0.0, 0.0), (0.0, 0.0, 1.0))
    assert not is_exposed(shaft, 1 - thin, (0.3, 0.0, 0.0), (0.0, 0.0, 1.0))
    assert not is_exposed(shaft, thin, (0.3, 0.0, 0.0), (0.0, 0.0, -1.0))
    assert is_exposed(shaft, thin, (0.5, 0.0, 0.0), (1.0, 0.0, 0.0))  # the thin side right above the shoulder
    balls = [Piece(limits=Limits(sphere=(None, 1.0)), transform=Transform(translate=(x, 0, 0))) for x in (0.0, 1.0)]
    pair = scene_of(Component(balls))
    i = int(np.argmin(pair.pieces["centre"][:, 0]))
    assert not is_exposed(pair, i, (1.0, 0.0, 0.0), (1.0, 0.0, 0.0))
    assert is_exposed(pair, i, (-1.0, 0.0, 0.0), (-1.0, 0.0, 0.0))
    crease = (0.5, np.sqrt(0.75), 0.0)
    assert is_exposed(pair, i, crease, crease) and is_exposed(pair, 1 - i, crease, (-0.5, np.sqrt(0.75), 0.0))
