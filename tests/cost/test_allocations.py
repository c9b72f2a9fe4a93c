"""What a step costs in memory and in work: counts, no times (bench.py prints times)."""

import tracemalloc

import numpy as np
from flowgmo_scenes import MIRRORS, WALLS, Scene, ball, deck


def many(n, collide, speed=1.0, **more):
    rng = np.random.default_rng(0)
    side = int(np.ceil(n ** (1 / 3)))
    places = [np.array([k // side**2, k // side % side, k % side]) - side / 2 for k in range(n)]
    balls = [ball(x, 0.3, speed * rng.normal(size=3), rng.normal(size=3)) for x in places]
    half = (side,) * 3
    return Scene(deck(*balls, lo=[-h for h in half], hi=half, collide=collide, **more))


def bytes_of_steps(s, steps=20):
    """Largest memory that one step held beyond what was there before it."""
    s.to(s.state.t + 0.02, 0.01)
    worst = 0
    tracemalloc.start()
    for _ in range(steps):
        before = tracemalloc.get_traced_memory()[0]
        tracemalloc.reset_peak()
        s.to(s.state.t + 0.01)
        worst = max(worst, tracemalloc.get_traced_memory()[1] - before)
    tracemalloc.stop()
    return worst


def test_bytes_of_a_step_of_200_flying_balls():
    """Measured: 0.07 MB without, 0.2 MB with collisions. Fails if rows, pairs or histories pile up in a step."""
    assert bytes_of_steps(many(200, collide=False)) < 300_000
    assert bytes_of_steps(many(200, collide=True, sides=WALLS)) < 600_000


def test_memory_does_not_grow_with_the_number_of_steps():
    """Measured: below 2 kB over 500 steps."""
    s = many(30, collide=True, sides=MIRRORS)
    s.to(0.5, 0.01)
    s.impacts = np.zeros(0)
    tracemalloc.start()
    for _ in range(500):
        s.to(s.state.t + 0.01)
        s.impacts = np.zeros(0)
    grown = tracemalloc.get_traced_memory()[0]
    tracemalloc.stop()
    assert grown < 50_000


def test_a_scene_without_an_effect_has_no_stage_for_it():
    flying = many(5, collide=False)
    assert [name for name, _ in flying.world.stages] == ["motion"] and flying.world.laws is None
    hitting = many(5, collide=True, sides=WALLS)
    assert [name for name, _ in hitting.world.stages] == ["collisions"]
