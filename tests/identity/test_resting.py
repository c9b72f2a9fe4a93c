"""Boxes that fall, slide, and stand on each other: restart, units, and mirror do not change the result."""

from dataclasses import fields

import numpy as np
import pytest
from flowgmo_scenes import Scene, deck, solid

from flowgmo.output import read_restart, write_restart
from flowgmo.state import State

G = 9.81
SIDES = (3, 3, 3, 3, 2, 3)
DT = 0.01
UNITS = {"p_WB": (1, 0, 0), "v_WB": (1, -1, 0), "w_WB": (0, -1, 0), "books": (2, -2, 1)}  # powers of L, T, M


def box(lo, hi, v=(0, 0, 0), w=(0, 0, 0), units=(1.0, 1.0, 1.0), more=""):
    """A coupled box of density 1000."""
    length, time, mass = units
    start = "".join(f" {n}tobs(1,#)={x * length / time!r}," for n, x in zip("uvw", v, strict=True) if x)
    start += "".join(f" om{n}tobs(1,#)={x / time!r}," for n, x in zip("xyz", w, strict=True) if x)
    text = solid(np.array(lo) * length, np.array(hi) * length, more=start + more)
    return text.replace("imo(#)=0", f"imo(#)=4, rhomvb(#)={1000.0 * mass / length**3!r}")


def sliding(units=(1.0, 1.0, 1.0)):
    """A box .4 x .2 x .1 that falls 2 cm on a rough floor and slides, turning, until it stays."""
    return [box((-0.2, -0.1, 0.02), (0.2, 0.1, 0.12), (1.0, 0.25, 0), (0, 0, 1.5), units)]


def stack(units=(1.0, 1.0, 1.0)):
    """Three boxes, each 1 mm over the one below, and pushed sideways."""
    return [
        box((-0.1, -0.1, 0.001 + 0.101 * k), (0.1, 0.1, 0.101 + 0.101 * k), (0.1 * (k == 2), 0, 0), units=units)
        for k in range(3)
    ]


def scene(make, units=(1.0, 1.0, 1.0)):
    length, time, _ = units
    lo, hi = np.array([-4.0, -4, 0]) * length, np.array([4.0, 4, 4]) * length
    return Scene(deck(*make(units), lo=lo, hi=hi, sides=SIDES, g=(0, 0, -G * length / time**2), e=0.3, mu=0.3))


def assert_same(one, two, units=(1.0, 1.0, 1.0)):
    """Every array of two States; `two` in the units. held_values: place, direction, force, age."""
    length, time, mass = units
    for field in fields(State):
        a, b = getattr(one, field.name), getattr(two, field.name)
        if not isinstance(a, np.ndarray):
            continue
        if field.name == "held_values":
            factor = np.array([length] * 3 + [1.0] * 3 + [mass * length / time**2] * 3 + [time])
        else:
            powers = UNITS.get(field.name, (0, 0, 0))
            factor = length ** powers[0] * time ** powers[1] * mass ** powers[2]
        assert np.array_equal(a * factor, b), field.name


@pytest.mark.parametrize("make", [sliding, stack])
def test_a_restart_with_contacts_that_stay_goes_on_bit_for_bit(make, tmp_path):
    """Through restart.h5 after 3, 11 and 25 steps, every time with a new world. Fails where the engine keeps what the
    State does not hold: a guess of forces, an age, an order of contacts."""
    whole, parts = scene(make), scene(make)
    held = []
    for k in range(1, 41):
        whole.to(k * DT), parts.to(k * DT)
        if k in (3, 11, 25):
            write_restart(tmp_path / "restart.h5", parts.model, parts.state)
            fresh = scene(make)
            fresh.state = read_restart(tmp_path / "restart.h5", fresh.model)
            held.append(len(fresh.state.held_parts))
            parts = fresh
    assert max(held) >= 4 and whole.state.general
    assert_same(whole.state, parts.state)


@pytest.mark.parametrize("make", [sliding, stack])
@pytest.mark.parametrize("powers", [(3, 0, 0), (0, 5, 0), (0, 0, -7), (-11, 4, 9)])
def test_powers_of_two_in_length_time_and_mass_give_the_same_bits(make, powers):
    """Falling, impacts of four corners, sliding, rest. Fails on any tolerance with a unit."""
    units = tuple(2.0**p for p in powers)
    plain, scaled = scene(make).to(0.4, DT), scene(make, units)
    scaled.to(0.4 * units[1], DT * units[1])
    assert_same(plain.state, scaled.state, units)
    assert len(plain.impacts) == len(scaled.impacts) > 0
    assert np.array_equal(scaled.impacts["time"], plain.impacts["time"] * units[1])
    assert np.array_equal(scaled.impacts["impulse"], plain.impacts["impulse"] * (units[2] * units[0] / units[1]))


def mirrored(text):
    """The box of `sliding` with y -> -y: velocity in y and spins about x and z change sign."""
    return text.replace("vtobs(1,#)=", "vtobs(1,#)=-").replace("omztobs(1,#)=", "omztobs(1,#)=-")


def test_a_mirrored_scene_slides_mirrored():
    """y -> -y. Measured: 1e-11, 8e-12, 6e-11: what is left where the forces count as found. Fails where the order of
    corners decides."""
    plain = scene(sliding).to(0.4, DT)
    other = scene(lambda units: [mirrored(text) for text in sliding(units)]).to(0.4, DT)
    np.testing.assert_allclose(other.p, plain.p * [1, -1, 1], rtol=0, atol=1e-9)
    np.testing.assert_allclose(other.v, plain.v * [1, -1, 1], rtol=0, atol=1e-9)
    np.testing.assert_allclose(other.w, plain.w * [-1, 1, -1], rtol=0, atol=1e-9)
    assert np.linalg.norm(plain.p[0, :2]) > 0.1


def test_a_stack_far_away_does_not_matter():
    """A box slides as it does alone, to the last bit. Fails where a guess of forces or an impact is shared.

    Bodies share the length of the legs that a step is cut into: 4 ms steps are one leg for either, with 10 ms the
    stack's shorter legs change the box by 1.5e-4.
    """
    alone = scene(sliding).to(0.3, 0.004)
    far = [text.replace("xl(#)=", "trnx(#)=2.0, xl(#)=") for text in stack()]
    both = scene(lambda units: sliding(units) + far).to(0.3, 0.004)
    for name in ("p_WB", "q_WB", "v_WB", "w_WB"):
        assert np.array_equal(getattr(both.state, name)[0], getattr(alone.state, name)[0]), name


@pytest.mark.parametrize("e", [0.0, 0.5])
def test_a_symmetric_scene_stays_symmetric(e):
    """A cube that falls and slides along x has its middle plane as a mirror. Measured: 2e-10 (e = 0)."""
    cube = [box((-0.1, -0.1, 0.02), (0.1, 0.1, 0.22), (0.5, 0, 0))]
    s = Scene(deck(*cube, lo=(-4, -4, 0), hi=(4, 4, 4), sides=SIDES, g=(0, 0, -G), e=e, mu=0.3))
    for _ in range(25):
        s.to(s.state.t + DT)
        assert abs(s.p[0, 1]) < 1e-9 and abs(s.v[0, 1]) < 1e-8 and abs(s.w[0, [0, 2]]).max() < 1e-6


def far_away(texts):
    """The same bodies 2 m aside."""
    return [text.replace("xl(#)=", "trnx(#)=2.0, xl(#)=") for text in texts]


def hit_hard(units=(1.0, 1.0, 1.0)):
    """The stack, and a box of its size that falls on it with 100 m/s."""
    return [*stack(units), box((-0.1, -0.1, 0.4), (0.1, 0.1, 0.5), (0, 0, -100.0), units=units)]


def test_a_stack_that_is_hit_hard_does_not_matter_to_the_last_bit():
    """What counts as rest, as settled, as turning, and the time in which a bounce must end are those of an island.

    Fails where they are taken from the fastest of the scene: measured 1e-16 m, 1e-13 m/s then.
    """
    alone = scene(stack).to(0.3, 0.002)
    both = scene(lambda units: stack(units) + far_away(hit_hard(units))).to(0.3, 0.002)
    for name in ("p_WB", "q_WB", "v_WB", "w_WB"):
        assert np.array_equal(getattr(both.state, name)[:3], getattr(alone.state, name)), name
    assert np.abs(both.impacts["impulse"]).max() > 20 * np.abs(alone.impacts["impulse"]).max()


@pytest.mark.parametrize("mass", [2.0, 8.0])
def test_the_mass_of_a_stack_far_away_does_not_matter_to_the_last_bit(mass):
    """Steps of 10 ms, cut into the stack's legs. Fails where all contacts share a unit of mass: roots of odd powers of
    two round; measured 4e-15 m, 2e-14 1/s then."""
    plain, other = (
        scene(lambda units, m=m: sliding(units) + far_away(stack((1.0, 1.0, m)))).to(0.3, DT) for m in (1.0, mass)
    )
    for name in ("p_WB", "q_WB", "v_WB", "w_WB"):
        assert np.array_equal(getattr(other.state, name)[0], getattr(plain.state, name)[0]), name


def test_forces_of_sleepers_hold_them():
    """The contacts that a sleeping body keeps carry its weight, each body by itself. Measured: 4e-11 of it.

    Fails where the history has its weight instead of what was solved for, and where a contact is lost in its sleep.
    """
    s = scene(stack).to(0.6, 0.005)
    assert (s.state.asleep == 1).all()
    s.to(0.7, 0.005, asked=[0.65])
    weight = s.masses[:, None] * [0, 0, G]
    np.testing.assert_allclose(s.row("contact_force")[-1], weight, atol=1e-9 * weight.max())
    total = np.zeros_like(weight)
    for (a, b, _), force in zip(s.state.held_parts, s.state.held_values[:, 6:9], strict=True):
        total[a] += force
        if b < len(total):
            total[b] -= force
    np.testing.assert_allclose(total, weight, atol=1e-9 * weight.max())


def hit_later(sleep):
    """A box at rest, that another flies against at t = .14925, in the middle of a step of 2 ms."""
    bodies = [
        box((-0.1, -0.1, 0), (0.1, 0.1, 0.2)),
        box((-0.5, -0.1, 0.21), (-0.3 + 0.001, 0.1, 0.25), v=(1.0 / 0.75, 0, 0.6)),
    ]
    text = deck(*bodies, lo=(-4, -4, 0), hi=(4, 4, 4), sides=SIDES, g=(0, 0, -G), e=0.0, mu=0.3, knobs=f"sleep={sleep}")
    return Scene(text)


def test_a_box_that_sleeps_is_hit_as_one_that_is_awake():
    """Every impact and the way after it. Measured: 1.1e-8, a rough cluster's answer to round-off (test_clusters).

    Fails where a body that wakes in the middle of a step falls from the step's start: g dt = 3 mm/s at the impact.
    """
    awake, asleep = hit_later(".false."), hit_later(".true.")
    awake.to(0.14, 0.002), asleep.to(0.14, 0.002)
    assert asleep.state.asleep[0] == 1 and awake.state.asleep[0] == 0
    awake.to(0.3, 0.002), asleep.to(0.3, 0.002)
    met = asleep.impacts[asleep.impacts["b"] == 2]
    assert len(met) > 0 and (met["time"] / 0.002 % 1.0 > 0.05).all()
    assert len(asleep.impacts) == len(awake.impacts)
    np.testing.assert_allclose(asleep.impacts["impulse"], awake.impacts["impulse"], rtol=0, atol=1e-6)
    np.testing.assert_allclose(asleep.p, awake.p, rtol=0, atol=1e-7)
    np.testing.assert_allclose(asleep.v, awake.v, rtol=0, atol=1e-6)
