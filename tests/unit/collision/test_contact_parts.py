"""Parts of the contact solver: one contact alone, banded systems."""

import contact_scenes as cs
import numpy as np
import pytest

from flowgmo.collision.banded import factor, substitute
from flowgmo.collision.one_contact import solve_one
from flowgmo.kernel import kernel


@kernel
def one(kk, n, mu, v):
    return solve_one(kk, n, mu, v)


@kernel
def band_solution(a, n, reach, rows, ends, x):
    factor(a, n, reach, rows, ends)
    substitute(a, n, reach, rows, ends, x)


def random_one(rng):
    g = rng.normal(size=(3, rng.integers(1, 6)))
    n = rng.normal(size=3)
    return g @ g.T, n / np.linalg.norm(n), 10 ** rng.uniform(-2, 1), rng.normal(size=3)


def test_one_contact_alone_obeys_the_law():
    """Any K of rank 1 to 5 vectors, μ to 10, 3000 problems. Measured: 9e-11, where K is near
    singular. Fails if a root of the quartic is missed."""
    rng = np.random.default_rng(3)
    for _ in range(3000):
        k, n, mu, v = random_one(rng)
        p = np.array(one(tuple(cs.six(k)), tuple(n), mu, tuple(v)))
        if np.linalg.matrix_rank(k) < 3 and n @ v < 0 and np.linalg.norm(np.linalg.pinv(k) @ k @ v - v) > 1e-9:
            continue  # no impulse stops v there: only bounded work is asked for
        u = v + k @ p
        pn, un = p @ n, u @ n
        pt, ut = p - pn * n, u - un * n
        size = 1e-9 * max(1.0, np.linalg.norm(p))
        assert pn >= 0 and un >= -size and pn * un <= size
        assert np.linalg.norm(pt) <= mu * pn * (1 + 1e-12)
        assert abs(ut @ pt + mu * pn * np.linalg.norm(ut)) <= size


@pytest.mark.parametrize("n, reach, holes", [(1, 0, 0), (6, 5, 0), (30, 11, 0), (40, 39, 0), (40, 9, 0.7)])
def test_banded_systems(n, reach, holes):
    """Against numpy, with a diagonal that needs row exchanges, and rows that end before their band. Measured: 2e-13.

    Fails if an exchange or an elimination reaches beyond the end that it has noted for a row."""
    rng = np.random.default_rng(n)
    i, j = np.indices((n, n))
    m = np.where(np.abs(i - j) <= reach, rng.normal(size=(n, n)), 0.0)
    m[i == j] *= 1e-3
    m[(rng.uniform(size=(n, n)) < holes) & (i != j)] = 0.0
    a = np.zeros((n, 3 * reach + 1))
    near = np.abs(i - j) <= reach
    a[i[near], (j - i + reach)[near]] = m[near]
    x = rng.normal(size=n)
    expected = np.linalg.solve(m, x)
    band_solution(a, n, reach, np.empty(n, np.int64), np.where((m != 0.0) | (i == j), j, 0).max(axis=1), x)
    np.testing.assert_allclose(x, expected, rtol=1e-7, atol=1e-9 * np.abs(expected).max())
