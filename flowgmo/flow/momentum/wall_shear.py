"""No-slip walls (`IWSH` = 1): the stress of a layer in which the velocity falls linearly to the wall's own.

    tau = mu (u - u_wall) / d,      force on the liquid of a face of component c, per volume of its cell and mu:
                                    s (u_wall - u),   s = sum A_wall / (d volume)   [1/length2]

Domain sides: d is half the cell, s = 2 / width^2, on the components along the side, as far as A on the side is open:
where a solid stands on it, or where A was closed because the side is a wall, the wall is one of the solids'.

Solids. A cell's wall is what its open fractions leave over. Along each direction the open part's shadow is at least
P = max(V, A_below, A_above) of the face, so that P - A_below of it ends on a wall below and P - A_above above (the
closure sum A n = 0, but it also sees both walls of a gap narrower than a cell). With W the areas of all three
directions, |W| that of an oblique wall, and W' the greater one of each direction's two,

    d = least of { V volume / (2 |W'|), half the cell's width along W' }

the first is exact for a wall along the mesh, the second for a wall that cuts off a corner. Water that a wall carries
along has no velocity across it, so the tangential velocity is the velocity itself and component c feels all of |W|; a
wall square to c nothing. Between them: min(|W|, sqrt(2) |W without c|), exact at 0, 45, and 90 degrees. In a cell
open to the full, walls lie on its faces, each d = half a width away.

Roughness is not in this stress; it would shorten d.

A side whose table changes in time slides at another speed in every stage of a step: u_wall of the stage's own time, so
that the stress is of second order in time as the rest is (momentum.py). Only speeds change, s and the faces stay.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flowgmo.flow.favor.cut_faces import U64, wet_face
from flowgmo.flow.fields import G, Grid, Open
from flowgmo.kernel import flow_kernel, inner

Array = np.ndarray


class SideWalls(NamedTuple):
    """Faces of one component beside no-slip sides of the domain; in an edge both sides together.

    rows (n, 4) int32 as columns of one cell; s [1/length2] (n,); speed (n,) [length/time] of the wall along the
    component; c the component; shares (n, 6) [-] of s that each side makes.
    """

    rows: Array
    s: Array
    speed: Array
    c: int
    shares: Array


def find_side_walls(
    grid: Grid, open: Open, no_slip: tuple[bool, ...], speeds: Array, c: int, present: tuple[bool, ...]
) -> SideWalls | None:
    """The faces of component c (0, 1, 2) beside sides that are no_slip (6 of them), moving at speeds (6, 3).

    present (3,): directions that are not absent; an absent one has no walls.
    """
    widths = grid[:3]
    n = [len(d) - 2 * G for d in widths]
    parts = []
    for side in range(6):
        d = side // 2
        if not no_slip[side] or d == c or not present[d]:
            continue
        ranges = [np.arange(G, m + G) for m in n]
        ranges[d] = np.array([G if side % 2 == 0 else n[d] + G - 1])
        i, j, k = (a.ravel() for a in np.meshgrid(*ranges, indexing="ij"))
        share = np.ones(i.size)
        if open.V is not None:
            share = _open_share(open, (i, j, k), c, d, side)
            keep = share > 0.0
            i, j, k, share = i[keep], j[keep], k[keep], share[keep]
        s = share * (2.0 / widths[d][ranges[d][0]] ** 2)
        rows = np.column_stack([i, j, k, k + 1]).astype(np.int32)
        parts.append((rows, s, np.full(i.size, side)))
    if not parts:
        return None
    rows, s, of_side = (np.concatenate(a) for a in zip(*parts, strict=True))
    numbers = np.ravel_multi_index(tuple(rows[:, :3].T), tuple(len(d) for d in widths))  # sorted much faster than rows
    _, first, of = np.unique(numbers, return_index=True, return_inverse=True)
    rows = rows[first]
    total = np.bincount(of, s)
    shares = np.zeros((len(rows), 6))
    shares[of, of_side] = s / total[of]
    walls = SideWalls(rows, total, np.zeros(len(rows)), c, shares)
    slide(walls, speeds)
    return walls


def slide(walls: SideWalls, speeds: Array) -> None:
    """Set walls.speed to sides moving at speeds (6, 3) [length/time]; in an edge the mean of both by their shares."""
    speed, along = walls.speed, speeds[:, walls.c]
    speed.fill(0.0)
    for side in np.flatnonzero(along):
        speed += walls.shares[:, side] * along[side]


def _open_share(open: Open, at: tuple[Array, Array, Array], c: int, d: int, side: int) -> Array:
    """(n,): open area of the side beside faces of component c, as a share of the faces' open volume, at most 1."""
    lower = tuple(a - (e == d and side % 2 == 0) for e, a in enumerate(at))
    step = [int(e == c) for e in range(3)]
    area = open[1 + d][lower] + open[1 + d][tuple(a + b for a, b in zip(lower, step, strict=True))]
    volume = open.V[at] + open.V[tuple(a + b for a, b in zip(at, step, strict=True))]
    return np.where(open[1 + c][at] > 0.0, area / np.maximum(np.maximum(area, volume), 1e-300), 0.0)


@inner
def _shadow(V, A, i, j, k, di, dj, dk):
    """Share of a cell's section that ends on a wall below and above along d; all open where the direction is absent."""
    if A is None:
        return 0.0, 0.0
    below = A[i - di, j - dj, k - dk]
    above = A[i, j, k]
    shadow = max(V, max(below, above))
    return shadow - below, shadow - above


@inner
def cell_shear(V, Ax, Ay, Az, dx, dy, dz, i, j, k, c):
    """A_wall / d [length] of one cell for component c."""
    part = V[i, j, k]
    if not part > 0.0:
        return 0.0
    x0, x1 = _shadow(part, Ax, i, j, k, U64(1), U64(0), U64(0))
    y0, y1 = _shadow(part, Ay, i, j, k, U64(0), U64(1), U64(0))
    z0, z1 = _shadow(part, Az, i, j, k, U64(0), U64(0), U64(1))
    a = dy[j] * dz[k]
    b = dx[i] * dz[k]
    e = dx[i] * dy[j]
    if part >= 1.0:
        x = 2.0 * (x0 + x1) * a / dx[i] if c != 0 else 0.0
        y = 2.0 * (y0 + y1) * b / dy[j] if c != 1 else 0.0
        z = 2.0 * (z0 + z1) * e / dz[k] if c != 2 else 0.0
        return x + y + z
    wx = (x0 + x1) * a
    wy = (y0 + y1) * b
    wz = (z0 + z1) * e
    area = np.sqrt(wx * wx + wy * wy + wz * wz)
    if not area > 0.0:
        return 0.0
    across = np.sqrt((wx * wx if c != 0 else 0.0) + (wy * wy if c != 1 else 0.0) + (wz * wz if c != 2 else 0.0))
    nx = max(x0, x1) * a
    ny = max(y0, y1) * b
    nz = max(z0, z1) * e
    greater = np.sqrt(nx * nx + ny * ny + nz * nz)
    half = 0.5 * (nx * dx[i] + ny * dy[j] + nz * dz[k]) / greater
    d = min(0.5 * part * (a * dx[i]) / greater, half)
    return min(area, np.sqrt(2.0) * across) / d


@flow_kernel
def solid_shear(rows, first, last, ci, cj, ck, V, Ax, Ay, Az, dx, dy, dz, out):
    """out (n,) = s [1/length2] of faces rows (n, 4) of one component: half of each of its two cells."""
    c = 0 * ci + 1 * cj + 2 * ck
    for r in range(first, last):
        i = U64(rows[r, 0])
        j = U64(rows[r, 1])
        k = U64(rows[r, 2])
        a = i + ci
        b = j + cj
        h = k + ck
        total = cell_shear(V, Ax, Ay, Az, dx, dy, dz, i, j, k, c) + cell_shear(V, Ax, Ay, Az, dx, dy, dz, a, b, h, c)
        volume = 0.125 * (dx[i] + dx[a]) * (dy[j] + dy[b]) * (dz[k] + dz[h])
        out[r] = 0.5 * total / volume


@flow_kernel
def shear_sides(rows, first, last, ci, cj, ck, q, F, s, speed, factor, out, change):
    """out and change (None: not wanted) += factor s (speed - q) on wet faces; speed None: at rest."""
    for r in range(first, last):
        i = U64(rows[r, 0])
        j = U64(rows[r, 1])
        k = U64(rows[r, 2])
        if wet_face(F, i, j, k, ci, cj, ck):
            wall = 0.0
            if speed is not None:
                wall = speed[r]
            out[i, j, k] += factor * s[r] * (wall - q[i, j, k])
            if change is not None:
                change[i, j, k] += factor * s[r] * (wall - q[i, j, k])


@flow_kernel
def wall_force(rows, first, last, ci, cj, ck, q, F, s, speed, mu, dx, dy, dz, out):
    """out (n,) = mu s (q - speed) volume [force]: what the liquid exerts on the wall beside each face, along c.

    rows, s of one component: of domain sides, or of solids (viscosity.CutViscosity). With the share of a component of
    the scene in the wall of each face, the sum of share * out is that component's shear force.
    """
    for r in range(first, last):
        i = U64(rows[r, 0])
        j = U64(rows[r, 1])
        k = U64(rows[r, 2])
        volume = 0.125 * (dx[i] + dx[i + ci]) * (dy[j] + dy[j + cj]) * (dz[k] + dz[k + ck])
        wall = 0.0
        if speed is not None:
            wall = speed[r]
        out[r] = mu * s[r] * (q[i, j, k] - wall) * volume if wet_face(F, i, j, k, ci, cj, ck) else 0.0
