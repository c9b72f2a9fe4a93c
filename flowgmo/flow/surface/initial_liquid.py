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

from flowgmo.flow.favor.cut_pairs import BATCH, cell_volumes
from flowgmo.flow.favor.fractions import mirror_ghosts
from flowgmo.flow.favor.near_surface import Shape, near_cells
from flowgmo.flow.fields import G, Open
from flowgmo.flow.surface.liquid_cells import OpenParts, fill_boxes, liquid_in_cells, near_bodies
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
    lists = [_open(cells, open_) for cells in near]
    lists = [_numbers(block, cells[last[tuple(cells.T + G)] < number]) for number, cells in enumerate(lists)]
    every = np.unique(np.concatenate([*lists, np.zeros(0, np.int64)]))
    lists = [*_near_solids(block, solids, open_), *lists]
    fractions = np.array([r.fraction if r.adds else 0.0 for r in regions])
    shapes = [*solids, *(r.shape for r in regions)]
    for a in range(0, len(every), BATCH):
        cells = _cells(block, every[a : a + BATCH])
        here, at = near_bodies(block, shapes, cells, lists, pieces), tuple(cells.T + G)
        F[at] = liquid_in_cells(block, shapes, here, len(solids), fractions, F[at], pieces)
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
    numbers = _numbers(block, cells)
    lists = _near_solids(block, solids, open_)
    rows = np.flatnonzero(np.isin(numbers, np.concatenate([*lists, np.zeros(0, np.int64)])))
    near = near_bodies(block, solids, cells[rows], lists, pieces)
    parts, amount = OpenParts.of(block, solids, cells, rows, near, pieces), room[between]

    def missing(t: float) -> float:
        return (below + (parts.below(up, low + t * (high - low)) * amount).sum() - volume) / total

    from scipy.optimize import brentq  # only scenes that ask for a level pay for loading it

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


def _numbers(block: Block, cells: np.ndarray) -> np.ndarray:
    return np.ravel_multi_index(cells.T.astype(np.int64), block.shape)


def _open(cells: np.ndarray, open_: Open) -> np.ndarray:
    """Those of the cells (n, 3) that are not closed."""
    return cells if open_.V is None else cells[open_.V[tuple(cells.T + G)] > 0.0]


def _near_solids(block: Block, solids: Sequence[Shape], open_: Open) -> list[np.ndarray]:
    """Numbers of the open cells near each solid."""
    near = [_open(near_cells(s.distance, block.planes, s.bounds()).cells, open_) for s in solids]
    return [_numbers(block, cells) for cells in near]
