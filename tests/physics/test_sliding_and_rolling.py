"""A sphere that slides and rolls (VALIDATION A; Goldsmith, Impact, §1): slip v ends after 2 v/(7 μ g) at 5/7 v; on a
slope it rolls iff μ >= (2/7) tan θ with a = (5/7) g sin θ, else it slides with a = g (sin θ - μ cos θ)."""

import numpy as np
import pytest
from flowgmo_scenes import OPEN, Scene, ball, deck, solid
from scipy.integrate import solve_ivp

G, R = 9.81, 0.1
FLOOR = (3, 3, 3, 3, 2, 3)


def on_floor(v, w=(0, 0, 0), mu=0.3, x=(0, 0, R)):
    return Scene(deck(ball(x, v=v, w=w), lo=(-90, -90, 0), hi=(90, 90, 3), sides=FLOOR, g=(0, 0, -G), e=0.5, mu=mu))


def on_slope(degrees, mu, v=(0, 0, 0), w=(0, 0, 0)):
    """A ball on a slope that falls towards +x; returns the scene and the slope's directions down, across, normal."""
    tilt = np.radians(degrees)
    down, n = np.array([np.cos(tilt), 0, -np.sin(tilt)]), np.array([np.sin(tilt), 0, np.cos(tilt)])
    floor = solid((-90, -90, -1), (90, 90, 0), more=f" roty(#)={float(degrees)!r},")
    frame = np.array([down, [0, 1, 0], n])
    text = deck(
        ball(R * n, v=np.dot(v, frame), w=np.dot(w, frame)), floor, lo=(-90, -90, -90), hi=(90, 90, 90), sides=OPEN,
        g=(0, 0, -G), mu=mu, e=0.5,
    )  # fmt: skip
    return Scene(text), frame


@pytest.mark.parametrize("dt", [0.01, 2.0])
def test_slip_ends_and_rolling_goes_on(dt):
    """μ = .3, v = 2: slip ends at 2 v/(7 μ g). Positions and loss in closed form. Measured: 8e-15."""
    v, mu = 2.0, 0.3
    ends = 2 * v / (7 * mu * G)
    s = on_floor((v, 0, 0), mu=mu).to(2.0, dt, asked=[0.9 * ends, ends, 1.5])
    places = [v * t - mu * G * t**2 / 2 for t in (0.9 * ends, ends)]
    places.append(places[1] + 5 / 7 * v * (1.5 - ends))
    np.testing.assert_allclose(s.row("p_WB")[:, 0, 0], places, atol=1e-10)
    speeds = [v - mu * G * 0.9 * ends, 5 / 7 * v, 5 / 7 * v]
    np.testing.assert_allclose(s.row("v_WB")[:, 0, 0], speeds, atol=1e-10)
    np.testing.assert_allclose(s.w[0], [0, 5 / 7 * v / R, 0], atol=1e-10)
    assert s.state.books[1] == pytest.approx(s.masses[0] * v**2 / 7, rel=1e-10)
    assert abs(s.remainder()) < 1e-10 * s.masses[0]
    np.testing.assert_allclose(s.row("contact_force")[::2, 0, 0], [-mu * s.masses[0] * G, 0], atol=1e-9)


def test_a_spinning_ball_starts_to_roll():
    """Topspin ω R = 7 drives it: v = 2/7 of that at the end."""
    s = on_floor((0, 0, 0), w=(0, 70.0, 0)).to(3.0)
    np.testing.assert_allclose(s.v[0], [2.0, 0, 0], atol=1e-10)


def test_backspin_brings_it_back():
    """v = 1, ω R = -5: it ends at (5 v + 2 ω R)/7 < 0. Slip and velocity are opposite on the way."""
    s = on_floor((1.0, 0, 0), w=(0, -50.0, 0)).to(5.0)
    np.testing.assert_allclose(s.v[0, 0], (5.0 - 10.0) / 7, atol=1e-10)


def test_english_bends_a_path_into_a_parabola():
    """Slip across the motion: constant force, so a parabola until it rolls (Coriolis 1835). Measured: 2e-16."""
    s = on_floor((2.0, 0, 0), w=(30.0, 0, 8.0), mu=0.2)
    slip = np.array([2.0, 0, 0]) - np.cross([30.0, 0, 8.0], [0, 0, R])
    slip[2] = 0
    ends = 2 * np.linalg.norm(slip) / (7 * 0.2 * G)
    s.to(ends)
    a = -0.2 * G * slip / np.linalg.norm(slip)
    np.testing.assert_allclose(s.p[0], [2 * ends, 0, R] + a * ends**2 / 2, atol=1e-10)
    np.testing.assert_allclose(s.w[0, 2], 8.0, atol=1e-12)


@pytest.mark.parametrize("dt", [0.02, 1.0])
@pytest.mark.parametrize("degrees, mu", [(20, 0.11), (20, 0.5), (60, 0.6), (20, 0.09), (60, 0.3)])
def test_from_rest_on_a_slope(degrees, mu, dt):
    """Rolls or slides by the threshold (2/7) tan θ. Measured: 8e-15 (bound of VALIDATION 1e-3)."""
    tilt = np.radians(degrees)
    s, frame = on_slope(degrees, mu)
    s.to(1.0, dt)
    rolls = mu >= 2 / 7 * np.tan(tilt)
    a = 5 / 7 * G * np.sin(tilt) if rolls else G * (np.sin(tilt) - mu * np.cos(tilt))
    np.testing.assert_allclose(frame @ s.p[0], [a / 2, 0, R], atol=1e-10)
    slip = frame @ (s.v[0] + np.cross(s.w[0], -R * frame[2]))
    np.testing.assert_allclose(slip, [0 if rolls else a - 2.5 * mu * G * np.cos(tilt), 0, 0], atol=1e-10)
    assert abs(s.remainder()) < 1e-10 * s.masses[0]


@pytest.mark.parametrize("side", [1 - 1e-6, 1 + 1e-6])
def test_the_threshold_of_rolling(side):
    s, frame = on_slope(30, side * 2 / 7 * np.tan(np.radians(30)))
    s.to(1.0)
    assert (s.state.books[1] > 1e-12 * s.masses[0]) == (side < 1)


@pytest.mark.parametrize("dt", [0.002, 0.02, 1.0])
def test_sliding_across_a_slope(dt):
    """Slip turns: m dv/dt = m g_t - μ N ŝ, J dω/dt = -R n × f, by solve_ivp. Measured: 9e-6
    of 3.5 at every dt (the leg's cut of the turning slip). Shorter steps must not be worse: the direction of the
    force must belong to the way that is made, not to a longer one that was planned."""
    v0, w0, mu = np.array([0.0, 2.0, 0.0]), np.array([-5.0, 0.0, 3.0]), 0.15
    s, frame = on_slope(30, mu, v0, w0)
    s.to(0.8, dt)
    press, pull = G * np.cos(np.radians(30)), G * np.sin(np.radians(30))

    def rates(_, y):
        v, w = y[3:6], y[6:]
        slip = v + np.cross(w, [0, 0, -R])
        f = -mu * press * slip / np.linalg.norm(slip)
        return [*v, *(f + [pull, 0, 0]), *(np.cross([0, 0, -R], f) / (0.4 * R**2))]

    y = solve_ivp(rates, (0, 0.8), [0, 0, R, *v0, *w0], method="DOP853", rtol=1e-11, atol=1e-12).y[:, -1]
    np.testing.assert_allclose(frame @ s.p[0], y[:3], atol=5e-5)
    np.testing.assert_allclose(frame @ s.v[0], y[3:6], atol=5e-5)
    np.testing.assert_allclose(frame @ s.w[0], y[6:], atol=5e-5)
    assert abs(s.remainder()) < 1e-10 * s.masses[0]


def test_off_the_edge_of_a_table():
    """Smooth table, v² > g R: it leaves at once and flies a parabola from the edge. Measured: 3e-10 (the rim)."""
    v = 1.5
    s = Scene(deck(ball((-0.75, 0, R), v=(v, 0, 0)), solid((-2, -1, -1), (0, 1, 0)), g=(0, 0, -G), e=0.5)).to(0.8)
    np.testing.assert_allclose(s.p[0], [v * 0.3, 0, R - G * 0.09 / 2], atol=1e-8)
    np.testing.assert_allclose(s.v[0], [v, 0, -G * 0.3], atol=1e-8)
    assert len(s.impacts) == 0


@pytest.mark.parametrize("e", [1.0, 0.5])
@pytest.mark.parametrize("mu", [0.0, 0.3])
def test_over_the_seam_of_two_boxes(mu, e):
    """A level joint is no obstacle: nothing is hit there, and the velocity stays. Fails if the second box's hidden edge
    is met."""
    floor = [solid((-1, -1, -1), (0, 1, 0)), solid((0, -1, -1), (1, 1, 0))]
    rolling = (-0.3 / R, 1.0 / R, 0)
    s = Scene(deck(ball((-0.3, 0, R), v=(1, 0.3, 0), w=rolling), *floor, g=(0, 0, -G), e=e, mu=mu)).to(0.31, 0.31)
    assert len(s.impacts) == 0
    s.to(0.6, 0.06)
    np.testing.assert_allclose(s.v[0], [1, 0.3, 0], atol=1e-9)
    np.testing.assert_allclose(s.p[0], [0.3, 0.18, R], atol=1e-8)
    assert len(s.impacts) == 0


def test_a_rolling_ball_meets_a_wall_and_rolls_back():
    """Rough floor, smooth wall: after the bounce it slips, then rolls with v' = -(5 e v - 2 v)/7."""
    walls = (3, 2, 3, 3, 2, 3)
    v, e = 1.0, 0.8
    rolling = ball((0, 0, R), v=(v, 0, 0), w=(0, v / R, 0))
    smooth = solid((1, -5, -5), (2, 5, 5), more=" cfrc(#)=0.0,")
    text = deck(rolling, smooth, lo=(-9, -9, 0), hi=(9, 9, 9), sides=walls, g=(0, 0, -G), e=e, mu=0.4)
    s = Scene(text).to(3.0)
    assert s.v[0, 0] == pytest.approx(-(5 * e * v - 2 * v) / 7, abs=1e-9)
    assert abs(s.remainder()) < 1e-10 * s.masses[0]
