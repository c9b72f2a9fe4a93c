"""The parts of an impact in which the direction of friction does not change: closed forms in the normal impulse p.

    f = (-μ d, 1), d the direction of slip      the impulse is f dp; where the sides stick f = (-Ktt⁻¹ b, 1)
    v3 = v3⁻ + r p,   W = v3⁻ p + ½ r p²        r = f · K f in stick, r = (K f)3 in slip
    dv_t/dp = K f's tangential part:  g along d (the slip speed's rate), h across it (its turning, s dφ/dp = h)

with Ktt the tangential part of K and b = (K13, K23). A direction with h = 0 is an invariant ray: slip that starts on it
stays on it. Two facts make the rest simple:

* On a ray b = (μ Ktt + g) d, so the rays that lead away from rest, g > 0, are the roots of
  |(μ Ktt + g)⁻¹ b| = 1. The left side falls from μ̄/μ to 0 as g grows, μ̄ = |Ktt⁻¹ b| the coefficient of stick:
  there is exactly one such ray if μ < μ̄ and none otherwise. It attracts its neighbours (dh/dφ = -g - μ e·Ktt e < 0,
  e across d) and raises v3 (r = f·K f + μ g > 0).
* Where slip has halted it sticks if μ >= μ̄, as friction can; else it starts again along that one ray (reversal).

The work law (Stronge): the normal impulse ends when restitution has given back e² of the work of compression. An impact
may compress twice: v3 falls again, below zero, after it was positive (Batlle & Cardona). We add up: `due` grows by
e² |dW| while v3 < 0 and is paid by dW while v3 > 0; the impact ends when it is paid. Why so: the outcome is then
continuous where the second compression shrinks to nothing (to start afresh would drop what the first one still owes),
the normal work is -(1 - e²) of all compression, never positive, and e = 1 loses only to friction.

Source: Stronge 2000, ch. 4; Batlle 1996 (invariant rays); Batlle & Cardona, "Conditions for dual compression in
perfectly elastic 3-D collisions"; report eqs. (15)-(28) with the errata.
"""

from __future__ import annotations

import numpy as np

from flowgmo.kernel import inner

EPS = 2.220446049250313e-16  # spacing of floats at 1: what round-off is measured with


@inner
def along_slip(k, d1, d2, mu):
    """Rates g, h, r [1/mass] of slip speed, turning, and v3 by normal impulse, slip in the unit direction (d1, d2).

    k: inverse mass, entries 11 22 33 12 13 23, here and below. Report eqs. (19)-(21).
    """
    t1 = k[4] - mu * (k[0] * d1 + k[3] * d2)
    t2 = k[5] - mu * (k[3] * d1 + k[1] * d2)
    return t1 * d1 + t2 * d2, t2 * d1 - t1 * d2, k[2] - mu * (k[4] * d1 + k[5] * d2)


@inner
def straight(v3, r, due, ee, limit):
    """Follow v3 along a straight piece of at most `limit` normal impulse.

    v3 [velocity], its rate r, due [energy] owed to restitution, ee = e². r > 0 where limit is infinite.
    Returns the impulse p, v3 after it, due then, and whether the work law ended it.
    """
    p = 0.0
    if v3 < 0.0:
        if r <= 0.0 or -v3 > r * limit:
            return limit, v3 + r * limit, due - ee * (v3 + 0.5 * r * limit) * limit, False
        p = -v3 / r
        due += ee * 0.5 * v3 * v3 / r
        v3 = 0.0
    if due <= 0.0:
        return p, v3, 0.0, True
    under = v3 * v3 + 2.0 * r * due
    root = np.sqrt(max(under, 0.0))
    left = limit - p
    if under >= 0.0 and 2.0 * due <= (v3 + root) * left:
        return p + 2.0 * due / (v3 + root), root, 0.0, True
    turn = v3 * v3 / (-2.0 * r) if r < 0.0 else 0.0  # work given back until v3 falls through zero
    v3 += r * left
    if r < 0.0 and v3 < 0.0:
        return limit, v3, due - turn + ee * 0.5 * v3 * v3 / -r, False
    return limit, v3, due - (v3 - 0.5 * r * left) * left, False


@inner
def principal(k):
    """Principal values l1 >= l2 of Ktt, direction (c, s) of the first, and the parts b1, b2 of (K13, K23) along them.

    A value below round-off is a direction that no impulse moves; it couples to nothing (b² <= l K33): there b = 0.
    """
    c, s = 1.0, 0.0
    l1, l2 = k[0], k[1]
    if k[3] != 0.0:
        z = (k[1] - k[0]) / (2.0 * k[3])  # Jacobi's rotation, the smaller angle
        t = 1.0 / (abs(z) + np.hypot(z, 1.0))
        t = -t if z < 0.0 else t
        l1, l2 = k[0] - t * k[3], k[1] + t * k[3]
        c = 1.0 / np.hypot(t, 1.0)
        s = -t * c
    if l2 > l1:
        l1, l2 = l2, l1
        c, s = -s, c
    b1, b2 = c * k[4] + s * k[5], c * k[5] - s * k[4]
    least = 64.0 * EPS * (k[0] + k[1] + k[2])  # round-off of entries that were sums of a few products of this size
    if l1 <= least:
        l1, b1 = 0.0, 0.0
    if l2 <= least:
        l2, b2 = 0.0, 0.0
    return l1, l2, c, s, b1, b2


@inner
def at_rest(k, mu):
    """Where slip has halted: (f1, f2) tangential impulse, r rise of v3, both by normal impulse; and does it stick?

    r = 0: locked, no normal impulse can lift the contact.
    """
    l1, l2, c, s, b1, b2 = principal(k)
    x = b1 / l1 if l1 > 0.0 else 0.0
    y = b2 / l2 if l2 > 0.0 else 0.0
    if x * x + y * y <= mu * mu:
        given = b1 * x + b2 * y
        r = k[2] - given
        noise = k[2]  # of the difference: b²/l inherits the error of l, relative to l
        if l1 > 0.0:
            noise += b1 * x * (k[2] + l1) / l1
        if l2 > 0.0:
            noise += b2 * y * (k[2] + l1) / l2
        if r <= 64.0 * EPS * noise:
            r = 0.0
        return s * y - c * x, -s * x - c * y, r, True
    x, y = diverging(mu * l1, mu * l2, b1, b2)
    d1, d2 = c * x - s * y, s * x + c * y
    return -mu * d1, -mu * d2, k[2] - mu * (k[4] * d1 + k[5] * d2), False


@inner
def diverging(a1, a2, b1, b2):
    """Unit vector along the ray that leaves rest: (b1, b2) / (a + g) with g > 0, a1 >= a2 >= 0; it exists.

    Newton on 1/|d(g)| = 1, which is concave and grows: from the left it never overshoots (Moré & Sorensen 1983).
    """
    size = np.hypot(b1, b2)
    g = max(size - a1, 0.0)
    x, y = 1.0, 0.0
    for _ in range(60):  # measured: 2 in the mean, 15 at most in 4e4 systems of any condition
        p, q = a1 + g, a2 + g
        x = b1 / p if b1 != 0.0 else 0.0
        y = b2 / q if b2 != 0.0 else 0.0
        n = np.hypot(x, y)
        fall = x * x / p + (y * y / q if y != 0.0 else 0.0)
        more = (n - 1.0) * n * n / fall
        if not more > 2.0 * EPS * g:
            break
        g += more
    n = np.hypot(x, y)
    return x / n, y / n
