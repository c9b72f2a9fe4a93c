"""Many balls in a box with random e, μ, sizes and masses: what must hold whatever happens."""

import numpy as np
import pytest
from flowgmo_scenes import OPEN, WALLS, Scene, ball, deck

SIZE = 1.0


def packing(rng, n, rough, g, walls, least=0.5):
    """n balls of different size on a jittered grid, with velocities and spins; restitution from `least` to 1."""
    side = int(np.ceil(n ** (1 / 3)))
    cells = rng.permutation(side**3)[:n]
    pitch = 2 * SIZE / side
    bodies, radii = [], []
    for c in cells:
        r = rng.uniform(0.2, 0.42) * pitch
        place = np.array([c // side**2, c // side % side, c % side]) * pitch - SIZE + pitch / 2
        place = place + rng.uniform(-1, 1, 3) * (0.5 * pitch - r) * 0.99
        mu = float(rng.uniform(0, 1)) if rough else 0.0
        bodies.append(ball(place, r, rng.normal(size=3), rng.normal(size=3) * 3 / r, rho=10 ** rng.uniform(2, 3),
                           e=float(rng.choice([1.0, rng.uniform(least, 1.0)])), mu=mu))  # fmt: skip
        radii.append(r)
    sides = WALLS if walls else OPEN
    text = deck(*bodies, lo=(-SIZE,) * 3, hi=(SIZE,) * 3, sides=sides, g=g, e=0.9, mu=0.4 if rough else 0.0)
    return Scene(text), np.array(radii)


def overlap(s, radii):
    """Deepest overlap of two balls, in radii of the smaller one."""
    apart = np.linalg.norm(s.p[:, None] - s.p[None], axis=2) - radii[:, None] - radii
    np.fill_diagonal(apart, np.inf)
    return float((-apart / np.minimum(radii[:, None], radii)).max())


def check_impacts(impacts):
    n, j = impacts["normal"], impacts["impulse"]
    jn = np.einsum("ij,ij->i", n, j)
    jt = np.linalg.norm(j - jn[:, None] * n, axis=1)
    assert np.all(np.abs(np.linalg.norm(n, axis=1) - 1) < 1e-12)
    assert np.all(jn >= 0)
    assert np.all(jt <= impacts["mu"] * jn * (1 + 1e-9) + 1e-12 * jn)
    assert np.all(impacts["energy_loss"] >= -1e-12 * jn**2)


@pytest.mark.parametrize("seed", range(6))
def test_many_balls_in_a_box(seed):
    """No gravity. Overlap, energy books, the friction cone.

    Fails on a missed contact, an impulse outside the cone, a gain of energy, a NaN, or an endless cluster.
    """
    rng = np.random.default_rng(seed)
    s, radii = packing(rng, 25, rough=seed % 2 == 1, g=(0, 0, 0), walls=True)
    before = s.kinetic()
    for k in range(1, 9):
        s.to(0.25 * k)
        energy = s.kinetic()
        assert np.isfinite(s.p).all() and np.isfinite(s.q).all() and np.isfinite(s.w).all()
        assert energy <= before * (1 + 1e-12)
        assert overlap(s, radii) < 1e-9
        assert np.all(np.abs(s.p) + radii[:, None] <= SIZE * (1 + 1e-9))
        before = energy
    assert len(s.impacts) > 50
    assert np.all(np.diff(s.impacts["time"]) >= 0)
    assert abs(s.remainder()) < 1e-10 * s.world.energy_at_start
    check_impacts(s.impacts)


@pytest.mark.parametrize("seed", range(3))
def test_momentum_is_conserved_in_free_space(seed):
    """Momentum and angular momentum about the origin. Measured: 4e-15 of their sums of sizes."""
    rng = np.random.default_rng(100 + seed)
    s, radii = packing(rng, 25, rough=True, g=(0, 0, 0), walls=False)
    m = s.masses[:, None]
    s.state.v_WB -= 3.0 * s.p  # they fall towards each other

    def sums():
        turning = np.cross(s.p, m * s.v) + 0.4 * m * radii[:, None] ** 2 * s.w
        return (m * s.v).sum(axis=0), turning.sum(axis=0)

    linear, turning = sums()
    size = np.abs(m * s.v).sum()
    s.to(1.0, 0.2)
    assert len(s.impacts) > 10
    np.testing.assert_allclose(sums()[0], linear, atol=1e-12 * size)
    np.testing.assert_allclose(sums()[1], turning, atol=1e-12 * size)
    check_impacts(s.impacts)


@pytest.mark.parametrize("seed", range(6))
def test_with_any_restitution_it_goes_on(seed):
    """e from 0: three bodies may come together in ever more impacts in a finite time. It goes on, and never hangs."""
    rng = np.random.default_rng(300 + seed)
    s, radii = packing(rng, 25, rough=seed % 2 == 1, g=(0, 0, 0), walls=True, least=0.0)
    s.to(2.0, 0.05)
    assert overlap(s, radii) < 1e-9
    assert s.kinetic() <= s.world.energy_at_start * (1 + 1e-12)
    assert abs(s.remainder()) < 1e-10 * s.world.energy_at_start
    check_impacts(s.impacts)


@pytest.mark.parametrize("seed", range(4))
def test_under_gravity_nothing_overlaps(seed):
    """Balls fall and bounce on each other, with closed forms: the books close to round-off."""
    rng = np.random.default_rng(200 + seed)
    s, radii = packing(rng, 12, rough=False, g=(0, 0, -9.81), walls=True)
    for k in range(1, 41):
        s.to(0.02 * k)
        assert overlap(s, radii) < 1e-9
    assert abs(s.remainder()) < 1e-9 * max(s.world.energy_at_start, s.kinetic())
    check_impacts(s.impacts)


@pytest.mark.parametrize("seed", [1, 3])
def test_a_pile_settles(seed):
    """Rough balls that rest on each other, with the contact engine: 80 steps of .1 s.

    Overlaps: 6e-5 of the smaller radius (the engine keeps contacts within 1e-4 of their size). Books: 2e-5 of the
    energy of a fall through the box. What is left is rolling, .2 m/s, and spin about the normals, which nothing
    stops; with seed 3 the last ball falls from another at 6 s.
    """
    rng = np.random.default_rng(200 + seed)
    s, radii = packing(rng, 12, rough=True, g=(0, 0, -9.81), walls=True, least=0.1)
    for k in range(1, 81):
        s.to(0.1 * k)
        assert overlap(s, radii) < 1e-4
    assert s.state.general and np.isfinite(s.q).all()
    assert np.all(np.abs(s.p) + radii[:, None] <= SIZE * (1 + 1e-4))
    assert np.abs(s.v).max() < 0.3
    assert abs(s.remainder()) < 1e-4 * s.masses.sum() * 9.81 * SIZE
    check_impacts(s.impacts)
