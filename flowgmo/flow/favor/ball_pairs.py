"""Cells near stationary balls: what each covers is found exactly (ball_cut.py), as that of balls that move is.

A body that stands and a solid are one thing then. Where others reach into a cell too, what all leave open is cut from
the distances at nodes (cell_parts.py), as it is.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flowgmo.flow.favor.ball_cut import cover_cells, fits, in_parts
from flowgmo.flow.favor.near_surface import TOUCHING, Shape, node_planes, reach
from flowgmo.flow.favor.sheets import is_plain
from flowgmo.mesh import Block


def ball_of(block: Block, shape: Shape) -> tuple[np.ndarray, bool] | None:
    """Centre (3), 0 (3), radius [length] of a shape that is a ball and is cut exactly in the block, and whether in
    parts (ball_cut.in_parts); None of others."""
    if getattr(shape, "sheets", None) is None or not is_plain(shape) or len(shape.sheets.h):
        return None
    found = getattr(shape, "sheets_by_piece", None)
    if found is None or len(found.rounds) != 1 or len(found.h) or found.curved or found.side[0, 0] != -1:
        return None
    sheet, (first, past) = found.rounds[0], reach(block.planes, shape.bounds())
    widths = tuple(np.diff(x[a : max(b, a + 1) + 1]) for x, a, b in zip(block.planes, first, past, strict=True))
    if sheet[3:6].any() or not fits(float(sheet[6]), widths):
        return None
    return sheet, in_parts(float(sheet[6]), widths)


def cut_balls(
    block: Block, shapes: Sequence[Shape], cells: np.ndarray, starts: np.ndarray, which: np.ndarray,
    covered: np.ndarray, opened: np.ndarray, removed: np.ndarray,
) -> None:  # fmt: skip
    """covered (p, 7) of pairs with balls, opened (c, 7) of cells (c, 3) that nothing else reaches, exactly.

    starts (c + 1,), which (p,): pairs of each cell, from 0; removed (c,): cells that a thin wall divides stay open as
    they are, where it is not 0.
    """
    halves, least = node_planes(block.planes, 2), TOUCHING * min(np.diff(x).min() for x in block.planes)
    of_pair, exact = np.repeat(np.arange(len(cells)), np.diff(starts)), np.zeros(len(which), bool)
    for b in np.unique(which):
        ball = ball_of(block, shapes[b])
        if ball is not None:
            mine = np.flatnonzero(which == b)
            cover_cells(cells[of_pair[mine]], *halves, *ball, least, found := np.empty((len(mine), 7)))
            covered[mine], exact[mine] = found, True
    some = exact & covered.any(axis=1)
    there = np.bincount(of_pair[covered.any(axis=1)], minlength=len(cells))
    alone = np.flatnonzero(some & (there[of_pair] == 1) & (removed[of_pair] == 0))
    opened[of_pair[alone]] = 1.0 - covered[alone]
