"""decks/pendulum: a hinge along y, one in any direction, and a stop of the angle."""

import numpy as np
import pytest


@pytest.mark.parametrize("deck", ["pendulum", "gate"])
def test_period(deck, runs):
    # Measured: 8e-15 s of 1.76 s and 3.01 s. 1e-5 would reveal the moment about the wrong axis, or, in the gate, the
    # part of gravity along the hinge acting.
    runs.agree("pendulum", deck, 1e-5)


@pytest.mark.parametrize("deck", ["pendulum", "gate"])
def test_hinge_holds(deck, runs):
    # Measured: 6e-16 m. The mass centre stays at its distance from the axis and in its plane.
    curves = runs.curves("pendulum", deck)
    body = curves.bodies["gate" if deck == "gate" else "rod"]
    lean, azimuth = np.radians([20.0, 30.0])
    axis = np.array([0.0, 1.0, 0.0])
    if deck == "gate":
        axis = np.array([np.sin(lean) * np.cos(azimuth), np.sin(lean) * np.sin(azimuth), np.cos(lean)])
    along = body["position"] @ axis
    away = np.linalg.norm(body["position"] - along[:, None] * axis, axis=1)
    assert np.abs(along - along[0]).max() <= 1e-12
    assert np.abs(away - 0.5).max() <= 1e-12


def test_stop(runs):
    # Measured: 6e-17 s, 2e-14 J, 7e-15 degrees. 1e-8 would reveal a stop that acts at the end of its step.
    runs.agree("pendulum", "stop", 1e-8)


def test_stop_holds(runs):
    # Measured: 0. The rod is pressed against the stop until the end: no creep, no bounce.
    curves = runs.curves("pendulum", "stop")
    held = curves.time > curves.impacts["time"][0]
    assert (curves.bodies["rod"]["angular_velocity"][held] == 0.0).all()
    assert np.ptp(curves.bodies["rod"]["orientation"][held], axis=0).max() == 0.0
