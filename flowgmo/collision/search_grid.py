"""Contact search on the mesh, the report's section 3.1: kept to compare with, and to show what it costs and saves.

For every pair whose bounding boxes share cells, among the mesh nodes that lie inside both bodies, in boundary cells of
both (no deeper than a cell's diagonal): the node with approaching velocity and the largest sum of depths below the two
surfaces is the contact point; the normal is that of the flatter surface there, turned from b to a.

Two exceptions, without which nothing comes to rest: bodies flat on each other touch in up to four of these nodes, the
deepest and those that span the area (one alone would tip a block with every impulse); and a pair that was held a moment
ago keeps its contact without approaching (what rests does not approach).

Nothing is found before a node lies in both bodies: thin bodies are missed, and the contact comes late by up to a cell.
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.convex import separation
from flowgmo.collision.shapes import ELLIPSOID, FRUSTUM, POINT, axis_of, place
from flowgmo.kernel import inner, kernel
from flowgmo.vectors import add, cross, dot, norm, put, quad, scale, sub, triple

MOST = 4  # contacts of a pair
ALIKE = 0.99  # cosine of the angle of two normals up to which they are those of one area
SAME = 1e-9  # farther than another by less than this part is as far: the first of them in the order of nodes
#: A mesh node in both bodies of a pair: place, normal from b to a, sum of depths [length], whether a surface is curved.
NODE = np.dtype([("x", "f8", 3), ("normal", "f8", 3), ("depth", "f8"), ("curved", "i8")], align=True)
SIDE = 0.5  # |cosine| of a frustum's normal with its axis below which the contact is on its round side


@inner
def _depth(sh, pieces, party, row, x):
    """Signed distance of the point x from a party (union of its pieces), outward normal, curvature [1/length]."""
    least = np.inf
    n = (0.0, 0.0, 1.0)
    curvature = 0.0
    probe = pieces.size - 1
    at = (x[0], x[1], x[2], 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    for j in range(sh.first_piece[party], sh.first_piece[party + 1]):
        frame = place(pieces[j], triple(row.p), quad(row.q))
        s, m, _, _, _ = separation(pieces, sh.vertices, probe, at, j, frame, (0.0, 0.0, 0.0))
        if s < least:
            least, n = s, m
            curvature = _curvature(pieces[j], frame, m)
    return least, n, curvature


@inner
def _curvature(piece, frame, n):
    """Larger curvature of a piece where its normal is n; of an ellipsoid the mean over its half axes."""
    if piece.kind == POINT:
        return 1.0 / piece.radius
    if piece.kind == ELLIPSOID:
        return 3.0 / (piece.size[0] + piece.size[1] + piece.size[2])
    if piece.kind == FRUSTUM and abs(dot(axis_of(frame, 2), n)) < SIDE:
        return 2.0 / (piece.size[0] + piece.size[1])
    return 0.0


@inner
def _first_node(planes, x):
    """Number of the first node that is not below x."""
    lo, hi = 0, planes.size
    while lo < hi:
        mid = (lo + hi) // 2
        if planes[mid] < x:
            lo = mid + 1
        else:
            hi = mid
    return lo


@kernel
def grid_contacts(sh, pieces, pairs, kept, boxes, M, plan, px, py, pz, nodes, out):
    """Contacts (at most MOST a pair) of pairs (count, 2) with the rows M at one time.

    pieces (p + 1,) of PIECE: those of sh and a ball without radius, the probe; kept (count,): 1 where the pair was held
    before; boxes (n, 6) of the parties; px, py, pz: planes of the mesh [length]; nodes (k,) of NODE: room for those in
    both bodies of a pair; out (MOST count,) of CONTACT: gap is minus the sum of the depths.
    Returns how many contacts, and the largest number of nodes (larger than k: enlarge and call again).
    """
    total = np.int64(0)
    most = np.int64(0)
    for c in range(pairs.shape[0]):
        a, b = pairs[c, 0], pairs[c, 1]
        found = np.int64(0)
        for i in range(_first_node(px, max(boxes[a, 0], boxes[b, 0])), px.size):
            if px[i] > min(boxes[a, 3], boxes[b, 3]):
                break
            for j in range(_first_node(py, max(boxes[a, 1], boxes[b, 1])), py.size):
                if py[j] > min(boxes[a, 4], boxes[b, 4]):
                    break
                for m in range(_first_node(pz, max(boxes[a, 2], boxes[b, 2])), pz.size):
                    if pz[m] > min(boxes[a, 5], boxes[b, 5]):
                        break
                    x = (px[i], py[j], pz[m])
                    diagonal = _diagonal(px, i, py, j, pz, m)
                    if _look(sh, pieces, a, b, M, x, diagonal, kept[c], nodes[min(found, nodes.size - 1)]):
                        found += 1
        most = max(most, found)
        if 0 < found <= nodes.size:
            total += _choose(nodes, found, a, b, plan, out[total:])
    return total, most


@inner
def _choose(nodes, count, a, b, plan, out):
    """Of the nodes [0, count): the deepest; where both bodies are flat there also the farthest from it, the farthest
    from their line, and the farthest from that on its other side. Returns how many went to out (MOST,)."""
    first = np.int64(0)
    for i in range(count):
        if nodes[i].depth > nodes[first].depth:
            first = np.int64(i)
    _store(nodes[first], a, b, plan, out[0])
    if nodes[first].curved:
        return np.int64(1)
    n, x = triple(nodes[first].normal), triple(nodes[first].x)
    second = _farthest(nodes, count, first, n, x, n, 0.0)
    if second < 0:
        return np.int64(1)
    _store(nodes[second], a, b, plan, out[1])
    line = sub(triple(nodes[second].x), x)
    across = cross(n, line)
    filled = np.int64(2)
    for side in (1.0, -1.0):
        other = _farthest(nodes, count, first, n, x, across, side)
        if other >= 0:
            _store(nodes[other], a, b, plan, out[filled])
            filled += 1
    return filled


@inner
def _farthest(nodes, count, first, n, x, across, side):
    """Node with a like normal that lies farthest from x; with side ±1: farthest along ± across. -1: there is none."""
    best = np.int64(-1)
    most = 0.0
    for i in range(count):
        if i == first or nodes[i].curved or dot(triple(nodes[i].normal), n) < ALIKE:
            continue
        d = sub(triple(nodes[i].x), x)
        far = side * dot(d, across) if side != 0.0 else norm(cross(n, d))
        if far > most * (1.0 + SAME):
            best, most = np.int64(i), far
    return best


@inner
def _store(node, a, b, plan, row):
    row.a, row.b = a, b
    put(row.point, triple(node.x))
    put(row.normal, triple(node.normal))
    row.gap = -node.depth
    row.e, row.mu = plan[a, b].e, plan[a, b].mu
    put(row.impulse, (0.0, 0.0, 0.0))
    row.feature = 0
    row.fresh = 1
    row.age = 0.0


@inner
def _diagonal(px, i, py, j, pz, m):
    """Largest diagonal of the cells around a node [length]."""
    return norm((_width(px, i), _width(py, j), _width(pz, m)))


@inner
def _width(planes, i):
    below = planes[i] - planes[i - 1] if i > 0 else 0.0
    above = planes[i + 1] - planes[i] if i + 1 < planes.size else 0.0
    return max(below, above)


@inner
def _look(sh, pieces, a, b, M, x, diagonal, kept, node):
    """Whether the mesh node x is in both parties a, b, near their surfaces, and approaches or was kept; fills node."""
    da, na, ka = _depth(sh, pieces, a, M[a], x)
    if da > 0.0 or da < -diagonal:
        return False
    db, nb, kb = _depth(sh, pieces, b, M[b], x)
    if db > 0.0 or db < -diagonal:
        return False
    n = nb if kb <= ka else scale(-1.0, na)
    u = add(triple(M[a].v), cross(triple(M[a].w), sub(x, triple(M[a].p))))
    w = add(triple(M[b].v), cross(triple(M[b].w), sub(x, triple(M[b].p))))
    if not kept and dot(sub(u, w), n) >= 0.0:
        return False
    put(node.x, x)
    put(node.normal, n)
    node.depth = -da - db
    node.curved = ka > 0.0 or kb > 0.0
    return node.depth > 0.0
