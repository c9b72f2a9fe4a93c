"""The liquid's surface in cells near solids: level water stays level whatever stands in it.

F is liquid per open volume, so that a level surface has another F in a cell that a solid cuts than in the cell beside
it, and none at all in a closed one. What neighbours can say is therefore turned into the **level** of the liquid in
them: along axis d, the share h of the cell up to which its open part holds V F of liquid. The open part is taken as
s . xi <= beta with

    s = (Ax[-] - Ax[+], Ay[-] - Ay[+], Az[-] - Az[+])      since the area vectors of a closed body sum to zero (Gauss)

and beta from V (plic.plane_offset): exact where the solid's surface is a plane in the cell. Below the level h lies a
box cut by a plane, whose volume is known in closed form (plic.volume_under), so that h is the root of a cubic, found
by Newton inside a bracket.

Heights of columns are sums of levels: where the surface is level, all are the same to round-off, their slopes are zero,
and the plane is level. A column says nothing, and is left out (the slope is then one-sided, or zero), where
    its middle cell is closed, or no open face leads to it, as behind a thin wall;
    it is dry and its lowest open cell is cut: the surface has met the solid before it (a beach), or
    full and its highest open cell is cut (under a slanting ceiling);
    the surface is hidden between a full cell and an empty one.
So are cells that are open by less than SLIT: their F is what round-off leaves of fluxes thousands of times as large as
they are. In the slit between a plug and the wall that it rests on (V = 1e-9, F from -131 to .9) they stood the surface
upright beside it, within a thousandth of a cell's centre, and faces open by a hundredth had 550 times their coefficient
in the pressure equation: 11 m/s where all else had 1 (hard/wet_plug_free).

What is closed, or behind a closed face of the column, counts as full below the surface and as empty above it: it is the
same for all columns. An image beyond a side has the level of its cell.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.fields import G
from flowgmo.flow.surface.cut_level import has_plane, level_of_cell, open_above, open_in_slab, reaches, solid_plane
from flowgmo.flow.surface.plic import EMPTY, FULL, plane_offset, stretched, volume_under
from flowgmo.kernel import inner

#: share of the largest rise: along an axis with less the surface has slopes of hundreds. Where columns say nothing
#: their slope is 0, and round-off in place of a rise would stand level water upright
FAINT = 1e-3
LEVEL = (
    0.25  # sum of two slopes: an axis with less, by the heights and as F falls, need not be compared with the others
)
LACK = 1e-3  # of a cell: beside bodies that move, liquid lacks 1e-6 to 1e-4 (short_cells.py)
SLIT = 1e-6  # of a cell: so little liquid takes no part (liquid.DUST)


@inner
def _hidden(F, opened, d, i, j, k, e, f, g, up):
    """Whether the surface lies in the solid between a full cell (i, j, k) and an empty one (e, f, g) next to it."""
    if F[i, j, k] < FULL or F[e, f, g] > EMPTY:
        return False
    dry_end = 0.0 if up > 0.0 else 1.0
    return not (reaches(opened, i, j, k, d, 1.0 - dry_end) and reaches(opened, e, f, g, d, dry_end))


@inner
def _is_image(F, d, i, j, k, e, f, g):
    """Whether the cell (e, f, g) next to (i, j, k) along d is its mirror image beyond a side."""
    n = e if d == 0 else (f if d == 1 else g)
    outside = n < G or n >= F.shape[d] - G
    return outside and F[e, f, g] == F[i, j, k]


@inner
def _height_at(F, opened, steps, i, j, k, d, up, least):
    """(known, height) of the liquid in three cells along d, in widths of the middle one, from the wet side; not known
    where the middle one is open by `least` or less."""
    V = opened.V
    if V[i, j, k] <= least:
        return False, 0.0
    a = np.int64(up)
    di, dj, dk = (a if d == 0 else 0), (a if d == 1 else 0), (a if d == 2 else 0)
    e, f, g = i - di, j - dj, k - dk
    x, y, z = i + di, j + dj, k + dk
    through_wet = open_above(opened, d, e, f, g) if up > 0.0 else open_above(opened, d, i, j, k)
    through_dry = open_above(opened, d, i, j, k) if up > 0.0 else open_above(opened, d, x, y, z)
    image_wet, image_dry = _is_image(F, d, i, j, k, e, f, g), _is_image(F, d, i, j, k, x, y, z)
    V_wet = V[e, f, g] if through_wet > 0.0 or image_wet else 0.0
    V_dry = V[x, y, z] if through_dry > 0.0 or image_dry else 0.0
    lowest = V_wet if V_wet > SLIT else V[i, j, k]
    highest = V_dry if V_dry > SLIT else V[i, j, k]
    middle = F[i, j, k]
    dry = middle <= EMPTY and (V_wet <= SLIT or F[e, f, g] <= EMPTY) and (V_dry <= SLIT or F[x, y, z] <= EMPTY)
    full = middle >= FULL and (V_wet <= SLIT or F[e, f, g] >= FULL) and (V_dry <= SLIT or F[x, y, z] >= FULL)
    if (dry and lowest < 1.0) or (full and highest < 1.0):
        return False, 0.0
    if V_wet > SLIT and _hidden(F, opened, d, e, f, g, i, j, k, up):
        return False, 0.0
    if V_dry > SLIT and _hidden(F, opened, d, i, j, k, x, y, z, up):
        return False, 0.0
    n = i if d == 0 else (j if d == 1 else k)
    t = steps.x if d == 0 else (steps.y if d == 1 else steps.z)
    own = level_of_cell(middle, opened, i, j, k, d, up)
    wet, air = 1.0, 0.0
    if V_wet > SLIT:  # an image has its cell's level: the solid in it is mirrored, and would say another
        wet = own if image_wet else level_of_cell(F[e, f, g], opened, e, f, g, d, up)
    if V_dry > SLIT:
        air = own if image_dry else level_of_cell(F[x, y, z], opened, x, y, z, d, up)
    wet *= t[3, n] if up > 0.0 else t[2, n]
    air *= t[2, n] if up > 0.0 else t[3, n]
    return True, own + (wet + air)


@inner
def _slope(F, opened, steps, i, j, k, d, up, e, here):
    """(known, slope) of the height along d in direction e, from those of the neighbouring columns that say something.

    What no open face leads to belongs to other liquid, as behind a thin wall. An image has no slope and is not known.
    """
    di, dj, dk = np.int64(e == 0), np.int64(e == 1), np.int64(e == 2)
    n = i if e == 0 else (j if e == 1 else k)
    t = steps.x if e == 0 else (steps.y if e == 1 else steps.z)
    below, low, above, high = False, 0.0, False, 0.0
    if open_above(opened, e, i - di, j - dj, k - dk) > 0.0:
        below, low = _height_at(F, opened, steps, i - di, j - dj, k - dk, d, up, SLIT)
    if open_above(opened, e, i, j, k) > 0.0:
        above, high = _height_at(F, opened, steps, i + di, j + dj, k + dk, d, up, SLIT)
    told = (below and not _is_image(F, e, i, j, k, i - di, j - dj, k - dk)) or (
        above and not _is_image(F, e, i, j, k, i + di, j + dj, k + dk)
    )
    if below and above:
        return told, t[0, n] * (high - here) - t[1, n] * (low - here)
    if above:
        return told, (high - here) / (0.5 + 0.5 * t[2, n])
    if below:
        return told, (here - low) / (0.5 + 0.5 * t[3, n])
    return False, 0.0


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
    if V[i, j, k] <= SLIT:
        return 0.0
    here = F[i, j, k]
    high = F[i + di, j + dj, k + dk] if V[i + di, j + dj, k + dk] > SLIT else here
    low = F[i - di, j - dj, k - dk] if V[i - di, j - dj, k - dk] > SLIT else here
    return high - low


@inner
def _is_amid_liquid(F, V, i, j, k):
    """Whether a cell lacks next to nothing, and so do those around it: no surface, whose slopes would be noise."""
    if F[i, j, k] < 1.0 - LACK:
        return False
    for d in range(3):
        di, dj, dk = (1 if d == 0 else 0), (1 if d == 1 else 0), (1 if d == 2 else 0)
        if V[i + di, j + dj, k + dk] > SLIT and F[i + di, j + dj, k + dk] < 1.0 - LACK:
            return False
        if V[i - di, j - dj, k - dk] > SLIT and F[i - di, j - dj, k - dk] < 1.0 - LACK:
            return False
    return True


@inner
def plane_at_solids(F, opened, steps, i, j, k):
    """(m, alpha) of the surface in the mixed cell (i, j, k) that is cut or has cut or closed neighbours.

    Along the axis of least slope; a cut cell's plane goes through its level at the middle of the cell. Amid liquid
    across the axis of the largest rise.
    """
    best, axis, up = np.inf, -1, 1.0
    best_e, best_f = 0.0, 0.0
    rises = _rise(F, opened.V, i, j, k, 0), _rise(F, opened.V, i, j, k, 1), _rise(F, opened.V, i, j, k, 2)
    most = max(abs(rises[0]), abs(rises[1]), abs(rises[2]))
    amid = _is_amid_liquid(F, opened.V, i, j, k)
    for d in range(2, -1, -1):
        rise = rises[d]
        if abs(rise) <= FAINT * most:
            continue
        side = 1.0 if rise < 0.0 else -1.0
        if amid:
            if abs(rise) == most:
                axis, up = d, side
            continue
        e, f = (d + 1) % 3, (d + 2) % 3
        here = _height_at(F, opened, steps, i, j, k, d, side, 0.0)[1]
        known_e, slope_e = _slope(F, opened, steps, i, j, k, d, side, e, here)
        known_f, slope_f = _slope(F, opened, steps, i, j, k, d, side, f, here)
        like_e, like_f = abs(rises[e] / rise), abs(rises[f] / rise)  # as F falls: where no column says anything, and
        tilt = abs(slope_e) + FAINT * like_e if known_e else like_e  # where two axes seem to have no slope
        tilt += abs(slope_f) + FAINT * like_f if known_f else like_f
        if tilt < best:
            best, axis, up, best_e, best_f = tilt, d, side, slope_e, slope_f
        if tilt < LEVEL and like_e + like_f < LEVEL:
            break
    if axis < 0:
        return (0.0, 0.0, 0.0), 0.0
    m = _vector(axis, up, -best_e, -best_f)
    if opened.V[i, j, k] >= 1.0:
        return m, plane_offset(m, F[i, j, k])
    level = level_of_cell(F[i, j, k], opened, i, j, k, axis, up)
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
    if not has_plane(s):
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
