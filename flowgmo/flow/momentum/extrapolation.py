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
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.fields import G
from flowgmo.kernel import flow_kernel

NONE, HELD, CONTINUED, FREE, BEYOND, CLOSED = 0, 1, 2, 3, 4, 5


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
def continue_faces(columns, first, last, source, value, mark):
    """Faces without a held value take the mean of neighbours of kind `source` or lower (not NONE); mark them.

    source HELD: from held faces, the result is CONTINUED; source FREE: from all that have a value, it is BEYOND.
    The new kind is above `source`, so that no face looks at one that was set in the same pass.
    """
    new = CONTINUED if source == HELD else BEYOND
    for c in range(first, last):
        i = np.int64(columns[c, 0])
        j = np.int64(columns[c, 1])
        for k in range(np.int64(columns[c, 2]), np.int64(columns[c, 3])):
            kind = mark[i, j, k]
            if kind == HELD or kind == CLOSED or (source != HELD and kind != NONE):
                continue
            total = 0.0
            weight = 0.0
            for m in range(-1, 2):
                for n in range(-1, 2):
                    for o in range(-1, 2):
                        there = mark[i + m, j + n, k + o]
                        if there > NONE and there <= source:
                            steps = abs(m) + abs(n) + abs(o)  # distance2, since each is one at most
                            near = 1.0 if steps == 1 else (0.5 if steps == 2 else 1.0 / 3.0)
                            total += near * value[i + m, j + n, k + o]
                            weight += near
            if weight > 0.0:
                value[i, j, k] = total / weight
                mark[i, j, k] = new
            elif kind == NONE:
                value[i, j, k] = 0.0


@flow_kernel
def rest_films(columns, first, last, F, step, periodic, least, value, mark):
    """Free faces between a film and air do not move towards the closed face (of velocity 0) that the film lies on."""
    p, q, r = step
    n = value.shape[0] * p + value.shape[1] * q + value.shape[2] * r
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
            on_side = not periodic and (at == G - 1 or at == n - G - 1)
            if (mark[e, f, g] == CLOSED or on_side) and value[e, f, g] == 0.0:
                value[i, j, k] = max(value[i, j, k], 0.0) if low else min(value[i, j, k], 0.0)


def continue_velocity(team, columns, b, A, F, value, direction, periodic, least, mark) -> None:
    """Give every open face of the columns' cells a velocity along `direction` (0, 1, 2), see above.

    columns: wider than the liquid by two cells; value: predicted velocity where the projection found none. Faces on the
    domain's sides keep their value, unless the direction is periodic.
    mark: int8 scratch of mesh size, 0 outside the columns.
    """
    step = (int(direction == 0), int(direction == 1), np.uint64(direction == 2))
    side = -1 if periodic else value.shape[direction] - G - 1
    team.run(mark_faces, columns, b, A, F, step, np.int64(side), least, mark)
    team.run(continue_faces, columns, np.int64(HELD), value, mark)
    team.run(rest_films, columns, F, tuple(int(n) for n in step), periodic, least, value, mark)
    team.run(continue_faces, columns, np.int64(FREE), value, mark)
