"""Pendulum on a fixed axis, 60° amplitude: T = T0 · 1.0731820071 = T0 (2/π) K(sin² 30°) (VALIDATION A)."""

import numpy as np
import pytest
from flowgmo_scenes import Scene, deck, on_axis
from scipy.spatial.transform import Rotation

STRETCH = 1.0731820071
G = np.array([0.0, 0.0, -9.81])
MOMENT, MASS, ARM = 0.7, 2.0, 0.4
AXES = {"y": (0, 1, 0), "x downwards": (-2, 0, 0), "any": (1.0, -2.0, 0.4)}


def pendulum(axis, amplitude):
    """Its deck, period and first angular acceleration."""
    a = np.array(axis) / np.linalg.norm(axis)
    pull = G - (G @ a) * a
    down = pull / np.linalg.norm(pull)
    point = np.array([0.3, -0.2, 0.5])
    centre = point + ARM * Rotation.from_rotvec(-amplitude * a).apply(down) + 0.17 * a
    text = deck(on_axis(MOMENT, axis, MASS, centre, point), g=G, collide=False)
    rate = np.sqrt(MASS * np.linalg.norm(pull) * ARM / MOMENT)
    return text, 2 * np.pi / rate, rate**2 * np.sin(amplitude)


@pytest.mark.parametrize("axis", AXES.values(), ids=AXES)
@pytest.mark.parametrize("parts", [1, 7, 500])
def test_the_period_at_60_degrees(axis, parts):
    """The rate at the period is the error of the period times the acceleration there. Bound: 1e-9 of T
    (VALIDATION 1e-5). The linear pendulum's period would be 7 % off."""
    text, linear, bend = pendulum(axis, np.pi / 3)
    period = linear * STRETCH
    s = Scene(text).to(period, period / parts)
    a = np.array(axis) / np.linalg.norm(axis)
    assert abs(s.w[0] @ a / bend) < 1e-9 * period
    assert abs(s.state.angle[0]) < 1e-9
    assert abs(s.remainder()) < 1e-10 * MASS * 9.81 * ARM


def test_half_a_period_is_the_other_side():
    text, linear, _ = pendulum((0, 1, 0), np.pi / 3)
    s = Scene(text).to(0.5 * linear * STRETCH)
    assert s.state.angle[0] == pytest.approx(2 * np.pi / 3, abs=1e-9)


def test_a_torque_about_the_axis_of_a_balanced_body():
    """θ = T t²/(2 J), whatever the direction of the axis. Measured: 5e-15."""
    loaded = on_axis(MOMENT, (1, 1, 1), MASS, more="igf(#)=1, txtobs(1,#)=0.6, tytobs(1,#)=0.6, tztobs(1,#)=0.6,")
    s = Scene(deck(loaded, collide=False)).to(2.0, 0.5)
    along = 0.6 * np.sqrt(3.0)
    assert s.state.angle[0] == pytest.approx(along / MOMENT * 2.0, rel=1e-11)
    assert s.state.books[3] == pytest.approx(along * s.state.angle[0], rel=1e-9)
