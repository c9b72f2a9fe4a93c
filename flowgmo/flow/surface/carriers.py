"""What carries the liquid across faces in one direction: velocity, open fraction, cell widths; and the upwind flux."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flowgmo.flow.fields import G
from flowgmo.kernel import inner

U, ONE = np.uint64, np.uint64(1)  # unsigned k: numba leaves out its test for negative indices, and loops vectorise


class Way(NamedTuple):
    """Direction d = 0, 1, 2. 1 / width of a cell is across[i] (x), across[j] (y) or 1 (z), times along[k]."""

    d: int
    across: np.ndarray
    along: np.ndarray


class Carrier(NamedTuple):
    """Velocity q [length/time] and open fraction A [-] (None: 1) of the faces in direction `way`."""

    q: np.ndarray
    A: np.ndarray | None
    way: Way


@inner
def ahead(d):
    """(di, dj, dk): the step to the next cell in direction d, dk unsigned."""
    return (1 if d == 0 else 0), (1 if d == 1 else 0), (ONE if d == 2 else ONE - ONE)


@inner
def across_column(d, across, i, j):
    """The part of 1 / width that is the same for a column."""
    return across[i] if d == 0 else (across[j] if d == 1 else 1.0)


@inner
def columns_of_faces(d, i, j):
    """How many columns of faces the column of cells owns: its upper ones, and the lower side of the domain."""
    return 2 if (d == 0 and i == G) or (d == 1 and j == G) else 1


@inner
def travel(q, A, dt, i, j, k):
    """A u dt [length] through the upper face."""
    if A is not None:
        return dt * q[i, j, k] * A[i, j, k]
    return dt * q[i, j, k]


@inner
def upwind(d, q, A, dt, F, i, j, k0, k1, flux):
    """flux of a column of faces as if every cell were evenly filled."""
    di, dj, dk = ahead(d)
    for k in range(U(k0), U(k1)):
        moved = travel(q, A, dt, i, j, k)
        share = F[i, j, k] if moved > 0.0 else F[i + di, j + dj, k + dk]
        flux[i, j, k] = moved * min(max(share, 0.0), 1.0)


@inner
def upwind_cell(q, d, i, j, k):
    """The cell that the flow through the upper face of (i, j, k) comes from."""
    if q > 0.0:
        return i, j, k
    return i + (1 if d == 0 else 0), j + (1 if d == 1 else 0), k + (1 if d == 2 else 0)


@inner
def next_along(d, i, j, k, by):
    """The cell `by` cells further along d."""
    return i + (by if d == 0 else 0), j + (by if d == 1 else 0), k + (by if d == 2 else 0)


@inner
def width_of(way, i, j, k):
    """1 / width of a cell along way.d [1/length]."""
    return way.along[k] * across_column(way.d, way.across, i, j)
