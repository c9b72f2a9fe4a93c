"""What a body uncovers in a step has a history only in its surroundings.

A cell that was closed and opens takes the mean fraction of the open cells around it, a face the mean velocity of the
open faces of the same component: the liquid that will be there comes from beside, not out of the body. Neither counts
as liquid yet, since the cell's open volume is still nothing.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.fields import G
from flowgmo.kernel import kernel


@kernel
def _sum_around(a, x, d, weight, open_or_not, edge, cells, total, sums):
    """total (n,) and sums (n,) of mean_around, in one order."""
    nx, ny, nz = weight.shape
    for c in range(len(cells)):
        for m in range(27):
            di = m // 9 - 1
            dj = m // 3 % 3 - 1
            dk = m % 3 - 1
            if m == 13:
                continue
            i = min(max(cells[c, 0] + di, edge), nx - 1 - edge)
            j = min(max(cells[c, 1] + dj, edge), ny - 1 - edge)
            k = min(max(cells[c, 2] + dk, edge), nz - 1 - edge)
            near = weight[i, j, k]
            if open_or_not:
                near = 1.0 if near > 0.0 else 0.0
            near /= abs(di) + abs(dj) + abs(dk)
            if a is not None:
                total[c] += near * a[i, j, k]
            if x is not None:
                total[c] += near * x[i if d == 0 else (j if d == 1 else k)]
            sums[c] += near


def mean_around(
    a: np.ndarray | None, weight: np.ndarray, cells: np.ndarray, *, open_or_not: bool = False,
    along: tuple[int, np.ndarray] | None = None, ghosts: bool = True,
) -> tuple[np.ndarray, np.ndarray]:  # fmt: skip
    """Means (n,) of a over the 26 places around cells (n, 3) by weight (mesh), and the sums (n,) of the weights.

    open_or_not: the weight is one wherever it is not nothing. along: in place of a, a direction and what holds there.
    ghosts: whether a has values beyond the sides; else the cells beside the sides stand for them, as in a mirror.
    """
    total, sums = np.zeros(len(cells)), np.zeros(len(cells))
    if len(cells):
        d, x = (0, None) if along is None else along
        edge = np.int64(0 if ghosts else G)
        _sum_around(a, x, d, weight, open_or_not, edge, np.ascontiguousarray(cells, np.int64), total, sums)
    return total / np.where(sums > 0.0, sums, 1.0), sums
