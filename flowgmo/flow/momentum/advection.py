"""Advection of velocity, (u . grad) u on the staggered mesh: first order, or second order and monotone.

Along each direction d, for the velocity q on a face P of the mesh:

        q_l            q_r            q at the two ends of the stretch that P stands for, taken from upstream
    --o--|------P------|--o--         U_l, U_r: velocity along d at these ends, linear between the faces that store it
         U_l           U_r

    dq/dt = - [ U_r (q_r - q_P) / d_r + U_l (q_P - q_l) / d_l ] / 2          d_r, d_l: distances of P to the ends

Both differences are derivatives at P. An end where the flow leaves P brings nothing at first order (q_r = q_P), so that
a value changes only towards values upstream of it. At second order the ends are extrapolated from upstream and limited
(upstream.py): no new extremum arises while the directional Courant numbers sum to at most 1/2, the bound of the
liquid's advection too (DESIGN 4), in each stage of Heun's method.

The form is not conservative (DESIGN 4): where all of q is equal it stays so, whatever the walls. Faces near solids are
listed apart (cut_faces.py) and done by cut_advection.py.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flowgmo.flow.favor.cut_faces import ONE, STEPS, TWO, U64, CutFaces
from flowgmo.flow.fields import Grid, Open
from flowgmo.flow.momentum.cut_advection import advect_cut
from flowgmo.flow.momentum.upstream import UPWIND, Ends, Slopes, end_value, make_ends, make_slopes
from flowgmo.flow.team import Team
from flowgmo.kernel import flow_kernel, inlined, inner

Array = np.ndarray
NO = U64(0)
VECTOR = U64(8)  # cells that the widest vectors hold


@inlined
def _row(i, j, k0, k1, start, end, ci, cj, ck, q, out, u, v, w, gx, gy, gz, far, ends, slopes, plain, bit):
    """One column of advect. gx, gy, gz [-]: weight, for U along x, y, z, of the face one step along c.

    From start to end, of which k0 to k1 counts: whole vectors (`whole_vectors`).
    """
    x, y, z = ends
    sx, sy, sz = slopes
    for k in range(start, end):
        q0 = q[i, j, k]
        total = 0.0
        if far is not None:
            gx = far[k]
            gy = gx
        if u is not None:
            U = (1.0 - gx) * u[i, j, k] + gx * u[i + ci, j + cj, k + ck]
            end = end_value(U, q[i - ONE, j, k], q0, q[i + ONE, j, k], q[i + TWO, j, k], sx, i)
            total += U * (end - q0) * x.upper[i]
            U = (1.0 - gx) * u[i - ONE, j, k] + gx * u[i - ONE + ci, j + cj, k + ck]
            end = end_value(U, q[i - TWO, j, k], q[i - ONE, j, k], q0, q[i + ONE, j, k], sx, i - ONE)
            total += U * (q0 - end) * x.lower[i]
        if v is not None:
            U = (1.0 - gy) * v[i, j, k] + gy * v[i + ci, j + cj, k + ck]
            end = end_value(U, q[i, j - ONE, k], q0, q[i, j + ONE, k], q[i, j + TWO, k], sy, j)
            total += U * (end - q0) * y.upper[j]
            U = (1.0 - gy) * v[i, j - ONE, k] + gy * v[i + ci, j - ONE + cj, k + ck]
            end = end_value(U, q[i, j - TWO, k], q[i, j - ONE, k], q0, q[i, j + ONE, k], sy, j - ONE)
            total += U * (q0 - end) * y.lower[j]
        if w is not None:
            U = (1.0 - gz) * w[i, j, k] + gz * w[i + ci, j + cj, k + ck]
            end = end_value(U, q[i, j, k - ONE], q0, q[i, j, k + ONE], q[i, j, k + TWO], sz, k)
            total += U * (end - q0) * z.upper[k]
            U = (1.0 - gz) * w[i, j, k - ONE] + gz * w[i + ci, j + cj, k - ONE + ck]
            end = end_value(U, q[i, j, k - TWO], q[i, j, k - ONE], q0, q[i, j, k + ONE], sz, k - ONE)
            total += U * (q0 - end) * z.lower[k]
        if plain is not None:
            total = total if (plain[i, j, k] & bit) != 0 else 0.0
        out[i, j, k] -= total if k0 <= k and k < k1 else 0.0


@inner
def whole_vectors(k0, k1, nz):
    """(start, end) around k0 .. k1, a multiple of VECTOR long, within the cells that have two ghosts beyond them.

    What is left of a loop over vectors costs as much for each cell as for a vector; columns have some 20 cells. The
    same (k0, k1) where the mesh is too low.
    """
    length = (k1 - k0 + VECTOR - ONE) // VECTOR * VECTOR
    if length + TWO + TWO > nz:
        return k0, k1
    start = min(k0, nz - TWO - length)
    return start, start + length


@flow_kernel
def advect(columns, first, last, ci, cj, ck, q, out, u, v, w, far, far_k, ends, slopes, plain, bit):
    """out -= (u . grad) q on the columns' plain faces of the component with steps ci, cj, ck, whose velocity is q.

    far (n + 4,) along c: weight of the cell above in what is interpolated to a face of c; far_k the same where c is z,
    else None. ends, slopes: per direction (upstream.py). plain, bit: cut_faces.py.
    """
    for c in range(first, last):
        i = U64(columns[c, 0])
        j = U64(columns[c, 1])
        g = far[i * ci + j * cj]
        gx = 0.5 if ci > NO else g
        gy = 0.5 if cj > NO else g
        gz = 0.5 if ck > NO else g
        k0 = U64(columns[c, 2])
        k1 = U64(columns[c, 3])
        start, end = whole_vectors(k0, k1, U64(q.shape[2]))
        _row(i, j, k0, k1, start, end, ci, cj, ck, q, out, u, v, w, gx, gy, gz, far_k, ends, slopes, plain, bit)


class Scheme(NamedTuple):
    """What `advect` needs for one component: see there."""

    far: Array
    far_k: Array | None
    ends: tuple[Ends, Ends, Ends]
    slopes: tuple[Slopes | None, Slopes | None, Slopes | None]


def make_schemes(grid: Grid, order: int) -> tuple[Scheme, Scheme, Scheme]:
    """The factors of this mesh for u, v, w; order: UPWIND or MONOTONE (`IORDER`)."""
    widths, distances = grid[:3], grid[3:]
    schemes = []
    for c in range(3):
        far = 0.5 * widths[c] / distances[c]
        ends = tuple(make_ends(widths[d], own=d == c) for d in range(3))
        slopes = tuple(make_slopes(widths[d], distances[d], own=d == c) for d in range(3))
        if order == UPWIND:
            slopes = (None, None, None)
        schemes.append(Scheme(far, far if c == 2 else None, ends, slopes))
    return tuple(schemes)


def add_advection(
    team: Team,
    columns: Array,
    schemes: tuple[Scheme, Scheme, Scheme],
    open: Open,
    cut: CutFaces,
    velocity: tuple[Array | None, Array | None, Array | None],
    F: Array | None,
    acceleration: tuple[Array | None, Array | None, Array | None],
) -> None:
    """Add - (u . grad) u [length/time2] to the acceleration of the upper faces of the cells in columns (m, 4).

    velocity (u, v, w), acceleration likewise, of mesh size on faces, None where absent. Values up to two faces away are
    read: both ghost layers, and what is in air near the surface, must hold velocities. Closed faces keep their
    acceleration, and so do cut faces that no liquid touches. F [-] or None. schemes: make_schemes; cut: of columns that
    hold these.

    The faces on the domain's lower sides (index 1) are not in any column: their upwind stencil leaves the arrays.
    """
    u, v, w = velocity
    for c, (q, out, scheme) in enumerate(zip(velocity, acceleration, schemes, strict=True)):
        if q is None:
            continue
        far, far_k, ends, slopes = scheme
        team.run(advect, columns, *STEPS[c], q, out, u, v, w, far, far_k, ends, slopes, cut.plain, np.uint8(1 << c))
        rows = cut.rows[c]
        if rows is not None and len(rows):
            team.run_uneven(advect_cut, rows, *STEPS[c], q, open[1 + c], F, out, u, v, w, *open, far, ends, slopes)
