"""Several balls one after another: chains with gaps, billiards, balls on hinges (VALIDATION C)."""

import numpy as np
import pytest
from flowgmo_scenes import Scene, ball, deck, on_axis
from scipy.special import ellipk

R = 0.1


@pytest.mark.parametrize("n, e", [(2, 0.3), (2, 1.0), (5, 0.3), (5, 0.8), (9, 0.8), (9, 1.0)])
def test_the_last_of_a_chain_with_gaps(n, e):
    """((1 + e)/2)^(n-1) when the first wave has passed, at Σ gap/v. Momentum 1. Measured: 3e-16 (bound 1e-10)."""
    balls = [ball((0.3 * k, 0, 0), v=(1.0 if k == 0 else 0.0, 0, 0)) for k in range(n)]
    passed = 0.1 * (((1 + e) / 2) ** -np.arange(n - 1.0)).sum()
    s = Scene(deck(*balls, lo=(-9, -9, -9), hi=(900, 9, 9), e=e)).to(passed * (1 + 1e-9))
    assert s.v[-1, 0] == pytest.approx(((1 + e) / 2) ** (n - 1), rel=1e-10)
    assert s.impacts["time"][s.impacts["b"] == n][0] == pytest.approx(passed, rel=1e-10)
    assert s.v[:, 0].sum() == pytest.approx(1.0, rel=1e-12)
    assert abs(s.remainder()) < 1e-10 * s.masses[0]


def after_cut(cut, e):
    """Velocities of cue and object ball, smooth, equal masses, cut angle in degrees."""
    angle = np.radians(cut)
    n = np.array([np.cos(angle), -np.sin(angle), 0])
    x = np.array([-2 * R * np.cos(angle) - 0.5, 2 * R * np.sin(angle), 0])
    s = Scene(deck(ball(x, v=(1, 0, 0)), ball((0, 0, 0)), e=e)).to(1.0)
    return s.v[0], s.v[1], n


@pytest.mark.parametrize("cut", [5.0, 30.0, 60.0, 85.0])
def test_billiard_balls_part_at_a_right_angle(cut):
    """Measured: 2e-13 degrees (bound 1e-3)."""
    cue, hit, n = after_cut(cut, 1.0)
    between = np.degrees(np.arccos(cue @ hit / np.linalg.norm(cue) / np.linalg.norm(hit)))
    assert between == pytest.approx(90.0, abs=1e-9)
    np.testing.assert_allclose(hit, np.cos(np.radians(cut)) * n, atol=1e-13)


def test_billiard_angle_with_a_loss():
    """e = .95, cut 30°: 87.5206° (VALIDATION C)."""
    cue, hit, _ = after_cut(30.0, 0.95)
    between = np.degrees(np.arccos(cue @ hit / np.linalg.norm(cue) / np.linalg.norm(hit)))
    assert between == pytest.approx(87.5206, abs=1e-3)


@pytest.mark.parametrize("e", [1.0, 0.6])
@pytest.mark.parametrize("dt", [0.01, 0.4])
def test_pendulum_bobs(e, dt):
    """A bob let go at 50° meets an equal one at rest at its lowest point; angular rates (1 ± e)/2 of it.

    Moments J about their axes, arms l to the line of contact: Ω² = 2 m g l (1 - cos 50°)/J.
    """
    moment, mass, arm, g = 0.35, 2.0, 0.4, 9.81
    angle = np.radians(50)
    moving = on_axis(moment, (0, 1, 0), mass, (-arm * np.sin(angle), 0, -arm * np.cos(angle)), (0, 0, 0), r=R)
    still = on_axis(moment, (0, 1, 0), mass, (2 * R, 0, -arm), (2 * R, 0, 0), r=R)
    s = Scene(deck(moving, still, g=(0, 0, -g), e=e))
    rate = np.sqrt(2 * mass * g * arm * (1 - np.cos(angle)) / moment)
    period = 2 * np.pi * np.sqrt(moment / (mass * g * arm))
    s.to(0.4 * period, dt)
    hit = s.impacts[0]
    assert len(s.impacts) == 1
    stretched = 0.25 * period * ellipk(np.sin(angle / 2) ** 2) / (np.pi / 2)
    assert hit["time"] == pytest.approx(stretched, rel=1e-9)
    gain = moment / arm * (1 + e) / 2 * rate
    np.testing.assert_allclose(hit["impulse"], [-gain, 0, 0], atol=1e-7 * gain)
    assert hit["energy_loss"] == pytest.approx(moment * rate**2 * (1 - e**2) / 4, abs=1e-8)
    assert abs(s.remainder()) < 1e-8
