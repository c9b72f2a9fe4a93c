"""Where in a cell the liquid is that a body displaces: the moment of its weight, which is not at the cell's centre.

In liquid at rest the sums over p a and over the first part of the lift cancel along every row of cells
(body_fluxes.py), their moments too, since all cells of a row have the same arm. What is left is the weight of the
liquid that each cell's covered part displaces, and that acts at the middle of this part:

    moment about B  =  sum of ((r + c) x (- rho g C volume)),      C the covered share below the level, c its middle

With arms r to the centres alone the flat bottom of a box whose edges lie between planes of the mesh is pushed beside
its middle: a box half as heavy as water, 5 cells across and upright, had a moment of 3e-3 of its weight times its
width, and turned with .4 rad/s after .3 s in water at rest.

    place_d  =  C c_d  =  integral of (xi_d - 1/2) over the covered part of the cell,  xi in 0 .. 1

is that of a plane where the shares of the faces are those of one (w = 0), of a step between those of both ends where
they are those of a corner of a box along the mesh (r = 0; w, r as in cut_level.py and observe/places_of_liquid.py), and
between these

    place  =  a step + (1 - a) ((1 - w) plane + w step),      a = 1 - r / w, or 0 where r > w

so that a box at rest that turns by rounding does not jump. Turned boxes 7 cells across miss 5e-5 of weight times width
(in the middle; 5e-4 with arms to the centres), with edges along the mesh 1.4e-4 (1.6e-3). Where the level cuts the cell
the part below it counts with the same middle: exact along the level for upright walls. Balls have none of this: what
presses on them goes through their centre.

The shares are the mean of the step and C that of its start, so that where a body moves the place is off by what it
moves in half a step.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.favor.shares import Shares
from flowgmo.flow.fields import Grid
from flowgmo.flow.observe.places_of_liquid import misses_of_box, moment_under
from flowgmo.flow.surface.cut_level import EXACT, has_plane
from flowgmo.flow.surface.plic import plane_offset, stretched, volume_under
from flowgmo.kernel import inner, kernel


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


@kernel
def _find(faces, covered, out):
    """out (m, 3) [-]: place of what is covered of each cell; faces (m, 6), covered (m,) shares.

    Shares of a face that is crossed during the step may lie beyond 0 .. 1 (crossings.py): here they are cut off there.
    """
    f = np.empty(6)
    for c in range(len(covered)):
        C = covered[c]
        for n in range(6):
            f[n] = min(max(faces[c, n], 0.0), 1.0)
        for d in range(3):
            out[c, d] = 0.0
        if not 0.0 < C < 1.0:
            continue
        s = (f[0] - f[1], f[2] - f[3], f[4] - f[5])
        beta = plane_offset(s, C)
        x, y, z = (1.0 - f[0], 1.0 - f[1]), (1.0 - f[2], 1.0 - f[3]), (1.0 - f[4], 1.0 - f[5])
        misses = misses_of_box(x, y, z, 1.0 - C, s)
        for d in range(3):
            low, high = f[2 * d], f[2 * d + 1]
            w, step = _unexplained(s, beta, d, low, high), _of_step(low, high, C)
            plane = moment_under(s, beta, d) - 0.5 * C if w < 1.0 else 0.0
            corner = 1.0 - misses / w if misses < w else 0.0
            out[c, d] = corner * step + (1.0 - corner) * ((1.0 - w) * plane + w * step)


def displaced_places(shares: Shares, covered: np.ndarray, below: np.ndarray | None, grid: Grid) -> np.ndarray:
    """(m, 3) [length4]: volume times place of what a body displaces in each of its cells.

    shares, covered (m,) as in body_fluxes; below (m,): the part of it that is under the level, None: all.
    """
    found = np.empty((len(covered), 3))
    _find(shares.faces, covered, found)
    widths = np.column_stack([d[shares.cells[:, e]] for e, d in enumerate(grid[:3])])
    found *= widths * widths.prod(axis=1)[:, None]
    return found if below is None else found * below[:, None]
