"""Velocities beside the liquid: where the projection says nothing, the stream is continued.

A face belongs to one of

    held         the projection found it (b > 0)
    closed       it is, or lies on a side of the domain (flow/boundary.py): nothing is taken from it
    continued    a neighbour (of the 26) is held: the mean of the held ones, weighted by 1 / distance2 in cells
    free         no neighbour is held, but liquid touches the face: it flies with the predicted velocity, but not into a
                 closed face on the other side of its cell: a film lies on the floor, and does not fall
    beyond       neighbours are continued or free: their mean
    none         0

Liquid above the centre of its cell so moves with what lies below it; drops that fill less than half a cell fall freely.

Which faces a mean is taken from is found once a step (`find_sources`), as bits of one number for each face, and used
for both velocities that are continued in it. Bit 9 (o + 1) + 3 (m + 1) + n + 1 is the neighbour (m, n, o) away.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flowgmo.flow.columns import ONE
from flowgmo.flow.fields import G
from flowgmo.flow.pressure.pressure_matrix import clear
from flowgmo.kernel import flow_kernel, inner

NONE, HELD, CONTINUED, FREE, BEYOND, CLOSED = 0, 1, 2, 3, 4, 5

#: Bits of `sources` above those of the neighbours: taken after all others; no neighbour, the value is 0; a film below
#: the face, above it
LATE, ZERO, FILM_BELOW, FILM_ABOVE = np.int32(1 << 27), np.int32(1 << 28), np.int32(1 << 29), np.int32(1 << 30)


class Beside(NamedTuple):
    """What is known of faces, arrays of mesh size: mark int8, its kind; nine int16, scratch; sources int32 for u, v, w,
    None in absent directions: where the value comes from, 0 where it stays."""

    mark: np.ndarray
    nine: np.ndarray
    sources: tuple


def make_beside(shape: tuple, present: tuple) -> Beside:
    """For a mesh of this shape; present (3,): directions that have a velocity."""
    sources = tuple(np.zeros(shape, np.int32) if there else None for there in present)
    return Beside(np.zeros(shape, np.int8), np.zeros(shape, np.int16), sources)


@flow_kernel
def mark_faces(columns, first, last, b, A, F, step, side, least, mark):
    """Sort the upper faces (along `step`, a unit vector, its z unsigned) of the columns' cells into the kinds above.

    side: index of the faces on the domain's upper side, -1 where periodic: they are CLOSED, since those on the lower
    side lie in no column, and a mirrored scene must give the mirrored flow.
    F > least is liquid. Only HELD, CLOSED, FREE (all that liquid touches, for now), NONE.
    """
    p, q, r = step
    for c in range(first, last):
        i = np.int64(columns[c, 0])
        j = np.int64(columns[c, 1])
        k1 = np.int64(columns[c, 3])
        for k in range(np.uint64(columns[c, 2]), np.uint64(k1)):
            kind = FREE if max(F[i, j, k], F[i + p, j + q, k + r]) > least else NONE
            if A is not None:
                kind = CLOSED if A[i, j, k] == 0.0 else kind
            mark[i, j, k] = HELD if b[i, j, k] > 0.0 else kind
        if r != 0:
            if k1 - 1 == side:
                mark[i, j, side] = CLOSED
        elif i * p + j * q == side:
            for k in range(np.int64(columns[c, 2]), k1):
                mark[i, j, k] = CLOSED


@flow_kernel
def find_neighbours(columns, first, last, source, mark, nine, sources):
    """sources of faces without a held value: their neighbours of kind `source` or lower (not NONE); mark them.

    source HELD: the result is CONTINUED; source FREE: from all that have a value, and it is BEYOND. The new kind is
    above `source`, so that no face looks at one that was set in the same pass.
    """
    new, when = (CONTINUED, np.int32(0)) if source == HELD else (BEYOND, LATE)
    for c in range(first, last):
        i, j = columns[c, 0], columns[c, 1]
        bottom, top = np.uint64(columns[c, 2] - 1), np.uint64(columns[c, 3] + 1)
        for k in range(bottom, top):
            nine[i, j, k] = 0
        for m in range(3):
            for n in range(3):
                bit = np.int16(1 << (3 * m + n))
                for k in range(bottom, top):
                    there = mark[i + m - 1, j + n - 1, k]
                    nine[i, j, k] |= bit if (there > NONE) & (there <= source) else np.int16(0)
        for k in range(columns[c, 2], columns[c, 3]):
            kind = mark[i, j, k]
            if source == HELD:
                sources[i, j, k] = ZERO if kind == NONE else 0
            if kind == HELD or kind == CLOSED or (source != HELD and kind != NONE):
                continue
            found = np.int32(nine[i, j, k - 1]) | np.int32(nine[i, j, k]) << 9 | np.int32(nine[i, j, k + 1]) << 18
            if found != 0:
                sources[i, j, k] = found | when
                mark[i, j, k] = new


@flow_kernel
def find_films(columns, first, last, F, step, periodic, least, mark, sources):
    """Free faces between air and a film that lies on a closed face on the other side of its cell."""
    p, q, r = step
    n = mark.shape[0] * p + mark.shape[1] * q + mark.shape[2] * r
    for c in range(first, last):
        i = np.int64(columns[c, 0])
        j = np.int64(columns[c, 1])
        for k in range(np.int64(columns[c, 2]), np.int64(columns[c, 3])):
            if mark[i, j, k] != FREE:
                continue
            low = F[i, j, k] > least
            if low == (F[i + p, j + q, k + r] > least):
                continue  # liquid on both sides
            s = np.int64(-1 if low else 1)
            e, f, g = i + s * p, j + s * q, k + s * r  # the other face of the film's cell
            at = e * p + f * q + g * r
            if mark[e, f, g] == CLOSED or (not periodic and (at == G - 1 or at == n - G - 1)):
                sources[i, j, k] = FILM_BELOW if low else FILM_ABOVE


@inner
def _mean(found, value, i, j, k):
    """Of the neighbours whose bits are set, weighted by 1 / distance2 in cells."""
    total = 0.0
    weight = 0.0
    a, b, c = np.uint64(i - 1), np.uint64(j - 1), np.uint64(k - 1)  # unsigned: see columns.ONE
    for o in range(np.uint64(3)):
        layer = (found >> np.int32(9 * o)) & 511
        if layer == 0:
            continue
        for m in range(np.uint64(3)):
            line = (layer >> np.int32(3 * m)) & 7
            if line == 0:  # most are: neighbours lie on one side
                continue
            for n in range(np.uint64(3)):
                steps = (m != ONE) + (n != ONE) + (o != ONE)  # distance2, since each is one at most
                near = 1.0 if steps == 1 else (0.5 if steps == 2 else 1.0 / 3.0)
                if (line >> np.int32(n)) & 1:
                    total += near * value[a + m, b + n, c + o]
                    weight += near
    return total / weight


@flow_kernel
def continue_faces(columns, first, last, late, step, sources, value):
    """Values from their sources, those of kind LATE or the others; films (before LATE) do not leave their floor.

    A free face between a film and air does not move towards the closed face, if that is at rest, that the film lies on.
    """
    p, q, r = step
    for c in range(first, last):
        i = np.int64(columns[c, 0])
        j = np.int64(columns[c, 1])
        for k in range(np.int64(columns[c, 2]), np.int64(columns[c, 3])):
            found = sources[i, j, k]
            if found == 0 or (found >= LATE and found < FILM_BELOW) != late:
                continue
            if found == ZERO:
                value[i, j, k] = 0.0
            elif found == FILM_BELOW:
                value[i, j, k] = max(value[i, j, k], 0.0) if value[i - p, j - q, k - r] == 0.0 else value[i, j, k]
            elif found == FILM_ABOVE:
                value[i, j, k] = min(value[i, j, k], 0.0) if value[i + p, j + q, k + r] == 0.0 else value[i, j, k]
            else:
                value[i, j, k] = _mean(found, value, i, j, k)


def find_sources(team, columns, before, b, A, F, periodic, least, beside) -> None:
    """Where the velocities of the open faces of the columns' cells come from, for `continue_velocity`.

    columns: wider than the liquid by two cells; before: those of the last call, where marks are to be forgotten.
    b, A, periodic: of u, v, w; b None in absent directions.
    """
    team.run(clear, before, beside.mark)
    for d, sources in enumerate(beside.sources):
        if sources is not None:
            step = (int(d == 0), int(d == 1), int(d == 2))
            side = -1 if periodic[d] else F.shape[d] - G - 1
            args = (F, (*step[:2], np.uint64(step[2])), np.int64(side), least, beside.mark)
            team.run(mark_faces, columns, b[d], A[d], *args)
            team.run(find_neighbours, columns, np.int64(HELD), beside.mark, beside.nine, sources)
            team.run(find_films, columns, F, step, periodic[d], least, beside.mark, sources)
            team.run(find_neighbours, columns, np.int64(FREE), beside.mark, beside.nine, sources)


def continue_velocity(team, columns, velocity, beside) -> None:
    """Give every open face of the columns' cells a velocity, see above; columns as of `find_sources`.

    velocity [u, v, w]: predicted where the projection found none. Faces on the domain's sides keep their value, unless
    the direction is periodic.
    """
    for d, (value, sources) in enumerate(zip(velocity, beside.sources, strict=True)):
        if value is not None:
            step = (int(d == 0), int(d == 1), int(d == 2))
            team.run_uneven(continue_faces, columns, False, step, sources, value)
            team.run_uneven(continue_faces, columns, True, step, sources, value)
