"""What bodies cover and leave open of cells with edges in them, and pockets that they divide a cell into.

Summed over the parts of cell_shares.py. Where a sheet is curved, chords are taken at the nodes and at the corners only,
and extrapolated (cell_parts.py). Planes are exact at once.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flowgmo.flow.favor.cell_shares import Near, Parts, cut, divide, extrapolated, part_of, split
from flowgmo.flow.favor.cut_cell import MOST_FIELDS
from flowgmo.flow.favor.near_surface import Shape
from flowgmo.mesh import Block


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


def largest_pocket(
    block: Block, shapes: Sequence[Shape], near: Near, removed: np.ndarray, pieces: int
) -> tuple[np.ndarray, np.ndarray]:
    """What of cells (c,) of planes only hangs together with the nodes that are not in removed (c,), bits, nan where
    that is not known; and whether it is all that is open.

    Two parts are neighbours when one plane is between them: they are convex, so the line from one to the other crosses
    that plane alone, within the cell.
    """
    cell, where, share, _, _, signs = cut(near, 6, pieces, pieces)
    parts = divide(block, shapes, near, 6, pieces, pieces)
    bare = ~np.logical_or.reduceat(parts.inside, parts.first[:-1]) if len(parts.cell) else np.zeros(0, bool)
    kept, all_of_it = np.full(len(near.cells), np.nan), np.zeros(len(near.cells), bool)
    for c in np.flatnonzero(near.flat & ~split(near, pieces)[0]):
        mine = np.flatnonzero(bare & (cell == c))
        values = near.sheets[near.first[c] : near.first[c + 1]]
        bits = (values < 0.0).T @ (1 << np.arange(len(values)))
        clear = (values != 0.0).all(axis=0) & ((removed[c] >> np.arange(values.shape[1])) & 1 == 0)
        masks = {int(where[q, 1]): share[q] for q in mine}
        reached = {int(where[q, 1]) for q in mine if signs[q] in bits[clear]}
        if len(reached) == 0:
            continue
        kept[c] = 0.0
        while reached:
            mask = reached.pop()
            kept[c] += masks.pop(mask)
            reached |= {mask ^ (1 << n) for n in range(MOST_FIELDS)} & masks.keys()
        all_of_it[c] = not masks
    return kept, all_of_it
