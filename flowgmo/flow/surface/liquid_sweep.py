"""One sweep of the liquid along one direction (the equation is in surface_tracking.py), and where there is liquid."""

from __future__ import annotations

import numpy as np

from flowgmo.flow.ahead import ask_ahead
from flowgmo.flow.fields import G
from flowgmo.flow.solid_lines import ask_at_solids
from flowgmo.flow.surface.carriers import U, across_column, ahead
from flowgmo.kernel import flow_kernel, inlined, kernel

FIRST, LAST = 1, 2  # bits of `kind`


@inlined
def _stretch(d, q, A, along, scale, i, j, k0, k1, heavy, F):
    """F += scale (A+ q+ - A- q-) along in the heavy cells of a column."""
    di, dj, dk = ahead(d)
    for k in range(k0, k1):
        high, low = q[i, j, k], q[i - di, j - dj, k - dk]
        if A is not None:
            high *= A[i, j, k]
            low *= A[i - di, j - dj, k - dk]
        F[i, j, k] += scale * along[k] * (high - low) if heavy[i, j, k] == 1 else 0.0


@inlined
def _restore(carrier, A, i, j, k0, k1, dt, heavy, F):
    """Take back what an earlier sweep added to a column's heavy cells against their stretching."""
    d, q, across, along = carrier.way.d, carrier.q, carrier.way.across, carrier.way.along
    scale = -dt * across_column(d, across, i, j)
    _stretch(d, q, A, along, scale, i, j, k0, k1, heavy, F)


@inlined
def _sweep_column(kind, own, A, one, A_one, two, A_two, i, j, k0, k1, dt, F, V, flux, heavy):
    """One column of `sweep`, V and A None where they are 1. Short loops over k, each with few arrays: with more than
    that, the compiler does not vectorise."""
    d, q, across, along = own.way.d, own.q, own.way.across, own.way.along
    di, dj, dk = ahead(d)
    if kind & FIRST:
        for k in range(k0, k1):
            heavy[i, j, k] = 1 if F[i, j, k] > 0.5 else 0
    if V is not None:
        for k in range(k0, k1):
            F[i, j, k] *= V[i, j, k]
    scale = across_column(d, across, i, j)
    for k in range(k0, k1):
        F[i, j, k] += scale * along[k] * (flux[i - di, j - dj, k - dk] - flux[i, j, k])
    if (kind & LAST) == 0:
        _stretch(d, q, A, along, dt * scale, i, j, k0, k1, heavy, F)
        if V is not None:
            for k in range(k0, k1):
                F[i, j, k] /= V[i, j, k] if V[i, j, k] > 0.0 else 1.0
    if one is not None:
        _restore(one, A_one, i, j, k0, k1, dt, heavy, F)
    if two is not None:
        _restore(two, A_two, i, j, k0, k1, dt, heavy, F)


@flow_kernel
def sweep(columns, first, last, kind, own, A, one, two, dt, F, V, lines, flux, heavy):
    """F after the sweep along own.way; after the LAST, with solids, V F.

    own Carrier with its A; one, two: the Carriers of the sweeps before the last one, None in others. flux [length] on
    the faces of own.way; lines: solid_lines.py. heavy int8, written in the FIRST sweep: 1 where F > 1/2, and the
    stretching is undone.
    """
    for c in range(first, last):
        ask_ahead(columns, c, last, F, 0, 0)
        ask_ahead(columns, c, last, flux, 0, 0)
        ask_at_solids(columns, c, last, V, lines)
        ask_ahead(columns, c, last, own.q, 0, 0)
        i, j, k0, k1 = columns[c, 0], columns[c, 1], U(columns[c, 2]), U(columns[c, 3])
        if V is not None:
            if lines[i, j] != 0:
                A_one, A_two = None if one is None else one.A, None if two is None else two.A
                _sweep_column(kind, own, A, one, A_one, two, A_two, i, j, k0, k1, dt, F, V, flux, heavy)
                continue
        _sweep_column(kind, own, None, one, None, two, None, i, j, k0, k1, dt, F, None, flux, heavy)


@inlined
def _worth(head, a, b):
    """What a volume through face (a, b) of a side brings of energy; 0 without heads."""
    return 0.0 if head is None else head[a, b]


@flow_kernel
def through_sides(columns, first, last, d, n, flux, grid, lower, upper, through):
    """through (4, columns): liquid that came in by the lower and upper side of direction d, n cells long [length^3],
    and the energy that it brought.

    flux [length] on the faces of that direction. lower, upper [energy/length^3] on the faces of the sides, of mesh size
    without d: what a volume brings (observe/streams.py); None where nothing passes.
    """
    for c in range(first, last):
        i, j, k0, k1 = columns[c, 0], columns[c, 1], columns[c, 2], columns[c, 3]
        low, high, low_brought, high_brought = 0.0, 0.0, 0.0, 0.0
        if d == 2:
            area = grid.dx[i] * grid.dy[j]
            low = flux[i, j, G - 1] * area if k0 == G else 0.0
            high = -flux[i, j, n + G - 1] * area if k1 == n + G else 0.0
            low_brought, high_brought = low * _worth(lower, i, j), high * _worth(upper, i, j)
        elif (i if d == 0 else j) == G or (i if d == 0 else j) == n + G - 1:
            width = grid.dy[j] if d == 0 else grid.dx[i]
            place, other = (i, j) if d == 0 else (j, i)
            for k in range(k0, k1):
                area = width * grid.dz[k]
                if place == G:
                    passed = area * (flux[i - 1, j, k] if d == 0 else flux[i, j - 1, k])
                    low += passed
                    low_brought += passed * _worth(lower, other, k)
                if place == n + G - 1:
                    passed = area * flux[i, j, k]
                    high -= passed
                    high_brought -= passed * _worth(upper, other, k)
        through[0, c], through[1, c] = low, high
        through[2, c], through[3, c] = low_brought, high_brought


@kernel
def look_for_liquid(F, lines, bounds):
    """bounds [i, j] = (k0, k1) int32 of the cells that hold liquid in each line where lines (mesh without z) is not 0,
    k1 <= k0 if none does; the first layer of ghosts is looked at too. Dust and negative remainders count."""
    nx, ny, nz = F.shape
    for i in range(G - 1, nx - G + 1):
        for j in range(G - 1, ny - G + 1):
            if lines[i, j] == 0:
                continue
            k0, k1 = np.int64(G - 1), np.int64(nz - G)
            while k0 <= k1 and F[i, j, k0] == 0.0:
                k0 += 1
            while k1 > k0 and F[i, j, k1] == 0.0:
                k1 -= 1
            bounds[i, j, 0], bounds[i, j, 1] = k0, k1 + 1


@kernel
def columns_within(bounds):
    """Columns (n, 4) int32 of bounds (mesh without z, 2), the first layer of ghosts among them."""
    nx, ny, _ = bounds.shape
    columns, n = np.empty((nx * ny, 4), np.int32), np.int64(0)
    for i in range(G - 1, nx - G + 1):
        for j in range(G - 1, ny - G + 1):
            if bounds[i, j, 0] < bounds[i, j, 1]:
                columns[n, 0], columns[n, 1] = i, j
                columns[n, 2], columns[n, 3] = bounds[i, j, 0], bounds[i, j, 1]
                n += 1
    return columns[:n].copy()
