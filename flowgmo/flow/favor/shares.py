"""What each solid covers of the faces of open cells, so that A + sum of S = 1 whatever was cut, closed or snapped.

    S_b  =  (1 - A) s_b / sum of s           s_b the share that solid b alone covers

A face that was closed although no solid covers any of it (a sliver, a thin wall) goes to the solids of its two cells,
in proportion to the volume they cover there.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flowgmo.flow.favor.cell_parts import faces_of
from flowgmo.flow.favor.cut_pairs import CutPairs
from flowgmo.flow.fields import G, Grid


class Shares(NamedTuple):
    """Open cells that a solid touches, (n, 3) int32 [with ghosts] in C order, and the shares (n, 6) of their faces that
    it covers: lower x, upper x, lower y, upper y, lower z, upper z."""

    cells: np.ndarray
    faces: np.ndarray

    @staticmethod
    def none() -> Shares:
        return Shares(np.zeros((0, 3), np.int32), np.zeros((0, 6)))


def wall_areas(shares: Shares, grid: Grid) -> np.ndarray:
    """Wall area vectors (n, 3) [length2] of the solid in its cells, pointing into it: force = sum of p times these."""
    dx, dy, dz = grid.dx[shares.cells[:, 0]], grid.dy[shares.cells[:, 1]], grid.dz[shares.cells[:, 2]]
    difference = shares.faces[:, 1::2] - shares.faces[:, ::2]
    return difference * np.column_stack([dy * dz, dz * dx, dx * dy])


def share_out(shape: tuple[int, int, int], pairs: CutPairs, fields: tuple, solids: int) -> tuple[Shares, ...]:
    """The Shares of each solid; fields: V, Ax, Ay, Az in their final form."""
    if not len(pairs.numbers):
        return tuple(Shares.none() for _ in range(solids))
    V, *areas = fields
    of_pair = np.repeat(np.arange(len(pairs.numbers)), np.diff(pairs.starts))
    closed = np.empty((len(pairs.numbers), 6))
    faces_of(pairs.cells, *areas, closed)
    closed = 1.0 - closed
    alone = pairs.covered[:, :6]
    total = np.add.reduceat(alone, pairs.starts[:-1], axis=0)
    # what is left of 1 after all that is open: rounding of the sum may leave total at 1e-17 where nothing is covered
    scale = np.where((total > 0.0) & (closed > 0.0), closed / np.where(total > 0.0, total, 1.0), 0.0)
    rows = [(pairs.numbers[of_pair], pairs.which, alone * scale[of_pair])]
    orphans = (total == 0.0) & (closed > 0.0)
    if orphans.any():
        rows.append(_adopt(shape, pairs, orphans, closed))
    numbers, which, faces = (np.concatenate(column) for column in zip(*rows, strict=True))
    return tuple(_collect(shape, numbers[which == b], faces[which == b], V) for b in range(solids))


def _adopt(shape: tuple[int, int, int], pairs: CutPairs, orphans: np.ndarray, closed: np.ndarray) -> tuple:
    """Rows (cell number, solid, six shares) for closed faces that nobody covers, for both cells of each face."""
    weights: dict[tuple[int, int], dict[int, float]] = {}
    amount: dict[tuple[int, int], float] = {}
    steps = (shape[1] * shape[2], shape[2], 1)
    for c, face in zip(*np.nonzero(orphans), strict=True):
        axis, upper = divmod(int(face), 2)
        if pairs.cells[c, axis] == 0 and not upper:
            key = (int(pairs.numbers[c]) - steps[axis], axis + 3)  # the domain's own lower side: no cell below
        else:
            key = (int(pairs.numbers[c]) - (0 if upper else steps[axis]), axis)
        part = slice(pairs.starts[c], pairs.starts[c + 1])
        own = pairs.covered[part, 6] if pairs.covered[part, 6].sum() > 0.0 else np.ones(part.stop - part.start)
        amount[key] = closed[c, face]
        mine = weights.setdefault(key, {})
        for b, w in zip(pairs.which[part], own, strict=True):
            mine[int(b)] = mine.get(int(b), 0.0) + float(w)
    rows = []
    for (lower, axis), mine in weights.items():
        for b, w in mine.items():
            share = amount[lower, axis] * w / sum(mine.values())
            step, direction = steps[axis % 3], axis % 3
            at = np.unravel_index(max(lower, 0), shape)[direction]
            if axis < 3:
                rows.append((lower, b, 2 * direction + 1, share))
            if axis >= 3 or at < shape[direction] - 1:
                rows.append((lower + step, b, 2 * direction, share))
    faces = np.zeros((len(rows), 6))
    faces[np.arange(len(rows)), [r[2] for r in rows]] = [r[3] for r in rows]
    return np.array([r[0] for r in rows]), np.array([r[1] for r in rows]), faces


def _collect(shape: tuple[int, int, int], numbers: np.ndarray, faces: np.ndarray, V: np.ndarray) -> Shares:
    """Rows of one solid, those of one cell added up; cells that are closed or not touched are left out."""
    if not len(numbers):
        return Shares.none()
    cells, where = np.unique(numbers, return_inverse=True)
    total = np.zeros((len(cells), 6))
    np.add.at(total, where, faces)
    at = np.column_stack(np.unravel_index(cells, shape)).astype(np.int32) + np.int32(G)
    kept = (total > 0.0).any(axis=1) & (V[tuple(at.T)] > 0.0)
    return Shares(at[kept], total[kept])
