"""Broad phase: boxes around all that parties may touch in a while, and the pairs whose boxes meet."""

from __future__ import annotations

import numpy as np

from flowgmo.bodies.arrays import BALLISTIC, STILL
from flowgmo.collision.broad import overlapping
from flowgmo.collision.paths import ASLEEP, FREE, HELD, motion_bounds
from flowgmo.collision.tree import bounds_of_party
from flowgmo.kernel import inner, kernel
from flowgmo.vectors import norm, quad, triple

WIDER = 1e-9  # of the reach: rounding must not lose a touch


@kernel
def sweep_boxes(which, sweep, sh, A, M, P, bounds, slack, boxes):
    """Boxes (n, 6) of the parties `which`: lowest, highest corner of all they may touch in the sweep [time].

    Rows of M (n,) stand at the starts of their paths; slack [-]: how much wider, in reaches. A body that moves is taken
    as the ball around B that holds it, one that stands still as its own box. B runs along a parabola where its
    acceleration is constant (a path bulges by |a| t²/8 over its chord), else it is bounded by its acceleration.
    """
    for k in range(which.size):
        b = which[k]
        row = M[b]
        if A[b].motion == STILL or P[b].mode == ASLEEP or (sweep == 0.0 and slack == 0.0):
            bounds_of_party(sh, b, (triple(row.p), quad(row.q)), boxes[b])
            far = (slack + WIDER) * sh.size[b]
            for i in range(3):
                boxes[b, i] -= far
                boxes[b, 3 + i] += far
            continue
        mean, spread = _course(A[b], row, P[b], bounds[b], sweep)
        far = spread + sh.reach[b] * (1.0 + slack + WIDER)
        for i in range(3):
            x = row.p[i]
            y = x + (row.v[i] + 0.5 * mean[i] * sweep) * sweep
            rounding = 1e-14 * (abs(x) + abs(y))
            boxes[b, i] = min(x, y) - far - rounding
            boxes[b, 3 + i] = max(x, y) + far + rounding


@inner
def _course(body, row, path, bound, sweep):
    """Mean acceleration of B (triple) to follow, and how far B may be from the chord of that path [length]."""
    if path.mode == HELD and body.hinge == 0:
        mean = triple(path.acc)
        return mean, 0.125 * norm(mean) * sweep * sweep + norm(triple(path.lift)) * (path.span > 0.0)
    if path.mode == FREE and body.motion == BALLISTIC:
        mean = triple(body.gravity)
        return mean, 0.125 * norm(mean) * sweep * sweep
    _, _, most = motion_bounds(body, row, path, bound, sweep)
    return (0.0, 0.0, 0.0), 0.5 * most * sweep * sweep


@kernel
def pairs_of_boxes(boxes, allowed, order, out):
    """Allowed pairs (i < j) of parties whose boxes (n, 6) meet, into out (m, 2); returns how many, maybe above m."""
    return overlapping(boxes, allowed, order, out)


@kernel
def pairs_with(bodies, boxes, allowed, out):
    """Allowed pairs (i < j) with one of `bodies` (ascending) whose boxes (n, 6) meet, each once, into out (m, 2)."""
    count = np.int64(0)
    for k in range(bodies.size):
        i = bodies[k]
        for j in range(boxes.shape[0]):
            if not allowed[i, j]:
                continue
            apart = False
            for m in range(3):
                apart = apart or boxes[i, m] > boxes[j, 3 + m] or boxes[j, m] > boxes[i, 3 + m]
            if apart:
                continue
            if j < i:  # found already if j is one of them
                at = np.searchsorted(bodies, j)
                if at < bodies.size and bodies[at] == j:
                    continue
            if count < out.shape[0]:
                out[count, 0] = min(i, j)
                out[count, 1] = max(i, j)
            count += 1
    return count
