"""Continuative and outflow sides of liquid that is shut in otherwise: they let out what has to go.

What such a side lets out is found from the flow inside before the pressure is known (boundary.let_out), and does not
add up with what comes in elsewhere. Where no free surface and no pressure side can take the difference Q of a region,

    u_out += Q / A      on all its faces on such sides, A their open area

is the change that makes it fit with the least kinetic energy.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.boundary import Sides
from flowgmo.flow.fields import G, Grid, Open
from flowgmo.mesh import CONTINUATIVE, OUTFLOW

Array = np.ndarray


class Exits:
    """Faces of a scene's continuative and outflow sides.

    Of each side: direction, layers of its faces and of the cells inside, sign of the velocity that leaves, areas
    [length2] of open faces; region: number of each cell's region, None: all are of region 0.
    """

    def __init__(self, grid: Grid, openings: Open, sides: Sides, region: Array | None) -> None:
        self.region = region
        self.sides = []
        for number, plan in enumerate(sides.plans):
            d, upper = divmod(number, 2)
            n = len(grid[d]) - 2 * G
            if plan.kind not in (CONTINUATIVE, OUTFLOW) or n == 1:
                continue
            face, cell = (n + G - 1, n + G - 1) if upper else (G - 1, G)
            area = np.multiply.outer(*(grid[e][G:-G] for e in range(3) if e != d))
            A = openings[1 + d]
            if A is not None:
                area = area * _layer(A, d, face)
            self.sides.append((d, face, cell, 1.0 if upper else -1.0, area))

    def let_out(self, surplus: Array, velocity: list, right: Array) -> Array:
        """Change velocity on the exits of each region so that its `surplus` (n,) [length3/time] leaves, and `right`,
        the net inflow of the cells inside, accordingly; returns the surplus of regions that have no exit."""
        area = np.zeros(len(surplus))
        for side in self.sides:
            area += np.bincount(self._regions(side), weights=side[4].ravel(), minlength=len(surplus))
        faster = np.divide(surplus, area, out=np.zeros(len(surplus)), where=area > 0.0)
        for side in self.sides:
            d, face, cell, sign, of_face = side
            change = faster[self._regions(side)].reshape(of_face.shape)
            _layer(velocity[d], d, face)[of_face > 0.0] += sign * change[of_face > 0.0]
            _layer(right, d, cell)[...] -= change * of_face
        return np.where(area > 0.0, 0.0, surplus)

    def _regions(self, side: tuple) -> Array:
        """(m,): the region of each face of a side; closed faces, which have no area, count as of region 0."""
        if self.region is None:
            return np.zeros(side[4].size, np.intp)
        return np.maximum(_layer(self.region, side[0], side[2]), 0).ravel().astype(np.intp)


def _layer(a: Array, d: int, k: int) -> Array:
    """The real cells' part of layer k along d, a view."""
    inside = [slice(G, -G)] * 3
    inside[d] = k
    return a[tuple(inside)]
