"""Boxes with common axes combined exactly: the cells between all their sides are either in or out.

surface = the rectangles between a cell that is in and one that is out,   |d| = distance to the nearest rectangle
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from flowgmo.geometry.moments import NOTHING, Moments
from flowgmo.geometry.primitives import Box, Mesh

CLOSE = 1e-12  # of the largest coordinate: sides that rotations moved apart by rounding are one
MANY = 40_000  # cells; above, the general rules are faster


@dataclass(frozen=True, eq=False)
class Lattice:
    """planes: sorted coordinates per axis, ends ±inf; owner (nx,ny,nz): the piece that fills a cell, -1 none."""

    planes: tuple[np.ndarray, np.ndarray, np.ndarray]
    owner: np.ndarray

    @cached_property
    def boxes(self) -> list[Box]:
        """Disjoint boxes that fill the body."""
        return [Box(*self._ends(block)) for block in merged(_blocks(self.owner >= 0))]

    def _ends(self, block: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return tuple(np.array([self.planes[k][block[k, side]] for k in range(3)]) for side in (0, 1))

    @cached_property
    def rectangles(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Axis (m,), outward sign (m,), lo (m,3), hi (m,3) of the surface, merged where flush."""
        axes, signs, ends = [], [], []
        for axis, sign, mask in self._surface():
            for block in merged(_blocks(mask)):
                axes.append(axis)
                signs.append(sign)
                block[axis] = [block[axis, 0] + 1, block[axis, 0] + 1]
                ends.append(self._ends(block))
        ends = np.array(ends).reshape(-1, 2, 3)
        return np.array(axes, int), np.array(signs), ends[:, 0], ends[:, 1]

    def _surface(self) -> list[tuple[int, float, np.ndarray]]:
        """Axis, outward sign, and the cells below one plane with an inner cell on one side, an outer on the other."""
        filled, found = self.owner >= 0, []
        for axis in range(3):
            below, above = np.moveaxis(filled, axis, 0)[:-1], np.moveaxis(filled, axis, 0)[1:]
            for sign, mask in ((1.0, below & ~above), (-1.0, above & ~below)):
                for plane in np.flatnonzero(mask.any((1, 2))):
                    only = np.zeros_like(mask)
                    only[plane] = mask[plane]
                    found.append((axis, sign, np.moveaxis(only, 0, axis)))
        return found

    def inside(self, x: np.ndarray) -> np.ndarray:
        result = np.zeros(len(x), bool)
        for side in ("left", "right"):  # a point on a plane belongs to both of its cells
            cell = [np.searchsorted(self.planes[k], x[:, k], side) - 1 for k in range(3)]
            cell = [np.clip(cell[k], 0, self.owner.shape[k] - 1) for k in range(3)]
            result |= self.owner[tuple(cell)] >= 0
        return result

    def _nearest(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        d, normal = np.full(len(x), np.inf), np.tile([0.0, 0.0, 1.0], (len(x), 1))
        sign = np.where(self.inside(x), -1.0, 1.0)
        for axis, outward, lo, hi in zip(*self.rectangles, strict=True):
            gap = x - np.clip(x, lo, hi)
            new = np.linalg.norm(gap, axis=1)
            near = new < d
            face = outward * np.eye(3)[axis]
            beside = (np.delete(gap, axis, 1) != 0).any(1) & (new > 0)
            edge = sign[:, None] * gap / np.where(new > 0, new, 1.0)[:, None]
            normal = np.where(near[:, None], np.where(beside[:, None], edge, face), normal)
            d = np.where(near, new, d)
        return sign * d, normal

    def distance(self, x: np.ndarray) -> np.ndarray:
        return self._nearest(x)[0]

    def normal(self, x: np.ndarray) -> np.ndarray:
        return self._nearest(x)[1]

    def support(self, d: np.ndarray) -> float:
        return max((box.support(d) for box in self.boxes), default=-np.inf)

    def moments(self, weights: np.ndarray | None = None) -> Moments | None:
        """Moments; weights: the density of each piece."""
        total = NOTHING
        for number in np.unique(self.owner[self.owner >= 0]):
            for block in merged(_blocks(self.owner == number)):
                own = Box(*self._ends(block)).moments()
                if own is None:
                    return None
                total = total.plus(own.times(1.0 if weights is None else weights[number]))
        return total

    def roots(self, x: np.ndarray, d: np.ndarray) -> np.ndarray:
        with np.errstate(divide="ignore", invalid="ignore"):
            t = np.hstack([(self.planes[k][1:-1] - x[:, k : k + 1]) / d[k] for k in range(3)])
        return np.where(np.isfinite(t), t, np.nan)

    def faces(self, resolution: int) -> Mesh | None:
        """One pair of triangles per cell side, so that neighbours share whole edges."""
        if not np.isfinite([self.support(e) for e in np.vstack([np.eye(3), -np.eye(3)])]).all():
            return None
        shape = np.array(self.owner.shape) + 1
        quads = []
        for axis, sign, mask in self._surface():
            base = np.argwhere(mask)
            base[:, axis] += 1
            u, v = np.eye(3, dtype=int)[[(axis + 1) % 3, (axis + 2) % 3]]
            corners = [base, base + u, base + u + v, base + v]
            number = np.stack([np.ravel_multi_index(c.T, shape) for c in corners], 1)
            quads.append(number if sign > 0 else number[:, ::-1])
        quad = np.vstack(quads)
        used, faces = np.unique(np.vstack([quad[:, [0, 1, 2]], quad[:, [0, 2, 3]]]), return_inverse=True)
        index = np.array(np.unravel_index(used, shape))
        return np.stack([self.planes[k][index[k]] for k in range(3)], 1), faces.reshape(-1, 3)

    def describe(self) -> str:
        return f"{len(self.boxes)} boxes"


def lattice_of(roles: Sequence[str], boxes: Sequence[Box]) -> Lattice | None:
    """Boxes of one frame applied in order; None when there would be too many cells."""
    ends = np.array([[box.lo, box.hi] for box in boxes])
    finite = np.abs(ends[np.isfinite(ends)])
    tol = CLOSE * finite.max(initial=0.0)
    planes = []
    for k in range(3):
        values = np.unique(ends[..., k][np.isfinite(ends[..., k])])
        values = values[np.r_[True, np.diff(values) > tol]] if len(values) else values
        planes.append(np.r_[-np.inf, values, np.inf])
    if np.prod([len(p) - 1 for p in planes]) > MANY:
        return None
    owner = np.full([len(p) - 1 for p in planes], -1)
    middles = [_middles(p) for p in planes]
    for number, (role, box) in enumerate(zip(roles, boxes, strict=True)):
        within = np.ones(owner.shape, bool)
        for k in range(3):
            shape = [-1 if j == k else 1 for j in range(3)]
            within &= ((middles[k] > box.lo[k]) & (middles[k] < box.hi[k])).reshape(shape)
        owner[within if role != "complement" else ~within] = -1 if role == "hole" else number
    return Lattice(tuple(planes), owner)


def _middles(planes: np.ndarray) -> np.ndarray:
    inner = planes[1:-1]
    if not len(inner):
        return np.zeros(1)
    size = max(np.abs(inner).max(), 1e-300)  # any point beyond the last plane will do
    return np.r_[inner[0] - size, (inner[1:] + inner[:-1]) / 2, inner[-1] + size]


def _blocks(mask: np.ndarray) -> np.ndarray:
    """Index ranges (n,3,2) of the true cells."""
    cells = np.argwhere(mask)
    return np.stack([cells, cells + 1], 2)


def merged(blocks: np.ndarray) -> np.ndarray:
    """Fewer blocks (m,3,2) that fill the same cells: runs along z, then equal runs along y, then along x."""
    for axis in (2, 1, 0):
        if not len(blocks):
            return blocks
        others = np.delete(blocks, axis, 1).reshape(len(blocks), -1)
        order = np.lexsort([blocks[:, axis, 0], *others.T])
        blocks, others = blocks[order], others[order]
        joins = (others[1:] == others[:-1]).all(1) & (blocks[1:, axis, 0] == blocks[:-1, axis, 1])
        start, end = np.r_[True, ~joins], np.r_[~joins, True]
        last = blocks[end, axis, 1]
        blocks = blocks[start].copy()
        blocks[:, axis, 1] = last
    return blocks
