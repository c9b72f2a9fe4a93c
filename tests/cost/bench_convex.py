"""Prints what the search between two pieces costs: python tests/cost/bench_convex.py. No test; machines differ."""

import sys
import time
from itertools import combinations
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "helpers"))

from convex_pieces import NOTHING, bring_to, manifold, one_of_each, separate, two

from flowgmo.collision.contact import CONTACT
from flowgmo.collision.convex import separation
from flowgmo.collision.manifold import contact_points
from flowgmo.collision.shapes import place
from flowgmo.kernel import kernel


@kernel
def placed(pieces, poses, k, shift):
    a = poses[k]
    return place(pieces[k], (a[0] + shift, a[1], a[2]), (a[3], a[4], a[5], a[6]))


@kernel
def many_separations(pieces, vertices, poses, n0, times, shift):
    total = 0.0
    for k in range(times):
        one, two = placed(pieces, poses, 0, k * shift), placed(pieces, poses, 1, 0.0)
        total += separation(pieces, vertices, 0, one, 1, two, n0)[0]
    return total


@kernel
def many_manifolds(pieces, vertices, poses, n, times, out):
    total = 0
    for _ in range(times):
        one, two = placed(pieces, poses, 0, 0.0), placed(pieces, poses, 1, 0.0)
        total += contact_points(pieces, vertices, 0, one, 1, two, n, 1e-3, out)
    return total


def first_call(vertices):
    """CPU seconds of the first separation and the first contact points: compilation, if no kernels are stored."""
    kinds, _ = one_of_each(np.random.default_rng(0))
    pieces, poses = two(kinds["ball"], kinds["floor"], at=(0.1, 0.2, 0.5))
    began = time.process_time()
    separate(pieces, vertices, poses, 0, 1, NOTHING)
    middle = time.process_time()
    manifold(pieces, vertices, poses, 0, 1, (0.0, 0.0, 1.0), 1e-3, np.zeros(8, CONTACT))
    return middle - began, time.process_time() - middle


def cost(one, other, rng, times=2000):
    """Mean CPU ns of a placed pair: separation apart and cold, touching and warm, and its contact points."""
    kinds, vertices = one_of_each(np.random.default_rng(0))
    sums = np.zeros(3)
    for _ in range(5):
        pieces, poses = two(kinds[one], kinds[other], rng)
        n = bring_to(1e-4, pieces, vertices, poses, rng)
        many_separations(pieces, vertices, poses, n, 1, 0.0)
        many_manifolds(pieces, vertices, poses, n, 1, np.zeros(8, CONTACT))
        far = poses.copy()
        far[0, :3] += 2.0 * np.array(n)
        began = time.process_time()
        many_separations(pieces, vertices, far, NOTHING, times, 1e-13)
        a = time.process_time()
        many_separations(pieces, vertices, poses, n, times, 1e-13)
        b = time.process_time()
        many_manifolds(pieces, vertices, poses, n, times, np.zeros(8, CONTACT))
        sums += np.array([a - began, b - a, time.process_time() - b]) / times / 5 * 1e9
    return sums


if __name__ == "__main__":
    vertices = one_of_each(np.random.default_rng(0))[1]
    for name, given in (("balls and half spaces (no vertices)", None), ("all pieces", vertices)):
        separating, pointing = first_call(given)
        print(f"first calls, {name}: separation {separating:.2f} s, contact points {pointing:.2f} s")
    rng = np.random.default_rng(1)
    names = ("ball", "box", "brick", "cylinder", "can", "cone", "egg", "lens", "rock", "triangle", "floor")
    print("ns: apart and cold, touching and warm, contact points")
    for one, other in [("ball", "floor"), *(p for p in combinations(names, 2) if p != ("ball", "floor"))]:
        print(f"  {one:9s} {other:9s}" + "".join(f"{x:8.0f}" for x in cost(one, other, rng)))
