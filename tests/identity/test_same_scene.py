"""One scene written in several ways: other units, mirrored, renumbered, steps split, effects at zero (VALIDATION E)."""

import numpy as np
import pytest
from flowgmo_scenes import Scene, ball, deck, matrix, rigid, solid, table

G = 9.81
SIDES = (2, 2, 2, 1, 2, 2)
STATE = ("p_WB", "q_WB", "v_WB", "w_WB", "angle", "hold", "support", "books")


def spread(seed=5, n=7):
    """Centres, radii, velocities, spins of n balls that do not overlap, and of a box below."""
    rng = np.random.default_rng(seed)
    grid = np.array([(i, j) for i in (-0.5, 0, 0.5) for j in (-0.5, 0, 0.5)])[rng.permutation(9)[:n]]
    x = np.column_stack([grid + rng.uniform(-0.05, 0.05, (n, 2)), rng.uniform(0.3, 0.9, n)])
    return x, rng.uniform(0.08, 0.18, n), rng.normal(size=(n, 3)), rng.normal(size=(n, 3)) * 5


def scene(length=1.0, time=1.0, mass=1.0, order=None, mirror=False, mu=0.2, seed=5):
    """Balls over a tilted box in a walled domain; units multiplied."""
    x, r, v, w = spread(seed)
    flip = np.array([-1.0, 1, 1]) if mirror else np.ones(3)
    turn = np.array([1.0, -1, -1]) if mirror else np.ones(3)
    x, v, w = x * flip * length, v * flip * length / time, w * turn / time
    rho = 1000.0 * mass / length**3
    bodies = [ball(a, b * length, c, d, rho=rho) for a, b, c, d in zip(x, r, v, w, strict=True)]
    bodies.append(solid(np.array([-0.4, -0.3, -0.4]) * length, np.array([0.4, 0.3, -0.1]) * length,
                        more=f" roty(#)={'-' if mirror else ''}14.0,"))  # fmt: skip
    order = list(range(len(bodies))) if order is None else order
    return Scene(
        deck(
            *[bodies[k] for k in order], lo=(-0.95 * length,) * 3, hi=(0.95 * length,) * 3, sides=SIDES,
            g=(0, 0, -G * length / time**2), e=0.7, mu=mu,
        )
    )  # fmt: skip


def loaded(length=1.0, time=1.0, mass=1.0):
    """A body with control loads, a stop, and a driven one."""
    force = mass * length / time**2
    inertia = np.array([[2.0, 0.3, -0.1], [0.3, 1.5, 0.2], [-0.1, 0.2, 1.1]]) * mass * length**2
    more = "igf(#)=1," + table("fxtobs", np.array([1.0, 2.0]) * force) + f" tytobs(1,#)={0.7 * force * length!r},"
    body = rigid(inertia, 1.5 * mass, w=np.array([1, 0.2, 3]) / time, r=0.1 * length,
                 more=more + f" dxmcmax(#)={0.25 * length!r},")  # fmt: skip
    wave = (
        f"imo(#)=3, iob(#)=#, rsh(#)={0.1 * length!r}, iupre(#)=1, uamp(#)={length / time!r}, ufre(#)={0.9 / time!r},"
    )
    return Scene(deck(body, wave, collide=False, times=[0, 0.6 * time], lo=(-9 * length,) * 3, hi=(9 * length,) * 3))


UNITS = {"p_WB": (1, 0, 0), "v_WB": (1, -1, 0), "w_WB": (0, -1, 0), "books": (2, -2, 1)}  # powers of L, T, M


@pytest.mark.parametrize("make", [scene, loaded])
@pytest.mark.parametrize("powers", [(3, 0, 0), (0, 5, 0), (0, 0, -7), (-11, 4, 9), (1, 1, 1)])
def test_powers_of_two_in_length_time_and_mass_give_the_same_bits(make, powers):
    """Every array of the State and every impact. Fails on any absolute tolerance or constant with a unit."""
    length, time, mass = (2.0**p for p in powers)
    plain, scaled = make(), make(length, time, mass)
    plain.to(1.5, 0.125)
    scaled.to(1.5 * time, 0.125 * time)
    for name in STATE:
        a, b, c = UNITS.get(name, (0, 0, 0))
        factor = length**a * time**b * mass**c
        expected = getattr(plain.state, name)
        if expected.dtype.kind == "f":
            expected = expected * factor
        assert np.array_equal(getattr(scaled.state, name), expected), name
    assert len(plain.impacts) == len(scaled.impacts) > 0
    assert np.array_equal(scaled.impacts["time"], plain.impacts["time"] * time)
    assert np.array_equal(scaled.impacts["impulse"], plain.impacts["impulse"] * (mass * length / time))


def until(s, impacts, end=3.0, dt=0.01):
    """Step until the scene had that many impacts."""
    while len(s.impacts) < impacts and s.state.t < end:
        s.to(s.state.t + dt)
    return s


def test_cgs_and_si_agree_up_to_the_20th_impact():
    """Measured: 2e-14."""
    si, cgs = scene(), scene(length=100.0, mass=1000.0)
    until(si, 20)
    cgs.to(si.state.t, 0.01)
    np.testing.assert_allclose(cgs.impacts["time"][:20], si.impacts["time"][:20], rtol=0, atol=1e-10)
    np.testing.assert_allclose(cgs.p / 100, si.p, atol=1e-9)


@pytest.mark.parametrize("seed", [5, 6])
def test_numbering_does_not_matter_up_to_the_20th_impact(seed):
    """Measured: 2e-14 for all."""
    order = [3, 7, 0, 6, 2, 1, 5, 4]
    plain, other = until(scene(seed=seed), 20), scene(order=order, seed=seed)
    other.to(plain.state.t, 0.01)
    np.testing.assert_allclose(other.impacts["time"][:20], plain.impacts["time"][:20], rtol=0, atol=1e-10)
    for name in ("p_WB", "v_WB"):
        np.testing.assert_allclose(getattr(other.state, name), getattr(plain.state, name)[order], atol=1e-8)


def test_a_mirrored_deck_gives_the_mirrored_result():
    """x -> -x: positions flip in x, spins in y and z. Measured: 3e-13."""
    plain, other = until(scene(), 20), scene(mirror=True)
    other.to(plain.state.t, 0.01)
    flip, turn = np.array([-1.0, 1, 1]), np.array([1.0, -1, -1])
    np.testing.assert_allclose(other.impacts["time"][:20], plain.impacts["time"][:20], rtol=0, atol=1e-10)
    np.testing.assert_allclose(other.p, plain.p * flip, atol=1e-8)
    np.testing.assert_allclose(other.w, plain.w * turn, atol=1e-6)


def test_steps_of_half_the_size_are_the_same_up_to_the_20th_impact():
    """Flight and impacts do not know the step. Measured: 9e-14."""
    plain, other = until(scene(mu=0.0), 20), scene(mu=0.0)
    other.to(plain.state.t, 0.005)
    np.testing.assert_allclose(other.impacts["time"][:20], plain.impacts["time"][:20], rtol=0, atol=1e-10)
    np.testing.assert_allclose(other.p, plain.p, atol=1e-8)


@pytest.mark.parametrize("dt", [0.5, 0.1, 0.003])
def test_flight_does_not_depend_on_the_step(dt):
    """Parabola and free top, to round-off of the sums. Measured: 5e-13 (1e-13 at dt = .003)."""
    inertia = np.array([[2.0, 0.3, -0.1], [0.3, 1.5, 0.2], [-0.1, 0.2, 1.1]])
    make = lambda: Scene(deck(rigid(inertia, v=(1, 2, 3), w=(1, 2, 3)), g=(0, 0, -G), collide=False))  # noqa: E731
    once, often = make().to(1.5), make().to(1.5, dt)
    for name in ("p_WB", "v_WB", "w_WB"):
        np.testing.assert_allclose(getattr(often.state, name), getattr(once.state, name), atol=1e-11)
    np.testing.assert_allclose(matrix(often.q[0]), matrix(once.q[0]), atol=1e-11)


def names(s):
    return {effect.name for effect in s.model.effects}


def test_zero_friction_is_no_friction():
    with_zero = scene(mu=0.0)
    assert "friction" not in names(with_zero) and "friction" in names(scene())
    with_zero.to(0.5)
    assert "dissipated" not in with_zero.first_row.energy or with_zero.state.books[1] == 0.0


def test_zero_gravity_is_no_gravity():
    assert "gravity" not in names(Scene(deck(ball((0, 0, 0)), collide=False)))


def test_zero_loads_and_tables_are_absent():
    """A control load of zeros makes no law: kernels get None, and the bits are those of the deck without it."""
    inertia = np.diag([1.0, 2.0, 3.0])
    plain = Scene(deck(rigid(inertia, w=(1, 2, 3)), g=(0, 0, -G), collide=False))
    zero = Scene(deck(rigid(inertia, w=(1, 2, 3), more="igf(#)=1, fxtobs(1,#)=0.0, tytobs(1,#)=0.0,"),
                      g=(0, 0, -G), collide=False))  # fmt: skip
    assert plain.world.laws is None
    assert "control loads" not in names(zero)
    assert zero.world.laws is None
    plain.to(1.0, 0.1), zero.to(1.0, 0.1)
    for name in STATE:
        assert np.array_equal(getattr(plain.state, name), getattr(zero.state, name)), name


def test_a_sinusoid_without_amplitude_is_rest():
    still = Scene(deck("imo(#)=3, iob(#)=#, rsh(#)=0.1, " + "".join(
        f"i{n}pre(#)=1, {n}amp(#)=0.0, {n}fre(#)=1.0," for n in ("u", "omx", "omy")), collide=False))  # fmt: skip
    still.to(1.0, 0.3)
    np.testing.assert_array_equal(still.p, 0.0)
    np.testing.assert_array_equal(still.q, [[1, 0, 0, 0]])


def test_collisions_that_cannot_happen_are_absent():
    """iclid=0, and iclid=1 with every side open and one body: no stage, no arrays for it."""
    for s in (Scene(deck(ball((0, 0, 0)), collide=False)), Scene(deck(ball((0, 0, 0)))),
              Scene(deck(ball((0, 0, 0), more="iclidob(#,#)=0,"), sides=(2,) * 6))):  # fmt: skip
        assert s.model.contacts is None and s.world.collisions is None
        assert [name for name, _ in s.world.stages] == ["motion"]
        assert s.first_row.contact_force is None
