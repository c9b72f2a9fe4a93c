"""What a body covers of one cell, by the simplest way that its pieces there allow.

    one piece                     all its sheets, one after the other (body_cut.py); most often there is only one
    several, cut by one sheet     that sheet, on the side where the body is
    else                          each face, and the volume, as a sum over sets of pieces (body_fold.py)

Each face is found by what is known at its own nodes, so that both its cells agree to the bit, whichever way they take.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.favor.body_cut import cover_part, signs_volume
from flowgmo.flow.favor.body_fold import (
    CUT,
    MOST_PIECES,
    choose_pieces,
    find_numbers,
    find_relevant,
    find_states,
    load_chords,
    load_common,
    load_one,
)
from flowgmo.kernel import inner

SEVERAL, NOWHERE = -1, -2  # in place of a number of sheets
NOTHING = 1e-14  # of a part: rounding of a sum of some 64 terms, 1e-16 each


@inner
def _in_a_face(values, used, flat):
    """Whether a sheet may lie in the plane of a face: it is 0 at a corner of the cell, but does not cut it."""
    for m in range(used):
        zero = False
        positive, negative = signs_volume(values[m], 2 if m < flat else 1)
        for i in range(0, 3, 2):
            for j in range(0, 3, 2):
                for k in range(0, 3, 2):
                    zero |= values[m, 9 * i + 3 * j + k] == 0.0
        if zero and not (positive and negative):
            return True
    return False


@inner
def _sheet_alone(values, sheet, used, side, n, fold):
    """The only sheet that cuts a cell, -1 where there are more or one lies in a face; pieces: fold.lists[0, :n]."""
    alone = np.int64(-1)
    for m in range(used):
        own = False
        for q in range(n):
            own |= side[fold.lists[0, q], sheet[m]] != 0
        if fold.state[sheet[m]] == CUT and own:
            if alone >= 0:
                return np.int64(-1)
            alone = np.int64(m)
    return alone


@inner
def load_cell(values, sheet, used, flat, side, roles, chosen, count, before, fold):
    """The sheets that alone bound what pieces chosen[:count] cover of a cell into fold.term; how many, how many planes.

    NOWHERE: nothing is covered; SEVERAL: each part has to be asked.
    """
    if _in_a_face(values, used, flat):
        return np.int64(SEVERAL), np.int64(0)
    find_states(values, sheet, used, flat, 6, fold.state)
    n, base = choose_pieces(side, roles, fold.state, chosen, count, before, fold.lists[0])
    same = base
    m = np.int64(0)
    if n > 0:
        m = _sheet_alone(values, sheet, used, side, n, fold)
        if m < 0:
            return np.int64(SEVERAL), np.int64(0)
        same = load_one(values, m, sheet[m], side, roles, n, base, fold)
    if same < 2:
        return np.int64(0 if same == 1 else NOWHERE), np.int64(0)
    return np.int64(1), np.int64(1 if m < flat else 0)


@inner
def _prepare_part(values, sheet, used, flat, side, roles, chosen, count, before, part, fold):
    """What is to be summed of a part that several pieces reach, chosen[:count], the last one first, before: base.

    Returns the number of sets in fold.c[0], the sheets in fold.term that bound the only one and how many are planes,
    and whether they are not there: sets that have to be loaded one by one.
    """
    find_states(values, sheet, used, flat, part, fold.state)
    n, base = choose_pieces(side, roles, fold.state, chosen, count, before, fold.lists[0])
    fold.c[0, 0] = base
    if n == 0:
        return n, np.int64(1), np.int64(0), np.int64(0), False
    cuts, last, on = find_relevant(values, sheet, used, side, n, fold)
    one = np.int64(1 if cuts == 1 and last < flat else 0)
    if cuts == 1 and on == 0:
        same = load_one(values, last, sheet[last], side, roles, n, base, fold)
        fold.c[0, 0] = same if same < 2 else 0
        fold.c[0, 1] = 1
        return n, np.int64(1 if same < 2 else 2), np.int64(1), one, False
    if n > MOST_PIECES:
        load_chords(values, sheet, used, fold.state, side, roles, fold.lists[0], n, base, fold.term)
        fold.c[0, 0] = 0
        fold.c[0, 1] = 1
        return n, np.int64(2), np.int64(1), np.int64(0), False
    find_numbers(sheet, used, side, roles, n, base, on, fold)
    return n, np.int64(1) << n, np.int64(0), np.int64(0), True


@inner
def cover_parts(work, values, sheet, used, flat, side, roles, chosen, count, before, loaded, planes, fold, out):
    """out (7,): covered shares of the faces and the volume of a cell that pieces chosen[:count] reach.

    loaded: sheets in fold.term, the first `planes` of them planes, that alone bound what is covered, or SEVERAL.

    chosen: the last one first; before: whether the cell lies in what is before them. values (used, NODES) of the sheets
    (used,) that may cut it, the first `flat` of them planes; side (p, s), roles (p,): geometry/sheets_by_piece.py.
    """
    for part in range(7):
        n, sets, terms, own, apart = np.int64(1), np.int64(2), loaded, planes, False
        if loaded == SEVERAL:
            n, sets, terms, own, apart = _prepare_part(
                values, sheet, used, flat, side, roles, chosen, count, before, part, fold
            )
        else:
            fold.c[0, 0] = 0
            fold.c[0, 1] = 1
        total = float(fold.c[0, 0])
        some = np.int64(fold.c[0, 0])
        for t in range(1, sets):
            fold.empty[t] = apart and (t & (t - 1)) > 0 and fold.empty[t & (t - 1)]
            if fold.c[0, t] == 0 or fold.empty[t]:
                continue
            some += 1
            if apart:
                terms, own = load_common(
                    values, sheet, used, flat, fold.state, side, fold.lists[0], n, fold.bit, t, fold.term
                )
            share = 0.0 if terms < 0 else cover_part(work, fold.ring, fold.term, own, terms, part)
            fold.empty[t] = share == 0.0
            total += fold.c[0, t] * share
        if some > 1:
            total = 0.0 if total < NOTHING else (1.0 if total > 1.0 - NOTHING else total)
        out[part] = total
