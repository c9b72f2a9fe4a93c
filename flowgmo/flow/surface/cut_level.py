"""The level of the liquid in one cell that a solid cuts, from its fraction F, and back.

The open part is taken as the plane of surface_at_solids.py, s . xi <= beta, as far as that explains the cell.

Where edges, thin walls, slivers that were closed or curved walls cut a cell, no plane has all its open faces. The share

    w = |A(0) - A[-]| + |A(1) - A[+]|      A(h) the plane's open cross-section at h, along the axis in question

that the plane does not explain is taken as evenly porous: below h lie  w V h + (1 - w) (plane's part). So F rises from
0 to 1 all the way from the lower to the upper face wherever the cell's faces are open there, each level is one F and
each F one level. Water whose F has the same level in all cells is at rest, whatever the solids (level_at_start.py).
(To take such a level from the neighbours instead would be right at rest, but a pressure that does not answer to its own
cell's liquid makes the equation of small waves unsymmetric: round-off grew by 1.8 a step.)
"""

from __future__ import annotations

from flowgmo.flow.surface.plic import EMPTY, FULL, is_mixed, plane_offset, stretched, volume_under
from flowgmo.kernel import inner

EXACT = 1e-9  # of a face: planes are cut to 2e-9 of a small cell (test_solid_planes.py); the slivers closed are 1e-4
ROOT_STEPS = 60  # Newton in a bracket ends after 3 to 7 (measured), bisection alone after 52


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
def has_plane(s):
    return abs(s[0]) + abs(s[1]) + abs(s[2]) > 0.0


@inner
def open_in_slab(s, beta, d, low, high):
    """Open volume of low < xi_d < high in shares of the cell: how much liquid it holds when that part is under water.

    The initial surface, if level, is still to round-off when V F of a cut cell is this of 0 .. level.
    """
    return (high - low) * volume_under(stretched(s, d, high - low), beta - s[d] * low)


@inner
def open_above(opened, d, i, j, k):
    """Open fraction of the upper face of a cell along d."""
    if d == 0:
        return opened.Ax[i, j, k]
    return opened.Ay[i, j, k] if d == 1 else opened.Az[i, j, k]


@inner
def porous_share(s, beta, opened, i, j, k, d):
    """w: what the plane of a cell does not explain of its open faces at both ends of axis d, 0 .. 1."""
    if not has_plane(s):
        return 1.0
    across = stretched(s, d, 0.0)
    low = open_above(opened, d, i - (1 if d == 0 else 0), j - (1 if d == 1 else 0), k - (1 if d == 2 else 0))
    high = open_above(opened, d, i, j, k)
    w = abs(volume_under(across, beta) - low) + abs(volume_under(across, beta - s[d]) - high)
    return min(w, 1.0) if w > EXACT else 0.0


@inner
def level_in_cut_cell(s, beta, w, V, F, d, up):
    """Share h of the cell, from below (up = 1) or from above (up = -1), that is under water along axis d.

    The volume V F [of the cell] lies in the open part between the wet side and h; w as of porous_share.
    """
    if F <= EMPTY:
        return 0.0
    if F >= FULL:
        return 1.0
    if w >= 1.0:
        return F
    if up < 0.0:  # the mirrored cell
        beta -= s[d]
        s = stretched(s, d, -1.0)
    beyond = stretched(s, d, 0.0)
    target, low, high, h = V * F, 0.0, 1.0, F
    for _ in range(ROOT_STEPS):
        missing = target - h * (w * V + (1.0 - w) * volume_under(stretched(s, d, h), beta))
        if missing > 0.0:
            low = h
        else:
            high = h
        area = w * V + (1.0 - w) * volume_under(beyond, beta - s[d] * h)  # open cross-section at h: the derivative
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
def level_of_cell(f, opened, i, j, k, d, up):
    """Level in an open cell with the fraction f: f where it is wholly open."""
    V = opened.V[i, j, k]
    if V < 1.0 and is_mixed(f):
        s, beta = solid_plane(opened, i, j, k)
        return level_in_cut_cell(s, beta, porous_share(s, beta, opened, i, j, k, d), V, f, d, up)
    return f


@inner
def reaches(opened, i, j, k, d, end):
    """Whether the open part of a cell has an area at its lower (end = 0) or upper (1) face along d."""
    V = opened.V[i, j, k]
    if V >= 1.0:
        return True
    s, beta = solid_plane(opened, i, j, k)
    if porous_share(s, beta, opened, i, j, k, d) > 0.0:
        return True
    return volume_under(stretched(s, d, 0.0), beta - s[d] * end) > 0.0


@inner
def holds_below(opened, i, j, k, d, level, up):
    """Open volume [of the cell] in the share `level` of cell (i, j, k) from its wet side along d."""
    V = opened.V[i, j, k]
    if V < 1.0:
        s, beta = solid_plane(opened, i, j, k)
        w = porous_share(s, beta, opened, i, j, k, d)
        low, high = (0.0, level) if up > 0.0 else (1.0 - level, 1.0)
        return w * V * level + (1.0 - w) * open_in_slab(s, beta, d, low, high)
    return V * level
