"""All cells near solids, cut: batch by batch, so that the distances at nodes never lie in memory all at once.

Two passes. The first cuts every cell. The second visits cells that a thin wall divides, for which the faces depend on
what both their cells keep: nodes where walls are curved (thin_walls.py), parts where they are planes (solid_shares.py).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from flowgmo.flow.favor.ball_pairs import cut_balls
from flowgmo.flow.favor.cell_parts import cut_cells
from flowgmo.flow.favor.cell_shares import Near, gather, part_of
from flowgmo.flow.favor.near_surface import Distance, Shape, node_distances, pairs_of
from flowgmo.flow.favor.sheets import is_plain
from flowgmo.flow.favor.solid_shares import in_both, largest_pocket, pocket_faces, solid_shares
from flowgmo.flow.favor.thin_walls import close_divided_faces, crossed_edges, cut_off_nodes, rejoin
from flowgmo.mesh import Block

BATCH = 20_000  # cells at once: about 1 kB each while they are cut


class CutPairs(NamedTuple):
    """Cells near solids and their pairs (cell, solid), cut.

    cells (c, 3) int32 without ghosts, in C order; numbers (c,) their numbers in it; starts (c + 1,) first pair of each;
    which (p,) the solid of each pair; covered (p, 7) by this solid alone and opened (c, 7) left by all: six faces, then
    volume. divided: cells with a thin wall; lost: open volume [length3] that dividing them took away.
    """

    cells: np.ndarray
    numbers: np.ndarray
    starts: np.ndarray
    which: np.ndarray
    covered: np.ndarray
    opened: np.ndarray
    divided: int = 0
    lost: float = 0.0


def cut_pairs(
    block: Block,
    distances: list[Distance],
    near: list[np.ndarray],
    pieces: int,
    thin: bool = True,
    shapes: Sequence[Shape] | None = None,
) -> CutPairs:
    """Cut all cells that are near solids; near: (n, 3) cells of each solid, in C order, without ghosts.

    thin: look for walls thinner than a cell. shapes: the shapes that the distances are of, where their edges are to be
    exact; without, they are cut off by chords.
    """
    numbers, starts, which = pairs_of(near, block.shape)
    cells = np.column_stack(np.unravel_index(numbers, block.shape)).astype(np.int32)
    cut = CutPairs(cells, numbers, starts, which, np.empty((len(which), 7)), np.empty((len(numbers), 7)))
    removed, whole = np.zeros(len(numbers), np.int64), np.full(len(numbers), np.nan)
    for a in range(0, len(numbers), BATCH):
        b = min(a + BATCH, len(numbers))
        part = slice(starts[a], starts[b])
        values, crossed = at_nodes(block, distances, cells[a:b], starts[a : b + 1], which[part], pieces, thin)
        ends = starts[a : b + 1] - starts[a]
        if thin:
            cut_off_nodes(ends, values, crossed, pieces, removed[a:b])
            rejoin(distances, block.planes, cells[a:b], ends, which[part], values, pieces, removed[a:b])
            if shapes is not None:
                _rejoin_at_edges(block, shapes, cut, a + np.flatnonzero(removed[a:b]), removed, pieces)
        cut_cells(ends, values, removed[a:b], pieces, cut.covered[part], cut.opened[a:b])
        if shapes is not None:
            _cut_edges(block, shapes, cut, np.arange(a, b), removed[a:b], whole, pieces)
            if pieces > 1:
                of_cells = cells[a:b], ends, which[part], cut.covered[part], cut.opened[a:b], removed[a:b]
                cut_balls(block, shapes, *of_cells)
    divided = np.flatnonzero(removed)
    parts = [divided[a : a + BATCH] for a in range(0, len(divided), BATCH)]
    lost = sum(_divide(block, distances, cut, removed, whole, part, pieces) for part in parts)
    if shapes is not None:
        for part in parts:
            _open_pockets(block, shapes, cut, removed, part, pieces)
    _agree(block, cut, len(distances))
    return cut._replace(divided=len(divided), lost=float(lost))


def _cut_edges(
    block: Block,
    shapes: Sequence[Shape],
    cut: CutPairs,
    cells: np.ndarray,
    removed: np.ndarray,
    whole: np.ndarray,
    pieces: int,
) -> None:
    """Cut cells again, indices (n,) ascending, near bodies of several sheets: their distances have kinks at edges.

    removed (n,): nodes that a thin wall cuts off; where it does, the faces stay, and whole[cells] is what would be open
    without (nan elsewhere).
    """
    chosen, pairs, near = _at_edges(block, shapes, cut, cells, pieces)
    if near is None:
        return
    cells, removed = cells[chosen], removed[chosen]
    cut.covered[pairs], opened = solid_shares(block, shapes, near, pieces)
    one = removed == 0
    cut.opened[cells[one]] = opened[one]
    if not one.all():
        divided = np.flatnonzero(~one)
        kept = largest_pocket(block, shapes, part_of(near, divided), removed[divided], pieces).volume
        known = ~np.isnan(kept)
        cut.opened[cells[divided[known]], 6] = kept[known]
        whole[cells[divided]] = opened[divided, 6]


def _at_edges(
    block: Block, shapes: Sequence[Shape], cut: CutPairs, cells: np.ndarray, pieces: int
) -> tuple[np.ndarray, np.ndarray, Near | None]:
    """Which of the cells (n,) are near bodies of several sheets, all their pairs, and what runs through them."""
    plain = np.array([is_plain(shape) for shape in shapes])
    counts = np.diff(cut.starts)[cells]
    ends = np.append(0, np.cumsum(counts))
    pairs = np.repeat(cut.starts[cells] - ends[:-1], counts) + np.arange(ends[-1])
    several = np.logical_or.reduceat(~plain[cut.which[pairs]], ends[:-1]) if len(cells) else np.zeros(0, bool)
    if not several.any():
        return several, pairs, None
    pairs, starts = pairs[np.repeat(several, counts)], np.append(0, np.cumsum(counts[several]))
    return several, pairs, gather(block, shapes, cut.cells[cells[several]], starts, cut.which[pairs], pieces)


def _rejoin_at_edges(
    block: Block, shapes: Sequence[Shape], cut: CutPairs, cells: np.ndarray, removed: np.ndarray, pieces: int
) -> None:
    """Take back what was removed from cells (n,) whose open parts hang together around the edge of a body."""
    chosen, _, near = _at_edges(block, shapes, cut, cells, pieces)
    if near is not None:
        cells = cells[chosen]
        removed[cells[largest_pocket(block, shapes, near, removed[cells], pieces).whole]] = 0


def _agree(block: Block, cut: CutPairs, shapes: int) -> None:
    """Give a face the share that its lower cell sees: the upper one may sum the same parts in another order."""
    key = np.repeat(cut.numbers, np.diff(cut.starts)) * shapes + cut.which
    at = np.repeat(cut.cells, np.diff(cut.starts), axis=0)
    _, ny, nz = block.shape
    for axis, step in enumerate((ny * nz, nz, 1)):
        lower = np.flatnonzero(at[:, axis] < block.shape[axis] - 1)
        upper = np.minimum(np.searchsorted(key, key[lower] + step * shapes), max(len(key) - 1, 0))
        both = key[upper] == key[lower] + step * shapes
        cut.covered[upper[both], 2 * axis] = cut.covered[lower[both], 2 * axis + 1]


def at_nodes(
    block: Block,
    distances: list[Distance],
    cells: np.ndarray,
    starts: np.ndarray,
    which: np.ndarray,
    pieces: int,
    thin: bool,
) -> tuple[np.ndarray, np.ndarray | None]:
    """Distances (p, (pieces + 1)^3) at the nodes of pairs, and their edges crossed by thin walls where asked for.

    cells (c, 3); starts (c + 1,) may begin anywhere; which (p,).
    """
    nodes = (pieces + 1) ** 3
    of_pair = np.repeat(np.arange(len(cells)), np.diff(starts))
    values = np.empty((len(which), nodes))
    crossed = np.zeros((len(which), 3, nodes), bool) if thin else None
    for b in np.unique(which):
        mine = which == b
        here = cells[of_pair[mine]]
        values[mine] = d = node_distances(distances[b], block.planes, here, pieces)
        if thin:
            crossed[mine] = crossed_edges(distances[b], block.planes, here, d, pieces)
    return values, crossed


def _divide(
    block: Block,
    distances: list[Distance],
    cut: CutPairs,
    removed: np.ndarray,
    whole: np.ndarray,
    divided: np.ndarray,
    pieces: int,
) -> float:
    """Faces of the cells numbered `divided` in cut; returns the open volume [length3] that they lost.

    whole (c,): their open shares without walls, nan where not known yet.
    """
    counts = cut.starts[divided + 1] - cut.starts[divided]
    ends = np.append(0, np.cumsum(counts))
    pairs = np.repeat(cut.starts[divided] - ends[:-1], counts) + np.arange(ends[-1])
    cells, opened = cut.cells[divided], cut.opened[divided]
    values, _ = at_nodes(block, distances, cells, ends, cut.which[pairs], pieces, False)
    beyond = np.stack([_across(block, cut, removed, cells, face) for face in range(6)], axis=1)
    close_divided_faces(ends, values, removed[divided], beyond, pieces, opened)
    cut.opened[divided] = opened
    undivided, alone = np.empty_like(opened), np.empty((len(pairs), 7))
    cut_cells(ends, values, np.zeros(len(divided), np.int64), pieces, alone, undivided)
    before = np.where(np.isnan(whole[divided]), undivided[:, 6], whole[divided])
    return float(((before - opened[:, 6]) * cell_volumes(block)[tuple(cells.T)]).sum())


def _open_pockets(
    block: Block, shapes: Sequence[Shape], cut: CutPairs, removed: np.ndarray, divided: np.ndarray, pieces: int
) -> None:
    """Faces of the cells numbered `divided` in cut, where planes divide them: what the pockets of both cells have.

    Cells beside them are looked at too: a corner of one in which no node lies may be behind the wall.
    """
    beside = [_beside(block, cut, cut.cells[divided], face) for face in range(6)]
    every = np.unique(np.concatenate([divided, *beside]))
    every = every[every >= 0]
    chosen, _, near = _at_edges(block, shapes, cut, every, pieces)
    if near is None:
        return
    cells = every[chosen]
    pockets = largest_pocket(block, shapes, near, removed[cells], pieces)
    parts = pocket_faces(block, shapes, near, pockets, pieces)
    known = {int(c): n for n, c in enumerate(cells) if not np.isnan(pockets.volume[n])}
    for row, c in enumerate(divided):
        if int(c) not in known:
            continue
        for face, own in enumerate(parts[known[int(c)]]):
            other = int(beside[face][row])
            if other in known:
                cut.opened[c, face] = in_both(own, parts[known[other]][face + 1 - 2 * (face % 2)])
            elif other < 0 or removed[other] == 0:  # there the whole face is one with the cell behind it
                cut.opened[c, face] = in_both(own, own)


def _beside(block: Block, cut: CutPairs, cells: np.ndarray, face: int) -> np.ndarray:
    """Numbers (n,) in cut of the neighbours across one face of cells (n, 3); -1 where nothing is near, or beyond the
    domain."""
    there = cells.astype(np.int64)
    there[:, face // 2] += 2 * (face % 2) - 1
    inside = ((there >= 0) & (there < block.shape)).all(axis=1)
    number = np.ravel_multi_index(np.where(inside[:, None], there, 0).T, block.shape)
    at = np.minimum(np.searchsorted(cut.numbers, number), len(cut.numbers) - 1)
    return np.where(inside & (cut.numbers[at] == number), at, -1)


def _across(block: Block, cut: CutPairs, removed: np.ndarray, cells: np.ndarray, face: int) -> np.ndarray:
    """Removed nodes (n,) of the neighbours across one face of cells (n, 3); none beyond the domain."""
    at = _beside(block, cut, cells, face)
    return np.where(at >= 0, removed[at], 0)


def cell_volumes(block: Block) -> np.ndarray:
    """Volumes [length3] of the cells without ghosts."""
    dx, dy, dz = (np.diff(x) for x in block.planes)
    return dx[:, None, None] * dy[:, None] * dz
