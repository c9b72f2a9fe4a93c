"""The solid's surface in each cut cell as a plane: what the liquid's interface meets there.

    n     unit normal into the open part:  sum over the faces of (open area x outward normal), made unit length;
          for a plane wall exactly its normal (the areas of a closed surface sum to zero)
    d     the open part is  n . (x - x_c) > d,  x_c the middle of the cell, so that it has the volume V

With m_i = |n_i| dx_i / sum, and α the depth of the plane below the open part's farthest corner (in units of the sum),
V(α) is a cubic in three pieces; it is inverted piece by piece, the cubic ones by Newton's method inside a bracket.

Source  Scardovelli & Zaleski 2000, Analytical relations connecting linear interfaces and volume fractions, eqs. 15-16.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flowgmo.flow.fields import G, Grid, Open
from flowgmo.kernel import inner, kernel

NO_WALL = 1e-12  # of the cell's largest face: a wall area of rounding size has no direction
STEPS = 60  # halvings that reach the last bit, Newton needs five


class SolidPlanes(NamedTuple):
    """cells (n, 3) int32 [with ghosts], planes (n, 4): normal x y z [-] into the open part, d [length]."""

    cells: np.ndarray
    planes: np.ndarray


@inner
def _cubic_root(a3, a2, a1, a0, low, high):
    """Root in [low, high] of a3 x^3 + a2 x^2 + a1 x + a0, which rises there from <= 0 to >= 0."""
    x = 0.5 * (low + high)
    for _ in range(STEPS):
        value = ((a3 * x + a2) * x + a1) * x + a0
        if value > 0.0:
            high = x
        else:
            low = x
        slope = (3.0 * a3 * x + 2.0 * a2) * x + a1
        new = x - value / slope if slope > 0.0 else low
        if not low < new < high:
            new = 0.5 * (low + high)
        if new == x:
            break
        x = new
    return x


@inner
def depth_of_volume(m1, m2, m3, volume):
    """α in [0, 1] with V(α) = volume [-]; m1 + m2 + m3 = 1, each >= 0, in any order."""
    V = min(volume, 1.0 - volume)
    a = min(m1, m2, m3)
    c = max(m1, m2, m3)
    b = max(min(m1, m2), min(max(m1, m2), m3))
    both = a + b
    product = 6.0 * a * b * c
    first = a * a / max(6.0 * b * c, 1e-300)  # V at α = a; b may be 0, then a is too
    if V < first:
        alpha = np.cbrt(product * V)
    elif V < first + 0.5 * (b - a) / c:
        alpha = 0.5 * (a + np.sqrt(a * a + 8.0 * b * c * (V - first)))
    elif c >= both and V >= 0.5 * both / c:
        alpha = c * V + 0.5 * both
    else:
        squares = a * a + b * b
        cubes = a * a * a + b * b * b - product * V
        top = min(both, c)
        at_top = ((3.0 * both - top) * top - 3.0 * squares) * top + cubes
        if at_top >= 0.0:
            alpha = _cubic_root(-1.0, 3.0 * both, -3.0 * squares, cubes, b, top)
        else:
            alpha = _cubic_root(-2.0, 3.0, -3.0 * (squares + c * c), cubes + c * c * c, top, 0.5)
    return alpha if volume <= 0.5 else 1.0 - alpha


@kernel
def _find_planes(V, Ax, Ay, Az, dx, dy, dz, cells, planes):
    """Fill cells and planes, as far as they reach; returns the number of cut cells."""
    nx, ny, nz = V.shape
    n = np.int64(0)
    for i in range(G, nx - G):
        for j in range(G, ny - G):
            for k in range(G, nz - G):
                if not 0.0 < V[i, j, k] < 1.0:
                    continue
                fx = dy[j] * dz[k]
                fy = dz[k] * dx[i]
                fz = dx[i] * dy[j]
                ax = (Ax[i, j, k] - Ax[i - 1, j, k]) * fx
                ay = (Ay[i, j, k] - Ay[i, j - 1, k]) * fy
                az = (Az[i, j, k] - Az[i, j, k - 1]) * fz
                size = np.sqrt(ax * ax + ay * ay + az * az)
                if size <= NO_WALL * max(fx, fy, fz):
                    continue
                if n < len(cells):
                    mx = abs(ax) * dx[i]
                    my = abs(ay) * dy[j]
                    mz = abs(az) * dz[k]
                    total = mx + my + mz
                    alpha = depth_of_volume(mx / total, my / total, mz / total, V[i, j, k])
                    cells[n, 0] = i
                    cells[n, 1] = j
                    cells[n, 2] = k
                    planes[n, 0] = ax / size
                    planes[n, 1] = ay / size
                    planes[n, 2] = az / size
                    planes[n, 3] = (0.5 - alpha) * total / size
                n += 1
    return n


def solid_planes(open_: Open, grid: Grid) -> SolidPlanes:
    """The plane of the solid in every cell that it cuts and where its wall has a direction; none without solids."""
    if open_.V is None:
        return SolidPlanes(np.zeros((0, 3), np.int32), np.zeros((0, 4)))
    found = SolidPlanes(np.zeros((0, 3), np.int32), np.zeros((0, 4)))
    n = _find_planes(*open_, grid.dx, grid.dy, grid.dz, *found)
    found = SolidPlanes(np.empty((n, 3), np.int32), np.empty((n, 4)))
    _find_planes(*open_, grid.dx, grid.dy, grid.dz, *found)
    return found
