"""What bodies are expected to do in a step (wet_foresight.py)."""

import numpy as np
import pytest

from flowgmo.bodies.arrays import POSE
from flowgmo.wet_foresight import expected_motion, next_rates

N = 3


def motion(v, w):
    out = np.zeros(N, POSE)
    out["v"], out["w"] = v, w
    return out


def steps(accelerations, dts, hit=None):
    """(motion at the end, rates) of bodies that go through steps with accelerations (k, n, 6); `hit`: (step, body) in
    which an impact changes a velocity."""
    rates, now = np.zeros((N, 2, 6)), motion(np.ones((N, 3)), np.zeros((N, 3)))
    which, reach = np.arange(N), np.full((N, 2), 10.0)
    for k, (a, dt) in enumerate(zip(accelerations, dts, strict=True)):
        U = np.hstack([now["v"], now["w"]]) + dt * a
        then = motion(U[:, :3], U[:, 3:])
        if hit is not None and hit[0] == k:
            then["v"][hit[1]] += 0.25
        rates, now = next_rates(rates, which, U, now, then, reach, dt), then
    return now, rates


def test_steady_acceleration_is_expected_to_go_on():
    """Also in a step of another length than those before it: to round-off where it will be, that is."""
    a = np.random.default_rng(5).normal(size=(N, 6))
    now, rates = steps([a, a], [0.01, 0.02])
    then = expected_motion(now, rates, np.array([0, 2]), 0.03)
    for body, share in ((0, 1.0), (1, 0.0), (2, 1.0)):  # the second is not asked for: contacts hold it
        gained = np.hstack([then["v"] - now["v"], then["w"] - now["w"]])[body]
        assert np.allclose(gained, share * 0.03 * a[body], rtol=1e-12, atol=1e-15)


def test_no_more_than_both_steps_say():
    """The lesser of two that agree, nothing where the load has turned, and nothing after one step."""
    a = np.ones((N, 6))
    for pair, gained in (((a, 3.0 * a), 1.0), ((3.0 * a, a), 1.0), ((a, -a), 0.0), ((0.0 * a, a), 0.0)):
        now, rates = steps(pair, [0.01, 0.01])
        then = expected_motion(now, rates, np.arange(N), 0.5)
        assert np.allclose(then["v"] - now["v"], 0.5 * gained, atol=1e-12)
    now, rates = steps([a], [0.01])
    assert np.array_equal(expected_motion(now, rates, np.arange(N), 0.5)["v"], now["v"])


@pytest.mark.parametrize("body", range(N))
def test_an_impact_says_nothing_of_the_next_steps(body):
    a = np.ones((N, 6))
    now, rates = steps([a, a, a], [0.01] * 3, hit=(1, body))
    then = expected_motion(now, rates, np.arange(N), 0.1)
    others = np.arange(N) != body
    assert np.array_equal(then["v"][body], now["v"][body])
    assert np.allclose((then["v"] - now["v"])[others], 0.1)
