"""One frictional contact alone, solved exactly: Coulomb's law at the end of the step, maximal dissipation.

With v the relative velocity without the contact's impulse p, u = v + K p:

    0 <= p_n ⟂ u_n >= 0     |p_t| <= μ p_n     u_t = 0, or p_t = -μ p_n u_t/|u_t|

open     v_n >= 0: p = 0
sticks   p = -K⁻¹ v if that lies in the cone
slides   p = p_n (n + μ d) with a unit tangent d = (cos θ, sin θ):  p_n = -v_n / (K_nn + μ K_nt·d), and the slip
         u_t = v_t + p_n (K_tn + μ K_tt d) must be -λ d, λ >= 0. d × u_t = 0 times the denominator is

            (d × v_t)(K_nn + μ K_nt·d) - v_n d × (K_tn + μ K_tt d) = 0

         a trigonometric polynomial of second degree in θ: at most four roots.

K is positive definite or semi-definite, hence a solution exists; a large μ can give several (Painlevé). The one with
the least normal impulse is taken: the choice depends on neither axes nor numbering.
Source: Bonnefon & Daviet 2011 (the quartic); Moreau 1988 (the law).
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.contact import symmetric_times
from flowgmo.collision.frame import tangents
from flowgmo.kernel import inner
from flowgmo.vectors import add, dot, norm, scale, sub

SAMPLES = (
    24  # 15 degrees; two roots nearer than that are missed together, which for random K with μ to 10 is one in 3000
)
FINE = 960  # then sought again
TRIES = 60  # false positions: with halved ends each gains a digit at least every third time


@inner
def sticking(kk, v):
    """p with K p = -v (triples); a singular K is stiffened by round-off of its trace."""
    e = 1e-14 * (kk[0] + kk[1] + kk[2])  # 50 round-offs: the pivots stay positive
    d0 = kk[0] + e
    l1, l2 = kk[3] / d0, kk[4] / d0
    d1 = kk[1] + e - l1 * kk[3]
    s = kk[5] - l2 * kk[3]
    d1 = max(d1, e)
    l3 = s / d1
    d2 = max(kk[2] + e - l2 * kk[4] - l3 * s, e)
    y0 = -v[0]
    y1 = -v[1] - l1 * y0
    y2 = -v[2] - l2 * y0 - l3 * y1
    z = y2 / d2
    y = y1 / d1 - l3 * z
    return (y0 / d0 - l1 * y - l2 * z, y, z)


@inner
def polynomial(kn, v, ktt, mu):
    """Coefficients of c, s, c², s², c s in the polynomial, c = cos θ, s = sin θ.

    kn: (K_nn, K_1n, K_2n), v: (v_n, v_1, v_2), ktt: (K_11, K_12, K_22).
    """
    return (
        v[2] * kn[0] - v[0] * kn[2],
        v[0] * kn[1] - v[1] * kn[0],
        mu * (v[2] * kn[1] - v[0] * ktt[1]),
        mu * (v[0] * ktt[1] - v[1] * kn[2]),
        mu * (v[2] * kn[2] - v[1] * kn[1] - v[0] * (ktt[2] - ktt[0])),
    )


@inner
def turn_of(f, c, s):
    """The polynomial with the coefficients f in the direction (c, s)."""
    return (f[0] + f[2] * c + f[4] * s) * c + (f[1] + f[3] * s) * s


@inner
def sliding(kn, v, ktt, mu, samples):
    """Least p_n and d (c, s) of all sliding solutions; p_n = inf if there is none. Arguments as in polynomial."""
    best = np.inf
    direction = (1.0, 0.0)
    f = polynomial(kn, v, ktt, mu)
    cw, sw = np.cos(2.0 * np.pi / samples), np.sin(2.0 * np.pi / samples)
    # the slip of a ball points along v_t: with the samples counted from there its root is not between two of them
    c, s = np.cos(np.pi / samples), -np.sin(np.pi / samples)
    slip = np.sqrt(v[1] * v[1] + v[2] * v[2])
    if slip > 0.0:
        c, s = -(c * v[1] - s * v[2]) / slip, -(s * v[1] + c * v[2]) / slip
    before = turn_of(f, c, s)
    for _ in range(samples):
        c1, s1 = c * cw - s * sw, s * cw + c * sw
        after = turn_of(f, c1, s1)
        if (before <= 0.0) != (after <= 0.0):
            d1, d2 = crossing(f, c, s, np.tan(np.pi / samples), before, after)
            below = kn[0] + mu * (kn[1] * d1 + kn[2] * d2)
            if below > 0.0:
                pn = -v[0] / below
                x = v[1] + pn * (kn[1] + mu * (ktt[0] * d1 + ktt[1] * d2))
                y = v[2] + pn * (kn[2] + mu * (ktt[1] * d1 + ktt[2] * d2))
                if d1 * x + d2 * y <= 0.0 and pn < best:
                    best = pn
                    direction = (d1, d2)
        c, s, before = c1, s1, after
    return best, direction


@inner
def crossing(f, c, s, hi, flo, fhi):
    """The direction in which the polynomial changes sign: false position, the kept side's value halved (Illinois).

    The unknown is τ = tan(φ/2), φ the angle from (c, s), between 0 and hi: no angle functions are needed.
    """
    lo = 0.0
    d1, d2 = c, s
    tau = lo
    side = 0
    for _ in range(TRIES):
        tau = (lo * fhi - hi * flo) / (fhi - flo) if fhi != flo else 0.5 * (lo + hi)
        below = 1.0 / (1.0 + tau * tau)
        cp, sp = (1.0 - tau * tau) * below, 2.0 * tau * below
        d1, d2 = c * cp - s * sp, s * cp + c * sp
        value = turn_of(f, d1, d2)
        if value == 0.0 or abs(hi - lo) < 0.5e-15:  # half of a rad: round-off of an angle
            break
        if (value <= 0.0) == (flo <= 0.0):
            done = lo == tau
            lo, flo = tau, value
            if side == -1:
                fhi *= 0.5
            side = -1
        else:
            done = hi == tau
            hi, fhi = tau, value
            if side == 1:
                flo *= 0.5
            side = 1
        if done:
            break
    return d1, d2


@inner
def solve_one(kk, n, mu, v):
    """Impulse (triple, space axes) of one contact. kk: K (six entries), v: velocity without the impulse."""
    vn = dot(v, n)
    if vn >= 0.0:
        return (0.0, 0.0, 0.0)
    kn = symmetric_times(kk, n)
    knn = dot(kn, n)
    if knn <= 1e-15 * (kk[0] + kk[1] + kk[2]):  # round-off of a sum: nothing moves along n
        return (0.0, 0.0, 0.0)
    if mu == 0.0:
        return scale(-vn / knn, n)
    p = sticking(kk, v)
    pn = dot(p, n)
    if pn >= 0.0 and norm(sub(p, scale(pn, n))) <= mu * pn:
        return p
    one, two = tangents(n)
    k1 = symmetric_times(kk, one)
    ktt = (dot(k1, one), dot(k1, two), dot(symmetric_times(kk, two), two))
    kn = (knn, dot(kn, one), dot(kn, two))
    v = (vn, dot(v, one), dot(v, two))
    pn = np.inf
    c, s = 1.0, 0.0
    for samples in (SAMPLES, FINE):
        if pn == np.inf:
            pn, (c, s) = sliding(kn, v, ktt, mu, samples)
    if pn == np.inf:  # round-off at the edge of the cone
        return scale(-vn / knn, n)
    d = add(scale(c, one), scale(s, two))
    return scale(pn, add(n, scale(mu, d)))
