"""Liquid at the start: up to a height, of a given volume with a level surface, and regions that add or take away.

F = liquid volume / open volume of each cell, 0 in closed ones. Planes are cut exactly, also where they meet solids or
each other; smooth surfaces nearly so (cell_parts.py: error of the third order or better). A level surface of given
volume is found on these exact volumes: they rise with the height, so a bracket closes on it.

Regions act in their order. A height or a volume is the region before the first.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from flowgmo.flow.cut_pairs import BATCH, at_nodes, cell_volumes
from flowgmo.flow.fields import G, Open
from flowgmo.flow.fractions import mirror_ghosts
from flowgmo.flow.liquid_cells import fill_boxes, liquid_shares, shares_below
from flowgmo.flow.near_surface import Shape, near_cells, pairs_of
from flowgmo.mesh import Block

CLOSED = 4e-16  # of the bracket: where the search for a height ends, two units in the last place
FULL = 1e-12  # of the open volume: a wanted volume larger by less than this is all of it, rounding of its sum


@dataclass(frozen=True)
class Level:
    """The half-space  up . x < height;  up (3,) of unit length."""

    up: np.ndarray
    height: float

    def distance(self, x: np.ndarray) -> np.ndarray:
        return x @ self.up - self.height

    def bounds(self) -> np.ndarray:
        high = np.where(self.up == 1.0, self.height, np.inf)
        return np.array([np.where(self.up == -1.0, -self.height, -np.inf), high])


@dataclass(frozen=True)
class Region:
    """Liquid that is put in (adds) or taken away where `shape` is; `fraction` of the volume [-] is liquid there."""

    shape: Shape
    adds: bool = True
    fraction: float = 1.0


def initial_liquid(
    block: Block,
    open_: Open,
    solids: Sequence[Shape] = (),
    regions: Sequence[Region] = (),
    height: float | None = None,
    volume: float | None = None,
    gravity: Sequence[float] = (0.0, 0.0, -1.0),
    pieces: int = 2,
) -> np.ndarray:
    """F with ghosts, mirrored: up to z = height, or `volume` [length3] with a surface across gravity, then the regions.

    open_, solids: what open_fractions made, and the shapes it was made of. gravity (3,): any length, not zero.
    Raises ValueError when `volume` is more than the open volume.
    """
    first: list[Region] = []
    if volume is not None:
        up = -np.asarray(gravity, float) / np.linalg.norm(gravity)
        first = [Region(level_of_volume(block, open_, solids, volume, up, pieces))]
    elif height is not None:
        first = [Region(Level(np.array([0.0, 0.0, 1.0]), float(height)))]
    return fill(block, open_, solids, [*first, *regions], pieces)


def fill(block: Block, open_: Open, solids: Sequence[Shape], regions: Sequence[Region], pieces: int = 2) -> np.ndarray:
    """F with ghosts, mirrored, of regions in their order."""
    F = np.zeros(tuple(n + 2 * G for n in block.shape))
    last = np.full(F.shape, -1, np.int16)
    near = []
    for number, region in enumerate(regions):
        found = near_cells(region.shape.distance, block.planes, region.shape.bounds())
        fill_boxes(found.inside, F, last, region.fraction if region.adds else 0.0, number)
        near.append(found.cells)
    open_cells = [_open(cells, open_) for cells in near]
    lists = [cells[last[tuple(cells.T + G)] < number] for number, cells in enumerate(open_cells)]
    numbers, starts, which = pairs_of(lists, block.shape)
    fractions = np.array([r.fraction if r.adds else 0.0 for r in regions])
    shapes = [r.shape.distance for r in regions]
    near_solids = _near_solids(block, solids, open_)
    for a in range(0, len(numbers), BATCH):
        batch = numbers[a : a + BATCH]
        ends = starts[a : a + BATCH + 1]
        cells, part = _cells(block, batch), slice(ends[0], ends[-1])
        values, _ = at_nodes(block, shapes, cells, ends, which[part], pieces, False)
        at = tuple(cells.T + G)
        out = np.empty(len(cells))
        solid_starts, solid_values = _solid_values(block, solids, near_solids, batch, pieces)
        liquid_shares(ends - ends[0], values, fractions[which[part]], F[at], solid_starts, solid_values, pieces, out)
        F[at] = out
    if open_.V is not None:
        F[open_.V == 0.0] = 0.0
    mirror_ghosts(F, -1)
    return F


def level_of_volume(
    block: Block, open_: Open, solids: Sequence[Shape], volume: float, up: np.ndarray, pieces: int = 2
) -> Level:
    """The plane across `up` (3,), of unit length, below which the open volume is `volume` [length3]."""
    room = cell_volumes(block) * (1.0 if open_.V is None else open_.V[G:-G, G:-G, G:-G])
    total = room.sum()
    if volume > total * (1.0 + FULL):
        raise ValueError(f"a volume of {volume:.6g} does not fit into the open volume, which is {total:.6g}")
    middle, half = _heights(block, up)
    bottom, top = middle - half, middle + half
    if volume >= total * (1.0 - FULL) or volume <= 0.0:
        return Level(up, float(top.max() if volume > 0.0 else bottom.min()))
    low, high = _bracket(bottom, top, room, volume)
    between = (bottom < high) & (top > low) & (room > 0.0)
    cells = np.argwhere(between)
    below = room[(top <= low)].sum()
    corner = np.column_stack([x[cells[:, k]] for k, x in enumerate(block.planes)])
    size = np.column_stack([np.diff(x)[cells[:, k]] for k, x in enumerate(block.planes)])
    numbers = np.ravel_multi_index(cells.T, block.shape)
    starts, values = _solid_values(block, solids, _near_solids(block, solids, open_), numbers, pieces)
    F, amount = np.empty(len(cells)), room[between]

    def missing(t: float) -> float:
        shares_below(corner, size, up, low + t * (high - low), starts, values, pieces, F)
        return (below + (F * amount).sum() - volume) / total

    t = brentq(missing, 0.0, 1.0, xtol=CLOSED, rtol=CLOSED * 4) if missing(0.0) < 0.0 < missing(1.0) else None
    if t is None:
        t = 0.0 if missing(0.0) >= 0.0 else 1.0
    return Level(up, float(low + t * (high - low)))


def _heights(block: Block, up: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Height up . x of the middle of each cell, and half the height that it spans."""
    x, y, z = (0.5 * (p[1:] + p[:-1]) for p in block.planes)
    dx, dy, dz = (0.5 * np.diff(p) for p in block.planes)
    middle = up[0] * x[:, None, None] + up[1] * y[:, None] + up[2] * z
    half = abs(up[0]) * dx[:, None, None] + abs(up[1]) * dy[:, None] + abs(up[2]) * dz
    return middle, half


def _bracket(bottom: np.ndarray, top: np.ndarray, room: np.ndarray, volume: float) -> tuple[float, float]:
    """Heights between which the surface lies: below the lower one all cells that it reaches hold at most `volume`, the
    cells wholly below the upper one hold at least that. Found by bisection over the heights that occur."""
    ends = []
    for edges, wanted in ((bottom, 0), (top, 1)):
        order = np.unique(edges[room > 0.0])
        a, b = 0, len(order) - 1
        while b - a > 1:
            c = (a + b) // 2
            held = room[edges < order[c]].sum() if wanted == 0 else room[edges <= order[c]].sum()
            below = held <= volume if wanted == 0 else held < volume
            a, b = (c, b) if below else (a, c)
        ends.append(order[a] if wanted == 0 else order[b])
    return float(ends[0]), float(ends[1])


def _cells(block: Block, numbers: np.ndarray) -> np.ndarray:
    return np.column_stack(np.unravel_index(numbers, block.shape)).astype(np.int32)


def _open(cells: np.ndarray, open_: Open) -> np.ndarray:
    """Those of the cells (n, 3) that are not closed."""
    return cells if open_.V is None else cells[open_.V[tuple(cells.T + G)] > 0.0]


def _near_solids(block: Block, solids: Sequence[Shape], open_: Open) -> list[np.ndarray]:
    """Numbers of the open cells near each solid."""
    near = [_open(near_cells(s.distance, block.planes, s.bounds()).cells, open_) for s in solids]
    return [np.ravel_multi_index(cells.T.astype(np.int64), block.shape) for cells in near]


def _solid_values(
    block: Block, solids: Sequence[Shape], near: list[np.ndarray], numbers: np.ndarray, pieces: int
) -> tuple[np.ndarray, np.ndarray]:
    """First pair of each of the cells `numbers` (ascending) and one past the last, and distances of solids near them at
    their nodes (q, nodes)."""
    lists = [_cells(block, np.intersect1d(numbers, n, assume_unique=True)) for n in near]
    which_cells, starts, which = pairs_of(lists, block.shape)
    counts = np.zeros(len(numbers) + 1, np.int64)
    counts[np.searchsorted(numbers, which_cells) + 1] = np.diff(starts)
    distances = [s.distance for s in solids]
    values, _ = at_nodes(block, distances, _cells(block, which_cells), starts, which, pieces, False)
    return np.cumsum(counts), values
