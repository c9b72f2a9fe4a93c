"""Friction of one contact in one step of a cluster: which tangential impulse obeys Coulomb's law.

With all other impulses given, the slip v at the start of the step ends as b + K Δ, Δ the tangential impulse,
|Δ| <= μ Δn.

Stick   Δ = -K⁻¹ b when the cone holds it: the slip ends at zero.
Slip    Δ = -μ Δn d, d the direction of the mean slip (v + b + K Δ) / 2 = s d: the middle of the step, so that the
        scheme is of second order and the work of friction, s d·Δ, is exactly negative. s is the root of

            |(s + ½ μ Δn K)⁻¹ (v + b) / 2| = 1,

        a falling function of s: Newton from the left on its reciprocal, which is concave, converges (the trust-region
        equation; Moré & Sorensen 1983).
"""

from __future__ import annotations

import numpy as np

from flowgmo.kernel import inner


@inner
def _solved(kxx, kyy, kxy, s, x, y):
    """(K + s)⁻¹ (x, y) of a symmetric 2 x 2 matrix."""
    a, c = kxx + s, kyy + s
    inverse = 1.0 / (a * c - kxy * kxy)
    return (c * x - kxy * y) * inverse, (a * y - kxy * x) * inverse


@inner
def coulomb(kxx, kyy, kxy, vx, vy, bx, by, limit, near):
    """Tangential impulse (two numbers) of a contact, and the mean slip speed s (near, where it sticks).

    limit = μ Δn [impulse]; K positive semi-definite; near [velocity]: an s to begin with, of a sweep before.
    """
    if limit <= 0.0:
        return 0.0, 0.0, near
    floor = 1e-13 * (kxx + kyy)  # a direction in which nothing moves (fixed point, axis) must not divide by zero
    if floor > 0.0:
        x, y = _solved(kxx, kyy, kxy, floor, bx, by)
        held = abs(x) <= limit and abs(y) <= limit  # first without squares, which vanish for the smallest numbers
        if held and x * x + y * y <= limit * limit and vx * x + vy * y >= 0.0:
            return -x, -y, near
    cx, cy = 0.5 * (vx + bx), 0.5 * (vy + by)
    size = np.sqrt(cx * cx + cy * cy)
    if size == 0.0:
        return 0.0, 0.0, near
    half = 0.5 * limit
    kxx, kyy, kxy = half * kxx, half * kyy, half * kxy
    s = 1e-13 * (kxx + kyy)  # as above
    if s > 0.0:
        x, y = _solved(kxx, kyy, kxy, s, cx, cy)
        if x * x + y * y <= 1.0:  # reverses within the step: no mean slip, no work
            return -limit * x, -limit * y, near
    least = max(s, size - kxx - kyy)  # left of the root: (s + K) d = c
    s = max(least, near)  # from the right of the root the first step leads to its left, for the reciprocal is concave
    for _ in range(30):  # converges quadratically from the left; with a good start one, seldom more than six
        x, y = _solved(kxx, kyy, kxy, s, cx, cy)
        r = np.sqrt(x * x + y * y)
        zx, zy = _solved(kxx, kyy, kxy, s, x, y)
        step = max(s + r * r * (r - 1.0) / (x * zx + y * zy), least) - s
        s += step
        if abs(step) <= 1e-6 * s:  # x - z step is then true to the square of that
            break
    x -= zx * step
    y -= zy * step
    r = np.sqrt(x * x + y * y)
    return -limit * x / r, -limit * y / r, s


@inner
def halt(s, still):
    """Fraction of a tried step of spring s after which its slip halts; 1 where it does not, or only at the end.

    A half where the slip turns by more than 60 degrees: it swerves past a minimum of its speed, in short steps.

    Whether it then sticks or turns is for a step that starts there to say: a step with a halt in its middle would
    take the sum of both frictions for a stick. Full friction along the first direction of slip, d, would end with

        w = v'·d - K_dd (μ Δn + Δ·d),    and v + (w - v) t / h = 0 gives t

    still [v_ref]: slip that is none: what sweeps leave of a stick, or less than the error of the steps. Nor does what
    halts in the first 1e-3 of a step count.
    """
    v = np.sqrt(s.v[0] * s.v[0] + s.v[1] * s.v[1])
    if v <= still:
        return 1.0
    x, y = s.v[0] / v, s.v[1] / v
    k = s.own[0, 0] * x * x + 2.0 * s.own[0, 1] * x * y + s.own[1, 1] * y * y
    w = s.end[0] * x + s.end[1] * y - k * (s.mu * s.dp[2] + s.dp[0] * x + s.dp[1] * y)
    t = v / (v - w) if w < 0.0 else 1.0
    if 1e-3 < t < 0.99:  # 0.99: near enough to the end, the rest is small in any case
        return t
    along = s.end[0] * x + s.end[1] * y
    after = np.sqrt(s.end[0] * s.end[0] + s.end[1] * s.end[1])
    return 0.5 if along < 0.5 * after and v > 1e-3 * after and after > still else 1.0
