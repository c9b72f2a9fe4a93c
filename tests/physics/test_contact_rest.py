"""Bodies of any shape that hold, slide, tip, roll, land and stand: the contact engine against closed forms.

Slope θ, block (VALIDATION A): holds iff μ >= tan θ, else s = g (sin θ - μ cos θ) t²/2; tips first iff base/height < μ.
Sphere: rolls iff μ >= (2/7) tan θ. Gravity is turned, the slope is the floor of the domain.
"""

import numpy as np
import pytest
from flowgmo_scenes import WALLS, Scene, at, ball, deck, matrix, number, solid, start

G, R = 9.81, 0.1
FLOOR = (3, 3, 3, 3, 2, 3)
ENGINE = "multiple='sequential'"  # takes balls, too, out of their closed forms


def box(half=(0.05, 0.05, 0.05), x=(0, 0, 0), v=(0, 0, 0), w=(0, 0, 0), more=""):
    """A coupled box; half (3,) edges, x (3,) its middle."""
    limits = " ".join(f"{a}l(#)={number(-h)}, {a}h(#)={number(h)}," for a, h in zip("xyz", half, strict=True))
    return f"imo(#)=4, rhomvb(#)=700.0, iob(#)=#, {limits} {at(x)} {start(v, w)} {more}"


def on_slope(degrees, *bodies, mu=0.5, e=0.0, knobs="", **more):
    t = np.radians(degrees)
    g = (G * np.sin(t), 0, -G * np.cos(t))
    return Scene(deck(*bodies, lo=(-9, -9, 0), hi=(9, 9, 9), sides=FLOOR, g=g, e=e, mu=mu, knobs=knobs, **more))


@pytest.mark.parametrize("dt", [0.2, 0.01])
@pytest.mark.parametrize("side", [1.001, 0.999, 0.5, 0.0])
def test_a_block_holds_iff_friction_reaches_the_slope(side, dt):
    """θ = 20°, 0.1 % above and below the limit. Measured: way 2e-11 m, books 2e-11 (bound of VALIDATION 1e-3).
    Fails if sticking is a slow slide, or friction pulls towards a threshold velocity."""
    t = np.radians(20)
    mu = side * np.tan(t)
    s = on_slope(20, box(x=(0, 0, 0.05)), mu=mu).to(1.0, dt)
    way = 0.0 if side >= 1 else G * (np.sin(t) - mu * np.cos(t)) / 2
    np.testing.assert_allclose(s.p[0], [way, 0, 0.05], atol=1e-9)
    np.testing.assert_allclose(s.v[0], [2 * way, 0, 0], atol=1e-9)
    np.testing.assert_allclose(s.w[0], 0.0, atol=1e-8)
    assert abs(s.remainder()) < 1e-9 * s.masses[0] * G


@pytest.mark.parametrize("base, tips", [(1.01, False), (0.99, True)])
def test_a_rough_block_tips_iff_its_base_is_narrow(base, tips):
    """θ = 20°, μ = .8: it turns over iff base/height < tan θ, 1 % above and below. Fails if corners share the load
    so that none can lift. Measured: the wider one stays to 3e-13 m."""
    half = (0.1 * base * np.tan(np.radians(20)), 0.1, 0.1)
    s = on_slope(20, box(half, (0, 0, 0.1)), mu=0.8).to(0.5, 0.01)
    assert (s.w[0, 1] > 0.01) == tips
    if not tips:
        np.testing.assert_allclose(s.p[0], [0, 0, 0.1], atol=1e-9)


@pytest.mark.parametrize("side", [1.01, 0.99, 0.3])
def test_a_sphere_rolls_iff_friction_suffices(side):
    """θ = 20°: a = (5/7) g sin θ, else g (sin θ - μ cos θ), with turning 5/2 μ g cos θ / R. Measured: 1e-13 m.
    Fails if the force is taken where the contact was before the leg."""
    t = np.radians(20)
    mu = side * 2 / 7 * np.tan(t)
    s = on_slope(20, ball((0, 0, R), R), mu=mu, knobs=ENGINE).to(0.5, 0.01)
    a = 5 / 7 * G * np.sin(t) if side >= 1 else G * (np.sin(t) - mu * np.cos(t))
    turn = a / R if side >= 1 else 2.5 * mu * G * np.cos(t) / R
    np.testing.assert_allclose(s.p[0], [a / 8, 0, R], atol=1e-9)
    np.testing.assert_allclose(s.v[0], [a / 2, 0, 0], atol=1e-9)
    np.testing.assert_allclose(s.w[0], [0, turn / 2, 0], atol=1e-8)


def test_sliding_ends_in_rolling_and_that_goes_on():
    """v = 2, μ = .3: slip is over at 2 v/(7 μ g) with 5/7 v, then nothing is lost. Measured: velocities 6e-14, way
    2e-6 of itself: slip ends at the end of a leg of 4.5 ms, not within. Fails if it does not end, or does twice."""
    s = on_slope(0, ball((0, 0, R), R, v=(2.0, 0, 0)), mu=0.3, knobs=ENGINE).to(1.0, 0.01)
    ends = 2 * 2.0 / (7 * 0.3 * G)
    place = 2.0 * ends - 0.3 * G * ends**2 / 2 + 5 / 7 * 2.0 * (1.0 - ends)
    np.testing.assert_allclose(s.v[0], [10 / 7, 0, 0], atol=1e-10)
    np.testing.assert_allclose(s.w[0], [0, 10 / 7 / R, 0], atol=1e-9)
    np.testing.assert_allclose(s.p[0], [place, 0, R], atol=1e-5 * place)


@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
def test_a_box_dropped_flat_rebounds_with_e_and_does_not_turn(e):
    """Four corners at once, half a metre above: v = e √(2 g h). Measured: time 4e-11, place 7e-11,
    turning 3e-8 (the cluster's residual). Fails if corners are hit in turn."""
    s = Scene(deck(box(x=(0, 0, 0.55)), lo=(-1, -1, 0), hi=(1, 1, 2), sides=FLOOR, g=(0, 0, -G), e=e, mu=0.3))
    falls, v = np.sqrt(1 / G), np.sqrt(G)
    after = 0.05
    s.to(falls + after, 0.02)
    np.testing.assert_allclose(s.impacts["time"], falls, rtol=1e-9)
    up = e * v * after - G * after**2 / 2 if e > 0 else 0.0
    np.testing.assert_allclose(s.p[0], [0, 0, 0.05 + up], atol=1e-8)
    np.testing.assert_allclose(s.v[0], [0, 0, e * v - G * after if e > 0 else 0.0], atol=1e-7)
    np.testing.assert_allclose(s.w[0], 0.0, atol=1e-7)


def test_a_tower_of_ten_stands_and_gains_no_energy():
    """Measured: 7e-12 m in a second, energy only falls (bound of VALIDATION 1e-4 of a box). Fails if
    contact forces are not found, or corrections feed energy."""
    tower = [box(x=(0, 0, 0.05 + 0.1 * k)) for k in range(10)]
    s = on_slope(0, *tower, e=0.2)
    places, weight = s.p.copy(), s.masses.sum() * G
    for _ in range(10):
        s.to(s.state.t + 0.1, 0.01)
        height = s.masses @ (s.p - places)[:, 2] / s.masses.sum()
        assert s.kinetic() + weight * height < 1e-9 * weight * 0.1
    np.testing.assert_allclose(s.p, places, atol=1e-9)


def test_a_block_on_a_driven_plate_is_carried_or_slides():
    """A plate starts at 1 m/s under two blocks: each gains μ g until it moves along. Measured: velocities 1e-12, ways
    1e-12 m, that of the rough one 9e-6: it stops sliding at the end of a leg. Fails if friction acts on velocities in
    space, or the plate is stopped."""
    plate = "imo(#)=3, iob(#)=#, xl(#)=-1.0, xh(#)=1.0, yl(#)=-1.0, yh(#)=1.0, zl(#)=-0.1, zh(#)=0.0, utobs(1,#)=1.0,"
    rough, smooth = (box(x=(0, y, 0.05), more=f" cfrc(#)={mu},") for y, mu in ((-0.5, 0.5), (0.5, 0.1)))
    s = Scene(deck(plate, rough, smooth, lo=(-9,) * 3, hi=(9,) * 3, g=(0, 0, -G), e=0.0, mu=1.0)).to(0.5, 0.01)
    np.testing.assert_allclose(s.v[1], [1, 0, 0], atol=1e-7)
    np.testing.assert_allclose(s.v[2], [0.1 * G * 0.5, 0, 0], atol=1e-9)
    np.testing.assert_allclose(s.p[2], [0.1 * G / 8, 0.5, 0.05], atol=1e-9)
    np.testing.assert_allclose(s.p[1, 0], 0.5 - 1 / (2 * 0.5 * G), rtol=1e-4)


@pytest.mark.parametrize("dt", [1e-2, 1e-3])
def test_a_ball_runs_off_an_edge_and_flies(dt):
    """Smooth table, v² > g R: a parabola from the edge. A leg's contact force is constant, so that the ball may leave
    up to one leg late, √(2e-3 R/g) or dt. Measured: 3.3 ms, 1.0 ms. Fails if it sticks to the edge or turns on it."""
    v, leg = 1.5, min(dt, np.sqrt(2e-3 * R / G))
    table = solid((-2, -1, -1), (0, 1, 0))
    s = Scene(deck(ball((-0.75, 0, R), R, v=(v, 0, 0)), table, g=(0, 0, -G), e=0.5, knobs=ENGINE)).to(0.8, dt)
    np.testing.assert_allclose(s.p[0, :2], [v * 0.3, 0], atol=1e-5)
    late = 0.3 - np.sqrt(2 * (R - s.p[0, 2]) / G)
    assert -1e-9 < late < leg * (1 + 1e-6)


def test_a_box_thrown_into_a_room_comes_to_rest_inside():
    """All sides are walls: nothing leaves, no energy appears. Measured: depth 2e-11 m, speed 1e-11 at the end."""
    s = Scene(deck(box((0.1, 0.07, 0.05), v=(3, 2, 1), w=(5, 9, 2)), lo=(-0.5,) * 3, hi=(0.5,) * 3, sides=WALLS,
                   g=(0, 0, -G), e=0.4, mu=0.3))  # fmt: skip
    energy = s.kinetic()
    s.to(1.5, 0.01)
    corners = np.abs(matrix(s.q[0])) @ (0.1, 0.07, 0.05)
    assert (np.abs(s.p[0]) + corners < 0.5 + 1e-9).all()
    assert s.kinetic() + s.masses[0] * G * s.p[0, 2] < energy * (1 + 1e-9)
    np.testing.assert_allclose(s.v[0], 0.0, atol=1e-9)
