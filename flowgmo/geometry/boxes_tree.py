"""A binary tree of boxes over boxes, walked level by level for many points at once.

    keep (point, node) while  distance(point, box of node) <= best upper bound of the point so far

Source  Ericson 2005, chapter 6.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class BoxTree:
    """Level k holds 2^k nodes: lo, hi (2^k, d); leaves are single items, `item` (2^depth,), -1 where there is none."""

    lo: tuple[np.ndarray, ...]
    hi: tuple[np.ndarray, ...]
    item: np.ndarray

    @staticmethod
    def over(lo: np.ndarray, hi: np.ndarray) -> BoxTree:
        """The tree of boxes lo, hi (f,d), halved along the longest side at the median."""
        depth = max(0, int(np.ceil(np.log2(len(lo)))))
        order, middle = np.arange(len(lo))[None], (lo + hi) / 2
        padding = (1 << depth) - len(lo)
        order = np.pad(order, ((0, 0), (0, padding)), constant_values=-1)
        for _ in range(depth):
            known = order >= 0
            where = np.where(known[..., None], middle[order], np.nan)
            with np.errstate(invalid="ignore"):
                spread = np.where(known[..., None], where, -np.inf).max(1) - np.where(
                    known[..., None], where, np.inf
                ).min(1)
            axis = np.nan_to_num(spread, nan=-1.0, neginf=-1.0).argmax(1)
            key = np.take_along_axis(where, axis[:, None, None], 2)[..., 0]
            order = np.take_along_axis(order, np.argsort(key, axis=1, kind="stable"), 1)  # NaN, no item, sorts last
            order = order.reshape(2 * len(order), -1)
        item = order[:, 0]
        known = (item >= 0)[:, None]
        los, his = [np.where(known, lo[item], np.inf)], [np.where(known, hi[item], -np.inf)]
        for _ in range(depth):
            los.append(np.minimum(los[-1][0::2], los[-1][1::2]))
            his.append(np.maximum(his[-1][0::2], his[-1][1::2]))
        return BoxTree(tuple(los[::-1]), tuple(his[::-1]), item)

    def near(self, x: np.ndarray, sample: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Pairs (point, item) that hold the nearest item of every point x (n,d); sample (f,d): a point of each item."""
        best = self._first_guess(x, sample)
        point, node = np.arange(len(x)), np.zeros(len(x), int)
        for level in range(len(self.lo)):
            if level:
                point, node = np.repeat(point, 2), np.stack([2 * node, 2 * node + 1], 1).ravel()
            lo, hi = self.lo[level][node], self.hi[level][node]
            p = x[point]
            gap = np.maximum(np.maximum(lo - p, p - hi), 0)
            far = np.where(np.isfinite(lo), np.maximum(np.abs(lo - p), np.abs(hi - p)), np.inf)
            np.minimum.at(best, point, (far * far).sum(1))
            keep = (gap * gap).sum(1) <= best[point] * (1 + 1e-12)  # rounding of the squares
            point, node = point[keep], node[keep]
        return point, self.item[node]

    def _first_guess(self, x: np.ndarray, sample: np.ndarray) -> np.ndarray:
        """Upper bound (n,) of the squared distance: go down into the nearer half each time."""
        node = np.zeros(len(x), int)
        for lo, hi in zip(self.lo[1:], self.hi[1:], strict=True):
            gaps = [(np.maximum(np.maximum(lo[k] - x, x - hi[k]), 0) ** 2).sum(1) for k in (2 * node, 2 * node + 1)]
            node = 2 * node + (gaps[1] < gaps[0])
        return ((x - sample[self.item[node]]) ** 2).sum(1)

    def holding(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Pairs (point, item) whose box holds the point x (n,d)."""
        point, node = np.arange(len(x)), np.zeros(len(x), int)
        for level in range(len(self.lo)):
            if level:
                point, node = np.repeat(point, 2), np.stack([2 * node, 2 * node + 1], 1).ravel()
            p = x[point]
            keep = ((p >= self.lo[level][node]) & (p <= self.hi[level][node])).all(1)
            point, node = point[keep], node[keep]
        return point, self.item[node]
