"""Steps full of impacts (collision/crowd.py): what must hold when their order is given up."""

import numpy as np
import pytest
from flowgmo_scenes import Scene, ball, deck

from flowgmo.collision import crowd

G, R, DT = 9.81, 0.05, 5e-3
SIDES = (2, 2, 2, 2, 2, 3)


def poured(n, layers, rng):
    """n x n x layers spheres over a floor between four walls, a fifth of a diameter apart, with noise, at 1 m/s."""
    pitch = 2.4 * R
    at = [np.array([i, j, k]) for k in range(layers) for j in range(n) for i in range(n)]
    balls = [ball(pitch * (x + 0.5) + 0.15 * R * rng.uniform(-1, 1, 3), R, (0, 0, -1.0)) for x in at]
    hi = (n * pitch, n * pitch, pitch * (layers + 3))
    return Scene(deck(*balls, lo=(0, 0, 0), hi=hi, sides=SIDES, g=(0, 0, -G), e=0.3, mu=0.3))


def overlap(s):
    """Deepest overlap of two spheres, or of one and the floor [R]."""
    apart = np.linalg.norm(s.p[:, None] - s.p[None], axis=2)
    np.fill_diagonal(apart, np.inf)
    return max(2.0 - apart.min() / R, 1.0 - s.p[:, 2].min() / R)


@pytest.fixture
def soon(monkeypatch):
    """Few contacts make a crowd: 27 spheres, not 150."""
    monkeypatch.setattr(crowd, "MUCH", 60)


def test_a_crowd_keeps_the_laws(soon):
    """Energy falls, nothing sinks or leaves, books close; measured: overlap .024 R, no rise at all.

    Fails where what is left for later passes through, or where overlaps taken away add more than they are worth.
    """
    s = poured(3, 3, np.random.default_rng(0))
    weight = s.masses * G
    first = total = s.kinetic() + weight @ s.p[:, 2]
    busy, rise, deepest = 0, 0.0, 0.0
    for k in range(1, 121):
        s.to(k * DT)
        before, total = total, s.kinetic() + weight @ s.p[:, 2]
        rise = max(rise, total - before)
        busy += s.state.busy
        deepest = max(deepest, overlap(s))
        assert np.abs(s.remainder()) <= 1e-9 * first
    assert busy > 10
    assert deepest <= crowd.SHALLOW
    assert rise <= 1e-12 * first
    assert s.world.collisions.engine.crowd.later > 0
    assert (s.p[:, :2] > 0.9 * R).all() and (s.p[:, :2] < 3 * 2.4 * R - 0.9 * R).all()


def test_a_crowd_that_settles_returns_to_the_exact_way(soon):
    """Fails where what a busy step leaves open keeps the next one busy: heaps would tremble and never sleep."""
    s = poured(2, 3, np.random.default_rng(1))
    for k in range(1, 401):
        s.to(k * DT)
    assert not s.state.busy
    assert np.abs(s.v[:, 2]).max() <= 1e-6  # a ball may roll on for ever
    assert overlap(s) <= 1e-6
