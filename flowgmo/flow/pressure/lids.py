"""The void that is left between a cell's centre and a closed face: the surface lies inside the cell.

A liquid cell learns of the surface from neighbours that are not liquid. Under a lid there is none: the last half cell
would count as full, nothing could flow into it, and the cell would be stopped at once when its centre becomes wet.

        ######  closed face             out = S (u* + q_c / delta)    S: of the plane, seen from the closed face
       |  void  |                       u* out of the opposite face, before the pressure acts
       |==x=====|  plane, q = 0         delta: from the centre to where the plane meets the line normal to the face
       |   o    |  centre, q_c
       +---^u*--+  the face opposite, through which the cell fills

This is the flow through a face to the air (pressure_matrix.py) that has the velocity of the face opposite: in a column
of liquid under the lid all faces have one velocity, hydrostatic pressure holds liquid at rest exactly, and at F = 1/2,
delta = 0, the equation is that of the cell below, which has met the surface here at the whole distance so far.
The plane as seen from the closed face covers what is wet of the face opposite and dry of the closed one, all of it if
it is level; delta may lie up to half a cell beyond. What wets the lid is held by it. Summed over the cell's closed
faces, out = U* + B q_c with B = sum S / delta.

What flows out is liquid that fills the void, so that it has a bound, and where it is reached the void has a pressure:

    out <= R,    q_void >= 0,    one of them is equal           R = room / dt

a linear complementarity problem. Its matrix is an M-matrix: beginning with all lids open, those that let out too much
are shut (out = R, given) and the rest solved again; pressures only rise, so that none has to be opened again, and that
ends (Chandrasekaran 1970, "A special case of the complementary pivot problem", Opsearch 7). Liquid that leaves the lid
is not hindered. While there is much room only a share of it is filled in a step: what arrives at a wall is stopped
within its last half cell, not within one step.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flowgmo.flow.fields import G, Grid, Open
from flowgmo.flow.surface.planes import Planes
from flowgmo.flow.surface.plic import FULL, crossing, share_of_slab, stretched, volume_under
from flowgmo.flow.surface.surface_normals import plane_at
from flowgmo.flow.team import Team
from flowgmo.kernel import flow_kernel, inner, kernel

OPEN, SHUT, ABSENT = 0, 1, 2  # a side of the domain: flow crosses it, nothing does, the direction has one cell
NEAREST = 1e-3  # least delta in cell widths: keeps 1 / delta finite, moves the surface by 1e-3 of a cell at most
FARTHEST = 1.0  # largest, where a cell beyond the face, were it open, would begin to be liquid
SHARE = 0.3  # of the room that is filled in a step; with half, 25 kPa for 3 ms on the box of dam_break, now 12
THIN = 0.02  # of a cell: so little room is filled at once: halves would take three steps more for each digit
MARGIN = 1.5  # on the void that leaves through the cell's faces: the planes turn from sweep to sweep (measured: 1.1)


class Lids(NamedTuple):
    """Cells with a void under a closed face: cells (n, 3) int32, conductance (n,) [length] B, area (n, 6) [length2]
    S for each closed face that the plane faces, 0 for others, room (n,) and volume (n,) [length3] void and cell,
    planes (n, 4) m and alpha (plic.py)."""

    cells: np.ndarray
    conductance: np.ndarray
    area: np.ndarray
    room: np.ndarray
    volume: np.ndarray
    planes: np.ndarray

    @property
    def at(self) -> tuple:
        """The cells, as an index of arrays of mesh size."""
        return tuple(self.cells.T)


@inner
def _shut(A, at_side, code, i, j, k):
    """Whether the upper face of a cell is closed; at_side: it lies on the domain's side, of kind `code`."""
    if at_side and code == SHUT:
        return True
    if A is not None:
        return A[i, j, k] == 0.0
    return False


@inner
def faces_shut(F, opened, closed, i, j, k):
    """(low, high) for x, y, z: whether each face of the cell is closed; both False in absent directions."""
    nx, ny, nz = F.shape
    x = (False, False)
    y = (False, False)
    z = (False, False)
    if closed[0] != ABSENT:
        low, high = i == G, i == nx - G - 1
        x = _shut(opened.Ax, low, closed[0], i - 1, j, k), _shut(opened.Ax, high, closed[1], i, j, k)
    if closed[2] != ABSENT:
        low, high = j == G, j == ny - G - 1
        y = _shut(opened.Ay, low, closed[2], i, j - 1, k), _shut(opened.Ay, high, closed[3], i, j, k)
    if closed[4] != ABSENT:
        low, high = k == G, k == nz - G - 1
        z = _shut(opened.Az, low, closed[4], i, j, k - 1), _shut(opened.Az, high, closed[5], i, j, k)
    return x, y, z


@inner
def may_have_lid(F, opened, closed, i, j, k):
    """Whether a liquid cell has void and a closed face across from an open one."""
    if F[i, j, k] >= FULL:
        return False
    x, y, z = faces_shut(F, opened, closed, i, j, k)
    return x[0] != x[1] or y[0] != y[1] or z[0] != z[1]


@inner
def _wet_share(m, alpha, d, at):
    """Share of the cell's face at xi_d = at (0 or 1) that is wet."""
    return volume_under(stretched(m, d, 0.0), alpha - m[d] * at)


@inner
def _add_lid(A, m, alpha, d, shut, i, j, k, S, width, area, n):
    """area[n] of the closed face along d that the plane faces, if any; returns its conductance."""
    if shut[0] == shut[1]:
        return 0.0
    high = np.int64(1 if shut[1] else 0)
    sign = 1.0 if high == 1 else -1.0
    delta = sign * crossing(m, alpha, d) if m[d] * sign > 0.0 else -1.0
    if delta < -NEAREST or delta > FARTHEST:
        return 0.0
    seen = _wet_share(m, alpha, d, 1.0 - high) - _wet_share(m, alpha, d, 1.0 * high)
    open_area = S * max(seen, 0.0)
    if A is not None:
        open_area *= A[i - high * (d == 0), j - high * (d == 1), k - high * (d == 2)]
    area[n, 2 * d + high] = open_area
    return open_area / (max(delta, NEAREST) * width)


@flow_kernel
def _find(columns, first, last, ends, F, V, opened, surfaces, grid, closed, wet,
          cells, conductance, area, room, volume, planes):  # fmt: skip
    """Fill the arrays of Lids in the order of the columns, up to ends (columns,) for each; where none is, conductance
    stays 0. surfaces (mesh, 4): the planes of F (surface/planes.py)."""
    for c in range(first, last):
        n = ends[c - 1] if c > 0 else np.int64(0)
        if ends[c] == n:
            continue
        i, j = np.int64(columns[c, 0]), np.int64(columns[c, 1])
        for k in range(columns[c, 2], columns[c, 3]):
            if wet[i, j, k] == 0 or not may_have_lid(F, opened, closed, i, j, k):
                continue
            m, alpha = plane_at(surfaces, i, j, k)
            x, y, z = faces_shut(F, opened, closed, i, j, k)
            dx, dy, dz = grid.dx[i], grid.dy[j], grid.dz[k]
            for f in range(6):
                area[n, f] = 0.0
            B = _add_lid(opened.Ax, m, alpha, 0, x, i, j, k, dy * dz, dx, area, n)
            B += _add_lid(opened.Ay, m, alpha, 1, y, i, j, k, dx * dz, dy, area, n)
            B += _add_lid(opened.Az, m, alpha, 2, z, i, j, k, dx * dy, dz, area, n)
            if B > 0.0:
                cells[n, 0], cells[n, 1], cells[n, 2] = i, j, k
                conductance[n] = B
                planes[n, 0], planes[n, 1], planes[n, 2] = m
                planes[n, 3] = alpha
                volume[n] = dx * dy * dz
                room[n] = (1.0 - F[i, j, k]) * volume[n]
                if V is not None:
                    room[n] *= V[i, j, k]
                n += 1


def find_lids(
    team: Team, columns: np.ndarray, counts: np.ndarray, F: np.ndarray, openings: Open, planes: Planes, grid: Grid,
    closed: np.ndarray, wet: np.ndarray,
) -> Lids:  # fmt: skip
    """The Lids in the columns. F [-] with ghosts filled; counts (columns,): cells of each that may have one.

    closed (6,) int8: OPEN, SHUT or ABSENT for each side of the domain; wet (mesh) as of mark_liquid.
    """
    ends = np.cumsum(counts)
    lids = _empty(int(ends[-1]) if len(ends) else 0)
    if not len(lids.cells):
        return lids
    lids.conductance.fill(0.0)
    team.run_uneven(_find, columns, ends, F, openings.V, openings, planes.at, grid, closed, wet, *lids)
    there = lids.conductance > 0.0
    return Lids(*(a[there] for a in lids))


def no_lids() -> Lids:
    """None."""
    return _empty(0)


def _empty(n: int) -> Lids:
    return Lids(np.empty((n, 3), np.int32), np.empty(n), np.empty((n, 6)), np.empty(n), np.empty(n), np.empty((n, 4)))


def outflow(lids: Lids, velocity: list) -> np.ndarray:
    """(n,) [length3/time] U*: what the predicted velocities [u, v, w] let out through the planes."""
    total = np.zeros(len(lids.cells))
    for d, u in enumerate(velocity):
        if u is not None:
            low = tuple(lids.cells[:, e] - (e == d) for e in range(3))
            total += lids.area[:, 2 * d + 1] * u[low] - lids.area[:, 2 * d] * u[lids.at]
    return total


@inner
def _void_through(A, u, b, q, S, width, dt, m, alpha, d, i, j, k):
    """Void [length3] that leaves a cell through its faces along d within dt, as the pressure q moves them."""
    di, dj, dk = np.int64(d == 0), np.int64(d == 1), np.int64(d == 2)
    total = 0.0
    for high in range(2):
        e, f, g = i - di * (1 - high), j - dj * (1 - high), k - dk * (1 - high)
        area = S
        if A is not None:
            area *= A[e, f, g]
        if area > 0.0:
            speed = u[e, f, g] - (q[e + di, f + dj, g + dk] - q[e, f, g]) * b[e, f, g] / area
            thick = min((speed if high == 1 else -speed) * dt / width, 1.0)
            if thick > 0.0:
                low = 1.0 - thick if high == 1 else 0.0
                total += area * width * thick * (1.0 - share_of_slab(m, alpha, d, low, low + thick))
    return total


@kernel
def _void_out(lids, grid, opened, u, v, w, bx, by, bz, q, dt, out):
    """out (n,) [length3]: the void that leaves each of the cells through its faces within dt."""
    for n in range(len(lids.cells)):
        i, j, k = np.int64(lids.cells[n, 0]), np.int64(lids.cells[n, 1]), np.int64(lids.cells[n, 2])
        m, alpha = (lids.planes[n, 0], lids.planes[n, 1], lids.planes[n, 2]), lids.planes[n, 3]
        dx, dy, dz = grid.dx[i], grid.dy[j], grid.dz[k]
        out[n] = 0.0
        if u is not None:
            out[n] += _void_through(opened.Ax, u, bx, q, dy * dz, dx, dt, m, alpha, 0, i, j, k)
        if v is not None:
            out[n] += _void_through(opened.Ay, v, by, q, dx * dz, dy, dt, m, alpha, 1, i, j, k)
        if w is not None:
            out[n] += _void_through(opened.Az, w, bz, q, dx * dy, dz, dt, m, alpha, 2, i, j, k)


def bound(lids: Lids, grid: Grid, openings: Open, velocity: list, b: tuple, q: np.ndarray, dt: float) -> np.ndarray:
    """(n,) [length3/time] R: the most that may flow out, with what void leaves through the faces of the cell.

    velocity [u, v, w] before the pressure q acts, b its coefficients of faces.
    """
    away = np.zeros(len(lids.cells))
    if len(away):
        _void_out(lids, grid, openings, *velocity, *b, q, dt, away)
    room = np.maximum(lids.room - MARGIN * away, 0.0)
    return np.minimum(room, np.maximum(SHARE * room, THIN * lids.volume)) / dt
