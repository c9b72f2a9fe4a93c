"""What a component is: transforms, recognition, names, surfaces, overlap, refusals."""

import numpy as np
import pytest

from flowgmo.geometry import (
    Component,
    GeometryError,
    Limits,
    Piece,
    Quadric,
    Torus,
    Transform,
    mesh_from,
    overlap_depth,
)
from flowgmo.geometry.transform import rotation


def box(lo, hi, role="solid", **parts):
    return Piece(role, Limits(*zip(lo, hi, strict=True)), **parts)


def ball(radius, at=(0, 0, 0)):
    return Component([Piece(limits=Limits(sphere=(None, radius)), transform=Transform(translate=at))])


CUBE = Component([box((-1,) * 3, (1,) * 3)])


def test_transform_order():
    """Magnify, rotate x then y then z, translate, about the centre."""
    t = Transform(magnify=2.0, magnify_axes=(1, 3, 1), rotate=(90, 0, 90), translate=(1, 0, 0), centre=(1, 1, 1))
    np.testing.assert_allclose(t.apply(np.array([[1.0, 2.0, 1.0]])), [[2, 1, 7]])  # y: 1 -> 6, Rx to z, Rz keeps z
    x = np.random.default_rng(0).normal(size=(5, 3))
    np.testing.assert_allclose(t.inverse(t.apply(x)), x)
    quarter = rotation((0, 0, 90))
    assert np.array_equal(quarter @ [1, 0, 0], [0, 1, 0])


def test_component_transform_follows_the_pieces():
    inner, outer = Transform(rotate=(10, 20, 30), translate=(1, 2, 3)), Transform(magnify=2, rotate=(5, 0, 50))
    body = Component([box((0,) * 3, (1, 2, 3), transform=inner)], outer)
    x = np.random.default_rng(0).uniform(0, 1, (20, 3)) * [1, 2, 3]
    assert body.inside(outer.apply(inner.apply(x))).all()
    assert not body.inside(outer.apply(inner.apply(x + [0, 0, 3.001]))).any()


@pytest.mark.parametrize("transform", [{"magnify": 0}, {"rotate": (float("nan"), 0, 0)}])
def test_impossible_transforms(transform):
    with pytest.raises(GeometryError):
        Transform(**transform)


def test_sphere_is_recognised():
    body = Component(
        [Piece(quadric=Quadric(-3, cx2=3, cy2=3, cz2=3), transform=Transform(translate=(1, 0, 0)))],
        Transform(magnify=2),
    )
    centre, radius = body.as_sphere()
    np.testing.assert_allclose((*centre, radius), (2, 0, 0, 2))
    assert body.describe() == "sphere, radius 2"
    assert CUBE.as_sphere() is None and ball(1).as_boxes() is None


def test_boxes_are_recognised():
    body = Component([box((0,) * 3, (1, 2, 3), transform=Transform(rotate=(0, 0, 90))), box((0,) * 3, (1, 1, None))])
    first, second = body.as_boxes()
    np.testing.assert_allclose(first.axes @ first.axes.T, np.eye(3))
    corner = first.origin + first.hi @ first.axes
    np.testing.assert_allclose(corner, [-2, 1, 3])
    assert second.hi[2] == np.inf
    assert body.describe() == "union of 2 boxes"


def test_pool_is_a_union_of_boxes():
    """A box with a box-shaped hole splits into disjoint boxes of the same volume."""
    pool = Component([box((0,) * 3, (4, 4, 2)), box((1, 1, 1), (3, 3, 2), "hole")])
    boxes = pool.as_boxes()
    np.testing.assert_allclose(sum((b.hi - b.lo).prod() for b in boxes), 28)
    np.testing.assert_allclose(pool.distance(np.array([[2.0, 2, 1.5], [2, 2, 0.5], [0.5, 2, 1.7]])), [0.5, -0.5, -0.3])


def test_default_quadric_with_box_limits_is_a_box():
    """FLOW-3D's CC = -0.1 holds everywhere, so limiters alone make the solid."""
    body = Component([Piece(limits=Limits((0, 1), (0, 1), (0, 1)), quadric=Quadric(c=-0.1))])
    assert body.describe() == "box, 1 x 1 x 1"


NAMES = {
    "cylinder, radius 1, height 2": dict(limits=Limits(radius=(None, 1), z=(0, 2))),
    "cylinder, radius 2, height 3": dict(quadric=Quadric(-4, cy2=1, cz2=1), limits=Limits(x=(0, 3))),
    "tube, radii 0.5 and 1, height 2": dict(limits=Limits(radius=(0.5, 1), z=(0, 2))),
    "cone or frustum, height 1": dict(limits=Limits(cone=(None, 20), z=(1, 2))),
    "torus, radii 1.5 and 0.5": dict(torus=Torus(1, 2)),
    "spherical shell, radii 1 and 2": dict(limits=Limits(sphere=(1, 2))),
    "ellipsoid, half axes 3, 2, 1": dict(quadric=Quadric(-1, cx2=1, cy2=1 / 4, cz2=1 / 9)),
    "half-space": dict(quadric=Quadric(-1, cx=1, cy=1)),
    "whole space": {},
}


@pytest.mark.parametrize("name", NAMES)
def test_names(name):
    assert Component([Piece(**NAMES[name])]).describe() == name


REFUSED = {
    "lower must be below": dict(limits=Limits(x=(1, 1))),
    "upper limit -1 of the radius": dict(limits=Limits(radius=(None, -1))),
    "inner radius < outer radius": dict(torus=Torus(2, 1)),
    "0 to 180 degrees": dict(limits=Limits(cone=(None, 200))),
    "constant 0.1 > 0": dict(quadric=Quadric(c=0.1)),
    "nowhere negative": dict(quadric=Quadric(c=1, cx2=1, cy2=1, cz2=1)),
    "nothing in common": dict(limits=Limits(radius=(2, None), sphere=(None, 1))),
    "not a finite number": dict(quadric=Quadric(c=float("nan"), cx=1)),
    "one of solid, hole": dict(role="gas"),
    "no solid subcomponent": dict(role="hole"),
}


@pytest.mark.parametrize("reason", REFUSED)
def test_empty_or_impossible_pieces_are_refused(reason):
    with pytest.raises(GeometryError, match=reason):
        Component([Piece(**REFUSED[reason])])


def test_holes_that_leave_nothing_are_refused():
    with pytest.raises(GeometryError, match="nothing is left"):
        Component([box((0,) * 3, (1,) * 3), box((-1,) * 3, (2,) * 3, "hole")])


SURFACES = {
    "box": CUBE,
    "boxes": Component([box((-1,) * 3, (1,) * 3), box((0,) * 3, (2,) * 3)]),
    "tube": Component([Piece(limits=Limits(radius=(0.5, 1), z=(0, 2)), transform=Transform(magnify=(-1, 1, 1)))]),
    "wedge": Component([Piece(limits=Limits(radius=(0.5, 1), z=(0, 1), angle=(0, 100)))]),
    "box and ball": Component([box((-1,) * 3, (1,) * 3), Piece(limits=Limits(sphere=(None, 1.2)))]),
}


@pytest.mark.parametrize("name", SURFACES)
def test_surface_is_closed_and_outward(name):
    """Every edge is run through as often one way as the other; the enclosed volume is the body's, within 2 %."""
    body = SURFACES[name]
    vertices, faces = body.triangles(40)
    directed = np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    there, back = (np.unique(e, axis=0, return_counts=True) for e in (directed, directed[:, ::-1]))
    assert np.array_equal(there[0], back[0]) and np.array_equal(there[1], back[1])
    a, b, c = vertices[faces].transpose(1, 0, 2)
    np.testing.assert_allclose((a * np.cross(b, c)).sum() / 6, body.mass_properties(1).volume, rtol=0.02)


def test_infinite_shapes_are_clipped():
    clip = np.array([[-2.0, -2, -2], [2, 2, 2]])
    for piece, volume in (
        (box((None, None, None), (None, None, 0)), 32),
        (Piece(limits=Limits(radius=(None, 1))), 4 * np.pi),
        (Piece("complement", Limits(sphere=(None, 1))), 64 - 4 / 3 * np.pi),
    ):
        body = Component([piece])
        with pytest.raises(GeometryError, match="unbounded"):
            body.triangles()
        vertices, faces = body.triangles(40, clip)
        a, b, c = vertices[faces].transpose(1, 0, 2)
        np.testing.assert_allclose((a * np.cross(b, c)).sum() / 6, volume, rtol=0.01)


def test_overlap_of_spheres_and_boxes_is_exact():
    assert overlap_depth(ball(1), ball(2, (2.75, 0, 0)), 1.0) == 0.25
    assert overlap_depth(ball(1), ball(2, (3.25, 0, 0)), 1.0) == 0
    assert overlap_depth(ball(1, (1.5, 0, 0)), CUBE, 1.0) == overlap_depth(CUBE, ball(1, (1.5, 0, 0)), 1.0) == 0.5


def test_overlap_of_others_is_sampled():
    rod = Component([Piece(limits=Limits(radius=(None, 1), z=(-1, 1)))])
    shifted = Component([Piece(limits=Limits(radius=(None, 1), z=(-1, 1)), transform=Transform(translate=(1.9, 0, 0)))])
    assert abs(overlap_depth(rod, shifted, 2.0) - 0.1) < 1e-9
    assert overlap_depth(CUBE, Component([box((1, -1, -1), (2, 1, 1))]), 1.0) == 0
    assert overlap_depth(CUBE, CUBE, 1.0) > 0.9  # the same place: as deep as its middle
    floor = Component([box((None,) * 3, (None, None, -0.9))])
    np.testing.assert_allclose(overlap_depth(rod, floor, 2.0), 0.1)
    assert overlap_depth(rod, Component([box((None,) * 3, (None, None, -1))]), 2.0) == 0


def test_limiters_cut_a_mesh():
    vertices, faces = CUBE.triangles()
    body = Component([Piece(stl=mesh_from(vertices[faces]), limits=Limits(z=(0, None)))])
    assert np.array_equal(body.inside(np.array([[0, 0, 0.5], [0, 0, -0.5]])), [True, False])
    found = body.mass_properties(1.0)
    assert abs(found.volume - 4) < 4 * found.error


def test_copies_and_pickles():
    """A body with a closure inside is stored as its pieces."""
    import copy
    import pickle

    rods = [Piece(limits=Limits(radius=(None, 1), z=(0, 1))), Piece(limits=Limits(radius=(None, 2), z=(1, 2)))]
    body, x = Component(rods, Transform(rotate=(10, 0, 0))), np.random.default_rng(0).normal(size=(9, 3))
    for other in (copy.deepcopy(body), pickle.loads(pickle.dumps(body))):
        assert np.array_equal(other.distance(x), body.distance(x))
