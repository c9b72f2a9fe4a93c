"""Liquid that full pockets would shut in, though there is void beyond them: they stay open.

A pocket that is full has a pressure and takes its room R, no more (pockets.py). What it is given beyond that the liquid
beside it has to send elsewhere: to the surface, to voids with room. Where full pockets are all that a few cells of
liquid have around them there is no elsewhere,

    solid  | pocket, full | liquid | pocket, full |  void             sum b (q - q_neighbour) = in* - R > 0

summed over these cells the left side vanishes and the right one does not: no pressure is high enough. In the slits of a
plug that wedged in its channel (hard/wet_plug_free: cells open by 1e-9, through faces of a hundredth) the solver ended
at 53 MPa, or at 1e50, and the steps at dtmin. But liquid is not pressed together there: it goes on through the full
pocket into the void beyond. So such a pocket has no bound: it takes what comes at zero pressure, and what it cannot
hold goes on to its neighbours (surface/spill_over.py).

Where a space is full in fact there is no void beyond, and nothing changes (sealed.py).
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.fields import G, Open
from flowgmo.kernel import inner, kernel

UNSEEN, LED_OUT, NOW, LEADS_OUT, SHUT_IN = 0, 1, 2, 3, 4  # marks of cells, see open_shut_in


@inner
def _beside(f, i, j, k):
    """Of face f = 0 .. 5 (Xmin .. Zmax) of a cell: the cell whose upper face it is, the cell beyond."""
    d, s = f // 2, np.int64(2 * (f % 2) - 1)
    beyond = (i + s * (d == 0), j + s * (d == 1), k + s * (d == 2))
    return (beyond, beyond) if s < 0 else ((i, j, k), beyond)


@inner
def _of(f, a, b, c, at):
    """The value of face f in one of three arrays, 0 in absent directions (None)."""
    value = 0.0
    if a is not None:
        value = a[at] if f < 2 else value
    if b is not None:
        value = b[at] if 2 <= f < 4 else value
    if c is not None:
        value = c[at] if f >= 4 else value
    return value


@inner
def _outside(at, shape):
    """Whether a cell is a ghost."""
    found = False
    for d in range(3):
        found |= at[d] < G or at[d] >= shape[d] - G
    return found


@inner
def _has_void_beside(opened, wet, i, j, k):
    """Whether an open face of a cell leads to one that is open and not liquid."""
    found = False
    for f in range(6):
        face, beyond = _beside(f, i, j, k)
        if not _outside(beyond, wet.shape) and _of(f, opened.Ax, opened.Ay, opened.Az, face) > 0.0:
            found |= wet[beyond] == 0 and opened.V[beyond] > 0.0
    return found


@inner
def _with_room(queue, last):
    """A queue (n, 3) whose first `last` rows are used, with room for the six neighbours of a cell."""
    longer = queue
    if last + 6 > len(queue):
        longer = np.empty((2 * len(queue), 3), np.int32)
        longer[:last] = queue[:last]
    return longer


@kernel
def open_shut_in(pockets, shut, lids, opened, wet, bx, by, bz, mark, kept_open):
    """Open, in shut (n,) bool and wet, the pockets (n, 3) of liquid that has no way out, where void is beyond them, and
    note them in kept_open (n,). lids (m, 3): cells with an open surface inside; mark: int8 of mesh size, 0 before and
    after."""
    queue = np.empty((256, 3), np.int32)
    last = np.int64(0)
    for m in range(len(lids)):
        mark[lids[m, 0], lids[m, 1], lids[m, 2]] = LEADS_OUT
    for n in range(len(pockets)):
        at = (np.int64(pockets[n, 0]), np.int64(pockets[n, 1]), np.int64(pockets[n, 2]))
        if not shut[n] or mark[at] != UNSEEN:
            continue
        first = last
        head = last
        out = False
        mark[at] = NOW
        queue = _with_room(queue, last)
        queue[last, 0], queue[last, 1], queue[last, 2] = at
        last += 1
        while head < last and not out:
            queue = _with_room(queue, last)
            i, j, k = np.int64(queue[head, 0]), np.int64(queue[head, 1]), np.int64(queue[head, 2])
            head += 1
            for f in range(6):
                face, beyond = _beside(f, i, j, k)
                if not _of(f, bx, by, bz, face) > 0.0:
                    continue
                if _outside(beyond, wet.shape) or wet[beyond] == 0:
                    out = True
                elif mark[beyond] == LED_OUT or mark[beyond] == LEADS_OUT:
                    out = True
                elif mark[beyond] == UNSEEN:
                    mark[beyond] = NOW
                    queue[last, 0], queue[last, 1], queue[last, 2] = beyond
                    last += 1
        if not out:
            for m in range(len(pockets)):
                own = (np.int64(pockets[m, 0]), np.int64(pockets[m, 1]), np.int64(pockets[m, 2]))
                if shut[m] and mark[own] == NOW and _has_void_beside(opened, wet, own[0], own[1], own[2]):
                    kept_open[m] = True
        for m in range(first, last):
            mark[queue[m, 0], queue[m, 1], queue[m, 2]] = LED_OUT if out else SHUT_IN
    for m in range(last):
        mark[queue[m, 0], queue[m, 1], queue[m, 2]] = UNSEEN
    for m in range(len(lids)):
        mark[lids[m, 0], lids[m, 1], lids[m, 2]] = UNSEEN
    for n in range(len(pockets)):
        if kept_open[n]:
            shut[n] = False
            wet[pockets[n, 0], pockets[n, 1], pockets[n, 2]] = 0


class WaysOut:
    """Which pockets of a projection stay open; kept_open (n,) bool."""

    def __init__(self, openings: Open) -> None:
        self.openings = openings
        self.mark = None if openings.V is None else np.zeros(openings.V.shape, np.int8)
        self.kept_open = np.zeros(0, bool)

    def begin(self, pockets: np.ndarray) -> None:
        """For pockets (n, 3): none yet."""
        self.pockets, self.kept_open = pockets, np.zeros(len(pockets), bool)

    def open(self, shut: np.ndarray, lids: np.ndarray, wet: np.ndarray, b: tuple) -> None:
        """Open those of shut (n,) bool that leave liquid without a way out, in `shut` and in wet (mesh), which is 1 in
        liquid cells and in shut pockets. lids (m, 3): liquid cells with an open surface inside; b [bx, by, bz]."""
        if shut.any():
            open_shut_in(self.pockets, shut, lids, self.openings, wet, *b, self.mark, self.kept_open)
