"""Cells in which bodies overlap each other or stationary solids: what they leave open together, cut exactly.

A flap that pierces the floor, two bodies on a common hinge: few cells, so all shapes near them are cut at once. An
overlap shows where what is covered sums to more than there is; from there it is followed through neighbouring cells
that hold more than one thing, as long as the union differs from the sum. So bodies that only rest on each other are
not cut again.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flowgmo.flow.favor.covered_cells import OVERLAP
from flowgmo.flow.favor.cut_pairs import cut_pairs
from flowgmo.flow.favor.near_surface import ROUNDING, Pose, Shape, placed, turned
from flowgmo.flow.fields import G
from flowgmo.mesh import Block

PIECES = 2  # as of stationary solids
AROUND = np.indices((3, 3, 3)).reshape(3, -1).T - 1  # a cell and its neighbours, over faces, edges and corners


class Posed:
    """A shape in a pose, with its sheets."""

    def __init__(self, shape: Shape, pose: Pose) -> None:
        self.shape, self.pose = shape, pose
        self.distance, self._bounds = placed(shape, pose)
        own = getattr(shape, "sheets", None)
        if own is not None:
            self.sheets = _turned(own, pose)

    def bounds(self) -> np.ndarray:
        return self._bounds


def _turned(own: tuple, pose: Pose) -> tuple:
    """Sheets in their pose; boxes are those that hold the turned ones."""
    R, t, back, set_back = pose
    back *= any(set_back)
    n = own.n @ R.T

    def boxes(low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        middle, half = 0.5 * (low + high) @ R.T + t, 0.5 * (high - low) @ np.abs(R).T
        return middle - half, middle + half

    curved = tuple(turned(d, pose) for d in own.curved)
    ends = (*boxes(own.low, own.high), curved, *boxes(own.curved_low, own.curved_high))
    return own._replace(n=n, h=own.h + n @ t - back, low=ends[0], high=ends[1], curved=curved, curved_low=ends[3],
                        curved_high=ends[4])  # fmt: skip


def open_together(block: Block, shapes: Sequence[Shape], cells: np.ndarray) -> np.ndarray:
    """Open shares (n, 7), six faces and volume, that all shapes leave of cells (n, 3) [with ghosts, C order]."""
    here = cells - np.int32(G)
    low, high = (np.column_stack([x[here[:, k] + e] for k, x in enumerate(block.planes)]) for e in (0, 1))
    radius = 0.5 * ROUNDING * np.linalg.norm(high - low, axis=1)
    lists = [here[shape.distance(0.5 * (low + high)) <= radius] for shape in shapes]
    cut = cut_pairs(block, [shape.distance for shape in shapes], lists, PIECES, thin=False, shapes=shapes)
    opened = np.ones((len(cells), 7))
    numbers = np.ravel_multi_index(here.T.astype(np.int64), block.shape)
    opened[np.searchsorted(numbers, cut.numbers)] = cut.opened
    return opened


def cut_overlaps(
    block: Block,
    shapes: Sequence[Shape],
    cells: np.ndarray,
    still: np.ndarray,
    total: np.ndarray,
    shared: np.ndarray,
    opened: np.ndarray,
    overlapping: np.ndarray,
) -> np.ndarray:
    """Replace opened (n, 7) by what the union of all shapes leaves, in cells that overlap; returns their indices.

    cells (n, 3) [with ghosts, C order]; still (n, 7) without bodies; total (n, 7) that bodies cover one by one; shared
    (n,): more than one thing; overlapping (n,): where the sum already shows it.
    """
    done = np.zeros(len(cells), bool)
    now = np.flatnonzero(overlapping)
    while len(now):
        together = np.minimum(open_together(block, shapes, cells[now]), still[now])
        together = np.where(total[now] > 0.0, together, still[now])
        differ = (np.abs(together - opened[now]) > OVERLAP).any(axis=1) | overlapping[now]
        opened[now] = together
        done[now] = True
        near = _neighbours(cells, now[differ], block.shape)
        now = near[shared[near] & ~done[near]]
    return np.flatnonzero(done)


def _neighbours(cells: np.ndarray, chosen: np.ndarray, shape: tuple[int, int, int]) -> np.ndarray:
    """Indices, ascending, of the cells around chosen ones (m,) that are in the list (n, 3)."""
    sizes = tuple(n + 2 * G for n in shape)
    numbers = np.ravel_multi_index(cells.T.astype(np.int64), sizes)
    around = (cells[chosen].astype(np.int64)[:, None] + AROUND).reshape(-1, 3)
    wanted = np.unique(np.ravel_multi_index(around.T, sizes))
    at = np.minimum(np.searchsorted(numbers, wanted), len(numbers) - 1)
    return at[numbers[at] == wanted]
