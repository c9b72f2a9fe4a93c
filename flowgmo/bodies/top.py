"""Rotation of a free rigid body, exact at any step: Euler's equations by Jacobi's elliptic functions.

    I1 dω1/dt = (I2 - I3) ω2 ω3   and cyclic, principal axes;  L fixed in space

With I1 <= I2 <= I3, let C be the axis about which the momentum circles (the largest moment if L² >= 2 E I2, else
the smallest), A the other end, B the middle. The addition theorems of sn, cn, dn give ω(t) from ω(0) directly,
without a phase (no incomplete integral, no signs to keep, nothing singular at the separatrix or at a steady spin):

    x(t) = (x c + κA y z s d) / D     κA = ±(B - C)/(A λ)     s, c, d = sn, cn, dn (λ t | m)
    y(t) = (y c d + κB x z s) / D     κB = ±(C - A)/(B λ)     D = c² + s² C (C - A) z² / P
    z(t) = (z d + κC x y s c) / D     κC = ±(A - B)/(C λ)     P = B (B - A) y² + C (C - A) z²
    λ² = (C - B) P / (A B C)          1 - m = (C - A) (C (C - B) z² - A (B - A) x²) / ((C - B) P)

The attitude follows from L being fixed: only the angle ψ about L is left,

    dψ/dt = L (2E - A x²) / (L² - A² x²)

(the precession of the A axis; or the same with C and z, whichever momentum stays farther from L), integrated by
Gauss's rule on panels short against the functions' period: to round-off. Source: Landau & Lifshitz, Mechanics §37;
Celledoni, Fassò, Säfström & Zanna 2008 for the use as a propagator; Abramowitz & Stegun 16.4 and 16.17.
"""

from __future__ import annotations

import numpy as np

from flowgmo.kernel import inner
from flowgmo.vectors import (
    along,
    cross,
    dot,
    from_matrix,
    norm,
    rotate,
    same_sign,
    scale,
    times,
    transposed_times,
    turned,
    unrotate,
)

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(10)
ISOTROPIC = 1e-13  # relative spread of the moments below which the tensor is a multiple of one


@inner
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


@inner
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


@inner
def spin_freely(q, w, moments, axes, dt):
    """Attitude and angular velocity of a torque-free body after dt.

    q (4), w (3) [rad/time] space axes, tuples; moments (3,) ascending, axes (3, 3) columns: principal axes in body
    axes, right-handed. Returns q, w. Exact for any dt (see the module's docstring).
    """
    spread = moments[2] - moments[0]
    if spread <= ISOTROPIC * moments[2] or dot(w, w) == 0.0:
        return turned(q, scale(dt, w)), w
    wp = transposed_times(axes, unrotate(q, w))
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
    lam = np.sqrt(abs(C - B) * P / (A * B * C))
    mc = 1.0
    d0 = 1.0
    if lam > 0.0:
        mc = abs(C - A) * (C * abs(C - B) * z * z - A * abs(B - A) * x * x) / (abs(C - B) * P)
        mc = min(max(mc, 0.0), 1.0)
        d0 = C * abs(C - A) * z * z / P
    L2 = (A * x) ** 2 + (B * y) ** 2 + (C * z) ** 2
    E2 = A * x * x + B * y * y + C * z * z
    # the axis whose attitude gives ψ: A or C, whichever momentum stays farther from L
    by_A = A * abs(E2 * C - L2) <= C * P
    K = A if by_A else C
    panels = max(1, int(np.ceil(2.0 * lam * abs(dt))))  # half a unit of the elliptic argument: 10 points give round-off
    h = dt / panels
    psi = 0.0
    for k in range(panels):
        part = 0.0
        for j in range(_NODES.size):
            xt, yt, zt = _rates((k + 0.5 + 0.5 * _NODES[j]) * h, A, B, C, sigma, x, y, z, lam, mc, d0)
            u = xt if by_A else zt
            part += _WEIGHTS[j] * (E2 - K * u * u) / (L2 - (K * u) ** 2)
        psi += 0.5 * h * part
    psi *= np.sqrt(L2)
    xt, yt, zt = _rates(dt, A, B, C, sigma, x, y, z, lam, mc, d0)
    wt = (xt, yt, zt) if about_largest else (zt, yt, xt)
    k = 0 if by_A == about_largest else 2
    q_new = _attitude(q, axes, (i1 * wp[0], i2 * wp[1], i3 * wp[2]), (i1 * wt[0], i2 * wt[1], i3 * wt[2]), k, psi)
    w_new = rotate(q_new, times(axes, wt))
    # rounding in the two turns is biased by about one unit in the last place a step: hold the energy where it is read
    wp = transposed_times(axes, unrotate(q_new, w_new))
    return q_new, scale(np.sqrt(E2 / (i1 * wp[0] ** 2 + i2 * wp[1] ** 2 + i3 * wp[2] ** 2)), w_new)


@inner
def _attitude(q, axes, before, after, k, psi):
    """The new q: momentum `before` and `after` (principal components) is one vector L in space, and the node
    e_k × L has turned about it by psi."""
    m0 = scale(1.0 / norm(before), before)
    m1 = scale(1.0 / norm(after), after)
    n0 = _node(m0, k)
    n1 = _node(m1, k)
    t1 = cross(m1, n1)
    L = rotate(q, times(axes, m0))
    n = rotate(q, times(axes, n0))
    n = along(scale(np.cos(psi), n), np.sin(psi), cross(L, n))
    t = cross(L, n)
    # columns of R: images of the body axes, whose principal components are the rows of `axes`
    c0 = _image(axes[0], m1, n1, t1, L, n, t)
    c1 = _image(axes[1], m1, n1, t1, L, n, t)
    c2 = _image(axes[2], m1, n1, t1, L, n, t)
    return same_sign(from_matrix(c0[0], c1[0], c2[0], c0[1], c1[1], c2[1], c0[2], c1[2], c2[2]), q)


@inner
def _node(m, k):
    """Unit vector e_k × m, for a unit m away from e_k, k = 0 or 2."""
    if k == 0:
        r = np.sqrt(m[1] ** 2 + m[2] ** 2)
        return (0.0, -m[2] / r, m[1] / r)
    r = np.sqrt(m[0] ** 2 + m[1] ** 2)
    return (-m[1] / r, m[0] / r, 0.0)


@inner
def _image(a, m1, n1, t1, L, n, t):
    """Where the rotation m1, n1, t1 -> L, n, t takes a (3,)."""
    return along(along(scale(dot(a, m1), L), dot(a, n1), n), dot(a, t1), t)
