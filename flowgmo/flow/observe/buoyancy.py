"""Where the liquid lifts a body: the centre of what it displaces.

The liquid's level at a body is the height to which still liquid would wet as much of its wall,

    sum over wall cells of |a| wetted(level) = sum of |a| F        wetted: the part of a cell's height below the level

which needs no search for a water line, is all of the wall of a body under water, and none in the dry. What the body
covers of the mesh below that level is what it displaces, cell by cell. In a cell of which it covers the part c and the
shares S of its faces, that part lies off the centre, along each direction, by

    (1 - c) / 2 (S_upper - S_lower) dx        exact for a body that fills one end of the cell

and lower where the level cuts the cell. Waves along the body and the air under a lid are averaged. Heights
are against gravity; without gravity nothing is lifted, and the level cuts along z.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.favor.body_cover import BodyCover
from flowgmo.flow.fields import Flow, Grid
from flowgmo.flow.observe.body_loads import wall_sizes
from flowgmo.kernel import inner, kernel


@inner
def _add(i, j, k, covered, lean, grid, centres, up, level, out):
    """out (4,) += volume, and first moments, of what a body displaces in a cell: of the share that it covers, which
    lies off the centre by lean (triple) [cells], below the level [length]."""
    dx, dy, dz = grid.dx[i], grid.dy[j], grid.dz[k]
    x, y, z = centres[0][i] + lean[0] * dx, centres[1][j] + lean[1] * dy, centres[2][k] + lean[2] * dz
    half = 0.5 * (abs(up[0]) * dx + abs(up[1]) * dy + abs(up[2]) * dz)
    height = x * up[0] + y * up[1] + z * up[2]
    below = min(max(0.5 + 0.5 * (level - height) / half, 0.0), 1.0)
    part = covered * below * dx * dy * dz
    lower = (1.0 - below) * half
    out[0] += part
    out[1] += part * (x - lower * up[0])
    out[2] += part * (y - lower * up[1])
    out[3] += part * (z - lower * up[2])


@kernel
def _sum_displaced(numbers, shares, runs, grid, centres, up, level, out):
    """out (4,) as of _add, of all cells of a body: numbers, shares, runs of its BodyCover; centres: tuple of three."""
    ny, nz = len(centres[1]), len(centres[2])
    for c in range(len(numbers)):
        s = shares[c]
        off = 0.5 * (1.0 - s[6])
        lean = (off * (s[1] - s[0]), off * (s[3] - s[2]), off * (s[5] - s[4]))
        i, j, k = numbers[c] // (ny * nz), numbers[c] // nz % ny, numbers[c] % nz
        _add(i, j, k, s[6], lean, grid, centres, up, level, out)
    for m in range(len(runs)):
        for number in range(runs[m, 0], runs[m, 1]):
            i, j, k = number // (ny * nz), number // nz % ny, number % nz
            _add(i, j, k, 1.0, (0.0, 0.0, 0.0), grid, centres, up, level, out)


def buoyancy_centre(
    cover: BodyCover, flow: Flow, V: np.ndarray, grid: Grid, centres: list[np.ndarray], up: np.ndarray
) -> tuple[np.ndarray, float]:
    """Centre (3,) [length] and volume [length3] of the liquid that a body displaces inside the domain; up (3,): unit
    vector against gravity. Volume 0 (and a centre that says nothing): the body is dry."""
    level, out = np.inf if flow.F is None else _level(cover, flow, V, grid, centres, up), np.zeros(4)
    _sum_displaced(cover.numbers, cover.shares, cover.runs, grid, tuple(centres), up, level, out)
    volume = float(out[0])
    return (out[1:] / volume if volume > 0.0 else np.zeros(3)), volume


def _level(cover: BodyCover, flow: Flow, V: np.ndarray, grid: Grid, centres: list[np.ndarray], up: np.ndarray) -> float:
    """Height [length] along `up` to which still liquid wets as much of a body's wall."""
    wall = wall_sizes(cover, V, grid)
    at = cover.numbers[wall > 0.0]
    wall = wall[wall > 0.0]
    wet = float(wall @ flow.F.reshape(-1)[at].clip(0.0, 1.0))
    if wet <= 0.0:
        return -np.inf
    if wet >= float(wall.sum()):
        return np.inf
    index = np.unravel_index(at, flow.p.shape)
    height = sum(u * c[k] for u, c, k in zip(up, centres, index, strict=True))
    half = 0.5 * sum(abs(u) * d[k] for u, d, k in zip(up, grid[:3], index, strict=True))
    # the wetted area grows by wall / (2 half) a height in each cell between its ends: linear between all of these
    ends = np.concatenate([height - half, height + half])
    slopes = np.concatenate([0.5 * wall / half, -0.5 * wall / half])
    order = np.argsort(ends, kind="stable")
    ends, slopes = ends[order], np.cumsum(slopes[order])
    areas = np.concatenate([[0.0], np.cumsum(slopes[:-1] * np.diff(ends))])
    k = int(np.searchsorted(areas, wet, side="left"))
    k = min(max(k, 1), len(ends) - 1)
    step = areas[k] - areas[k - 1]
    return float(ends[k - 1] + (ends[k] - ends[k - 1]) * ((wet - areas[k - 1]) / step if step > 0.0 else 1.0))
