"""Stops: plastic impacts with a partner that cannot move.

The velocity component that runs into a stop becomes zero and stays so while the loads (or the prescribed velocity) push
against it; then the body is free to return. Here: balls and bodies in free fall, and the list of hits.
"""

from __future__ import annotations

import numpy as np

from flowgmo.kernel import inner
from flowgmo.vectors import (
    put,
    triple,
)

IN_IMPACTS = 0  # place in State.books


@inner
def first_crossing(gap, v, a):
    """First t >= 0 at which v t + a t²/2 reaches gap >= 0 on the way up; infinity: never. Stable for small a."""
    gap = max(gap, 0.0)
    if gap == 0.0 and (v > 0.0 or (v == 0.0 and a > 0.0)):
        return 0.0
    under = v * v + 2.0 * a * gap
    if under < 0.0:
        return np.inf
    root = np.sqrt(under)
    if v >= 0.0:
        return 2.0 * gap / (v + root) if v + root > 0.0 else np.inf
    return (root - v) / a if a > 0.0 else np.inf


@inner
def fall_to_stops(body, row, books, t0, t1, hits):
    """Parabola with stops. Components are independent: each runs to its own stop, if it has one, and is held there."""
    n = np.int64(0)
    start, speed_then = triple(row.p), triple(row.v)
    for k in range(3):
        g = body.gravity[k]
        t = t0
        while t < t1:
            if row.hold[k] != 0:
                if g * row.hold[k] >= 0.0:  # it stays: nothing but gravity acts
                    break
                row.hold[k] = 0
            away = row.p[k] - body.origin[k]
            up = first_crossing(body.hi[k] - away, row.v[k], g)
            down = first_crossing(away - body.lo[k], -row.v[k], -g)
            dt = min(up, down)
            if not t + dt <= t1:
                dt = t1 - t
                row.p[k] += row.v[k] * dt + 0.5 * g * dt * dt
                row.v[k] += g * dt
                break
            t += dt
            speed = row.v[k] + g * dt
            row.hold[k] = 1 if up < down else -1
            row.p[k] = body.origin[k] + (body.hi[k] if up < down else body.lo[k])
            row.v[k] = 0.0
            place = (
                _fallen(body, 0, start, speed_then, t - t0),
                _fallen(body, 1, start, speed_then, t - t0),
                _fallen(body, 2, start, speed_then, t - t0),
            )
            n = note_hit(hits, n, t, k, -body.mass * speed, 0.5 * body.mass * speed * speed, place, books)
    return n


@inner
def _fallen(body, k, start, speed, t):
    """Coordinate k of B after t of free fall, no farther than its stops."""
    away = start[k] - body.origin[k] + (speed[k] + 0.5 * body.gravity[k] * t) * t
    return body.origin[k] + min(max(away, body.lo[k]), body.hi[k])


@inner
def note_hit(hits, n, t, k, impulse, loss, place, books):
    if n < hits.shape[0]:
        put(hits[n, 4:7], place)
        hits[n, 0] = t
        hits[n, 1] = k
        hits[n, 2] = impulse
        hits[n, 3] = loss
    books[IN_IMPACTS] += loss
    return n + 1
