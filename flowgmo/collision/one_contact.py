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
def turn_of(theta, kn, v, ktt, mu):
    """The polynomial at θ. kn: (K_nn, K_1n, K_2n), v: (v_n, v_1, v_2), ktt: (K_11, K_12, K_22)."""
    c, s = np.cos(theta), np.sin(theta)
    x = kn[1] + mu * (ktt[0] * c + ktt[1] * s)
    y = kn[2] + mu * (ktt[1] * c + ktt[2] * s)
    return (c * v[2] - s * v[1]) * (kn[0] + mu * (kn[1] * c + kn[2] * s)) - v[0] * (c * y - s * x)


@inner
def sliding(kn, v, ktt, mu, samples):
    """Least p_n and the angle of d of all sliding solutions; p_n = inf if there is none. Arguments as in turn_of."""
    best = np.inf
    angle = 0.0
    width = 2.0 * np.pi / samples
    # the slip of a ball points along v_t: with the samples counted from there its root is not between two of them
    origin = np.arctan2(-v[2], -v[1]) - 0.5 * width
    before = turn_of(origin, kn, v, ktt, mu)
    for k in range(samples):
        lo = origin + k * width
        after = turn_of(lo + width, kn, v, ktt, mu)
        if (before <= 0.0) != (after <= 0.0):
            theta = crossing(lo, lo + width, before, after, kn, v, ktt, mu)
            c, s = np.cos(theta), np.sin(theta)
            below = kn[0] + mu * (kn[1] * c + kn[2] * s)
            if below > 0.0:
                pn = -v[0] / below
                x = v[1] + pn * (kn[1] + mu * (ktt[0] * c + ktt[1] * s))
                y = v[2] + pn * (kn[2] + mu * (ktt[1] * c + ktt[2] * s))
                if c * x + s * y <= 0.0 and pn < best:
                    best = pn
                    angle = theta
        before = after
    return best, angle


@inner
def crossing(lo, hi, flo, fhi, kn, v, ktt, mu):
    """Where the polynomial changes sign: false position, the kept side's value halved (Illinois)."""
    theta = lo
    side = 0
    for _ in range(TRIES):
        theta = (lo * fhi - hi * flo) / (fhi - flo) if fhi != flo else 0.5 * (lo + hi)
        f = turn_of(theta, kn, v, ktt, mu)
        if f == 0.0 or abs(hi - lo) < 1e-15:  # rad: round-off of an angle
            break
        if (f <= 0.0) == (flo <= 0.0):
            done = lo == theta
            lo, flo = theta, f
            if side == -1:
                fhi *= 0.5
            side = -1
        else:
            done = hi == theta
            hi, fhi = theta, f
            if side == 1:
                flo *= 0.5
            side = 1
        if done:
            break
    return theta


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
    angle = 0.0
    for samples in (SAMPLES, FINE):
        if pn == np.inf:
            pn, angle = sliding(kn, v, ktt, mu, samples)
    if pn == np.inf:  # round-off at the edge of the cone
        return scale(-vn / knn, n)
    d = add(scale(np.cos(angle), one), scale(np.sin(angle), two))
    return scale(pn, add(n, scale(mu, d)))
