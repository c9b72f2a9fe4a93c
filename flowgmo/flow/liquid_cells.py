"""Liquid in single cells: the share of a cell's open volume that regions of liquid, applied in order, fill.

A point holds what the last region that contains it says. So the liquid is a sum over disjoint parts

    F V = sum over regions r of  fraction_r |inside r, outside all later ones, outside the solids|

each of which is where a few fields are positive, cut exactly (cut_cell.py).
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.cell_parts import open_by, open_share
from flowgmo.flow.cut_cell import work_space
from flowgmo.flow.fields import G
from flowgmo.kernel import kernel


@kernel
def liquid_shares(starts, values, fractions, before, solid_starts, solids, pieces, F):
    """F (c,) of cells: liquid / open volume.

    starts (c + 1,) first pair of each cell, pairs in the order of the regions; values (p, nodes) their distances,
    negative inside; fractions (p,) what a region gives its inside, 0 for a hole; before (c,): what regions that hold
    the whole cell left; solid_starts (c + 1,), solids (q, nodes) likewise.
    """
    work = work_space()
    most = np.int64(0)
    for c in range(len(starts) - 1):
        most = max(most, starts[c + 1] - starts[c] + solid_starts[c + 1] - solid_starts[c])
    fields = np.empty((most, values.shape[1]))
    for c in range(len(starts) - 1):
        first = starts[c]
        last = starts[c + 1]
        m = solid_starts[c + 1] - solid_starts[c]
        for q in range(m):
            for at in range(fields.shape[1]):
                fields[q, at] = solids[solid_starts[c] + q, at]
        smooth = last == first + 1  # parts that are extrapolated one by one need not sum to the whole
        room = 1.0 if m == 0 else open_share(work, fields, 0, m, 0, pieces, 6, smooth)
        held = 0.0
        for step in range(last - first + 1):  # the last region first; then what was there before all of them
            p = last - 1 - step
            amount = before[c] if p < first else fractions[p]
            if p >= first:
                for at in range(fields.shape[1]):
                    fields[m, at] = -values[p, at]
            if amount > 0.0:
                count = m if p < first else m + 1
                held += amount * open_share(work, fields, 0, count, 0, pieces, 6, smooth)
            if p >= first:
                for at in range(fields.shape[1]):
                    fields[m, at] = values[p, at]
                m += 1
        F[c] = min(held / room, 1.0) if room > 0.0 else 0.0


@kernel
def shares_below(low, size, up, height, starts, solids, pieces, F):
    """F (c,): share of the open volume of cells that lies below the plane up . x = height.

    low, size (c, 3) [length] lowest corner and widths; starts (c + 1,), solids (q, nodes) distances of solids near.
    """
    work = work_space()
    most = np.int64(1)
    for c in range(len(starts) - 1):
        most = max(most, starts[c + 1] - starts[c] + 1)
    fields = np.empty((most, (pieces + 1) ** 3))
    for c in range(len(starts) - 1):
        m = starts[c + 1] - starts[c]
        for q in range(m):
            for node in range(fields.shape[1]):
                fields[q, node] = solids[starts[c] + q, node]
        at = 0
        for i in range(pieces + 1):
            for j in range(pieces + 1):
                for k in range(pieces + 1):
                    x = low[c, 0] + size[c, 0] * i / pieces
                    y = low[c, 1] + size[c, 1] * j / pieces
                    z = low[c, 2] + size[c, 2] * k / pieces
                    fields[m, at] = height - (up[0] * x + up[1] * y + up[2] * z)
                    at += 1
        if m == 0:
            F[c] = open_by(work, fields, 0, 1, 0, pieces, 6, pieces)  # one plane: exact in one piece
            continue
        room = open_share(work, fields, 0, m, 0, pieces, 6, True)
        below = open_share(work, fields, 0, m + 1, 0, pieces, 6, True)
        F[c] = min(below / room, 1.0) if room > 0.0 else 0.0


@kernel
def fill_boxes(boxes, F, last, fraction, number):
    """F = fraction and last = number in boxes (m, 2, 3) of cells [without ghosts], first and one past the last."""
    for b in range(boxes.shape[0]):
        for i in range(boxes[b, 0, 0] + G, boxes[b, 1, 0] + G):
            for j in range(boxes[b, 0, 1] + G, boxes[b, 1, 1] + G):
                for k in range(boxes[b, 0, 2] + G, boxes[b, 1, 2] + G):
                    F[i, j, k] = fraction
                    last[i, j, k] = number
