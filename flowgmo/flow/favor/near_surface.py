"""The cells that a surface may pass through, and its signed distance at their nodes.

Distance is asked for where it matters only. Blocks of 16^3 cells that reach the shape's bounds are asked at their
centre; one farther from the surface than half its diagonal lies on one side of it, the others are halved, down to
single cells. So the work goes with the area of the surface. A distance that is too small costs time but hides nothing;
one that is too large (some quadrics with √(x² + y²), geometry/root_quadric.py) may hide a part of the surface.

The nodes of a cell are the (pieces + 1)^3 points that divide it into pieces^3 equal parts; index (i (pieces + 1) + j)
(pieces + 1) + k. Cells are numbered without ghosts here: 0 .. n - 1.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, Protocol

import numpy as np

LARGEST = 16  # cells along a block at the start: 3 million cells are 730 blocks
TOUCHING = 1e-12  # of a cell: distances smaller than this are rounding of a surface that runs through a node
ROUNDING = 1.0 + 1e-9  # a block is skipped when this much farther than its corners: distances are rounded

Planes = tuple[np.ndarray, np.ndarray, np.ndarray]
Distance = Callable[[np.ndarray], np.ndarray]


class Shape(Protocol):
    """What solids and liquid regions are to the mesh: signed distance, negative inside, and a box (2, 3)."""

    def distance(self, x: np.ndarray) -> np.ndarray: ...
    def bounds(self) -> np.ndarray: ...


class Pose(NamedTuple):
    """Where a shape is: x = R x0 + t, x0 the place it was given at. R (3, 3) a rotation, t (3,) [length].

    back [length]: by how much the faces `set_back` (Body.faces_towards) stand back, so that liquid reaches between them
    and what they lie on.
    """

    R: np.ndarray
    t: np.ndarray
    back: float = 0.0
    set_back: tuple[bool, ...] = ()


class Near(NamedTuple):
    """cells (n, 3) int32 that the surface may cut, in C order; inside (m, 2, 3) int32: boxes of cells, first and one
    past the last, that lie wholly inside."""

    cells: np.ndarray
    inside: np.ndarray


def placed(shape: Shape, pose: Pose | None) -> tuple[Distance, np.ndarray]:
    """Distance function and bounds (2, 3) of the shape in its pose."""
    if pose is None:
        return shape.distance, shape.bounds()
    low, high = shape.bounds()
    distance = turned(shape.distance, pose)
    if not (np.isfinite(low).all() and np.isfinite(high).all()):
        return distance, np.array([[-np.inf] * 3, [np.inf] * 3])
    middle = pose.R @ (0.5 * (low + high)) + pose.t
    half = np.abs(pose.R) @ (0.5 * (high - low))
    return distance, np.array([middle - half, middle + half])


def turned(distance: Distance, pose: Pose) -> Distance:
    """A distance given in the place at t = 0, in the pose."""
    if not any(pose.set_back):
        return lambda x: distance((x - pose.t) @ pose.R)
    return lambda x: distance((x - pose.t) @ pose.R) + pose.back


def near_cells(distance: Distance, planes: Planes, bounds: np.ndarray, box: np.ndarray | None = None) -> Near:
    """The cells in `box` (2, 3), first and one past the last, that the surface may cut; the whole mesh without."""
    first, past = reach(planes, bounds)
    if box is not None:
        first, past = np.maximum(first, box[0]), np.minimum(past, box[1])
    nothing = np.zeros((0, 2, 3), np.int32)
    if (first >= past).any():
        return Near(nothing[:, 0], nothing)
    size, inside = LARGEST, [nothing]
    counts = -((first - past) // size)
    low = first + size * np.indices(counts).reshape(3, -1).T
    while True:
        high = np.minimum(low + size, past)
        d, radius = _at_middle(distance, planes, low, high)
        near = np.abs(d) <= radius
        within = ~near & (d < 0.0)
        inside.append(np.stack([low[within], high[within]], axis=1).astype(np.int32))
        low = low[near]
        if size == 1:
            order = np.lexsort(low.T[::-1])
            return Near(low[order].astype(np.int32), np.concatenate(inside))
        size //= 2
        low = (low[:, None] + size * np.indices((2, 2, 2)).reshape(3, -1).T).reshape(-1, 3)
        low = low[(low < past).all(axis=1)]


def reach(planes: Planes, bounds: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First and one past the last cell that the bounds touch; one more at each end, whose face may lie on the body."""
    ends = [
        (max(np.searchsorted(x, a, "left") - 2, 0), min(np.searchsorted(x, b, "right") + 1, len(x) - 1))
        for x, a, b in zip(planes, bounds[0], bounds[1], strict=True)
    ]
    first, past = np.array(ends).T
    return first, past


def _at_middle(distance: Distance, planes: Planes, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Distance (n,) at the middle of blocks of cells low .. high - 1 (n, 3), and half their diagonals (n,)."""
    a = np.column_stack([x[low[:, k]] for k, x in enumerate(planes)])
    b = np.column_stack([x[high[:, k]] for k, x in enumerate(planes)])
    d = distance(0.5 * (a + b)) if len(low) else np.zeros(0)
    return d, 0.5 * ROUNDING * np.linalg.norm(b - a, axis=1)


def node_numbers(shape: tuple[int, int, int], cells: np.ndarray, pieces: int) -> np.ndarray:
    """Numbers (n, (pieces + 1)^3) of the cells' nodes in the mesh of all nodes, C order."""
    local = np.indices((pieces + 1,) * 3).reshape(3, -1)
    _, my, mz = (pieces * n + 1 for n in shape)
    at = [pieces * cells[:, axis, None].astype(np.int64) + local[axis] for axis in range(3)]
    return (at[0] * my + at[1]) * mz + at[2]


def node_planes(planes: Planes, pieces: int) -> Planes:
    """Coordinates of the nodes, each cell divided into equal parts."""
    parts = np.arange(pieces) / pieces
    return tuple(np.append((x[:-1, None] + np.diff(x)[:, None] * parts).ravel(), x[-1]) for x in planes)


def node_distances(distance: Distance, planes: Planes, cells: np.ndarray, pieces: int) -> np.ndarray:
    """Distance [length] at the nodes of cells (n, 3), shape (n, (pieces + 1)^3).

    Each node is asked for once, so that neighbours agree. A distance of rounding size is 0: the node is on the surface.
    """
    shape = tuple(len(x) - 1 for x in planes)
    numbers, where = np.unique(node_numbers(shape, cells, pieces), return_inverse=True)
    _, my, mz = (pieces * n + 1 for n in shape)
    at = np.stack([numbers // (my * mz), numbers // mz % my, numbers % mz], axis=1)
    points = np.column_stack([x[at[:, axis]] for axis, x in enumerate(node_planes(planes, pieces))])
    d = distance(points) if len(points) else np.zeros(0)
    smallest = min(np.diff(x).min() for x in planes)
    d = np.where(np.abs(d) <= TOUCHING * smallest, 0.0, d)
    return d[where].reshape(len(cells), (pieces + 1) ** 3)


def pairs_of(near: list[np.ndarray], shape: tuple[int, int, int]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Which shapes are near which cell, from their near cells (n, 3) each.

    Numbers (c,) of the cells in C order, ascending; first pair of each cell and one past the last (c + 1,); for each
    pair (p,) its shape, in the given order. Pair p of shape b is the next of b's near cells.
    """
    numbers = [np.ravel_multi_index(cells.T.astype(np.int64), shape) for cells in near]
    every = np.concatenate([*numbers, np.zeros(0, np.int64)])
    which = np.repeat(np.arange(len(near)), [len(n) for n in numbers])
    order = np.lexsort((which, every))
    cells, first = np.unique(every[order], return_index=True)
    return cells, np.append(first, len(every)), which[order]
