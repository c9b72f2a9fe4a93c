"""Slip that turns during an impact: the curved part of the hodograph, by Taylor series.

By normal impulse p the slip u = (v1, v2), s = |u|, follows du/dp = b - μ Ktt u/s, which is singular where s passes near
zero. In the variable dτ = dp/s everything is smooth there, and a halt lies at τ = ∞:

    du/dτ  = b s - μ Ktt u            b = (K13, K23)
    dp/dτ  = s,    dp_t/dτ = -μ u
    dv3/dτ = R = K33 s - μ b·u
    dW/dτ  = s v3

Only the products u·u = s² and s v3 are not linear, so the series in τ of any order follow by recurrence, k s_k from
Σ s_j s_{k-j} = Σ u_j·u_{k-j} (Cauchy products). A step is as long as its last terms are round-off; its polynomials
are also the dense output in which events are found: R = 0, v3 = 0, the work law. A step ends at an event, so v3 is
monotonic in it and each event is one root, bracketed. (v3 could turn twice within a step, where u passes b closely;
found by comparing 40 000 impacts with steps 80 times shorter: 1 in 1000, none of them with an error above 4e-13.)

The direction of u turns one way only, towards an invariant ray (straight.py) that it nears exponentially in τ: where
its turning h has become round-off, the rest is straight; where s has, slip has halted.

Source: the flow of the slip, Batlle 1996, Stronge 2000 ch. 4; Taylor steps with such a length, Jorba & Zou 2005.
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.straight import EPS, along_slip
from flowgmo.kernel import inner

ORDER = 20  # fewer terms make more steps, and a step costs order²: 16 to 24 are within 1.5 times of the least time
MOST = 5000  # steps. Boxes: 3 in the median, 15 in the mean, 150 at most; rods 1e4 times their width: 3300
FAR = 1e8  # impulse in units of |v|/K: beyond, K J is a difference of numbers whose round-off is that of the energy
ON_RAY, HALTED, ENDED, WEDGED, GAVE_UP = range(5)
U1, U2, S, R, V3, W = range(6)  # rows of series


@inner
def turning_slip(k, v, ee, mu):
    """Follow the slip from v (triple) until it runs straight, halts, or the work law ends the impact.

    k inverse mass with largest diagonal entry 1, v scaled to 1 (impact_exact.py), v3 < 0, slip not zero; ee = e².
    Returns v, impulse (triples), energy due to restitution, how it ended (ON_RAY ...), whether v3 ever fell while
    negative (jam), steps.
    """
    c = np.empty((6, ORDER + 1))
    y = np.zeros(9)  # values of the rows, then the integrals of the first three: the impulse
    y[U1], y[U2], y[V3] = v
    due = 0.0
    compressing, jammed = v[2] < 0.0, False
    unit = 1.0 / (mu * (k[0] + k[1]) + np.hypot(k[4], k[5]))  # of τ: rates of order 1 for any μ
    end = GAVE_UP
    steps = np.int64(0)
    while steps < MOST:
        s = np.hypot(y[U1], y[U2])
        if s <= EPS / 16.0:  # of the largest velocity at the start: less than its round-off
            y[U1], y[U2] = 0.0, 0.0
            end = HALTED
            break
        _, h, r = along_slip(k, y[U1] / s, y[U2] / s, mu)
        if abs(h) * unit <= 32.0 * EPS:  # round-off of h
            end = ON_RAY
            break
        if steps == 0:
            rising = r > 0.0
        steps += 1
        jammed = jammed or (compressing and not rising)
        dt = expand(c, k, y[U1], y[U2], y[V3], mu, unit)
        dt, turned, crossed, ended = first_event(c, dt, rising, compressing, due)
        advance(c, y, dt)
        due -= ee * y[W] if compressing else y[W]
        if turned:
            rising = not rising
        if crossed:
            y[V3] = 0.0
            compressing = not compressing
        if ended or (crossed and due <= 0.0):
            end = ENDED
            break
        if unit * y[8] > FAR:
            end = WEDGED
            break
    mu *= unit
    return (y[U1], y[U2], y[V3]), (-mu * y[6], -mu * y[7], unit * y[8]), max(due, 0.0), end, jammed, steps


@inner
def first_event(c, dt, rising, compressing, due):
    """Shorten a step dt to its first event.

    Returns dt, and which it was: v3 turned (rising became falling or back), it changed sign, the work law is met.
    """
    found = -1
    for row in (R, V3, W):  # in this order: v3 is monotonic up to a root of R, W up to one of v3
        x = value(c, row, dt)
        target = 0.0
        if row == R:
            met = (x > 0.0) != rising
        elif row == V3:
            met = (x >= 0.0) == compressing
        else:
            target = due
            met = not compressing and x >= due
        if met:
            dt = root(c, row, dt, target)
            found = row
    return dt, found == R, found == V3, found == W


@inner
def expand(c, k, v1, v2, v3, mu, unit):
    """Fill the series c (6, ORDER + 1) at the state given; returns how far they reach to round-off."""
    c[U1, 0], c[U2, 0], c[S, 0], c[V3, 0], c[W, 0] = v1, v2, np.hypot(v1, v2), v3, 0.0
    half = 0.5 / c[S, 0]
    order = c.shape[1] - 1  # not ORDER: loops of known length are unrolled, a fifth more code to compile
    m = mu * unit
    for n in range(order + 1):
        if n > 0:  # each product comes twice, but the middle one; the two of S_0 S_n are not known yet
            square = 2.0 * (c[U1, 0] * c[U1, n] + c[U2, 0] * c[U2, n])
            for j in range(1, (n + 1) // 2):
                x, y, s = c[U1, j] * c[U1, n - j], c[U2, j] * c[U2, n - j], c[S, j] * c[S, n - j]
                square += 2.0 * (x + y - s)
            if n % 2 == 0:
                x, y, s = c[U1, n // 2], c[U2, n // 2], c[S, n // 2]
                square += x * x + y * y - s * s
            c[S, n] = half * square
        x, y, s = c[U1, n], c[U2, n], c[S, n]
        c[R, n] = unit * k[2] * s - m * (k[4] * x + k[5] * y)
        if n < order:
            power, other = 0.0, 0.0  # two sums: the processor works on both at once
            for j in range((n + 1) // 2):
                power += c[S, j] * c[V3, n - j]
                other += c[S, n - j] * c[V3, j]
            if n % 2 == 0:
                power += c[S, n // 2] * c[V3, n // 2]
            over = 1.0 / (n + 1.0)
            c[U1, n + 1] = over * (unit * k[4] * s - m * (k[0] * x + k[3] * y))
            c[U2, n + 1] = over * (unit * k[5] * s - m * (k[3] * x + k[1] * y))
            c[V3, n + 1] = over * c[R, n]
            c[W, n + 1] = over * unit * (power + other)
    s = EPS * c[S, 0]
    reach = 4.0  # decays by e^-4 at most: where the series end by themselves
    for n in range(order - 1, order + 1):
        last = abs(c[U1, n]) + abs(c[U2, n]) + abs(c[S, n])
        if last > 0.0:
            reach = min(reach, (s / last) ** (1.0 / n))
    return reach


@inner
def value(c, row, x):
    """Series of a row at x."""
    y = 0.0
    for n in range(c.shape[1] - 1, -1, -1):
        y = y * x + c[row, n]
    return y


@inner
def advance(c, y, x):
    """The state after a step x: the rows at x, and their first three integrals added, all in one pass."""
    u1, u2, s, v3, w = 0.0, 0.0, 0.0, 0.0, 0.0
    p1, p2, p = 0.0, 0.0, 0.0
    for n in range(c.shape[1] - 1, -1, -1):
        over = 1.0 / (n + 1.0)
        u1, p1 = u1 * x + c[U1, n], p1 * x + over * c[U1, n]
        u2, p2 = u2 * x + c[U2, n], p2 * x + over * c[U2, n]
        s, p = s * x + c[S, n], p * x + over * c[S, n]
        v3, w = v3 * x + c[V3, n], w * x + c[W, n]
    y[U1], y[U2], y[S], y[V3], y[W] = u1, u2, s, v3, w
    y[6] += p1 * x
    y[7] += p2 * x
    y[8] += p * x


@inner
def root(c, row, hi, target):
    """Where the series of a row reaches target, between 0 and hi; Newton, bisected where it leaves the bracket."""
    lo = 0.0
    end = value(c, row, hi)
    up = end > target
    x = hi * (target - c[row, 0]) / (end - c[row, 0]) if end != c[row, 0] else 0.5 * hi
    if not (lo < x < hi):
        x = 0.5 * hi
    for _ in range(100):  # bisection alone takes 60
        y, slope = 0.0, 0.0
        for n in range(c.shape[1] - 1, -1, -1):
            slope = slope * x + y
            y = y * x + c[row, n]
        y -= target
        if (y > 0.0) == up:
            hi = x
        else:
            lo = x
        old = x
        x = x - y / slope if slope != 0.0 else lo
        if not (lo < x < hi):
            x = 0.5 * (lo + hi)
        if abs(x - old) <= 2.0 * EPS * hi:
            break
    return x
