"""What a body of several pieces covers of a cell: a sum over pieces that cut it and what these have in common.

With x = 1 in a piece and 0 outside, the pieces in their order make the body by

    solid  f <- f + x - f x        hole  f <- f - f x        complement  f <- 1 - x + f x

so that f is a sum of products of x, x^2 being x: covered = sum over sets T of pieces of c_T |all of T|, c_T whole
numbers. What convex pieces have in common is convex, where all their sheets are negative, and cut as one piece is
(body_cut.py): planes are exact wherever pieces touch, overlap or are taken out of each other. Few pieces cut a cell;
one that fills it makes those before it meaningless.

A sheet in the plane of a face: a body that begins on either side of it covers the face, so f is found on both sides
and f1 + f2 - f1 f2 is covered. Everything is decided by what is known at the nodes of a face: both its cells agree.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flowgmo.flow.favor.body_cut import NODES, signs_face, signs_volume
from flowgmo.kernel import inner

SOLID, HOLE, COMPLEMENT = 0, 1, 2
WITHIN, BEYOND, CUT, ON = -1, 1, 0, 2  # a sheet is negative, positive, both, or 0 all over
MOST_PIECES = 8  # that cut one part and are told apart, 256 sets; of more the edges are cut off by chords
FAR = 1e300  # stands for a distance where there is no surface


class Fold(NamedTuple):
    """Scratch of one thread: state (s,) of each sheet on a part, on (s,), lists of pieces (3, p), bit (p,) of each in
    a set, c (3, 256), empty (256,), term (s + 1, NODES); ring, sums, fine, coarse of body_cut.py."""

    state: np.ndarray
    on: np.ndarray
    lists: np.ndarray
    bit: np.ndarray
    c: np.ndarray
    empty: np.ndarray
    term: np.ndarray
    ring: np.ndarray
    sums: np.ndarray
    fine: np.ndarray
    coarse: np.ndarray


@inner
def choose_pieces(side, roles, state, among, count, base, chosen):
    """Those of pieces among[:count], the last one first, that a part is neither within nor outside of.

    side (p, s), roles (p,): geometry/sheets_by_piece.py; state (s,) of each sheet on the part. chosen becomes them;
    returns how many, and whether the part lies in what is before them (base: before all).
    """
    n = np.int64(0)
    for q in range(count):
        p = among[q]
        open_ = False
        outside = False
        for s in range(side.shape[1]):
            own = side[p, s]
            if own != 0:
                here = state[s]
                if here == -own:
                    outside = True
                    break
                open_ |= here != own
        if outside:
            if roles[p] == COMPLEMENT:
                base = np.int64(1)
                break
        elif open_:
            chosen[n] = p
            n += 1
        elif roles[p] != COMPLEMENT:
            base = np.int64(1 if roles[p] == SOLID else 0)
            break
    while n > 0 and (roles[chosen[n - 1]] == HOLE) == (base == 0):
        n -= 1  # it adds to what is all filled, or takes away where nothing is
    return n, np.int64(base)


@inner
def find_states(values, sheet, used, flat, part, state):
    """State on a part of the sheets used, of their values at the nodes; planes are asked at the corners."""
    for m in range(used):
        step = 2 if m < flat else 1
        if part == 6:
            positive, negative = signs_volume(values[m], step)
        else:
            positive, negative = signs_face(values[m], part, step)
        if positive and negative:
            state[sheet[m]] = CUT
        elif positive or negative:
            state[sheet[m]] = BEYOND if positive else WITHIN
        else:
            state[sheet[m]] = ON


@inner
def _side_of_cell(d):
    """On which side of a sheet the cell lies that it touches along a face: 1 or -1."""
    total = 0.0
    for i in range(0, 3, 2):
        for j in range(0, 3, 2):
            for k in range(0, 3, 2):
                total += d[9 * i + 3 * j + k]
    return 1 if total > 0.0 else -1


@inner
def _set_alone(roles, chosen, n, base, bit, size, c):
    """c (size,): the whole numbers c_T of pieces chosen[:n], the last one first; bit (p,): their places in T."""
    for t in range(size):
        c[t] = 0
    c[0] = base
    for q in range(n - 1, -1, -1):
        role = roles[chosen[q]]
        own = 1 << bit[chosen[q]]
        for t in range(size):
            if t & own:
                continue
            one = 1 if t == 0 else 0
            before = c[t]
            c[t | own] = one - before if role == SOLID else (-before if role == HOLE else before - one)
            if role == COMPLEMENT:
                c[t] = one


@inner
def _unite(size, c):
    """c[0] <- c[0] + c[1] - c[0] c[1], the product over sets; c (3, size)."""
    for t in range(size):
        c[2, t] = c[0, t] + c[1, t]
    for t in range(size):
        if c[0, t] != 0:
            for u in range(size):
                c[2, t | u] -= c[0, t] * c[1, u]
    for t in range(size):
        c[0, t] = c[2, t]


@inner
def load_common(values, sheet, used, flat, state, side, chosen, n, bit, t, term):
    """Sheets that bound what the pieces in t have in common and cut the part into term, negative there.

    Returns their number and how many are planes; -1 where two of the pieces lie on either side of one.
    """
    count = np.int64(0)
    planes = np.int64(0)
    for m in range(used):
        if state[sheet[m]] != CUT:
            continue
        wanted = 0
        for q in range(n):
            own = side[chosen[q], sheet[m]]
            if own == 0 or not (t >> bit[chosen[q]]) & 1:
                continue
            if wanted == -own:
                return np.int64(-1), planes
            wanted = own
        if wanted != 0:
            for v in range(NODES):
                term[count, v] = -wanted * values[m, v]
            count += 1
            planes += m < flat
    return count, planes


@inner
def load_chords(values, sheet, used, state, side, roles, chosen, n, base, term):
    """One field for pieces that are too many, negative where the body is, from the largest of each and min and max."""
    for v in range(NODES):
        d = -FAR if base == 1 else FAR
        for q in range(n - 1, -1, -1):
            most = -FAR
            for m in range(used):
                own = side[chosen[q], sheet[m]]
                if own != 0 and (state[sheet[m]] == CUT or state[sheet[m]] == ON):
                    most = max(most, -own * values[m, v])
            role = roles[chosen[q]]
            d = min(d, most) if role == SOLID else (max(d, -most) if role == HOLE else min(d, -most))
        term[0, v] = d


@inner
def load_one(values, m, s, side, roles, n, base, fold):
    """What is covered on both sides of the single sheet that cuts a part: 0 or 1, or 2 where they differ; the sheet is
    then in fold.term, the covered side negative."""
    fold.state[s] = WITHIN
    _, below = choose_pieces(side, roles, fold.state, fold.lists[0], n, base, fold.lists[1])
    fold.state[s] = BEYOND
    _, above = choose_pieces(side, roles, fold.state, fold.lists[0], n, base, fold.lists[1])
    fold.state[s] = CUT
    if below == above:
        return below
    for v in range(NODES):
        fold.term[0, v] = values[m, v] if below == 1 else -values[m, v]
    return np.int64(2)


@inner
def find_relevant(values, sheet, used, side, n, fold):
    """Of the sheets of pieces fold.lists[0, :n]: how many cut, the last of them, how many lie in the part.

    fold.on (used,): 0, or for those that lie in it the side on which the cell lies.
    """
    cuts = np.int64(0)
    last = np.int64(0)
    on = np.int64(0)
    for m in range(used):
        fold.on[m] = 0
        here = fold.state[sheet[m]]
        if here != CUT and here != ON:
            continue
        for q in range(n):
            if side[fold.lists[0, q], sheet[m]] != 0:
                if here == ON:
                    fold.on[m] = _side_of_cell(values[m])
                    on += 1
                else:
                    cuts += 1
                    last = np.int64(m)
                break
    return cuts, last, on


@inner
def find_numbers(sheet, used, side, roles, n, base, on, fold):
    """fold.c[0]: the whole numbers c_T of the pieces fold.lists[0, :n]; on: sheets lie in the part."""
    for q in range(n):
        fold.bit[fold.lists[0, q]] = n - 1 - q
    for trace in range(2 if on > 0 else 1):
        for m in range(used):
            if fold.on[m] != 0:
                fold.state[sheet[m]] = fold.on[m] if trace == 0 else -fold.on[m]
        some, before = choose_pieces(side, roles, fold.state, fold.lists[0], n, base, fold.lists[1])
        _set_alone(roles, fold.lists[1], some, before, fold.bit, 1 << n, fold.c[trace])
    if on > 0:
        _unite(1 << n, fold.c)
