"""Boxes over pieces, near pairs of two parties, and the sweep over all parties, against brute force."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from flowgmo.bodies.arrays import POSE
from flowgmo.collision.broad import overlapping
from flowgmo.collision.pieces import Shapes
from flowgmo.collision.shapes import BOX, CAVITY, ELLIPSOID, FRUSTUM, HALF_SPACE, PIECE
from flowgmo.collision.tree import NODE, all_bounds, build_tree, near_pairs, pieces_near_box
from flowgmo.kernel import kernel


@kernel
def boxes_at(shapes, party, lo, hi, out):
    return pieces_near_box(shapes, party, lo, hi, out)


@kernel
def pairs(shapes, a, pose_a, b, pose_b, within, out):
    return near_pairs(shapes, a, pose_a, b, pose_b, within, out)


@kernel
def overlaps(boxes, allowed, order, out):
    return overlapping(boxes, allowed, order, out)


def shapes_of(boxes):
    """Shapes whose parties are made of given boxes (m,2,3); a party that is a vector is a half-space below it."""
    pieces, trees, first_piece, first_node = [], [], [0], [0]
    for party, own in enumerate(boxes):
        plane = np.ndim(own) == 1
        box = np.array([[[-np.inf] * 3, [np.inf] * 3]]) if plane else own
        reach = np.linalg.norm(box[:, 1] - box[:, 0], axis=1) / 2
        order, nodes = build_tree(box[:, 0], box[:, 1], reach)
        rows = np.zeros(len(box), PIECE)
        rows["body"] = party
        if plane:
            rows["kind"] = HALF_SPACE
            rows["axes"][:, 2] = own / np.linalg.norm(own)
        else:
            rows["centre"] = box[order].mean(1)
            rows["size"] = (box[order, 1] - box[order, 0]) / 2
        nodes["piece"][nodes["piece"] >= 0] += first_piece[-1]
        nodes["right"][nodes["right"] >= 0] += first_node[-1]
        nodes["after"] += first_node[-1]
        pieces.append(rows)
        trees.append(nodes)
        first_piece.append(first_piece[-1] + len(rows))
        first_node.append(first_node[-1] + len(nodes))
    none = np.zeros(0)
    return Shapes(
        np.concatenate(pieces), np.zeros((0, 3)), np.array(first_piece), np.concatenate(trees), np.array(first_node),
        none, none, none, none, none,
    )  # fmt: skip


def cloud(rng, m, size=0.1):
    middle, half = rng.uniform(-1, 1, (m, 1, 3)), size * rng.uniform(0, 1, (m, 1, 3))
    return np.concatenate([middle - half, middle + half], 1)


def pose(rng, where=0.0):
    q = rng.normal(size=4)
    q /= np.linalg.norm(q)
    return tuple(rng.normal(size=3) * where), tuple(q)


def turned(x, pose):
    p, (w, *u) = pose
    return Rotation.from_quat([*u, w]).apply(x) + p


def box_corners(piece):
    signs = np.array(np.meshgrid(*[[-1, 1]] * 3)).reshape(3, -1).T
    return piece["centre"] + signs * piece["size"]


@pytest.mark.parametrize("m", [1, 2, 3, 7, 64, 1000])
def test_a_tree_holds_every_piece_once(m):
    """Every node's box and ball hold its leaves; a subtree is the range i .. after - 1; depth is the least possible."""
    rng = np.random.default_rng(m)
    boxes = cloud(rng, m)
    order, nodes = build_tree(boxes[:, 0], boxes[:, 1], np.linalg.norm(boxes[:, 1] - boxes[:, 0], axis=1) / 2)
    assert sorted(order) == list(range(m)) and len(nodes) == 2 * m - 1
    leaves = nodes["piece"][nodes["piece"] >= 0]
    assert np.array_equal(leaves, np.arange(m))  # in depth-first order: a node's pieces are a range

    def depth(i):
        inside = nodes["piece"][i : nodes["after"][i]]
        own = boxes[order[inside[inside >= 0]]]
        c, h = nodes["centre"][i], nodes["half"][i]
        assert (own[:, 0] >= c - h).all() and (own[:, 1] <= c + h).all()
        far = np.maximum(np.abs(own[:, 0] - c), np.abs(own[:, 1] - c))
        assert nodes["reach"][i] >= np.linalg.norm(far, axis=1).max() * 0.5
        return 0 if nodes["right"][i] < 0 else 1 + max(depth(i + 1), depth(nodes["right"][i]))

    assert depth(0) == int(np.ceil(np.log2(m)))


@pytest.mark.parametrize("seed", range(20))
def test_pieces_near_a_box(seed):
    rng = np.random.default_rng(seed)
    boxes = [cloud(rng, 5), cloud(rng, 200)]
    shapes = shapes_of(boxes)
    lo = rng.uniform(-1, 1, 3)
    hi = lo + rng.uniform(0, 1, 3)
    out = np.zeros(300, np.int64)
    for party in (0, 1):
        own = slice(shapes.first_piece[party], shapes.first_piece[party + 1])
        rows = shapes.pieces[own]
        meet = (rows["centre"] - rows["size"] <= hi).all(1) & (rows["centre"] + rows["size"] >= lo).all(1)
        count = boxes_at(shapes, party, tuple(lo), tuple(hi), out)
        assert sorted(out[:count]) == list(np.flatnonzero(meet) + own.start)
    full = np.full(1, -1)
    assert boxes_at(shapes, 1, tuple(lo), tuple(hi), full) == count  # says how many there are, writes what fits


def six_axes_gap(shapes, i, pose_a, j, pose_b):
    """Largest gap of two boxes along their six face directions: a lower bound of their distance."""
    a, b = (turned(box_corners(shapes.pieces[k]), pose) for k, pose in ((i, pose_a), (j, pose_b)))
    gaps = []
    for p in (pose_a, pose_b):
        for axis in turned(np.eye(3), ((0, 0, 0), p[1])):
            gaps += [(b @ axis).min() - (a @ axis).max(), (a @ axis).min() - (b @ axis).max()]
    return max(gaps)


@pytest.mark.parametrize("seed", range(20))
def test_near_pairs_of_two_clouds(seed):
    """Every pair whose boxes no face direction separates by `within`, and no pair twice. The rest is not listed but
    for the ball test, which only takes away."""
    rng = np.random.default_rng(seed)
    shapes = shapes_of([cloud(rng, 1 + seed), cloud(rng, 60)])
    poses, within = (pose(rng), pose(rng, 0.5)), rng.choice([0.0, 0.05, 0.3])
    out = np.zeros((5000, 2), np.int64)
    count = pairs(shapes, 0, poses[0], 1, poses[1], within, out)
    found = [tuple(p) for p in out[:count]]
    assert len(set(found)) == count
    found = set(found)
    for i in range(1 + seed):
        for j in range(1 + seed, 61 + seed):
            gap = six_axes_gap(shapes, i, poses[0], j, poses[1])
            if (i, j) in found:
                assert gap <= within + 1e-9
            else:  # apart by a face direction or as balls
                a, b = (turned(shapes.pieces[[k]]["centre"], p) for k, p in ((i, poses[0]), (j, poses[1])))
                reach = np.linalg.norm(shapes.pieces["size"][[i, j]], axis=1).sum()
                assert gap > within - 1e-9 or np.linalg.norm(a - b) - reach > within - 1e-9
    few = np.full((1, 2), -1)
    assert pairs(shapes, 0, poses[0], 1, poses[1], within, few) == count


def test_near_pairs_with_half_spaces():
    """A half-space lists the pieces that are not above it by more than `within`; two of them are one pair."""
    rng = np.random.default_rng(3)
    n = np.array([0.3, -0.2, 1.0])
    shapes = shapes_of([n, cloud(rng, 300), n])
    still = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))
    body, out = pose(rng, 0.3), np.zeros((400, 2), np.int64)
    height = [(turned(box_corners(p), body) @ n).min() / np.linalg.norm(n) for p in shapes.pieces[1:301]]
    for within in (0.0, 0.2):
        count = pairs(shapes, 0, still, 1, body, within, out)
        assert sorted(out[:count, 1] - 1) == list(np.flatnonzero(np.array(height) <= within))
        assert pairs(shapes, 1, body, 0, still, within, out) == count
    assert pairs(shapes, 0, still, 2, still, 0.0, out) == 1


@pytest.mark.parametrize(
    "kind, size", [(BOX, (0.9, 1.0, 1.1)), (FRUSTUM, (0.5, 1.4, 1.0)), (ELLIPSOID, (1.2, 1.0, 1.5))]
)
def test_near_pairs_with_a_hole(kind, size):
    """A body in a hole lists the pieces near the wall: what it leaves out is deeper inside than `within`, what it lists
    is not deeper than that and the piece's own size. Measured: 25, 55, 10 of 300 are listed."""
    rng = np.random.default_rng(4)
    shapes = shapes_of([np.ones(3), 0.8 * cloud(rng, 300, 0.02)])
    shapes.pieces["kind"][0], shapes.pieces["size"][0] = kind + CAVITY, size
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    shapes.pieces["axes"][0] = turn * np.sign(np.linalg.det(turn))
    here, body, out = pose(rng, 1.0), pose(rng), np.zeros((400, 2), np.int64)
    body = (tuple(np.array(here[0]) + 0.05), body[1])
    within = 0.02
    count = pairs(shapes, 0, here, 1, body, within, out)
    listed = set(out[:count, 1])
    u = rng.normal(size=(3000, 3))
    u /= np.linalg.norm(u, axis=1)[:, None]
    for j in range(1, 301):
        x = turned(box_corners(shapes.pieces[j]), body) - here[0]
        own = Rotation.from_quat([*here[1][1:], here[1][0]]).inv().apply(x) @ shapes.pieces["axes"][0].T
        depth = min(hole_depth(kind, np.array(size), p, u) for p in own)
        assert j in listed or depth > within - 1e-9
        if kind != ELLIPSOID:  # whose bound is loose where it is flat
            assert j not in listed or depth <= within + 2.01 * np.linalg.norm(shapes.pieces["size"][j])
    assert 5 < count < 60
    assert pairs(shapes, 1, body, 0, here, within, out) == count


def hole_depth(kind, size, x, u):
    """Distance of x inside a hole from its wall: along the face normals, for the ellipsoid along many directions."""
    if kind == BOX:
        return (size - np.abs(x)).min()
    if kind == FRUSTUM:
        slope = (size[1] - size[0]) / (2 * size[2])
        side = (size[0] + slope * (x[2] + size[2]) - np.hypot(x[0], x[1])) / np.hypot(1.0, slope)
        return min(side, size[2] - abs(x[2]))
    if np.linalg.norm(x / size) > 1:
        return -1.0
    return np.linalg.norm(u * size - x, axis=1).min()


def test_parties_without_pieces_have_no_pairs():
    rng = np.random.default_rng(0)
    shapes = shapes_of([cloud(rng, 3)])
    shapes = shapes._replace(first_piece=np.array([0, 3, 3]), first_node=np.array([0, 5, 5]))
    boxes, none = np.zeros((2, 6)), np.zeros((9, 2), np.int64)
    assert pairs(shapes, 0, pose(rng), 1, pose(rng), 1.0, none) == 0
    all_bounds(shapes, np.zeros(0, POSE), boxes)
    assert (boxes[1, :3] > boxes[1, 3:]).all()
    assert overlaps(np.vstack([boxes, [[-np.inf] * 3 + [np.inf] * 3]]), np.ones((3, 3), bool), none[:3, 0], none) == 1


@pytest.mark.parametrize("seed", range(10))
def test_bounds_hold_the_party(seed):
    rng = np.random.default_rng(seed)
    shapes = shapes_of([cloud(rng, 1 + 3 * seed), np.array([0.0, 0.0, 1.0]), np.array([0.0, -2.0, 0.0]), np.ones(3)])
    poses = np.zeros(1, POSE)
    p, q = pose(rng, 1.0)
    poses["p"], poses["q"] = p, q
    boxes = np.zeros((4, 6))
    all_bounds(shapes, poses, boxes)
    corners = np.vstack([turned(box_corners(piece), (p, q)) for piece in shapes.pieces[: 1 + 3 * seed]])
    assert (corners >= boxes[0, :3] - 1e-12).all() and (corners <= boxes[0, 3:] + 1e-12).all()
    assert np.ptp(boxes[0].reshape(2, 3), axis=0).max() < 2 * np.sqrt(3) * np.ptp(corners, axis=0).max()
    inf = np.inf
    assert list(boxes[1]) == [-inf, -inf, -inf, inf, inf, 0.0]
    assert list(boxes[2]) == [-inf, 0.0, -inf, inf, inf, inf]
    assert list(boxes[3]) == [-inf] * 3 + [inf] * 3


@pytest.mark.parametrize("n", [1, 2, 5, 100, 500])
def test_overlapping_parties(n):
    """Against all pairs: touching boxes count, infinite ones too, forbidden pairs do not."""
    rng = np.random.default_rng(n)
    middle = rng.uniform(0, 1, (n, 3)) * [1.0, 30.0, 2.0]
    boxes = np.hstack([middle - 0.3, middle + 0.3])
    if n > 4:
        boxes[0] = [-np.inf] * 3 + [np.inf] * 3
        boxes[1] = [-np.inf, -np.inf, -np.inf, np.inf, 5.0, np.inf]
        boxes[3, :3] = boxes[2, 3:]  # touch in one point
        boxes[3, 3:] = boxes[3, :3] + 1.0
    allowed = rng.random((n, n)) < 0.8
    allowed &= allowed.T
    if n > 4:
        allowed[2, 3] = allowed[3, 2] = True
    meet = (boxes[:, None, :3] <= boxes[None, :, 3:]).all(2)
    wanted = np.argwhere(np.triu(meet & meet.T & allowed, 1))
    out = np.zeros((n * n, 2), np.int64)
    count = overlaps(boxes, allowed, np.zeros(n, np.int64), out)
    found = out[:count]
    assert np.array_equal(found[np.lexsort(found.T[::-1])], wanted)
    assert overlaps(boxes, allowed, np.zeros(n, np.int64), out[:0]) == count


def test_node_is_small():
    """A tree of 20 000 triangles stays in the second-level cache of one core or little more: 80 bytes a node."""
    assert NODE.itemsize <= 80
