"""Parts of the collision search and of the impact: distance to a box, safe steps, crossings, the closed form."""

import numpy as np
import pytest
from numba import njit

from flowgmo.bodies.stops import first_crossing
from flowgmo.collision.balls.distance import box_distance
from flowgmo.collision.balls.scene import FLAT
from flowgmo.collision.balls.search import safe_step
from flowgmo.collision.impact_exact import ball_impact


@njit
def distance(x, flats):
    return box_distance(x, flats[0])


@njit
def step_and_crossing(d, speed, bound):
    return safe_step(d, speed, bound), first_crossing(d, -speed, bound)


@njit
def impact(v, n, e, mu, kn, kt):
    return ball_impact(v, n, e, mu, kn, kt)


def flat(axes, lo, hi, origin=(0.3, -0.2, 0.1)):
    flats = np.zeros(1, FLAT)
    flats["origin"], flats["axes"], flats["lo"], flats["hi"] = origin, axes, lo, hi
    return flats


def frame(rng):
    q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return np.ascontiguousarray(q * np.sign(np.linalg.det(q)))


@pytest.mark.parametrize("seed", range(40))
def test_distance_to_a_box_is_that_to_its_nearest_point(seed):
    """Outside against the clamped point; the gradient is the unit vector to it. Measured: 9e-16."""
    rng = np.random.default_rng(seed)
    axes, lo, hi = frame(rng), -rng.uniform(0.1, 1, 3), rng.uniform(0.1, 1, 3)
    flats = flat(axes, lo, hi)
    local = rng.uniform(-2, 2, 3)
    x = flats["origin"][0] + axes.T @ local
    d, n, place = distance(tuple(x), flats)
    nearest = np.clip(local, lo, hi)
    outside = np.linalg.norm(local - nearest)
    if outside > 0:
        assert d == pytest.approx(outside, rel=1e-13)
        np.testing.assert_allclose(n, axes.T @ (local - nearest) / outside, atol=1e-12)
        assert place == int(((local > hi) | (local < lo)).sum())
    else:
        assert d == pytest.approx(-min((hi - local).min(), (local - lo).min()), rel=1e-12)
        assert place == 1


def test_a_half_space_has_no_edges():
    lo, hi = np.array([-np.inf, -np.inf, -np.inf]), np.array([np.inf, np.inf, 0.5])
    d, n, place = distance((1e6, -1e6, 2.0), flat(np.eye(3), lo, hi, (0, 0, 0)))
    assert (d, place) == (1.5, 1) and n == (0.0, 0.0, 1.0)


@pytest.mark.parametrize("seed", range(20))
def test_a_safe_step_is_the_first_root(seed):
    """d + s τ - A τ²/2 is not negative before it, and zero there. Small bounds do not cancel."""
    rng = np.random.default_rng(seed)
    d, speed, bound = rng.uniform(0, 2), rng.normal(), 10.0 ** rng.uniform(-14, 2)
    tau, _ = step_and_crossing(d, speed, bound)
    before = np.linspace(0, tau, 50)[:-1]
    assert np.all(d + speed * before - bound * before**2 / 2 >= -1e-12)
    if tau < 1e6:
        assert d + speed * tau - bound * tau**2 / 2 == pytest.approx(0.0, abs=1e-9 * (1 + abs(speed) * tau))


def test_safe_steps_without_a_bound():
    assert step_and_crossing(2.0, -0.5, 0.0)[0] == 4.0
    assert step_and_crossing(2.0, 0.5, 0.0)[0] == np.inf


@pytest.mark.parametrize("seed", range(200))
def test_an_impact_obeys_the_laws(seed):
    """Any e, μ, K of balls: rebound e |v3|, |Jt| <= μ Jn, slip never reversed, the loss is that of the work,
    ½ (v⁺ + v⁻)·J <= 0."""
    rng = np.random.default_rng(seed)
    n = rng.normal(size=3)
    n /= np.linalg.norm(n)
    v = rng.normal(size=3)
    v -= (v @ n + abs(rng.normal())) * n
    e, mu = rng.choice([0.0, 1.0, rng.uniform()]), rng.choice([0.0, rng.uniform(), 10.0])
    kn = 10.0 ** rng.uniform(-6, 6)
    kt = kn * rng.uniform(1, 3.5)
    j, regime, loss = impact(tuple(v), tuple(n), e, mu, kn, kt)
    j = np.array(j)
    jn, jt = j @ n, j - (j @ n) * n
    after = v + kn * jn * n + kt * jt
    slip, slip_after = v - (v @ n) * n, after - (after @ n) * n
    assert after @ n == pytest.approx(-e * (v @ n), abs=1e-12)
    assert np.linalg.norm(jt) <= mu * jn + 1e-15 * np.linalg.norm(j) * 10
    assert slip_after @ slip >= -1e-12
    assert regime == (1 if mu > 0 and np.linalg.norm(slip_after) < 1e-12 * np.linalg.norm(slip) else 0)
    work = 0.5 * (v + after) @ j
    assert work <= 1e-12 * (v @ n) ** 2 / kn
    assert loss == pytest.approx(-work, abs=1e-12 * (v @ v) / kn)
