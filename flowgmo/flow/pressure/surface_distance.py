"""Where the free surface lies between two cell centres, for the pressure (second order).

A cell is liquid where its centre is. Between the centre of a liquid cell and that of its neighbour in the air the
surface is met where the plane of one of the two cells (PLIC, plic.py) crosses the line through the centres:

    centre of the liquid cell  o------------|====x=====|----------o  centre of the other        x: the plane
                               0     own half   other half        h

The crossing counts for the plane of the cell in whose half it lies. Where both do, one of them is what transport has
left: a little void in the cell below or a little liquid in the one above, and the larger one of the two is believed.
Where no plane does, since they do not fit at the face or a solid hides how the surface lies, what both cells hold is
taken for a column of liquid along the line.
"""

from __future__ import annotations

import math

from flowgmo.flow.ahead import ask_ahead
from flowgmo.flow.pressure.lids import may_have_lid
from flowgmo.flow.pressure.pockets import POCKET
from flowgmo.flow.solid_lines import ask_at_solids
from flowgmo.flow.surface.cut_level import holds_below
from flowgmo.flow.surface.plic import FULL, crossing, is_mixed, is_plane
from flowgmo.flow.surface.surface_normals import near_solids, plane_at
from flowgmo.kernel import flow_kernel, inner

LEAST = 0.1  # of the own cell: a guess must not put the surface into the centre, where any pressure is a jet
DRY, WET = 0.01, 0.99  # F of a cell that a solid cuts: outside, what is missing is no surface that a plane could show
NEAREST = 1e-3  # least share of h, and depth of the centre of a liquid cell in widths: keeps 1 / theta finite


@flow_kernel
def mark_liquid(columns, first, last, F, V, opened, lines, planes, closed, wet, lids):
    """wet (int8, mesh) = 1 in cells whose centre lies in the liquid, 0 in the others of the columns.

    F None: no free surface, all open cells. In cells that a solid cuts the plane decides, since F is a share of what is
    open there; everywhere else F >= 1/2 says the same. By NEAREST more than that: with the surface in the very centre
    1 / theta would be cut off, and cells that round-off makes wet or dry would have pressures apart by 1e-3 rho g h:
    water at rest swung at .2 m/s. Others that a solid cuts are POCKET (pockets.py). lids
    (columns,): how many of the cells are that or may have a void under a closed face (lids.py, with `closed`).
    lines: solid_lines.py.
    """
    for c in range(first, last):
        ask_ahead(columns, c, last, F, 0, 0)
        ask_at_solids(columns, c, last, V, lines)
        ask_ahead(columns, c, last, wet, 0, 0)
        i = columns[c, 0]
        j = columns[c, 1]
        lids[c] = 0
        solid = False
        if V is not None:
            solid = lines[i, j] != 0
        for k in range(columns[c, 2], columns[c, 3]):
            liquid = True
            if F is not None:
                liquid = F[i, j, k] >= 0.5 + NEAREST
            if V is not None:
                if solid and V[i, j, k] == 0.0:
                    liquid = False
                elif F is not None:
                    if solid and DRY < F[i, j, k] < WET and near_solids(V, i, j, k):
                        m, alpha = plane_at(planes, i, j, k)
                        if is_plane(m):
                            size = abs(m[0]) + abs(m[1]) + abs(m[2])
                            liquid = 0.5 * (m[0] + m[1] + m[2]) + NEAREST * size <= alpha
            wet[i, j, k] = 1 if liquid else 0
            if F is not None:
                if liquid and F[i, j, k] < FULL:  # no call for full cells: it costs more than all the rest
                    if may_have_lid(F, opened, closed, i, j, k):
                        lids[c] += 1
                if V is not None:
                    if solid and not liquid and 0.0 < V[i, j, k] < 1.0:
                        wet[i, j, k] = POCKET
                        lids[c] += 1


@inner
def _plane(F, planes, i, j, k):
    """(m, alpha) of the surface in a cell, m = 0 without one."""
    if not is_mixed(F[i, j, k]):
        return (0.0, 0.0, 0.0), 0.0
    return plane_at(planes, i, j, k)


@inner
def _size(m):
    return abs(m[0]) + abs(m[1]) + abs(m[2])


@inner
def _crossing(m, alpha, d):
    """crossing(m, alpha, d), inf without a plane, and where it runs along d: round-off would say where it is met."""
    return crossing(m, alpha, d) if abs(m[d]) > NEAREST * _size(m) else math.inf


@inner
def _near_centre(m, alpha):
    """Whether a cell's plane passes its centre as near as cells beside it may be dry by round-off."""
    return is_plane(m) and abs(0.5 * (m[0] + m[1] + m[2]) - alpha) <= 3.0 * NEAREST * _size(m)


@inner
def _longest(m):
    """The axis along which a plane's vector is longest."""
    return 2 if abs(m[2]) >= max(abs(m[0]), abs(m[1])) else (1 if abs(m[1]) >= abs(m[0]) else 0)


@inner
def _one_level(m, alpha, n, beta, d):
    """Whether two planes are one, along the line of direction d through both centres, as far as NEAREST tells."""
    a = _longest(m)
    if a == d or m[a] * n[a] <= 0.0:
        return False
    tilt = max(abs(m[d] / m[a]), abs(n[d] / n[a]))
    return max(tilt, abs(crossing(m, alpha, a) - crossing(n, beta, a))) <= 3.0 * NEAREST


@inner
def _goes_on(m, alpha, d, F, V, opened, i, j, k):
    """Whether a plane that runs along d may go on in the cell (i, j, k), which a solid cuts, where no liquid or no void
    is left for it to be seen: the cell is open on one side of it only."""
    if V is not None:
        if 0.0 < V[i, j, k] < 1.0 and is_plane(m):
            a = _longest(m)
            if a != d and abs(m[d]) <= 3.0 * NEAREST * abs(m[a]):
                up = 1.0 if m[a] > 0.0 else -1.0
                level = min(max(0.5 + up * crossing(m, alpha, a), 0.0), 1.0)
                held = holds_below(opened, i, j, k, a, level, up)
                return abs(held - V[i, j, k] * F[i, j, k]) <= 3.0 * NEAREST * V[i, j, k]
    return False


@inner
def _holds_more(F, V, own, other, own_wide, other_wide):
    """Whether the other cell has more liquid than the own one has void."""
    void, liquid = (1.0 - F[own[0], own[1], own[2]]) * own_wide, F[other[0], other[1], other[2]] * other_wide
    if V is not None:
        void *= V[own[0], own[1], own[2]]
        liquid *= V[other[0], other[1], other[2]]
    return liquid > void


@inner
def wet_share(F, V, opened, planes, own, other, d, sign, own_wide, other_wide):
    """Share of the distance of two centres that is wet: own (i, j, k) is liquid, other beyond sign * d is not.

    inf where the plane runs along the line: through the own centre, or from cell to cell, and only how a solid cuts
    them makes one wet and one dry. Other is then as good as liquid, nothing drives it.
    """
    h = 0.5 * (own_wide + other_wide)
    m, alpha = _plane(F, planes, own[0], own[1], own[2])
    near = sign * _crossing(m, alpha, d)
    # a plane through the very centre, where F = 1/2, may round to either side of it; one in the face to the other cell
    # may be void that the pressure's tolerance has left in a full cell: then the other cell knows better
    meets = -NEAREST <= near <= 0.5 - NEAREST
    if meets and not _holds_more(F, V, own, other, own_wide, other_wide):
        return max(near * own_wide / h, NEAREST)
    n, beta = _plane(F, planes, other[0], other[1], other[2])
    far = -sign * _crossing(n, beta, d)
    if -2.0 * NEAREST <= far <= 0.5:  # the centre of a dry cell may lie as deep as that
        return max((h - far * other_wide) / h, NEAREST)
    if meets:
        return max(near * own_wide / h, NEAREST)
    if _near_centre(m, alpha) or _one_level(m, alpha, n, beta, d):
        return math.inf
    if not is_plane(n) and _goes_on(m, alpha, d, F, V, opened, other[0], other[1], other[2]):
        return math.inf
    if not is_plane(m) and _goes_on(n, beta, d, F, V, opened, own[0], own[1], own[2]):
        return math.inf
    # planes that do not meet the line say little: what both cells hold, as if the surface lay across it
    filled = F[own[0], own[1], own[2]] * own_wide + F[other[0], other[1], other[2]] * other_wide
    distance = min(max(filled - 0.5 * own_wide, LEAST * own_wide), h)
    return max(distance / h, NEAREST)
