"""The matrices of multigrid: the finest in single precision, each coarser one from the one above it."""

from __future__ import annotations

import numpy as np

from flowgmo.flow.ahead import ask_ahead
from flowgmo.flow.columns import ONE
from flowgmo.flow.fields import G
from flowgmo.kernel import flow_kernel, inner


@flow_kernel
def single(columns, first, last, a, scale, out):
    """out = scale a, in single precision."""
    for c in range(first, last):
        ask_ahead(columns, c, last, a, 0, 0)
        ask_ahead(columns, c, last, out, 0, 0)
        i = columns[c, 0]
        j = columns[c, 1]
        for k in range(np.uint64(columns[c, 2]), np.uint64(columns[c, 3])):
            out[i, j, k] = np.float32(a[i, j, k] * scale)


@flow_kernel
def invert(columns, first, last, diagonal, out):
    """out = 1 / diagonal in liquid cells, 0 elsewhere."""
    for c in range(first, last):
        i = columns[c, 0]
        j = columns[c, 1]
        for k in range(np.uint64(columns[c, 2]), np.uint64(columns[c, 3])):
            d = diagonal[i, j, k]
            out[i, j, k] = 1 / d if d > 0.0 else d * 0


@inner
def _between(b, diagonal, i, j, k, m, n, o):
    """b of a face if both its cells are liquid."""
    return b[i, j, k] if diagonal[i, j, k] != 0.0 and diagonal[m, n, o] != 0.0 else np.float32(0.0)


@flow_kernel
def held_shares(columns, first, last, bx, by, bz, diagonal, surface):
    """surface = sum of the b of a liquid cell's faces to cells that are not liquid."""
    for c in range(first, last):
        ask_ahead(columns, c, last, bx, 0, 0)
        ask_ahead(columns, c, last, by, 0, 0)
        ask_ahead(columns, c, last, bz, 0, 0)
        ask_ahead(columns, c, last, diagonal, 1, 0)
        ask_ahead(columns, c, last, surface, 0, 0)
        i = columns[c, 0]
        j = columns[c, 1]
        for k in range(np.uint64(columns[c, 2]), np.uint64(columns[c, 3])):
            total = np.float32(0.0)
            if bx is not None:
                total += bx[i - 1, j, k] if diagonal[i - 1, j, k] == 0.0 else np.float32(0.0)
                total += bx[i, j, k] if diagonal[i + 1, j, k] == 0.0 else np.float32(0.0)
            if by is not None:
                total += by[i, j - 1, k] if diagonal[i, j - 1, k] == 0.0 else np.float32(0.0)
                total += by[i, j, k] if diagonal[i, j + 1, k] == 0.0 else np.float32(0.0)
            if bz is not None:
                total += bz[i, j, k - ONE] if diagonal[i, j, k - ONE] == 0.0 else np.float32(0.0)
                total += bz[i, j, k] if diagonal[i, j, k + ONE] == 0.0 else np.float32(0.0)
            surface[i, j, k] = total if diagonal[i, j, k] != 0.0 else np.float32(0.0)


@flow_kernel
def coarsen(columns, first, last, factors, bx, by, bz, diagonal, surface, Bx, By, Bz, whole, held):
    """Coefficients of the coarse columns' upper faces, and their cells' share of the surface; 1 in `whole` is liquid.

    The fine level's bx, by, bz, diagonal, surface; then the coarse level's.
    """
    fx, fy, fz = factors
    nx, ny, nz = diagonal.shape
    for c in range(first, last):
        m = columns[c, 0]
        n = columns[c, 1]
        i1 = min((m - G) * fx + G + fx, nx - G) - 1
        j1 = min((n - G) * fy + G + fy, ny - G) - 1
        for o in range(columns[c, 2], columns[c, 3]):
            k0 = (o - G) * fz + G
            k1 = min(k0 + fz, nz - G) - 1
            x = np.float32(0.0)
            y = np.float32(0.0)
            z = np.float32(0.0)
            s = np.float32(0.0)
            liquid = np.float32(0.0)
            for i in range((m - G) * fx + G, i1 + 1):
                for j in range((n - G) * fy + G, j1 + 1):
                    for k in range(k0, k1 + 1):
                        s += surface[i, j, k]
                        liquid = max(liquid, diagonal[i, j, k])
                        if bx is not None:
                            if i == i1:
                                x += _between(bx, diagonal, i, j, k, i + 1, j, k)
                        if by is not None:
                            if j == j1:
                                y += _between(by, diagonal, i, j, k, i, j + 1, k)
                    if bz is not None:
                        z += _between(bz, diagonal, i, j, k1, i, j, k1 + 1)
            if bx is not None:
                Bx[m, n, o] = x / np.float32(fx)
            if by is not None:
                By[m, n, o] = y / np.float32(fy)
            if bz is not None:
                Bz[m, n, o] = z / np.float32(fz)
            held[m, n, o] = s
            whole[m, n, o] = np.float32(1.0) if liquid > 0.0 else np.float32(0.0)


@flow_kernel
def complete(columns, first, last, bx, by, bz, surface, diagonal):
    """diagonal = surface + sum of the six b, where there is liquid."""
    for c in range(first, last):
        i = columns[c, 0]
        j = columns[c, 1]
        for k in range(np.uint64(columns[c, 2]), np.uint64(columns[c, 3])):
            if diagonal[i, j, k] != 0.0:
                total = surface[i, j, k]
                if bx is not None:
                    total += bx[i - 1, j, k] + bx[i, j, k]
                if by is not None:
                    total += by[i, j - 1, k] + by[i, j, k]
                if bz is not None:
                    total += bz[i, j, k - ONE] + bz[i, j, k]
                diagonal[i, j, k] = total
