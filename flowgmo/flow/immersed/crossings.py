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

from flowgmo.flow.favor.shares import Shares, wall_areas
from flowgmo.flow.fields import Grid, Open
from flowgmo.flow.immersed.body_fluxes import cross
from flowgmo.kernel import kernel

AMISS = 0.03  # of what a wall sweeps in a cell: less is what the mean of three leaves of walls that pass gradually
JUMP = 0.01  # of a face: those whose openings hardly change in the step are not passed by a wall
ALONG = 0.1  # of a wall's way: faces that it goes along are not passed
SLOW = 1e-9  # of a cell: walls that move less within a step stand still


def mend_crossings(
    opened: Open, now: Open, shares: Sequence[Shares], grown: tuple[np.ndarray, np.ndarray], grid: Grid,
    centres: Sequence[np.ndarray], places: np.ndarray, velocities: np.ndarray, middles: Sequence[np.ndarray | None],
    dt: float,
) -> list[Shares]:  # fmt: skip
    """The bodies' shares of faces, and the openings in `opened`, with r = 0 where walls pass faces at once.

    opened: means of the step, whose areas are changed where shares are; now: at its start;
    grown: numbers (n,) of cells, ascending, and V1 - V0 of each (n,) [length3]; B at places (b, 3), velocities (b, 6);
    centres of cells, middles of bodies: as in body_fluxes.
    """
    numbers, volume = grown[0], grown[1].copy()
    speeds = []
    for one, place, U, middle in zip(shares, places, velocities, middles, strict=True):
        r = np.column_stack([x[one.cells[:, e]] for e, x in enumerate(centres)]) - place
        speeds.append(wall_speeds(r, U, middle))
        own = np.ravel_multi_index(tuple(one.cells.T.astype(np.int64)), opened.V.shape)
        volume[np.searchsorted(numbers, own)] -= dt * (wall_areas(one, grid) * speeds[-1]).sum(axis=1)
    out = list(shares)
    for b, one in enumerate(shares):
        own = np.ravel_multi_index(tuple(one.cells.T.astype(np.int64)), opened.V.shape)
        found = np.searchsorted(numbers, own)
        r, faces = volume[found], one.faces.copy()
        for d, A in enumerate(opened[1:]):
            _mend(d, A, now[1 + d], own, faces, r, grid, dt * speeds[b])
        volume[found] = r
        if not np.array_equal(faces, one.faces):
            out[b] = one._replace(faces=faces)
    return out


def wall_speeds(r: np.ndarray, U: np.ndarray, middle: np.ndarray | None) -> np.ndarray:
    """(n, 3) [length/time] with which a body's wall goes at r (n, 3) from B, without turns that move nothing: of balls,
    and of bodies of revolution about their axis. U (6,), middle as in body_fluxes."""
    v, w = U[:3], U[3:]
    if middle is None:
        return v + cross(w, r)
    if middle.ndim == 1:
        return np.broadcast_to(v + cross(w, middle), r.shape)
    point, axis = middle
    return v + cross(w, r) - (w @ axis) * cross(axis, r - point)


@kernel
def _find_passed(d, own, step, r, way, A, before, dx, dy, dz, ny, nz, low, high, much, swept):
    """Fill low, high (n,) with positions, in own (n,), of the cells below and above the faces along d that a wall has
    passed at once, much and swept (n,) [length3] with what they are to take over and what the wall sweeps there;
    returns how many. r (n,), way (n, 3) as of _mend; A, before: flat, of the faces along d."""
    count = np.int64(0)
    m = np.int64(0)
    for n in range(len(own)):
        while m < len(own) and own[m] < own[n] + step:
            m += 1
        if m == len(own):
            break
        if own[m] != own[n] + step or not r[n] * r[m] < 0.0 or not abs(A[own[n]] - before[own[n]]) > JUMP:
            continue
        i, j, k = own[n] // (ny * nz), own[n] // nz % ny, own[n] % nz
        volume = dx[i] * dy[j] * dz[k]
        area = volume / (dx[i] if d == 0 else (dy[j] if d == 1 else dz[k]))
        far = 0.0
        for e in range(3):
            far = max(far, abs(0.5 * (way[n, e] + way[m, e])))
        along = 0.5 * (way[n, d] + way[m, d])
        shared = min(abs(r[n]), abs(r[m]))
        if abs(along) > ALONG * far and far * area > SLOW * volume and shared > AMISS * abs(area * along):
            low[count] = n
            high[count] = m
            much[count] = shared if r[n] > 0.0 else -shared
            swept[count] = area * along
            count += 1
    return count


def _mend(
    d: int, A: np.ndarray, before: np.ndarray, own: np.ndarray, faces: np.ndarray, r: np.ndarray, grid: Grid,
    way: np.ndarray,
) -> None:  # fmt: skip
    """Along d, of one body: faces (n, 6), r (n,) [length3] of its cells own (n,), ascending, and the areas A are
    changed. before: areas at the start; way (n, 3) [length] of the wall in the step."""
    flat, was = A.reshape(-1), before.reshape(-1)
    rows, values = np.empty((2, len(own)), np.int64), np.empty((2, len(own)))
    step = A.strides[d] // A.itemsize
    count = _find_passed(d, own, step, r, way, flat, was, *grid[:3], *A.shape[1:], *rows, *values)
    if not count:
        return
    (low, high), (much, swept) = rows[:, :count], values[:, :count]
    at, was = own[low], was[own[low]]
    change = much / swept
    opens = flat[at] > was  # the mean lies between what was open and what is open to the full, or closed
    change = np.where(opens, np.clip(change, -faces[low, 2 * d + 1], flat[at] - was), change)
    change = np.where(opens, change, np.clip(change, flat[at] - was, flat[at]))
    faces[low, 2 * d + 1] += change
    faces[high, 2 * d] += change
    flat[at] -= change
    r[low] -= change * swept
    r[high] += change * swept
