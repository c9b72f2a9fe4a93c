"""Faces that are hardly open: widened for the pressure, passed by what goes with the body as they are."""

import numpy as np
from flow_solids import ball, graded_block

from flowgmo.flow.favor.fractions import open_fractions
from flowgmo.flow.favor.moving_openings import MovingOpenings
from flowgmo.flow.favor.near_surface import Pose
from flowgmo.flow.fields import Open, grid_of
from flowgmo.flow.immersed.narrow_faces import NARROW, NarrowFaces


def _moved(block):
    """The mean openings of a ball's step, and what it touches."""
    still, poses = (
        open_fractions(block, []),
        [Pose(np.eye(3), np.array(t)) for t in ((0.5, 0.5, 0.5), (0.51, 0.5, 0.5))],
    )
    moving = MovingOpenings(block, still, [], [ball(0.2, (0.0, 0.0, 0.0))], poses[:1])
    return moving.mean, moving.sweep(poses[1:])


def test_a_stream_that_moves_with_a_ball_passes_by_what_is_open():
    """Outflow of every cell with the widened faces, less what is let by, and what carries the liquid through each face:
    those of a uniform stream through the faces as they are, to rounding."""
    block = graded_block(14)
    mean, swept = _moved(block)
    before, grid, U = Open(*(a.copy() for a in mean)), grid_of(block), np.array([1.0, 0.3, -0.2, 0.0, 0.0, 0.0])
    numbers = np.ravel_multi_index(tuple(swept.cells.T.astype(np.int64)), mean.V.shape)
    found = NarrowFaces(mean, numbers)
    assert sum(len(faces) for faces in found.faces) > 10
    centres = [np.zeros(n) for n in mean.V.shape]
    let_by = found.let_by(swept.shares, grid, centres, np.zeros((1, 3)), U[None], [np.zeros(3)])
    velocity = [np.full(mean.V.shape, u) for u in U[:3]]
    found.lean(velocity, 1.0)
    out = np.zeros(len(numbers))
    for d, (A, was, u) in enumerate(zip(mean[1:], before[1:], velocity, strict=True)):
        narrow = was != A
        assert (A[narrow] == NARROW).all()
        np.testing.assert_allclose(A * u, was * U[d], atol=1e-15)
        at, low = tuple(swept.cells.T), list(swept.cells.T)
        low[d] = low[d] - 1
        area = grid[(d + 1) % 3][at[(d + 1) % 3]] * grid[(d + 2) % 3][at[(d + 2) % 3]]
        out += U[d] * area * ((A - was)[at] - (A - was)[tuple(low)])
    assert abs(out).max() > 1e-6
    np.testing.assert_allclose(let_by, out, atol=1e-17)
    found.lean(velocity, -1.0)
    for u, exact in zip(velocity, U[:3], strict=True):
        np.testing.assert_allclose(u, exact, atol=1e-15)
