"""A plane in a cell: the geometry of piecewise linear interface calculation (PLIC).

In a cell scaled to the unit cube, xi = (x - x_low) / dx, the liquid is m . xi <= alpha. The plane's vector m points
out of the liquid; for a normal n in space m = (n_x dx, n_y dy, n_z dz), so that nothing below asks for the cell's
size. Mirroring the axes with m_i < 0 (xi -> 1 - xi, alpha -> alpha + |m_i|), dividing by |m_x| + |m_y| + |m_z| and
sorting leaves 0 <= m1 <= m2 <= m3, m1 + m2 + m3 = 1 and, F(1 - alpha) = 1 - F(alpha), alpha <= 1/2. The liquid under
the plane is a tetrahedron less those that stick out of the cube:

    F(alpha) = (alpha^3 - sum (alpha - m_i)^3 + sum (alpha - m_i - m_j)^3) / (6 m1 m2 m3)      terms > 0 only

Scardovelli and Zaleski 2000 ("Analytical relations connecting linear interfaces and volume fractions", J. Comput.
Phys. 164). As written, it loses all digits when m1 is small. alpha^3 - (alpha - m1)^3 divides by m1 in
closed form, and what then still has m1 below it is a cube of something smaller than m1: this form keeps round-off.

The inverse is closed too, but for alpha between m2 and min(m1 + m2, 1/2). There F is convex and rises, so that Newton
from the upper end comes down to the root without a miss.
"""

from __future__ import annotations

import numpy as np

from flowgmo.kernel import inner

EMPTY = 1e-12  # [-] F below it is dust, above 1 - EMPTY full: no plane. 1e4 x round-off, for 1e4 steps of it
FULL = (
    1.0 - 1e-6
)  # [-] F above it has no plane: what the pressure leaves open in full cells (stages.TOLERANCE) is spread evenly
NEWTON_STEPS = 30  # ends by itself after 3 to 6 (measured); the bound only makes it certain


@inner
def is_mixed(F):
    """Whether a cell with this fraction gets a plane."""
    return F > EMPTY and F < FULL


@inner
def _sorted(a, b, c):
    """The three numbers in rising order."""
    low, high = min(a, b), max(a, b)
    return min(low, c), max(low, min(high, c)), max(high, c)


@inner
def _under(m1, m2, m3, alpha):
    """F(alpha) for sorted m with sum 1 and 0 <= alpha <= 1/2."""
    if alpha < m1:
        return alpha * alpha * alpha / (6.0 * m1 * m2 * m3)
    if alpha >= m1 + m2:
        return (alpha - 0.5 * (m1 + m2)) / m3
    full = 3.0 * alpha * (alpha - m1) + m1 * m1
    if alpha > m2:
        full -= (alpha - m2) ** 3 / m1
    if alpha > m3:
        full -= (alpha - m3) ** 3 / m1
    return full / (6.0 * m2 * m3)


@inner
def _offset(m1, m2, m3, F):
    """alpha for sorted m with sum 1 and 0 <= F <= 1/2: the inverse of `_under`."""
    m12 = m1 + m2
    if m12 <= m3 and 2.0 * m3 * F >= m12:
        return m3 * F + 0.5 * m12
    scaled = 6.0 * m2 * m3 * F
    if scaled <= m1 * m1:
        return np.cbrt(m1 * scaled)
    if scaled <= m1 * m1 + 3.0 * m2 * (m2 - m1):
        return 0.5 * (m1 + np.sqrt(m1 * m1 + (4.0 / 3.0) * (scaled - m1 * m1)))
    alpha = min(m12, 0.5)
    for _ in range(NEWTON_STEPS):
        p, q = alpha - m2, max(alpha - m3, 0.0)
        value = 3.0 * alpha * (alpha - m1) + m1 * m1 - (p * p * p + q * q * q) / m1 - scaled
        slope = 6.0 * alpha - 3.0 * m1 - 3.0 * (p * p + q * q) / m1
        step = value / slope
        alpha -= step
        if step <= 1e-14 * alpha:  # quadratic: the next step would be below round-off; < 0 means it is there
            break
    return alpha


@inner
def plane_offset(m, F):
    """alpha of the plane m . xi = alpha that leaves the share F of the cell on the liquid's side, to round-off.

    m triple [any unit], F in [0, 1] (beyond: as at the end). F = 0 and 1 give planes that touch a corner. m = 0: 0.
    """
    a, b, c = abs(m[0]), abs(m[1]), abs(m[2])
    total = a + b + c
    below = min(m[0], 0.0) + min(m[1], 0.0) + min(m[2], 0.0)
    if not total > 0.0:
        return 0.0
    m1, m2, m3 = _sorted(a / total, b / total, c / total)
    F = min(max(F, 0.0), 1.0)
    if F <= 0.5:
        return total * _offset(m1, m2, m3, F) + below
    return total - total * _offset(m1, m2, m3, 1.0 - F) + below


@inner
def volume_under(m, alpha):
    """Share [0, 1] of the unit cube with m . xi <= alpha, to round-off (`plane_offset` inverts it)."""
    a, b, c = abs(m[0]), abs(m[1]), abs(m[2])
    total = a + b + c
    alpha -= min(m[0], 0.0) + min(m[1], 0.0) + min(m[2], 0.0)
    if alpha <= 0.0:
        return 0.0
    if alpha >= total:
        return 1.0
    m1, m2, m3 = _sorted(a / total, b / total, c / total)
    if alpha <= 0.5 * total:
        return _under(m1, m2, m3, alpha / total)
    return 1.0 - _under(m1, m2, m3, (total - alpha) / total)


@inner
def stretched(m, d, scale):
    """m with component d multiplied by scale: the same plane seen from a box that is `scale` as long in direction d."""
    return (
        m[0] * scale if d == 0 else m[0],
        m[1] * scale if d == 1 else m[1],
        m[2] * scale if d == 2 else m[2],
    )


@inner
def is_plane(m):
    """False for m = 0: nothing says where in the cell the liquid lies."""
    return m[0] != 0.0 or m[1] != 0.0 or m[2] != 0.0


@inner
def share_of_slab(m, alpha, d, low, high):
    """Liquid share of the slab low < xi_d < high of the cell, for fluxes. d 0, 1, 2; 0 <= low < high <= 1."""
    return volume_under(stretched(m, d, high - low), alpha - m[d] * low)


@inner
def signed_distance(m, alpha, widths, point):
    """Distance [length] of a point from the plane, > 0 outside the liquid.

    widths (dx, dy, dz) of the cell; point [length] from the cell's lowest corner. m = 0: inf.
    """
    n = (m[0] / widths[0], m[1] / widths[1], m[2] / widths[2])
    size = np.sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2])
    return (n[0] * point[0] + n[1] * point[1] + n[2] * point[2] - alpha) / size if size > 0.0 else np.inf


@inner
def crossing(m, alpha, d):
    """Where the line through the cell's centre along axis d meets the plane, in cell widths from the centre.

    Signed, along +d; outside -1/2 .. 1/2 the plane is met beyond the cell. inf where the line runs along the plane.
    """
    missing = alpha - 0.5 * (m[0] + m[1] + m[2])
    return missing / m[d] if m[d] != 0.0 else np.inf


@inner
def polygon(m, alpha, out):
    """Corners of the plane's cut through the unit cube, in order around it, for pictures; returns how many, 0 or 3..6.

    out (>= 8, 3): the face of the cube with the largest |m_d| is clipped by 0 <= xi_d <= 1 after lifting it onto the
    plane, so that each corner is a lift of a point of a square: Sutherland and Hodgman 1974.
    """
    d = 0
    if abs(m[1]) > abs(m[d]):
        d = 1
    if abs(m[2]) > abs(m[d]):
        d = 2
    if m[d] == 0.0:
        return np.int64(0)
    e, f = (d + 1) % 3, (d + 2) % 3
    for corner in range(4):
        x = 1.0 if corner in (1, 2) else 0.0
        y = 1.0 if corner >= 2 else 0.0
        out[corner, e], out[corner, f] = x, y
        out[corner, d] = (alpha - m[e] * x - m[f] * y) / m[d]
    n = _clip(out, np.int64(4), d, 0.0, 1.0)
    return _clip(out, n, d, 1.0, -1.0)


@inner
def _clip(points, n, d, bound, sense):
    """Keep of the polygon points[:n] what has sense (xi_d - bound) >= 0; returns the new count. In place: one corner
    that is cut off gives way to at most two."""
    kept = np.empty((8, 3))  # 4 corners and one more for each of two clips: 6, and room
    count = np.int64(0)
    for i in range(n):
        j = (i + 1) % n
        here, there = sense * (points[i, d] - bound), sense * (points[j, d] - bound)
        if here >= 0.0:
            for x in range(3):
                kept[count, x] = points[i, x]
            count += 1
        if (here > 0.0 and there < 0.0) or (here < 0.0 and there > 0.0):
            t = here / (here - there)
            for x in range(3):
                kept[count, x] = points[i, x] + t * (points[j, x] - points[i, x])
            kept[count, d] = bound
            count += 1
    if count < 3:
        return np.int64(0)
    for i in range(count):
        for x in range(3):
            points[i, x] = kept[i, x]
    return count
