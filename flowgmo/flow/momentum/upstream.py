"""The value at the end of a stretch of mesh, taken from upstream: for advection.

Nodes lie on faces along their own component's direction, in cell centres along the other two. End m is half way along
cell m + 1 in the first case, the upper plane of cell m in the second:

    own        node m (plane)   end m   node m + 1 (plane)         gap m = dx[m + 1]
                  |---------- cell m + 1 ---------|

    across     node m (centre)    end m (plane)   node m + 1 (centre)    gap m = hy[m]
                  o---------------|---------------o

From the node upstream (m, when U > 0), with b the difference to the node beyond the end and a the one before,

    q_end = q_m + least of { b, a', (a' + 2 b') / 6 },        0 where they oppose

a', b': the differences over twice the distance from the node to the end. (a' + 2 b') / 6 is third order on equal cells,
exact for linear q on any; the bounds b and a' are those of Koren 1993 (A robust upwind discretization method for
advection, diffusion and source terms). The end's value so lies between its neighbours, and the step is at most
a'. Chosen by measurement: a sine after one turn on 64 equal cells, Courant number 1/4, mean error in 1e-3 (order), and
that of a step on 100 cells:

    minmod 19.9 (1.8)  .063     van Leer 9.2 (2.0)  .044     van Albada 13.2 (2.0)  .049
    MC      6.6 (1.9)  .038     superbee 12.8 (1.7) .018     Koren       3.0 (2.2)  .033
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flowgmo.kernel import inner

UPWIND, MONOTONE = 1, 3  # IORDER

Array = np.ndarray


class Ends(NamedTuple):
    """lower, upper [1/length] (n + 4,): 1 / (2 d) for the ends below and above node m, d its distance to the end."""

    lower: Array
    upper: Array


class Slopes(NamedTuple):
    """(n + 4,): a' = a up_a, b' = b up_b at end m for node m upstream; down_a, down_b for node m + 1."""

    up_a: Array
    up_b: Array
    down_a: Array
    down_b: Array


def make_ends(d: Array, *, own: bool) -> Ends:
    """For cells of widths d (n + 4,); own: nodes on faces."""
    r = 1.0 / d
    return Ends(r, _next(r) if own else r)


def make_slopes(d: Array, h: Array, *, own: bool) -> Slopes:
    """For cells of widths d (n + 4,) with centres h (n + 4,) apart; own: nodes on faces."""
    above = _next(d)
    gap = above if own else h
    width, width_above = (above, above) if own else (d, above)  # twice the distance to the end
    before = np.append(gap[0], gap[:-1])
    return Slopes(width / before, width / gap, width_above / _next(gap), width_above / gap)


def _next(a: Array) -> Array:
    """The neighbour above; the last entry repeats itself and is not used."""
    return np.append(a[1:], a[-1])


@inner
def end_value(U, below2, below, above, above2, slopes, m):
    """q at end m, between nodes `below` and `above`, when U carries it; slopes None: first order."""
    forward = U > 0.0
    if slopes is None:
        return below if forward else above
    # both sides are computed before one is taken: what is read on one side only becomes a read of single values
    b = above - below
    a_up, b_up = (below - below2) * slopes.up_a[m], b * slopes.up_b[m]
    a_down, b_down = (above2 - above) * slopes.down_a[m], b * slopes.down_b[m]
    a = a_up if forward else a_down
    scaled_b = b_up if forward else b_down
    mean = a * (1.0 / 6.0) + scaled_b * (1.0 / 3.0)
    step = max(min(min(a, b), mean), 0.0) + min(max(max(a, b), mean), 0.0)
    from_below, from_above = below + step, above - step
    return from_below if forward else from_above
