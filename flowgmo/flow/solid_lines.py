"""Lines along z that no solid comes near: most of a mesh. Their open fractions are 1 and need not be read.

A kernel that does little with each value waits for memory: with V and A of the faces it asks for half as much again, or
twice. So a line is looked up once, and where it is free the same code runs without them (`inlined`, with None in place
of V and A): the same bits, since 1 a = a.

    own   (mesh without z) int8     1: V, or A of an upper face, is below 1 somewhere in the line
    lines (mesh without z) int8     1: own is, of one of the 3 x 3 lines around: the faces below belong to these

Where bodies move, every cell of which something is written marks its line at once (`mark`); a line is taken back at the
start of a step (`renew`), when all of it is 1 again. What a step does to open fractions after that it does in cells
that the bodies touch, which are marked.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.ahead import ask_ahead_where
from flowgmo.flow.fields import G, Open
from flowgmo.kernel import inner, kernel


class SolidLines:
    """Of one scene. watched: whoever writes open fractions says so (`mark`, `renew`); else all lines are 1. still: the
    scene's solids never move."""

    def __init__(self, *, watched: bool = False) -> None:
        self.watched, self.still = watched, False
        self._own: np.ndarray | None = None
        self._lines = np.zeros((0, 0), np.int8)
        self._known = False

    def of(self, opened: Open) -> np.ndarray | None:
        """The lines of these open fractions; None without solids."""
        if opened.V is None:
            return None
        if not self.watched:
            return np.ones(opened.V.shape[:2], np.int8)
        if self._own is None:
            self._look(opened)
        if not self._known:
            self._lines.fill(0)
            spread(self._own, self._lines)
            self._known = True
        return self._lines

    def mark(self, cells: np.ndarray) -> None:
        """Open fractions of cells (n, 3), or of their faces, have been written."""
        if self._own is not None and len(cells):
            mark_lines(cells, self._own)
            self._known = False

    def renew(self, opened: Open, cells: np.ndarray | None) -> None:
        """Take back lines that are all open again; cells (n, 3): those that solids touch in the step to come, None: not
        known, all is looked at."""
        if opened.V is None or not self.watched:
            return
        if self._own is None or cells is None:
            self._look(opened)
        else:
            look_again(*opened, self._own)
            self.mark(cells)
        self._known = False

    def _look(self, opened: Open) -> None:
        self._own, self._lines, self._known = find_own(opened), np.zeros(opened.V.shape[:2], np.int8), False


def find_own(opened: Open) -> np.ndarray:
    """own as above, of these open fractions."""
    return np.any([(a < 1.0).any(axis=2) for a in opened if a is not None], axis=0).astype(np.int8)


@kernel
def look_again(V, Ax, Ay, Az, own):
    """own of the lines where it is set, as the open fractions are now."""
    for i in range(own.shape[0]):
        for j in range(own.shape[1]):
            if own[i, j] != 0:
                own[i, j] = 0
                for k in range(V.shape[2]):
                    if V[i, j, k] < 1.0 or Ax[i, j, k] < 1.0 or Ay[i, j, k] < 1.0 or Az[i, j, k] < 1.0:
                        own[i, j] = 1
                        break


@kernel
def mark_lines(cells, own):
    """own = 1 in the lines of cells (n, 3), and in the ghosts that may be their images: at either side."""
    nx, ny = own.shape
    for c in range(len(cells)):
        own[cells[c, 0], cells[c, 1]] = 1
    for i in range(nx):
        both = own[i, G] | own[i, G + 1] | own[i, ny - G - 1] | own[i, ny - G - 2]
        for g in range(G):
            own[i, g] |= both
            own[i, ny - 1 - g] |= both
    for j in range(ny):
        both = own[G, j] | own[G + 1, j] | own[nx - G - 1, j] | own[nx - G - 2, j]
        for g in range(G):
            own[g, j] |= both
            own[nx - 1 - g, j] |= both


@kernel
def spread(own, lines):
    """lines: not 0 where own is not, or in one of the lines around; what they hold before stays."""
    nx, ny = own.shape
    for i in range(nx):
        for j in range(ny):
            if own[i, j] != 0:
                for m in range(max(i - 1, 0), min(i + 2, nx)):
                    for n in range(max(j - 1, 0), min(j + 2, ny)):
                        lines[m, n] = 1


@inner
def ask_at_solids(columns, c, last, a, lines):
    """ask_ahead of open fractions a, where they are read."""
    if a is not None:
        ask_ahead_where(columns, c, last, a, lines)
