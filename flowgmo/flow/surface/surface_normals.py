"""The liquid's surface in a mixed cell: a plane m . xi = alpha (plic.py) from F in the 3 x 3 x 3 cells around it.

Two kinds of estimate, in units of the cell:

    heights   where the surface faces z most, the liquid in three cells along z is a height H(x, y), and
              m = (-dH/dx, -dH/dy, +-1); likewise for x and y. Exact for planes that stay inside the three cells.
    Youngs    m = -grad F, averaged over the neighbours with weights 1 2 1. Rough, but never far off.

Of the three heights, the one with the least slope is the best. Where a surface is steep to all of them, as a drop of
few cells, heights miss what leaves the stencil and flatten it: Youngs is taken when it is the more oblique. Aulisa,
Manservisi, Scardovelli and Zaleski 2007 ("Interface reconstruction with least-squares fit and split advection in
three-dimensional Cartesian geometry", J. Comput. Phys. 225), "mixed Youngs-centred". A height is left out
where one of its five columns does not fall from wet to dry by SOUND: the surface leaves the three cells there, or the
liquid is a thread with two surfaces. Both ways of taking a difference over graded cells are exact for a linear H or F.

Where liquid is the same along an axis, as in a scene of one layer, and the plane misses the neighbours' F by much, as
at a thread or a corner, line_fit.py looks for a better one. In three dimensions nothing was found that is worth its
time: the least misfit in 27 cells of Youngs and three heights takes ten times as long, gains a third on a carried
sphere, and loses 3 % in LeVeque's deformation (.00757 in place of .00736 at 32 cells, .00258 of .00250 at 64; with a
Gauss-Newton step .00745 and .00245, and the sphere .0138).

Cells that are closed or cut by a solid are left to surface_at_solids.py. Ghost cells outside the domain must hold
what continues the liquid: the mirror image at walls, symmetry and in absent directions, the opposite side where
periodic. Sums are grouped so that a mirrored surface gives the mirrored plane to the last bit.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flowgmo.flow.fields import Grid
from flowgmo.flow.surface.line_fit import line_vector
from flowgmo.flow.surface.line_of_pieces import line_of_pieces
from flowgmo.flow.surface.plic import is_mixed, plane_offset
from flowgmo.flow.surface.surface_at_solids import plane_at_solids
from flowgmo.kernel import flow_kernel, inner

#: [-] F at the wet end less F at the dry end of a column that has a height. Errors of the reversed vortex with 32, 64,
#: 80, 128 cells: .051 .0117 .0060 .0024; with .6: .059 .0114 .0080 .0027; with none: .061 .0130 .0082 .0022. Carried
#: sphere 12 cells across: .0121; with .8 .0139; with none .0150.
SOUND = 0.3
TIE = 1e-3  # of |m_x| + |m_y| + |m_z|: water that is nearly level is the same to both, and round-off would choose


class Steps(NamedTuple):
    """Per direction (4, n + 4) [-], in units of the cell's own width d (h: distances of centres):

    0, 1: weights up and down of (q[+1] - q) and -(q[-1] - q) in a second-order derivative, 2, 3: d[+1] / d, d[-1] / d.
    """

    x: np.ndarray
    y: np.ndarray
    z: np.ndarray


def steps_of(grid: Grid) -> Steps:
    """The Steps of a grid. At the outermost ghosts, where nothing is reconstructed, the missing neighbour repeats."""
    return Steps(*(_steps(d, h) for d, h in ((grid.dx, grid.hx), (grid.dy, grid.hy), (grid.dz, grid.hz))))


def _steps(d: np.ndarray, h: np.ndarray) -> np.ndarray:
    up, down = h, np.append(h[0], h[:-1])
    wider, narrower = np.append(d[1:], d[-1]), np.append(d[0], d[:-1])
    return np.array([d * down / (up * (up + down)), d * up / (down * (up + down)), wider / d, narrower / d])


@inner
def near_solids(V, i, j, k):
    """Whether one of the 27 cells around (i, j, k) is not wholly open."""
    least = V[i, j, k]
    for a in range(i - 1, i + 2):
        for b in range(j - 1, j + 2):
            least = min(least, min(V[a, b, k], min(V[a, b, k - 1], V[a, b, k + 1])))
    return least < 1.0


@inner
def plane_of_cell(F, V, opened, steps, i, j, k):
    """(m, alpha) of the surface in the mixed cell (i, j, k): liquid is m . xi <= alpha, xi in 0 .. 1 over the cell.

    F (mesh) [-], V opened.V (by itself, since None must be an argument to be pruned), opened Open, steps Steps. On the
    liquid's side lies F of the cell; where a solid cuts it V F of its open part, to round-off when m is along an axis.
    """
    if V is not None:
        if near_solids(V, i, j, k):
            return plane_at_solids(F, opened, steps, i, j, k)
    m = surface_vector(F, steps.x, steps.y, steps.z, i, j, k)
    return m, plane_offset(m, F[i, j, k])


@inner
def _column(F, i, j, k):
    return F[i, j, k - 1], F[i, j, k], F[i, j, k + 1]


@inner
def _difference(steps, i, low, mid, high):
    """d/dx of q, times the cell's width."""
    return steps[0, i] * (high - mid) - steps[1, i] * (low - mid)


@inner
def _height(steps, i, low, mid, high):
    """Liquid in three cells in a row, in widths of the middle one."""
    return mid + (steps[3, i] * low + steps[2, i] * high)


@inner
def _smooth(low, mid, high):
    return 2.0 * mid + (low + high)


@inner
def surface_vector(F, x, y, z, i, j, k):
    """m of the surface in a mixed cell, out of the liquid, in units of the cell; neighbours wholly open.

    x, y, z: those of Steps. 0 where nothing says where the liquid lies, as in a lone cell.
    """
    c00, c01, c02 = _column(F, i - 1, j - 1, k), _column(F, i - 1, j, k), _column(F, i - 1, j + 1, k)
    c10, c11, c12 = _column(F, i, j - 1, k), _column(F, i, j, k), _column(F, i, j + 1, k)
    c20, c21, c22 = _column(F, i + 1, j - 1, k), _column(F, i + 1, j, k), _column(F, i + 1, j + 1, k)

    # Youngs: smooth along two axes, difference along the third
    s00, s01, s02 = _smooth(c00[0], c00[1], c00[2]), _smooth(c01[0], c01[1], c01[2]), _smooth(c02[0], c02[1], c02[2])
    s10, s11, s12 = _smooth(c10[0], c10[1], c10[2]), _smooth(c11[0], c11[1], c11[2]), _smooth(c12[0], c12[1], c12[2])
    s20, s21, s22 = _smooth(c20[0], c20[1], c20[2]), _smooth(c21[0], c21[1], c21[2]), _smooth(c22[0], c22[1], c22[2])
    gx = _difference(x, i, _smooth(s00, s01, s02), _smooth(s10, s11, s12), _smooth(s20, s21, s22))
    gy = _difference(y, j, _smooth(s00, s10, s20), _smooth(s01, s11, s21), _smooth(s02, s12, s22))
    gz = _difference(z, k, _layer(0, c00, c01, c02, c10, c11, c12, c20, c21, c22),
                     _layer(1, c00, c01, c02, c10, c11, c12, c20, c21, c22),
                     _layer(2, c00, c01, c02, c10, c11, c12, c20, c21, c22))  # fmt: skip

    # heights along x, y, z: slopes in the two other directions
    h = _height(x, i, c01[1], c11[1], c21[1])
    xy = _difference(y, j, _height(x, i, c00[1], c10[1], c20[1]), h, _height(x, i, c02[1], c12[1], c22[1]))
    xz = _difference(z, k, _height(x, i, c01[0], c11[0], c21[0]), h, _height(x, i, c01[2], c11[2], c21[2]))
    h = _height(y, j, c10[1], c11[1], c12[1])
    yx = _difference(x, i, _height(y, j, c00[1], c01[1], c02[1]), h, _height(y, j, c20[1], c21[1], c22[1]))
    yz = _difference(z, k, _height(y, j, c10[0], c11[0], c12[0]), h, _height(y, j, c10[2], c11[2], c12[2]))
    h = _height(z, k, c11[0], c11[1], c11[2])
    zx = _difference(x, i, _height(z, k, c01[0], c01[1], c01[2]), h, _height(z, k, c21[0], c21[1], c21[2]))
    zy = _difference(y, j, _height(z, k, c10[0], c10[1], c10[2]), h, _height(z, k, c12[0], c12[1], c12[2]))
    ok_x = _falls(gx, c01[1], c21[1], c00[1], c20[1], c02[1], c22[1], c01[0], c21[0], c01[2], c21[2])
    ok_y = _falls(gy, c10[1], c12[1], c00[1], c02[1], c20[1], c22[1], c10[0], c12[0], c10[2], c12[2])
    ok_z = _falls(gz, c11[0], c11[2], c01[0], c01[2], c21[0], c21[2], c10[0], c10[2], c12[0], c12[2])
    m = _choose((gx, gy, gz), (xy, xz), (yx, yz), (zx, zy), ok_x, ok_y, ok_z)
    along = _same_along(c00, c01, c02, c10, c11, c12, c20, c21, c22)
    if along < 0:
        return m
    p, q = (x if along != 0 else y), (z if along != 2 else y)
    e, f = (i if along != 0 else j), (k if along != 2 else j)
    rows = (c00[0], c10[0], c20[0]), (c00[1], c10[1], c20[1]), (c00[2], c10[2], c20[2])
    if along == 0:
        rows = (c00[0], c01[0], c02[0]), (c00[1], c01[1], c02[1]), (c00[2], c01[2], c02[2])
    if along == 2:
        rows = (c00[1], c10[1], c20[1]), (c01[1], c11[1], c21[1]), (c02[1], c12[1], c22[1])
    a, b = m[0] if along != 0 else m[1], m[2] if along != 2 else m[1]
    a, b = line_vector(a, b, rows, (p[3, e], p[2, e]), (q[3, f], q[2, f]))
    return (0.0 if along == 0 else a), (0.0 if along == 1 else (a if along == 0 else b)), (0.0 if along == 2 else b)


@inner
def _same_along(c00, c01, c02, c10, c11, c12, c20, c21, c22):
    """The axis along which all 27 cells are the same, y before x before z; -1: none."""
    if c00 == c01 and c01 == c02 and c10 == c11 and c11 == c12 and c20 == c21 and c21 == c22:
        return 1
    if c00 == c10 and c10 == c20 and c01 == c11 and c11 == c21 and c02 == c12 and c12 == c22:
        return 0
    if _even(c00, c01, c02) and _even(c10, c11, c12) and _even(c20, c21, c22):
        return 2
    return -1


@inner
def _even(one, two, three):
    """Whether nothing changes along the three columns."""
    return one[0] == one[1] == one[2] and two[0] == two[1] == two[2] and three[0] == three[1] == three[2]


@inner
def _falls(g, low, high, low1, high1, low2, high2, low3, high3, low4, high4):
    """Whether five columns change by SOUND from end to end, all the way that g says."""
    s = 1.0 if g > 0.0 else -1.0
    outer = min(min(s * (high1 - low1), s * (high2 - low2)), min(s * (high3 - low3), s * (high4 - low4)))
    return g != 0.0 and min(s * (high - low), outer) > SOUND


@inner
def _layer(n, c00, c01, c02, c10, c11, c12, c20, c21, c22):
    """Weighted sum of the nine cells at one k. Opposite corners first: mirroring changes no bit."""
    corners = (c00[n] + c22[n]) + (c02[n] + c20[n])
    return 4.0 * c11[n] + (2.0 * ((c01[n] + c21[n]) + (c10[n] + c12[n])) + corners)


@inner
def _choose(g, of_x, of_y, of_z, ok_x, ok_y, ok_z):
    """The least steep height, or Youngs where that is more oblique by TIE. of_x: slopes (d/dy, d/dz) of the height
    along x."""
    # a height's vector is 1 along its axis: its share of |m_x| + |m_y| + |m_z| is 1 / (1 + slopes)
    tx = abs(of_x[0]) + abs(of_x[1]) if ok_x else np.inf
    ty = abs(of_y[0]) + abs(of_y[1]) if ok_y else np.inf
    tz = abs(of_z[0]) + abs(of_z[1]) if ok_z else np.inf
    least = min(tz, min(ty, tx))
    a, b, c = abs(g[0]), abs(g[1]), abs(g[2])
    steepest = max(a, max(b, c))
    if steepest == 0.0:
        return 0.0, 0.0, 0.0
    if least == np.inf or steepest * (1.0 + least) < (1.0 - TIE) * (a + b + c):
        return -g[0], -g[1], -g[2]
    if tz == least:
        return -of_z[0], -of_z[1], (1.0 if g[2] < 0.0 else -1.0)
    if ty == least:
        return -of_y[0], (1.0 if g[1] < 0.0 else -1.0), -of_y[1]
    return (1.0 if g[0] < 0.0 else -1.0), -of_x[0], -of_x[1]


@flow_kernel
def find_planes(columns, first, last, F, V, steps, lines, moments, planes):
    """planes (mesh, 4): m and alpha of the mixed cells of the columns that are not near solids; others stay.

    V: opened.V; lines: solid_lines.py; moments: of carried_moments.py, None where none are known. Apart from
    `find_planes_at_solids`: with its code in one kernel these take half as long again.
    """
    for c in range(first, last):
        i, j, k0, k1 = columns[c, 0], columns[c, 1], columns[c, 2], columns[c, 3]
        for k in range(k0, k1):
            if is_mixed(F[i, j, k]):
                if V is not None:
                    if lines[i, j] != 0 and near_solids(V, i, j, k):
                        continue
                m = surface_vector(F, steps.x, steps.y, steps.z, i, j, k)
                if moments is not None:
                    m = line_of_pieces(F, steps, moments, m, i, j, k)
                planes[i, j, k, 0], planes[i, j, k, 1], planes[i, j, k, 2] = m
                planes[i, j, k, 3] = plane_offset(m, F[i, j, k])


@flow_kernel
def find_planes_at_solids(columns, first, last, F, opened, steps, planes):
    """The same of those that are near solids."""
    for c in range(first, last):
        i, j, k0, k1 = columns[c, 0], columns[c, 1], columns[c, 2], columns[c, 3]
        for k in range(k0, k1):
            if is_mixed(F[i, j, k]) and near_solids(opened.V, i, j, k):
                m, planes[i, j, k, 3] = plane_at_solids(F, opened, steps, i, j, k)
                planes[i, j, k, 0], planes[i, j, k, 1], planes[i, j, k, 2] = m


@inner
def plane_at(planes, i, j, k):
    """(m, alpha) of a mixed cell, from what `find_planes` left."""
    return (planes[i, j, k, 0], planes[i, j, k, 1], planes[i, j, k, 2]), planes[i, j, k, 3]
