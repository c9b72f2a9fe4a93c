"""Unit quaternions q = (w, x, y, z) that turn body components into space components: x_W = q x_B q*.

Source: Diebel 2006, "Representing attitude"; series of the exponential are cut where the next term is below round-off.
"""

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True)
def rotate(q, x):
    """x_W (3,) from x_B (3,): x + 2 w (u × x) + 2 u × (u × x), u the vector part."""
    tx = 2.0 * (q[2] * x[2] - q[3] * x[1])
    ty = 2.0 * (q[3] * x[0] - q[1] * x[2])
    tz = 2.0 * (q[1] * x[1] - q[2] * x[0])
    return np.array(
        [
            x[0] + q[0] * tx + q[2] * tz - q[3] * ty,
            x[1] + q[0] * ty + q[3] * tx - q[1] * tz,
            x[2] + q[0] * tz + q[1] * ty - q[2] * tx,
        ]
    )


@njit(cache=True)
def unrotate(q, x):
    """x_B (3,) from x_W (3,)."""
    return rotate(np.array([q[0], -q[1], -q[2], -q[3]]), x)


@njit(cache=True)
def product(p, q):
    """The quaternion product p q: first turn by q, then by p."""
    return np.array(
        [
            p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
            p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
            p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1],
            p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0],
        ]
    )


@njit(cache=True)
def normalized(q):
    """q / |q|."""
    return q / np.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])


@njit(cache=True)
def turned(q, phi):
    """q after a turn by the rotation vector phi (3,) [rad] in space axes."""
    angle = np.sqrt(phi[0] * phi[0] + phi[1] * phi[1] + phi[2] * phi[2])
    half = 0.5 * angle
    s = np.sin(half) / angle if angle > 1e-4 else 0.5 - angle * angle / 48.0  # next term angle^4/3840 < 1e-19
    return normalized(product(np.array([np.cos(half), s * phi[0], s * phi[1], s * phi[2]]), q))


@njit(cache=True)
def to_matrix(q):
    """R_WB (3, 3), columns are the body axes in space."""
    w, x, y, z = q[0], q[1], q[2], q[3]
    return np.array(
        [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
            [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
            [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
        ]
    )


@njit(cache=True)
def from_matrix(R):
    """q (4,) of a rotation matrix; the largest of the four components is found first (Shepperd 1978)."""
    trace = R[0, 0] + R[1, 1] + R[2, 2]
    q = np.empty(4)
    if trace > 0.0:
        s = np.sqrt(trace + 1.0) * 2.0
        q[0] = 0.25 * s
        q[1] = (R[2, 1] - R[1, 2]) / s
        q[2] = (R[0, 2] - R[2, 0]) / s
        q[3] = (R[1, 0] - R[0, 1]) / s
        return normalized(q)
    i = 0
    if R[1, 1] > R[0, 0]:
        i = 1
    if R[2, 2] > R[i, i]:
        i = 2
    j, k = (i + 1) % 3, (i + 2) % 3
    s = np.sqrt(1.0 + R[i, i] - R[j, j] - R[k, k]) * 2.0
    q[0] = (R[k, j] - R[j, k]) / s
    q[1 + i] = 0.25 * s
    q[1 + j] = (R[j, i] + R[i, j]) / s
    q[1 + k] = (R[k, i] + R[i, k]) / s
    return normalized(q)


@njit(cache=True)
def along(q, reference):
    """q or -q, whichever lies nearer to the reference quaternion: the sign stays continuous."""
    dot = q[0] * reference[0] + q[1] * reference[1] + q[2] * reference[2] + q[3] * reference[3]
    return -q if dot < 0.0 else q


@njit(cache=True)
def cross(a, b):
    """a × b (3,)."""
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


@njit(cache=True)
def dot(a, b):
    """a · b of two (3,), summed in a fixed order."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit(cache=True)
def norm(a):
    """|a| of (3,)."""
    return np.sqrt(dot(a, a))


@njit(cache=True)
def turned_linearly(q, w, alpha, dt):
    """q after dt [time] under the space angular velocity w + alpha t, alpha constant (a rolling or sliding ball).

    Fourth-order Magnus: phi = w̄ h + (h³/12) α × ω̄ ... evaluated on sub-steps in which ω turns and grows little.

        phi(h) = ∫ω + ½ ∫∫ [ω(s), ω(r)] dr ds = h (w + α h/2) - (h³/12) w × α          (Iserles & Nørsett 1999)
    """
    size = norm(cross(w, alpha)) * dt**3
    if size == 0.0:
        return turned(q, dt * w + 0.5 * dt * dt * alpha)
    rate = (norm(w) + norm(alpha) * dt) * dt
    n = int(np.ceil(max(4.0 * size ** (1.0 / 3.0), 4.0 * rate)))  # remainder ~ (1/4)^5/720 per sub-step, ~1e-6 of a turn
    n = min(max(n, 1), 1000)
    h = dt / n
    c = cross(w, alpha)
    for k in range(n):
        wk = w + (k * h) * alpha
        phi = h * wk + (0.5 * h * h) * alpha - (h**3 / 12.0) * c
        q = turned(q, phi)
    return q
