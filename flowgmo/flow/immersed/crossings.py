"""Faces that a flat wall crosses within a step: their mean openings from the volumes that it sweeps.

The open part A of a face during a step is the mean over three poses (favor/moving_openings.py). That is enough where
walls pass gradually. A wall that runs along a face passes it at once: from 0 to 1 at some time between two poses, and
the mean of three says 1/6 or 5/6 for it, whatever that time was. The liquid that follows the wall would have to go
through there with up to six times the wall's speed, and the energy of that is made of nothing (a plug in a channel: an
eighth of its largest kinetic energy in one step).

The volumes know the time. With velocity U of the wall, S of the body's share of faces, what the body leaves of a
cell, C0 - C1 of its volume, is what the wall sweeps in it,

    C0 - C1 = dt (sum over faces: outward S U . n area)              what is missing: r [of a cell]

if S is the mean over the step. At a face that was passed at once r of the two cells are opposite, and

    S += r (lower cell's volume) / (dt U . n area)                   A -= the same

makes both vanish: liquid that moves with the wall passes as it is. Steps of cells of a uniform mesh: the mean of a jump
that is passed after the share t of the step becomes t or 1 - t, exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from flowgmo.flow.favor.shares import Shares, wall_areas
from flowgmo.flow.fields import Grid, Open
from flowgmo.flow.immersed.body_fluxes import cross
from flowgmo.kernel import kernel

AMISS = 0.03  # of what a wall sweeps in a cell: less is what the mean of three leaves of walls that pass gradually
JUMP = 0.01  # of a face: those whose openings hardly change in the step are not passed by a wall
ALONG = 0.1  # of a wall's way: faces that it goes along are not passed
SLOW = 1e-9  # of a cell: walls that move less within a step stand still


class _Wall(NamedTuple):
    """Of one body: own (n,) flat indices of its cells, ascending; faces (n, 6) its shares; missing (n,) [length3]: r;
    way (n, 3) [length] of the wall in the step."""

    own: np.ndarray
    faces: np.ndarray
    missing: np.ndarray
    way: np.ndarray


def mend_crossings(
    opened: Open, now: Open, shares: Sequence[Shares], left: Sequence[np.ndarray], grid: Grid,
    centres: Sequence[np.ndarray], places: np.ndarray, velocities: np.ndarray, middles: Sequence[np.ndarray | None],
    dt: float,
) -> list[Shares]:  # fmt: skip
    """The bodies' shares of faces, and the openings in `opened`, with r = 0 where walls pass faces at once.

    opened: means of the step, whose areas are changed where shares are; now: at its start;
    left: of each body C0 - C1 (m,) [-] in the cells of its shares; B at places (b, 3), velocities (b, 6); centres of
    cells, middles of bodies: as in body_fluxes. Each body is told by what it sweeps itself: their order says nothing.
    """
    bodies = []
    for one, C, place, U, middle in zip(shares, left, places, velocities, middles, strict=True):
        r = np.column_stack([x[one.cells[:, e]] for e, x in enumerate(centres)]) - place
        speeds = wall_speeds(r, U, middle)
        own = np.ravel_multi_index(tuple(one.cells.T.astype(np.int64)), opened.V.shape)
        volumes = np.prod([d[k] for d, k in zip(grid[:3], one.cells.T, strict=True)], axis=0)
        missing = C * volumes - dt * (wall_areas(one, grid) * speeds).sum(axis=1)
        bodies.append(_Wall(own, one.faces.copy(), missing, dt * speeds))
    for d, A in enumerate(opened[1:]):
        for wall, found in [(wall, _passed(d, A, now[1 + d], wall, grid)) for wall in bodies]:
            _mend(d, A, now[1 + d], wall, *found)
    changed = [not np.array_equal(wall.faces, one.faces) for wall, one in zip(bodies, shares, strict=True)]
    return [
        one._replace(faces=wall.faces) if yes else one for one, wall, yes in zip(shares, bodies, changed, strict=True)
    ]


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
    returns how many. r (n,), way (n, 3) as of _Wall; A, before: flat, of the faces along d."""
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


def _passed(d: int, A: np.ndarray, before: np.ndarray, wall: _Wall, grid: Grid) -> tuple[np.ndarray, np.ndarray]:
    """rows (2, k): cells of the wall below and above the faces along d that it has passed at once; values (2, k)
    [length3]: what these are to take over, and what it sweeps there. A, before: areas of the step and at its start."""
    flat, was = A.reshape(-1), before.reshape(-1)
    rows, values = np.empty((2, len(wall.own)), np.int64), np.empty((2, len(wall.own)))
    of = d, wall.own, A.strides[d] // A.itemsize, wall.missing, wall.way
    count = _find_passed(*of, flat, was, *grid[:3], *A.shape[1:], *rows, *values)
    return rows[:, :count], values[:, :count]


def _mend(d: int, A: np.ndarray, before: np.ndarray, wall: _Wall, rows: np.ndarray, values: np.ndarray) -> None:
    """Change the areas A along d, the faces and what is missing of a wall, rows and values: of _passed."""
    if not rows.shape[1]:
        return
    flat, faces, (low, high), (much, swept) = A.reshape(-1), wall.faces, rows, values
    at = wall.own[low]
    was, change = before.reshape(-1)[at], much / swept
    opens = flat[at] > was  # the mean lies between what was open and what is open to the full, or closed
    change = np.where(opens, np.clip(change, -faces[low, 2 * d + 1], flat[at] - was), change)
    change = np.where(opens, change, np.clip(change, flat[at] - was, flat[at]))
    faces[low, 2 * d + 1] += change
    faces[high, 2 * d] += change
    flat[at] -= change
    wall.missing[low] -= change * swept
    wall.missing[high] += change * swept
