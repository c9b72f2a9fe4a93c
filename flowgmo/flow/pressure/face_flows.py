"""What passes the faces of the pressure equation's cells: net inflow before it is solved, and the push of its solution.

right = - sum over faces (outward A S u) + PUSH (F - 1) V / ease        of cells that hold more than their volume
u    -= (q_upper - q_lower) b / (A S)
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.ahead import ask_ahead
from flowgmo.flow.columns import ONE
from flowgmo.flow.pressure.pressure_matrix import open_volume
from flowgmo.flow.pressure.thin_cells import ease_of_face
from flowgmo.flow.solid_lines import ask_at_solids
from flowgmo.kernel import flow_kernel, inlined

PUSH = 0.5  # share of an overfull cell's excess that leaves in one step: all of it at once would swing back


@inlined
def _inflow_of_column(grid, V, Ax, Ay, Az, u, v, w, F, p, beta, dt, ease, right, i, j, k0, k1):
    """One column of `net_inflow`, V and A None where they are 1."""
    for k in range(k0, k1):
        total = 0.0
        if u is not None:
            S = grid.dy[j] * grid.dz[k]
            if Ax is not None:
                total += S * (Ax[i - 1, j, k] * u[i - 1, j, k] - Ax[i, j, k] * u[i, j, k])
            else:
                total += S * (u[i - 1, j, k] - u[i, j, k])
        if v is not None:
            S = grid.dx[i] * grid.dz[k]
            if Ay is not None:
                total += S * (Ay[i, j - 1, k] * v[i, j - 1, k] - Ay[i, j, k] * v[i, j, k])
            else:
                total += S * (v[i, j - 1, k] - v[i, j, k])
        if w is not None:
            S = grid.dx[i] * grid.dy[j]
            if Az is not None:
                total += S * (Az[i, j, k - ONE] * w[i, j, k - ONE] - Az[i, j, k] * w[i, j, k])
            else:
                total += S * (w[i, j, k - ONE] - w[i, j, k])
        most = 1.0
        if beta is not None:
            most += beta * max(p[i, j, k], 0.0)
            total += beta * p[i, j, k] * open_volume(grid, V, i, j, k) / dt
        if F is not None:  # without a branch: the loop vectorises
            total += PUSH * max(F[i, j, k] - most, 0.0) * open_volume(grid, V, i, j, k) / ease
        right[i, j, k] = total


@flow_kernel
def net_inflow(columns, first, last, grid, V, Ax, Ay, Az, lines, u, v, w, F, p, beta, dt, ease, right):
    """right = - sum over faces (outward A S u) + source [length3/time] in the columns' cells.

    beta [time2 length/mass]: the liquid gives way by this, None without; p: the last pressure. ease [time] >= dt: in it
    PUSH of what a cell holds too much leaves. lines: solid_lines.py.
    """
    for c in range(first, last):
        ask_ahead(columns, c, last, u, 0, 0)
        ask_ahead(columns, c, last, v, 0, 0)
        ask_ahead(columns, c, last, w, 0, 0)
        ask_at_solids(columns, c, last, Ax, lines)
        ask_at_solids(columns, c, last, Ay, lines)
        ask_at_solids(columns, c, last, Az, lines)
        ask_at_solids(columns, c, last, V, lines)
        ask_ahead(columns, c, last, F, 0, 0)
        ask_ahead(columns, c, last, right, 0, 0)
        i, j, k0, k1 = columns[c, 0], columns[c, 1], np.uint64(columns[c, 2]), np.uint64(columns[c, 3])
        if V is not None:
            if lines[i, j] != 0:
                _inflow_of_column(grid, V, Ax, Ay, Az, u, v, w, F, p, beta, dt, ease, right, i, j, k0, k1)
                continue
        _inflow_of_column(grid, None, None, None, None, u, v, w, F, p, beta, dt, ease, right, i, j, k0, k1)


@inlined
def _push_column(b, S, area_z, A, q, step, u, i, j, k0, k1):
    """One column of `push`."""
    m, n, o = step
    for k in range(k0, k1):
        area = S * area_z[k]
        if A is not None:
            area *= A[i, j, k]
        gained = (q[i, j, k] - q[i + m, j + n, k + o]) * b[i, j, k] / area
        u[i, j, k] += gained if b[i, j, k] > 0.0 else 0.0


@flow_kernel
def push(columns, first, last, b, area_x, area_y, area_z, A, lines, q, step, u):
    """u -= (q_upper - q_lower) b / (A S) on the upper faces with b > 0. area_x * area_y * area_z = S (1 for `step`).
    lines: solid_lines.py."""
    m, n, _ = step
    for c in range(first, last):
        ask_ahead(columns, c, last, b, 0, 0)
        ask_at_solids(columns, c, last, A, lines)
        ask_ahead(columns, c, last, q, m, n)
        ask_ahead(columns, c, last, u, 0, 0)
        i, j, k0, k1 = columns[c, 0], columns[c, 1], np.uint64(columns[c, 2]), np.uint64(columns[c, 3])
        S = area_x[i] * area_y[j]
        if A is not None:
            if lines[i, j] != 0:
                _push_column(b, S, area_z, A, q, step, u, i, j, k0, k1)
                continue
        _push_column(b, S, area_z, None, q, step, u, i, j, k0, k1)


@flow_kernel
def difference(rows, first, last, b, area_x, area_y, area_z, eased, A, wet, q, step, out):
    """out (n,) = (q_upper - q_lower) b / (A S) on faces rows (n, 4), 0 where b is; thin cells like others.

    eased: None or what thin_cells.ease_of_face asks for.
    """
    m, n, o = step
    for r in range(first, last):
        i = rows[r, 0]
        j = rows[r, 1]
        k = np.uint64(rows[r, 2])
        out[r] = 0.0
        if b[i, j, k] > 0.0:
            area = area_x[i] * area_y[j] * area_z[k]
            if A is not None:
                area *= A[i, j, k]
            if eased is not None:
                if wet[i, j, k] != 0 and wet[i + m, j + n, k + o] != 0:
                    area *= ease_of_face(*eased, n + 2 * np.int64(o), np.int64(i), np.int64(j), np.int64(k))
            out[r] = (q[i + m, j + n, k + o] - q[i, j, k]) * b[i, j, k] / area
