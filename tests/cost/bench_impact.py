"""What one impact costs and how exact it is: python tests/cost/bench_impact.py. No test; times depend on the machine.

300 random free boxes hit at a corner. Errors of the velocities after it against the exact impact, relative to |v|
before; energy: what steps give back too much, relative to ½ v3²/K33.
"""

import numpy as np
from tables import best_of, row, title

from flowgmo_impacts import box_corners, collide_many, euler_many, exact_many, six  # isort: skip (tables adds its folder)

BOXES = 300


def boxes(seed=0):
    """K, v, e, mu of the 300."""
    rng = np.random.default_rng(seed)
    v = rng.normal(size=(BOXES, 3))
    v[:, 2] = -np.abs(v[:, 2])
    return box_corners(rng, BOXES), v, rng.uniform(size=BOXES), 10 ** rng.uniform(-1, 0, size=BOXES)


def nanoseconds(law, K, v, e, mu, *more):
    """Per impact, the best of five passes over the table."""
    return 1e9 * best_of(5, law, six(K), v, e, mu, *more, np.empty((len(K), 6))) / len(K)


def same(K, v, mu):
    """The table for one kind of impact, repeated."""
    n = 3000
    return np.tile(K, (n, 1, 1)), np.tile(np.array(v, dtype=float), (n, 1)), np.full(n, 0.5), np.full(n, mu)


def steps_against_exact(table):
    K, v, _, _ = table
    after, _, _, loss, _ = collide_many(*table)
    title(
        f"impact: {BOXES} random boxes, corner on a floor, e 0 .. 1, mu .1 .. 1\nerror in |v| before; energy given back"
    )
    row("", "ns", "error", "largest", "energy", "largest", "too much in")
    row("exact", f"{nanoseconds(exact_many, *table):.0f}", "0", "0", "0", "0", "0 %")
    for dpfrac in (1e-1, 1e-2, 1e-3, 1e-4):
        steps, _, _, lost, _ = collide_many(*table, dpfrac)
        error = np.linalg.norm(steps - after, axis=1) / np.linalg.norm(v, axis=1)
        gain = (loss - lost) / (0.5 * v[:, 2] ** 2 / K[:, 2, 2])
        cells = (f"{np.median(error):.1e}", f"{error.max():.1e}", f"{np.median(gain):.1e}", f"{gain.max():.1e}")
        cost = f"{nanoseconds(euler_many, *table, dpfrac):.0f}"
        row(f"euler, dpfrac {dpfrac:g}", cost, *cells, f"{np.mean(gain > 0):.0%}")


def kinds(table):
    title("exact impact by kind: the cheaper ones never enter the code of the others")
    plane = np.array([[2.5, 0, -1.5], [0, 4, 0], [-1.5, 0, 2.5]])
    row("", "ns")
    for name, kind in (
        ("frictionless", same(plane, (0.2, 0.1, -1), 0.0)),
        ("ball", same(np.diag([3.5, 3.5, 1.0]), (1, 0.5, -1), 0.2)),
        ("plane, slips", same(plane, (2, 0, -1), 0.3)),
        ("plane, reverses", same(plane, (0.2, 0, -1), 0.3)),
        ("plane, sticks", same(plane, (0.2, 0, -1), 0.7)),
        ("general, boxes", table),
    ):
        row(name, f"{nanoseconds(exact_many, *kind):.0f}")


if __name__ == "__main__":
    table = boxes()
    steps_against_exact(table)
    kinds(table)
