"""Velocities beside the liquid."""

import numpy as np
import pytest

from flowgmo.flow.columns import all_columns
from flowgmo.flow.fields import G
from flowgmo.flow.momentum.extrapolation import BEYOND, CLOSED, CONTINUED, FREE, HELD, continue_velocity
from flowgmo.flow.team import Team

SHAPE = (12, 11, 14)


def pool(direction, depth=6, drop=None):
    """b, F, velocity of a pool up to layer `depth` along z whose held faces all move at 3; maybe a drop above it."""
    b, F, u = np.zeros(SHAPE), np.zeros(SHAPE), np.full(SHAPE, 0.5)
    F[:, :, :depth] = 1.0
    b[:, :, :depth] = 1.0
    u[:, :, :depth] = 3.0
    if drop:
        F[drop] = 0.3
    return b, F, u


@pytest.mark.parametrize("direction", [0, 1, 2])
def test_a_uniform_stream_goes_on_for_two_cells_and_drops_keep_their_own(direction):
    b, F, u = pool(direction, drop=(6, 6, 10))
    mark = np.zeros(SHAPE, np.int8)
    continue_velocity(Team(1), all_columns(SHAPE), b, None, F, u, direction, False, 1e-9, mark)
    real = (slice(G, -G - 1),) * 2
    assert np.all(u[real][:, :, 6:8] == pytest.approx(3.0, rel=1e-14))
    assert (mark[real][:, :, 6] == CONTINUED).all()
    assert mark[real][:, :, 7].min() == mark[real][:, :, 7].max() == BEYOND
    assert mark[6, 6, 10] == FREE and u[6, 6, 10] == 0.5
    assert (u[real][:, :, 9] == 0.0).sum() > 0.5 * u[real][:, :, 9].size  # nothing is near: no velocity
    assert (mark[real][:, :, 3] == HELD).all()


def test_closed_faces_give_nothing_and_get_nothing():
    b, F, u = pool(0)
    A = np.ones(SHAPE)
    A[6, 6, 6] = 0.0
    u[6, 6, 6] = -99.0
    mark = np.zeros(SHAPE, np.int8)
    continue_velocity(Team(1), all_columns(SHAPE), b, A, F, u, 0, False, 1e-9, mark)
    assert mark[6, 6, 6] == CLOSED and u[6, 6, 6] == -99.0
    assert u[G : -G - 1, G:-G, 6:8].min() in (-99.0, pytest.approx(3.0))
    assert np.sort(np.unique(u[G : -G - 1, G:-G, 6:8]))[1] == pytest.approx(3.0, rel=1e-14)


def test_order_of_visits_does_not_matter():
    rng = np.random.default_rng(4)
    b = (rng.random(SHAPE) < 0.3) * 1.0
    F, u = rng.random(SHAPE) * (rng.random(SHAPE) < 0.4), rng.standard_normal(SHAPE)
    results = []
    for columns in (all_columns(SHAPE), all_columns(SHAPE)[::-1].copy()):
        value, mark = u.copy(), np.zeros(SHAPE, np.int8)
        continue_velocity(Team(1), columns, b, None, F, value, 1, False, 1e-9, mark)
        results.append((value, mark))
    assert np.array_equal(results[0][0], results[1][0])
    assert np.array_equal(results[0][1], results[1][1])
