"""What a body covers of cells near it, in one go where its sheets are planes and round ones.

    plane    d = n . x - h
    round    d = |w| - r,  w = x - c - a (a . (x - c))      a cylinder about the axis a; a ball with a = 0

Each cell first asks at its middle which sheets reach it, and so which pieces of the body (body_fold.py) it may be cut
by: most often one, which is cut as body_cut.py has it; where a ball is all that reaches it, as ball_cut.py has it.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.favor.ball_cut import cover_cell, fits, in_parts, scratch
from flowgmo.flow.favor.body_cells import NOWHERE, cover_parts, load_cell
from flowgmo.flow.favor.body_cut import NODES, cover_by_one
from flowgmo.flow.favor.body_fold import BEYOND, CUT, MOST_PIECES, SOLID, WITHIN, Fold, choose_pieces
from flowgmo.flow.favor.clip_square import MOST
from flowgmo.flow.favor.cut_cell import work_space
from flowgmo.flow.favor.near_surface import ROUNDING
from flowgmo.kernel import free_kernel, inner

PLANE = 4  # numbers of a plane: n (3), h
ROUND = 7  # numbers of a round sheet: c (3), a (3), r
BY_CHORDS, WHOLE, IN_PARTS = 0, 1, 2  # how balls are cut
FAR_WITHIN, FAR_BEYOND = -1, -2  # in place of a row: the sheet is farther from a cell than its corners


@inner
def plane_value(sheet, x, y, z):
    """Distance to a plane."""
    return sheet[0] * x + sheet[1] * y + sheet[2] * z - sheet[3]


@inner
def round_value(sheet, x, y, z):
    """Distance to a round sheet."""
    wx = x - sheet[0]
    wy = y - sheet[1]
    wz = z - sheet[2]
    along = wx * sheet[3] + wy * sheet[4] + wz * sheet[5]
    wx -= along * sheet[3]
    wy -= along * sheet[4]
    wz -= along * sheet[5]
    return np.sqrt(wx * wx + wy * wy + wz * wz) - sheet[6]


@inner
def _far_or_cut(d, reach):
    """State of a sheet in a cell by its distance from the middle."""
    return CUT if abs(d) <= ROUNDING * reach else (BEYOND if d > 0.0 else WITHIN)


@inner
def _reaching(planes, rounds, rows, x, y, z, cell, c, state):
    """state (s,) of all sheets in a cell, CUT where they may cut it: planes, round ones, those known at nodes."""
    i = 2 * cell[0] + 1
    j = 2 * cell[1] + 1
    k = 2 * cell[2] + 1
    hx = x[i + 1] - x[i]
    hy = y[j + 1] - y[j]
    hz = z[k + 1] - z[k]
    s = np.int64(0)
    for m in range(len(planes)):
        p = planes[m]
        reach = abs(p[0]) * hx + abs(p[1]) * hy + abs(p[2]) * hz
        state[s] = _far_or_cut(plane_value(p, x[i], y[j], z[k]), reach)
        s += 1
    reach = np.sqrt(hx * hx + hy * hy + hz * hz)
    for m in range(len(rounds)):
        state[s] = _far_or_cut(round_value(rounds[m], x[i], y[j], z[k]), reach)
        s += 1
    for q in range(len(rows)):
        state[s] = BEYOND if rows[q, c] == FAR_BEYOND else (WITHIN if rows[q, c] == FAR_WITHIN else CUT)
        s += 1


@inner
def _used(state, side, chosen, n, sheet):
    """Numbers, ascending, of the sheets that may cut a cell and are those of pieces chosen[:n]; how many."""
    used = np.int64(0)
    for s in range(len(state)):
        if state[s] != CUT:
            continue
        for q in range(n):
            if side[chosen[q], s] != 0:
                sheet[used] = s
                used += 1
                break
    return used


@inner
def _sheet_values(sheet, is_plane, own, x, y, z, cell, least, step, out, row):
    """out[row] (NODES,): own, 1 or -1, times a plane or round sheet at the nodes; whether it is positive anywhere.

    step: 2 for the corners only.
    """
    positive = False
    for i in range(0, 3, step):
        a = x[2 * cell[0] + i]
        for j in range(0, 3, step):
            b = y[2 * cell[1] + j]
            for k in range(0, 3, step):
                c = z[2 * cell[2] + k]
                d = own * (plane_value(sheet, a, b, c) if is_plane else round_value(sheet, a, b, c))
                d = 0.0 if abs(d) <= least else d
                out[row, 9 * i + 3 * j + k] = d
                positive |= d > 0.0
    return positive


@inner
def _known_values(at, known, own, least, out, row):
    """out[row] (NODES,): own times a sheet by its values at numbered nodes; whether it is positive anywhere."""
    positive = False
    for v in range(NODES):
        d = own * known[at[v]]
        d = 0.0 if abs(d) <= least else d
        out[row, v] = d
        positive |= d > 0.0
    return positive


def cut_of_balls(rounds: np.ndarray, widths: tuple[np.ndarray, ...]) -> int:
    """How balls among round sheets (q, 7) are cut in cells of these widths [length]: BY_CHORDS, or all of them exactly,
    WHOLE or IN_PARTS (ball_cut.py)."""
    radii = rounds[~rounds[:, 3:6].any(axis=1), 6]
    if not len(radii) or not all(fits(float(radius), widths) for radius in radii):
        return BY_CHORDS
    return IN_PARTS if any(in_parts(float(radius), widths) for radius in radii) else WHOLE


@inner
def _is_ball(rounds, own, s):
    """Whether number s is a ball, and what it holds is covered (own: side of the piece)."""
    return own == WITHIN and 0 <= s < len(rounds) and not (rounds[s, 3] or rounds[s, 4] or rounds[s, 5])


@free_kernel
def cut_body(cells, x, y, z, planes, rounds, balls, side, roles, least, rows, at, known, covered):
    """covered (c, 7) of cells (c, 3) [without ghosts]: six faces, then volume [-].

    x, y, z: planes of half cells; side (p, s), roles (p,): the body's pieces by its sheets, planes (m, 4), rounds (q,
    7), then those of rows; balls: of cut_of_balls, where nothing else reaches; least [length]: a distance
    that counts as 0. rows (., c): for each sheet that is neither plane nor round the row of each cell in at (., NODES),
    numbers of its nodes in known (v,) [length]; FAR_WITHIN where the cell lies far on its negative side, FAR_BEYOND on
    the other.
    """
    work = work_space()
    pieces, sheets = side.shape
    values = np.zeros((sheets, NODES))
    fold = Fold(
        np.empty(sheets, np.int64), np.empty(sheets, np.int64), np.empty((3, pieces), np.int64),
        np.empty(pieces, np.int64), np.empty((3, 1 << MOST_PIECES), np.int64),
        np.empty(1 << MOST_PIECES, np.bool_), np.zeros((sheets + 1, NODES)),
        np.empty((2, MOST, 3)), np.empty((8, 8)), np.empty(7), np.empty(7),
    )  # fmt: skip
    ball = scratch()
    sheet = np.empty(sheets, np.int64)
    every = np.arange(pieces)[::-1].copy()
    chosen = np.empty(pieces, np.int64)
    curved = len(planes) + len(rounds)
    for c in range(len(cells)):
        _reaching(planes, rounds, rows, x, y, z, cells[c], c, fold.state)
        n, base = choose_pieces(side, roles, fold.state, every, pieces, 0, chosen)
        used = _used(fold.state, side, chosen, n, sheet)
        flat = np.int64(0)
        while flat < used and sheet[flat] < len(planes):
            flat += 1
        step = 2 if used == flat else 1
        alone = n == 1 and base == 0 and roles[chosen[0]] == SOLID
        if (
            balls != BY_CHORDS
            and alone
            and used == 1
            and _is_ball(rounds, side[chosen[0], sheet[0]], sheet[0] - len(planes))
        ):
            cover_cell(ball, rounds[sheet[0] - len(planes)], balls == IN_PARTS, x, y, z, cells[c], least, covered[c])
            continue
        loaded = np.int64(0 if alone or base == 1 else NOWHERE)
        own = np.int64(0)
        into = fold.term if alone else values
        for m in range(used):
            s = sheet[m]
            turn = -float(side[chosen[0], s]) if alone else 1.0
            row = loaded if alone else m
            if m < flat:
                positive = _sheet_values(planes[s], True, turn, x, y, z, cells[c], least, step, into, row)
            elif s < curved:
                positive = _sheet_values(rounds[s - len(planes)], False, turn, x, y, z, cells[c], least, 1, into, row)
            else:
                positive = _known_values(at[rows[s - curved, c]], known, turn, least, into, row)
            if alone and positive:  # what is nowhere positive does not cut
                loaded += 1
                own += m < flat
        if n > 0 and not alone:
            loaded, own = load_cell(values, sheet, used, flat, side, roles, chosen, n, base, fold)
        if loaded == NOWHERE:
            for part in range(7):
                covered[c, part] = 0.0
        elif loaded == 0 or loaded == 1:
            cover_by_one(fold.term, own, loaded, fold.sums, fold.fine, fold.coarse, covered[c])
        else:
            cover_parts(work, values, sheet, used, flat, side, roles, chosen, n, base, loaded, own, fold, covered[c])
