"""Where the water's surface meets a body inside a cell: the part of the wall that the pressure of the cell misses.

The load of a cell counts whole where its centre is in the liquid, and not at all where it is not (body_fluxes.py). In
liquid at rest with its surface at the height h of the cell (from its bottom, in heights of a cell), the pressure
p = rho g dz (h - z) acts on the wall below h only. What the body covers below h, the share C(h) of the cell, is bounded
by that wall, the lower face's share S_low, and the level, where p = 0: upwards

    the wall gives             C(h) - h S_low                                               rho g volume
    p of the centre and lift   h (S_upper - S_low) - S_upper + C(1),  C(1) the covered share     (the same unit)

    so that is added           (1 - h) S_upper - (C(1) - C(h))      where the centre is in the liquid
                               C(h) - h S_low                       where it is not, and nothing counted

With the same S as in J the sum over a column is C(h) of its cells and nothing else, also where S is the mean of a step
and C that of its start (lift in body_fluxes.py). Sideways nothing is added: what counts whole adds up to nothing in
water at rest, planes do not (a turned box, 10 cells across: a side force of 3e-5 of its weight, 2e-3 by planes).

h is what the solver reads from F as the level (surface/cut_level.py), so that it is that of its pressure. C(h) of a
ball is that of the cell with its upper face lowered to h (favor/ball_cut.py), of a convex body of planes that of the
cell cut by them and the level (favor/cell_moments.py), in proportion where others take their part of it; of other
bodies that of the plane m . xi <= alpha, m from the shares of the faces (the difference of
opposite ones), alpha from C(1). What the plane does not explain of S_low and S_upper counts as evenly spread, as in
cut_level.py: a thin upright wall has m = 0 but for rounding.

A sphere half in the water, ten cells across, is wrong by 2.3e-5; by this with planes 1.9e-4; by the wall of the plane
alone, whose S are not those that the centres count with, 1.0e-3.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flowgmo.flow.favor.ball_cut import cover_by_ball, scratch
from flowgmo.flow.favor.body_cover import BodyCover
from flowgmo.flow.favor.cell_moments import cut_by_level, cut_by_planes, planes_through
from flowgmo.flow.favor.cut_cell import MOST_FIELDS, volume_inside, work_space
from flowgmo.flow.fields import Grid, Open
from flowgmo.flow.surface.cut_level import level_of_cell
from flowgmo.flow.surface.plic import plane_offset, stretched, volume_under
from flowgmo.kernel import free_kernel, inner

UPRIGHT = 0.999  # of gravity along one direction of the mesh: else levels are none of the mesh's, and nothing is added


class Surface(NamedTuple):
    """F (mesh), gravity (3,) [length/time2], and what is open now, that F is a share of."""

    F: np.ndarray
    gravity: np.ndarray
    opened: Open


class Below(NamedTuple):
    """Of a body's cells: part (m,) of what is covered that lies below the level; height (m,) of the level, in heights
    of the cell, where it crosses what is covered, else 0; d: direction of gravity, up: 1.0 or -1.0."""

    part: np.ndarray
    height: np.ndarray
    d: int
    up: float


@inner
def _by_plane(faces, covered, d, up, h):
    """C(h) of a plane; faces (6,) and covered of the body."""
    m = (faces[0] - faces[1], faces[2] - faces[3], faces[4] - faces[5])
    if not abs(m[0]) + abs(m[1]) + abs(m[2]) > 0.0:
        return covered * h
    wet, dry = (faces[2 * d], faces[2 * d + 1]) if up > 0.0 else (faces[2 * d + 1], faces[2 * d])
    m = m if up > 0.0 else stretched(m, d, -1.0)
    alpha, across = plane_offset(m, covered), stretched(m, d, 0.0)
    spread = abs(volume_under(across, alpha) - wet) + abs(volume_under(across, alpha - m[d]) - dry)
    spread = min(spread, 1.0)
    return h * (spread * covered + (1.0 - spread) * volume_under(stretched(m, d, h), alpha))


@inner
def _by_ball(cut, R, covered, d, up, h, out):
    """C(h) of a ball of radius R [length] in the cell cut.q; out (7,): scratch."""
    size, tall = 0.0, cut.q[d, 1] - cut.q[d, 0]
    for e in range(3):
        size += (cut.q[e, 1] - cut.q[e, 0]) ** 2
    parts = R * R < 0.25 * size
    cover_by_ball(cut, R, parts, 0.0, out)
    whole = out[6]
    if not whole > 0.0:
        return covered * h
    if up > 0.0:
        cut.q[d, 1] = cut.q[d, 0] + h * tall
    else:
        cut.q[d, 0] = cut.q[d, 1] - h * tall
    if not cut.q[d, 0] < cut.q[d, 1]:  # by less than rounding
        return 0.0
    cover_by_ball(cut, R, parts, 0.0, out)
    return min(covered / whole * h * out[6], covered)


@inner
def _by_planes(work, planes, which, low, size, covered, d, up, h):
    """C(h) of a convex body of planes, in proportion where others take their part of it; -1 of more planes than
    can be cut."""
    count = planes_through(planes, low, size, which)
    if not 0 <= count < MOST_FIELDS:
        return -1.0
    polygons = cut_by_planes(work, planes, which, count, low, size)
    whole = volume_inside(work, polygons)
    if not whole > 0.0:
        return covered * h
    below = volume_inside(work, cut_by_level(work, polygons, d, up, h))
    return min(covered / whole * below, covered)


@free_kernel
def _find(cells, F, opened, faces, covered, d, up, low, size, ball, planes, too_much, missing, part, height):
    """too_much, missing (m,): what is to be added along d of above, 0 in cells that no surface crosses; part (m,): of
    what is covered, that below the level; height (m,): h where the surface crosses what is covered, else 0. low, size
    (m, 3) [length]: corners and widths of the cells; ball, planes: of BodyCover."""
    out = np.empty(7)
    work, which = work_space(), np.empty(MOST_FIELDS, np.int64)
    cut = scratch()
    for c in range(len(cells)):
        i, j, k = np.int64(cells[c, 0]), np.int64(cells[c, 1]), np.int64(cells[c, 2])
        too_much[c] = missing[c] = height[c] = 0.0
        part[c] = 1.0 if F[i, j, k] >= 0.5 else 0.0
        if not (0.0 < F[i, j, k] < 1.0 and 0.0 < covered[c] < 1.0 and opened.V[i, j, k] > 0.0):
            continue
        h = level_of_cell(F[i, j, k], opened, i, j, k, d, up)
        if not 0.0 < h < 1.0:
            part[c] = 1.0 if h > 0.0 else 0.0
            continue
        height[c] = h
        below = -1.0
        if planes is not None:
            below = _by_planes(work, planes, which, low[c], size[c], covered[c], d, up, h)
        if ball is not None:
            for e in range(3):
                cut.q[e, 0] = low[c, e] - ball[e]
                cut.q[e, 1] = cut.q[e, 0] + size[c, e]
            below = _by_ball(cut, ball[6], covered[c], d, up, h, out)
        if below < 0.0:
            below = _by_plane(faces[c], covered[c], d, up, h)
        wet, dry = (faces[c, 2 * d], faces[c, 2 * d + 1]) if up > 0.0 else (faces[c, 2 * d + 1], faces[c, 2 * d])
        part[c] = below / covered[c]
        too_much[c] = up * ((1.0 - h) * dry - (covered[c] - below))
        missing[c] = up * (below - h * wet)


def waterline(
    at: np.ndarray, faces: np.ndarray, covered: np.ndarray, surface: Surface, grid: Grid, centres: list[np.ndarray],
    cover: BodyCover | None = None,
) -> tuple[np.ndarray | None, Below]:  # fmt: skip
    """(m, 2, 3) [length4/time2] what is to be added, per density, to the force of a body's cells: where their centre is
    in the liquid, and where it is not; None without gravity along the mesh. And what of them lies below the level.

    at (m, 3) its cells [with ghosts], faces (m, 6) and covered (m,) shares of the body, centres [length] of cells for
    each direction; cover: of the body as it is now, for those that are cut exactly; None: of another one.
    """
    gravity = surface.gravity
    size = float(np.linalg.norm(gravity))
    d = int(np.abs(gravity).argmax())
    if not abs(gravity[d]) > UPRIGHT * size:
        part = (surface.F[tuple(at.T)] >= 0.5).astype(float)
        return None, Below(part, np.zeros(len(at)), d, 1.0)
    found, up = np.empty((4, len(at))), -float(np.sign(gravity[d]))
    widths = np.column_stack([w[at[:, e]] for e, w in enumerate(grid[:3])])
    low = np.column_stack([x[at[:, e]] for e, x in enumerate(centres)]) - 0.5 * widths
    exact = (None, None) if cover is None else (cover.ball, cover.planes)
    _find(at, surface.F, surface.opened, faces, covered, d, up, low, widths, *exact, *found)
    out = np.zeros((len(at), 2, 3))
    out[:, :, d] = found[:2].T * (size * widths.prod(axis=1))[:, None]
    return out, Below(found[2], found[3], d, up)
