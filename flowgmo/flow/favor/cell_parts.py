"""Open parts of cells near solids: six faces and the volume, summed over the equal pieces of each cell.

A pair is a cell and one solid near it. Each solid's own share comes from its distance alone; what is open is where the
distances of all pairs of the cell are positive, cut one after the other (cut_cell.py).
Faces in the order lower x, upper x, lower y, upper y, lower z, upper z; number 6 is the volume.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.favor.cut_cell import MOST_FIELDS, share_where_positive, work_space
from flowgmo.flow.fields import G
from flowgmo.kernel import inner, kernel


@inner
def node(i, j, k, pieces):
    """Number of a node in its cell."""
    return (i * (pieces + 1) + j) * (pieces + 1) + k


@inner
def corner_node(part, i, j, k, pieces):
    """Number of the node at (i, j, k) of the cell (part 6), or at (i, j) of one of its faces, whatever k."""
    if part == 6:
        return node(i, j, k, pieces)
    level = pieces * (part % 2)
    if part // 2 == 0:
        return node(level, i, j, pieces)
    if part // 2 == 1:
        return node(i, level, j, pieces)
    return node(i, j, level, pieces)


@inner
def _load(work, values, first, last, removed):
    """Put the fields of pairs first .. last - 1 that cut at the nodes work.nodes into the work space.

    Returns their number, -1 where one of them is nowhere positive; more than MOST_FIELDS are joined into the last.
    """
    count = np.int64(0)
    for p in range(first, last):
        bits = removed if p == first else 0
        positive = np.int64(0)
        for corner in range(8):
            at = work.nodes[corner]
            if values[p, at] > 0.0 and not (bits >> at) & 1:
                positive += 1
        if positive == 0:
            return np.int64(-1)
        if positive == 8:
            continue
        row = min(count, MOST_FIELDS - 1)
        for corner in range(8):
            at = work.nodes[corner]
            value = min(values[p, at], 0.0) if (bits >> at) & 1 else values[p, at]
            work.fields[row, corner] = value if count < MOST_FIELDS else min(value, work.fields[row, corner])
        count += 1
    return min(count, MOST_FIELDS)


@inner
def open_by(work, values, first, last, removed, pieces, part, step):
    """Open share of a part, cut in pieces of `step`."""
    total = 0.0
    for i in range(0, pieces, step):
        for j in range(0, pieces, step):
            for k in range(0, pieces if part == 6 else step, step):
                for corner in range(8):
                    work.nodes[corner] = corner_node(
                        part, i + step * (corner // 4), j + step * (corner // 2 % 2), k + step * (corner % 2), pieces
                    )
                fields = _load(work, values, first, last, removed)
                if fields == 0:
                    total += 1.0
                elif fields > 0:
                    total += share_where_positive(work, fields, part != 6)
    n = pieces // step
    return total / (n * n * n if part == 6 else n * n)


@inner
def extrapolated(fine, coarse):
    """(4 fine - coarse) / 3: without the leading error of chords, which is four times as large at twice the step.

    Changed by at most half of what it lacks to 0 and 1, so that neither is reached where the fine cut says otherwise.
    """
    room = 0.5 * min(fine, 1.0 - fine)
    return fine + min(max((fine - coarse) / 3.0, -room), room)


@inner
def open_share(work, values, first, last, removed, pieces, part, smooth):
    """Share of a part of a cell, 0 .. 5 a face, 6 the volume, that all pairs first .. last - 1 leave open.

    removed: bits of nodes behind a thin wall, which are covered whatever their distance. smooth: extrapolated, where
    pieces is even and no node is removed.
    """
    fine = 0.0
    for step in range(1, 3):
        share = open_by(work, values, first, last, removed, pieces, part, step)
        if step == 1 and (not smooth or pieces % 2 == 1 or removed != 0 or share == 0.0 or share == 1.0):
            return share
        if step == 2:
            return extrapolated(fine, share)
        fine = share
    return fine


@kernel
def cut_cells(starts, values, removed, pieces, covered, opened):
    """covered (p, 7) of each pair alone, opened (c, 7) of each cell, from the distances (p, (pieces + 1)^3) at nodes.

    starts (c + 1,): first pair of each cell; removed (c,): bits of the nodes that a thin wall cuts off.
    """
    work = work_space()
    for c in range(len(starts) - 1):
        first = starts[c]
        last = starts[c + 1]
        for p in range(first, last + 1):  # each pair alone, then all together
            together = p == last
            if together and last == first + 1 and removed[c] == 0:
                for part in range(7):
                    opened[c, part] = 1.0 - covered[first, part]
                continue
            a = first if together else p
            b = last if together else p + 1
            for part in range(7):
                share = open_share(work, values, a, b, removed[c] if together else 0, pieces, part, True)
                if together:
                    opened[c, part] = share
                else:
                    covered[p, part] = 1.0 - share


@kernel
def put_cells(cells, opened, V, Ax, Ay, Az):
    """Write opened (n, 7) of cells (n, 3) [without ghosts] into the arrays; a face takes what both its cells leave."""
    for c in range(cells.shape[0]):
        i = cells[c, 0] + G
        j = cells[c, 1] + G
        k = cells[c, 2] + G
        V[i, j, k] = min(V[i, j, k], opened[c, 6])
        Ax[i - 1, j, k] = min(Ax[i - 1, j, k], opened[c, 0])
        Ax[i, j, k] = min(Ax[i, j, k], opened[c, 1])
        Ay[i, j - 1, k] = min(Ay[i, j - 1, k], opened[c, 2])
        Ay[i, j, k] = min(Ay[i, j, k], opened[c, 3])
        Az[i, j, k - 1] = min(Az[i, j, k - 1], opened[c, 4])
        Az[i, j, k] = min(Az[i, j, k], opened[c, 5])


@inner
def close_cell(V, Ax, Ay, Az, i, j, k):
    """No volume and no open face; i, j, k with ghosts."""
    V[i, j, k] = 0.0
    Ax[i - 1, j, k] = 0.0
    Ax[i, j, k] = 0.0
    Ay[i, j - 1, k] = 0.0
    Ay[i, j, k] = 0.0
    Az[i, j, k - 1] = 0.0
    Az[i, j, k] = 0.0


@kernel
def close_boxes(boxes, V, Ax, Ay, Az):
    """Close all cells of boxes (m, 2, 3) [without ghosts]."""
    for b in range(boxes.shape[0]):
        for i in range(boxes[b, 0, 0] + G, boxes[b, 1, 0] + G):
            for j in range(boxes[b, 0, 1] + G, boxes[b, 1, 1] + G):
                for k in range(boxes[b, 0, 2] + G, boxes[b, 1, 2] + G):
                    close_cell(V, Ax, Ay, Az, i, j, k)


@kernel
def faces_of(cells, Ax, Ay, Az, out):
    """Open fractions (n, 6) of the faces of cells (n, 3) [without ghosts]."""
    for c in range(cells.shape[0]):
        i = cells[c, 0] + G
        j = cells[c, 1] + G
        k = cells[c, 2] + G
        out[c, 0] = Ax[i - 1, j, k]
        out[c, 1] = Ax[i, j, k]
        out[c, 2] = Ay[i, j - 1, k]
        out[c, 3] = Ay[i, j, k]
        out[c, 4] = Az[i, j, k - 1]
        out[c, 5] = Az[i, j, k]
