"""Cells in which bodies overlap each other or stationary solids: what they leave open together, cut exactly.

A flap that pierces the floor, two bodies on a common hinge: few cells, so all shapes near them are cut at once.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flowgmo.flow.favor.cut_pairs import cut_pairs
from flowgmo.flow.favor.near_surface import ROUNDING, Pose, Shape, placed
from flowgmo.flow.fields import G
from flowgmo.mesh import Block

PIECES = 2  # as of stationary solids


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
    R, t = pose
    n = own.n @ R.T

    def boxes(low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        middle, half = 0.5 * (low + high) @ R.T + t, 0.5 * (high - low) @ np.abs(R).T
        return middle - half, middle + half

    curved = tuple((lambda x, d=d: d((x - t) @ R)) for d in own.curved)
    ends = (*boxes(own.low, own.high), curved, *boxes(own.curved_low, own.curved_high))
    return own._replace(n=n, h=own.h + n @ t, low=ends[0], high=ends[1], curved=curved, curved_low=ends[3],
                        curved_high=ends[4])  # fmt: skip


def open_together(block: Block, shapes: Sequence[Shape], cells: np.ndarray) -> np.ndarray:
    """Open shares (n, 7), six faces and volume, that all shapes together leave of cells (n, 3) [with ghosts, C order]."""
    here = cells - np.int32(G)
    low, high = (np.column_stack([x[here[:, k] + e] for k, x in enumerate(block.planes)]) for e in (0, 1))
    radius = 0.5 * ROUNDING * np.linalg.norm(high - low, axis=1)
    lists = [here[shape.distance(0.5 * (low + high)) <= radius] for shape in shapes]
    cut = cut_pairs(block, [shape.distance for shape in shapes], lists, PIECES, thin=False, shapes=shapes)
    opened = np.ones((len(cells), 7))
    numbers = np.ravel_multi_index(here.T.astype(np.int64), block.shape)
    opened[np.searchsorted(numbers, cut.numbers)] = cut.opened
    return opened
