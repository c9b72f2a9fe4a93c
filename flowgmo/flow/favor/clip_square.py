"""Share of a face in which several sheets are positive: the square, cut by one after the other.

As cut_cell.py has it for cells, for a polygon in the plane: every corner with f > 0 stays, and where f changes sign
between neighbours a and b there is a new corner a + (b - a) f_a / (f_a - f_b), a the one that stays. A sheet is
bilinear between the corners of the square.

Source  Sutherland & Hodgman 1974.
"""

from __future__ import annotations

import numpy as np

from flowgmo.kernel import inner

MOST = 32  # corners: a cut of a ring makes it at most half as long again, 4 x 1.5^5 = 31, as cut_cell.MOST_CORNERS


@inner
def start_square(ring):
    """The unit square about its middle, counter-clockwise; ring (2, MOST, 3): two polygons, x, y and value."""
    for v in range(4):
        ring[0, v, 0] = 0.5 if v == 1 or v == 2 else -0.5
        ring[0, v, 1] = 0.5 if v >= 2 else -0.5
    return np.int64(4)


@inner
def _between(ring, here, kept, lost, to, m):
    """Write the point between two corners of ring[here] where the value vanishes, seen from the one that stays."""
    t = ring[here, kept, 2] / (ring[here, kept, 2] - ring[here, lost, 2])
    for axis in range(2):
        ring[to, m, axis] = ring[here, kept, axis] + t * (ring[here, lost, axis] - ring[here, kept, axis])


@inner
def clip(ring, here, size, f00, f10, f11, f01):
    """Keep of polygon ring[here] with `size` corners what is positive, in the other polygon; returns its size."""
    for v in range(size):
        x = ring[here, v, 0] + 0.5
        y = ring[here, v, 1] + 0.5
        ring[here, v, 2] = (1.0 - y) * ((1.0 - x) * f00 + x * f10) + y * ((1.0 - x) * f01 + x * f11)
    to = 1 - here
    m = np.int64(0)
    for a in range(size):
        b = a + 1 if a + 1 < size else 0
        if ring[here, a, 2] > 0.0:
            if m < MOST:
                ring[to, m, 0] = ring[here, a, 0]
                ring[to, m, 1] = ring[here, a, 1]
                m += 1
            if ring[here, b, 2] <= 0.0 and m < MOST:
                _between(ring, here, a, b, to, m)
                m += 1
        elif ring[here, b, 2] > 0.0 and m < MOST:
            _between(ring, here, b, a, to, m)
            m += 1
    return m


@inner
def area_of(ring, here, size):
    """Area of polygon ring[here]."""
    twice = 0.0
    for a in range(size):
        b = a + 1 if a + 1 < size else 0
        twice += ring[here, a, 0] * ring[here, b, 1] - ring[here, b, 0] * ring[here, a, 1]
    return min(max(0.5 * twice, 0.0), 1.0)
