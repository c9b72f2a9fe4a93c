"""A sphere that bounces to rest (report 4.2, VALIDATION C): h_i = e^(2i) h0,

t_i = √(2 h0/g) (-1 - eⁱ + 2 Σ_{j<=i} eʲ), the whole ends at √(2 h0/g) (1 + e)/(1 - e).
"""

import numpy as np
import pytest
from flowgmo_scenes import OPEN, Scene, ball, deck, solid

G, H, R = 9.81, 0.5, 0.1
FALL = np.sqrt(2 * H / G)
FLOOR = (3, 3, 3, 3, 2, 3)


def scene(e, floor="side", x=(0, 0), **more):
    """Dropped from H above the domain's bottom, or above a box."""
    bodies = [ball((*x, H + R))] + ([solid((-1, -1, -1), (1, 1, 0))] if floor == "box" else [])
    low = 0.0 if floor == "side" else -3.0
    sides = FLOOR if floor == "side" else OPEN
    return Scene(deck(*bodies, lo=(-2, -2, low), hi=(2, 2, 3), sides=sides, g=(0, 0, -G), e=e, **more))


def impact_times(e, n):
    """Times of impacts 1 .. n: the fall, then flights of 2 eⁱ."""
    return FALL * (1 + 2 * np.concatenate([[0], np.cumsum(e ** np.arange(1, n))]))


@pytest.mark.parametrize("floor", ["side", "box"])
@pytest.mark.parametrize("dt", [1e-3, 1e-2, 0.1, 1.0, 10.0])
def test_every_recorded_bounce_and_the_time_of_rest(dt, floor):
    """Measured: 1e-13 on times, also at dt = 10 (bound of VALIDATION 1e-8)."""
    e, end = 0.8, max(3.0, dt)
    s = scene(e, floor).to(end, dt)
    single = s.impacts[s.impacts["count"] == 1]
    n = len(single)
    assert n >= 1
    np.testing.assert_allclose(single["time"], impact_times(e, n), atol=1e-8, rtol=0)
    speeds = np.sqrt(2 * G * H) * e ** np.arange(n)
    np.testing.assert_allclose(single["impulse"][:, 2], s.masses[0] * (1 + e) * speeds, rtol=1e-8)
    whole = s.impacts[s.impacts["count"] > 1]
    rest = FALL * (1 + e) / (1 - e)
    assert rest == pytest.approx(2.873479, abs=1e-6)
    np.testing.assert_allclose(whole["time"], rest, atol=1e-8)
    np.testing.assert_allclose(s.p[0], [0, 0, R], atol=1e-12)
    np.testing.assert_array_equal(s.v[0], 0.0)
    assert abs(s.remainder()) < 1e-10 * s.masses[0] * G * H


@pytest.mark.slow
def test_at_a_tiny_step():
    s = scene(0.8).to(3.0, 1e-4)
    single = s.impacts[s.impacts["count"] == 1]
    np.testing.assert_allclose(single["time"], impact_times(0.8, len(single)), atol=1e-8, rtol=0)
    np.testing.assert_allclose(s.p[0], [0, 0, R], atol=1e-12)


@pytest.mark.parametrize("dt", [0.02, 10.0])
def test_no_penetration_and_no_gain_of_energy_at_any_row(dt):
    """Rows inside the series too: heights from the closed form. Measured: 3e-14 below the floor."""
    asked = np.linspace(0.01, 9.9, 991)
    s = scene(0.8).to(10.0, dt, asked=asked)
    height = s.row("p_WB")[:, 0, 2] - R
    assert height.min() > -1e-12
    energy = s.energy("kinetic") + s.energy("potential")
    assert np.all(np.diff(energy) < 1e-12 * s.masses[0] * G * H)
    np.testing.assert_allclose(s.energy("remainder"), 0.0, atol=1e-10 * s.masses[0] * G * H)
    starts = impact_times(0.8, 40)
    for t, h in zip(asked, height, strict=True):
        k = np.searchsorted(starts, t)
        if 0 < k < 40:
            up, since = np.sqrt(2 * G * H) * 0.8**k, t - starts[k - 1]
            assert h == pytest.approx(up * since - G * since**2 / 2, abs=1e-9)


def test_contact_force_at_rest_is_the_weight():
    s = scene(0.5).to(3.0, 0.5, asked=[2.9])
    np.testing.assert_allclose(s.row("contact_force")[0, 0], [0, 0, s.masses[0] * G], rtol=1e-14)


@pytest.mark.parametrize("mu, v, w", [(0.2, 1.0, (0, 0, 0)), (0.05, 3.0, (0, 20.0, 5.0)), (1.0, 0.5, (0, -30.0, 0))])
def test_an_oblique_series_closed_at_once_is_the_series_bounce_by_bounce(mu, v, w):
    """The same throw with DELT longer than the whole series and with short steps. Measured: 3e-13."""

    def run(dt):
        bodies = ball((0, 0, H + R), v=(v, 0.3 * v, 0), w=w)
        text = deck(bodies, lo=(-50, -50, 0), hi=(50, 50, 3), sides=FLOOR, g=(0, 0, -G), e=0.7, mu=mu)
        return Scene(text).to(4.0, dt, asked=[1.0, 1.6, 2.5])

    once, often = run(4.0), run(0.01)
    assert (once.impacts["count"] > 1).sum() == 1
    for name in ("p_WB", "v_WB", "w_WB"):
        np.testing.assert_allclose(once.row(name), often.row(name), atol=1e-9)
    for a, b in ((once.p, often.p), (once.v, often.v), (once.w, often.w), (once.q, often.q)):
        np.testing.assert_allclose(a, b, atol=1e-9)
    total = [s.impacts["impulse"].sum(axis=0) for s in (once, often)]
    np.testing.assert_allclose(total[0], total[1], rtol=1e-8)
    for s in (once, often):
        assert abs(s.remainder()) < 1e-9 * s.masses[0]


def test_a_bounce_series_on_a_slope_slides_on():
    """Smooth slope of 20°: along it the fall of a point mass, whatever the bounces do. Measured: 2e-15."""
    tilt = np.radians(20)
    floor = solid((-90, -1, -1), (90, 1, 0), more=" roty(#)=20.0,")
    n = np.array([np.sin(tilt), 0, np.cos(tilt)])
    s = Scene(deck(ball((0.3 + R) * n), floor, g=(0, 0, -G), e=0.5)).to(3.0, 3.0)
    down = np.array([np.cos(tilt), 0, -np.sin(tilt)])
    assert s.p[0] @ down == pytest.approx(G * np.sin(tilt) * 4.5, rel=1e-11)
    assert s.p[0] @ n == pytest.approx(R, abs=1e-11)
