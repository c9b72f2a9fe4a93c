"""Where in its cells the liquid lies after a step of two sweeps: first moments, of the pieces that the sweeps carried.

    cell at the end = what stayed + what came through its two faces across the second sweep's way, each of them three
                      pieces side by side (carried_flux.py), each a part of a cell of the step's start: a line in a box

moments (mesh, 3): F that they belong to, and the integrals of x and z over the liquid [cell widths; the two axes in
their order] in 0 .. 1 over the cell. line_of_pieces.py reads them where nine F do not say how the surface lies: where
F falls along one of the axes, as at every smooth surface, they are not found. They are of use where F is what the
pieces add up to: not where solids are near, where liquid came in through a side, or was spilled over. Beyond periodic
sides they are those of the other side.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.fields import G, Grid
from flowgmo.flow.surface.carried_flux import TINY, moved_by, room_along, slabs
from flowgmo.flow.surface.carriers import next_along, width_of
from flowgmo.flow.surface.line_moments import moments_under
from flowgmo.flow.surface.liquid_flux import is_drop
from flowgmo.flow.surface.plic import is_mixed, is_plane, stretched
from flowgmo.flow.surface.surface_normals import plane_at
from flowgmo.kernel import flow_kernel, inner

UNKNOWN = -1.0  # in place of F: no cell holds that
#: [-] F after a cell less F before it: where that much in three columns, nine F say how the surface lies. Reversed
#: vortex with 32, 64, 128 cells: .3 .0269 .0075 .0014, .6 .0242 .0070 .0013, none .0221 .0070 .0012 (means of six
#: lengths of step, but for 128), and 1.0, 1.0, 1.6 of the time that two reconstructions a step take
FALLS = 0.6


def unknown_moments(grid: Grid) -> np.ndarray | None:
    """(mesh, 3) for a mesh of one layer of cells, nothing known yet; None for others."""
    shape = tuple(len(d) for d in grid[:3])
    return np.full((*shape, 3), UNKNOWN) if sum(n == 1 + 2 * G for n in shape) == 1 else None


@inner
def _piece(F, planes, i, j, k, d, low, high, e, bottom, top):
    """(share, moment along d, along e) of the box low < xi_d < high, bottom < xi_e < top, in 0 .. 1 over the box."""
    here = min(max(F[i, j, k], 0.0), 1.0)
    if is_mixed(here) and not is_drop(F, i, j, k):
        m, alpha = plane_at(planes, i, j, k)
        box = stretched(stretched(m, d, high - low), e, top - bottom)
        if is_plane(m) and (box[d] != 0.0 or box[e] != 0.0):
            return moments_under(box[d], box[e], alpha - m[d] * low - m[e] * bottom)
    return here, 0.5 * here, 0.5 * here


@inner
def _arrival(by, lower, upper, total, ratio):
    """(bottom, top, to_bottom, to_top): which slab of a cell comes to the cell `by` (1: above) of it, and where to.

    lower, upper: how far its lower and upper face moves liquid [heights of the cell]; total: its T; ratio: its height
    in that of the cell it comes to."""
    if by > 0:
        out = max(upper, 0.0)
        return 1.0 - min(out / total, 1.0), 1.0, 0.0, out * ratio
    if by < 0:
        out = max(-lower, 0.0)
        return 0.0, min(out / total, 1.0), 1.0 - out * ratio, 1.0
    low, high = max(-lower, 0.0) / total, 1.0 - max(upper, 0.0) / total
    return low, high, max(lower, 0.0), 1.0 + min(upper, 0.0)


@inner
def _from_cell(F, planes, own, one, dt, periodic, i, j, k, by, ratio):
    """(F, moment along one's way, along own's) of what comes from (i, j, k) to the cell `by` of it along own's."""
    d, e = one.way.d, own.way.d
    moved, x, y, z = room_along(own.way, e, periodic, F.shape, i, j, k)
    shift = moved_by(one, dt, moved, x, y, z)
    t, low, high = slabs(shift, one, i, j, k)
    total = max(t[0] + t[1] + t[2], TINY)
    a, b, c = next_along(e, i, j, k, -1)
    scale = dt * width_of(own.way, i, j, k)
    lower, upper = own.q[a, b, c] * scale, own.q[i, j, k] * scale
    bottom, top, to_bottom, to_top = _arrival(by, lower, upper, total, ratio)
    share, along, across, start = np.float64(0.0), np.float64(0.0), np.float64(0.0), np.float64(0.0)
    if top > bottom:
        for n in range(3):
            if t[n] > 0.0:
                a, b, c = next_along(d, i, j, k, n - 1)
                part, x, z = _piece(F, planes, a, b, c, d, low[n], high[n], e, bottom, top)
                area = t[n] * (top - bottom) * ratio
                share += area * part
                along += area * (start * part + t[n] * x) / total
                across += area * (to_bottom * part + (to_top - to_bottom) * z)
            start += t[n]
    return share, along, across


@inner
def _change(F, d, i, j, k):
    """F after the cell along d less F before it."""
    a, b, c = next_along(d, i, j, k, -1)
    e, f, g = next_along(d, i, j, k, 1)
    return F[e, f, g] - F[a, b, c]


@inner
def _falls(F, d, e, i, j, k):
    """Whether F changes along d by FALLS in a cell and in its neighbours along e, the same way in all three."""
    a, b, c = next_along(e, i, j, k, -1)
    f, g, h = next_along(e, i, j, k, 1)
    before, here, after = _change(F, d, a, b, c), _change(F, d, i, j, k), _change(F, d, f, g, h)
    return min(before, min(here, after)) > FALLS or max(before, max(here, after)) < -FALLS


@flow_kernel
def carry_moments(columns, first, last, own, one, dt, F, before, planes, periodic, moments):
    """moments of the columns' cells at the end of a step where F falls along neither axis; others stay.

    own, one Carriers of its second and first sweep; F [-] of its end, before [-] and planes (mesh, 4) of its start,
    ghosts filled; periodic: whether own's way is.
    """
    nx, ny, nz = F.shape
    d, e = one.way.d, own.way.d
    for n in range(first, last):
        i, j = columns[n, 0], columns[n, 1]
        if i < G or i >= nx - G or j < G or j >= ny - G:
            continue
        for k in range(max(columns[n, 2], G), min(columns[n, 3], nz - G)):
            if not is_mixed(F[i, j, k]) or _falls(F, d, e, i, j, k) or _falls(F, e, d, i, j, k):
                continue
            share, along, across = np.float64(0.0), np.float64(0.0), np.float64(0.0)
            for by in range(-1, 2):
                a, b, c = next_along(e, i, j, k, -by)
                ratio = width_of(own.way, i, j, k) / width_of(own.way, a, b, c)
                part, x, z = _from_cell(before, planes, own, one, dt, periodic, a, b, c, by, ratio)
                share, along, across = share + part, along + x, across + z
            moments[i, j, k, 0] = share
            moments[i, j, k, 1], moments[i, j, k, 2] = (along, across) if d < e else (across, along)


def join_periodic(moments: np.ndarray, periodic: tuple[bool, bool, bool]) -> None:
    """Ghosts beyond periodic sides become those of the cells at the other side."""
    for d in range(3):
        n = moments.shape[d] - 2 * G
        if periodic[d] and n > 1:
            layers = np.moveaxis(moments, d, 0)
            layers[:G], layers[-G:] = layers[n : n + G], layers[G : 2 * G]
