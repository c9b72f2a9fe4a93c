"""The second of two sweeps: what crosses a face comes from the planes of the step's start, carried by the first sweep.

    +--------+--------+--------+        first sweep, along x: through the left face came a slab l = u dt thick, r left
    | left   |        |        |        through the right one. What the cell holds now are pieces, side by side, of
    |     .##|########|##      |        the cells that they came from, T = 1 + l - r wide together [widths of the
    |  .' ###|########|###     | ^ w    cell]. The second sweep takes of each piece the same slab at the face.
    +-----|--+-----|--+--------+
           l         r                  flux = w dt  sum t share(piece, slab) / T,      slab: w dt / (T height) thick

T times as wide, the pieces are T times as high where they have room in the cell: without divergence that is what the
second sweep stretches them by. Then the cell holds S = sum t F(piece) and T - S of void, no slab holds more of either
than its cell, and void that leaves, less void that comes, is w dt's difference less the liquid's: 0 <= F <= 1 up to
Courant numbers of 1 along each direction, to div(u) dt where there is some. Fluxes telescope: volume to round-off.

Planes are found once a step in place of twice, and liquid is cut and laid together as often. Where the first sweep's
pieces are not known (cells that a solid comes near) planes are found anew between the sweeps, as in three dimensions.
Source  the split of Scardovelli and Zaleski 2003 ("Interface reconstruction with least-square fit and split
        Eulerian-Lagrangian advection", Int. J. Numer. Meth. Fluids 41), without its second reconstruction
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.fields import G
from flowgmo.flow.surface.carriers import columns_of_faces, next_along, travel, upwind, upwind_cell, width_of
from flowgmo.flow.surface.liquid_flux import is_drop, share_beside_solids
from flowgmo.flow.surface.plic import EMPTY, FULL, is_mixed, is_plane, share_of_slab, stretched, volume_under
from flowgmo.flow.surface.surface_normals import near_solids, plane_at
from flowgmo.kernel import flow_kernel, inner

TINY = 1e-300  # in place of 0: a cell that everything has left


@inner
def room_along(way, d, periodic, shape, i, j, k):
    """(whether the first sweep moved what the cell holds, the cell of which to read how): beyond a side across d the
    cell at the other side where that is periodic; beyond others nothing moved."""
    at, n = (i if d == 0 else (j if d == 1 else k)), shape[d] - 2 * G
    if G <= at < n + G:
        return True, i, j, k
    e, f, g = next_along(d, i, j, k, n if at < G else -n)
    return periodic, e, f, g


@inner
def moved_by(one, dt, moved, i, j, k):
    """(l, r) [widths of the cell]: how far liquid went through its lower and upper face in the first sweep."""
    if not moved:
        return 0.0, 0.0
    e, f, g = next_along(one.way.d, i, j, k, -1)
    scale = dt * width_of(one.way, i, j, k)
    return one.q[e, f, g] * scale, one.q[i, j, k] * scale


@inner
def slabs(shift, one, i, j, k):
    """Of the three pieces: thickness in widths of the cell (i, j, k), and the slabs' ends low, high in their own.

    shift: l and r as `moved_by` gives them."""
    own = width_of(one.way, i, j, k)
    e, f, g = next_along(one.way.d, i, j, k, -1)
    a, b, c = next_along(one.way.d, i, j, k, 1)
    left, right = max(shift[0], 0.0), max(-shift[1], 0.0)
    low = max(-shift[0], 0.0)
    stays = max(1.0 - low - max(shift[1], 0.0), 0.0)
    from_left = min(left * width_of(one.way, e, f, g) / own, 1.0)
    from_right = min(right * width_of(one.way, a, b, c) / own, 1.0)
    return (left, stays, right), (1.0 - from_left, low, 0.0), (1.0, low + stays, from_right)


@inner
def _share(F, planes, i, j, k, d, low, high, e, bottom, top):
    """Liquid share of the box low < xi_d < high, bottom < xi_e < top of a cell at the step's start."""
    here = min(max(F[i, j, k], 0.0), 1.0)
    if not is_mixed(here) or is_drop(F, i, j, k):
        return here
    m, alpha = plane_at(planes, i, j, k)
    if not is_plane(m):
        return here
    box = stretched(stretched(m, d, high - low), e, top - bottom)
    return volume_under(box, alpha - m[d] * low - m[e] * bottom)


@inner
def _carried_share(F, planes, one, shift, i, j, k, d, thick, upper):
    """Liquid share of the slab at the upper (or lower) face across d, `thick` heights of the cell (i, j, k)."""
    t, low, high = slabs(shift, one, i, j, k)
    total = max(t[0] + t[1] + t[2], TINY)
    slab = min(thick / total, 1.0)
    bottom, top = (1.0 - slab, 1.0) if upper else (0.0, slab)
    amount = np.float64(0.0)
    for n in range(3):
        if t[n] > 0.0:
            e, f, g = next_along(one.way.d, i, j, k, n - 1)
            amount += t[n] * _share(F, planes, e, f, g, one.way.d, low[n], high[n], d, bottom, top)
    return amount / total


@inner
def alike(F, d, i, j, k):
    """Whether a cell and its two neighbours along d are all full, or all dry."""
    a, b, c = next_along(d, i, j, k, -1)
    e, f, g = next_along(d, i, j, k, 1)
    least = min(F[i, j, k], min(F[a, b, c], F[e, f, g]))
    return least >= FULL or max(F[i, j, k], max(F[a, b, c], F[e, f, g])) <= EMPTY


@inner
def is_walled(one, V, lines, i, j, k):
    """Whether a solid comes near a cell, or has a part in its faces across the first sweep's way."""
    if lines[i, j] == 0:
        return False
    e, f, g = next_along(one.way.d, i, j, k, -1)
    return near_solids(V, i, j, k) or one.A[i, j, k] < 1.0 or one.A[e, f, g] < 1.0


@inner
def _found_anew(F, V, opened, planes, i, j, k, d, low, high, passed):
    """Liquid share of a slab of a mixed cell, from its plane after the first sweep."""
    if near_solids(V, i, j, k):
        return share_beside_solids(F, V, opened, planes, i, j, k, d, low, high, passed)
    m, alpha = plane_at(planes, i, j, k)
    return share_of_slab(m, alpha, d, low, high) if is_plane(m) and not is_drop(F, i, j, k) else F[i, j, k]


@flow_kernel
def carried_flux(columns, first, last, own, one, dt, F, V, opened, planes, lines, before, at_start, periodic, flux):
    """flux [length] of the upper faces of the columns, and of the domain's lower sides beside them, as `plic_flux`.

    own, one Carriers of this sweep and of the first; F [-] after the first sweep, before [-] at the step's start, both
    with ghosts; planes (mesh, 4) of F where a solid is near, at_start of `before`. periodic: whether own's way is.
    """
    d, q, A = own.way.d, own.q, own.A
    for c in range(first, last):
        i, j, k0, k1 = columns[c, 0], columns[c, 1], columns[c, 2], columns[c, 3]
        for back in range(columns_of_faces(d, i, j)):
            a, b = i - (back if d == 0 else 0), j - (back if d == 1 else 0)
            bottom = k0 - 1 if d == 2 else k0
            upwind(d, q, A, dt, F, a, b, bottom, k1, flux)
            for k in range(bottom, k1):
                e, f, g = upwind_cell(q[a, b, k], d, a, b, k)
                passed = travel(q, A, dt, a, b, k)
                if passed == 0.0 or alike(before, one.way.d, e, f, g):
                    continue
                thick = min(abs(q[a, b, k]) * dt * width_of(own.way, e, f, g), 1.0)
                if V is not None:
                    if is_walled(one, V, lines, e, f, g):
                        if is_mixed(F[e, f, g]) and flux[a, b, k] != 0.0:
                            low, high = (1.0 - thick, 1.0) if q[a, b, k] > 0.0 else (0.0, thick)
                            at = F, V, opened, planes, e, f, g, d, low, high
                            flux[a, b, k] = passed * _found_anew(*at, A[a, b, k] * thick)
                        continue
                moved, x, y, z = room_along(own.way, d, periodic, before.shape, e, f, g)
                shift = moved_by(one, dt, moved, x, y, z)
                share = _carried_share(before, at_start, one, shift, e, f, g, d, thick, q[a, b, k] > 0.0)
                flux[a, b, k] = passed * share
