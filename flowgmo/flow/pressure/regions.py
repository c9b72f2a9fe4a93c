"""Regions of connected open cells, kept while bodies move.

Not cells are joined but runs: the open cells of a vertical line that open faces connect. A mesh has about as many runs
as lines, and hardly more joins between those of lines side by side, so that both are listed:

    runs    of every line: first cell and one past the last          read from V and Az of the line
    joins   of every pair of lines beside each other: which run of one and which of the other an open face connects

Where bodies have changed cells, the lines of these are read again, and their joins; the others' are taken over. Then
the runs are sorted into regions, all of them (a matter of lines, not of cells), and numbers are written where they are
others than before: the same as if everything had been done anew.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.fields import G, Open
from flowgmo.kernel import free_kernel, inner, kernel

Array = np.ndarray
SPARE = 256  # runs and joins that a step may add before all are listed a second time


@kernel
def _find(parent, a):
    """The root of a run's tree, with the way to it halved."""
    while parent[a] != a:
        parent[a] = parent[parent[a]]
        a = parent[a]
    return a


@free_kernel
def list_runs(V, Az, again, old_first, old_runs, old_number, first, runs, number):
    """Fill first (lines + 1,), runs (r, 2) as far as they reach, and number (r,): what their label is, -1 where it is
    not written yet; returns how many there are. again (lines,): those to be read; of the others the old ones hold."""
    nx, ny, nz = V.shape
    count = np.int64(0)
    line = np.int64(0)
    for i in range(G, nx - G):
        for j in range(G, ny - G):
            first[line] = count
            if not again[line]:
                for r in range(old_first[line], old_first[line + 1]):
                    if count < len(runs):
                        runs[count, 0] = old_runs[r, 0]
                        runs[count, 1] = old_runs[r, 1]
                        number[count] = old_number[r]
                    count += 1
            else:
                for k in range(G, nz - G):
                    if V[i, j, k] == 0.0:
                        continue
                    if k == G or V[i, j, k - 1] == 0.0 or Az[i, j, k - 1] == 0.0:
                        count += 1
                        if count <= len(runs):
                            runs[count - 1, 0] = k
                            number[count - 1] = -1
                    if count <= len(runs):
                        runs[count - 1, 1] = k + 1
            line += 1
    first[line] = count
    return count


@inner
def _beside(i, j, d, lines, joined):
    """The line after line (i, j) along x (d 0) or y; -1 at the side of a domain that is not joined to the other one."""
    i += 1 - d
    j += d
    if i == lines[0]:
        i = 0 if joined[0] else np.int64(-1)
    if j == lines[1]:
        j = 0 if joined[1] else np.int64(-1)
    return i * lines[1] + j if i >= 0 and j >= 0 else np.int64(-1)


@free_kernel
def list_joins(Ax, Ay, again, first, runs, joined, old_first, old_joins, out_first, joins):
    """Fill out_first (2 lines + 1,) and joins (n, 2) as far as it reaches: numbers of the runs within their lines, for
    each line those with the line after it along x, then along y; returns how many there are."""
    lines = Ax.shape[0] - 2 * G, Ax.shape[1] - 2 * G
    count = np.int64(0)
    line = np.int64(0)
    for i in range(lines[0]):
        for j in range(lines[1]):
            for d in range(2):
                out_first[2 * line + d] = count
                other = _beside(i, j, d, lines, joined)
                if other < 0:
                    continue
                if not again[line] and not again[other]:
                    for n in range(old_first[2 * line + d], old_first[2 * line + d + 1]):
                        if count < len(joins):
                            joins[count, 0] = old_joins[n, 0]
                            joins[count, 1] = old_joins[n, 1]
                        count += 1
                    continue
                a = first[line]
                b = first[other]
                while a < first[line + 1] and b < first[other + 1]:
                    end = min(runs[a, 1], runs[b, 1])
                    k = max(runs[a, 0], runs[b, 0])
                    while k < end and (Ax[i + G, j + G, k] if d == 0 else Ay[i + G, j + G, k]) == 0.0:
                        k += 1
                    if k < end:
                        if count < len(joins):
                            joins[count, 0] = a - first[line]
                            joins[count, 1] = b - first[other]
                        count += 1
                    ends = runs[a, 1]
                    if ends <= runs[b, 1]:
                        a += 1
                    if runs[b, 1] <= ends:
                        b += 1
            line += 1
    out_first[2 * lines[0] * lines[1]] = count
    return count


@free_kernel
def join_runs(Az, first, runs, join_first, joins, joined, parent):
    """parent (r,) becomes the number of each run's region, in the order of their first runs; returns how many."""
    lines = Az.shape[0] - 2 * G, Az.shape[1] - 2 * G
    high = np.int64(Az.shape[2] - G)
    line = np.int64(0)
    for i in range(lines[0]):
        for j in range(lines[1]):
            for d in range(2):
                other = _beside(i, j, d, lines, joined)
                for n in range(join_first[2 * line + d], join_first[2 * line + d + 1]):
                    a = _find(parent, np.int64(first[line] + joins[n, 0]))
                    parent[_find(parent, np.int64(first[other] + joins[n, 1]))] = a
            if joined[2] and first[line] < first[line + 1]:
                a, b = first[line], first[line + 1] - 1
                open_face = Az[i + G, j + G, high - 1] > 0.0
                if open_face and runs[a, 0] == G and runs[b, 1] == high:
                    parent[_find(parent, np.int64(b))] = _find(parent, np.int64(a))
            line += 1
    number = np.full(len(parent), -1, np.int64)
    count = np.int64(0)
    for run in range(len(parent)):
        root = _find(parent, np.int64(run))
        if number[root] < 0:
            number[root] = count
            count += 1
    for run in range(len(parent)):
        number[run] = number[_find(parent, np.int64(run))]
    parent[:] = number
    return count


@free_kernel
def write_labels(again, first, runs, number, region, label):
    """label of the lines that were read again or whose runs have other numbers now; number becomes region (r,)."""
    ny = label.shape[1] - 2 * G
    high = label.shape[2] - G
    for line in range(len(again)):
        i = line // ny + G
        j = line % ny + G
        if again[line]:
            for k in range(G, high):
                label[i, j, k] = -1
        for r in range(first[line], first[line + 1]):
            if again[line] or number[r] != region[r]:
                for k in range(runs[r, 0], runs[r, 1]):
                    label[i, j, k] = region[r]
            number[r] = region[r]


@free_kernel
def count_cells(first, runs, region, lines, high, held, cells, reached):
    """Per region: cells, and whether it touches a side that is `held` (6,)."""
    for line in range(lines[0] * lines[1]):
        i = line // lines[1]
        j = line % lines[1]
        beside = (
            (held[0] and i == 0) or (held[1] and i == lines[0] - 1) or (held[2] and j == 0)
            or (held[3] and j == lines[1] - 1)
        )  # fmt: skip
        for r in range(first[line], first[line + 1]):
            cells[region[r]] += runs[r, 1] - runs[r, 0]
            if beside or (held[4] and runs[r, 0] == G) or (held[5] and runs[r, 1] == high):
                reached[region[r]] = True


class Regions:
    """Of the open cells of a block. label (mesh) int32: number of each cell's region, -1: closed; cells (n,): how many
    each has; reached (n,): whether it touches a held side. again: lines that were read at the last renewal."""

    def __init__(self, openings: Open, held: tuple[bool, ...], joined: tuple[bool, ...]) -> None:
        """held (6,): sides that count for `reached`; joined (3,): the two sides across a direction are one."""
        self.openings, self.held, self.joined = openings, np.array(held), np.array(joined)
        self.label = np.full(openings.V.shape, -1, np.int32)
        self.lines = np.array(openings.V.shape[:2]) - 2 * G
        n = int(self.lines.prod())
        self._first, self._join_first = np.zeros(n + 1, np.int64), np.zeros(2 * n + 1, np.int64)
        self._runs, self._number = np.zeros((n, 2), np.int32), np.zeros(n, np.int64)
        self._joins = np.zeros((2 * n, 2), np.int32)
        self.renew(None)

    def renew(self, changed: Array | None) -> None:
        """Open fractions of cells changed (n, 3) [with ghosts], or of their lower faces, are others now; None: all."""
        again = np.full(int(self.lines.prod()), changed is None)
        if changed is not None:
            again[(changed[:, 0] - G) * self.lines[1] + changed[:, 1] - G] = True
        self.again = again
        self._list(again)
        region = np.arange(len(self._runs))
        args = self._first, self._runs, self._join_first, self._joins, self.joined
        count = join_runs(self.openings.Az, *args, region)
        write_labels(again, self._first, self._runs, self._number, region, self.label)
        self.cells, self.reached = np.zeros(count, np.int64), np.zeros(count, bool)
        high = self.label.shape[2] - G
        count_cells(self._first, self._runs, region, self.lines, high, self.held, self.cells, self.reached)

    def _list(self, again: Array) -> None:
        """Runs and joins as they are now."""
        V, Ax, Ay, Az = self.openings
        first, size, count = np.empty_like(self._first), len(self._runs) + SPARE, 1
        while count:  # a second time where there are many more than before
            runs, number = np.empty((size, 2), np.int32), np.empty(size, np.int64)
            found = list_runs(V, Az, again, self._first, self._runs, self._number, first, runs, number)
            count, size = max(found - size, 0), found
        self._first, self._runs, self._number = first, runs[:found], number[:found]
        join_first, size, count = np.empty_like(self._join_first), len(self._joins) + SPARE, 1
        while count:
            joins = np.empty((size, 2), np.int32)
            old = self._join_first, self._joins
            found = list_joins(Ax, Ay, again, self._first, self._runs, self.joined, *old, join_first, joins)
            count, size = max(found - size, 0), found
        self._join_first, self._joins = join_first, joins[:found]
