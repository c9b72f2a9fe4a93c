"""Faces through which a thin cell opens: less inertia than the distance of the two centres says.

    (u_new - u) phi = - dt (dp / (rho h) - g) + ...        phi = min(1, 2 V / A),  V of the smaller of the two cells

A cell of which a solid leaves a tenth open (V = .1, behind a wall that runs along the face) cannot take in or give out
more than its own small faces let through: the wall says what crosses its large face (A = 1), not the inertia of the
liquid there. With all of it (phi = 1) the pressure of the thin cell would have to stop the flow of a whole cell, and
would suck the liquid through its small faces: beside the front edge of a box in a flow of 4 m/s at -17 kPa and 9 m/s,
which shortens everybody's step. With phi the thin cell has (nearly) its neighbour's pressure, as if the two were one
cell, and for V -> 0 the wall on the mesh plane is met continuously: there no pressure is needed. Pressure and gravity
act alike, so that liquid at rest stays at rest.

Viscous forces are not raised by 1 / phi: where they rule, phi is 1 (liquid.inertia_rules), and slivers are as
cut_viscosity.py has them. For V >= A / 2 nothing changes: smooth walls through the middle of cells keep their order.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flowgmo.flow.fields import G, Open
from flowgmo.kernel import flow_kernel, inner

LEAST = 0.02  # phi: thinner cells are as good as joined, and more would only spoil the matrix


class ThinFaces(NamedTuple):
    """Upper faces along one direction: columns (n, 4) of one cell each, and ease (n,) = 1 / phi.

    acts (n,): ease where both cells are liquid now, 1 at the free surface, where nothing holds a thin cell back.
    """

    columns: np.ndarray
    ease: np.ndarray
    acts: np.ndarray


def find_thin_faces(opened: Open) -> tuple[ThinFaces | None, ...]:
    """Those along x, y, z that open a thin cell, None where there are none; not those on the sides of the domain."""
    if opened.V is None:
        return None, None, None
    return tuple(_along(opened.V, A, d) for d, A in enumerate(opened[1:]))


def _along(V: np.ndarray, A: np.ndarray | None, d: int) -> ThinFaces | None:
    if A is None or V.shape[d] <= 1 + 2 * G:
        return None
    real = [slice(G, -G)] * 3
    lower, upper = real.copy(), real.copy()
    lower[d], upper[d] = slice(G, -G - 1), slice(G + 1, -G)
    least, area = np.minimum(V[tuple(lower)], V[tuple(upper)]), A[tuple(lower)]
    thin = (2.0 * least < area) & (least > 0.0)
    if not thin.any():
        return None
    ease = 1.0 / np.maximum(2.0 * least[thin] / area[thin], LEAST)
    at = np.argwhere(thin) + G
    return ThinFaces(np.column_stack([at, at[:, 2] + 1]).astype(np.int32), ease, np.ones(len(ease)))


@inner
def ease_between(V_low, V_high, A):
    """1 / phi of one face with open area A between two cells."""
    least = min(V_low, V_high)
    return max(A / max(2.0 * least, LEAST * A), 1.0) if least > 0.0 else 1.0


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
