"""Slivers: open fractions too small to carry a flow, closed once, at the start.

    A, V nearer than `least` to 0 or 1       become 0 or 1                                   (EPS of the decks)
    V < `lone`, no neighbour of V >= `lone` through an open face:      closed                (VFCLEAN)
    V < max A / `area_ratio`                 raised to it; only where it is asked for        (AVRCK)
    V = 0, or all faces closed               the cell and all its faces are closed

Closing a face may lock its neighbour in, so this is repeated until nothing changes; it only ever closes, so it ends.
Raising volumes moves a wall that lies just beyond a mesh plane by up to a third of a cell: it spoils what the exact cut
gives and nothing here needs it.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.favor.cell_parts import close_cell
from flowgmo.flow.fields import G
from flowgmo.kernel import inner, kernel


@inner
def _snap(x, least):
    if x < least:
        return 0.0
    return 1.0 if x > 1.0 - least else x


@kernel
def snap_fractions(V, Ax, Ay, Az, least):
    """All fractions nearer than `least` to 0 or 1 become 0 or 1."""
    nx, ny, nz = V.shape
    for i in range(G - 1, nx - G):
        for j in range(G - 1, ny - G):
            for k in range(G - 1, nz - G):
                V[i, j, k] = _snap(V[i, j, k], least)
                Ax[i, j, k] = _snap(Ax[i, j, k], least)
                Ay[i, j, k] = _snap(Ay[i, j, k], least)
                Az[i, j, k] = _snap(Az[i, j, k], least)


@inner
def _best_neighbour(V, Ax, Ay, Az, i, j, k):
    """Largest open face of a cell, and largest V behind an open face; a direction of one cell has no faces.

    Behind a side of the domain lies as much as in the cell itself.
    """
    nx, ny, nz = V.shape
    area = 0.0
    volume = 0.0
    if nx > 2 * G + 1:
        if Ax[i - 1, j, k] > 0.0:
            area = max(area, Ax[i - 1, j, k])
            volume = max(volume, V[i - 1, j, k] if i > G else V[i, j, k])
        if Ax[i, j, k] > 0.0:
            area = max(area, Ax[i, j, k])
            volume = max(volume, V[i + 1, j, k] if i < nx - G - 1 else V[i, j, k])
    if ny > 2 * G + 1:
        if Ay[i, j - 1, k] > 0.0:
            area = max(area, Ay[i, j - 1, k])
            volume = max(volume, V[i, j - 1, k] if j > G else V[i, j, k])
        if Ay[i, j, k] > 0.0:
            area = max(area, Ay[i, j, k])
            volume = max(volume, V[i, j + 1, k] if j < ny - G - 1 else V[i, j, k])
    if nz > 2 * G + 1:
        if Az[i, j, k - 1] > 0.0:
            area = max(area, Az[i, j, k - 1])
            volume = max(volume, V[i, j, k - 1] if k > G else V[i, j, k])
        if Az[i, j, k] > 0.0:
            area = max(area, Az[i, j, k])
            volume = max(volume, V[i, j, k + 1] if k < nz - G - 1 else V[i, j, k])
    return area, volume


@kernel
def find_slivers(V, Ax, Ay, Az, lone, marked):
    """Mark (uint8) the real cells to be closed; returns how many are marked that are not closed yet."""
    nx, ny, nz = V.shape
    found = np.int64(0)
    for i in range(G, nx - G):
        for j in range(G, ny - G):
            for k in range(G, nz - G):
                marked[i, j, k] = 0
                if V[i, j, k] == 1.0 and Ax[i, j, k] == 1.0 and nx > 2 * G + 1:
                    continue
                if V[i, j, k] == 0.0:
                    faces = (
                        Ax[i - 1, j, k] + Ax[i, j, k] + Ay[i, j - 1, k] + Ay[i, j, k] + Az[i, j, k - 1] + Az[i, j, k]
                    )
                    marked[i, j, k] = faces > 0.0
                else:
                    area, neighbour = _best_neighbour(V, Ax, Ay, Az, i, j, k)
                    marked[i, j, k] = area == 0.0 or (V[i, j, k] < lone and neighbour < lone)
                found += marked[i, j, k]
    return found


@kernel
def close_marked(V, Ax, Ay, Az, marked):
    """Close the marked cells with all their faces."""
    nx, ny, nz = V.shape
    for i in range(G, nx - G):
        for j in range(G, ny - G):
            for k in range(G, nz - G):
                if marked[i, j, k]:
                    close_cell(V, Ax, Ay, Az, i, j, k)


@kernel
def raise_volumes(V, Ax, Ay, Az, area_ratio):
    """V >= largest open face / area_ratio in open cells."""
    nx, ny, nz = V.shape
    for i in range(G, nx - G):
        for j in range(G, ny - G):
            for k in range(G, nz - G):
                if 0.0 < V[i, j, k] < 1.0:
                    area, _ = _best_neighbour(V, Ax, Ay, Az, i, j, k)
                    V[i, j, k] = max(V[i, j, k], min(area / area_ratio, 1.0))


def close_slivers(V, Ax, Ay, Az, least: float, lone: float, area_ratio: float | None) -> None:
    """Clean the arrays of real cells and faces up, in place. Ghosts are left alone."""
    snap_fractions(V, Ax, Ay, Az, least)
    marked = np.zeros(V.shape, np.uint8)
    while find_slivers(V, Ax, Ay, Az, lone, marked):
        close_marked(V, Ax, Ay, Az, marked)
    if area_ratio is not None:
        raise_volumes(V, Ax, Ay, Az, area_ratio)
