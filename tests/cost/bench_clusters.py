"""Prints what clusters cost, and what error that buys: python tests/cost/bench_clusters.py. No test."""

import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "helpers"))

import cluster_scenes as scenes

from flowgmo.collision.clusters import resolve
from flowgmo.kernel import kernel


@kernel
def run(contacts, responses, twists, eta, fraction):
    return resolve(contacts, responses, twists, eta, fraction)


@kernel
def nothing(contacts, responses, twists, eta, fraction):
    """What calling a kernel from Python costs: taken off."""
    return contacts.shape[0]


def seconds(scene, fraction, call=run):
    """The fastest of several calls, and the velocities after it."""
    best = np.inf
    for _ in range(5):
        contacts, responses, twists = (part.copy() for part in scene)
        began = time.perf_counter()
        call(contacts, responses, twists, 1.5, fraction)
        best = min(best, time.perf_counter() - began)
    return best, np.concatenate([twists["v"], twists["w"]])


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
}

if __name__ == "__main__":
    began = time.perf_counter()
    seconds(SCENES["box on 4 corners"], 0.03)
    print(f"compilation, or the cache: {time.perf_counter() - began:.1f} s")
    for name, scene in SCENES.items():
        call, _ = seconds(scene, 0.03, nothing)
        _, exact = seconds(scene, 0.005)
        line = f"{name:34s}"
        for fraction in (0.2, 0.1, 0.05, 0.03):
            cost, end = seconds(scene, fraction)
            error = abs(end - exact).max() / abs(exact).max()
            line += f"{(cost - call) * 1e6:9.0f} µs {error:7.0e}"
        print(line + "    h ω 0.2 0.1 0.05 0.03; error against 0.005")
