"""Liquid in single cells: the share of a cell's open volume that regions of liquid, applied in order, fill.

A point holds what the last region that contains it says. The sheets of all regions and solids near a cell divide it
into parts that lie wholly inside or outside of each (cell_shares.py), so

    F = sum over open parts of  share x fraction of the last region that holds the part  /  sum of their shares
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from flowgmo.flow.favor.arrangement import measure_below
from flowgmo.flow.favor.cell_parts import open_by
from flowgmo.flow.favor.cell_shares import Near, Parts, divide, extrapolated, gather, part_of, split
from flowgmo.flow.favor.cut_cell import work_space
from flowgmo.flow.favor.near_surface import Shape
from flowgmo.flow.fields import G
from flowgmo.kernel import kernel
from flowgmo.mesh import Block


def liquid_in_cells(
    block: Block,
    shapes: Sequence[Shape],
    near: Near,
    solids: int,
    fractions: np.ndarray,
    before: np.ndarray,
    pieces: int,
) -> np.ndarray:
    """F (c,) of the cells of `near`: shapes are `solids` solids, then regions in their order.

    fractions: what each region gives its inside, 0 for a hole; before (c,): what fills the rest.
    """
    held, room, level = _held(divide(block, shapes, near, 6, pieces, pieces), near, solids, fractions, before)
    finer, blind = split(near, pieces)
    cells = np.flatnonzero(finer)
    if len(cells):
        fine = part_of(near, cells)
        found = _held(divide(block, shapes, fine, 6, 1, pieces), fine, solids, fractions, before[cells])
        skip = blind[cells]
        held[cells] = np.where(skip, found[0], extrapolated(found[0], held[cells]))
        room[cells] = np.where(skip, found[1], extrapolated(found[1], room[cells]))
        level[cells] = found[2]
    F = np.minimum(held / np.where(room > 0.0, room, 1.0), 1.0)
    return np.where(np.isnan(level), F, level)


def _held(
    parts: Parts, near: Near, solids: int, fractions: np.ndarray, before: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Liquid and open share (c,) of cells, and F (c,) where all of what is open holds the same, else nan."""
    kind = near.which[parts.pair]
    closed = np.logical_or.reduceat(parts.inside & (kind < solids), parts.first[:-1])
    last = np.maximum.reduceat(np.where(parts.inside & (kind >= solids), kind - solids, -1), parts.first[:-1])
    amount = np.where(last >= 0, np.append(fractions, 0.0)[last], before[parts.cell])
    cell, share, amount = parts.cell[~closed], parts.share[~closed], amount[~closed]
    count = len(near.cells)
    low, high = np.full(count, np.inf), np.full(count, -np.inf)
    np.minimum.at(low, cell, amount)
    np.maximum.at(high, cell, amount)
    room = np.bincount(cell, share, count)
    level = np.where(low == high, low, np.where(room > 0.0, np.nan, 0.0))
    return np.bincount(cell, share * amount, count), room, level


@dataclass
class OpenParts:
    """What solids leave open of cells (c, 3): for the volume below a plane, again and again.

    low, size (c, 3) [length]; rows: cells with solids near them, their parts and open share; room (c,).
    """

    low: np.ndarray
    size: np.ndarray
    rows: np.ndarray
    near: Near
    finer: np.ndarray
    blind: np.ndarray
    parts: tuple[Parts, Parts]
    pieces: int

    @staticmethod
    def of(
        block: Block, solids: Sequence[Shape], cells: np.ndarray, rows: np.ndarray, near: Near, pieces: int
    ) -> OpenParts:
        """near: the solids near cells[rows]."""
        low = np.column_stack([x[cells[:, k]] for k, x in enumerate(block.planes)])
        size = np.column_stack([np.diff(x)[cells[:, k]] for k, x in enumerate(block.planes)])
        finer, blind = split(near, pieces)
        finer = np.flatnonzero(finer)
        coarse = _open_ones(divide(block, solids, near, 6, pieces, pieces))
        fine = _open_ones(divide(block, solids, part_of(near, finer), 6, 1, pieces))
        return OpenParts(low, size, rows, near, finer, blind, (coarse, fine), pieces)

    def below(self, up: np.ndarray, height: float) -> np.ndarray:
        """Share (c,) of the open volume of each cell that lies below the plane up . x = height."""
        F = np.empty(len(self.low))
        shares_below(self.low, self.size, up, height, F)
        if not len(self.rows):
            return F
        low, size = self.low[self.rows], self.size[self.rows]
        held, room = self._sums(0, self.near, low, size, up, height, self.pieces)
        if len(self.finer):
            near = part_of(self.near, self.finer)
            found = self._sums(1, near, low[self.finer], size[self.finer], up, height, 1)
            skip = self.blind[self.finer]
            for total, fine in zip((held, room), found, strict=True):
                total[self.finer] = np.where(skip, fine, extrapolated(fine, total[self.finer]))
        F[self.rows] = np.minimum(held / np.where(room > 0.0, room, 1.0), 1.0)
        return F

    def _sums(
        self, which: int, near: Near, low: np.ndarray, size: np.ndarray, up: np.ndarray, height: float, step: int
    ) -> tuple[np.ndarray, np.ndarray]:
        parts, count = self.parts[which], len(near.cells)
        below = np.empty(len(parts.cell))
        measure_below(near.first, near.sheets, parts.cell, parts.where, step, self.pieces, low, size, up, height, below)
        return np.bincount(parts.cell, below, count), np.bincount(parts.cell, parts.share, count)


def _open_ones(parts: Parts) -> Parts:
    """The parts that lie in no body."""
    if not len(parts.cell):
        return parts
    kept = ~np.logical_or.reduceat(parts.inside, parts.first[:-1])
    return parts._replace(cell=parts.cell[kept], where=parts.where[kept], share=parts.share[kept])


@kernel
def shares_below(low, size, up, height, F):
    """F (c,): share of cells, low and size (c, 3) [length], that lies below the plane up . x = height."""
    work = work_space()
    fields = np.empty((1, 8))
    for c in range(len(F)):
        at = 0
        for i in range(2):
            for j in range(2):
                for k in range(2):
                    x = low[c, 0] + size[c, 0] * i
                    y = low[c, 1] + size[c, 1] * j
                    z = low[c, 2] + size[c, 2] * k
                    fields[0, at] = height - (up[0] * x + up[1] * y + up[2] * z)
                    at += 1
        F[c] = open_by(work, fields, 0, 1, 0, 1, 6, 1)


@kernel
def fill_boxes(boxes, F, last, fraction, number):
    """F = fraction and last = number in boxes (m, 2, 3) of cells [without ghosts], first and one past the last."""
    for b in range(boxes.shape[0]):
        for i in range(boxes[b, 0, 0] + G, boxes[b, 1, 0] + G):
            for j in range(boxes[b, 0, 1] + G, boxes[b, 1, 1] + G):
                for k in range(boxes[b, 0, 2] + G, boxes[b, 1, 2] + G):
                    F[i, j, k] = fraction
                    last[i, j, k] = number


def near_bodies(
    block: Block, shapes: Sequence[Shape], cells: np.ndarray, near: Sequence[np.ndarray], pieces: int
) -> Near:
    """Near of cells (c, 3), in C order, for those of the numbers `near` of cells of each shape that are among them."""
    numbers = np.ravel_multi_index(cells.T.astype(np.int64), block.shape)
    found = [np.flatnonzero(np.isin(numbers, n, assume_unique=True)) for n in near]
    at = np.concatenate([*found, np.zeros(0, np.int64)])
    which = np.repeat(np.arange(len(near)), [len(f) for f in found])
    order = np.lexsort((which, at))
    starts = np.append(0, np.cumsum(np.bincount(at, minlength=len(cells))))
    return gather(block, shapes, cells, starts, which[order], pieces)
