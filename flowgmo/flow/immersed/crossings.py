"""Faces that a flat wall crosses within a step: their mean openings from the volumes that it sweeps.

The open part A of a face during a step is the mean over three poses (favor/moving_openings.py). That is enough where
walls pass gradually. A wall that runs along a face passes it at once: from 0 to 1 at some time between two poses, and
the mean of three says 1/6 or 5/6 for it, whatever that time was. The liquid that follows the wall would have to go
through there with up to six times the wall's speed, and the energy of that is made of nothing (a plug in a channel: an
eighth of its largest kinetic energy in one step).

The volumes know the time. With velocity U of the wall, S of the body's share of faces, the open volume of a cell grows
by V1 - V0, and this is what the wall sweeps in it,

    V1 - V0 = dt (sum over faces: outward S U . n area)              what is missing: r [of a cell]

if S is the mean over the step. At a face that was passed at once r of the two cells are opposite, and

    S += r (lower cell's volume) / (dt U . n area)                   A -= the same

makes both vanish: liquid that moves with the wall passes as it is. Steps of cells of a uniform mesh: the mean of a jump
that is passed after the share t of the step becomes t or 1 - t, exactly.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flowgmo.flow.favor.shares import Shares
from flowgmo.flow.fields import Grid, Open

AMISS = 0.01  # of a cell: less is what the mean of three leaves of walls that pass gradually (balls: up to 5e-3)


def mend_crossings(
    opened: Open, shares: Sequence[Shares], missing: tuple[np.ndarray, np.ndarray], grid: Grid,
    centres: Sequence[np.ndarray], places: np.ndarray, velocities: np.ndarray, dt: float,
) -> list[Shares]:  # fmt: skip
    """The bodies' shares of faces, and the openings in `opened`, with r = 0 where walls pass faces at once.

    missing: numbers (n,) of cells, ascending, and r of each (n,) [length3], changed; B at places (b, 3), velocities
    (b, 6). opened's areas are changed where shares are.
    """
    numbers, volume = missing
    out = list(shares)
    for b, (one, place, U) in enumerate(zip(shares, places, velocities, strict=True)):
        own = np.ravel_multi_index(tuple(one.cells.T.astype(np.int64)), opened.V.shape)
        found = np.searchsorted(numbers, own)
        r, faces = volume[found], one.faces.copy()
        for d, A in enumerate(opened[1:]):
            _mend(d, A, one.cells, own, faces, r, grid, centres, place, U, dt)
        volume[found] = r
        if not np.array_equal(faces, one.faces):
            out[b] = one._replace(faces=faces)
    return out


def _mend(
    d: int, A: np.ndarray, cells: np.ndarray, own: np.ndarray, faces: np.ndarray, r: np.ndarray, grid: Grid,
    centres: Sequence[np.ndarray], place: np.ndarray, U: np.ndarray, dt: float,
) -> None:  # fmt: skip
    """Along d, of one body: faces (n, 6), r (n,) [length3] of its cells and the areas A are changed."""
    if not len(own):
        return
    step = A.strides[d] // A.itemsize
    upper = np.searchsorted(own, own + step).clip(0, len(own) - 1)
    volumes = np.prod([w[cells[:, e]] for e, w in enumerate(grid[:3])], axis=0)
    low = np.flatnonzero((own[upper] == own + step) & (np.abs(r) > AMISS * volumes) & (r * r[upper] < 0.0))
    if not len(low):
        return
    high, (e, f) = upper[low], ((d + 1) % 3, (d + 2) % 3)
    arm = np.column_stack([x[cells[low, k]] for k, x in enumerate(centres)]) - place
    swept = dt * (U[d] + U[3 + e] * arm[:, f] - U[3 + f] * arm[:, e]) * volumes[low] / grid[d][cells[low, d]]
    much = np.sign(r[low]) * np.minimum(np.abs(r[low]), np.abs(r[high]))
    flat, at = A.reshape(-1), own[low]
    change = np.divide(much, swept, out=np.zeros_like(much), where=np.abs(swept) > AMISS * volumes[low])
    change = np.clip(change, -faces[low, 2 * d + 1], flat[at])
    faces[low, 2 * d + 1] += change
    faces[high, 2 * d] += change
    flat[at] -= change
    r[low] -= change * swept
    r[high] += change * swept
