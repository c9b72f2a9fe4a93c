"""After the sweeps: what a cell cut by a solid could not hold, or lacks, is settled with its open neighbours.

A u dt may exceed the little open volume V of such a cell, so that V F ends above V or below 0. Only this excess moves:

    to neighbour n   weight A_n (face area) V_n (V - V F)_n  what is too much goes where there is room
    from neighbour n weight A_n (face area) (V F)_n          what is missing comes from where there is liquid

A neighbour that is offered more than its room takes the same share of every offer, and what it leaves goes by A V2,
room or not: a share of a larger cell is less overfull than all of a small one. (Five that gave all they had to the only
neighbour with room filled a cell of .07 behind a rising ball to 2.4 of what it holds, hard/wet_released.) The volume
given is the volume taken, to round-off: a donor leaves its excess over the sum of weights in `rate`, a receiver what it
takes of offers in `share`, there the donor what was left to it; so that a kernel writes to its own column only.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.ahead import ask_ahead
from flowgmo.flow.fields import G
from flowgmo.flow.surface.carriers import U
from flowgmo.flow.surface.plic import EMPTY
from flowgmo.kernel import flow_kernel, inner


@inner
def _excess(V, liquid):
    """What is above V or below 0, beyond round-off, of the liquid V F."""
    if liquid > V + EMPTY * V:
        return liquid - V
    return liquid if liquid < -EMPTY * V else 0.0


@inner
def _appetite(V, liquid, much, rest):
    """Weight per area of a receiver: room for too much, liquid against too little; rest: what finds no room.

    Room counts by the cell's own volume, so that where it is short, a cell that is hardly open is not filled a
    thousandfold; a cell that closes takes nothing, whatever it lacks itself.
    """
    if rest:
        return V * V
    if much:
        return V * max(V - max(liquid, 0.0), 0.0)
    return max(liquid, 0.0) if V > 0.0 else 0.0  # a cell that closes gives all it has already


@inner
def _neighbour(n, i, j, k):
    """Cell across face n = 0 .. 5 (Xmin .. Zmax)."""
    s = np.int64(1 if n % 2 == 1 else -1)
    return (
        i + (s if n < 2 else 0),
        j + (s if n == 2 or n == 3 else 0),
        k + (s if n > 3 else 0),
    )


@inner
def _open_area(n, i, j, k, opened, grid):
    """Open area [length^2] of face n; 0 on the sides of the domain, where nothing is settled."""
    nx, ny, nz = opened.V.shape
    if n < 2:
        if (n == 0 and i == G) or (n == 1 and i == nx - G - 1):
            return 0.0
        return opened.Ax[i - (1 if n == 0 else 0), j, k] * grid.dy[j] * grid.dz[k]
    if n < 4:
        if (n == 2 and j == G) or (n == 3 and j == ny - G - 1):
            return 0.0
        return opened.Ay[i, j - (1 if n == 2 else 0), k] * grid.dx[i] * grid.dz[k]
    if (n == 4 and k == G) or (n == 5 and k == nz - G - 1):
        return 0.0
    return opened.Az[i, j, k - (1 if n == 4 else 0)] * grid.dx[i] * grid.dy[j]


@flow_kernel
def find_excess(columns, first, last, rest, liquid, V, opened, grid, lines, rate, some):
    """rate [length] = excess volume / sum of (weight, area) over the open faces of each cut cell, 0 elsewhere.

    liquid V F [-], V at the end of the step, opened with the areas that carried the liquid. rest: it is what found no
    room, and goes by A V2. some (mesh without z) int8: 1 where a column has such a cell, 0 where it has none; rate is
    not written where no solid comes near the column or one beside it (lines, solid_lines.py).
    """
    for c in range(first, last):
        i, j, k0, k1 = columns[c, 0], columns[c, 1], columns[c, 2], columns[c, 3]
        some[i, j] = 0
        if not _is_near(lines, i, j):
            continue
        for k in range(k0, k1):
            rate[i, j, k] = 0.0
            if V[i, j, k] >= 1.0:
                continue
            excess = _excess(V[i, j, k], liquid[i, j, k])
            if excess == 0.0 or (rest and excess < 0.0):
                continue
            some[i, j] = 1
            total = 0.0
            for n in range(6):
                a, b, e = _neighbour(n, i, j, k)
                want = _appetite(V[a, b, e], liquid[a, b, e], excess > 0.0, rest)
                total += _open_area(n, i, j, k, opened, grid) * want
            if total > 0.0:
                rate[i, j, k] = excess * (grid.dx[i] * grid.dy[j] * grid.dz[k]) / total


@inner
def _is_near(some, i, j):
    """Whether a column, or one beside it, has cells with an excess: few columns, and the others need no look at it."""
    return some[i, j] | some[i - 1, j] | some[i + 1, j] | some[i, j - 1] | some[i, j + 1] != 0


@flow_kernel
def find_shares(columns, first, last, V, opened, grid, rate, some, share):
    """share [-]: of the offers that cells beside those with rate > 0 have room for, 1 at most."""
    for c in range(first, last):
        i, j, k0, k1 = columns[c, 0], columns[c, 1], columns[c, 2], columns[c, 3]
        if not _is_near(some, i, j):
            continue
        for k in range(k0, k1):
            offered = 0.0  # [length3] for each of room
            for n in range(6):
                a, b, e = _neighbour(n, i, j, k)
                if rate[a, b, e] > 0.0:
                    offered += rate[a, b, e] * _open_area(n, i, j, k, opened, grid) * V[i, j, k]
            volume = grid.dx[i] * grid.dy[j] * grid.dz[k]
            share[i, j, k] = volume / offered if offered > volume else 1.0


@flow_kernel
def find_left(columns, first, last, liquid, V, opened, grid, rate, some, share, left):
    """share [-] of cells that hold too much: what their neighbours have no room for, of a cell. left (columns,): the
    largest of these."""
    for c in range(first, last):
        i, j, k0, k1 = columns[c, 0], columns[c, 1], columns[c, 2], columns[c, 3]
        left[c] = 0.0
        if some[i, j] == 0:
            continue
        for k in range(k0, k1):
            excess = _excess(V[i, j, k], liquid[i, j, k]) if V[i, j, k] < 1.0 else 0.0
            if excess > 0.0:
                kept = 0.0 if rate[i, j, k] > 0.0 else excess
                for n in range(6):
                    a, b, e = _neighbour(n, i, j, k)
                    offered = _open_area(n, i, j, k, opened, grid) * _appetite(V[a, b, e], liquid[a, b, e], True, False)
                    if offered > 0.0:
                        offered *= rate[i, j, k] / (grid.dx[i] * grid.dy[j] * grid.dz[k])
                        kept += offered * (1.0 - share[a, b, e])
                share[i, j, k] = kept
                left[c] = max(left[c], kept)


@inner
def _gained(rate, share, liquid, size, opened, grid, rest, i, j, k):
    """What a cell (i, j, k) with V = size and V F = liquid gets from its neighbours, in shares of it."""
    total = 0.0
    for n in range(6):
        a, b, e = _neighbour(n, i, j, k)
        r = rate[a, b, e]
        if r != 0.0:
            want = _appetite(size, liquid, r > 0.0, rest)
            if want > 0.0:
                taken = share[i, j, k] if r > 0.0 and not rest else 1.0
                total += taken * r * _open_area(n, i, j, k, opened, grid) * want
    return total / (grid.dx[i] * grid.dy[j] * grid.dz[k])


@flow_kernel
def settle(columns, first, last, rest, more, F, V, opened, grid, lines, rate, some, share, books):
    """Hand over the excess, turn V F into F again (with solids: F holds V F before), and note the extremes.

    V at the end of the step, None without solids; rest and lines as of find_excess; more: F stays V F, the rest comes
    next. books (columns, 3): largest V F - V, least V F [-], and liquid [length^3] of closed cells that found no open
    neighbour and is lost.
    """
    for c in range(first, last):
        i, j, k0, k1 = columns[c, 0], columns[c, 1], columns[c, 2], columns[c, 3]
        ask_ahead(columns, c, last, F, 0, 0)
        over, under, lost = 0.0, 0.0, 0.0
        solid = False
        if V is not None:
            solid = lines[i, j] != 0
            near = _is_near(some, i, j)
            for k in range(k0, k1 if solid else k0):
                size, liquid = V[i, j, k], F[i, j, k]
                now = liquid
                if near:
                    if rate[i, j, k] != 0.0:
                        now = size if liquid > 0.0 else 0.0
                        if liquid > 0.0 and not rest:
                            now += share[i, j, k]
                    now += _gained(rate, share, liquid, size, opened, grid, rest, i, j, k)
                over, under = max(over, now - size), min(under, now)
                if size <= 0.0:
                    lost += now * (grid.dx[i] * grid.dy[j] * grid.dz[k])
                if more:
                    F[i, j, k] = now
                else:
                    F[i, j, k] = now / size if size > 0.0 else 0.0
        for k in range(U(k0), U(k0 if solid else k1)):
            over, under = max(over, F[i, j, k] - 1.0), min(under, F[i, j, k])
        books[c, 0], books[c, 1], books[c, 2] = over, under, lost
