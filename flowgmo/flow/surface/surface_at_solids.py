"""The liquid's surface in cells near solids: level water stays level whatever stands in it.

F is liquid per open volume, so that a level surface has another F in a cell that a solid cuts than in the cell beside
it, and none at all in a closed one. What neighbours can say is therefore turned into the **level** of the liquid in
them: along axis d, the share h of the cell up to which its open part holds V F of liquid. The open part is taken as
s . xi <= beta with

    s = (Ax[-] - Ax[+], Ay[-] - Ay[+], Az[-] - Az[+])      since the area vectors of a closed body sum to zero (Gauss)

and beta from V (plic.plane_offset): exact where the solid's surface is a plane in the cell. Below the level h lies a
box cut by a plane, whose volume is known in closed form (plic.volume_under), so that h is the root of a cubic, found
by Newton inside a bracket. Heights of columns are sums of levels: where the surface is level, all are the same to
round-off, their slopes are zero, and the plane is level.

A column says nothing, and is left out (the slope is then one-sided, or zero), where
    its middle cell is closed;
    it is dry and its lowest open cell is cut: the surface has met the solid before it (a beach), or
    full and its highest open cell is cut (under a slanting ceiling).
A closed cell below the surface counts as full, above it as empty: it is the same for all columns.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.surface.plic import EMPTY, FULL, is_mixed, plane_offset, stretched, volume_under
from flowgmo.kernel import inner

ROOT_STEPS = 60  # Newton in a bracket ends after 3 to 7 (measured), bisection alone after 52

#: share of the largest rise: along an axis with less the surface has slopes of hundreds. Where columns say nothing
#: their slope is 0, and round-off in place of a rise would stand level water upright
FAINT = 1e-3


@inner
def solid_plane(opened, i, j, k):
    """(s, beta): the open part of cell (i, j, k) is s . xi <= beta, xi in 0 .. 1. s = 0: no plane, evenly porous."""
    s = (
        opened.Ax[i - 1, j, k] - opened.Ax[i, j, k],
        opened.Ay[i, j - 1, k] - opened.Ay[i, j, k],
        opened.Az[i, j, k - 1] - opened.Az[i, j, k],
    )
    return s, plane_offset(s, opened.V[i, j, k])


@inner
def _has_plane(s):
    return abs(s[0]) + abs(s[1]) + abs(s[2]) > 0.0


@inner
def open_in_slab(s, beta, d, low, high):
    """Open volume of low < xi_d < high in shares of the cell: how much liquid it holds when that part is under water.

    The initial surface, if level, is still to round-off when V F of a cut cell is this of 0 .. level.
    """
    return (high - low) * volume_under(stretched(s, d, high - low), beta - s[d] * low)


@inner
def level_in_cut_cell(s, beta, V, F, d, up):
    """Share h of the cell, from below (up = 1) or from above (up = -1), that is under water along axis d.

    The volume V F [of the cell] lies in the open part between the wet side and h.
    """
    if F <= EMPTY:
        return 0.0
    if F >= FULL:
        return 1.0
    if up < 0.0:  # the mirrored cell
        beta -= s[d]
        s = stretched(s, d, -1.0)
    beyond = stretched(s, d, 0.0)
    target, low, high, h = V * F, 0.0, 1.0, F
    for _ in range(ROOT_STEPS):
        missing = target - h * volume_under(stretched(s, d, h), beta)
        if missing > 0.0:
            low = h
        else:
            high = h
        area = volume_under(beyond, beta - s[d] * h)  # of the open cross-section at h: the derivative
        step = missing / area if area > 0.0 else 2.0
        new = h + step
        if not (new >= low and new <= high):
            new = 0.5 * (low + high)
        done = abs(new - h) <= 1e-15  # of a cell: round-off
        h = new
        if done:
            break
    return h


@inner
def _level(F, opened, i, j, k, d, up, closed):
    """Level in any cell: F where it is wholly open, `closed` where it is closed."""
    V, f = opened.V[i, j, k], F[i, j, k]
    if V <= 0.0:
        return closed
    if V < 1.0 and is_mixed(f):
        s, beta = solid_plane(opened, i, j, k)
        if _has_plane(s):
            return level_in_cut_cell(s, beta, V, f, d, up)
    return f


@inner
def _height_at(F, opened, steps, i, j, k, d, up):
    """(known, height) of the liquid in three cells along d, in widths of the middle one, from the wet side."""
    V = opened.V
    if V[i, j, k] <= 0.0:
        return False, 0.0
    a = np.int64(up)
    di, dj, dk = (a if d == 0 else 0), (a if d == 1 else 0), (a if d == 2 else 0)
    V_wet, V_dry = V[i - di, j - dj, k - dk], V[i + di, j + dj, k + dk]
    F_wet, F_dry = F[i - di, j - dj, k - dk], F[i + di, j + dj, k + dk]
    lowest = V_wet if V_wet > 0.0 else V[i, j, k]
    highest = V_dry if V_dry > 0.0 else V[i, j, k]
    middle = F[i, j, k]
    dry = middle <= EMPTY and (V_wet <= 0.0 or F_wet <= EMPTY) and (V_dry <= 0.0 or F_dry <= EMPTY)
    full = middle >= FULL and (V_wet <= 0.0 or F_wet >= FULL) and (V_dry <= 0.0 or F_dry >= FULL)
    if (dry and lowest < 1.0) or (full and highest < 1.0):
        return False, 0.0
    n = i if d == 0 else (j if d == 1 else k)
    t = steps.x if d == 0 else (steps.y if d == 1 else steps.z)
    wet = _level(F, opened, i - di, j - dj, k - dk, d, up, 1.0) * (t[3, n] if up > 0.0 else t[2, n])
    air = _level(F, opened, i + di, j + dj, k + dk, d, up, 0.0) * (t[2, n] if up > 0.0 else t[3, n])
    return True, _level(F, opened, i, j, k, d, up, 0.0) + (wet + air)


@inner
def _slope(F, opened, steps, i, j, k, d, up, e, here):
    """Slope of the height along d in direction e, from those of the two neighbouring columns that say something."""
    di, dj, dk = (1 if e == 0 else 0), (1 if e == 1 else 0), (1 if e == 2 else 0)
    n = i if e == 0 else (j if e == 1 else k)
    t = steps.x if e == 0 else (steps.y if e == 1 else steps.z)
    below, low = _height_at(F, opened, steps, i - di, j - dj, k - dk, d, up)
    above, high = _height_at(F, opened, steps, i + di, j + dj, k + dk, d, up)
    if below and above:
        return t[0, n] * (high - here) - t[1, n] * (low - here)
    if above:
        return (high - here) / (0.5 + 0.5 * t[2, n])
    if below:
        return (here - low) / (0.5 + 0.5 * t[3, n])
    return 0.0


@inner
def _rise(F, V, i, j, k, d):
    """F beyond the cell along d less F before it, over five neighbouring lines; closed cells say nothing."""
    di, dj, dk = (1 if d == 0 else 0), (1 if d == 1 else 0), (1 if d == 2 else 0)
    total = 2.0 * _rise_on_line(F, V, i, j, k, di, dj, dk)
    # the two other axes; opposite lines first, so that mirroring changes no bit
    ei, ej, ek = dk, di, dj
    total += _rise_on_line(F, V, i - ei, j - ej, k - ek, di, dj, dk) + _rise_on_line(
        F, V, i + ei, j + ej, k + ek, di, dj, dk
    )
    ei, ej, ek = dj, dk, di
    return total + (
        _rise_on_line(F, V, i - ei, j - ej, k - ek, di, dj, dk)
        + _rise_on_line(F, V, i + ei, j + ej, k + ek, di, dj, dk)
    )


@inner
def _rise_on_line(F, V, i, j, k, di, dj, dk):
    if V[i, j, k] <= 0.0:
        return 0.0
    here = F[i, j, k]
    high = F[i + di, j + dj, k + dk] if V[i + di, j + dj, k + dk] > 0.0 else here
    low = F[i - di, j - dj, k - dk] if V[i - di, j - dj, k - dk] > 0.0 else here
    return high - low


@inner
def plane_at_solids(F, opened, steps, i, j, k):
    """(m, alpha) of the surface in the mixed cell (i, j, k) that is cut or has cut or closed neighbours.

    Along the axis of least slope; a cut cell's plane goes through its level at the middle of the cell.
    """
    best, axis, up = np.inf, -1, 1.0
    best_e, best_f = 0.0, 0.0
    rises = _rise(F, opened.V, i, j, k, 0), _rise(F, opened.V, i, j, k, 1), _rise(F, opened.V, i, j, k, 2)
    least = FAINT * max(abs(rises[0]), abs(rises[1]), abs(rises[2]))
    for d in range(2, -1, -1):
        rise = rises[d]
        if abs(rise) <= least:
            continue
        side = 1.0 if rise < 0.0 else -1.0
        here = _height_at(F, opened, steps, i, j, k, d, side)[1]
        e, f = (d + 1) % 3, (d + 2) % 3
        slope_e = _slope(F, opened, steps, i, j, k, d, side, e, here)
        slope_f = _slope(F, opened, steps, i, j, k, d, side, f, here)
        if abs(slope_e) + abs(slope_f) < best:
            best, axis, up, best_e, best_f = abs(slope_e) + abs(slope_f), d, side, slope_e, slope_f
    if axis < 0:
        return (0.0, 0.0, 0.0), 0.0
    m = _vector(axis, up, -best_e, -best_f)
    s, beta = solid_plane(opened, i, j, k)
    V = opened.V[i, j, k]
    if V >= 1.0 or not _has_plane(s):
        return m, plane_offset(m, F[i, j, k])
    level = level_in_cut_cell(s, beta, V, F[i, j, k], axis, up)
    return m, 0.5 * (m[0] + m[1] + m[2]) + (level - 0.5)


@inner
def _vector(d, along, e, f):
    """The triple with `along` on axis d, e on the next and f on the one after."""
    if d == 0:
        return along, e, f
    if d == 1:
        return f, along, e
    return e, f, along


@inner
def share_in_cut_cell(m, alpha, opened, i, j, k, F, d, low, high):
    """Liquid share of the open part of low < xi_d < high in a cut cell.

    The surface is taken as level across the slab, at its height in the slab's middle: exact for level water.
    """
    s, beta = solid_plane(opened, i, j, k)
    if not _has_plane(s):
        return volume_under(stretched(m, d, high - low), alpha - m[d] * low)
    room = open_in_slab(s, beta, d, low, high)
    axis = 2 if abs(m[2]) >= max(abs(m[0]), abs(m[1])) else (1 if abs(m[1]) >= abs(m[0]) else 0)
    if not room > 0.0 or m[axis] == 0.0:
        return min(max(F, 0.0), 1.0)
    rest = alpha - 0.5 * (m[0] + m[1] + m[2]) + 0.5 * m[axis]
    if axis == d:
        level = rest / m[d]
        under = (low, min(max(level, low), high)) if m[d] > 0.0 else (max(min(level, high), low), high)
        return min(open_in_slab(s, beta, d, under[0], under[1]) / room, 1.0)
    level = min(max((rest - m[d] * (0.5 * (low + high) - 0.5)) / m[axis], 0.0), 1.0)
    thick = high - low
    slab, beta = stretched(s, d, thick), beta - s[d] * low
    start, tall = (0.0, level) if m[axis] > 0.0 else (level, 1.0 - level)
    return min(tall * volume_under(stretched(slab, axis, tall), beta - s[axis] * start) * thick / room, 1.0)
