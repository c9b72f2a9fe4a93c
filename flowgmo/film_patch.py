"""How far films reach: the curvatures by which the gap between two surfaces opens around its narrowest places.

Two balls, a ball and a flat: known. Else from the gap's width H(x) = distance to the one + distance to the other, on
the plane between them: along sixteen directions the places where H has grown by h, which is as far as the film reaches
(flow/immersed/film.py); a_i there, and the curvature that opens as far is 2 h / a_i^2. Trace and deviator are means of
the eight lines. A direction in which the gap opens at once beyond some place ends there: an edge.

A distance changes by no more than one goes: H has grown by h at h / 2 at the soonest, where the search begins, with
steps that double. All films of a pair are looked at together: surfaces answer a thousand points in the time of ten.

A film that ends at edges all around is a plate. Its pressure obeys the equation of a twisted bar's stress, so that its
force is 3 mu J v / h^3; St Venant's J = A^4 / (4 pi^2 I) of the polygon of the sixteen places, A its area, I its polar
moment, is right within a tenth (a disc - 5, a square + 8 %). The curvatures are scaled to give that.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

Array = np.ndarray

PARTS = 8  # of the last step, twice: 1 / 128 of where the film ends
EDGE = 0.125  # of the growth at half the way: a parabola has a quarter, an edge nothing
BEYOND = np.sqrt(2.0)  # gaps beyond a right edge over a flat the width has doubled
ASKEW = 0.05  # of its reach: nearer to its middle a film is not moved
LINES = 8
TURNS = np.arange(LINES) / LINES * np.pi


class Patches(NamedTuple):
    """k films. place (k, 3) [length]: their middles; curvatures (k, 2) [1/length] of the opening gap; lines (k, 2, 3):
    their directions; power (k,): 1, 1.5, 3, by how many of the two end."""

    place: Array
    curvatures: Array
    lines: Array
    power: Array


def of_balls(place: Array, normal: Array, curvature: float) -> Patches:
    """Gaps (k, 3), with normals (k, 3), that open by one relative curvature [1/length] on all sides."""
    k = len(place)
    return Patches(place, np.full((k, 2), curvature), np.stack(across(normal), axis=1), np.ones(k))


def measured(width: Callable[[Array], Array], place: Array, normal: Array, gap: Array, size: float) -> Patches:
    """Around places (k, 3) with these normals (k, 3); width(x (m, 3)) -> (m,) [length]; gap (k,) [length] > 0: what it
    grows by; size [length]: no film is larger."""
    e, f = across(normal)
    ends, edges = _ends(width, place, e, f, gap, size)
    half, quarter = LINES, LINES // 2
    off = (ends[:, :1] - ends[:, half, None]) * e + (ends[:, quarter, None] - ends[:, half + quarter, None]) * f
    askew = np.linalg.norm(off, axis=1) > 2.0 * ASKEW * ends.min(axis=1)
    if askew.any():
        place = place + np.where(askew[:, None], 0.5 * off, 0.0)
        ends[askew], edges[askew] = _ends(width, place[askew], e[askew], f[askew], gap[askew], size)
    k = 2.0 * gap[:, None] / (0.5 * (ends[:, :LINES] + ends[:, LINES:])) ** 2
    trace = 2.0 * k.mean(axis=1)
    one, two = 2.0 * (k * np.cos(2.0 * TURNS)).mean(axis=1), 2.0 * (k * np.sin(2.0 * TURNS)).mean(axis=1)
    least = 2.0 * gap / size**2
    deviator = np.minimum(np.hypot(one, two), np.maximum(0.5 * trace - least, 0.0))
    angle = 0.5 * np.arctan2(two, one)[:, None]
    lines = np.stack([np.cos(angle) * e + np.sin(angle) * f, np.cos(angle) * f - np.sin(angle) * e], axis=1)
    curvatures = np.column_stack([0.5 * trace + deviator, 0.5 * trace - deviator])
    ended = edges[:, :LINES] & edges[:, LINES:]
    crossed = (ended & np.roll(ended, LINES // 2, axis=1)).any(axis=1)
    power = np.where(crossed, 3.0, np.where(ended.any(axis=1), 1.5, 1.0))
    plate = ended.all(axis=1)
    strength = trace[plate] * np.sqrt(curvatures[plate].prod(axis=1))
    curvatures[plate] *= np.sqrt(4.0 * np.pi * gap[plate] ** 2 / (_torsion(ends[plate]) * strength))[:, None]
    return Patches(place, curvatures, lines, power)


def own_shares(patches: Patches, h: Array, own: Array, others: Array, alike: Array) -> Array:
    """Shares (k,) of films that are nearer to their own places (k, 3) than to those of others (m, 3) with alike (k, m).

    h (k,) [length]: the widths of their gaps.
    """
    away, share = others - own[:, None], np.ones(len(own))
    far = (away * away).sum(axis=2)
    for line, k in zip(patches.lines.transpose(1, 0, 2), patches.curvatures.T, strict=True):
        ahead, reach = np.einsum("kmd,kd->km", away, line), np.sqrt(2.0 * h / k)
        ends = 0.0
        for s in (ahead, -ahead):
            some = alike & (s > 0.0)
            halfway = np.where(some, 0.5 * far / np.where(some, s, 1.0), np.inf)
            ends = ends + np.minimum(halfway.min(axis=1, initial=np.inf), reach)
        share *= 0.5 * ends / reach
    return share


def _torsion(ends: Array) -> Array:
    """J (k,) [length4] of polygons with corners so far (k, 2 LINES) from the middle."""
    next_, turn = np.roll(ends, -1, axis=1), np.pi / LINES
    area = 0.5 * np.sin(turn) * ends * next_
    moment = area * (ends**2 + ends * next_ * np.cos(turn) + next_**2) / 6.0
    return area.sum(axis=1) ** 4 / (4.0 * np.pi**2 * moment.sum(axis=1))


def across(n: Array) -> tuple[Array, Array]:
    """Two unit vectors (k, 3) each across unit vectors n (k, 3)."""
    e = np.eye(3)[np.abs(n).argmin(axis=1)]
    e = e - (e * n).sum(axis=1)[:, None] * n
    e /= np.linalg.norm(e, axis=1)[:, None]
    return e, np.cross(n, e)


def _ends(
    width: Callable[[Array], Array], place: Array, e: Array, f: Array, gap: Array, size: float
) -> tuple[Array, Array]:
    """(k, 2 LINES) [length] how far from places the width has grown by gap, from e to f and on; whether at an edge."""
    ways = np.cos(TURNS)[:, None] * e[:, None] + np.sin(TURNS)[:, None] * f[:, None]
    ways = np.concatenate([ways, -ways], axis=1)
    start = width(place)[:, None, None]

    def grown(s: Array) -> Array:
        at = place[:, None, None] + s[..., None] * ways[:, :, None]
        return width(at.reshape(-1, 3)).reshape(s.shape) - start

    rise = gap[:, None, None]
    levels = int(np.ceil(np.log2(max(2.0 * size / gap.min(), 1.0)))) + 1
    s = np.minimum(0.5 * rise * 2.0 ** np.arange(levels), size).repeat(2 * LINES, axis=1)
    low = np.zeros(s.shape[:2])
    for _ in range(3):
        wide = grown(s) >= rise
        wide[..., -1] = True
        k = wide.argmax(axis=2)[..., None]
        high = np.take_along_axis(s, k, axis=2)[..., 0]
        low = np.where(k[..., 0] > 0, np.take_along_axis(s, np.maximum(k - 1, 0), axis=2)[..., 0], low)
        s = low[..., None] + (high - low)[..., None] * np.arange(1, PARTS + 1) / PARTS
    first, last = np.moveaxis(grown(np.stack([low, high], axis=2)), 2, 0)
    gap = gap[:, None]
    ends = low + (high - low) * np.clip((gap - first) / np.maximum(last - first, 1e-9 * gap), 0.0, 1.0)  # no steps
    edges = (grown(0.5 * ends[..., None]) < EDGE * rise)[..., 0]
    return np.where(edges, np.maximum(ends - BEYOND * gap, 0.5 * ends), ends), edges
