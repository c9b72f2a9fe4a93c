"""Quaternions as tuples: turns, matrices, and the Magnus series of a rolling ball."""

import numpy as np
import pytest
from numba import njit
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from flowgmo import vectors


@njit
def turned(q, phi):
    return vectors.turned(q, phi)


@njit
def linearly(q, w, alpha, dt):
    return vectors.turned_linearly(q, w, alpha, dt)


@njit
def there_and_back(q, x):
    return vectors.rotate(q, x), vectors.unrotate(q, vectors.rotate(q, x))


@njit
def from_rows(m):
    return vectors.from_matrix(m[0, 0], m[0, 1], m[0, 2], m[1, 0], m[1, 1], m[1, 2], m[2, 0], m[2, 1], m[2, 2])


def rotation(q):
    return Rotation.from_quat([q[1], q[2], q[3], q[0]])


@pytest.mark.parametrize("size", [0.0, 1e-9, 1e-4, 1.0001e-4, 1.0, 3.14159, 20.0])
def test_a_turn_by_a_rotation_vector(size):
    """Measured: 3e-16, on both sides of the series' limit."""
    phi = size * np.array([0.36, 0.48, -0.8])
    q = turned((1.0, 0.0, 0.0, 0.0), tuple(phi))
    assert np.linalg.norm(q) == pytest.approx(1.0, abs=1e-15)
    np.testing.assert_allclose(rotation(q).as_matrix(), Rotation.from_rotvec(phi).as_matrix(), atol=1e-14)


def test_rotate_and_back():
    q = tuple(np.array([0.5, -0.1, 0.7, 0.5]))
    q = tuple(np.array(q) / np.linalg.norm(q))
    there, back = there_and_back(q, (1.0, 2.0, 3.0))
    np.testing.assert_allclose(there, rotation(q).apply([1, 2, 3]), atol=1e-14)
    np.testing.assert_allclose(back, [1, 2, 3], atol=1e-14)


@pytest.mark.parametrize("seed", range(20))
def test_matrix_to_quaternion(seed):
    """All four branches of Shepperd's method: random rotations and half turns."""
    rng = np.random.default_rng(seed)
    axis = rng.normal(size=3) * [1, 10 ** rng.uniform(-9, 0), 10 ** rng.uniform(-9, 0)]
    turn = Rotation.from_rotvec(np.pi * (1 - 1e-9 * (seed % 2)) * np.roll(axis, seed) / np.linalg.norm(axis))
    np.testing.assert_allclose(rotation(from_rows(turn.as_matrix())).as_matrix(), turn.as_matrix(), atol=1e-13)


@pytest.mark.parametrize("w, alpha, dt", [
    ((1.0, 2.0, -1.0), (3.0, -1.0, 0.5), 1.0), ((10.0, 0, 3.0), (0, 40.0, 0), 0.4), ((0, 0, 5.0), (0, 0, -2.0), 3.0),
    ((0.0, 0, 0), (1.0, 1.0, 0), 2.0), ((1e-3, 0, 0), (0, 1e-3, 0), 10.0),
])  # fmt: skip
def test_a_turn_with_constant_angular_acceleration(w, alpha, dt):
    """dq/dt = ½ ω(t) q with ω = w + α t in space axes, by solve_ivp. Measured: 5e-7 (fourth order,
    (1/4)^5/720 a sub-step); exact where α is along w."""

    def rates(t, q):
        s = np.array(w) + t * np.array(alpha)
        return 0.5 * np.array([-s @ q[1:], *(s * q[0] + np.cross(s, q[1:]))])

    q = solve_ivp(rates, (0, dt), [1.0, 0, 0, 0], method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    mine = linearly((1.0, 0.0, 0.0, 0.0), tuple(map(float, w)), tuple(map(float, alpha)), dt)
    np.testing.assert_allclose(rotation(mine).as_matrix(), rotation(q).as_matrix(), atol=2e-6)
