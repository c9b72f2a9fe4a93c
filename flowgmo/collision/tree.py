"""Trees of boxes over the pieces of each party, and what the search asks of them.

Every party has one binary tree, halved at the median along the longest side, its boxes in body axes. The nodes stand in
depth-first order, so that the left child of node i is i + 1 and a subtree is a range; the pieces of a party are stored
in the order of the leaves. A node also has a ball, which is the better bound for a ball, and for a body that turns.

Two boxes in different axes are apart when one of their six face directions separates them by more than `within`:

    |t_k| > h_k + Σ_l |R_kl| g_l + within        t from the one box's middle to the other's, h, g half edges

Without the nine directions across two edges this is conservative: a pair may be listed that is not near.
Source  Gottschalk, Lin & Manocha 1996.
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.shapes import BOX, CAVITY, ELLIPSOID, FRUSTUM, HALF_SPACE
from flowgmo.kernel import inner, kernel
from flowgmo.vectors import add, dot, norm, rotate, sub, times, triple, unrotate

#: centre (from B) and half edges of the box in body axes, infinite where something below is; reach: radius of a ball
#: about the centre that holds all below; right: the other child (the left one is next), -1 in a leaf; after: next node
#: outside this subtree; piece: of a leaf, -1 above.
NODE = np.dtype(
    [
        ("centre", "f8", 3),
        ("half", "f8", 3),
        ("reach", "f8"),
        ("right", "i8"),
        ("after", "i8"),
        ("piece", "i8"),
    ],
    align=True,
)
WIDER = 1.0 + 2.0**-40  # boxes are so much larger than computed: far above the rounding of turning them (2^-50)
DEEP = 128  # entries of the stack: the sum of two depths, each at most the 63 bits of a count


def build_tree(lo: np.ndarray, hi: np.ndarray, reach: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Order (m,) of the leaves, and nodes (2 m - 1,) of NODE, `piece` and links counted from 0.

    lo, hi (m,3): boxes of the pieces, ±inf where one has no end; reach (m,): radius of a ball about the box's middle.
    """
    bounded = np.isfinite(lo).all(1) & np.isfinite(hi).all(1)
    with np.errstate(invalid="ignore"):
        middle = np.where(bounded[:, None], (lo + hi) / 2, 0.0)
        half = np.where(bounded[:, None], (hi - lo) / 2, np.inf)
    m = len(lo)
    order, nodes = np.arange(m), np.zeros(2 * m - 1, NODE)
    start, count, index = np.array([0]), np.array([m]), np.array([0])
    levels = []
    while len(start):
        nodes["after"][index] = index + 2 * count - 1
        levels.append(index)
        leaf = count == 1
        nodes["right"][index[leaf]], nodes["piece"][index[leaf]] = -1, start[leaf]
        start, count, index = start[~leaf], count[~leaf], index[~leaf]
        if not len(start):
            break
        _sort(order, middle, start, count)
        left = (count + 1) // 2
        nodes["right"][index], nodes["piece"][index] = index + 2 * left, -1
        start = np.stack([start, start + left], 1).ravel()
        index = np.stack([index + 1, index + 2 * left], 1).ravel()
        count = np.stack([left, count - left], 1).ravel()
    leaves = nodes["piece"] >= 0
    own = order[nodes["piece"][leaves]]
    nodes["centre"][leaves], nodes["half"][leaves] = middle[own], WIDER * half[own]
    nodes["reach"][leaves] = WIDER * reach[own]
    for index in levels[::-1]:
        _enclose(nodes, index[nodes["right"][index] >= 0])
    return order, nodes


def _sort(order: np.ndarray, middle: np.ndarray, start: np.ndarray, count: np.ndarray) -> None:
    """Sort each run of `order` along the axis on which its middles spread most."""
    segment = np.repeat(np.arange(len(start)), count)
    place = np.repeat(start - np.r_[0, np.cumsum(count)[:-1]], count) + np.arange(count.sum())
    first = np.r_[0, np.cumsum(count)[:-1]]
    x = middle[order[place]]
    spread = np.maximum.reduceat(x, first) - np.minimum.reduceat(x, first)
    key = np.take_along_axis(x, spread.argmax(1)[segment, None], 1)[:, 0]
    order[place] = order[place][np.lexsort((order[place], key, segment))]


def _enclose(nodes: np.ndarray, index: np.ndarray) -> None:
    """Box and ball of nodes from those of their children."""
    a, b = nodes[index + 1], nodes[nodes["right"][index]]
    with np.errstate(invalid="ignore"):
        lo = np.minimum(a["centre"] - a["half"], b["centre"] - b["half"])
        hi = np.maximum(a["centre"] + a["half"], b["centre"] + b["half"])
        bounded = np.isfinite(lo).all(1) & np.isfinite(hi).all(1)
        centre = np.where(bounded[:, None], (lo + hi) / 2, 0.0)
        nodes["centre"][index] = centre
        nodes["half"][index] = np.where(bounded[:, None], WIDER * np.maximum(hi - centre, centre - lo), np.inf)
    balls = [np.linalg.norm(c["centre"] - centre, axis=1) + c["reach"] for c in (a, b)]
    corner = np.linalg.norm(nodes["half"][index], axis=1)
    nodes["reach"][index] = np.where(bounded, WIDER * np.minimum(corner, np.maximum(*balls)), np.inf)


@inner
def pieces_near_box(shapes, party, lo, hi, out):
    """Pieces of a party whose boxes meet the box lo, hi (triples, body axes, from B): their numbers into out (m,).

    Returns how many there are; where that is more than m, the rest is not written.
    """
    count = np.int64(0)
    i = shapes.first_node[party]
    end = shapes.first_node[party + 1]
    while i < end:
        node = shapes.nodes[i]
        apart = False
        for k in range(3):
            c = node.centre[k]
            h = node.half[k]
            apart = apart or c - h > hi[k] or c + h < lo[k]
        if apart:
            i = node.after
            continue
        if node.piece >= 0:
            if count < len(out):
                out[count] = node.piece
            count += 1
        i += 1
    return count


@inner
def _apart(A, B, R, back, t, within):
    """Whether two nodes are more than `within` apart; R: rows, B's axes to A's, back: its transpose, t from A's B."""
    if not (A.half[0] < np.inf and B.half[0] < np.inf):
        return False
    ca = triple(A.centre)
    cb = triple(B.centre)
    d = sub(add(t, (dot(R[0], cb), dot(R[1], cb), dot(R[2], cb))), ca)
    far = A.reach + B.reach + within
    if dot(d, d) > far * far:
        return True
    ha = triple(A.half)
    hb = triple(B.half)
    for k in range(3):
        if abs(d[k]) > ha[k] + _width(R[k], hb) + within or abs(dot(back[k], d)) > hb[k] + _width(back[k], ha) + within:
            return True
    return False


@inner
def _width(n, half):
    """Half the width of a box along n."""
    return abs(n[0]) * half[0] + abs(n[1]) * half[1] + abs(n[2]) * half[2]


@inner
def _clear_of(piece, pose, node, pose_node, within):
    """Whether a bounded node is more than `within` above a half-space, or so deep inside a hole, by the node's ball."""
    p, q = pose
    pn, qn = pose_node
    centre = add(p, rotate(q, triple(piece.centre)))
    d = sub(add(pn, rotate(qn, triple(node.centre))), centre)
    if piece.kind == HALF_SPACE:
        n = rotate(q, triple(piece.axes[2]))
        return dot(n, d) - min(_width(unrotate(qn, n), triple(node.half)), node.reach) > within
    r = times(piece.axes, unrotate(q, d))
    s = triple(piece.size)
    room = within + node.reach
    if piece.kind == BOX + CAVITY:
        return abs(r[0]) + room < s[0] and abs(r[1]) + room < s[1] and abs(r[2]) + room < s[2]
    if piece.kind == FRUSTUM + CAVITY:
        slope = (s[1] - s[0]) / (2.0 * s[2])
        gap = s[0] + slope * (r[2] + s[2]) - np.sqrt(r[0] * r[0] + r[1] * r[1])
        return abs(r[2]) + room < s[2] and gap > room * np.sqrt(1.0 + slope * slope)
    if piece.kind == ELLIPSOID + CAVITY:
        return room < (1.0 - norm((r[0] / s[0], r[1] / s[1], r[2] / s[2]))) * min(s[0], min(s[1], s[2]))
    return False


@inner
def near_pairs(shapes, a, pose_a, b, pose_b, within, out):
    """Pairs of pieces (i of party a, j of party b) whose boxes are nearer than `within` [length], into out (m, 2).

    pose: (p, q), the position of B (triple) and the quaternion of a party; those of a domain side are zero and one.
    Conservative: lists every pair that is so near, and some that are not; of parties of one piece each always that
    pair. Returns how many there are; where that is more than m, the rest is not written.
    """
    count = np.int64(0)
    nodes_a = shapes.first_node[a + 1] - shapes.first_node[a]
    nodes_b = shapes.first_node[b + 1] - shapes.first_node[b]
    if nodes_a == 0 or nodes_b == 0:
        return count
    if nodes_a == 1 and nodes_b == 1:
        if len(out) > 0:
            out[0, 0] = shapes.first_piece[a]
            out[0, 1] = shapes.first_piece[b]
        return count + 1
    pa, qa = pose_a
    pb, qb = pose_b
    t = unrotate(qa, sub(pb, pa))
    back = (
        unrotate(qa, rotate(qb, (1.0, 0.0, 0.0))),
        unrotate(qa, rotate(qb, (0.0, 1.0, 0.0))),
        unrotate(qa, rotate(qb, (0.0, 0.0, 1.0))),
    )
    R = (
        (back[0][0], back[1][0], back[2][0]),
        (back[0][1], back[1][1], back[2][1]),
        (back[0][2], back[1][2], back[2][2]),
    )
    stack = np.empty((DEEP, 2), np.int64)
    stack[0, 0] = shapes.first_node[a]
    stack[0, 1] = shapes.first_node[b]
    top = 1
    while top > 0:
        top -= 1
        i = stack[top, 0]
        j = stack[top, 1]
        A = shapes.nodes[i]
        B = shapes.nodes[j]
        if _apart(A, B, R, back, t, within):
            continue
        if A.piece >= 0 and not A.half[0] < np.inf and B.half[0] < np.inf:
            if _clear_of(shapes.pieces[A.piece], pose_a, B, pose_b, within):
                continue
        if B.piece >= 0 and not B.half[0] < np.inf and A.half[0] < np.inf:
            if _clear_of(shapes.pieces[B.piece], pose_b, A, pose_a, within):
                continue
        if A.piece >= 0 and B.piece >= 0:
            if count < len(out):
                out[count, 0] = A.piece
                out[count, 1] = B.piece
            count += 1
        elif A.piece < 0 and (B.piece >= 0 or A.reach >= B.reach):  # the larger one is opened
            stack[top, 0] = A.right
            stack[top, 1] = j
            stack[top + 1, 0] = i + 1
            stack[top + 1, 1] = j
            top += 2
        else:
            stack[top, 0] = i
            stack[top, 1] = B.right
            stack[top + 1, 0] = i
            stack[top + 1, 1] = j + 1
            top += 2
    return count


@inner
def bounds_of_party(shapes, party, pose, box):
    """Box that holds a party into box (6,): lowest, highest corner in space axes; inverted (inf, -inf) if it has none.

    Exact (to WIDER) for one ball and for a half-space along an axis of space; else the turned box, cut by the ball
    around it.
    """
    p, q = pose
    first = shapes.first_node[party]
    for k in range(3):
        box[k] = np.inf
        box[3 + k] = -np.inf
    if first == shapes.first_node[party + 1]:
        return
    node = shapes.nodes[first]
    c = add(p, rotate(q, triple(node.centre)))
    if not node.half[0] < np.inf:
        for k in range(3):
            box[k] = -np.inf
            box[3 + k] = np.inf
        if node.piece >= 0 and shapes.pieces[node.piece].kind == HALF_SPACE:
            piece = shapes.pieces[node.piece]
            n = rotate(q, triple(piece.axes[2]))
            c = add(p, rotate(q, triple(piece.centre)))
            for k in range(3):
                if n[k] == 1.0:
                    box[3 + k] = c[k]
                elif n[k] == -1.0:
                    box[k] = c[k]
        return
    half = triple(node.half)
    ex = unrotate(q, (1.0, 0.0, 0.0))
    ey = unrotate(q, (0.0, 1.0, 0.0))
    ez = unrotate(q, (0.0, 0.0, 1.0))
    width = (_width(ex, half), _width(ey, half), _width(ez, half))
    for k in range(3):
        h = min(width[k], node.reach) * WIDER
        box[k] = c[k] - h
        box[3 + k] = c[k] + h


@kernel
def all_bounds(shapes, poses, boxes):
    """Boxes (parties, 6) of all parties; poses (n,) of bodies.arrays.POSE, the parties beyond are domain sides."""
    for party in range(len(boxes)):
        pose = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))
        if party < len(poses):
            row = poses[party]
            pose = (triple(row.p), (row.q[0], row.q[1], row.q[2], row.q[3]))
        bounds_of_party(shapes, party, pose, boxes[party])
