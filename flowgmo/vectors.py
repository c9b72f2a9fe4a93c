"""Vectors and quaternions as tuples of floats, for kernels: no allocation, a fraction of the compile time.

`triple` and `quad` read a row of an array, `put` writes one. Quaternions q = (w, x, y, z) are unit and turn body
components into space components, x_W = q x_B q* (Diebel 2006, "Representing attitude").
"""

from __future__ import annotations

import numpy as np

from flowgmo.kernel import inner


@inner
def triple(a):
    """(3,) array -> tuple."""
    return (a[0], a[1], a[2])


@inner
def quad(a):
    """(4,) array -> tuple."""
    return (a[0], a[1], a[2], a[3])


@inner
def put(a, x):
    """Write a triple into the array (3,)."""
    a[0] = x[0]
    a[1] = x[1]
    a[2] = x[2]


@inner
def put4(a, q):
    """Write a quadruple into the array (4,)."""
    a[0] = q[0]
    a[1] = q[1]
    a[2] = q[2]
    a[3] = q[3]


@inner
def add(a, b):
    """a + b."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


@inner
def sub(a, b):
    """a - b."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


@inner
def scale(s, a):
    """s a."""
    return (s * a[0], s * a[1], s * a[2])


@inner
def along(x, s, d):
    """x + s d."""
    return (x[0] + s * d[0], x[1] + s * d[1], x[2] + s * d[2])


@inner
def dot(a, b):
    """a · b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inner
def norm(a):
    """|a|."""
    return np.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


@inner
def cross(a, b):
    """a × b."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@inner
def without(a, n):
    """The part of a across the unit vector n."""
    s = a[0] * n[0] + a[1] * n[1] + a[2] * n[2]
    return (a[0] - s * n[0], a[1] - s * n[1], a[2] - s * n[2])


@inner
def times(m, x):
    """Matrix (3, 3) array times triple."""
    return (
        m[0, 0] * x[0] + m[0, 1] * x[1] + m[0, 2] * x[2],
        m[1, 0] * x[0] + m[1, 1] * x[1] + m[1, 2] * x[2],
        m[2, 0] * x[0] + m[2, 1] * x[1] + m[2, 2] * x[2],
    )


@inner
def transposed_times(m, x):
    """Transpose of a matrix (3, 3) array times triple."""
    return (
        m[0, 0] * x[0] + m[1, 0] * x[1] + m[2, 0] * x[2],
        m[0, 1] * x[0] + m[1, 1] * x[1] + m[2, 1] * x[2],
        m[0, 2] * x[0] + m[1, 2] * x[1] + m[2, 2] * x[2],
    )


@inner
def rotate(q, x):
    """x_W from x_B: x + 2 w (u × x) + 2 u × (u × x), u the vector part of q."""
    tx = 2.0 * (q[2] * x[2] - q[3] * x[1])
    ty = 2.0 * (q[3] * x[0] - q[1] * x[2])
    tz = 2.0 * (q[1] * x[1] - q[2] * x[0])
    return (
        x[0] + q[0] * tx + q[2] * tz - q[3] * ty,
        x[1] + q[0] * ty + q[3] * tx - q[1] * tz,
        x[2] + q[0] * tz + q[1] * ty - q[2] * tx,
    )


@inner
def unrotate(q, x):
    """x_B from x_W."""
    return rotate((q[0], -q[1], -q[2], -q[3]), x)


@inner
def product(p, q):
    """The quaternion product p q: first turn by q, then by p."""
    return (
        p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
        p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
        p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1],
        p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0],
    )


@inner
def normalized(q):
    """q / |q|."""
    size = np.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    return (q[0] / size, q[1] / size, q[2] / size, q[3] / size)


@inner
def same_sign(q, reference):
    """q or -q, whichever lies nearer to the reference quaternion: the sign stays continuous."""
    d = q[0] * reference[0] + q[1] * reference[1] + q[2] * reference[2] + q[3] * reference[3]
    return (-q[0], -q[1], -q[2], -q[3]) if d < 0.0 else q


@inner
def turned(q, phi):
    """q after a turn by the rotation vector phi [rad] in space axes."""
    angle = norm(phi)
    half = 0.5 * angle
    s = np.sin(half) / angle if angle > 1e-4 else 0.5 - angle * angle / 48.0  # next term angle^4/3840 < 1e-19
    return normalized(product((np.cos(half), s * phi[0], s * phi[1], s * phi[2]), q))


@inner
def turned_linearly(q, w, alpha, dt):
    """q after dt [time] under the space angular velocity w + alpha t, alpha constant (a rolling or sliding ball).

    Fourth-order Magnus series on sub-steps in which the axis turns little (Iserles & Nørsett 1999):

        phi(h) = ∫ω + ½ ∫∫ [ω(s), ω(r)] dr ds = h (w + α h/2) - (h³/12) w × α
    """
    c = cross(w, alpha)
    size = norm(c) * dt * dt * dt
    if size == 0.0:
        return turned(q, along(scale(dt, w), 0.5 * dt * dt, alpha))
    rate = (norm(w) + norm(alpha) * dt) * dt
    n = int(min(max(np.ceil(4.0 * max(size ** (1.0 / 3.0), rate)), 1.0), 1000.0))  # remainder (1/4)^5/720 a sub-step
    h = dt / n
    for k in range(n):
        wk = along(w, k * h, alpha)
        phi = along(along(scale(h, wk), 0.5 * h * h, alpha), -h * h * h / 12.0, c)
        q = turned(q, phi)
    return q


@inner
def from_matrix(r00, r01, r02, r10, r11, r12, r20, r21, r22):
    """Quaternion of a rotation matrix given by rows; the largest component is found first (Shepperd 1978)."""
    trace = r00 + r11 + r22
    if trace > 0.0:
        s = np.sqrt(trace + 1.0) * 2.0
        return normalized((0.25 * s, (r21 - r12) / s, (r02 - r20) / s, (r10 - r01) / s))
    if r00 >= r11 and r00 >= r22:
        s = np.sqrt(1.0 + r00 - r11 - r22) * 2.0
        return normalized(((r21 - r12) / s, 0.25 * s, (r01 + r10) / s, (r02 + r20) / s))
    if r11 >= r22:
        s = np.sqrt(1.0 + r11 - r00 - r22) * 2.0
        return normalized(((r02 - r20) / s, (r01 + r10) / s, 0.25 * s, (r12 + r21) / s))
    s = np.sqrt(1.0 + r22 - r00 - r11) * 2.0
    return normalized(((r10 - r01) / s, (r02 + r20) / s, (r12 + r21) / s, 0.25 * s))
