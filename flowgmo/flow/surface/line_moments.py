"""A line in a cell from where its liquid lies: F and the first moments M = integral of (x, z) over the liquid.

    a x + b z <= alpha in the unit square; out of the liquid points n = (a, b) / |(a, b)|, along the line t

F says how much is below the line, M where: of all lines with that F the one is taken whose moments are nearest (moment
of fluid). Turned by an angle d about the middle of its chord, L long, a line moves its moments by

    dM = - t L^3 / 12 d,      so that with e = M(line) - M:  e . t = 0 at the nearest,  d = e . t / (L^3 / 12 + e . n)
                              is Newton's step to it (t turns by - n d)

F in the nine cells says as much of a smooth surface. Of a thread thinner than a cell it does not: whether the liquid
lies at the left, in the middle or at the right only the way that it came knows.

Dyadechko and Shashkov 2008 ("Reconstruction of multi-material interfaces from moment data", J. Comput. Phys. 227).
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.surface.line_fit import line_offset
from flowgmo.kernel import inner

#: [-] of the cell's width: a centroid nearer to the middle than that does not say on which side the liquid is. 1e7 x
#: round-off
MIDDLE = 1e-9
TURNS = 20  # ends by itself after 3 to 9; the bound only makes it certain
STILL = 1e-13  # [radian] turns below it are round-off
LONGEST = 0.5  # [radian] in one step: moments follow a turn for about so far
CURVED = 0.2  # least share of L^3 / 12 in the derivative: e . n may cancel it where the liquid is a thread
LEVEL = 1e-13  # [-] relative: distances squared at their least that differ by less do so by round-off


@inner
def _in_corner(a, b, alpha):
    """(area, Mx, Mz) below the line in the unit square for a, b >= 0, not both 0, and alpha <= (a + b) / 2."""
    if alpha <= 0.0:
        return 0.0, 0.0, 0.0
    if alpha < min(a, b):  # a triangle
        area = 0.5 * alpha * alpha / (a * b)
        return area, area * alpha / (3.0 * a), area * alpha / (3.0 * b)
    low, high = min(a, b), max(a, b)
    here, there = alpha / high, (alpha - low) / high  # heights of the trapezoid at both ends
    along = here / 6.0 + there / 3.0
    across = (here * here + here * there + there * there) / 6.0
    area = 0.5 * (here + there)
    return (area, along, across) if a <= b else (area, across, along)


@inner
def moments_under(a, b, alpha):
    """(area, Mx, Mz) of the unit square's part with a x + b z <= alpha; a, b not both 0."""
    alpha -= min(a, 0.0) + min(b, 0.0)
    p, q = abs(a), abs(b)
    if 2.0 * alpha <= p + q:
        area, x, z = _in_corner(p, q, alpha)
    else:  # all but the corner opposite
        void, x, z = _in_corner(p, q, p + q - alpha)
        area, x, z = 1.0 - void, 0.5 - void + x, 0.5 - void + z
    return area, (area - x if a < 0.0 else x), (area - z if b < 0.0 else z)


@inner
def _chord_length(a, b, alpha):
    """Of the line in the unit square; (a, b) of length 1."""
    alpha -= min(a, 0.0) + min(b, 0.0)
    low, high = min(abs(a), abs(b)), max(abs(a), abs(b))
    least = min(alpha, low + high - alpha)
    return least / (low * high) if least < low else 1.0 / high


@inner
def _missed(a, b, F, Mx, Mz):
    """(e . t, step, e . e), e: moments of the line with (a, b) of length 1 less those given, step: Newton's."""
    alpha = line_offset(a, b, F)
    of_line = moments_under(a, b, alpha)
    x, z = of_line[1] - Mx, of_line[2] - Mz
    length = _chord_length(a, b, alpha)
    rate = length * length * length / 12.0
    along = a * z - b * x
    step = along / max(rate + (a * x + b * z), CURVED * rate)
    return along, max(min(step, LONGEST), -LONGEST), x * x + z * z


@inner
def nearest_line(a, b, F, Mx, Mz):
    """(a, b) of the line whose first moments are nearest to (Mx, Mz), F [-] below it, in a cell of unit width.

    The given (a, b) where the liquid lies about the middle: either side would do. Else the first guess is the
    direction from the liquid's centre to the cell's.
    """
    x, z = 0.5 * F - Mx, 0.5 * F - Mz
    size = np.sqrt(x * x + z * z)
    if not size > MIDDLE * F:
        return a, b
    a, b = x / size, z / size
    along, turn, off = _missed(a, b, F, Mx, Mz)
    for _ in range(TURNS):
        better = False
        while not better and abs(turn) > STILL:
            c, s = np.cos(turn), np.sin(turn)
            p, q = c * a - s * b, s * a + c * b
            next_along, next_turn, next_off = _missed(p, q, F, Mx, Mz)
            better = next_off < off or (abs(next_along) < abs(along) and next_off <= (1.0 + LEVEL) * off)
            turn *= 0.5
        if not better:
            break
        a, b, along, turn, off = p, q, next_along, next_turn, next_off
    return a, b
