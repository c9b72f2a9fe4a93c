"""Where the liquid of a cell is: first moments of what fills its open part, for potential energy.

Taken at the cell's centre, liquid that a surface or a wall leaves in one half of a cell is up to half a cell off: the
potential energy then stays as it is while a body moves through a cell, and jumps at its end.

    moment_d = integral of xi_d over the liquid        xi in 0 .. 1 over the cell, shares of the cell

**A plane** m . xi <= alpha in the unit cube. With A(h) its cross-section at xi_d = h, a square cut by a line,

    moment_d = integral of h A(h) dh

A is a quadratic polynomial between the heights at which the plane passes the four edges along d, h = (alpha - {0, m_e,
m_f, m_e + m_f}) / m_d; so two points of Gauss (exact for cubics) on each of three pieces give all but what lies before
them, where A = 1. Closed forms of the moment (Scardovelli and Zaleski 2000) lose all digits when some m is small.

**Mixed cells** that are wholly open: the plane of the surface. **Cut cells**: level liquid, along the axis which the
surface faces most, up to the volume V F; along the others the middle of the open part. The open part's cross-sections
are those of

    a plane s . xi <= beta with the porous share w (cut_level.py), exact for walls that are planes, or
    a step at a: A(0) below, A(1) above, V = a A(0) + (1 - a) A(1), exact for corners and edges of boxes along the mesh

whichever misses less of the faces of the cell: the step by

    r = |product of lengths - c| + sum of |1 - larger A|,    lengths c / |s_d|, c = 1 - V    solid in the corner
    r = |product of lengths - V| + sum of smaller A,         lengths V / |s_d|               liquid in the corner

A box longer than the cell goes through it: its length is 1, and the term of the sum is shared by its length. So no
round-off of s_d says which of both it is (a ball that floats still, half in the water: 4e-5 J to and fro, of 289).

Cells above plic.FULL are full, and hold what they hold evenly: at most 5e-7 of a cell off.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.surface.cut_level import has_plane, level_in_cut_cell, open_above, porous_share, solid_plane
from flowgmo.flow.surface.plic import is_mixed, is_plane, stretched, volume_under
from flowgmo.flow.surface.surface_normals import plane_at
from flowgmo.kernel import inner

GAUSS = 0.5 / np.sqrt(3.0)  # of a piece: the two points on either side of its middle


@inner
def area_under(small, large, c):
    """Share [0, 1] of the unit square with small x + large y <= c, to round-off; 0 <= small <= large."""
    if c <= 0.0:
        return 0.0
    if c >= small + large:
        return 1.0
    if c <= small:
        return c * c / (2.0 * small * large)
    if c <= large:
        return (c - 0.5 * small) / large
    left = small + large - c
    return 1.0 - left * left / (2.0 * small * large)


@inner
def _piece(small, large, c, n, low, high):
    """Integral of h A(h) over low < h < high, between edges; A(h): area of small x + large y <= c - n h."""
    mid, off = 0.5 * (low + high), GAUSS * (high - low)
    a, b = mid - off, mid + off
    return 0.5 * (high - low) * (a * area_under(small, large, c - n * a) + b * area_under(small, large, c - n * b))


@inner
def moment_under(m, alpha, d):
    """Integral of xi_d over the part m . xi <= alpha of the unit cube, to round-off. m triple, d 0, 1, 2."""
    n = m[d]
    if n == 0.0:
        return 0.5 * volume_under(m, alpha)
    if n < 0.0:  # the mirrored cube
        alpha -= n
    e, f = m[(d + 1) % 3], m[(d + 2) % 3]
    c = alpha - (min(e, 0.0) + min(f, 0.0))  # of the square with both mirrored to numbers >= 0
    small, large = min(abs(e), abs(f)), max(abs(e), abs(f))
    size = abs(n)
    h0 = min(max((c - (small + large)) / size, 0.0), 1.0)
    h1 = min(max((c - large) / size, h0), 1.0)
    h2 = min(max((c - small) / size, h1), 1.0)
    h3 = min(max(c / size, h2), 1.0)
    moment = 0.5 * h0 * h0
    for piece in range(3):
        low, high = (h0, h1) if piece == 0 else ((h1, h2) if piece == 1 else (h2, h3))
        if high > low:
            moment += _piece(small, large, c, size, low, high)
    return volume_under(stretched(m, d, -1.0), alpha) - moment if n < 0.0 else moment


@inner
def _ends(opened, i, j, k, d):
    """(A(0), A(1)) of a cell along d; V twice where the direction is absent."""
    m, n, o = (1 if d == 0 else 0), (1 if d == 1 else 0), (1 if d == 2 else 0)
    return open_above(opened, d, i - m, j - n, k - o), open_above(opened, d, i, j, k)


@inner
def box_misses(opened, s, i, j, k):
    """r above: how much of a cell's openings no corner of a box along the mesh explains."""
    return misses_of_box(
        _ends(opened, i, j, k, 0), _ends(opened, i, j, k, 1), _ends(opened, i, j, k, 2), opened.V[i, j, k], s
    )


@inner
def misses_of_box(x, y, z, V, s):
    """The same of a cell with the open volume V and the open faces (lower, upper) x, y, z; s as of solid_plane."""
    covered, held, solid, liquid = 1.0, 1.0, 0.0, 0.0
    for d in range(3):
        low, high = x if d == 0 else (y if d == 1 else z)
        of_solid, of_liquid = _share_of_length(s[d], 1.0 - V), _share_of_length(s[d], V)
        covered *= (1.0 - V) / abs(s[d]) if of_solid >= 1.0 else 1.0
        held *= V / abs(s[d]) if of_liquid >= 1.0 else 1.0
        solid += of_solid * (1.0 - max(low, high))
        liquid += of_liquid * min(low, high)
    return min(abs(covered - (1.0 - V)) + solid, abs(held - V) + liquid)


@inner
def _share_of_length(s, c):
    """The length of the cell in that of a box, c / |s|: 1 if it ends in the cell, 0 without an end."""
    return min(abs(s) / c, 1.0) if c > 0.0 else 0.0


@inner
def _of_step(low, high, V, T):
    """Integral of h A(h) up to the volume T, of A = low below a step and high above it; they hold V together."""
    a = min(max((V - high) / (low - high), 0.0), 1.0) if low != high else 1.0
    if T <= a * low or not high > 0.0:
        return 0.5 * T * T / low if low > 0.0 else 0.5 * T
    top = min(a + (T - a * low) / high, 1.0)
    return 0.5 * (a * a * low + (top - a) * (top + a) * high)


@inner
def moment_in_cut_cell(opened, i, j, k, d, F, up):
    """Integral of xi_d over the volume V F of level liquid in a cut cell; up 1: from below along d, -1: from above."""
    V = opened.V[i, j, k]
    s, beta = solid_plane(opened, i, j, k)
    w = porous_share(s, beta, opened, i, j, k, d)
    T = V * min(F, 1.0)
    if w > 0.0 and has_plane(s):
        low, high = _ends(opened, i, j, k, d)
        if box_misses(opened, s, i, j, k) < w:
            return _of_step(low, high, V, T) if up > 0.0 else T - _of_step(high, low, V, T)
    h = level_in_cut_cell(s, beta, w, V, F, d, up)
    if up < 0.0:
        beta -= s[d]
        s = stretched(s, d, -1.0)
    plane = moment_under(stretched(s, d, h), beta, d) if w < 1.0 else 0.0
    moment = h * h * (0.5 * w * V + (1.0 - w) * plane)
    return moment if up > 0.0 else T - moment


@inner
def _in_cut_cell(opened, i, j, k, F, axis, up, weights):
    """Sum of weights_d (moment_d - half of the volume) of liquid in a cut cell: level along `axis` with the dry side
    up, in the middle of the open part along the others. axis < 0: all lies evenly in the open part."""
    V, total = opened.V[i, j, k], 0.0
    for d in range(3):
        if weights[d] != 0.0:
            level, share = (F, 1.0) if d == axis else (1.0, F)
            moment = moment_in_cut_cell(opened, i, j, k, d, level, up if d == axis else 1.0)
            total += weights[d] * (share * moment - 0.5 * V * F)
    return total


@inner
def lean(F, V, opened, planes, i, j, k, weights):
    """Sum over d of weights_d (moment_d - half of the liquid's volume) of cell (i, j, k), which is mixed or cut.

    F (mesh) or None where all is liquid; V: opened.V (None: wholly open cells); planes (mesh, 4) of F (planes.py);
    weights triple [any unit]. 0 for cells whose liquid lies evenly around the centre.
    """
    fraction, m, alpha, mixed = 1.0, (0.0, 0.0, 0.0), 0.0, False
    if F is not None:
        fraction = max(F[i, j, k], 0.0)  # cells that close may lack a little for a step
        mixed = is_mixed(fraction)
        if mixed:
            m, alpha = plane_at(planes, i, j, k)
            mixed = is_plane(m)
    if V is not None:
        if V[i, j, k] < 1.0:
            axis = -1
            if mixed:
                axis = 2 if abs(m[2]) >= max(abs(m[0]), abs(m[1])) else (1 if abs(m[1]) >= abs(m[0]) else 0)
            up = 1.0 if axis < 0 or m[axis] > 0.0 else -1.0
            return _in_cut_cell(opened, i, j, k, fraction, axis, up, weights)
    total = 0.0
    if mixed:
        for d in range(3):
            if weights[d] != 0.0:
                total += weights[d] * (moment_under(m, alpha, d) - 0.5 * fraction)
    return total
