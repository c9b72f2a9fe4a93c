"""Prints what dry scenes cost: python tests/cost/bench.py. No test; numbers depend on the machine."""

import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "helpers"))


def flying(steps, collide, n=200):
    """n free spheres, 10 diameters apart; seconds per step. collide: every step looks for impacts, and finds few."""
    from flowgmo_scenes import WALLS, Scene, ball, deck

    rng = np.random.default_rng(0)
    places = [2.0 * np.array([k // 36, k // 6 % 6, k % 6]) - 5.0 for k in range(n)]
    balls = [ball(x, 0.1, rng.normal(size=3)) for x in places]
    s = Scene(deck(*balls, lo=(-9,) * 3, hi=(9,) * 3, sides=WALLS, collide=collide))
    s.to(1e-3)
    began = time.perf_counter()
    s.to(1.0, 1.0 / steps)
    return (time.perf_counter() - began) / steps


def colliding(n, seconds):
    """n elastic balls in a closed box; seconds per impact, and how many."""
    from flowgmo_scenes import WALLS, Scene, ball, deck

    rng = np.random.default_rng(0)
    side = int(np.ceil(n ** (1 / 3)))
    places = [np.array([k // side**2, k // side % side, k % side]) - (side - 1) / 2 for k in range(n)]
    balls = [ball(x, 0.3, rng.normal(size=3)) for x in places]
    s = Scene(deck(*balls, lo=(-side / 2,) * 3, hi=(side / 2,) * 3, sides=WALLS, e=1.0))
    s.to(0.01)
    s.impacts = np.zeros(0)
    began = time.perf_counter()
    s.to(seconds, 0.1)
    return (time.perf_counter() - began) / len(s.impacts), len(s.impacts)


def start_up(command):
    """Seconds of a command in a process of its own, kernels compiled."""
    from flowgmo_scenes import ball, deck

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "t.nml"
        path.write_text(deck(ball((0, 0, 0)), ball((1, 0, 0)), g=(0, 0, -1.0), sides=(2,) * 6, end=0.1))
        words = [sys.executable, "-m", "flowgmo.cli", command, str(path)] + (
            ["--overwrite"] if command == "run" else []
        )
        subprocess.run(words, capture_output=True, check=True)
        began = time.perf_counter()
        subprocess.run(words, capture_output=True, check=True)
        return time.perf_counter() - began


if __name__ == "__main__":
    steps = 10_000
    print(f"one free sphere, a step: {flying(steps, False, n=1) * 1e6:.0f} µs (check.py: STEP_OVERHEAD)")
    for collide in (False, True):
        each = flying(steps, collide)
        what = "collisions on" if collide else "no collisions"
        print(f"200 free spheres, {what}, {steps} steps: {each * steps:.2f} s, {each * 1e6:.0f} µs a step")
    for n in (10, 50, 200):
        cost, count = colliding(n, 3.0)
        print(f"{n} balls in a box: {cost * 1e9:.0f} ns an impact ({count} impacts)")
    for command in ("check", "run"):
        print(f"flowgmo {command}, later start: {start_up(command):.2f} s")
