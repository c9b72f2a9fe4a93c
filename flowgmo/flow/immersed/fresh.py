"""What a body uncovers in a step has a history only in its surroundings.

A cell that was closed and opens takes the mean fraction of the open cells around it, a face the mean velocity of the
open faces of the same component: the liquid that will be there comes from beside, not out of the body. Neither counts
as liquid yet, since the cell's open volume is still nothing.
"""

from __future__ import annotations

import numpy as np

AROUND = [(i, j, k) for i in (-1, 0, 1) for j in (-1, 0, 1) for k in (-1, 0, 1) if (i, j, k) != (0, 0, 0)]


def mean_around(a: np.ndarray, weight: np.ndarray, cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Means (n,) of a over the 26 places around cells (n, 3) by weight (mesh), and the sums (n,) of the weights."""
    total, sums = np.zeros(len(cells)), np.zeros(len(cells))
    for step in AROUND:
        at = tuple(np.minimum(np.maximum(cells[:, e] + step[e], 0), a.shape[e] - 1) for e in range(3))
        near = weight[at] / (abs(step[0]) + abs(step[1]) + abs(step[2]))
        total += near * a[at]
        sums += near
    return total / np.where(sums > 0.0, sums, 1.0), sums
