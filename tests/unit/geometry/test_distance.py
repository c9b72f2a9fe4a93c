"""Identities of the signed distance, for every kind of shape: |grad d| = 1, n = grad d, sign = membership, and the
distance to a fine triangulation of the same surface."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from flowgmo.geometry import Component, Limits, Piece, Quadric, Torus, Transform, mesh_from
from flowgmo.geometry.mesh_solid import nearest_on_triangle

TURNED = Transform(rotate=(30, 40, 50), translate=(0.3, -0.2, 0.1), centre=(0.1, 0.2, 0.3))


def one(**parts):
    return Component([Piece(**{"transform": TURNED, **parts})])


def box(lo, hi, role="solid"):
    return Piece(role, Limits(*zip(lo, hi, strict=True)))


EXACT = {
    "box": one(limits=Limits(x=(-1, 1), y=(-0.5, 2), z=(0, 1))),
    "slab": one(limits=Limits(z=(0, 1))),
    "sphere": one(limits=Limits(sphere=(None, 1.2))),
    "sphere quadric": one(quadric=Quadric(c=-1, cx2=2, cy2=2, cz2=2, cx=0.5)),
    "shell": one(limits=Limits(sphere=(0.5, 1.2))),
    "cylinder": one(limits=Limits(radius=(None, 1), z=(-1, 1))),
    "endless cylinder": one(limits=Limits(radius=(None, 1))),
    "x cylinder quadric": one(quadric=Quadric(c=-1, cy2=1, cz2=1, cy=0.5), limits=Limits(x=(-1, 2))),
    "tube": one(limits=Limits(radius=(0.5, 1), z=(-1, 1))),
    "cone": one(limits=Limits(cone=(None, 30), z=(None, 2))),
    "frustum": one(limits=Limits(cone=(None, 30), z=(1, 2))),
    "cone with root": one(quadric=Quadric(c=-1, crxy=1, cz=0.5), limits=Limits(z=(0, None))),
    "double cone": one(quadric=Quadric(cx2=1, cy2=1, cz2=-0.3), limits=Limits(z=(-2, 1))),
    "sector": one(limits=Limits(cone=(30, 100), sphere=(1, 2))),
    "cap": one(limits=Limits(sphere=(None, 1), z=(0.3, None))),
    "torus": one(torus=Torus(0.5, 2.0)),
    "wedge over half": one(limits=Limits(radius=(0.5, 1.5), z=(-1, 1), angle=(20, 250))),
    "wedge under half": one(limits=Limits(radius=(None, 1.5), z=(-1, 1), angle=(-20, 50))),
    "ellipsoid": one(limits=Limits(sphere=(None, 2)), transform=Transform((1, 0.5, 0.7), rotate=(10, 20, 30))),
    "ellipsoid with equal axes": one(quadric=Quadric(c=-1, cx2=1, cy2=1, cz2=4)),
    "paraboloid": one(quadric=Quadric(c=-1, cx2=1, cy2=2, cz=1)),
    "hyperboloid": one(quadric=Quadric(c=-1, cx2=1, cy2=1.5, cz2=-1)),
    "saddle": one(quadric=Quadric(c=0.1, cx2=1, cy2=-2, cxz=1)),
    "half-space": one(quadric=Quadric(c=-1, cx=1, cz=0.5)),
    "lattice": Component(
        [box((-1,) * 3, (1,) * 3), box((0,) * 3, (2,) * 3), box((-0.5, -0.5, -2), (0.5, 0.5, 2), "hole")]
    ),
    "coaxial": Component(
        [
            Piece(limits=Limits(radius=(None, 1), z=(-1, 1))),
            Piece(limits=Limits(radius=(None, 0.5), z=(0, 2))),
            Piece("hole", Limits(sphere=(None, 0.7))),
        ]
    ),
    "outside of a sphere": one(role="complement", limits=Limits(sphere=(None, 1))),
    "ball in box": Component([box((-1,) * 3, (1,) * 3), Piece("hole", Limits(sphere=(None, 0.7)))]),
}
BOUND = {
    "cylinder in box": one(limits=Limits(x=(-1, 1), y=(-1, 1), radius=(None, 1.2), z=(-1, 1))),
    "cut hyperboloid": one(quadric=Quadric(c=-1, cx2=1, cy2=2, cz2=-1), limits=Limits(z=(-1, 1))),
    "stretched torus": one(torus=Torus(0.5, 2.0), transform=Transform((1, 2, 1))),
    "sheared box": Component([Piece(limits=Limits((-1, 1), (-1, 1), (-1, 1)), transform=TURNED)], Transform((1, 2, 1))),
    "box and ball": Component([box((-1,) * 3, (1,) * 3), Piece(limits=Limits(sphere=(None, 1.2)))]),
    "general root": one(quadric=Quadric(c=-1, crxy=1, cz=0.5, cx2=0.3), limits=Limits(z=(0, 1))),
}
EVERY = EXACT | BOUND
POINTS = np.random.default_rng(1).uniform(-3, 3, (400, 3))


def gradient(body, x, h=1e-6):
    return np.stack([(body.distance(x + h * e) - body.distance(x - h * e)) / (2 * h) for e in np.eye(3)], 1)


@pytest.mark.parametrize("name", EXACT)
def test_gradient_is_the_unit_normal(name):
    body = EXACT[name]
    normal, slope = body.normal(POINTS), gradient(body, POINTS)
    np.testing.assert_allclose(np.linalg.norm(normal, axis=1), 1, atol=1e-12)
    kinks = np.abs(slope - normal).max(1) > 1e-5  # within h = 1e-6 of a medial surface: rare
    assert kinks.sum() <= 1


@pytest.mark.parametrize("name", EVERY)
def test_sign_is_membership(name):
    body = EVERY[name]
    assert np.array_equal(body.distance(POINTS) <= 0, body.inside(POINTS))


@pytest.mark.parametrize("name", [name for name in EVERY if name != "general root"])
def test_step_by_the_distance_never_crosses(name):
    """|d| is at most the true distance: d changes by no more than the way between two points.

    Not so for a general root surface, whose distance may be too large, as its docstring says.
    """
    body = EVERY[name]
    d, way = body.distance(POINTS), np.random.default_rng(2).normal(size=POINTS.shape)
    way *= (np.random.default_rng(3).uniform(0, 0.999, len(d)) * np.abs(d) / np.linalg.norm(way, axis=1))[:, None]
    assert np.array_equal(body.inside(POINTS + way), body.inside(POINTS))


@pytest.mark.parametrize("name", EXACT)
def test_projection_lands_on_the_surface(name):
    """x - d n lies on the surface, and is the nearest: nothing of the surface is within the ball of radius |d|."""
    body = EXACT[name]
    d = body.distance(POINTS)
    foot = POINTS - d[:, None] * body.normal(POINTS)
    np.testing.assert_allclose(body.distance(foot), 0, atol=1e-9)


def bounded(name):
    return np.isfinite(EXACT[name].bounds()).all() and name != "ball in box"


@pytest.mark.parametrize("name", [name for name in EXACT if bounded(name)])
def test_distance_to_triangulation(name):
    """Against brute force over the triangles; they lie within 0.02 of the surface (measured 0.012 for the wedges)."""
    body = EXACT[name]
    vertices, faces = body.triangles(60)
    corners, points = vertices[faces], POINTS[:25]
    for x, d in zip(points, body.distance(points), strict=True):
        nearest, _ = nearest_on_triangle(np.broadcast_to(x, (len(corners), 3)), corners)
        assert abs(np.linalg.norm(nearest - x, axis=1).min() - abs(d)) < 0.02


@pytest.mark.parametrize("name", [name for name in EXACT if bounded(name)])
def test_bounds_are_tight(name):
    """The triangulation reaches them: within 0.05 (the chord of 48 steps), and not beyond."""
    body = EXACT[name]
    vertices, _ = body.triangles(48)
    low, high = body.bounds()
    assert (vertices >= low - 0.03).all() and (vertices <= high + 0.03).all()
    np.testing.assert_allclose(vertices.min(0), low, atol=0.05)
    np.testing.assert_allclose(vertices.max(0), high, atol=0.05)


@pytest.mark.parametrize("scale", [2.0**-20, 2.0**20])
@pytest.mark.parametrize("name", ["box", "tube", "torus", "ellipsoid"])
def test_scaling_by_powers_of_two(name, scale):
    """Lengths times 2^k give the same distances times 2^k, to rounding of the transform."""
    piece = EXACT[name].pieces[0]
    whole = Component([piece], Transform(magnify=scale))
    np.testing.assert_allclose(whole.distance(POINTS * scale), EXACT[name].distance(POINTS) * scale, rtol=1e-9)


def test_points_on_symmetry_planes_of_an_ellipsoid():
    """Where several surface points are nearest the iteration meets its pole: distance to the end of the short axis."""
    body = one(quadric=Quadric(c=-1, cx2=1 / 9, cy2=1 / 4, cz2=1), transform=Transform())
    np.testing.assert_allclose(body.distance(np.zeros((1, 3))), [-1], rtol=1e-12)
    x = np.array([[0.5, 0, 0], [0, 0.3, 0], [1e-9, 0, 0], [2.9, 0, 0], [5, 0, 0]])
    t = np.linspace(-np.pi, np.pi, 2001)
    u, v = np.meshgrid(t, t / 2)
    surface = np.stack([3 * np.cos(v) * np.cos(u), 2 * np.cos(v) * np.sin(u), np.sin(v)], -1).reshape(-1, 3)
    for point, d in zip(x, np.abs(body.distance(x)), strict=True):
        assert abs(np.linalg.norm(surface - point, axis=1).min() - d) < 1e-5


@settings(max_examples=40, deadline=None)
@given(
    st.lists(st.floats(-2, 2, allow_subnormal=False), min_size=6, max_size=6),
    st.floats(-2, 2, allow_subnormal=False),
    st.lists(st.floats(-3, 3), min_size=3, max_size=3),
)
@example([0.15625, 0.0, 0.0, 0.0, 1.192092896e-07, 0.0], 0.0, [0.0, 0.0, 1.0])  # nearly two planes, a point on one
def test_any_quadric_gives_surface_points(squares, c, point):
    """Whatever the coefficients, the foot lies on the surface and the normal there is unit."""
    xx, yy, zz, xy, xz, yz = squares
    try:
        body = one(quadric=Quadric(c=c, cx=0.3, cy2=yy, cx2=xx, cz2=zz, cxy=xy, cxz=xz, cyz=yz), transform=Transform())
    except ValueError:
        return  # nothing inside
    x = np.array([point])
    d = body.distance(x)
    if not np.isfinite(d).all() or abs(d[0]) > 1e3:
        return  # no surface, or none nearby
    np.testing.assert_allclose(body.distance(x - d * body.normal(x)), 0, atol=1e-6)


def test_mesh_agrees_with_its_shape():
    """A box as triangles has the distance, normal, and membership of the box, to rounding."""
    body = EXACT["box"]
    vertices, faces = body.triangles()
    mesh = Component([Piece(stl=mesh_from(vertices[faces]))])
    np.testing.assert_allclose(mesh.distance(POINTS), body.distance(POINTS), atol=1e-12)
    outside = ~body.inside(POINTS)
    np.testing.assert_allclose(mesh.normal(POINTS)[outside], body.normal(POINTS)[outside], atol=1e-9)
    assert np.array_equal(mesh.inside(POINTS), body.inside(POINTS))
