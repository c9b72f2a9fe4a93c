"""How far a film reaches: the curvatures by which the gap between two surfaces opens around its narrowest place.

Two balls, a ball and a flat: known. Else from the gap's width H(x) = distance to the one + distance to the other, on
the plane between them: along sixteen directions the places where H has grown by h, which is as far as the film reaches
(flow/immersed/film.py); a_i there, and the curvature that opens as far is 2 h / a_i^2. Trace and deviator are means of
the eight lines. A direction in which the gap opens at once beyond some place ends there: an edge.

A film that ends at edges all around is a plate. Its pressure obeys the equation of a twisted bar's stress, so that its
force is 3 mu J v / h^3; St Venant's J = A^4 / (4 pi^2 I) of the polygon of the sixteen places, A its area, I its polar
moment, is right within a tenth (a disc - 5, a square + 8 %). The curvatures are scaled to give that.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

Array = np.ndarray

LEVELS = 30  # halves of the domain's size: 1e-9 of it
PARTS = 16  # of the last half, twice: 1 / 512 of where the film ends
EDGE = 0.125  # of the growth at half the way: a parabola has a quarter, an edge nothing
BEYOND = np.sqrt(2.0)  # gaps beyond a right edge over a flat the width has doubled
ASKEW = 0.05  # of its reach: nearer to its middle a film is not moved
LINES = 8
TURNS = np.arange(LINES) / LINES * np.pi


class Patch(NamedTuple):
    """place (3,) [length]: its middle; curvatures (2,) [1/length] of the opening gap; lines (2, 3): their directions;
    power: 1, 1.5, 3, by how many of the two end."""

    place: Array
    curvatures: Array
    lines: Array
    power: float


def of_balls(place: Array, normal: Array, curvature: float) -> Patch:
    """A gap that opens by one relative curvature [1/length] on all sides."""
    return Patch(place, np.full(2, curvature), np.array(across(normal)), 1.0)


def measured(width: Callable[[Array], Array], place: Array, normal: Array, gap: float, size: float) -> Patch:
    """Around a place (3,) with this normal; width(x (m, 3)) -> (m,) [length]; gap [length] > 0: what it grows by;
    size [length]: no film is larger."""
    e, f = across(normal)
    for turn in range(2):
        ends, edges = _ends(width, place, e, f, gap, size)
        off = 0.5 * ((ends[0] - ends[LINES]) * e + (ends[LINES // 2] - ends[LINES + LINES // 2]) * f)
        if turn or np.linalg.norm(off) <= ASKEW * ends.min():
            break
        place = place + off
    reach = 0.5 * (ends[:LINES] + ends[LINES:])
    k = 2.0 * gap / reach**2
    trace, one, two = 2.0 * k.mean(), 2.0 * (k * np.cos(2.0 * TURNS)).mean(), 2.0 * (k * np.sin(2.0 * TURNS)).mean()
    least = 2.0 * gap / size**2
    deviator = min(float(np.hypot(one, two)), 0.5 * trace - least if trace > 2.0 * least else 0.0)
    angle = 0.5 * np.arctan2(two, one)
    lines = np.array([np.cos(angle) * e + np.sin(angle) * f, np.cos(angle) * f - np.sin(angle) * e])
    curvatures = np.array([0.5 * trace + deviator, 0.5 * trace - deviator])
    ended = edges[:LINES] & edges[LINES:]
    crossed = ended & np.roll(ended, LINES // 2)
    power = 3.0 if crossed.any() else 1.5 if ended.any() else 1.0
    if ended.all():
        curvatures *= np.sqrt(4.0 * np.pi * gap**2 / (_torsion(ends) * trace * np.sqrt(curvatures.prod())))
    return Patch(place, curvatures, lines, power)


def own_share(patch: Patch, h: float, own: Array, others: Array) -> float:
    """Share of a film that is nearer to its own place (3,) than to others (m, 3); h [length]: the width of its gap."""
    away, share = others - own, 1.0
    far = (away * away).sum(axis=1)
    for line, k in zip(patch.lines, patch.curvatures, strict=True):
        ahead, reach = away @ line, np.sqrt(2.0 * h / k)
        ends = [float((0.5 * far[s > 0.0] / s[s > 0.0]).min(initial=reach)) for s in (ahead, -ahead)]
        share *= 0.5 * sum(ends) / reach
    return share


def _torsion(ends: Array) -> float:
    """J [length4] of the polygon with corners so far (2 LINES,) from the middle."""
    next_, turn = np.roll(ends, -1), np.pi / LINES
    area = 0.5 * np.sin(turn) * ends * next_
    moment = area * (ends**2 + ends * next_ * np.cos(turn) + next_**2) / 6.0
    return float(area.sum() ** 4 / (4.0 * np.pi**2 * moment.sum()))


def across(n: Array) -> tuple[Array, Array]:
    """Two unit vectors across the unit vector n (3,)."""
    e = np.eye(3)[int(np.abs(n).argmin())]
    e = e - (e @ n) * n
    e /= np.linalg.norm(e)
    return e, np.cross(n, e)


def _ends(
    width: Callable[[Array], Array], place: Array, e: Array, f: Array, gap: float, size: float
) -> tuple[Array, Array]:
    """(2 LINES,) [length] how far from place the width has grown by gap, from e to f and on; whether at an edge."""
    ways = np.cos(TURNS)[:, None] * e + np.sin(TURNS)[:, None] * f
    ways, all_ = np.concatenate([ways, -ways]), np.arange(2 * LINES)
    start = float(width(place[None])[0])

    def grown(s: Array) -> Array:
        at = place + s[..., None] * ways[:, None]
        return (width(at.reshape(-1, 3)) - start).reshape(s.shape)

    s = np.broadcast_to(size * 0.5 ** np.arange(LEVELS, -1.0, -1.0), (2 * LINES, LEVELS + 1))
    low = np.zeros(2 * LINES)
    for _ in range(3):
        wide = grown(s) >= gap
        wide[:, -1] = True
        k = wide.argmax(axis=1)
        high = s[all_, k]
        low = np.where(k > 0, s[all_, np.maximum(k - 1, 0)], low)
        s = low[:, None] + (high - low)[:, None] * np.arange(1, PARTS + 1) / PARTS
    first, last = grown(np.column_stack([low, high])).T
    ends = low + (high - low) * np.clip((gap - first) / np.maximum(last - first, 1e-9 * gap), 0.0, 1.0)  # no steps
    edges = (grown(0.5 * ends[:, None]) < EDGE * gap)[:, 0]
    return np.where(edges, np.maximum(ends - BEYOND * gap, 0.5 * ends), ends), edges
