"""Walls thinner than a cell: a cell must not join what they separate.

Where a wall passes between two nodes, both are open and the cut does not see it. Two things find it:

    an edge from node 0 to node 1, both open, d0 + d1 < L    the wall may pass; asked at  s = L d0 / (d0 + d1)
                                                             a plane wall of any thickness and direction holds s
    the open nodes of the cell, joined by edges that no      more than one group: the wall divides the cell, also
    wall passes                                              where it is thick enough to cover nodes

At angle θ to the edge a plane wall between s1 and s2 gives d0 = s1 cos θ, d1 = (L - s2) cos θ, hence s1 <= s <= s2. A
curved wall is met after a few such steps.

A cell has one pressure and one amount of liquid, so it belongs to one side: the group with the larger sum of distances,
the first one if two are equal (a wall through the middle of cells then stands on their upper side, in the mirror image
of the scene too). The nodes of the others are covered. A face is open only as far as both of its cells keep its nodes.
No path from cell to cell through open faces then crosses the wall; it stands on the mesh, up to 1 / pieces of a cell
away, and its own thickness is lost where it covers no node. A gap between solids in which no node lies is closed.
Nodes that see each other belong together even when no edge joins them: a wedge between two solids is not a wall.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.favor.cell_parts import corner_node, open_share
from flowgmo.flow.favor.cut_cell import work_space
from flowgmo.flow.favor.near_surface import Distance, Planes, node_numbers, node_planes
from flowgmo.kernel import inner, kernel

ROUNDS = 4  # meet all edges of a shell of radius 5 cells down to 0.005 cell thick, and miss half of them at 0.001


def crossed_edges(distance: Distance, planes: Planes, cells: np.ndarray, d: np.ndarray, pieces: int) -> np.ndarray:
    """Edges that a thin wall crosses between two open nodes: (n, 3, (pieces + 1)^3) bool, [cell, axis, lower node].

    cells (n, 3) without ghosts; d (n, (pieces + 1)^3) distances at their nodes.
    """
    m = pieces + 1
    crossed = np.zeros((len(cells), 3, m**3), bool)
    shape = tuple(len(x) - 1 for x in planes)
    numbers = node_numbers(shape, cells, pieces)
    fine = node_planes(planes, pieces)
    local = np.indices((m, m, m)).reshape(3, -1)
    for axis, step in enumerate((m * m, m, 1)):
        lower = np.flatnonzero(local[axis] < pieces)
        length = np.diff(planes[axis])[cells[:, axis], None] / pieces
        d0, d1 = d[:, lower], d[:, lower + step]
        cell, edge = np.nonzero((d0 > 0.0) & (d1 > 0.0) & (d0 + d1 < length))
        if not len(cell):
            continue
        _, one, all_of = np.unique(numbers[cell, lower[edge]], return_index=True, return_inverse=True)
        c, e = cell[one], edge[one]
        at = [pieces * cells[c, k] + local[k, lower[e]] for k in range(3)]
        points = np.column_stack([x[a] for x, a in zip(fine, at, strict=True)])
        way = np.broadcast_to(np.eye(3)[axis], points.shape)
        hit = _between(distance, points, way, length[c, 0], d0[c, e], d1[c, e])
        crossed[cell, axis, lower[edge]] = hit[all_of]
    return crossed


def _between(
    distance: Distance, points: np.ndarray, way: np.ndarray, length: np.ndarray, d0: np.ndarray, d1: np.ndarray
) -> np.ndarray:
    """Whether something lies on lines from points (n, 3) along unit vectors way (n, 3), with distances d0, d1 > 0 at
    their ends.

    Asked at s; where the wall is curved s may miss it, and the parts that may still hold it are asked in turn, as in
    the Illinois method (Dowell & Jarratt 1971).
    """
    hit = np.zeros(len(points), bool)
    edge, start = np.arange(len(points)), np.zeros(len(points))
    w0, w1 = d0, d1  # what s is reckoned from: the end that stays counts half, or s would creep towards the other
    for _ in range(ROUNDS):
        s = length * (w0 / (w0 + w1))
        x = points[edge] + (start + s)[:, None] * way[edge]
        m = distance(x) if len(x) else np.zeros(0)
        hit[edge[m <= 0.0]] = True
        free = ~hit[edge]
        low, high = free & (d0 + m < s), free & (m + d1 < length - s)
        edge, start = np.concatenate([edge[low], edge[high]]), np.concatenate([start[low], (start + s)[high]])
        length = np.concatenate([s[low], (length - s)[high]])
        w0, w1 = np.concatenate([0.5 * w0[low], m[high]]), np.concatenate([m[low], 0.5 * w1[high]])
        d0, d1 = np.concatenate([d0[low], m[high]]), np.concatenate([m[low], d1[high]])
    return hit


def rejoin(
    distances: list[Distance],
    planes: Planes,
    cells: np.ndarray,
    starts: np.ndarray,
    which: np.ndarray,
    values: np.ndarray,
    pieces: int,
    removed: np.ndarray,
) -> None:
    """Take back from removed (c,) the nodes that see the deepest node kept: a straight line to it meets no solid.

    In a narrow wedge between two solids the edges of the mesh are all crossed, but nothing divides the cell.
    cells (c, 3), starts (c + 1,), which (p,), values (p, nodes) as in cut_cells.
    """
    local = np.indices((pieces + 1,) * 3).reshape(3, -1).T
    fine = node_planes(planes, pieces)
    rows: list[tuple[int, int, int, int]] = []
    for c in np.flatnonzero(removed):
        least = values[starts[c] : starts[c + 1]].min(axis=0)
        gone = (removed[c] >> np.arange(len(least))) & 1 == 1
        best = int(np.argmax(np.where(gone, -1.0, least)))
        rows += [(c, at, best, p) for at in np.flatnonzero(gone) for p in range(starts[c], starts[c + 1])]
    if not rows:
        return
    c, at, best, p = np.array(rows).T
    a, b = (np.column_stack([x[pieces * cells[c, k] + local[m, k]] for k, x in enumerate(fine)]) for m in (at, best))
    length = np.linalg.norm(b - a, axis=1)
    d0, d1 = values[p, at], values[p, best]
    hidden = np.zeros(len(rows), bool)
    for solid in np.unique(which[p]):
        mine = np.flatnonzero((which[p] == solid) & (d0 + d1 < length))
        way = (b - a)[mine] / length[mine, None]
        hidden[mine] = _between(distances[solid], a[mine], way, length[mine], d0[mine], d1[mine])
    still = np.zeros_like(removed)
    np.bitwise_or.at(still, c[hidden], np.int64(1) << at[hidden])
    removed &= still


@inner
def _flood(group, stack, start, number, crossed, first, last, pieces):
    """Give all nodes that can be reached from `start` this group number."""
    m = pieces + 1
    group[start] = number
    stack[0] = start
    waiting = np.int64(1)
    while waiting > 0:
        waiting -= 1
        at = stack[waiting]
        for axis in range(3):
            step = m * m if axis == 0 else (m if axis == 1 else 1)
            position = at // step % m
            for side in range(2):
                if position == (pieces if side == 1 else 0):
                    continue
                other = at + step if side == 1 else at - step
                if group[other] != 0:
                    continue
                lower = min(at, other)
                free = True
                for p in range(first, last):
                    free = free and not crossed[p, axis, lower]
                if free:
                    group[other] = number
                    stack[waiting] = other
                    waiting += 1


@kernel
def cut_off_nodes(starts, values, crossed, pieces, removed):
    """removed (c,) int64: bits of the open nodes that are not of the cell's largest group, 0 where it is one group."""
    nodes = (pieces + 1) ** 3
    group = np.empty(nodes, np.int64)
    stack = np.empty(nodes, np.int64)
    size = np.empty(nodes + 1)
    for c in range(len(starts) - 1):
        for at in range(nodes):
            group[at] = 0
            for p in range(starts[c], starts[c + 1]):
                if values[p, at] <= 0.0:
                    group[at] = -1
        number = np.int64(0)
        for at in range(nodes):
            if group[at] == 0:
                number += 1
                _flood(group, stack, at, number, crossed, starts[c], starts[c + 1], pieces)
        removed[c] = 0
        if number < 2:
            continue
        size[:] = 0.0
        for at in range(nodes):
            if group[at] > 0:
                least = values[starts[c], at]
                for p in range(starts[c] + 1, starts[c + 1]):
                    least = min(least, values[p, at])
                size[group[at]] += least
        best = np.int64(1)
        for g in range(2, number + 1):
            best = g if size[g] > size[best] else best
        for at in range(nodes):
            if group[at] > 0 and group[at] != best:
                removed[c] |= np.int64(1) << at


@inner
def _across(bits, face, pieces):
    """The neighbour's bits, at the nodes it shares with this face of the cell, as bits of the cell's own nodes."""
    own = np.int64(0)
    for a in range(pieces + 1):
        for b in range(pieces + 1):
            at = corner_node(face, a, b, 0, pieces)
            other = corner_node(face + 1 - 2 * (face % 2), a, b, 0, pieces)
            own |= ((bits >> other) & 1) << at
    return own


@kernel
def close_divided_faces(starts, values, removed, beyond, pieces, opened):
    """Faces (c, 6) of divided cells, open where the cell and its neighbour keep the nodes; beyond (c, 6): its bits."""
    work = work_space()
    for c in range(len(starts) - 1):
        for face in range(6):
            bits = removed[c] | _across(beyond[c, face], face, pieces)
            opened[c, face] = open_share(work, values, starts[c], starts[c + 1], bits, pieces, face, True)
