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
for both velocities that are continued in it. Bit 9 (o + 1) + 3 (m + 1) + n + 1 is the neighbour (m, n, o) away. Kinds
are bits of lines (face_bits.py): a kernel asks 64 faces at once whether a neighbour is held, and goes only to those
that have one. Few have: in a dam break 28 000 of 129 000 along each direction.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flowgmo.flow.ahead import ask_ahead
from flowgmo.flow.columns import ONE
from flowgmo.flow.face_bits import (
    ALL,
    LAST,
    NO_BIT,
    SHIFT,
    first_bit,
    make_bits,
    start_of,
    window,
    within,
    words_of,
)
from flowgmo.flow.fields import G
from flowgmo.flow.solid_lines import ask_at_solids
from flowgmo.kernel import flow_kernel, inlined

#: Of `sources`, in place of neighbours: a film below the face, above it
FILM_BELOW, FILM_ABOVE = np.int32(1 << 29), np.int32(1 << 30)

#: (27, 3) the neighbours of a source's bits, (m, n, o); and 1 / distance2 in cells, 0 for the face itself
AWAY = np.array([(m, n, o) for o in (-1, 0, 1) for m in (-1, 0, 1) for n in (-1, 0, 1)])
NEAR = np.array([1.0 / (away @ away) if away.any() else 0.0 for away in AWAY])

#: The three bits of a window, spread to o = -1, 0, 1: a product puts copies 8 bits apart, of which one bit each is kept
THREE, COPIES, KEPT = np.uint64(7), np.uint64(1 | 1 << 8 | 1 << 16), np.uint64(1 | 1 << 9 | 1 << 18)


class Beside(NamedTuple):
    """What is known of upper faces; bits (nx, ny, words) as of face_bits.py.

    Of one direction after the other: held, closed, free (all that liquid touches beside these); some: held, free or
    continued; left: what a pass has not found.
    Of u, v, w, None in absent directions: continued (and films), beyond, none; sources int32 of mesh size: where the
    value of the continued and those beyond comes from. away (27,): how far in memory the neighbours of its bits lie.
    """

    held: np.ndarray
    closed: np.ndarray
    free: np.ndarray
    some: np.ndarray
    left: np.ndarray
    continued: tuple
    beyond: tuple
    none: tuple
    sources: tuple
    away: np.ndarray


def make_beside(shape: tuple, present: tuple) -> Beside:
    """For a mesh of this shape; present (3,): directions that have a velocity."""
    found = [tuple(make_bits(shape) if there else None for there in present) for _ in range(3)]
    sources = tuple(np.zeros(shape, np.int32) if there else None for there in present)
    away = (AWAY @ _strides(shape)).astype(np.uint64)  # those behind wrap around, and back when they are added
    return Beside(*(make_bits(shape) for _ in range(5)), *found, sources, away)


def _strides(shape: tuple) -> np.ndarray:
    """(3,) from a face to the next along each direction, in faces."""
    return np.array([shape[1] * shape[2], shape[2], 1])


@flow_kernel
def forget(columns, first, last, held, closed, some):
    """Take all bits from the columns' lines."""
    for c in range(first, last):
        for word in range(held.shape[2]):
            held[columns[c, 0], columns[c, 1], word] = NO_BIT
            closed[columns[c, 0], columns[c, 1], word] = NO_BIT
            some[columns[c, 0], columns[c, 1], word] = NO_BIT


@flow_kernel
def mark_faces(columns, first, last, b, A, lines, F, step, side, least, held, closed, free, left):
    """Sort the upper faces (along `step`, a unit vector, its z unsigned) of the columns' cells into the kinds above.

    side: index of the faces on the domain's upper side, -1 where periodic: they are closed, since those on the lower
    side lie in no column, and a mirrored scene must give the mirrored flow.
    F > least is liquid. lines: solid_lines.py. left: those that are neither held nor closed.
    """
    p, q, r = step
    for c in range(first, last):
        i = np.int64(columns[c, 0])
        j = np.int64(columns[c, 1])
        k0, k1 = np.uint64(columns[c, 2]), np.uint64(columns[c, 3])
        ask_ahead(columns, c, last, F, p, q)
        ask_ahead(columns, c, last, b, 0, 0)
        ask_at_solids(columns, c, last, A, lines)
        solid = False
        if A is not None:
            solid = lines[i, j] != 0
        shut_side = NO_BIT if r != 0 or i * p + j * q != side else ALL
        for word in range(*words_of(k0, k1)):
            start = start_of(word)
            has, wet, shut = NO_BIT, NO_BIT, NO_BIT
            for k in range(max(k0, start), min(k1, start + LAST + ONE)):
                bit = ONE << (k - start)
                wet |= bit if max(F[i, j, k], F[i + p, j + q, k + r]) > least else NO_BIT
                has |= bit if b[i, j, k] > 0.0 else NO_BIT
            if A is not None:
                for k in range(max(k0, start), min(k1, start + LAST + ONE) if solid else NO_BIT):
                    shut |= ONE << (k - start) if A[i, j, k] == 0.0 else NO_BIT
            on_side = shut_side
            if r != 0 and np.int64(min(k1, start + LAST + ONE)) - 1 == side:
                on_side = ONE << (np.uint64(side) - start)
            has &= ~on_side
            every = within(word, k0, k1)
            shut = ((shut & ~has) | on_side) & every
            held[i, j, word] = has
            closed[i, j, word] = shut
            free[i, j, word] = wet & ~(has | shut)
            left[i, j, word] = every & ~(has | shut)


@inlined
def _beside_any(bits, i, j, word):
    """Faces of a word that have a neighbour of the 26, or themselves, among the bits."""
    here, below, above = NO_BIT, NO_BIT, NO_BIT
    for m in range(i - 1, i + 2):
        for n in range(j - 1, j + 2):
            here |= bits[m, n, word]
            below |= bits[m, n, word - ONE]
            above |= bits[m, n, word + ONE]
    return here | (here << ONE) | (here >> ONE) | (below >> LAST) | (above << LAST)


@inlined
def _neighbours(bits, i, j, word, place):
    """The source of a face: those of its neighbours that are among the bits."""
    found = NO_BIT
    amid = place != NO_BIT and place != LAST
    below = (word << SHIFT) + place - ONE
    for m in range(3):
        for n in range(3):
            if amid:  # most are; their neighbours lie in one word
                three = bits[i + m - 1, j + n - 1, word] >> (place - ONE)
            else:
                three = window(bits, i + m - 1, j + n - 1, below)
            found |= (((three & THREE) * COPIES) & KEPT) << np.uint64(3 * m + n)
    return np.int32(found)


@flow_kernel
def find_neighbours(columns, first, last, wanted, given, sources, found, missed):
    """Sort the wanted faces into those with a neighbour among the given ones (found, and their sources), and the rest.

    What is found is not given: no face looks at one that was found in the same pass.
    """
    for c in range(first, last):
        i = np.int64(columns[c, 0])
        j = np.int64(columns[c, 1])
        for word in range(*words_of(columns[c, 2], columns[c, 3])):
            all_of = wanted[i, j, word]
            left = all_of & _beside_any(given, i, j, word) if all_of != NO_BIT else NO_BIT
            found[i, j, word] = left
            missed[i, j, word] = all_of & ~left
            while left != NO_BIT:
                place = first_bit(left)
                left &= left - ONE
                sources[i, j, start_of(word) + place] = _neighbours(given, i, j, word, place)


@flow_kernel
def find_films(columns, first, last, F, step, periodic, least, held, closed, free, some, left, continued, sources):
    """Free faces between air and a film that lies on a closed face on the other side of its cell go to the continued.

    Before, what has a value: some = held, free or continued; and left loses what is free.
    """
    p, q, r = step
    n = F.shape[0] * p + F.shape[1] * q + F.shape[2] * r
    for c in range(first, last):
        i = np.int64(columns[c, 0])
        j = np.int64(columns[c, 1])
        for word in range(*words_of(columns[c, 2], columns[c, 3])):
            some[i, j, word] = held[i, j, word] | free[i, j, word] | continued[i, j, word]
            left[i, j, word] &= ~free[i, j, word]
            asked = free[i, j, word] & ~continued[i, j, word]
            while asked != NO_BIT:
                bit = asked & ~(asked - ONE)
                k = np.int64(start_of(word) + first_bit(asked))
                asked &= asked - ONE
                low = F[i, j, k] > least
                if low == (F[i + p, j + q, k + r] > least):
                    continue  # liquid on both sides
                s = np.int64(-1 if low else 1)
                e, f, g = i + s * p, j + s * q, k + s * r  # the other face of the film's cell
                at = e * p + f * q + g * r
                shut = window(closed, e, f, np.uint64(g + 64)) & ONE != NO_BIT
                if shut or (not periodic and (at == G - 1 or at == n - G - 1)):
                    sources[i, j, k] = FILM_BELOW if low else FILM_ABOVE
                    continued[i, j, word] |= bit


@flow_kernel
def continue_faces(columns, first, last, chosen, stride, sources, away, near, value):
    """Values of the chosen faces: means over their sources, weighted by `near`; films do not leave their floor.

    A free face between a film and air does not move towards the closed face, if that is at rest, that the film lies on.
    value (faces of the mesh,), flat: half of the time would go into finding where the 7 neighbours of a face are from
    three indices; stride: from a face to the next one along the direction.
    """
    ny, nz = np.uint64(sources.shape[1]), np.uint64(sources.shape[2])
    for c in range(first, last):
        i = np.uint64(columns[c, 0])
        j = np.uint64(columns[c, 1])
        ask_ahead(columns, c, last, sources, 0, 0)
        for word in range(*words_of(columns[c, 2], columns[c, 3])):
            left = chosen[i, j, word]
            while left != NO_BIT:
                k = start_of(word) + first_bit(left)
                left &= left - ONE
                at = (i * ny + j) * nz + k
                found = sources[i, j, k]
                if found == FILM_BELOW:
                    value[at] = max(value[at], 0.0) if value[at - stride] == 0.0 else value[at]
                    continue
                if found == FILM_ABOVE:
                    value[at] = min(value[at], 0.0) if value[at + stride] == 0.0 else value[at]
                    continue
                total, weight = 0.0, 0.0
                while found != 0:
                    bit = np.uint64(first_bit(found))
                    found &= found - np.int32(1)
                    total += near[bit] * value[at + away[bit]]
                    weight += near[bit]
                value[at] = total / weight


@flow_kernel
def stop_faces(columns, first, last, chosen, value):
    """0 on the chosen faces."""
    for c in range(first, last):
        i = columns[c, 0]
        j = columns[c, 1]
        for word in range(*words_of(columns[c, 2], columns[c, 3])):
            left = chosen[i, j, word]
            while left != NO_BIT:
                value[i, j, start_of(word) + first_bit(left)] = 0.0
                left &= left - ONE


def find_sources(team, columns, before, b, A, lines, F, periodic, least, beside) -> None:
    """Where the velocities of the open faces of the columns' cells come from, for `continue_velocity`.

    columns: wider than the liquid by two cells; before: those of the last call, where bits are to be forgotten.
    b, A, periodic: of u, v, w; lines: solid_lines.py; b None in absent directions.
    """
    held, closed, free, some, left, *_ = beside
    team.run(forget, before, held, closed, some)
    for d, (continued, beyond, none, sources) in enumerate(zip(*beside[5:9], strict=True)):
        if sources is not None:
            step = (int(d == 0), int(d == 1), int(d == 2))
            side = -1 if periodic[d] else F.shape[d] - G - 1
            args = (F, (*step[:2], np.uint64(step[2])), np.int64(side), least)
            team.run(mark_faces, columns, b[d], A[d], lines, *args, held, closed, free, none)
            team.run(find_neighbours, columns, none, held, sources, continued, left)
            kinds = held, closed, free, some, left, continued
            team.run(find_films, columns, F, step, periodic[d], least, *kinds, sources)
            team.run(find_neighbours, columns, left, some, sources, beyond, none)


def continue_velocity(team, columns, velocity, beside) -> None:
    """Give every open face of the columns' cells a velocity, see above; columns as of `find_sources`.

    velocity [u, v, w]: predicted where the projection found none. Faces on the domain's sides keep their value, unless
    the direction is periodic.
    """
    for d, value in enumerate(velocity):
        if value is not None:
            stride = np.uint64(_strides(value.shape)[d])
            args = stride, beside.sources[d], beside.away, NEAR, _flat(value)
            team.run_uneven(continue_faces, columns, beside.continued[d], *args)
            team.run_uneven(continue_faces, columns, beside.beyond[d], *args)
            team.run_uneven(stop_faces, columns, beside.none[d], value)


def _flat(a: np.ndarray) -> np.ndarray:
    """The same values in one row, never a copy."""
    if not a.flags.c_contiguous:
        raise ValueError("velocities lie in C order, without gaps")
    return a.reshape(-1)
