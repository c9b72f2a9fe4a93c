"""Where straight lines of one direction cross a triangle mesh: look at its shadow along that direction.

inside the shadow of a triangle:  all three signed areas have one sign;  they are the weights of its corners' heights
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flowgmo.geometry.boxes_tree import BoxTree
from flowgmo.geometry.transform import rotation

ASKEW = rotation((33.7, 21.3, 47.9))  # no round angle, so that no usual face or edge is seen end on
SKEW = ASKEW[:, 0]


@dataclass(frozen=True, eq=False)
class Shadow:
    """Triangles' corners across (f,3,2) and along (f,3) a direction d (3,), and a tree of the former."""

    d: np.ndarray
    across: np.ndarray
    flat: np.ndarray
    along: np.ndarray
    tree: BoxTree

    @staticmethod
    def of(corners: np.ndarray, d: np.ndarray) -> Shadow:
        """The shadow of triangles (f,3,3)."""
        across = np.linalg.svd(d[None])[2][1:]
        flat = corners @ across.T
        return Shadow(d, across, flat, corners @ d, BoxTree.over(flat.min(1), flat.max(1)))

    def crossings(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Line (m,) and parameter t (m,) of every crossing of the lines x (n,3) + t d."""
        points = x @ self.across.T
        line, face = self.tree.holding(points)
        a, b, c = self.flat[face].transpose(1, 0, 2) - points[line]
        wa, wb, wc = _cross(b, c), _cross(c, a), _cross(a, b)
        total = wa + wb + wc
        hit = ((wa >= 0) & (wb >= 0) & (wc >= 0) | (wa <= 0) & (wb <= 0) & (wc <= 0)) & (total != 0)
        weights = np.stack([wa, wb, wc], 1)[hit] / total[hit, None]
        line = line[hit]
        height = (weights * self.along[face[hit]]).sum(1) - x[line] @ self.d
        return line, height / (self.d @ self.d)


def _cross(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    return u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]


def padded(row: np.ndarray, value: np.ndarray, rows: int) -> np.ndarray:
    """Values gathered by row into a table (rows, most), NaN where a row has fewer."""
    order = np.argsort(row, kind="stable")
    row, value = row[order], value[order]
    count = np.bincount(row, minlength=rows)
    table = np.full((rows, count.max(initial=0)), np.nan)
    table[row, np.arange(len(row)) - np.r_[0, np.cumsum(count)[:-1]][row]] = value
    return table
