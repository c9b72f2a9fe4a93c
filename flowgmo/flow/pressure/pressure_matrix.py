"""The pressure equation: what couples which cells, and how strongly.

Liquid cells are those whose centre lies in the liquid (surface_distance.py), all open ones without a free surface.
With q = p dt / rho [length2/time] the projection asks, for every liquid cell,

    sum over faces  b (q - q_neighbour) = - sum over faces (outward A S u*) + source          b = A S / h

S is the area of a face, A its open fraction, h the distance of the two centres. A face to a cell that is not liquid
ends at the free surface, where q = 0: its distance is the wet part of h only,

    b = A S / (theta h)             u = u* - (q_upper - q_lower) / (theta h)

which puts the surface where it lies between the centres, not at a face (second order; Gibou et al. 2002, Enright et
al. 2003). Cells that are not liquid keep q = 0, so that one array per direction holds both kinds of faces and the
operator needs no case: diagonal = sum of the six b, and what lids.py and compressibility add. The matrix is symmetric
and positive definite where a surface or a pressure side is met, else semi-definite.

"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.ahead import ask_ahead
from flowgmo.flow.columns import ONE
from flowgmo.flow.fields import Open
from flowgmo.flow.pressure.surface_distance import wet_share
from flowgmo.flow.solid_lines import ask_at_solids
from flowgmo.kernel import flow_kernel, inlined, inner


@inner
def open_volume(grid, V, i, j, k):
    """Of a cell [length3]."""
    volume = grid.dx[i] * grid.dy[j] * grid.dz[k]
    if V is not None:
        volume *= V[i, j, k]
    return volume


@inlined
def _coefficients_of_column(grid, Ax, Ay, Az, wet, bx, by, bz, i, j, k0, k1):
    """One column of `face_coefficients`, A None where they are 1."""
    across_x = grid.dy[j] / grid.hx[i]
    across_y = grid.dx[i] / grid.hy[j]
    across_z = grid.dx[i] * grid.dy[j]
    for k in range(k0, k1):
        if bx is not None:
            b = across_x * grid.dz[k] * (wet[i, j, k] * wet[i + 1, j, k])
            if Ax is not None:
                b *= Ax[i, j, k]
            bx[i, j, k] = b
        if by is not None:
            b = across_y * grid.dz[k] * (wet[i, j, k] * wet[i, j + 1, k])
            if Ay is not None:
                b *= Ay[i, j, k]
            by[i, j, k] = b
        if bz is not None:
            b = across_z / grid.hz[k] * (wet[i, j, k] * wet[i, j, k + ONE])
            if Az is not None:
                b *= Az[i, j, k]
            bz[i, j, k] = b


@flow_kernel
def face_coefficients(columns, first, last, grid, Ax, Ay, Az, lines, wet, bx, by, bz):
    """b [length] of the columns' upper faces between liquid cells, 0 on others. bx None: one cell in that direction.

    wet int8, 1 or 0: the product of both says whether they are liquid, without a branch. lines: solid_lines.py.
    """
    for c in range(first, last):
        ask_ahead(columns, c, last, bx, 0, 0)
        ask_ahead(columns, c, last, by, 0, 0)
        ask_ahead(columns, c, last, bz, 0, 0)
        ask_at_solids(columns, c, last, Ax, lines)
        ask_at_solids(columns, c, last, Ay, lines)
        ask_at_solids(columns, c, last, Az, lines)
        i, j, k0, k1 = columns[c, 0], columns[c, 1], np.uint64(columns[c, 2]), np.uint64(columns[c, 3])
        if Ax is not None:
            if lines[i, j] != 0:
                _coefficients_of_column(grid, Ax, Ay, Az, wet, bx, by, bz, i, j, k0, k1)
                continue
        _coefficients_of_column(grid, None, None, None, wet, bx, by, bz, i, j, k0, k1)


@flow_kernel
def surface_coefficients(columns, first, last, widths, S1, S2, S3, h, A, d, F, V, opened, planes, wet, b):
    """b of the columns' upper faces along d (0, 1, 2) that lie between a liquid cell and another one.

    widths, h: of cells along d; S1[i] S2[j] S3[k]: the face's area; planes (mesh, 4) of F (planes.py).
    """
    di = np.int64(d == 0)
    dj = np.int64(d == 1)
    dk = np.int64(d == 2)
    for c in range(first, last):
        i = np.int64(columns[c, 0])
        j = np.int64(columns[c, 1])
        for k in range(columns[c, 2], columns[c, 3]):
            below = wet[i, j, k]
            if below == wet[i + di, j + dj, k + dk]:
                continue
            n = i * di + j * dj + k * dk
            conductance = S1[i] * S2[j] * S3[k] / h[n]
            if A is not None:
                conductance *= A[i, j, k]
            if conductance == 0.0:
                continue
            low = (i, j, np.int64(k))
            high = (i + di, j + dj, k + dk)
            if below != 0:
                share = wet_share(F, V, opened, planes, low, high, d, 1.0, widths[n], widths[n + 1])
            else:
                share = wet_share(F, V, opened, planes, high, low, d, -1.0, widths[n + 1], widths[n])
            b[i, j, k] = conductance / share


@flow_kernel
def diagonals(columns, first, last, grid, V, wet, bx, by, bz, give, diagonal):
    """Sum of the six b of liquid cells, plus `give` [1/length2] times their open volume; 0 in all other cells.

    give: what compressibility adds (projection.py), None without.
    """
    for c in range(first, last):
        ask_ahead(columns, c, last, bx, 0, 0)
        ask_ahead(columns, c, last, by, 0, 0)
        ask_ahead(columns, c, last, bz, 0, 0)
        ask_ahead(columns, c, last, V, 0, 0)
        ask_ahead(columns, c, last, diagonal, 0, 0)
        i = columns[c, 0]
        j = columns[c, 1]
        for k in range(np.uint64(columns[c, 2]), np.uint64(columns[c, 3])):
            total = 0.0
            if bx is not None:
                total += bx[i - 1, j, k] + bx[i, j, k]
            if by is not None:
                total += by[i, j - 1, k] + by[i, j, k]
            if bz is not None:
                total += bz[i, j, k - ONE] + bz[i, j, k]
            if give is not None:
                total += give * open_volume(grid, V, i, j, k)
            diagonal[i, j, k] = total if wet[i, j, k] != 0 else 0.0


@flow_kernel
def add_give(columns, first, last, grid, V, wet, give, scale, surface):
    """surface += scale give (open volume) in liquid cells: what `diagonals` adds, for multigrid.py."""
    for c in range(first, last):
        i = columns[c, 0]
        j = columns[c, 1]
        for k in range(np.uint64(columns[c, 2]), np.uint64(columns[c, 3])):
            if wet[i, j, k] != 0:
                surface[i, j, k] += np.float32(scale * give * open_volume(grid, V, i, j, k))


@flow_kernel
def clear(columns, first, last, a):
    """Zero in the columns' cells."""
    for c in range(first, last):
        i = columns[c, 0]
        j = columns[c, 1]
        for k in range(np.uint64(columns[c, 2]), np.uint64(columns[c, 3])):
            a[i, j, k] = 0.0


@flow_kernel
def foresee(columns, first, last, p, before, factor, wet, q):
    """q = factor (p + (p - before) / 2), between factor p / 2 and 2 factor p, in liquid cells: a first guess.

    Half of the last change: in a splash the whole of it is no better (5.4 and 5.5 iterations a step, 6.7 with p).
    """
    for c in range(first, last):
        ask_ahead(columns, c, last, p, 0, 0)
        ask_ahead(columns, c, last, before, 0, 0)
        ask_ahead(columns, c, last, q, 0, 0)
        i = columns[c, 0]
        j = columns[c, 1]
        for k in range(np.uint64(columns[c, 2]), np.uint64(columns[c, 3])):
            now = p[i, j, k]
            guess = 1.5 * now - 0.5 * before[i, j, k]
            low = min(0.5 * now, 2.0 * now)
            high = max(0.5 * now, 2.0 * now)
            q[i, j, k] = factor * min(max(guess, low), high) if wet[i, j, k] != 0 else q[i, j, k]


@flow_kernel
def scale_into(columns, first, last, a, factor, out):
    """out = factor a."""
    for c in range(first, last):
        i = columns[c, 0]
        j = columns[c, 1]
        for k in range(np.uint64(columns[c, 2]), np.uint64(columns[c, 3])):
            out[i, j, k] = factor * a[i, j, k]


@flow_kernel
def scale_liquid(columns, first, last, a, factor, wet, out):
    """out = factor a in liquid cells, 0 in the others: a cell that was liquid a step ago must not hold its pressure."""
    for c in range(first, last):
        ask_ahead(columns, c, last, a, 0, 0)
        ask_ahead(columns, c, last, out, 0, 0)
        i = columns[c, 0]
        j = columns[c, 1]
        for k in range(np.uint64(columns[c, 2]), np.uint64(columns[c, 3])):
            out[i, j, k] = factor * a[i, j, k] if wet[i, j, k] != 0 else 0.0


NO_SOLIDS = Open(None, None, None, None)
