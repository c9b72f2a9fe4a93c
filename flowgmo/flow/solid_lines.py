"""Lines along z that no solid comes near: most of a mesh. Their open fractions are 1 and need not be read.

A kernel that does little with each value waits for memory: with V and A of the faces it asks for half as much again, or
twice. So a line is looked up once, and where it is free the same code runs without them (`inlined`, with None in place
of V and A): the same bits, since 1 a = a.

    lines (mesh without z) int8     0: V, and A of all upper faces, are 1 in all of the 3 x 3 lines around

so that the faces below belong to it, and all cells that share an edge. Where bodies move all are 1: the fractions
change with every step.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.ahead import ask_ahead_where
from flowgmo.flow.fields import Open
from flowgmo.kernel import inner


class SolidLines:
    """Of one scene. still: its solids never move, so that lines are looked for once."""

    def __init__(self, *, still: bool = False) -> None:
        self.still = still
        self._lines: np.ndarray | None = None

    def of(self, opened: Open) -> np.ndarray | None:
        """The lines of these open fractions; None without solids."""
        if opened.V is None:
            return None
        if self._lines is None:
            self._lines = find_lines(opened) if self.still else np.ones(opened.V.shape[:2], np.int8)
        return self._lines


def find_lines(opened: Open) -> np.ndarray:
    """Lines as above, of these open fractions."""
    touched = np.pad(np.any([(a < 1.0).any(axis=2) for a in opened if a is not None], axis=0), 1)
    n, m = opened.V.shape[:2]
    return np.any([touched[i : i + n, j : j + m] for i in range(3) for j in range(3)], axis=0).astype(np.int8)


@inner
def ask_at_solids(columns, c, last, a, lines):
    """ask_ahead of open fractions a, where they are read."""
    if a is not None:
        ask_ahead_where(columns, c, last, a, lines)
