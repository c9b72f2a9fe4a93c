"""The guards of the exact impact: what is singular, zero, locked, wedged, or far out of proportion."""

import math

import numpy as np
import pytest
from flowgmo_impacts import SLIP, STICK, about_normal, box_corners, collide, collide_many, near, rod

from flowgmo.collision.impact_exact import HELD, RESOLVED, RIGID


def test_no_impulse_without_approach():
    for v3 in (0.0, 0.3, np.nan):
        _, j, _, loss, status = collide(rod(45), (1.0, 0.2, v3), 0.5, 0.3)
        assert not j.any() and loss == 0.0 and status == RESOLVED


def test_nothing_can_give_way():
    """K33 = 0, also by round-off of a lever: reported, no impulse."""
    c = np.array([1.0, 0.5, 1e-17])
    for K in (np.zeros((3, 3)), np.diag([1.0, 1.0, 0.0]), np.outer(c, c)):
        _, j, _, loss, status = collide(K, (1, 0, -1), 0.5, 0.3)
        assert not j.any() and loss == 0.0 and status == RIGID


def test_a_driven_partner_presses_on_a_locked_side():
    """A fixed axis that a driven partner's motion does not fit: slip halts, approach remains; reported, finite."""
    c = np.array([-1.0, 0.0, 0.5])
    after, j, _, _, status = collide(np.outer(c, c), (0.1, 0, -1), 0.5, 3.0)
    assert status == HELD and np.all(np.isfinite(j)) and after[2] < 0.0
    K = box_corners(np.random.default_rng(13), 3000, "axis", spread=1.0)
    v = np.random.default_rng(14).normal(size=(3000, 3))
    v[:, 2] = -np.abs(v[:, 2])
    e, mu = np.full(3000, 0.5), 10 ** np.random.default_rng(15).uniform(-2, 2, size=3000)
    after, j, _, loss, status = collide_many(K, v, e, mu)
    assert set(status.tolist()) == {HELD, RESOLVED}
    assert np.all(np.isfinite(j)) and np.all(loss >= 0.0) and np.all(after[status == RESOLVED, 2] >= 0.0)
    assert np.all(np.linalg.norm(j, axis=1) * np.linalg.norm(K, axis=(1, 2)) < 1e12 * np.linalg.norm(v, axis=1))


def test_slender_rods_on_a_point():
    """K almost of rank one: slip halts or turns a thousand times slower than the series' time. Each ends, no gain.

    The bearing takes impulses up to 1e6 |v|/K, so v3 may end below zero by round-off of K J. Measured: 2e-14 |K| |J|.
    """
    rng = np.random.default_rng(16)
    K = box_corners(rng, 3000, "point", spread=3.0)
    v = np.einsum("nij,nj->ni", K, rng.normal(size=(3000, 3)))
    v *= -np.sign(v[:, 2:])
    after, j, _, loss, status = collide_many(K, v, rng.uniform(size=3000), 10 ** rng.uniform(-2, 2, size=3000))
    assert np.all(status == RESOLVED) and np.all(loss >= 0.0)
    speed = np.linalg.norm(v, axis=1) + np.linalg.norm(K, axis=(1, 2)) * np.linalg.norm(j, axis=1)
    assert np.all(after[:, 2] >= -1e-13 * speed)


def test_limits_of_restitution_and_friction():
    """e = 0 ends where v3 = 0; μ = 0 is Newton's e; a large μ differs from infinity as 1/μ (measured: 18/μ).

    Slip need not halt even there: friction may lift the contact before."""
    rng = np.random.default_rng(9)
    for K in box_corners(rng, 100):
        v = np.array([*rng.normal(size=2), -1.0])
        assert collide(K, v, 0.0, rng.uniform(0.01, 3))[0][2] == pytest.approx(0.0, abs=1e-14)
        after, j, regime, _, _ = collide(K, v, 0.7, 0.0)
        assert after[2] == pytest.approx(0.7, abs=1e-15) and j[0] == j[1] == 0.0 and regime == SLIP
        much = [collide(K, v, 0.7, mu)[0] for mu in (1e6, 1e9, 1e15, np.inf)]
        near(much[0], much[3], 30 / 1e6)
        near(much[1], much[3], 30 / 1e9)
        near(much[2], much[3], 1e-13)


def test_slip_that_is_zero_at_the_start():
    """It sticks or starts along the ray; so does the limit of small slips (a slip of s changes v by order s)."""
    rng = np.random.default_rng(10)
    modes = set()
    for K in box_corners(rng, 60):
        mu = rng.uniform(0.05, 1.0)
        after, _, regime, _, _ = collide(K, (0, 0, -1), 0.5, mu)
        modes.add(regime)
        for s in (1e-300, 1e-18, 1e-12, 1e-8):
            a = rng.uniform(0, 6)
            slow = collide(K, (s * math.cos(a), s * math.sin(a), -1), 0.5, mu)[0]
            near(slow, after, 1e-13 + 20 * s)
    assert modes == {SLIP, STICK}


def test_extreme_ratios_of_slip_and_approach():
    """Slip up to 1e100 times the approach, approach up to 1e250 times the slip: finite, inside the cone, no gain."""
    rng = np.random.default_rng(11)
    for K in box_corners(rng, 30):
        for s in (1e-250, 1e-30, 1e-10, 1e10, 1e30, 1e100):
            for mu in (0.2, 4.0):
                after, j, _, loss, status = collide(K, (s, -0.3 * s, -1), 0.5, mu)
                assert np.all(np.isfinite(after)) and status == RESOLVED
                assert np.hypot(j[0], j[1]) <= mu * j[2] * (1 + 1e-15) and loss >= 0.0
        assert np.all(np.isfinite(collide(K, (0, 1e-310, -2e-310), 0.5, 0.2)[0]))


def test_slip_that_starts_on_a_ray_stays_on_it():
    """Also on a ray that repels its neighbours, where round-off of a turned system would grow: against the two straight
    pieces by hand. Measured: 7e-16."""
    b, l1, l2, k3, mu, v1 = 0.35, 4.0, 1.0, 2.0, 0.5, 0.05
    K = np.array([[l1, 0.0, b], [0.0, l2, 0.0], [b, 0.0, k3]])
    g = b - mu * l1  # slip along +1 slows down; it turns by dh/dφ = -g - μ l2 > 0 times its deviation
    assert -g - mu * l2 > 1.0
    r1, r2, p1 = k3 - mu * b, k3 - b * b / l1, -v1 / g  # slip to its halt at p1, then stick: μ̄ = b/l1
    v3 = -1 + r1 * p1
    work = -p1 + r1 * p1**2 / 2 - v3**2 / (2 * r2)
    for angle in np.linspace(0.0, 6.0, 25):
        Q = about_normal(angle)
        after, _, regime, _, _ = collide(Q @ K @ Q.T, Q @ [v1, 0, -1], 0.5, mu)
        near(Q.T @ after, [0, 0, math.sqrt(-2 * r2 * 0.25 * work)], 1e-14)
        assert regime == STICK
