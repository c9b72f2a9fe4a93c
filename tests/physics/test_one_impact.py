"""One impact (VALIDATION B): Table 1 of the report, rough planes and spheres, reflections, mirrors. Bound 1e-10."""

import numpy as np
import pytest
from flowgmo_scenes import MIRRORS, WALLS, Scene, ball, deck, driven, solid
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from flowgmo.records import SLIP, STICK

R = 0.1


@pytest.mark.parametrize("e, after", [(1.0, (0, 1)), (0.0, (0.5, 0.5)), (0.5, (0.25, 0.75))])
def test_table_1_central_impact_of_equal_spheres(e, after):
    """Report Table 1. Measured: exact."""
    s = Scene(deck(ball((0, 0, 0), v=(1, 0, 0)), ball((0.5, 0, 0)), e=e)).to(1.0)
    np.testing.assert_allclose(s.v[:, 0], after, atol=1e-12)
    hit = s.impacts[0]
    mass = s.masses[0]
    assert (hit["a"], hit["b"], hit["e"], hit["mu"], hit["regime"]) == (1, 2, e, 0.0, SLIP)
    assert hit["time"] == pytest.approx(0.3, rel=1e-12)
    np.testing.assert_allclose(hit["point"], [0.4, 0, 0], atol=1e-12)
    np.testing.assert_allclose(hit["normal"], [-1, 0, 0], atol=1e-12)
    np.testing.assert_allclose(hit["impulse"], [-mass * (1 + e) / 2, 0, 0], rtol=1e-12)
    assert hit["energy_loss"] == pytest.approx(mass * (1 - e**2) / 4, abs=1e-12 * mass)
    assert abs(s.remainder()) < 1e-12 * mass


PLANE = [(0.5, 0.1, 1.0, 0.475), (0.8, 0.2, 2.0, 0.74), (0.8, 0.2, 1.0, 0.0)]
TURNS = {"level": (0, 0, 0), "steep": (70, 0, 0), "any": (25, 35, -110)}


@pytest.mark.parametrize("turn", TURNS.values(), ids=TURNS)
@pytest.mark.parametrize("e, mu, slide, left", PLANE)
def test_sphere_on_a_rough_plane(e, mu, slide, left, turn):
    """K = diag(7/2, 7/2, 1)/m: |vt| of the contact falls by (7/2) μ (1 + e)|vn|, or to 0. Measured: 2e-15, any plane.

    The spin about the normal and the direction of slip stay.
    """
    to_space = Rotation.from_euler("xyz", turn, degrees=True)
    n, along, across = to_space.apply([[0, 0, 1], [0.6, 0.8, 0], [-0.8, 0.6, 0]])
    spin = to_space.apply([0.7, -0.3, 1.9])
    lowest = np.cross(spin, -R * n)
    v = slide * along - n - (lowest - (lowest @ n) * n)
    plane = solid((-9, -9, None), (9, 9, 0), more=" " + "".join(
        f" rot{a}(#)={x}.0," for a, x in zip("xyz", turn, strict=True)))  # fmt: skip
    s = Scene(deck(ball(0.3 * n, v=v, w=spin), plane, e=e, mu=mu)).to(0.25)
    contact = s.v[0] + np.cross(s.w[0], -R * n)
    np.testing.assert_allclose(contact, left * along + e * n, atol=1e-10)
    assert s.w[0] @ n == pytest.approx(spin @ n, abs=1e-12)
    hit = s.impacts[0]
    assert hit["regime"] == (STICK if left == 0.0 else SLIP)
    tangential = hit["impulse"] - (hit["impulse"] @ n) * n
    assert np.linalg.norm(tangential) <= mu * hit["impulse"] @ n * (1 + 1e-12)
    assert abs(tangential @ across) < 1e-10 * s.masses[0]
    assert abs(s.remainder()) < 1e-10 * s.masses[0]


@pytest.mark.parametrize("e, mu, slide, left", PLANE)
def test_two_rough_spheres(e, mu, slide, left):
    """K = diag(7, 7, 2)/m: half the impulse changes both. Angular momentum about any point stays. Measured: 3e-15."""
    n = np.array([1.0, 0, 0])
    spin = np.array([0.3, slide / (2 * R), -0.2])  # both turn alike: the contact slides by 2 R ω along z
    one = ball((0, 0, 0), r=R, v=(1.0, 0, 0.0), w=spin * [1, 1, 0])
    two = ball((0.5, 0, 0), r=R, w=spin * [1, 1, 0])
    s = Scene(deck(one, two, e=e, mu=mu)).to(0.4)
    slip = s.v[0] + np.cross(s.w[0], R * n) - s.v[1] - np.cross(s.w[1], -R * n)
    np.testing.assert_allclose(slip, [-e, 0, -left], atol=1e-10)
    mass = s.masses[0]
    momentum = mass * s.v.sum(axis=0)
    turning = (np.cross(s.p, mass * s.v) + 0.4 * mass * R**2 * s.w).sum(axis=0)
    np.testing.assert_allclose(momentum, [mass, 0, 0], atol=1e-12 * mass)
    np.testing.assert_allclose(turning, 0.8 * mass * R**2 * spin * [1, 1, 0], atol=1e-12 * mass)
    assert abs(s.remainder()) < 1e-12 * mass


def reflect(v, n, e=1.0):
    return v - (1 + e) * (v @ n) * n


def aimed_at(place, n, v, flight=0.4):
    """Start of a ball that touches `place` with normal n (unit, towards the ball) after the flight."""
    return place + R * n - flight * v


CONTACTS = {
    "face": ((0.2, 0.1, 0.0), (0, 0, 1)),
    "edge": ((1.0, 0.3, 0.0), (0.6, 0, 0.8)),
    "corner": ((1.0, 1.0, 0.0), (2 / 7, 3 / 7, 6 / 7)),
    "near a face at an edge": ((1.0, 0.3, 0.0), (1e-4, 0, np.sqrt(1 - 1e-8))),
}


@pytest.mark.parametrize("e", [1.0, 0.6])
@pytest.mark.parametrize("place, n", CONTACTS.values(), ids=CONTACTS)
def test_ball_against_face_edge_and_corner_of_a_box(place, n, e):
    """v' = v - (1 + e)(v·n) n, n from the nearest point of the box. Measured: 4e-15 (near a face: 2e-11)."""
    place, n = np.array(place), np.array(n, dtype=float)
    v = np.array([0.3, -0.2, -1.0]) - 0.5 * n
    s = Scene(deck(ball(aimed_at(place, n, v), v=v), solid((-1, -1, -1), (1, 1, 0)), e=e)).to(1.0)
    assert s.impacts["time"] == pytest.approx([0.4], abs=1e-10)
    np.testing.assert_allclose(s.v[0], reflect(v, n, e), atol=1e-9)
    np.testing.assert_allclose(s.impacts[0]["point"], place, atol=1e-10)


def test_a_ball_under_gravity_meets_an_edge():
    """The parabola's own time: thrown so that it arrives at t = .4 with v = (.5, 0, -1.2). Measured: 2e-14."""
    g = np.array([0, 0, -9.81])
    place, n, late = np.array([1.0, 0.3, 0.0]), np.array([0.6, 0, 0.8]), np.array([-0.5, 0, -1.2])
    first = late - 0.4 * g
    x = place + R * n - 0.4 * first - 0.08 * g
    s = Scene(deck(ball(x, v=first), solid((-1, -1, -1), (1, 1, 0)), g=g)).to(0.45)
    assert s.impacts["time"] == pytest.approx([0.4], abs=1e-12)
    np.testing.assert_allclose(s.v[0], reflect(late, n) + 0.05 * g, atol=1e-10)


@pytest.mark.parametrize("offset", [0.0, 1e-3, -0.2])
def test_a_corner_of_three_walls_sends_a_ball_back(offset):
    """Smooth elastic walls: v' = -v whatever the order of the hits. Measured: exact."""
    v = np.array([-1.0, -2.0, -3.0])
    x = -0.5 * v + R + np.array([0, offset, 2 * offset])
    s = Scene(deck(ball(x, v=v), lo=(0, 0, 0), hi=(9, 9, 9), sides=WALLS)).to(1.0)
    np.testing.assert_allclose(s.v[0], -v, atol=1e-13)
    assert len(s.impacts) == 3
    assert sorted(s.impacts["b"]) == [-5, -3, -1]


def test_a_mirror_is_elastic_and_frictionless_whatever_the_deck_says():
    """IBCT 1 beside e = .3, μ = .9."""
    v, w = (1.0, -2.0, 0.5), (3.0, 4.0, 5.0)
    s = Scene(deck(ball((0, 0, 0), v=v, w=w), lo=(-1, -1, -1), hi=(1, 1, 1), sides=MIRRORS, e=0.3, mu=0.9)).to(0.9)
    np.testing.assert_allclose(s.v[0], [1.0, 2.0, 0.5], atol=1e-15)
    np.testing.assert_array_equal(s.w[0], w)
    assert s.impacts[0]["e"] == 1.0 and s.impacts[0]["mu"] == 0.0


def test_a_pair_takes_the_smaller_restitution_and_friction():
    one, two = ball((0, 0, 0), v=(1, 0, 0), e=0.9, mu=0.1), ball((0.5, 0.05, 0), e=0.4, mu=0.6)
    hit = Scene(deck(one, two)).to(1.0).impacts[0]
    assert (hit["e"], hit["mu"]) == (0.4, 0.1)


@pytest.mark.parametrize("dt", [0.01, 1.0])
def test_a_driven_ball_hits_a_free_one(dt):
    """The driven one does not change: the free one leaves with (1 + e) V. Its work is in the books. Measured: exact."""
    s = Scene(deck(driven((0, 0, 0), v=(2.0, 0, 0)), ball((0.5, 0, 0)), e=0.7)).to(1.0, dt, asked=[0.5])
    np.testing.assert_allclose(s.v[:, 0], [2.0, 3.4], atol=1e-12)
    np.testing.assert_allclose(s.p[0], [2.0, 0, 0], atol=1e-12)
    assert s.impacts["time"] == pytest.approx([0.15], rel=1e-11)
    assert s.state.books[2] == pytest.approx(s.masses[1] * 3.4 * 2.0, rel=1e-12)
    assert abs(s.remainder()) < 1e-10 * s.kinetic()
    assert abs(s.energy("remainder")[0]) < 1e-10 * s.kinetic()


def test_a_driven_ball_on_a_sinusoid_meets_a_flying_one():
    """Contact where A (1 - cos ωt)/ω + 2 R = gap - u t, by bisection. Measured: exact."""
    body = driven((0, 0, 0), more="iupre(#)=1, uamp(#)=2.5, ufre(#)=0.8,")
    s = Scene(deck(body, ball((1.0, 0, 0), v=(-0.3, 0, 0)), e=1.0)).to(1.0)
    rate = 1.6 * np.pi
    when = brentq(lambda t: 2.5 / rate * (1 - np.cos(rate * t)) - (0.8 - 0.3 * t), 0.0, 0.6, xtol=1e-15)
    assert s.impacts["time"][0] == pytest.approx(when, abs=1e-12)
    assert s.v[1, 0] == pytest.approx(2 * 2.5 * np.sin(rate * when) + 0.3, abs=1e-10)
