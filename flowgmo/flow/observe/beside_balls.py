"""Potential energy of the liquid around balls that fit in a cell: where it is, exactly.

places_of_liquid.py finds the open part of a cut cell from its faces. A ball within a cell leaves no trace on them, and
the liquid around it would be anywhere in the cell: the energy of what it displaces jumps by up to rho g volume times a
cell when the ball comes to the next one, or when the surface does (wet_tiny: .007 J of .16, the largest kinetic
energy). In cells that nothing else cuts liquid lies below the level h along gravity instead, outside of the ball,

    F V = h - C(h)                      C(h): share of the cell that the ball covers below h          (ball_cut.py)
    moment of the liquid  =  that of the cell below h  -  that of the ball there

In cells with another body or a solid too all stays as it is.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.favor.ball_cut import cover_by_ball, moment_of_ball, scratch
from flowgmo.flow.favor.body_cover import BodyCover
from flowgmo.flow.fields import Flow, Grid, Open
from flowgmo.flow.observe.places_of_liquid import lean
from flowgmo.kernel import inner, kernel

HALVINGS = 45  # of a cell: 3e-14
ALONE = 1e-9  # of a cell: what a ball covers and what is open differ by less from 1 where nothing else is


@inner
def _cut_below(cut, R, d, up, h, out):
    """Share of the whole cell cut.q that a ball covers below the level h; cut is then of the part below."""
    low, high = cut.q[d, 0], cut.q[d, 1]
    if up > 0.0:
        cut.q[d, 1] = low + h * (high - low)
    else:
        cut.q[d, 0] = high - h * (high - low)
    if not cut.q[d, 0] < cut.q[d, 1]:  # by less than rounding
        cut.area[:], cut.polar[:] = 0.0, 0.0
        return 0.0
    cover_by_ball(cut, R, True, 0.0, out)
    return h * out[6]


@inner
def _find_level(cut, R, d, up, volume, out):
    """h with h - C(h) = volume [cells]."""
    low, high, first, last = 0.0, 1.0, cut.q[d, 0], cut.q[d, 1]
    for _ in range(HALVINGS):
        h = 0.5 * (low + high)
        held = h - _cut_below(cut, R, d, up, h, out)
        cut.q[d, 0], cut.q[d, 1] = first, last
        if held < volume:
            low = h
        else:
            high = h
    return high


@kernel
def _sum_around(numbers, shares, sheet, grid, centres, opened, F, planes, g):
    """Of one ball, its cells numbers (n,), shares (n, 7); sheet: centre (3), 0 (3), radius [length]; centres: tuple of
    three; F (mesh) or None, planes (mesh, 4) of it; g triple [length/time2]. Returns what is added / rho
    [length5/time2]."""
    total, cut, out, R = 0.0, scratch(), np.empty(7), sheet[6]
    ny, nz = len(centres[1]), len(centres[2])
    along = 2 if abs(g[2]) >= max(abs(g[0]), abs(g[1])) else (1 if abs(g[1]) >= abs(g[0]) else 0)
    up = 1.0 if g[along] <= 0.0 else -1.0
    for c in range(len(numbers)):
        i, j, k = numbers[c] // (ny * nz), numbers[c] // nz % ny, numbers[c] % nz
        widths = (grid.dx[i], grid.dy[j], grid.dz[k])
        part = 1.0
        if F is not None:
            part = min(max(F[i, j, k], 0.0), 1.0)
        if not (abs(opened.V[i, j, k] + shares[c, 6] - 1.0) < ALONE and part > 0.0):
            continue
        middle, whole = (centres[0][i], centres[1][j], centres[2][k]), widths[0] * widths[1] * widths[2]
        for d in range(3):
            cut.q[d, 0] = middle[d] - 0.5 * widths[d] - sheet[d]
            cut.q[d, 1] = cut.q[d, 0] + widths[d]
        h = 1.0
        if part < 1.0:
            h = _find_level(cut, R, along, up, part * opened.V[i, j, k], out)
        covered = _cut_below(cut, R, along, up, h, out)
        weights = (g[0] * widths[0], g[1] * widths[1], g[2] * widths[2])
        total += whole * lean(F, opened.V, opened, planes, i, j, k, weights)
        total += whole * weights[along] * up * 0.5 * h * (1.0 - h)
        for d in range(3):
            total += g[d] * (moment_of_ball(cut, R, d) + whole * covered * (sheet[d] - middle[d]))
    return total


def around_balls(
    covers: list[BodyCover], flow: Flow, opened: Open, grid: Grid, centres: list[np.ndarray], gravity: np.ndarray,
    planes: np.ndarray | None,
) -> float:  # fmt: skip
    """What is added to the potential energy / rho [length5/time2]; opened: what all bodies leave open now; gravity (3,)
    [length/time2]; planes (mesh, 4) of flow.F (planes.py)."""
    total, g = 0.0, tuple(float(x) for x in gravity)
    for cover in covers:
        if cover.ball is not None and cover.small and any(g):
            of = cover.numbers, cover.shares, cover.ball, grid, tuple(centres), opened
            total += float(_sum_around(*of, flow.F, planes, g))
    return total
