"""What one impact costs and how exact it is: python tests/cost/bench_impact.py. No test; times depend on the machine.

300 random free boxes hit at a corner. Errors of the velocities after it against the exact impact, relative to |v|
before; energy: what steps give back too much, relative to ½ v3²/K33.
"""

import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "helpers"))
from flowgmo_impacts import box_corners, collide_many, euler_many, exact_many, six

BOXES = 300


def boxes(seed=0):
    """K, v, e, mu of the 300."""
    rng = np.random.default_rng(seed)
    v = rng.normal(size=(BOXES, 3))
    v[:, 2] = -np.abs(v[:, 2])
    return box_corners(rng, BOXES), v, rng.uniform(size=BOXES), 10 ** rng.uniform(-1, 0, size=BOXES)


def nanoseconds(law, K, v, e, mu, *more):
    """Per impact, the best of five passes over the table."""
    k, out = six(K), np.empty((len(K), 6))
    best = np.inf
    for _ in range(5):
        began = time.perf_counter()
        law(k, v, e, mu, *more, out)
        best = min(best, time.perf_counter() - began)
    return 1e9 * best / len(K)


def same(K, v, mu):
    """The table for one kind of impact, repeated."""
    n = 3000
    return np.tile(K, (n, 1, 1)), np.tile(np.array(v, dtype=float), (n, 1)), np.full(n, 0.5), np.full(n, mu)


if __name__ == "__main__":
    table = boxes()
    K, v, _, _ = table
    after, _, _, loss, _ = collide_many(*table)
    print(f"exact: {nanoseconds(exact_many, *table):.0f} ns an impact")
    for dpfrac in (1e-1, 1e-2, 1e-3, 1e-4):
        steps, _, _, lost, _ = collide_many(*table, dpfrac)
        error = np.linalg.norm(steps - after, axis=1) / np.linalg.norm(v, axis=1)
        gain = (loss - lost) / (0.5 * v[:, 2] ** 2 / K[:, 2, 2])
        print(
            f"dpfrac {dpfrac:g}: error median {np.median(error):.1e}, largest {error.max():.1e}; energy too high by "
            f"median {np.median(gain):.1e}, largest {gain.max():.1e}, in {np.mean(gain > 0):.0%}; "
            f"{nanoseconds(euler_many, *table, dpfrac):.0f} ns"
        )
    plane = np.array([[2.5, 0, -1.5], [0, 4, 0], [-1.5, 0, 2.5]])
    for name, kind in (
        ("frictionless", same(plane, (0.2, 0.1, -1), 0.0)),
        ("ball", same(np.diag([3.5, 3.5, 1.0]), (1, 0.5, -1), 0.2)),
        ("plane, slips", same(plane, (2, 0, -1), 0.3)),
        ("plane, reverses", same(plane, (0.2, 0, -1), 0.3)),
        ("plane, sticks", same(plane, (0.2, 0, -1), 0.7)),
        ("boxes, general", table),
    ):
        print(f"{name}: {nanoseconds(exact_many, *kind):.0f} ns")
