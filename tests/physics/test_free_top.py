"""Torque-free rotation: exact at any step. Source: Landau & Lifshitz, Mechanics §37; solve_ivp as second opinion."""

import numpy as np
import pytest
from flowgmo_scenes import Scene, deck, matrix, rigid
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

PERIOD = 39.105734197288  # 4 K(m) / n of I = (1, 2, 3), ω = (.01, 1, .01): VALIDATION A
SLOW_SPIN = (0.01, 1.0, 0.01)


def top(inertia, w):
    return Scene(deck(rigid(inertia, w=w), collide=False))


def body_rates(s):
    return matrix(s.q[0]).T @ s.w[0]


def reference(inertia, w, t):
    """q, w (body axes) of Euler's equations, integrated to 1e-13."""
    inverse = np.linalg.inv(inertia)

    def rates(_, y):
        q, w = y[:4], y[4:]
        a, u = q[0], q[1:]
        dq = 0.5 * np.array([-u @ w, *(a * w + np.cross(u, w))])
        return [*dq, *(inverse @ -np.cross(w, inertia @ w))]

    y = solve_ivp(rates, (0, t), [1, 0, 0, 0, *w], method="DOP853", rtol=1e-13, atol=1e-14).y[:, -1]
    return y[:4] / np.linalg.norm(y[:4]), y[4:]


def random_tensor(rng):
    """A possible body's inertia tensor, with products of inertia."""
    points = rng.normal(size=(12, 3)) * rng.uniform(0.2, 2.0, 3)
    return sum(p @ p * np.eye(3) - np.outer(p, p) for p in points)


def test_the_period_of_the_asymmetric_top():
    """Measured: 5e-12 relative (bound of VALIDATION 1e-6). A wrong modulus or a wrong axis shifts it by per cents."""

    def middle(t):
        return body_rates(top(np.diag([1.0, 2.0, 3.0]), SLOW_SPIN).to(t))[1]

    down = brentq(middle, 0.15 * PERIOD, 0.35 * PERIOD, xtol=1e-11)
    again = brentq(middle, 1.15 * PERIOD, 1.35 * PERIOD, xtol=1e-11)
    assert again - down == pytest.approx(PERIOD, rel=1e-10)


def kept(steps_per_period, periods):
    inertia = np.diag([1.0, 2.0, 3.0])
    s = top(inertia, SLOW_SPIN)
    s.to(periods * PERIOD, PERIOD / steps_per_period)
    w = body_rates(s)
    energy = w @ inertia @ w / (np.array(SLOW_SPIN) @ inertia @ SLOW_SPIN) - 1
    momentum = matrix(s.q[0]) @ inertia @ w - inertia @ np.array(SLOW_SPIN)
    return abs(energy), np.abs(momentum).max() / 2.0, np.abs(w - SLOW_SPIN).max()


def test_energy_and_momentum_over_a_thousand_periods_in_one_step_each():
    """Bound 1e-10 of both. Fails if round-off of a step is biased."""
    energy, momentum, _ = kept(1, 1000)
    assert energy < 1e-10 and momentum < 1e-10


@pytest.mark.slow
def test_energy_and_momentum_over_a_thousand_periods_at_small_steps():
    energy, momentum, _ = kept(100, 1000)
    assert energy < 1e-10 and momentum < 1e-10


TENSORS = {
    "random": random_tensor(np.random.default_rng(1)),
    "products of inertia": random_tensor(np.random.default_rng(2)),
    "prolate": np.diag([1.0, 2.0, 2.0]),
    "oblate": np.diag([2.0, 2.0, 3.0]),
    "sphere": 2.0 * np.eye(3),
    "nearly symmetric": np.diag([2.0, 2.0 + 1e-9, 3.0]),
    "needle": np.diag([1e-4, 1.0, 1.0 + 1e-5]),
}


@pytest.mark.parametrize("name", TENSORS)
@pytest.mark.parametrize("dt", [0.05, 7.0])
def test_it_agrees_with_eulers_equations_integrated(name, dt):
    """Measured: 4e-11, the reference's own error. Covers every branch of the closed form."""
    inertia = TENSORS[name]
    w = np.random.default_rng(3).normal(size=3)
    s = top(inertia, w).to(7.0, dt)
    q, w_end = reference(inertia, w, 7.0)
    np.testing.assert_allclose(body_rates(s), w_end, atol=1e-9)
    np.testing.assert_allclose(matrix(s.q[0]), matrix(q), atol=1e-9)


@pytest.mark.parametrize("off", [0.0, 1e-12, -1e-12, 1e-6, -1e-6])
def test_near_the_separatrix(off):
    """A spin that ends on the unstable axis, or nearly: z = x/√3 on I = (1, 2, 3). Measured: 2e-13.

    Fails if the modulus near one loses its digits (m and 1 - m must be formed apart).
    """
    inertia = np.diag([1.0, 2.0, 3.0])
    w = np.array([0.3, 1.0, 0.3 / np.sqrt(3) + off])
    q, w_end = reference(inertia, w, 12.0)
    for dt in (12.0, 0.5):
        s = top(inertia, w).to(12.0, dt)
        np.testing.assert_allclose(body_rates(s), w_end, atol=3e-8)
        np.testing.assert_allclose(matrix(s.q[0]), matrix(q), atol=3e-8)


@pytest.mark.parametrize("axis", range(3))
def test_a_spin_about_a_principal_axis_stays(axis):
    """Exactly: an unstable axis must not be left by round-off of the closed form within 30 turns."""
    w = 2 * np.pi * np.eye(3)[axis]
    s = top(np.diag([1.0, 2.0, 3.0]), w).to(30.25, 0.25)
    np.testing.assert_allclose(s.w[0], w, atol=1e-12)
    turn = np.eye(3)[axis] * np.sin(np.pi * 30.25)
    np.testing.assert_allclose(np.abs(s.q[0][1:]), np.abs(turn), atol=1e-11)
