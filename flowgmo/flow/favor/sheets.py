"""Which sheets of which body run through which cell, and their values at its nodes.

A body may say of which smooth sheets its surface is made (planes n . x = h, and curved ones by their distance, each in
a box beyond which it carries no surface). One that does not is one curved sheet itself, where its distance is negative,
and as exact as that is smooth. A mesh whose facets stand for a curved surface may have many planes in one cell: from
MOST_PLANES on its distance says as much, and costs less.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flowgmo.flow.favor.near_surface import TOUCHING, Shape, node_distances, node_planes
from flowgmo.mesh import Block

MANY = 32  # planes: fewer are compared with all cells, which is less work than lists, and are no curved surface
MOST_PLANES = 5  # of a mesh in a cell: as many as can be told apart at once (cut_cell.MOST_FIELDS)
ALIKE = 1e6  # two planes of a mesh are counted as one when normals and distances (in cells) agree to 1 / this


class Rows(NamedTuple):
    """Sheets of one body in cells: cell (p,) index into the cells asked for, ascending; values (p, nodes) [length];
    flat (p,) planes; alone (p,): the body is where this sheet is negative, else its distance has to be asked."""

    cell: np.ndarray
    values: np.ndarray
    flat: np.ndarray
    alone: np.ndarray


def is_plain(shape: Shape) -> bool:
    """Whether one sheet, its own distance, is all there is to a shape."""
    sheets = getattr(shape, "sheets", None)
    return sheets is None or sheets.single


def rows_of(shape: Shape, block: Block, cells: np.ndarray, pieces: int) -> Rows:
    """All sheets of a shape that change sign in cells (n, 3); those that are alone also where they do not."""
    if is_plain(shape):
        sheets = getattr(shape, "sheets", None)
        every = np.arange(len(cells))
        values = node_distances(shape.distance, block.planes, cells, pieces)
        flat = np.full(len(cells), sheets is not None and len(sheets.h) == 1)
        return Rows(every, values, flat, np.ones(len(cells), bool))
    low, high = (np.column_stack([x[cells[:, k] + e] for k, x in enumerate(block.planes)]) for e in (0, 1))
    found = [_planes(shape.sheets, block, cells, low, high, pieces)]
    crowded = _crowded(found[0], shape.sheets, low, high, len(cells))
    found[0] = [a[~crowded[found[0][0]]] for a in found[0][:2]]
    parts = [(found[0][0], found[0][1], True, False)]
    for distance, a, b in zip(shape.sheets.curved, shape.sheets.curved_low, shape.sheets.curved_high, strict=True):
        near = np.flatnonzero((low <= b).all(axis=1) & (high >= a).all(axis=1) & ~crowded)
        values = node_distances(distance, block.planes, cells[near], pieces)
        cut = (values.min(axis=1) < 0.0) & (values.max(axis=1) > 0.0)
        parts.append((near[cut], values[cut], False, False))
    if crowded.any():
        near = np.flatnonzero(crowded)
        parts.append((near, node_distances(shape.distance, block.planes, cells[near], pieces), False, True))
    cell = np.concatenate([p[0] for p in parts])
    order = np.argsort(cell, kind="stable")
    values = np.concatenate([p[1] for p in parts])[order]
    flat, alone = (np.concatenate([np.full(len(p[0]), p[k]) for p in parts])[order] for k in (2, 3))
    return Rows(cell[order], values, flat, alone)


def faces_on_sheets(shape: Shape, block: Block, cells: np.ndarray) -> np.ndarray:
    """Faces (n, 6) of cells, lower x, upper x, ..., in whose plane a plane of the shape lies."""
    found = np.zeros((len(cells), 6), bool)
    if is_plain(shape):
        return found
    n, h = shape.sheets.n, shape.sheets.h
    smallest = min(np.diff(x).min() for x in block.planes)
    for axis, x in enumerate(block.planes):
        others = np.delete(np.abs(n), axis, axis=1).max(axis=1, initial=0.0)
        across = np.unique((h * np.sign(n[:, axis]))[others <= TOUCHING])
        at = np.minimum(np.searchsorted(across, x - TOUCHING * smallest), len(across) - 1)
        on = np.abs(across[at] - x) <= TOUCHING * smallest if len(across) else np.zeros(len(x), bool)
        found[:, 2 * axis] = on[cells[:, axis]]
        found[:, 2 * axis + 1] = on[cells[:, axis] + 1]
    return found


def _planes(sheets: object, block: Block, cells: np.ndarray, low: np.ndarray, high: np.ndarray, pieces: int) -> list:
    """Cell (p,), values (p, nodes) and number (p,) of the planes that cut cells in their boxes."""
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    cell, plane = _overlaps(sheets, block, cells, low, high)
    n = sheets.n[plane]
    reach = (np.abs(n) * half[cell]).sum(axis=1)
    near = np.abs((n * middle[cell]).sum(axis=1) - sheets.h[plane]) < reach
    cell, plane = cell[near], plane[near]
    fine = node_planes(block.planes, pieces)
    local = np.indices((pieces + 1,) * 3).reshape(3, -1)
    values = np.repeat(-sheets.h[plane, None], local.shape[1], axis=1)
    for axis in range(3):
        values += sheets.n[plane, axis, None] * fine[axis][pieces * cells[cell, axis, None] + local[axis]]
    smallest = min(np.diff(x).min() for x in block.planes)
    values[np.abs(values) <= TOUCHING * smallest] = 0.0
    cut = (values.min(axis=1) < 0.0) & (values.max(axis=1) > 0.0)
    return [cell[cut], values[cut], plane[cut]]


def _overlaps(
    sheets: object, block: Block, cells: np.ndarray, low: np.ndarray, high: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Pairs (cell, plane) whose boxes touch, by cell and then plane."""
    if len(sheets.h) <= MANY:
        touch = (low[:, None] <= sheets.high).all(axis=2) & (high[:, None] >= sheets.low).all(axis=2)
        return np.nonzero(touch)
    shape = block.shape
    numbers = np.ravel_multi_index(cells.T.astype(np.int64), shape)
    first = np.column_stack(
        [np.searchsorted(x, a, "left") - 1 for x, a in zip(block.planes, sheets.low.T, strict=True)]
    )
    last = np.column_stack([np.searchsorted(x, a, "right") for x, a in zip(block.planes, sheets.high.T, strict=True)])
    first, last = np.clip(first, 0, None), np.minimum(last, shape)
    count = np.clip(last - first, 0, None)
    total = count.prod(axis=1)
    plane = np.repeat(np.arange(len(total)), total)
    at = np.arange(len(plane)) - np.repeat(np.cumsum(total) - total, total)
    i, rest = np.divmod(at, (count[:, 1] * count[:, 2])[plane])
    j, k = np.divmod(rest, count[plane, 2])
    number = np.ravel_multi_index((first[plane] + np.column_stack([i, j, k])).T, shape)
    cell = np.minimum(np.searchsorted(numbers, number), max(len(numbers) - 1, 0))
    known = numbers[cell] == number if len(numbers) else np.zeros(len(number), bool)
    cell, plane = cell[known], plane[known]
    order = np.lexsort((plane, cell))
    return cell[order], plane[order]


def _crowded(found: list, sheets: object, low: np.ndarray, high: np.ndarray, cells: int) -> np.ndarray:
    """Cells (n,) with more than MOST_PLANES different planes of a shape."""
    if len(sheets.h) <= MANY:
        return np.zeros(cells, bool)
    cell, _, plane = found
    n = sheets.n[plane]
    size = np.linalg.norm(high[cell] - low[cell], axis=1)
    away = ((n * 0.5 * (low[cell] + high[cell])).sum(axis=1) - sheets.h[plane]) / size
    side = np.sign(n[np.arange(len(n)), np.abs(n).argmax(axis=1)])[:, None]
    rows = np.round(np.column_stack([n, away]) * side * ALIKE)
    different = np.unique(np.column_stack([cell, rows]), axis=0)[:, 0].astype(np.int64)
    return np.bincount(different, minlength=cells) > MOST_PLANES
