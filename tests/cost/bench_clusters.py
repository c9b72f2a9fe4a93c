"""Several contacts at once: what they cost, and what that buys: python tests/cost/bench_clusters.py. No test.

First the two treatments of the deck on the same clusters: multiple='simultaneous' (clusters.py, Hertz) and 'sequential'
(sequential.py). Then the step of the simultaneous one: cost and error of h ω = 0.2 … 0.03, against 0.005.
"""

import time

import numpy as np
from tables import best_of, row, title

import cluster_scenes as scenes  # isort: skip (tables adds its folder)
from flowgmo.collision.laws import FRACTION  # isort: skip
from flowgmo.collision.sequential import AT_REST, TURNS  # isort: skip
from flowgmo.collision.together import strike_in_turn, strike_together  # isort: skip
from flowgmo.kernel import kernel  # isort: skip

HERTZ = 1.5


@kernel
def nothing(contacts, responses, twists, eta, fraction):
    """What calling a kernel from Python costs: taken off."""
    return contacts.shape[0]


def seconds(scene, fraction, call=strike_together):
    """The fastest of several calls, and the velocities after it."""
    best = np.inf
    for _ in range(5):
        contacts, responses, twists = (part.copy() for part in scene)
        best = min(best, best_of(1, call, contacts, responses, twists, HERTZ, fraction))
    return best, np.concatenate([twists["v"], twists["w"]])


def in_turn(contacts, responses, twists, eta, fraction):
    strike_in_turn(contacts, responses, twists, AT_REST, TURNS)


def lost(scene, call):
    """Energy that the contacts lose."""
    contacts, responses, twists = (part.copy() for part in scene)
    call(contacts, responses, twists, HERTZ, FRACTION)
    return contacts["loss"].sum()


def renumbered(scene, call):
    """Largest change of a velocity when the contacts come in the opposite order: zero for a law without an order."""
    contacts, responses, twists = scene
    _, one = seconds(scene, FRACTION, call)
    _, other = seconds((contacts[::-1].copy(), responses, twists), FRACTION, call)
    return np.abs(one - other).max()


def treatments():
    """Both treatments of three clusters: velocities, energy, dependence on the order, cost."""
    three, rack = scenes.row(3), scenes.rack()
    flat, rough = scenes.box(0.5), scenes.box(0.5, 0.3, v=(0.1, 0.2, -1.0), w=(0.3, 0, 1))
    shown = {
        "three balls, e 1: v1 v2 v3": (three, lambda y: y[:3, 0]),
        "rack of 15: corner, middle, cue": (rack, lambda y: (np.linalg.norm(y[11]), np.linalg.norm(y[13]), y[0, 0])),
        "flat box, e .5: v, ω along, across": (flat, lambda y: (y[0, 2], y[2, 0], y[2, 1])),
        "turning box, mu .3: v, ω, ω": (rough, lambda y: (y[0, 2], y[2, 0], y[2, 1])),
    }
    title("clusters: all contacts together (Hertz) or in turn; [m/s, 1/s]; order: change when contacts are renumbered")
    row("", "contacts", "", "", "", "lost", "order", "µs", width=48)
    for name, (scene, pick) in shown.items():
        for label, call in (("together", strike_together), ("in turn", in_turn)):
            seconds(scene, FRACTION, call)
            call_alone, _ = seconds(scene, FRACTION, nothing)
            cost, end = seconds(scene, FRACTION, call)
            cells = [f"{x:.6f}" for x in pick(end)]
            cost = f"{(cost - call_alone) * 1e6:.1f}"
            row(f"{name}  {label}", len(scene[0]), *cells, f"{lost(scene, call):.1e}", f"{renumbered(scene, call):.0e}",
                cost, width=48)  # fmt: skip
    print("reference, Hertz: three balls -.070952 .076403 .994549; rack 5.596908 2.633651 -1.792493; flat box .5 0 0")


SCENES = {
    "4 balls in a row, 3 contacts": scenes.row(4),
    "rack, 31 contacts": scenes.rack(),
    "box on 4 corners": scenes.box(0.5),
    "box on 4 rough corners": scenes.box(0.5, 0.3, v=(0.1, 0.2, -1.0), w=(0.3, 0, 1)),
    "domino, 8 rough contacts": scenes.domino(),
    "domino, e = 0": scenes.domino(0.0),
    "plate, 100 contacts": scenes.plate(100, 0.5, 0.0),
    "plate, 100 rough contacts": scenes.plate(100, 0.5, 0.3),
    "pile of 125 balls, 325 contacts": scenes.pile(5, 0.5, 0.0),
    "the same, rough": scenes.pile(5, 0.5, 0.3),
    "pile of 64 balls, e = 0": scenes.pile(4, 0.0, 0.0),
    "tower of 11 cubes, 45 rough contacts": scenes.tower(11, 0.5, 0.5),
    "the same, e = 0": scenes.tower(11, 0.0, 0.5),
}


def steps():
    """Cost and error of the step of the springs."""
    title("clusters: step of the springs, h ω; error against 0.005, of the largest velocity")
    row("", *(x for f in (0.2, 0.1, 0.05, 0.03) for x in (f"µs at {f}", "error")), width=38)
    for name, scene in SCENES.items():
        call, _ = seconds(scene, 0.03, nothing)
        _, exact = seconds(scene, 0.005)
        cells = []
        for fraction in (0.2, 0.1, 0.05, 0.03):
            cost, end = seconds(scene, fraction)
            cells += [f"{(cost - call) * 1e6:.0f}", f"{abs(end - exact).max() / abs(exact).max():.0e}"]
        row(name, *cells, width=38)


if __name__ == "__main__":
    began = time.perf_counter()
    seconds(SCENES["box on 4 corners"], 0.03)
    print(f"compilation, or the cache: {time.perf_counter() - began:.1f} s")
    treatments()
    steps()
