"""Lasting contact as a constraint or as micro-collisions: python tests/cost/bench_resting.py. No test; machines differ.

A ball and a box laid on the floor of the domain, e 0.5, mu 0.5, g 9.81, for half a second. Depth: how deep the lowest
point has sunk, of the body's half height, at the end and in the second half alone (it would go on); energy: ½ m v² +
m g z gained since the start, in m g R. The micro-collisions of the report lose height in every step.
"""

import numpy as np
from tables import row, timed, title

from flowgmo_scenes import Scene, ball, deck, matrix, number  # isort: skip (tables adds its folder)

G, R, END = 9.81, 0.1, 0.5
TREATMENTS = {
    "constraint": "multiple='sequential'",  # keeps the ball out of its closed form
    "micro": "resting='micro'",
    "micro, grid 40³": "resting='micro' search='grid'",
}


def box():
    limits = " ".join(f"{a}l(#)={number(-R)}, {a}h(#)={number(R)}," for a in "xyz")
    return f"imo(#)=4, rhomvb(#)=1000.0, iob(#)=#, {limits} trnz(#)={number(R)},"


def ball_depth(s):
    return max(0.0, R - s.p[0, 2]) / R


def box_depth(s):
    return max(0.0, R * np.abs(matrix(s.q[0])[2]).sum() - s.p[0, 2]) / R


def energy(s):
    m = s.masses[0]
    return (s.kinetic() / m + G * (s.p[0, 2] - R)) / (G * R)


def scene(body, knobs):
    here = {"lo": (-1, -1, 0), "hi": (1, 1, 2), "sides": (3, 3, 3, 3, 2, 3), "g": (0, 0, -G), "e": 0.5, "mu": 0.5}
    return Scene(deck(body, cells=40 if "grid" in knobs else 1, knobs=knobs, **here))


def measure(body, depth, knobs, dt):
    """Depth at the end, depth gained in the second half, energy gained, ms a step."""
    scene(body, knobs).to(3 * dt, dt)  # compiles, or loads
    s = scene(body, knobs)
    cost = timed(s.to, END / 2, dt)
    half = depth(s)
    cost += timed(s.to, END, dt)
    return depth(s), depth(s) - half, energy(s), 1e3 * cost / (END / dt)


if __name__ == "__main__":
    for name, body, depth in (("ball", ball((0, 0, R), R), ball_depth), ("box", box(), box_depth)):
        title(f"resting: a {name} laid on a floor for {END} s")
        row("", "dt [s]", "depth", "2nd half", "energy", "ms a step")
        for label, knobs in TREATMENTS.items():
            for dt in (1e-2, 1e-3, 1e-4):
                deep, more, gain, cost = measure(body, depth, knobs, dt)
                row(label, f"{dt:.0e}", f"{deep:.1e}", f"{more:.1e}", f"{gain:.1e}", f"{cost:.3f}")
