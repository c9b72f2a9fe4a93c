"""Which parties may meet at all: pairs of boxes along the axes of space that overlap.

The boxes are sorted by their lower ends on one axis; each is then compared with those that begin before it ends. The
axis is the one on which they lie farthest apart for their size, so that few do. A box without an end on that axis (a
floor) is compared with all.
Source  Baraff 1992, section 5; Cohen, Lin, Manocha & Ponamgi 1995 (sweep and prune).
"""

from __future__ import annotations

import numpy as np

from flowgmo.kernel import inner


@inner
def _sift(order, boxes, axis, root, end):
    """One step of the heap sort: let order[root] sink among root .. end - 1."""
    while 2 * root + 1 < end:
        child = 2 * root + 1
        if child + 1 < end and boxes[order[child], axis] < boxes[order[child + 1], axis]:
            child += 1
        if not boxes[order[root], axis] < boxes[order[child], axis]:
            return
        order[root], order[child] = order[child], order[root]
        root = child


@inner
def _widest_axis(boxes):
    """The axis on which the middles of the bounded boxes spread most, relative to their mean edge."""
    axis = 0
    best = -1.0
    for k in range(3):
        lo = np.inf
        hi = -np.inf
        edges = 0.0
        for i in range(len(boxes)):
            edge = boxes[i, 3 + k] - boxes[i, k]
            if edge < np.inf and edge >= 0.0:
                middle = boxes[i, k] + 0.5 * edge
                lo = min(lo, middle)
                hi = max(hi, middle)
                edges += edge
        spread = (hi - lo) / edges if edges > 0.0 and hi > lo else 0.0
        if spread > best:
            best = spread
            axis = k
    return axis


@inner
def overlapping(boxes, allowed, order, out):
    """Allowed pairs (i < j) of parties whose boxes meet, into out (m, 2): sort along one axis, sweep along it.

    boxes (n, 6): lowest, highest corner, ends may be infinite, inverted ones meet none; allowed (n, n) bool, symmetric;
    order (n,) int, work. Returns how many there are; where that is more than m, the rest is not written.
    """
    n = len(boxes)
    axis = _widest_axis(boxes)
    for i in range(n):
        order[i] = i
    for i in range(n // 2):
        _sift(order, boxes, axis, n // 2 - 1 - i, n)
    for end in range(n - 1, 0, -1):
        order[0], order[end] = order[end], order[0]
        _sift(order, boxes, axis, 0, end)
    u = (axis + 1) % 3
    v = (axis + 2) % 3
    count = np.int64(0)
    for s in range(n):
        i = order[s]
        if boxes[i, axis] > boxes[i, 3 + axis]:
            continue
        for r in range(s + 1, n):
            j = order[r]
            if boxes[j, axis] > boxes[i, 3 + axis]:
                break
            meet = boxes[i, u] <= boxes[j, 3 + u] and boxes[j, u] <= boxes[i, 3 + u]
            meet = meet and boxes[i, v] <= boxes[j, 3 + v] and boxes[j, v] <= boxes[i, 3 + v]
            if meet and boxes[j, axis] <= boxes[j, 3 + axis] and allowed[i, j]:
                if count < len(out):
                    out[count, 0] = min(i, j)
                    out[count, 1] = max(i, j)
                count += 1
    return count
