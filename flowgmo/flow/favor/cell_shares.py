"""Cells, and their faces, as parts that lie wholly inside or outside of each body near them.

The sheets of all bodies near a cell divide it (arrangement.py). Whether a body holds a point is a matter of the sides
of its sheets on which the point lies, so what holds for one point holds for all with the same signs: a body is asked
once for each, in the cell's volume, and its faces follow. Where a sheet lies in the plane of a face the body may begin
beyond it: there it is asked too, so that a wall in the plane of a face closes the face.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from flowgmo.flow.favor.arrangement import count_parts, divide_cells
from flowgmo.flow.favor.cut_cell import MOST_FIELDS
from flowgmo.flow.favor.near_surface import Shape
from flowgmo.flow.favor.sheets import Rows, faces_on_sheets, is_plain, rows_of
from flowgmo.mesh import Block

MOST_SLOTS = 62  # bodies near one cell that count, a bit each
STEP = 1e-9  # of a cell: how far beyond a face it is asked what lies there; what is asked of volumes too
INWARDS = 1e-6  # of half a cell: how far nodes are moved to ask there; more than rounding, less than any sheet is off


class Near(NamedTuple):
    """Cells (c, 3) and the bodies near them: starts (c + 1,) first pair (cell, body) of each, which (p,) the body.

    first, sheets, flat, slots: sheets of each cell (c + 1,), (s, nodes), whether all are planes (c,), for each sheet
    the pair, as a number within its cell, that it decides alone, or -1. asked (p,): pairs that no sheet decides.
    beyond (p, 6): faces of the cell in whose plane a sheet of the body lies. known, origin (c,): what was asked
    already, and the cells' numbers there.
    """

    cells: np.ndarray
    starts: np.ndarray
    which: np.ndarray
    first: np.ndarray
    sheets: np.ndarray
    flat: np.ndarray
    slots: np.ndarray
    asked: np.ndarray
    beyond: np.ndarray
    known: Known | None
    origin: np.ndarray


class Known(NamedTuple):
    """Bodies (bits, by their number within the cell) at points of cell c with signs s: inside[n], key[n] = c R + rank
    of s among signs (R,); key ascending."""

    signs: np.ndarray
    key: np.ndarray
    inside: np.ndarray

    def find(self, cell: np.ndarray, signs: np.ndarray) -> np.ndarray:
        """Index (q,) into inside, -1 where nothing is known."""
        rank = np.minimum(np.searchsorted(self.signs, signs), len(self.signs) - 1)
        key = cell * len(self.signs) + rank
        at = np.minimum(np.searchsorted(self.key, key), len(self.key) - 1)
        return np.where((self.signs[rank] == signs) & (self.key[at] == key), at, -1)


class Parts(NamedTuple):
    """cell (q,) index of each part's cell, share (q,) of it; first (q + 1,), inside: for each part and each pair of its
    cell, in their order, whether it lies in that body; pair: the pair's number. where (q, 2): arrangement.py."""

    cell: np.ndarray
    where: np.ndarray
    share: np.ndarray
    first: np.ndarray
    pair: np.ndarray
    inside: np.ndarray


def gather(
    block: Block, shapes: Sequence[Shape], cells: np.ndarray, starts: np.ndarray, which: np.ndarray, pieces: int
) -> Near:
    """The sheets of bodies `which` (p,) in the cells (c, 3) of their pairs; order of shapes is order of cutting."""
    of_pair = np.repeat(np.arange(len(cells)), np.diff(starts))
    local = np.arange(len(which)) - starts[of_pair]
    nodes = (pieces + 1) ** 3
    none = Rows(np.zeros(0, np.int64), np.zeros((0, nodes)), np.zeros(0, bool), np.zeros(0, bool))
    found, pair = [none], [np.zeros(0, np.int64)]
    for b in np.unique(which):
        mine = np.flatnonzero(which == b)
        rows = rows_of(shapes[b], block, cells[of_pair[mine]], pieces)
        pair.append(mine[rows.cell])
        found.append(rows)
    pairs = np.concatenate(pair)
    order = np.argsort(pairs, kind="stable")
    pairs = pairs[order]
    values, flat, alone = (np.concatenate([r[k] for r in found])[order] for k in (1, 2, 3))
    cell = of_pair[pairs]
    slots = np.where(alone & (local[pairs] < MOST_SLOTS), local[pairs], -1)
    asked = np.ones(len(which), bool)
    asked[pairs[slots >= 0]] = False
    curved = np.bincount(cell[~flat], minlength=len(cells)) > 0
    first = np.append(0, np.cumsum(np.bincount(cell, minlength=len(cells))))
    beyond = np.zeros((len(which), 6), bool)
    for b in np.unique(which[asked]):
        mine = np.flatnonzero(which == b)
        beyond[mine] = faces_on_sheets(shapes[b], block, cells[of_pair[mine]])
    near = Near(cells, starts, which, first, values, ~curved, slots, asked, beyond, None, np.arange(len(cells)))
    bodies = np.array([not is_plain(shape) and len(shape.sheets.curved) > 0 for shape in shapes], bool)
    bent = curved | (np.bincount(of_pair, bodies[which], len(cells)) > 0.0)
    return near._replace(known=_ask_all(block, shapes, near, bent, pieces))


def _ask_all(block: Block, shapes: Sequence[Shape], near: Near, bent: np.ndarray, pieces: int) -> Known | None:
    """What bodies are at all signs that occur in the cells' volumes; bent (c,): cells near curved sheets."""
    if not near.asked.any():
        return None
    finer = np.flatnonzero(split(near, pieces)[0])
    coarse, fine = cut(near, 6, pieces, pieces), cut(part_of(near, finer), 6, 1, pieces)
    nodes = _at_nodes(near, np.flatnonzero(bent), pieces)
    cell = np.concatenate([nodes[0], finer[fine[0]], coarse[0]])
    signs, centre = (np.concatenate([nodes[k], fine[m], coarse[m]]) for k, m in ((1, 5), (2, 3)))
    rank = np.repeat([0, 1, 2], [len(nodes[0]), len(fine[0]), len(coarse[0])])
    size = np.concatenate([nodes[3], fine[2], coarse[2]])
    order = np.lexsort((-size, rank, signs, cell))
    cell, centre, signs = cell[order], centre[order], signs[order]
    first = np.append(True, (np.diff(cell) != 0) | (np.diff(signs) != 0))[: len(cell)]
    cell, centre, signs = cell[first], centre[first], signs[first]
    found = _ask(block, shapes, near, cell, centre)
    kinds, rank = np.unique(signs, return_inverse=True)
    return Known(kinds, cell * len(kinds) + rank, found)


def _at_nodes(near: Near, chosen: np.ndarray, pieces: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Cell, signs, place (q, 3) and smallest |distance| of nodes of chosen cells (n,): a chord may have the centroid of
    a part on its wrong side, a node is where it is. Moved off the mesh planes, where a body may end."""
    here, count = part_of(near, chosen), (pieces + 1) ** 3
    cell = np.repeat(np.arange(len(chosen)), np.diff(here.first))
    local = np.minimum(np.arange(len(cell)) - here.first[cell], MOST_SLOTS)
    signs, away = np.zeros((len(chosen), count), np.int64), np.full((len(chosen), count), np.inf)
    np.add.at(signs, cell, (here.sheets < 0.0) * np.where(local < MOST_SLOTS, 1 << local, 0)[:, None])
    np.minimum.at(away, cell, np.abs(here.sheets))
    at = np.indices((pieces + 1,) * 3).reshape(3, -1).T / pieces
    c, n = np.nonzero(away > 0.0)
    return chosen[c], signs[c, n], (0.5 + (1.0 - INWARDS) * (at - 0.5))[n], away[c, n]


def _ask(block: Block, shapes: Sequence[Shape], near: Near, cell: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Bits (q,) of the bodies that are asked at places `at` (q, 3) in unit cells."""
    of_part, local, pair = _pairs(near, cell)
    asked = near.asked[pair] & (local < MOST_SLOTS)
    of_part, local, which = of_part[asked], local[asked], near.which[pair[asked]]
    points = _points(block, near.cells[cell[of_part]], at[of_part])
    bits = np.zeros(len(cell), np.int64)
    for b in np.unique(which):
        mine = np.flatnonzero(which == b)
        within = mine[shapes[b].distance(points[mine]) < 0.0]
        bits[of_part[within]] |= np.int64(1) << local[within]  # one body is one pair of a cell, so none is met twice
    return bits


def _pairs(near: Near, cell: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """All pairs of the cells of parts: index of the part, number of the pair within its cell, and of all."""
    width = np.diff(near.starts)[cell]
    first = np.cumsum(width) - width
    of_part = np.repeat(np.arange(len(cell)), width)
    local = np.arange(len(of_part)) - first[of_part]
    return of_part, local, near.starts[cell[of_part]] + local


def part_of(near: Near, chosen: np.ndarray) -> Near:
    """The same for some of the cells, their indices (n,) ascending."""

    def pick(starts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        counts = np.diff(starts)[chosen]
        ends = np.append(0, np.cumsum(counts))
        return ends, np.repeat(starts[chosen] - ends[:-1], counts) + np.arange(ends[-1])

    starts, pairs = pick(near.starts)
    first, rows = pick(near.first)
    return Near(
        near.cells[chosen], starts, near.which[pairs], first, near.sheets[rows], near.flat[chosen], near.slots[rows],
        near.asked[pairs], near.beyond[pairs], near.known, near.origin[chosen],
    )  # fmt: skip


def cut(near: Near, part: int, step: int, pieces: int) -> tuple[np.ndarray, ...]:
    """Cell, where, share, centre, inside, signs of all parts of divide_cells."""
    n = pieces // step
    counts = np.empty((len(near.cells), n**3 if part == 6 else n**2), np.int64)
    count_parts(near.first, near.sheets, part, step, pieces, counts)
    room = int(np.where(counts < 0, 1 << MOST_FIELDS, counts).sum())
    cell, share, inside, signs = np.empty(room, np.int64), np.empty(room), *np.empty((2, room), np.int64)
    centre, where = np.empty((room, 3)), np.empty((room, 2), np.int64)
    q = divide_cells(near.first, near.sheets, part, step, pieces, near.slots, cell, where, share, centre, inside, signs)
    return tuple(a[:q] for a in (cell, where, share, centre, inside, signs))


def divide(block: Block, shapes: Sequence[Shape], near: Near, part: int, step: int, pieces: int) -> Parts:
    """All parts of the volumes (part 6) or of one face (0 .. 5) of the cells, in boxes of `step` nodes."""
    cell, where, share, centre, bits, signs = cut(near, part, step, pieces)
    if near.known is not None:
        at = near.known.find(near.origin[cell], signs)
        bits |= np.where(at >= 0, near.known.inside[at], 0)
        new = np.flatnonzero(at < 0)
        bits[new] |= _ask(block, shapes, near, cell[new], centre[new])
    of_part, local, pair = _pairs(near, cell)
    inside = (local < MOST_SLOTS) & ((bits[of_part] >> np.minimum(local, MOST_SLOTS)) & 1 == 1)
    if part < 6:
        _look_beyond(block, shapes, near, part, cell, centre, of_part, pair, inside)
    first = np.append(0, np.cumsum(np.diff(near.starts)[cell]))
    return Parts(cell, where, share, first, pair, inside)


def _look_beyond(
    block: Block, shapes: Sequence[Shape], near: Near, face: int, cell: np.ndarray, centre: np.ndarray,
    of_part: np.ndarray, pair: np.ndarray, inside: np.ndarray,
) -> None:  # fmt: skip
    """Set `inside` of parts of a face behind which a body begins that has a sheet in its plane."""
    there = np.flatnonzero(near.beyond[pair, face] & ~inside)
    at = centre[of_part[there]]
    at[:, face // 2] += STEP if face % 2 else -STEP
    points = _points(block, near.cells[cell[of_part[there]]], at)
    which = near.which[pair[there]]
    for b in np.unique(which):
        mine = np.flatnonzero(which == b)
        inside[there[mine]] = shapes[b].distance(points[mine]) < 0.0


def _points(block: Block, cells: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Points (n, 3) in space from places `at` (n, 3) in unit cells."""
    columns = [x[cells[:, k]] + at[:, k] * (x[cells[:, k] + 1] - x[cells[:, k]]) for k, x in enumerate(block.planes)]
    return np.column_stack(columns)


def split(near: Near, pieces: int) -> tuple[np.ndarray, np.ndarray]:
    """Which cells (c,) have to be divided in finer boxes, and for which of them the coarse ones say nothing."""
    counts = np.empty((len(near.cells), 1), np.int64)
    count_parts(near.first, near.sheets, 6, pieces, pieces, counts)
    crowded = (counts[:, 0] < 0) & (pieces > 1)
    return crowded | (~near.flat & (pieces > 1)), crowded | (pieces % 2 == 1)


def extrapolated(fine: np.ndarray, coarse: np.ndarray) -> np.ndarray:
    """(4 fine - coarse) / 3, as in cell_parts.py, of shares (n,)."""
    room = 0.5 * np.minimum(fine, 1.0 - fine).clip(0.0)
    return fine + np.clip((fine - coarse) / 3.0, -room, room)
