"""Cells that a solid cuts and that are not liquid yet, but cannot take what flows towards them.

The centre of a cell that a wall cuts may lie in the wall: then the surface of liquid that comes to the wall never
reaches the centre, and the cell ends the liquid with q = 0 until it is full, however much flows in. What does not fit
would be stopped at once in the step after. So, as for lids (lids.py), the flow through the faces that liquid touches
is bound by the room, and where the bound is reached the void has a pressure:

    in - grown <= R,    q >= 0,    one of them is equal         R = room / dt

room: of the cell, and of the halves of its neighbours beside these faces, which has to come in or to be filled first.
So a cell that is hardly open is a lid on its neighbour.

grown: what a body that moves opens of the cell in a unit of time (immersed.py), < 0 where it closes it. The equation
asks a shut cell for that anyway, so that the room is that before the body moved, (1 - F) V0. With the room of V1 a cell
that opens from nothing took 1.3 times what it holds once it was shut: cells that were overfull, and jets in the slits
behind light bodies (hard/wet_shell).

What closes takes of the room first. Of the cell's own (1 - F) V0 is left (1 - F) V0 + dt grown, and R is what is bound
of that, less grown. Where nothing is left the cell is full within the step, and lets out what does not fit: R dt =
(1 - F) V0, all of it. Where it was not counted, a box that fell into a pile of others left .19 of a cell to a neighbour
that was full (hard/wet_pile).
Bodies that the pressure moves close it with the velocity that they have with q (Voids.opening): a ball of a thousandth
of the water's density that hits the water at 3 m/s stops at once, and closes nothing.

q is the pressure at the surface, where the coefficients b of the faces end (pressure_matrix.py): a shut cell is an
unknown of the same matrix, with sum b (q - q_neighbour) = in* - R over these faces.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.fields import Grid, Open
from flowgmo.flow.pressure.lids import ABSENT, SHARE, THIN, faces_shut
from flowgmo.flow.surface.plic import is_mixed, is_plane, share_of_slab
from flowgmo.flow.surface.surface_normals import Steps, plane_of_cell
from flowgmo.kernel import inner, kernel

POCKET = 2  # in `wet`, until the columns are known


@inner
def _leads_to_void(wet, F, i, j, k):
    """Whether a cell is void: dry, or a pocket that is less than half full."""
    return wet[i, j, k] == 0 or (wet[i, j, k] == POCKET and F[i, j, k] < 0.5)


@inner
def _beside_void(wet, F, opened, closed, i, j, k):
    """Whether an open face of a cell leads to void."""
    x, y, z = faces_shut(F, opened, closed, i, j, k)
    found = False
    if closed[0] != ABSENT:
        found |= not x[0] and _leads_to_void(wet, F, i - 1, j, k)
        found |= not x[1] and _leads_to_void(wet, F, i + 1, j, k)
    if closed[2] != ABSENT:
        found |= not y[0] and _leads_to_void(wet, F, i, j - 1, k)
        found |= not y[1] and _leads_to_void(wet, F, i, j + 1, k)
    if closed[4] != ABSENT:
        found |= not z[0] and _leads_to_void(wet, F, i, j, k - 1)
        found |= not z[1] and _leads_to_void(wet, F, i, j, k + 1)
    return found


@kernel
def take_pockets(columns, counts, F, opened, closed, wet, cells):
    """Cells (n, 3) int32 of the columns marked POCKET in `wet`, which becomes 0; counts (columns,): if any.

    A pocket amid liquid is liquid (1, and not in the list): void that is left there, mostly by the split of the sweeps,
    would take the pressure away around it at once, and give it back with a blow two steps later.
    """
    n = np.int64(0)
    for c in range(columns.shape[0]):
        if counts[c] > 0:
            i, j = np.int64(columns[c, 0]), np.int64(columns[c, 1])
            for k in range(columns[c, 2], columns[c, 3]):
                if wet[i, j, k] == POCKET:
                    cells[n, 0], cells[n, 1], cells[n, 2] = i, j, k
                    n += 1
    amid = np.zeros(n, np.bool_)
    for m in range(n):
        i, j, k = np.int64(cells[m, 0]), np.int64(cells[m, 1]), np.int64(cells[m, 2])
        amid[m] = F[i, j, k] >= 0.5 and not _beside_void(wet, F, opened, closed, i, j, k)
    kept = np.int64(0)
    for m in range(n):
        i, j, k = np.int64(cells[m, 0]), np.int64(cells[m, 1]), np.int64(cells[m, 2])
        wet[i, j, k] = 1 if amid[m] else 0
        if not amid[m]:
            cells[kept, 0], cells[kept, 1], cells[kept, 2] = i, j, k
            kept += 1
    return kept


@inner
def _void_share(F, V, opened, steps, i, j, k, d, high, thick):
    """Void in the slab of a cell beside its lower or upper (high = 1) face along d, in shares of the slab."""
    if not is_mixed(F[i, j, k]):
        return 0.0
    m, alpha = plane_of_cell(F, V, opened, steps, i, j, k)
    if not is_plane(m):
        return 1.0 - F[i, j, k]
    low = 1.0 - thick if high == 1 else 0.0
    return 1.0 - share_of_slab(m, alpha, d, low, low + thick)


@inner
def _through(A, u, b, q, S, width, F, V, opened, steps, d, i, j, k):
    """Through the faces along d that liquid touches: flow in as predicted, flow in [length3/time]; void beyond."""
    di, dj, dk = np.int64(d == 0), np.int64(d == 1), np.int64(d == 2)
    before, after, void = 0.0, 0.0, 0.0
    for high in range(2):
        e, f, g = i - di * (1 - high), j - dj * (1 - high), k - dk * (1 - high)
        if b[e, f, g] == 0.0:
            continue
        area, inward = S, -1.0 if high == 1 else 1.0
        if A is not None:
            area *= A[e, f, g]
        before += inward * area * u[e, f, g]
        flow = inward * (area * u[e, f, g] - (q[e + di, f + dj, g + dk] - q[e, f, g]) * b[e, f, g])
        after += flow
        if flow > 0.0:
            s = np.int64(1 if high == 1 else -1)
            near = 0.5 * area * width[i * di + j * dj + k * dk + s]
            void += near * _void_share(F, V, opened, steps, i + s * di, j + s * dj, k + s * dk, d, 1 - high, 0.5)
    return before, after, void


@kernel
def _flows(cells, F, V, opened, steps, grid, u, v, w, bx, by, bz, q, dt, V0, grown, flows):
    """flows (n, 3): flow in as predicted, flow in beyond what the cell grows by, bound R."""
    for n in range(len(cells)):
        i, j, k = np.int64(cells[n, 0]), np.int64(cells[n, 1]), np.int64(cells[n, 2])
        dx, dy, dz = grid.dx[i], grid.dy[j], grid.dz[k]
        volume, room = dx * dy * dz * V[i, j, k], 0.0
        own, closing = max(1.0 - F[i, j, k], 0.0) * dx * dy * dz * V0[n], dt * min(grown[n], 0.0)
        x, y, z = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        if u is not None:
            x = _through(opened.Ax, u, bx, q, dy * dz, grid.dx, F, V, opened, steps, 0, i, j, k)
        if v is not None:
            y = _through(opened.Ay, v, by, q, dx * dz, grid.dy, F, V, opened, steps, 1, i, j, k)
        if w is not None:
            z = _through(opened.Az, w, bz, q, dx * dy, grid.dz, F, V, opened, steps, 2, i, j, k)
        flows[n, 0] = x[0] + y[0] + z[0]
        flows[n, 1] = x[1] + y[1] + z[1] - grown[n]
        room += x[2] + y[2] + z[2]
        if own + closing > 0.0:
            room += own + closing
            flows[n, 2] = (min(room, max(SHARE * room, THIN * volume)) - closing) / dt
        else:
            flows[n, 2] = (own + room) / dt


def pocket_flows(
    cells: np.ndarray, F: np.ndarray, openings: Open, steps: Steps, grid: Grid, velocity: list, b: tuple,
    q: np.ndarray, dt: float, V0: np.ndarray, grown: np.ndarray,
) -> np.ndarray:  # fmt: skip
    """(n, 3) of pockets, cells (n, 3): flow in before and after the pressure, through faces with b > 0, this one beyond
    what the cells grow by, and its bound R.

    velocity [u, v, w] before the pressure q acts; V0 (n,) that F is a share of, grown (n,). Flows [length3/time].
    """
    flows = np.zeros((len(cells), 3))
    if len(cells):
        _flows(cells, F, openings.V, openings, steps, grid, *velocity, *b, q, dt, V0, grown, flows)
    return flows
