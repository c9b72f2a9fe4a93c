"""Spheres in a box: cost of a step against touching pairs: python tests/cost/bench_pour.py. No test.

50, 150, 500 equal spheres of radius 5 cm, e 0.3, mu 0.3, in a shaft (walls of the domain), steps of 5 ms: packed, in a
cubic lattice in which all neighbours touch and nothing moves, the cost of lasting contacts alone; and poured, from a
lattice with noise, where impacts cost most. All together gets two minutes; what was not reached is not measured, and a
line says so.
"""

import time

import numpy as np
from tables import row, timed, title

from flowgmo_scenes import Scene, ball, deck  # isort: skip (tables adds its folder)

G, R, DT, END = 9.81, 0.05, 5e-3, 1.5
SECONDS = {50: 25.0, 150: 25.0, 500: 25.0}  # of wall time: what one accepts to wait for a table
PACKED_STEPS = 20
PACKED_SECONDS = 12.0
EVERY = 10  # steps between two lines
SLOWEST = 3.0  # a step that takes longer [s] ends the table: the next one may take a minute


def packed(n):
    """All touch their neighbours, the floor and the walls of the lowest layer's shaft."""
    side = int(round(n ** (1 / 3)))
    balls = [ball(2 * R * np.array([k % side + 0.5, k // side % side + 0.5, k // side**2 + 0.5]), R) for k in range(n)]
    width, high = 2 * R * side, 2 * R * (n // side**2 + 3)
    sides = (2, 2, 2, 2, 2, 3)
    return deck(*balls, lo=(0, 0, 0), hi=(width, width, high), sides=sides, g=(0, 0, -G), e=0.3, mu=0.3)


def poured(n):
    """The shaft is as wide as the lattice, n^(1/3) spheres: heaps are about as high as wide."""
    rng = np.random.default_rng(0)
    side = int(round(n ** (1 / 3)))
    pitch = 2.4 * R
    width = side * pitch
    at = [np.array([k % side, k // side % side, k // side**2]) for k in range(n)]
    balls = [ball(pitch * (x + 0.5) + 0.15 * R * rng.uniform(-1, 1, 3), R, (0, 0, -1.0)) for x in at]
    high = pitch * (n // side**2 + 3)
    sides = (2, 2, 2, 2, 2, 3)
    return deck(*balls, lo=(0, 0, 0), hi=(width, width, high), sides=sides, g=(0, 0, -G), e=0.3, mu=0.3)


def touching_pairs(s):
    """Pairs of parties in lasting contact."""
    return len(np.unique(s.state.held_parts[:, :2], axis=0))


def rest(n):
    s = Scene(packed(n))
    first = timed(s.to, DT)
    began, steps = time.perf_counter(), 0
    while steps < PACKED_STEPS and time.perf_counter() - began < PACKED_SECONDS:
        s.to(s.state.t + DT)
        steps += 1
    cost = 1e3 * (time.perf_counter() - began) / steps
    fast = np.linalg.norm(s.v, axis=1).max()
    row(f"{n} spheres", touching_pairs(s), steps, f"{1e3 * first:.0f}", f"{cost:.1f}", f"{fast:.0e}", width=14)


def pour(n):
    s = Scene(poured(n))
    began, last = time.perf_counter(), 0.0
    while s.state.t < END - DT / 2 and time.perf_counter() - began < SECONDS[n] and last < SLOWEST:
        start, steps, hits = time.perf_counter(), 0, len(s.impacts)
        while steps < EVERY and time.perf_counter() - began < SECONDS[n] and last < SLOWEST:
            last = timed(s.to, s.state.t + DT)
            steps += 1
        cost = 1e3 * (time.perf_counter() - start) / steps
        pairs, overlap = touching_pairs(s), deepest(s, n)
        cells = (
            f"{s.state.t:.3f}",
            pairs,
            len(s.impacts) - hits,
            f"{cost:.1f}",
            f"{s.kinetic():.2e}",
            f"{overlap:.0e}",
        )
        row(f"{n} spheres", *cells, width=14)
    if s.state.t < END - DT / 2:
        why = f"a step took {last:.1f} s" if last >= SLOWEST else f"{SECONDS[n]:.0f} s of wall time were over"
        print(f"stopped at t = {s.state.t:.3f} s of {END} s: {why}")


def deepest(s, n):
    """Largest overlap of two spheres, in radii."""
    worst = 0.0
    for k in range(n - 1):
        apart = np.linalg.norm(s.p[k + 1 : n] - s.p[k], axis=1).min()
        worst = max(worst, (2 * R - apart) / R)
    return worst


if __name__ == "__main__":
    Scene(poured(8)).to(0.5, DT)  # compiles, or loads
    title(f"pour: spheres packed in a shaft at rest, dt = {DT} s")
    row("", "held pairs", "steps", "ms the 1st", "ms a step", "speed [m/s]", width=14)
    for n in SECONDS:
        rest(n)
    title(f"pour: spheres fall into a shaft, dt = {DT} s")
    row("", "t [s]", "held pairs", "impacts", "ms a step", "kinetic [J]", "overlap [R]", width=14)
    for n in SECONDS:
        pour(n)
