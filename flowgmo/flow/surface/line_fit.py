"""The surface where it is a line: liquid that is the same along one axis, from F in the 3 x 3 cells across it.

    a x + b z <= alpha, |a| = 1 or |b| = 1, x, z in 0 .. 1 over the cell; alpha follows from F of the cell

The line of the heights, or Youngs', is kept where it misses F of the eight neighbours by little. Where it misses them
by MISSED (sum of squares), a thread, a corner or another surface reaches into the 3 x 3 cells, and

    ELVIRA     liquid in three columns along z gives three slopes, centred and to either side, and in three along x
               three more; that one is taken which misses least: one of the sided differences does not know of what
               reaches in. Exact for lines.
    LVIRA      then a Gauss-Newton step of the slope towards the least misfit, unless it is no better. With F of the
               cell kept, the line turns about the middle X of its chord: with b = +-1 the share A of a neighbour has

                   dA / da = l (X - X_n)       l: extent along x of its chord / (|b| area), X_n the chord's middle

Pilliod and Puckett 2004 ("Second-order accurate volume-of-fluid algorithms for tracking material interfaces",
J. Comput. Phys. 199). A smooth surface is better off without: the least misfit to an arc is not its tangent. A disc
carried across the diagonal and back, 24 cells across: .0013 by heights and Youngs, .0021 by ELVIRA everywhere, .0018
by LVIRA. The reversed vortex with 64 cells: .0118, .0092, .0065.

The line that was there is no candidate: with it the vortex has .0091 in place of .0069. Where both sided slopes are
equally good the centred one is taken: what mirrors itself stays so.
"""

from __future__ import annotations

import numpy as np

from flowgmo.kernel import inner

#: [-] relative: misfits that differ by less are equal. 1e4 x round-off of a sum of squares of differences of F
EQUAL = 1e-11
#: [-] F beyond the cell less F before it, of three columns, below which nothing says on which side the liquid lies:
#: a thread in the middle of its cells. 1e5 x round-off
NO_SIDE = 1e-10
#: [-] squares of F, summed over eight neighbours. Reversed vortex with 64 cells .0070 to .0083 for .01 to .13, carried
#: disc 12 cells across .0066 with .06, .0068 without a fit, .0071 with .01, .0081 with .03
MISSED = 0.06


@inner
def area_under(a, b, alpha):
    """Share [0, 1] of the unit square with a x + b z <= alpha; not both 0."""
    alpha -= min(a, 0.0) + min(b, 0.0)
    a, b = abs(a), abs(b)
    total, low, high = a + b, min(a, b), max(a, b)
    least = min(alpha, total - alpha)
    if least <= 0.0:
        return 0.0 if alpha <= 0.0 else 1.0
    share = 0.5 * least * least / (low * high) if least < low else (least - 0.5 * low) / high
    return share if 2.0 * alpha <= total else 1.0 - share


@inner
def line_offset(a, b, F):
    """alpha of the line that leaves the share F, 0 to 1, below it: the inverse of `area_under`."""
    below = min(a, 0.0) + min(b, 0.0)
    a, b = abs(a), abs(b)
    low, high, share = min(a, b), max(a, b), min(F, 1.0 - F)
    least = np.sqrt(2.0 * low * high * share) if 2.0 * high * share < low else high * share + 0.5 * low
    return below + (least if F <= 0.5 else a + b - least)


@inner
def _square(x):
    return x * x


@inner
def _misfit_of_row(row, wide, a, b, alpha, tall):
    """Sum of squares over the cells left and right. row: F; wide: widths left and right; tall: the row's own."""
    left = area_under(a * wide[0], b * tall, alpha + a * wide[0]) - row[0]
    right = area_under(a * wide[1], b * tall, alpha - a) - row[2]
    return _square(left) + _square(right)


@inner
def missed_by(rows, wide, tall, a, b):
    """Sum of squares of what the line misses F by, in the eight neighbours; arguments as of `line_vector`."""
    alpha = line_offset(a, b, rows[1][1])
    low, high = alpha + b * tall[0], alpha - b
    middle = _square(area_under(a, b * tall[0], low) - rows[0][1]) + _square(
        area_under(a, b * tall[1], high) - rows[2][1]
    )
    ends = _misfit_of_row(rows[0], wide, a, b, low, tall[0]) + _misfit_of_row(rows[2], wide, a, b, high, tall[1])
    return _misfit_of_row(rows[1], wide, a, b, alpha, 1.0) + (middle + ends)


@inner
def _chord(a, b, alpha, x, wide, z, tall):
    """(l, X): extent along x, and middle, of the line in the cell x .. x + wide, z .. z + tall; b not 0."""
    low, high = x, x + wide
    if a != 0.0:
        one, other = (alpha - b * z) / a, (alpha - b * (z + tall)) / a
        low, high = max(low, min(one, other)), min(high, max(one, other))
    elif alpha / b < z or alpha / b > z + tall:
        return 0.0, x
    return max(high - low, 0.0), 0.5 * (low + high)


@inner
def _turn(share, a, b, alpha, x, wide, z, tall, X):
    """(dA/da (A - F), (dA/da)^2) of a neighbour with F = share, for the Gauss-Newton step."""
    length, middle = _chord(a, b, alpha, x, wide, z, tall)
    if length == 0.0:
        return 0.0, 0.0
    rate = length / (abs(b) * wide * tall) * (X - middle)
    return rate * (area_under(a * wide, b * tall, alpha - a * x - b * z) - share), rate * rate


@inner
def _improved(rows, wide, tall, a, b, misfit):
    """a after a Gauss-Newton step, b = +-1 kept; a itself where that is no better."""
    alpha = line_offset(a, b, rows[1][1])
    X = _chord(a, b, alpha, 0.0, 1.0, 0.0, 1.0)[1]
    left, low = wide[0], tall[0]
    down0 = _turn(rows[0][0], a, b, alpha, -left, left, -low, low, X)
    down1 = _turn(rows[0][1], a, b, alpha, 0.0, 1.0, -low, low, X)
    down2 = _turn(rows[0][2], a, b, alpha, 1.0, wide[1], -low, low, X)
    same0 = _turn(rows[1][0], a, b, alpha, -left, left, 0.0, 1.0, X)
    same2 = _turn(rows[1][2], a, b, alpha, 1.0, wide[1], 0.0, 1.0, X)
    up0 = _turn(rows[2][0], a, b, alpha, -left, left, 1.0, tall[1], X)
    up1 = _turn(rows[2][1], a, b, alpha, 0.0, 1.0, 1.0, tall[1], X)
    up2 = _turn(rows[2][2], a, b, alpha, 1.0, wide[1], 1.0, tall[1], X)
    slope = (same0[0] + same2[0]) + ((down0[0] + down2[0]) + (up0[0] + up2[0])) + (down1[0] + up1[0])
    square = (same0[1] + same2[1]) + ((down0[1] + down2[1]) + (up0[1] + up2[1])) + (down1[1] + up1[1])
    if not square > 0.0:
        return a
    better = a - slope / square
    return better if missed_by(rows, wide, tall, better, b) < misfit else a


@inner
def _best_slope(rows, wide, tall, left, centred, right, b):
    """(misfit, a) of the best of three lines a x + b z with b = +-1."""
    of_centred = missed_by(rows, wide, tall, centred, b)
    of_left, of_right = missed_by(rows, wide, tall, left, b), missed_by(rows, wide, tall, right, b)
    if min(of_left, of_right) >= of_centred or abs(of_left - of_right) <= EQUAL * (of_left + of_right):
        return of_centred, centred
    return (of_left, left) if of_left < of_right else (of_right, right)


@inner
def _heights(rows, tall):
    """Liquid in the three columns along z, in heights of the middle cell."""
    return (
        rows[1][0] + (tall[0] * rows[0][0] + tall[1] * rows[2][0]),
        rows[1][1] + (tall[0] * rows[0][1] + tall[1] * rows[2][1]),
        rows[1][2] + (tall[0] * rows[0][2] + tall[1] * rows[2][2]),
    )


@inner
def _slopes(rows, wide, tall):
    """Slopes of the height: to the left, centred (second order on graded cells), and to the right."""
    h = _heights(rows, tall)
    near, far = 0.5 + 0.5 * wide[0], 0.5 + 0.5 * wide[1]
    left, right = (h[1] - h[0]) / near, (h[2] - h[1]) / far
    return left, (far * left + near * right) / (near + far), right


@inner
def _candidate(rows, wide, tall, rise):
    """(misfit, a, b) of the best line from columns along z; rise: F above less F below. Misfit inf: no side known."""
    if not abs(rise) > NO_SIDE:
        return np.inf, 0.0, 0.0
    b = 1.0 if rise < 0.0 else -1.0
    left, centred, right = _slopes(rows, wide, tall)
    misfit, a = _best_slope(rows, wide, tall, -left, -centred, -right, b)
    return misfit, a, b


@inner
def line_vector(a, b, rows, wide, tall):
    """(a, b) itself, or of a line in the middle cell that fits better, out of the liquid, in units of the cell.

    rows: F [-] of the 3 x 3 cells, three along x for each of three z. wide, tall: widths of the left and right, and of
    the lower and upper cells [-], in widths of the middle one. (0, 0): nothing says where the liquid lies.
    """
    if (a == 0.0 and b == 0.0) or missed_by(rows, wide, tall, a, b) <= MISSED:
        return a, b
    columns = (
        (rows[0][0], rows[1][0], rows[2][0]),
        (rows[0][1], rows[1][1], rows[2][1]),
        (rows[0][2], rows[1][2], rows[2][2]),
    )
    up = 2.0 * (rows[2][1] - rows[0][1]) + ((rows[2][0] - rows[0][0]) + (rows[2][2] - rows[0][2]))
    right = 2.0 * (rows[1][2] - rows[1][0]) + ((rows[0][2] - rows[0][0]) + (rows[2][2] - rows[2][0]))
    along_z = _candidate(rows, wide, tall, up)
    along_x = _candidate(columns, tall, wide, right)
    if along_z[0] == np.inf and along_x[0] == np.inf:
        return a, b
    if along_z[0] <= along_x[0]:
        return _improved(rows, wide, tall, along_z[1], along_z[2], along_z[0]), along_z[2]
    return along_x[2], _improved(columns, tall, wide, along_x[1], along_x[2], along_x[0])
