"""decks/top: the free asymmetric top against Jacobi's functions."""

import numpy as np
from scipy.special import ellipj, ellipkinc

MOMENTS = np.array([1.0, 2.0, 3.0])


def exact_spin(t):
    """Angular velocity in body axes (n, 3): Landau & Lifshitz, Mechanics, par. 37, w0 = (.01, 1, .01)."""
    w0 = np.array([0.01, 1.0, 0.01])
    (a, b, c), energy, momentum = MOMENTS, MOMENTS @ w0**2, MOMENTS**2 @ w0**2
    rate = np.sqrt((c - b) * (momentum - energy * a) / (a * b * c))
    m = (b - a) * (energy * c - momentum) / ((c - b) * (momentum - energy * a))
    size = np.sqrt([
        (energy * c - momentum) / (a * (c - a)),
        (energy * c - momentum) / (b * (c - b)),
        (momentum - energy * a) / (c * (c - a)),
    ])  # fmt: skip
    sn, cn, dn, _ = ellipj(ellipkinc(np.arctan2(w0[1] / size[1], w0[0] / size[0]), m) + rate * t, m)
    return np.stack([cn, sn, dn], axis=1) * size


def test_period_and_invariants(runs):
    # Measured: period 2.5e-11 s, energy 2e-14, momentum 1e-14. 1e-6 and 1e-10 would reveal an integrator in place of
    # the closed form, or one that leaks.
    bounds = {"period": 1e-6, "change of energy": 1e-10, "change of angular momentum": 1e-10}
    runs.agree("top", "top", bounds | {"w2 at a quarter": 1e-8, "w2 at a half": 1e-8})


def test_whole_curve(runs):
    # Measured: 5e-11 over three periods. Would reveal a wrong branch where the top turns over.
    curves = runs.curves("top", "top")
    plate = curves.bodies["plate"]
    w = runs.measure.body_axes(plate["orientation"], plate["angular_velocity"])
    assert np.abs(w - exact_spin(curves.time)).max() <= 1e-9


def test_angular_momentum_keeps_its_direction(runs):
    # Measured: 2e-14 of 2.0. Orientation and spin belong together: a wrong attitude with a right spin would show here.
    plate = runs.curves("top", "top").bodies["plate"]
    q, w = plate["orientation"], plate["angular_velocity"]
    momentum = runs.measure.body_axes(q * [1.0, -1.0, -1.0, -1.0], runs.measure.body_axes(q, w) * MOMENTS)
    assert np.abs(momentum - momentum[0]).max() <= 1e-10
