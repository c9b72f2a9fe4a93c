"""Faces that are hardly open: widened for the pressure."""

import numpy as np
from flow_solids import ball, graded_block

from flowgmo.flow.favor.fractions import open_fractions
from flowgmo.flow.favor.moving_openings import MovingOpenings
from flowgmo.flow.favor.near_surface import Pose
from flowgmo.flow.fields import Open
from flowgmo.flow.immersed.narrow_faces import NARROW, NarrowFaces


def _moved(block):
    """The mean openings of a ball's step, and what it touches."""
    still, poses = (
        open_fractions(block, []),
        [Pose(np.eye(3), np.array(t)) for t in ((0.5, 0.5, 0.5), (0.51, 0.5, 0.5))],
    )
    moving = MovingOpenings(block, still, [], [ball(0.2, (0.0, 0.0, 0.0))], poses[:1])
    return moving.mean, moving.sweep(poses[1:])


def test_faces_are_open_by_a_hundredth_and_shares_shrink_as_much():
    """A + S = 1 on each widened face inside the domain."""
    mean, swept = _moved(graded_block(14))
    before = Open(*(a.copy() for a in mean))
    numbers = np.ravel_multi_index(tuple(swept.cells.T.astype(np.int64)), mean.V.shape)
    found = NarrowFaces(mean, numbers)
    mine, seen = found.shares_of(swept.shares[0]), 0
    for d, (A, was) in enumerate(zip(mean[1:], before[1:], strict=True)):
        assert (A[was != A] == NARROW).all()
        at = tuple(mine.cells.T)
        widened = (was != A)[at]
        seen += widened.sum()
        np.testing.assert_allclose(mine.faces[widened, 2 * d + 1], 1.0 - NARROW, atol=1e-12)
    assert seen > 5
