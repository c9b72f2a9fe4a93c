"""Where in a cell the liquid is that a body displaces: the moment of its weight, which is not at the cell's centre.

In liquid at rest the sums over p a and over the first part of the lift cancel along every row of cells
(body_fluxes.py), their moments too, since all cells of a row have the same arm. What is left is the weight of the
liquid that each cell's covered part displaces, and that acts at the middle of this part:

    moment about B  =  sum of ((r + c) x (- rho g C volume)),      C the covered share below the level, c its middle

With arms r to the centres alone the flat bottom of a box whose edges lie between planes of the mesh is pushed beside
its middle: a box half as heavy as water, 5 cells across and upright, had a moment of 3e-3 of its weight times its
width, and turned with .4 rad/s after .3 s in water at rest.

    place_d  =  C c_d  =  integral of (xi_d - 1/2) over the covered part of the cell,  xi in 0 .. 1

Shares of faces and C are those of the body where it is at the start of the step, as C is in lift. Means over the step
say nothing of a shape: of a face that lies in the plane of faces they are 0, 1, or anything between by what rounding
makes of the way (a box at rest, afloat, one face in such a plane: .02 rad/s2).

Convex bodies of planes are cut exactly (favor/cell_moments.py). Of others the place is that of a plane where the shares
of the faces are those of one (w = 0), of a step between those of both ends where they are those of a corner of a box
along the mesh (r = 0; w, r as in cut_level.py and observe/places_of_liquid.py), and between these

    place  =  a step + (1 - a) ((1 - w) plane + w step),      a = 1 - r / w, or 0 where r > w

so that a body at rest that turns by rounding does not jump. Cylinders 6 cells across miss 3e-5 of weight times width
(in the middle; 4.4e-4 at most with arms to the centres), turned boxes missed as much with this blend, 3e-4 at most,
and 1e-16 now. Where the level cuts the cell the part below it is cut too, or of others counts with the same middle:
exact along the level for upright walls. Balls have none of this: what presses on them goes through their centre.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.favor.body_cover import BodyCover
from flowgmo.flow.favor.cell_moments import cut_by_level, cut_by_planes, moment_within, planes_through
from flowgmo.flow.favor.cut_cell import MOST_FIELDS, work_space
from flowgmo.flow.fields import Grid
from flowgmo.flow.immersed.waterline import Below
from flowgmo.flow.observe.places_of_liquid import misses_of_box, moment_under
from flowgmo.flow.surface.cut_level import EXACT, has_plane
from flowgmo.flow.surface.plic import plane_offset, stretched, volume_under
from flowgmo.kernel import free_kernel, inner


@inner
def _unexplained(s, beta, d, low, high):
    """Share of a cell that the plane s . xi <= beta does not explain by what is covered of its ends along d."""
    if not has_plane(s):
        return 1.0
    across = stretched(s, d, 0.0)
    w = abs(volume_under(across, beta) - low) + abs(volume_under(across, beta - s[d]) - high)
    return min(w, 1.0) if w > EXACT else 0.0


@inner
def _of_step(low, high, C):
    """Place along a direction in which `low` is covered up to a step, and `high` behind it, C together."""
    a = min(max((C - high) / (low - high), 0.0), 1.0) if low != high else 1.0
    return -0.5 * a * (1.0 - a) * (low - high)


@inner
def _by_faces(shares, out):
    """out (3,): place of what is covered of a cell by what a body covers of its faces and volume, shares (7,)."""
    C = shares[6]
    s = (shares[0] - shares[1], shares[2] - shares[3], shares[4] - shares[5])
    beta = plane_offset(s, C)
    x, y, z = (1.0 - shares[0], 1.0 - shares[1]), (1.0 - shares[2], 1.0 - shares[3]), (1.0 - shares[4], 1.0 - shares[5])
    misses = misses_of_box(x, y, z, 1.0 - C, s)
    for d in range(3):
        low, high = shares[2 * d], shares[2 * d + 1]
        w, step = _unexplained(s, beta, d, low, high), _of_step(low, high, C)
        plane = moment_under(s, beta, d) - 0.5 * C if w < 1.0 else 0.0
        corner = 1.0 - misses / w if misses < w else 0.0
        out[d] = corner * step + (1.0 - corner) * ((1.0 - w) * plane + w * step)


@free_kernel
def _find(shares, low, sizes, planes, part, height, d, up, out):
    """out (m, 3) [-]: place of what is covered of each cell below the level; shares (m, 7) of its faces and volume;
    low, sizes (m, 3) [length]: its lower corner and widths; planes (n, 4): of a convex body of planes, or None; part,
    height (m,), d, up: as in Below."""
    work, which = work_space(), np.empty(MOST_FIELDS, np.int64)
    for c in range(len(shares)):
        if not 0.0 < shares[c, 6] < 1.0:
            for e in range(3):
                out[c, e] = 0.0
            continue
        if planes is not None:
            count = planes_through(planes, low[c], sizes[c], which)
            level = height[c] > 0.0
            if (count > 1 or level) and 0 <= count < (MOST_FIELDS if level else MOST_FIELDS + 1):
                polygons = cut_by_planes(work, planes, which, count, low[c], sizes[c])
                if level:
                    polygons = cut_by_level(work, polygons, d, up, height[c])
                moment_within(work, polygons, out[c])
                below = 1.0 if level else part[c]
                for e in range(3):
                    out[c, e] *= below
                continue
        _by_faces(shares[c], out[c])
        for e in range(3):
            out[c, e] *= part[c]


def displaced_places(
    at: np.ndarray, cells: np.ndarray, covered: np.ndarray, cover: BodyCover, below: Below | None, grid: Grid,
    centres: list[np.ndarray],
) -> np.ndarray:  # fmt: skip
    """(m, 3) [length4]: volume times place of what a body displaces in each of its cells.

    at (m, 3) int32, cells (m,): these, and as flat index; covered (m,): what of each counts as covered by this body
    (less than the body covers by itself where others share its place); cover: of the body now; below: what of it is
    under the level, None: all. centres [length] of cells for each direction.
    """
    shares = np.zeros((len(cells), 7))
    row = np.searchsorted(cover.numbers, cells)
    there = np.flatnonzero(row < len(cover.numbers))
    there = there[cover.numbers[row[there]] == cells[there]]  # others are wholly inside, or not touched now
    shares[there] = cover.shares[row[there]]
    sizes = np.column_stack([d[at[:, e]] for e, d in enumerate(grid[:3])])
    low = np.column_stack([x[at[:, e]] for e, x in enumerate(centres)]) - 0.5 * sizes
    found = np.empty((len(cells), 3))
    below = below or Below(np.ones(len(cells)), np.zeros(len(cells)), 0, 1.0)
    _find(shares, low, sizes, cover.planes, *below, found)
    part = np.divide(covered, shares[:, 6], out=np.zeros(len(cells)), where=shares[:, 6] > 0.0)
    return found * sizes * (sizes.prod(axis=1) * part)[:, None]
