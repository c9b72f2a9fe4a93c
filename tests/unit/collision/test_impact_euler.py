"""The report's fixed steps: first order towards the exact impact, and never endless."""

import numpy as np
from flowgmo_impacts import box_corners, collide, collide_many, euler

from flowgmo.collision.impact_exact import HELD, RESOLVED, RIGID


def boxes(n, seed):
    rng = np.random.default_rng(seed)
    v = rng.normal(size=(n, 3))
    v[:, 2] = -np.abs(v[:, 2])
    return box_corners(rng, n), v, np.full(n, 0.846), 10 ** rng.uniform(-1.0, 0.0, size=n)


def test_first_order_towards_the_exact_impact():
    """Ten times finer steps, ten times smaller error. Median of 300 boxes, relative to |v|, measured at dpfrac .1, .01,
    .001, .0001: 3.7e-2, 3.5e-3, 4.0e-4, 3.6e-5."""
    K, v, e, mu = boxes(300, 1)
    exact = collide_many(K, v, e, mu)[0]
    errors = []
    for dpfrac in (0.1, 0.01, 0.001, 0.0001):
        after, j, _, _, status = collide_many(K, v, e, mu, dpfrac)
        assert np.all(status == RESOLVED)
        assert np.all(np.hypot(j[:, 0], j[:, 1]) <= mu * j[:, 2] * (1 + 1e-12))
        errors.append(np.median(np.linalg.norm(after - exact, axis=1) / np.linalg.norm(v, axis=1)))
    assert 0.002 < errors[1] < 0.02
    for coarse, fine in zip(errors[:-1], errors[1:], strict=True):
        assert 5.0 < coarse / fine < 20.0


def test_it_returns_too_much_energy():
    """It ends beyond the work law, by up to a step: 68 % of 300 boxes lose less than in the exact impact."""
    K, v, e, mu = boxes(300, 2)
    exact = collide_many(K, v, e, mu)[3]
    steps = collide_many(K, v, e, mu, 0.01)[3]
    assert np.mean(steps < exact) > 0.6


def test_guards():
    """No approach, nothing that gives way, no friction, a locked rod, a slip of zero, jams; each ends, no nan."""
    K = np.diag([1.0, 1.0, 2.0])
    assert not collide(K, (1, 0, 0.0), 0.5, 0.3, euler, 0.01)[1].any()
    assert collide(np.diag([1.0, 1.0, 0.0]), (1, 0, -1), 0.5, 0.3, euler, 0.01)[4] == RIGID
    after, j, _, _, status = collide(K, (1, 0, -1), 0.5, 0.0, euler, 0.01)
    assert abs(after[2] - 0.5) < 0.03 and j[0] == 0.0 and status == RESOLVED
    after = collide(K, (0, 0, -1), 0.5, 0.3, euler, 0.01)[0]
    assert after[0] == after[1] == 0.0
    u = np.array([1, 0, 1]) / np.sqrt(2)
    after, _, _, _, status = collide(3 * (np.eye(3) - np.outer(u, u)), (1, 0.6, -1), 0.5, 1.2, euler, 0.001)
    assert np.linalg.norm(after) < 0.02 and status == RESOLVED
    c = np.array([-1.0, 0.0, 0.5])
    after, j, _, _, status = collide(np.outer(c, c), (0.1, 0, -1), 0.5, 3.0, euler, 0.001)
    assert status == HELD and np.all(np.isfinite(j))


def test_never_endless():
    """All bonds, any e and μ: it ends and stays finite, and what it did not finish it reports."""
    rng = np.random.default_rng(3)
    for bond in ("free", "point", "axis"):
        n = 1000
        K = box_corners(rng, n, bond, spread=1.0)
        v = np.einsum("nij,nj->ni", K, rng.normal(size=(n, 3)))
        v *= -np.sign(v[:, 2:])
        e, mu = rng.uniform(size=n), 10 ** rng.uniform(-2, 2, size=n)
        after, _, _, _, status = collide_many(K, v, e, mu, 0.02)
        assert np.all(np.isfinite(after))
        assert np.mean(status == RESOLVED) > 0.9
