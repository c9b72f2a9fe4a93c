"""What bodies cover and leave open of cells with edges in them, and pockets that they divide a cell into.

Summed over the parts of cell_shares.py. Where a sheet is curved, chords are taken at the nodes and at the corners only,
and extrapolated (cell_parts.py). Planes are exact at once.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from flowgmo.flow.favor.cell_shares import Near, Parts, cut, divide, extrapolated, part_of, split
from flowgmo.flow.favor.cut_cell import MOST_FIELDS
from flowgmo.flow.favor.near_surface import Shape
from flowgmo.mesh import Block

SAME_PLACE = 1e-9  # of a cell: centres of one part as seen from two cells, cut to rounding; what is asked of volumes
NOTHING = 1e-12  # of a face: rounding of the sum of its parts


def solid_shares(block: Block, shapes: Sequence[Shape], near: Near, pieces: int) -> tuple[np.ndarray, np.ndarray]:
    """covered (p, 7) of each pair alone and opened (c, 7) of each cell, as of cell_parts.cut_cells.

    Covered is what is not open: saddles of a curved sheet, cut from both sides, need not fill the cell.
    """
    free, opened = np.empty((len(near.which), 7)), np.empty((len(near.cells), 7))
    finer, blind = split(near, pieces)
    cells = np.flatnonzero(finer)
    fine, pairs = part_of(near, cells), np.flatnonzero(np.repeat(finer, np.diff(near.starts)))
    for part in range(7):
        free[:, part], opened[:, part] = _sums(divide(block, shapes, near, part, pieces, pieces), near)
        if len(cells):
            alone, left = _sums(divide(block, shapes, fine, part, 1, pieces), fine)
            skip = blind[cells]
            opened[cells, part] = np.where(skip, left, extrapolated(left, opened[cells, part]))
            skip = np.repeat(skip, np.diff(fine.starts))
            free[pairs, part] = np.where(skip, alone, extrapolated(alone, free[pairs, part]))
    return 1.0 - free, opened


def _sums(parts: Parts, near: Near) -> tuple[np.ndarray, np.ndarray]:
    """Share (p,) of each cell outside of each pair's body, and (c,) outside of all; 0 and 1 without rounding."""
    share = np.repeat(parts.share, np.diff(parts.first))
    alone = whole(parts.pair[~parts.inside], share[~parts.inside], parts.pair[parts.inside], len(near.which))
    closed = np.logical_or.reduceat(parts.inside, parts.first[:-1]) if len(parts.cell) else np.zeros(0, bool)
    left = whole(parts.cell[~closed], parts.share[~closed], parts.cell[closed], len(near.cells))
    return alone, left


def whole(at: np.ndarray, share: np.ndarray, other: np.ndarray, count: int) -> np.ndarray:
    """Sums (count,) of shares at places `at`; 1 to the bit where nothing is at the places `other`."""
    total = np.minimum(np.bincount(at, share, count), 1.0)
    return np.where((np.bincount(other, minlength=count) == 0) & (total > 0.0), 1.0, total)


class Pockets(NamedTuple):
    """What of cells (c,) hangs together: volume (c,) share of the cell, nan where that is not known; whole (c,) whether
    it is all that is open; signs: for each cell, of its parts, the sides of all sheets on which they lie (cut)."""

    volume: np.ndarray
    whole: np.ndarray
    signs: list[set[int]]


def largest_pocket(block: Block, shapes: Sequence[Shape], near: Near, removed: np.ndarray, pieces: int) -> Pockets:
    """The Pockets of cells of planes only with the nodes that are not in removed (c,), bits.

    Two parts are neighbours when one plane is between them: they are convex, so the line from one to the other crosses
    that plane alone, within the cell.
    """
    cell, where, share, _, _, signs = cut(near, 6, pieces, pieces)
    parts = divide(block, shapes, near, 6, pieces, pieces)
    bare = _bare(parts)
    kept, all_of_it = np.full(len(near.cells), np.nan), np.zeros(len(near.cells), bool)
    sides: list[set[int]] = [set() for _ in near.cells]
    for c in np.flatnonzero(near.flat & ~split(near, pieces)[0]):
        mine = np.flatnonzero(bare & (cell == c))
        values = near.sheets[near.first[c] : near.first[c + 1]]
        bits = (values < 0.0).T @ (1 << np.arange(len(values)))
        clear = (values != 0.0).all(axis=0) & ((removed[c] >> np.arange(values.shape[1])) & 1 == 0)
        masks = {int(where[q, 1]): q for q in mine}
        reached = {int(where[q, 1]) for q in mine if signs[q] in bits[clear]}
        if len(reached) == 0:
            continue
        kept[c] = 0.0
        while reached:
            mask = reached.pop()
            q = masks.pop(mask)
            kept[c] += share[q]
            sides[c].add(int(signs[q]))
            reached |= {mask ^ (1 << n) for n in range(MOST_FIELDS)} & masks.keys()
        all_of_it[c] = not masks
    return Pockets(kept, all_of_it, sides)


def pocket_faces(
    block: Block, shapes: Sequence[Shape], near: Near, pockets: Pockets, pieces: int
) -> list[list[list[tuple[float, float, float]]]]:
    """For each cell and each of its six faces, the parts that its pocket has there: share, and centre in unit cells.

    A part of a face belongs to the part of the cell that lies on the same sides of all sheets. The two cells of a face
    are cut there by the same sheets, so that what both pockets leave open are the parts that both have.
    """
    found: list = [[[] for _ in range(6)] for _ in near.cells]
    for face in range(6):
        cell, _, share, centre, _, signs = cut(near, face, pieces, pieces)
        bare = _bare(divide(block, shapes, near, face, pieces, pieces))
        at = np.delete(centre, face // 2, axis=1)
        for q in np.flatnonzero(bare):
            if int(signs[q]) in pockets.signs[cell[q]]:
                found[cell[q]][face].append((float(share[q]), float(at[q, 0]), float(at[q, 1])))
    return found


def in_both(one: list[tuple[float, float, float]], other: list[tuple[float, float, float]]) -> float:
    """Share of a face that parts of two pockets have in common, 1 to the bit where it is all."""
    total = sum(s for s, a, b in one if any(abs(a - c) + abs(b - d) <= SAME_PLACE for _, c, d in other))
    return 1.0 if total > 1.0 - NOTHING else total


def _bare(parts: Parts) -> np.ndarray:
    """Which parts lie in no body."""
    if not len(parts.cell):
        return np.zeros(0, bool)
    return ~np.logical_or.reduceat(parts.inside, parts.first[:-1])
