"""Write open fractions of a list of cells into the arrays of the mesh, with the mirror images beyond the sides.

A ghost holds what its mirror image inside holds (fractions.mirror_ghosts): entry g of a side the image of entry
image[g] along that direction, one direction after the other, so that in edges and corners all of them are images.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.fields import G
from flowgmo.kernel import inner, kernel


@kernel
def put_faces(cells, opened, Ax, Ay, Az):
    """Faces of cells (n, 3) [with ghosts] from opened (n, 6 or 7); the later of two cells wins."""
    for c in range(len(cells)):
        i = cells[c, 0]
        j = cells[c, 1]
        k = cells[c, 2]
        Ax[i - 1, j, k] = opened[c, 0]
        Ax[i, j, k] = opened[c, 1]
        Ay[i, j - 1, k] = opened[c, 2]
        Ay[i, j, k] = opened[c, 3]
        Az[i, j, k - 1] = opened[c, 4]
        Az[i, j, k] = opened[c, 5]


@kernel
def close_full(cells, opened, Ax, Ay, Az):
    """Close all faces of cells whose opened[:, 6] is 0."""
    for c in range(len(cells)):
        if opened[c, 6] == 0.0:
            i = cells[c, 0]
            j = cells[c, 1]
            k = cells[c, 2]
            Ax[i - 1, j, k] = 0.0
            Ax[i, j, k] = 0.0
            Ay[i, j - 1, k] = 0.0
            Ay[i, j, k] = 0.0
            Az[i, j, k - 1] = 0.0
            Az[i, j, k] = 0.0


@kernel
def put_volumes(cells, opened, V):
    """V of cells (n, 3) from opened[:, 6]."""
    for c in range(len(cells)):
        V[cells[c, 0], cells[c, 1], cells[c, 2]] = opened[c, 6]


@inner
def _image(g, n, staggered):
    """The inner entry along a direction of n cells that entry g shows; itself where it is no ghost.

    staggered: upper faces across this direction, of which entry G - 1 lies on the domain's side.
    """
    high = G + n - 1
    low = G - 1 if staggered else G
    if g < low:
        return min(2 * low - g if staggered else 2 * low - 1 - g, high)
    if g > high:
        return max(2 * high - g if staggered else 2 * high + 1 - g, low)
    return g


@inner
def _copy(a, i, j, k, axis):
    """Write a[i, j, k] into all its images; axis as of mirror_ghosts."""
    nx = a.shape[0] - 2 * G
    ny = a.shape[1] - 2 * G
    nz = a.shape[2] - 2 * G
    value = a[i, j, k]
    for ii in range(a.shape[0] if i <= 2 * G or i >= nx - 1 else 1):
        p = ii if i <= 2 * G or i >= nx - 1 else i
        if _image(p, nx, axis == 0) != i:
            continue
        for jj in range(a.shape[1] if j <= 2 * G or j >= ny - 1 else 1):
            q = jj if j <= 2 * G or j >= ny - 1 else j
            if _image(q, ny, axis == 1) != j:
                continue
            for kk in range(a.shape[2] if k <= 2 * G or k >= nz - 1 else 1):
                r = kk if k <= 2 * G or k >= nz - 1 else k
                if _image(r, nz, axis == 2) == k:
                    a[p, q, r] = value


@kernel
def mirror_cells(cells, a, axis):
    """Write the images of what cells (n, 3) and their lower faces hold; axis -1: cell centres, 0, 1, 2: upper faces."""
    nx, ny, nz = a.shape
    for c in range(len(cells)):
        i = np.int64(cells[c, 0])
        j = np.int64(cells[c, 1])
        k = np.int64(cells[c, 2])
        near = i <= 2 * G or i >= nx - 2 * G - 1 or j <= 2 * G or j >= ny - 2 * G - 1
        if not (near or k <= 2 * G or k >= nz - 2 * G - 1):
            continue
        for face in range(2 if axis >= 0 else 1):  # one call in a loop is compiled once
            _copy(a, i - face * (axis == 0), j - face * (axis == 1), k - face * (axis == 2), axis)
