"""Prescribed motion: sinusoids and tables integrated in closed form, general rotation against solve_ivp (1e-8)."""

import numpy as np
import pytest
from flowgmo_scenes import Scene, deck, driven, matrix, on_axis, table
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation


def sinus(name, amplitude, frequency, phase=0.0):
    return f"i{name}pre(#)=1, {name}amp(#)={amplitude!r}, {name}fre(#)={frequency!r}, {name}phs(#)={phase!r}, "


def travel(amplitude, frequency, phase, t):
    """∫ A sin(2 π f t + φ), φ in degrees."""
    rate, phi = 2 * np.pi * frequency, np.radians(phase)
    return amplitude / rate * (np.cos(phi) - np.cos(rate * t + phi))


@pytest.mark.parametrize("dt", [1e-3, 0.37, 2.7])
def test_sinusoidal_translation_with_a_phase_in_degrees(dt):
    """Measured: 7e-15. Phase in radians, or frequency per radian, would be off by the order of the amplitude."""
    waves = [(0.3, 1.3, 30.0), (1.2, 0.4, 0.0), (-0.5, 2.0, 200.0)]
    text = "".join(sinus(n, *wave) for n, wave in zip("uvw", waves, strict=True))
    s = Scene(deck(driven((1, 2, 3), more=text), collide=False)).to(2.7, dt, asked=[1.1])
    np.testing.assert_allclose(s.p[0] - [1, 2, 3], [travel(*w, 2.7) for w in waves], atol=1e-12)
    np.testing.assert_allclose(s.row("p_WB")[0, 0] - [1, 2, 3], [travel(*w, 1.1) for w in waves], atol=1e-12)
    speed = [a * np.sin(2 * np.pi * f * 2.7 + np.radians(p)) for a, f, p in waves]
    np.testing.assert_allclose(s.v[0], speed, atol=1e-12)


@pytest.mark.parametrize("dt", [1e-2, 0.7, 4.0])
def test_tables_of_velocity(dt):
    """Trapezes between entries, constant outside. Measured: 2e-14. A kink stepped over would be off by dt² slope."""
    t, y = [0.2, 0.9, 1.0, 2.5], [1.0, -2.0, 3.0, 0.5]
    more = table("utobs", y) + table("wtobs", [0, 0, 1, 1])
    s = Scene(deck(driven((0, 0, 0), more=more), times=t, collide=False)).to(4.0, dt)
    whole = 0.2 * y[0] + sum((b - a) * (p + q) / 2 for a, b, p, q in zip(t, t[1:], y, y[1:], strict=False)) + 1.5 * 0.5
    np.testing.assert_allclose(s.p[0], [whole, 0.0, 0.05 + 1.5 + 1.5], atol=1e-12)
    np.testing.assert_allclose(s.v[0], [0.5, 0.0, 1.0], atol=1e-15)


@pytest.mark.parametrize("dt", [0.01, 1.9])
def test_rotation_about_a_fixed_axis_of_any_direction(dt):
    """Angle = the integral; the centre runs on its circle. Measured: 2e-16."""
    axis = np.array([1.0, 2.0, -2.0]) / 3
    body = on_axis(1.0, 3 * axis, centre=(0.5, 0, 0), kind=3, more=sinus("omx", 2.0, 0.7, 10.0))
    s = Scene(deck(body, collide=False)).to(1.9, dt)
    angle = travel(2.0, 0.7, 10.0, 1.9)
    assert s.state.angle[0] == pytest.approx(angle, abs=1e-12)
    np.testing.assert_allclose(s.p[0], Rotation.from_rotvec(angle * axis).apply([0.5, 0, 0]), atol=1e-12)


def test_one_body_axis_with_a_reference_point_off_the_centre():
    """The reference point, not the mass centre, follows the table."""
    more = "xref0(#)=0.5, yref0(#)=0.0, zref0(#)=0.0, rhomvb(#)=10.0,"
    s = Scene(deck(driven((0, 0, 0), v=(1, 0, 0), w=(0, 0, 2.0), more=more), collide=False)).to(1.3, 0.1)
    c, n = np.cos(2.6), np.sin(2.6)
    np.testing.assert_allclose(s.p[0], [0.5 + 1.3 - 0.5 * c, -0.5 * n, 0.0], atol=1e-12)
    np.testing.assert_allclose(s.v[0], [1 + n, -c, 0.0], atol=1e-12)


@pytest.mark.parametrize("dt", [0.02, 0.5, 2.0])
def test_general_rotation_about_several_axes(dt):
    """dq/dt = ½ q ω(t), ω in body axes, by solve_ivp. Measured: 4e-13."""
    waves = [(2.0, 0.7, 20.0), (1.5, 1.1, 90.0), (-0.8, 0.3, 0.0)]
    text = "".join(sinus(n, *w) for n, w in zip(("omx", "omy", "omz"), waves, strict=True))
    s = Scene(deck(driven((0, 0, 0), v=(0.1, 0, 0), more=text), collide=False)).to(2.0, dt)

    def rates(t, q):
        w = np.array([a * np.sin(2 * np.pi * f * t + np.radians(p)) for a, f, p in waves])
        return 0.5 * np.array([-q[1:] @ w, *(q[0] * w + np.cross(q[1:], w))])

    q = solve_ivp(rates, (0, 2.0), [1.0, 0, 0, 0], method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    np.testing.assert_allclose(matrix(s.q[0]), matrix(q), atol=1e-8)
    np.testing.assert_allclose(s.p[0], [0.2, 0, 0], atol=1e-12)
