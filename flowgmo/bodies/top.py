"""Rotation of a free rigid body, exact at any step: Euler's equations by Jacobi's elliptic functions.

    I1 dω1/dt = (I2 - I3) ω2 ω3   and cyclic, principal axes;  angular momentum L fixed in space

With I1 <= I2 <= I3, let C be the axis about which the momentum circles (the largest moment if L² >= 2 E I2, else the
smallest), A the other end, B the middle. The addition theorems of sn, cn, dn give ω(t) from ω(0) directly, without a
phase (no incomplete integral, no signs to keep, nothing singular at the separatrix or at a steady spin):

    x(t) = (x c + κA y z s d) / D     κA = ±(B - C)/(A λ)     s, c, d = sn, cn, dn (λ t | m)
    y(t) = (y c d + κB x z s) / D     κB = ±(C - A)/(B λ)     D = c² + s² C (C - A) z² / P
    z(t) = (z d + κC x y s c) / D     κC = ±(A - B)/(C λ)     P = B (B - A) y² + C (C - A) z²   (signs of the differences)
    λ² = (C - B) P / (A B C)          1 - m = (C - A) (C (C - B) z² - A (B - A) x²) / ((C - B) P)

The attitude follows from L being fixed: only the angle ψ about L is left,

    dψ/dt = L (2E - A x²) / (L² - A² x²)

(the precession of the A axis; or the same with C and z, whichever momentum stays farther from L), integrated by Gauss's rule on panels short against
the functions' period: to round-off. Source: Landau & Lifshitz, Mechanics §37; Celledoni, Fassò, Säfström & Zanna 2008
for the use as a propagator; Abramowitz & Stegun 16.4 and 16.17.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from flowgmo.bodies.rotation import along, dot, from_matrix, rotate, to_matrix, turned, unrotate

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(10)
ISOTROPIC = 1e-13  # relative spread of the moments below which the tensor is a multiple of one


@njit(cache=True)
def jacobi(u, mc):
    """sn, cn, dn of argument u and complementary parameter mc = 1 - m in [0, 1], by the AGM (A&S 16.4)."""
    if mc <= 0.0:
        c = 1.0 / np.cosh(u)
        return np.tanh(u), c, c
    a = 1.0
    b = np.sqrt(mc)
    em = np.empty(30)
    en = np.empty(30)
    last = 0
    c = 1.0
    for i in range(30):
        last = i
        em[i] = a
        en[i] = b
        c = 0.5 * (a + b)
        if abs(a - b) <= 1e-9 * a:  # converges quadratically: the next difference is below 1e-18
            break
        b = np.sqrt(a * b)
        a = c
    phase = c * u
    sn = np.sin(phase)
    cn = np.cos(phase)
    dn = 1.0
    if sn != 0.0:
        a = cn / sn
        c = c * a
        for i in range(last, -1, -1):
            b = em[i]
            a = c * a
            c = c * dn
            dn = (en[i] + a) / (b + a)
            a = c / b
        a = 1.0 / np.sqrt(c * c + 1.0)
        sn = a if sn >= 0.0 else -a
        cn = c * sn
    return sn, cn, dn


@njit(cache=True)
def _rates(t, A, B, C, sigma, x, y, z, lam, mc, d0):
    """Principal rates x, y, z at time t from those at 0 (formulae above)."""
    if lam == 0.0:
        return x, y, z
    s, c, d = jacobi(lam * t, mc)
    D = c * c + s * s * d0
    xt = (x * c + sigma * (B - C) / (A * lam) * y * z * s * d) / D
    yt = (y * c * d + sigma * (C - A) / (B * lam) * x * z * s) / D
    zt = (z * d + sigma * (A - B) / (C * lam) * x * y * s * c) / D
    return xt, yt, zt


@njit(cache=True)
def spin_freely(q, w, moments, axes, dt):
    """Attitude and angular velocity of a torque-free body after dt.

    q (4,), w (3,) [rad/time] space axes, moments (3,) ascending, axes (3, 3) columns: principal axes in body axes,
    right-handed. Returns q, w. Exact for any dt (see the module's docstring).
    """
    spread = moments[2] - moments[0]
    if spread <= ISOTROPIC * moments[2] or dot(w, w) == 0.0:
        return turned(q, dt * w), w
    R = to_matrix(q) @ axes
    wp = axes.T @ unrotate(q, w)
    i1, i2, i3 = moments[0], moments[1], moments[2]
    about_largest = i3 * (i3 - i2) * wp[2] ** 2 >= i1 * (i2 - i1) * wp[0] ** 2
    if about_largest:
        A, B, C, sigma = i1, i2, i3, 1.0
        x, y, z = wp[0], wp[1], wp[2]
    else:
        A, B, C, sigma = i3, i2, i1, -1.0
        x, y, z = wp[2], wp[1], wp[0]
    # with C the smallest moment both differences change sign: P, λ², m are formed from absolute values
    P = B * abs(B - A) * y * y + C * abs(C - A) * z * z
    lam2 = abs(C - B) * P / (A * B * C)
    lam = np.sqrt(lam2)
    mc = 1.0
    d0 = 1.0
    if lam > 0.0:
        mc = abs(C - A) * (C * abs(C - B) * z * z - A * abs(B - A) * x * x) / (abs(C - B) * P)
        mc = min(max(mc, 0.0), 1.0)
        d0 = C * abs(C - A) * z * z / P
    L2 = (A * x) ** 2 + (B * y) ** 2 + (C * z) ** 2
    E2 = A * x * x + B * y * y + C * z * z
    L = np.sqrt(L2)
    panels = max(1, int(np.ceil(2.0 * lam * abs(dt))))  # half a unit of the elliptic argument: 10 points give round-off
    h = dt / panels
    # the axis whose attitude gives ψ: A or C, whichever momentum stays farther from L
    far_A = A * abs(E2 * C - L2) / abs(C - A)
    far_C = C * P / abs(C - A)
    by_A = far_A <= far_C
    K = A if by_A else C
    psi = 0.0
    for k in range(panels):
        part = 0.0
        for j in range(_NODES.size):
            xt, yt, zt = _rates((k + 0.5 + 0.5 * _NODES[j]) * h, A, B, C, sigma, x, y, z, lam, mc, d0)
            u = xt if by_A else zt
            part += _WEIGHTS[j] * (E2 - K * u * u) / (L2 - (K * u) ** 2)
        psi += 0.5 * h * part
    psi *= L
    xt, yt, zt = _rates(dt, A, B, C, sigma, x, y, z, lam, mc, d0)
    k = 0 if by_A == about_largest else 2
    wt = np.array([xt, yt, zt]) if about_largest else np.array([zt, yt, xt])
    start = _momentum_frame(wp * moments, k)
    stop = _momentum_frame(wt * moments, k)
    c, s = np.cos(psi), np.sin(psi)
    about_L = np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
    R = R @ start.T @ about_L @ stop
    q_new = along(from_matrix(R @ axes.T), q)
    w_new = rotate(q_new, axes @ wt)
    # rounding in the two turns is biased by about one unit in the last place a step: hold the energy where it is read
    wp = axes.T @ unrotate(q_new, w_new)
    return q_new, w_new * np.sqrt(E2 / (moments[0] * wp[0] ** 2 + moments[1] * wp[1] ** 2 + moments[2] * wp[2] ** 2))


@njit(cache=True)
def _momentum_frame(momentum, k):
    """Rows: the momentum's direction, the node e_k × L, and their product, in principal components (3, 3)."""
    m = momentum / np.sqrt(dot(momentum, momentum))
    n = np.zeros(3)
    i, j = (k + 1) % 3, (k + 2) % 3
    r = np.sqrt(m[i] ** 2 + m[j] ** 2)
    n[i] = -m[j] / r
    n[j] = m[i] / r
    out = np.empty((3, 3))
    out[0] = m
    out[1] = n
    out[2, 0] = m[1] * n[2] - m[2] * n[1]
    out[2, 1] = m[2] * n[0] - m[0] * n[2]
    out[2, 2] = m[0] * n[1] - m[1] * n[0]
    return out
