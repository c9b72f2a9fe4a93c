"""Distance of a point from a box, with the direction of growth: all that a ball needs to know about a flat."""

from __future__ import annotations

import numpy as np

from flowgmo.kernel import inner


@inner
def box_distance(x, flat):
    """Signed distance of the point x from a flat (dtype FLAT), its gradient (the outward unit normal), and the place.

    Outside exact, edges and corners included (the distance to a convex set is convex along any line); inside minus the
    depth below the nearest face. Place: 1 above a face, 2 an edge, 3 a corner.
    """
    out = np.zeros(3)
    outside = 0
    depth = np.inf
    near = 0
    sign = 1.0
    for i in range(3):
        y = 0.0
        for k in range(3):
            y += flat.axes[i, k] * (x[k] - flat.origin[k])
        above = y - flat.hi[i]
        below = flat.lo[i] - y
        if above > 0.0:
            out[i] = above
            outside += 1
        elif below > 0.0:
            out[i] = -below
            outside += 1
        if -above < depth:
            depth, near, sign = -above, i, 1.0
        if -below < depth:
            depth, near, sign = -below, i, -1.0
    a = flat.axes
    if outside == 0:
        return -depth, (sign * a[near, 0], sign * a[near, 1], sign * a[near, 2]), 1
    if outside == 1:
        d = abs(out[0] + out[1] + out[2])
    else:
        d = np.sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2])
    u, v, w = out[0] / d, out[1] / d, out[2] / d
    n = (
        u * a[0, 0] + v * a[1, 0] + w * a[2, 0],
        u * a[0, 1] + v * a[1, 1] + w * a[2, 1],
        u * a[0, 2] + v * a[1, 2] + w * a[2, 2],
    )
    return d, n, outside
