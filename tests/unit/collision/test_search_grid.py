"""The search on mesh nodes (report, section 3.1): the deepest node that both bodies hold, normal of the flatter one."""

import numpy as np
import pytest
from arenas import arena_of
from flowgmo_scenes import ball, deck, solid

from flowgmo.collision.gather import no_contacts
from flowgmo.collision.grid_watch import GridWatch

R, CELLS = 0.31, 40
FLOOR = (-0.7, 0.7), (-0.7, 0.7), (-0.4, 0.013)  # its top lies between two planes of nodes


def touching(x, v=(0.2, 0, -1), first="ball", w=(0, 0, 0)):
    """Contacts of a ball at x and a stationary box, by the nodes of 40 x 40 x 40 cells in (-1, 1)³."""
    bodies = [ball((0, 0, 0.6), R, v=v, w=w, mu=0.2), solid(*zip(*FLOOR, strict=True))]  # apart; moved below
    if first == "box":
        bodies.reverse()
    text = deck(*bodies, lo=(-1,) * 3, hi=(1,) * 3, cells=CELLS, e=0.5, mu=0.3, knobs="search='grid',")
    watch = GridWatch(arena_of(text))
    watch.arena.motion["p"][bodies.index(next(b for b in bodies if "rsh" in b))] = x
    return watch, watch.touching(no_contacts())


def nodes_in_both(x):
    """Nodes (k, 3) of the mesh in both bodies, and the sum of their depths (k,)."""
    planes = np.linspace(-1, 1, CELLS + 1)
    every = np.stack(np.meshgrid(planes, planes, planes, indexing="ij"), -1).reshape(-1, 3)
    in_ball = R - np.linalg.norm(every - x, axis=1)
    lo, hi = np.array(FLOOR).T
    in_box = np.minimum(every - lo, hi - every).min(axis=1)
    both = (in_ball >= 0) & (in_box >= 0)
    return every[both], (in_ball + in_box)[both]


def test_no_node_in_both_is_no_contact():
    """The ball reaches 4 mm into the box, the node planes do not: the contact comes late by up to a cell (5 cm)."""
    assert len(touching((0.02, 0.03, 0.013 + R - 0.004))[1]) == 0


@pytest.mark.parametrize("first", ["ball", "box"])
@pytest.mark.parametrize("x", [(0.02, 0.03, 0.28), (-0.31, 0.12, 0.26), (0.1, -0.2, 0.3)])
def test_the_deepest_node_and_the_flat_normal(x, first):
    """The node with the largest sum of depths of all that lie in both; the normal of the box, the flatter one, turned
    from b to a whichever of them is the ball; the gap is minus the depths. Fails if the ball's normal is taken."""
    _, found = touching(x, first=first)
    nodes, depth = nodes_in_both(np.array(x))
    assert len(found) == 1 and len(nodes) > 3
    (contact,) = found
    here = np.flatnonzero(np.all(np.abs(nodes - contact["point"]) < 1e-12, axis=1))
    assert here.size == 1 and depth[here[0]] == pytest.approx(depth.max(), rel=1e-12)
    assert contact["gap"] == pytest.approx(-depth.max(), rel=1e-12)
    np.testing.assert_allclose(contact["normal"], [0, 0, 1 if first == "ball" else -1], atol=1e-14)
    assert (contact["a"], contact["b"], contact["e"], contact["mu"], contact["fresh"]) == (0, 1, 0.5, 0.2, 1)


def test_a_ball_that_leaves_is_no_contact():
    """No node with approaching velocity: it may lie in both, an impact would pull."""
    assert len(touching((0.02, 0.03, 0.28), v=(0.2, 0, 1e-9))[1]) == 0


def test_a_look_is_due_before_half_a_cell_is_crossed():
    """Fastest point |v| + |ω| R: the time in which it goes half a cell of 5 cm. Without motion never."""
    watch, _ = touching((0.02, 0.03, 0.6), v=(3, 0, -4), w=(0, 10, 0))
    assert watch.longest() == pytest.approx(0.025 / (5 + 10 * R), rel=1e-6)
    assert touching((0.02, 0.03, 0.6), v=(0, 0, 0))[0].longest() == np.inf


def test_held_pairs_keep_impulse_and_age():
    """A contact that was there before is not new, wherever the node is now."""
    watch, found = touching((0.02, 0.03, 0.28))
    found["impulse"], found["age"] = (1, 2, 3), 0.7
    watch.arena.motion["p"][0, 0] += 0.2
    (now,) = watch.touching(found)
    assert now["fresh"] == 0 and now["age"] == 0.7 and tuple(now["impulse"]) == (1, 2, 3)
    assert abs(now["point"][0] - found["point"][0, 0]) > 0.1


def test_a_block_that_lies_flat_touches_in_four_nodes_that_span_its_face():
    """Of 5 x 5 nodes in its lower face: the mean of the four within a cell of its middle, none on a line of three."""
    block = solid((-0.11, -0.12, 0.6), (0.11, 0.12, 0.8)).replace("imo(#)=0", "imo(#)=4, rhomvb(#)=1000.0")
    text = deck(block, solid((-1, -1, -1), (1, 1, 0.013)), lo=(-1,) * 3, hi=(1,) * 3, cells=CELLS, e=0.5,
                knobs="search='grid',")  # fmt: skip
    watch = GridWatch(arena_of(text))
    watch.arena.motion["p"][0, 2] = 0.08
    watch.arena.motion["v"][0, 2] = -1.0
    found = watch.touching(no_contacts())
    assert len(found) == 4
    np.testing.assert_allclose(found["normal"], [[0, 0, 1]] * 4, atol=1e-14)
    spread = found["point"][:, :2]
    assert np.linalg.norm(spread.mean(axis=0)) < 0.05
    assert np.linalg.matrix_rank(spread - spread.mean(axis=0), tol=0.05) == 2
    watch.arena.motion["v"][0, 2] = 0.0
    assert len(watch.touching(no_contacts())) == 0
    assert len(watch.touching(found)) == 4
