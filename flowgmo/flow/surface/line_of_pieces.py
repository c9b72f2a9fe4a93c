"""The surface of a thread thinner than a cell: from where the liquid lies that the last step carried into the cell.

Where the best line still misses F of the eight neighbours by TORN, nine F do not say how the liquid lies; a line from
them puts it to one side, each time it is found, and tears the thread. There the line is taken whose first moments are
nearest to those that the pieces of the last step have in the cell (carried_moments.py, line_moments.py), if they are
known.
"""

from __future__ import annotations

from flowgmo.flow.fields import G
from flowgmo.flow.surface.carriers import next_along
from flowgmo.flow.surface.line_fit import missed_by
from flowgmo.flow.surface.line_moments import nearest_line
from flowgmo.flow.surface.plic import FULL, is_plane
from flowgmo.kernel import inner

KNOWN = 1.0 - FULL  # [-] F may differ by what the pressure leaves open in full cells: these take part evenly
#: [-] squares of F, summed over eight neighbours. Reversed vortex with 32 and 64 cells, means of six lengths of step:
#: none .0568 .0074, .06 .0220 .0081, .4 .0187 .0089, .6 .0221 .0070, .8 .0314 .0071, 1 .0356 .0087
TORN = 0.6


@inner
def line_of_pieces(F, steps, moments, m, i, j, k):
    """m of a mixed cell, or of the line that its moments tell, where m misses the neighbours' F by TORN."""
    here = F[i, j, k]
    known = moments[i, j, k, 0]
    if not abs(known - here) < KNOWN:
        return m
    flat = 1 if F.shape[1] == 1 + 2 * G else (0 if F.shape[0] == 1 + 2 * G else 2)
    p, q = (1 if flat == 0 else 0), (1 if flat == 2 else 2)
    wide, tall = _widths(steps, p, i, j, k), _widths(steps, q, i, j, k)
    rows = _row(F, p, q, i, j, k, -1), _row(F, p, q, i, j, k, 0), _row(F, p, q, i, j, k, 1)
    if is_plane(m) and missed_by(rows, wide, tall, m[p], m[q]) <= TORN:
        return m
    scale = here / known
    a, b = nearest_line(m[p], m[q], here, scale * moments[i, j, k, 1], scale * moments[i, j, k, 2])
    return (
        (a if p == 0 else 0.0),
        (a if p == 1 else (b if q == 1 else 0.0)),
        (b if q == 2 else 0.0),
    )


@inner
def _row(F, p, q, i, j, k, by):
    """F of three cells along p, `by` cells along q."""
    a, b, c = next_along(q, i, j, k, by)
    e, f, g = next_along(p, a, b, c, -1)
    x, y, z = next_along(p, a, b, c, 1)
    return F[e, f, g], F[a, b, c], F[x, y, z]


@inner
def _widths(steps, d, i, j, k):
    """Widths of the neighbours before and after along d, in those of the cell."""
    if d == 0:
        return steps.x[3, i], steps.x[2, i]
    return (steps.y[3, j], steps.y[2, j]) if d == 1 else (steps.z[3, k], steps.z[2, k])
