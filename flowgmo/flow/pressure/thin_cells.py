"""Faces through which a thin cell opens: less inertia than the distance of the two centres says.

    (u_new - u) phi = - dt (dp / (rho h) - g) + ...        phi = 1 - flat (1 - min(1, 2 V / A)),  of the smaller cell

A cell of which a solid leaves a tenth open (V = .1, behind a wall that runs along the face) cannot take in or give out
more than its own small faces let through: the wall says what crosses its large face (A = 1), not the inertia of the
liquid there. With all of it (phi = 1) the pressure of the thin cell would have to stop the flow of a whole cell, and
would suck the liquid through its small faces: beside the front edge of a box in a flow of 4 m/s at -17 kPa and 9 m/s,
which shortens everybody's step. With phi the thin cell has (nearly) its neighbour's pressure, as if the two were one
cell, and for V -> 0 the wall on the mesh plane is met continuously: there no pressure is needed. Pressure and gravity
act alike, so that liquid at rest stays at rest.

Along a wall that is oblique to the mesh liquid crosses such a face for good, and phi would be too little inertia for
the force that drives it. In the tip of a wedge, open by A_x and A_z with V = A_x A_z / 2, it slides: A_x u = A_z w, so
that w = T u with the slope T = A_x / A_z. Where gravity and the pressure around would give u_e along the wall to liquid
with all its inertia, the pressure of the tip itself settles so that (cells as wide as high)

    u = u_e (1 + T) / (phi_x + T phi_z)            u_e with phi = 1; u_e (1 + T) / (A_z (1 + T2)) with phi = 2 V / A

A film on a slope of 14 degrees so began with 20 times what gravity gives it along the slope (tests/physics/
test_oblique_walls.py). So phi is kept where the wall is nearly parallel to the face, and given up as it gets steep:

    flat = max(0, 1 - T / STEEP)            u <= u_e (1 + T flat) <= u_e (1 + STEEP / 4)

T is |s_e| / |s_d| of the plane that leaves the cell's faces open (cut_level.solid_plane), and counts c2 times in cells
that are c times as wide along the face's direction as along the wall. A layer that ends at a closed face of the mesh,
or at the edge of a box along the mesh, has such a plane too and does not rise: where the corner of a box explains the
cell (places_of_liquid.py), T is 0.

Viscous forces are not raised by 1 / phi: where they rule, phi is 1 (liquid.inertia_rules), and slivers are as
cut_viscosity.py has them. For V >= A / 2 nothing changes: smooth walls through the middle of cells keep their order.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from flowgmo.flow.fields import G, Grid, Open
from flowgmo.flow.observe.places_of_liquid import box_misses
from flowgmo.flow.surface.cut_level import EXACT, solid_plane
from flowgmo.kernel import flow_kernel, inner, kernel

LEAST = 0.02  # phi: thinner cells are as good as joined, and more would only spoil the matrix
STEEP = 0.25  # rise of a wall to its run, in cells, from which phi is 1; with more liquid slides too fast, see above


class ThinFaces(NamedTuple):
    """Upper faces along one direction: columns (n, 4) of one cell each, and ease (n,) = 1 / phi.

    acts (n,): ease where both cells are liquid now, 1 at the free surface, where nothing holds a thin cell back.
    """

    columns: np.ndarray
    ease: np.ndarray
    acts: np.ndarray


def find_thin_faces(opened: Open, grid: Grid) -> tuple[ThinFaces | None, ...]:
    """Those along x, y, z that open a thin cell, None where there are none; not those on the sides of the domain."""
    if opened.V is None:
        return None, None, None
    return tuple(_along(opened, grid, d) for d in range(3))


def _along(opened: Open, grid: Grid, d: int) -> ThinFaces | None:
    V, A = opened.V, opened[1 + d]
    if A is None or V.shape[d] <= 1 + 2 * G:
        return None
    real = [slice(G, -G)] * 3
    lower, upper = real.copy(), real.copy()
    lower[d], upper[d] = slice(G, -G - 1), slice(G + 1, -G)
    least, area = np.minimum(V[tuple(lower)], V[tuple(upper)]), A[tuple(lower)]
    thin = (2.0 * least < area) & (least > 0.0)
    if not thin.any():
        return None
    cells = (np.argwhere(thin) + G).astype(np.int32)
    ease = np.ones(len(cells))
    _eases(cells, opened, grid, np.int64(d), ease)
    cells, ease = cells[ease > 1.0], ease[ease > 1.0]
    if not len(ease):
        return None
    return ThinFaces(np.column_stack([cells, cells[:, 2] + 1]).astype(np.int32), ease, np.ones(len(ease)))


@inner
def _flat(opened, grid, d, i, j, k):
    """How far the wall of a cell runs along its faces along d: 1, down to 0 where it is as steep as STEEP."""
    s, _ = solid_plane(opened, i, j, k)
    if box_misses(opened, s, i, j, k) <= EXACT:
        return 1.0
    x, y, z = (s[0], grid.dx[i]), (s[1], grid.dy[j]), (s[2], grid.dz[k])
    own, e, f = (x, y, z) if d == 0 else ((y, z, x) if d == 1 else (z, x, y))
    rise = math.hypot(e[0] * (own[1] / e[1]) ** 2, f[0] * (own[1] / f[1]) ** 2)
    return max(1.0 - rise / (STEEP * abs(own[0])), 0.0) if own[0] != 0.0 else 0.0


@inner
def _inertia(opened, grid, d, i, j, k, A):
    """phi A of a face along d with open area A by one of its cells."""
    least = max(2.0 * opened.V[i, j, k], LEAST * A)
    if least >= A:
        return A
    return least + (1.0 - _flat(opened, grid, d, i, j, k)) * (A - least)


@inner
def ease_of_face(opened, grid, d, i, j, k):
    """1 / phi of the upper face along d of cell (i, j, k)."""
    A = opened.Ax[i, j, k] if d == 0 else (opened.Ay[i, j, k] if d == 1 else opened.Az[i, j, k])
    e, f, g = i + np.int64(d == 0), j + np.int64(d == 1), k + np.int64(d == 2)
    if not min(opened.V[i, j, k], opened.V[e, f, g]) > 0.0:
        return 1.0
    return A / min(_inertia(opened, grid, d, i, j, k, A), _inertia(opened, grid, d, e, f, g, A))


@kernel
def _eases(cells, opened, grid, d, ease):
    """ease (n,) of the upper faces along d of cells (n, 3)."""
    for n in range(len(cells)):
        ease[n] = ease_of_face(opened, grid, d, np.int64(cells[n, 0]), np.int64(cells[n, 1]), np.int64(cells[n, 2]))


@flow_kernel
def multiply(columns, first, last, ease, acts, wet, di, dj, dk, b):
    """b *= acts on the one face of each column along (di, dj, dk); acts = ease between two liquid cells, else 1."""
    for c in range(first, last):
        i, j, k = np.int64(columns[c, 0]), np.int64(columns[c, 1]), np.int64(columns[c, 2])
        acts[c] = ease[c] if wet[i, j, k] != 0 and wet[i + di, j + dj, k + dk] != 0 else 1.0
        b[i, j, k] *= acts[c]


@flow_kernel
def add_rest(columns, first, last, acts, g, b, u):
    """u += (acts - 1) g where the pressure acts (b > 0): it holds what gravity pulls."""
    for c in range(first, last):
        i, j, k = columns[c, 0], columns[c, 1], columns[c, 2]
        if b[i, j, k] > 0.0:
            u[i, j, k] += (acts[c] - 1.0) * g
