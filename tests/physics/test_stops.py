"""Travel and angle limits: plastic impacts with partner 0 'limit' (DESIGN 6); prescribed bodies wait and return."""

import numpy as np
import pytest
from flowgmo_scenes import Scene, deck, driven, number, on_axis, rigid, solid, table, three

from flowgmo.deck.errors import DeckError
from flowgmo.records import LIMIT

UNIT = np.eye(3)
G = 9.81


def falling(more, v=(0, 0, 0), g=(0, 0, -G)):
    return Scene(deck(rigid(UNIT, mass=2.0, v=v, more=more), g=g, collide=False))


@pytest.mark.parametrize("dt", [0.01, 0.3, 1.5])
def test_a_falling_body_stops_and_stays(dt):
    """Time, place, impulse and loss of the stop in closed form. Measured: 6e-15."""
    s = falling("dzmcmin(#)=0.7,", v=(0.2, 0, 0)).to(1.5, dt, asked=[1.2])
    when, speed = np.sqrt(1.4 / G), np.sqrt(1.4 * G)
    np.testing.assert_allclose(s.p[0], [0.3, 0, -0.7], atol=1e-14)
    np.testing.assert_array_equal(s.v[0], [0.2, 0, 0])
    np.testing.assert_allclose(s.row("p_WB")[0, 0], [0.24, 0, -0.7], atol=1e-14)
    assert len(s.impacts) == 1
    hit = s.impacts[0]
    assert (hit["a"], hit["b"], hit["regime"], hit["count"]) == (1, 0, LIMIT, 1)
    assert hit["time"] == pytest.approx(when, rel=1e-13)
    np.testing.assert_allclose(hit["impulse"], [0, 0, 2.0 * speed], rtol=1e-13)
    np.testing.assert_allclose(hit["normal"], [0, 0, 1], atol=0)
    assert hit["energy_loss"] == pytest.approx(2.0 * 0.7 * G, rel=1e-13)
    assert abs(s.remainder()) < 1e-12


@pytest.mark.parametrize("dt", [0.01, 1.5])
def test_the_record_of_a_stop_says_where_it_was(dt):
    """The mass centre at the time of the hit. Fails if it is where the body was when the step began."""
    s = falling("dzmcmin(#)=0.7,", v=(0.2, 0, 0)).to(1.5, dt)
    np.testing.assert_allclose(s.impacts[0]["point"], [0.2 * np.sqrt(1.4 / G), 0, -0.7], atol=1e-12)


def test_thrown_against_a_stop_it_returns_under_gravity():
    """Up to the stop at .3, then free fall from there."""
    for dt in (0.05, 0.6):
        s = falling("dzmcmax(#)=0.3,", v=(0, 0, 4.0)).to(0.6, dt)
        when = (4.0 - np.sqrt(16.0 - 0.6 * G)) / G
        np.testing.assert_allclose(s.p[0, 2], 0.3 - G * (0.6 - when) ** 2 / 2, atol=1e-13)
        assert s.impacts["time"] == pytest.approx([when], rel=1e-13)


@pytest.mark.parametrize("dt", [0.01, 2.0])
def test_no_step_takes_a_body_past_its_second_stop(dt):
    """Thrown up to +.05, back, and down to -.05, in one step as in many."""
    s = falling("dzmcmax(#)=0.05, dzmcmin(#)=0.05,", v=(0, 0, 1.0)).to(2.0, dt)
    np.testing.assert_allclose(s.p[0], [0, 0, -0.05], atol=1e-14)
    assert len(s.impacts) == 2


def test_a_zero_travel_holds_a_component():
    s = falling("dzmcmin(#)=0.0, dzmcmax(#)=0.0,", v=(0.5, 0, 1.0)).to(1.0, 0.1)
    np.testing.assert_allclose(s.p[0], [0.5, 0, 0], atol=1e-14)


@pytest.mark.parametrize("dt", [0.05, 2.0])
def test_a_load_presses_a_body_against_its_stop(dt):
    """F = 2 over .5: the stop takes all of F s, and the load does no work on a body that stands."""
    body = rigid(UNIT, more="igf(#)=1, fxtobs(1,#)=2.0, dxmcmax(#)=0.5,")
    s = Scene(deck(body, collide=False)).to(2.0, dt)
    np.testing.assert_allclose(s.p[0], [0.5, 0, 0], atol=1e-14)
    assert s.impacts["time"] == pytest.approx([np.sqrt(0.5)], rel=1e-9)
    assert s.state.books[3] == pytest.approx(1.0, rel=1e-9)
    assert abs(s.remainder()) < 1e-9


@pytest.mark.parametrize("dt", [0.01, 0.1, 2.0])
def test_it_leaves_the_stop_when_the_load_turns(dt):
    """F falls from +2 to -2 between t = 1 and 1.3, so it turns at 1.15. Then x = .5 + ∫∫F."""
    body = rigid(UNIT, more="igf(#)=1," + table("fxtobs", [2, 2, -2, -2]) + " dxmcmax(#)=0.5,")
    s = Scene(deck(body, times=[0, 1, 1.3, 3], collide=False)).to(2.0, dt)
    ramp, slope = 0.15, 4 / 0.3
    expected = -slope * ramp**3 / 6 - slope * ramp**2 / 2 * 0.7 - 2 * 0.7**2 / 2
    assert s.p[0, 0] - 0.5 == pytest.approx(expected, rel=1e-6)
    assert abs(s.remainder()) < 1e-9


@pytest.mark.parametrize("dt", [0.01, 1.5])
def test_angle_limit_of_a_pendulum(dt):
    """Released at 60°, stopped 20° on: loss m g l (cos 40° - cos 60°), impulse moment J ω. Degrees in the deck."""
    moment, mass, arm = 0.7, 2.0, 0.4
    centre = (arm * np.sin(np.pi / 3), 0, -arm * np.cos(np.pi / 3))
    body = on_axis(moment, (0, 1, 0), mass, centre, more="anglmax(#)=20.0, anglmin(#)=0.0,")
    s = Scene(deck(body, g=(0, 0, -G), collide=False)).to(1.5, dt)
    lost = mass * G * arm * (np.cos(np.radians(40)) - 0.5)
    assert s.state.angle[0] == pytest.approx(np.radians(20), abs=1e-13)
    assert len(s.impacts) == 1
    assert s.impacts["energy_loss"][0] == pytest.approx(lost, rel=1e-9)
    np.testing.assert_allclose(s.impacts["impulse"][0], [0, -np.sqrt(2 * moment * lost), 0], rtol=1e-9)
    assert abs(s.remainder()) < 1e-9


@pytest.mark.parametrize("dt", [0.01, 0.25, 1.0])
def test_a_prescribed_body_waits_at_its_limit_and_returns(dt):
    """u = sin 2πt comes back at once when it turns: from .2 at t = .5 to .2 - 1/π at t = 1."""
    s = Scene(deck(driven((0, 0, 0), more="iupre(#)=1, uamp(#)=1.0, ufre(#)=1.0, dxmcmax(#)=0.2,"), collide=False))
    s.to(0.5, min(dt, 0.5))
    assert s.p[0, 0] == pytest.approx(0.2, abs=1e-13)
    s.to(1.0, min(dt, 0.5))
    assert s.p[0, 0] == pytest.approx(0.2 - 1 / np.pi, abs=1e-12)


@pytest.mark.parametrize("more", ["anglmax(#)=10.0,", "dzmcmin(#)=0.1,"])
def test_a_body_on_a_fixed_point_has_no_stops(more):
    """A deck that gives it one is refused: what limits.py watches are free bodies and fixed axes."""
    with pytest.raises(DeckError, match="limits of"):
        falling(more + " imoaxs(#)=4, zaxs0(#)=0.5,")


def test_a_driven_axis_waits_at_its_angle():
    """Rate 1 until t = 1, falling to -1 at t = 1.5: it turns back at 1.25."""
    rates = table("omxtobs", [1.0, 1.0, -1.0, -1.0]).replace("omxtobs(1,#)=1.0,", "")
    body = on_axis(1.0, (0, 0, 1), centre=(0.5, 0, 0), rate=1.0, kind=3, more="anglmax(#)=30.0," + rates)
    s = Scene(deck(body, times=[0, 1, 1.5, 3.0], collide=False)).to(1.0)
    assert s.state.angle[0] == pytest.approx(np.pi / 6, abs=1e-14)
    assert s.w[0] @ s.w[0] == 0.0
    s.to(2.5)
    assert s.state.angle[0] == pytest.approx(np.pi / 6 - 0.125 - 1.0, abs=1e-12)


@pytest.mark.parametrize("first", [0.0, 1e-18, 1e-9])
def test_a_load_that_grows_from_almost_nothing(first):
    """F = t on a body at rest, but for its first value: x = t³/6. Fails if the error of a step counts against a
    change that is round-off."""
    body = rigid(UNIT, more="igf(#)=1," + table("fxtobs", [first, 1.0]))
    s = Scene(deck(body, times=[0, 1], collide=False)).to(1.0)
    assert s.p[0, 0] == pytest.approx(1 / 6, rel=1e-8)


MU, MASS = 0.3, 8.0
FLOOR = (3, 3, 3, 3, 2, 3)


def block(lo=(-0.1, -0.1, 0), v=(0, 0, 0), more="", side=0.2):
    """A coupled cube of 8 kg."""
    start = three(("utobs(1,#)", "vtobs(1,#)", "wtobs(1,#)"), v)
    text = solid(lo, np.add(lo, side), more=start + more)
    return text.replace("imo(#)=0", f"imo(#)=4, rhomvb(#)={number(MASS / side**3)}")


def on_the_floor(*bodies, z=0.0, mu=MU, times=None):
    """Plastic impacts, rough floor."""
    return Scene(
        deck(*bodies, lo=(-9, -9, z), hi=(9, 9, 9), sides=FLOOR, g=(0, 0, -G), e=0.0, mu=mu, times=times)
    )  # fmt: skip


@pytest.mark.parametrize("dt", [0.01, 0.05])
def test_a_block_that_slides_on_a_rough_floor_meets_its_stop(dt):
    """The stop at x = .1 takes m u; along the stop the block slides on. Measured: time 1e-12, where it ends 8e-6 (it
    comes to rest within a leg). Fails where stops are watched in free flight only: it slides through, to x = .17."""
    s = on_the_floor(block(v=(1.0, 0.2, 0), more=" dxmcmax(#)=0.1,")).to(1.0, dt)
    pull = MU * G / np.hypot(1.0, 0.2)  # of the velocity, per unit of it: its direction stays
    u = np.sqrt(1.0 - 2 * pull * 0.1)
    hit = s.impacts[s.impacts["regime"] == LIMIT]
    assert hit["time"] == pytest.approx([(1.0 - u) / pull], rel=1e-9) and hit["b"][0] == 0
    np.testing.assert_allclose(hit["impulse"][0], [-MASS * u, 0, 0], rtol=1e-9, atol=1e-9)
    assert hit["energy_loss"][0] == pytest.approx(MASS * u**2 / 2, rel=1e-9)
    np.testing.assert_allclose(s.p[0, [0, 2]], 0.1, atol=1e-10)
    assert s.p[0, 1] == pytest.approx(0.02 + (0.2 * u) ** 2 / (2 * MU * G), abs=2e-5)
    np.testing.assert_allclose([s.v[0], s.w[0]], 0, atol=1e-9)
    assert abs(s.remainder()) < 1e-12 * MASS


@pytest.mark.parametrize("dt", [0.01, 0.05])
def test_a_load_presses_a_block_on_the_floor_against_its_stop_and_pulls_it_back(dt):
    """F = 40 - 40 t: it stands at the stop until F = -μ m g, then slides back with a = -(F + μ m g)/m.

    Measured: 8e-9 m/s, 3e-6 m; books 9e-6 J of 5 (Simpson's sum and constant forces in a leg: h²).
    """
    pushed = block(more=" dxmcmax(#)=0.1, igf(#)=1," + table("fxtobs", [40, -40]))
    s = on_the_floor(pushed, times=[0, 2.0]).to(1.0, dt)
    assert s.p[0, 0] == pytest.approx(0.1, abs=1e-10) and np.abs(s.v[0]).max() < 1e-9
    s.to(2.0, dt)
    turn = 1.0 + MU * MASS * G / 40
    np.testing.assert_allclose(s.v[0], [-40 / MASS * (2 - turn) ** 2 / 2, 0, 0], atol=2e-5)
    assert s.p[0, 0] == pytest.approx(0.1 - 40 / MASS * (2 - turn) ** 3 / 6, abs=1e-5)
    assert np.count_nonzero(s.impacts["regime"] == LIMIT) == 1
    assert abs(s.remainder()) < 1e-4


@pytest.mark.parametrize("dt", [0.01, 0.0025])
def test_a_gate_that_pushes_a_block_meets_its_angle_limit(dt):
    """A torque of 5 turns the gate against a block on the floor; at 10° it stops, and the block slides on.

    Measured: angle exact, books 3e-15 J of .9. Its record is a moment along the axis.
    """
    gate = solid((0, -0.05, -0.05), (1, 0.05, 0.05)).replace("imo(#)=0", "imo(#)=4, imoaxs(#)=1, rhomvb(#)=1000.0")
    gate += " igf(#)=1, tztobs(1,#)=5.0, anglmax(#)=10.0,"
    pushed = block((0.5, 0.051, -0.05))
    s = on_the_floor((gate, "axisz(#)=1.0,"), pushed, z=-0.05, mu=0.05).to(2.0, dt)
    assert s.state.angle[0] == pytest.approx(np.radians(10), abs=1e-12)
    hit = s.impacts[s.impacts["regime"] == LIMIT]
    assert len(hit) == 1 and hit["impulse"][0, 2] < -0.5 and np.abs(hit["impulse"][0, :2]).max() < 1e-12
    assert s.state.books[3] == pytest.approx(5.0 * np.radians(10), rel=2e-4)  # less what shifts turn it back: 7e-5
    assert np.abs(s.v).max() < 1e-9
    assert abs(s.remainder()) < 1e-12
