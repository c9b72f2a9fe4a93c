"""One body from t0 to t1, by the cheapest way that is exact for it; stops included.

ballistic        p + v t + g t²/2, free top                  (stops.py, top.py)
driven           integrals of the laws                       (driven.py)
hinged, forced   equations of motion integrated              (forced.py, equations.py, integrate.py)
"""

from __future__ import annotations

from flowgmo.bodies.arrays import BALLISTIC, DRIVEN, HINGED, STILL
from flowgmo.bodies.driven import drive
from flowgmo.bodies.forced import fly_integrated
from flowgmo.bodies.stops import fall_to_stops
from flowgmo.bodies.top import spin_freely
from flowgmo.kernel import inner
from flowgmo.vectors import (
    put,
    put4,
    quad,
    triple,
)


@inner
def fly(body, row, laws, books, t0, t1, hits):
    """Move one body from t0 to t1 [time]: body of dtype BODY, row of dtype POSE (changed), books (4,) added to.

    hits (m, 7): rows (time, component 0-2 or 3 for the angle, momentum taken by the stop, energy lost, B then) are
    filled as far as there is room. Returns the number of hits, or FAILED when an integration gave up.
    """
    motion = body.motion
    if motion == STILL or t1 <= t0:
        return 0
    if laws is None:
        return _ballistic(body, row, books, t0, t1, hits)
    return _by_laws(body, row, laws, laws.ballistic, laws.hinged, laws.forced, laws.stops, books, t0, t1, hits)


@inner
def _ballistic(body, row, books, t0, t1, hits):
    n = fall_to_stops(body, row, books, t0, t1, hits) if body.stopped else _parabola(body, row, t1 - t0)
    q, w = spin_freely(quad(row.q), triple(row.w), body.moments, body.axes, t1 - t0)
    put4(row.q, q)
    put(row.w, w)
    return n


@inner
def _by_laws(body, row, laws, ballistic, hinged, forced, stops, books, t0, t1, hits):
    if ballistic is not None:
        if body.motion == BALLISTIC:
            return _ballistic(body, row, books, t0, t1, hits)
    if body.motion == DRIVEN:
        drive(body, row, laws, t0, t1)
        return 0
    if hinged is not None:
        if body.motion == HINGED:
            return fly_integrated(body, row, laws, stops, books, t0, t1, hits)
    if forced is not None:
        return fly_integrated(body, row, laws, stops, books, t0, t1, hits)
    return 0


@inner
def _parabola(body, row, h):
    for k in range(3):
        g = body.gravity[k]
        row.p[k] += row.v[k] * h + 0.5 * g * h * h
        row.v[k] += g * h
    return 0
