"""Velocities beside the liquid."""

import numpy as np
import pytest
from scipy import ndimage

from flowgmo.flow.columns import all_columns
from flowgmo.flow.fields import G
from flowgmo.flow.momentum.extrapolation import FILM_BELOW, continue_velocity, find_sources, make_beside
from flowgmo.flow.team import Team

SHAPE = (12, 11, 14)
NONE, HELD, CONTINUED, FREE, BEYOND, CLOSED = range(6)


def faces_of(bits, nz):
    """(nx, ny, nz) bool of bits as of face_bits.py."""
    words = np.ascontiguousarray(bits[:, :, 1:-1]).astype("<u8").view(np.uint8)
    return np.unpackbits(words, axis=2, bitorder="little")[:, :, :nz].astype(bool)


def kinds_of(beside, d):
    """(mesh) the kinds of the faces along d, the last direction that was looked at."""
    shape = beside.sources[d].shape
    mark = np.full(shape, NONE)
    bits = beside.free, beside.held, beside.closed, beside.continued[d], beside.beyond[d]
    for kind, one in zip((FREE, HELD, CLOSED, CONTINUED, BEYOND), bits, strict=True):
        mark[faces_of(one, shape[2])] = kind
    films = (mark == CONTINUED) & (beside.sources[d] >= FILM_BELOW)
    mark[films] = FREE
    return mark


def continued(columns, b, A, F, u, d):
    """u becomes continued along d; returns the marks of its faces."""
    present = tuple(e == d for e in range(3))
    beside = make_beside(F.shape, present)
    only = [[x if there else None for there in present] for x in (b, A, u)]
    find_sources(
        Team(1), columns, columns, only[0], only[1], np.ones(F.shape[:2], np.int8), F, (False,) * 3, 1e-9, beside
    )
    continue_velocity(Team(1), columns, only[2], beside)
    return kinds_of(beside, d)


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
    mark = continued(all_columns(SHAPE), b, None, F, u, direction)
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
    mark = continued(all_columns(SHAPE), b, A, F, u, 0)
    assert mark[6, 6, 6] == CLOSED and u[6, 6, 6] == -99.0
    assert u[G : -G - 1, G:-G, 6:8].min() in (-99.0, pytest.approx(3.0))
    assert np.sort(np.unique(u[G : -G - 1, G:-G, 6:8]))[1] == pytest.approx(3.0, rel=1e-14)


def test_order_of_visits_does_not_matter():
    rng = np.random.default_rng(4)
    b = (rng.random(SHAPE) < 0.3) * 1.0
    F, u = rng.random(SHAPE) * (rng.random(SHAPE) < 0.4), rng.standard_normal(SHAPE)
    results = []
    for columns in (all_columns(SHAPE), all_columns(SHAPE)[::-1].copy()):
        value = u.copy()
        mark = continued(columns, b, None, F, value, 1)
        results.append((value, mark))
    assert np.array_equal(results[0][0], results[1][0])
    assert np.array_equal(results[0][1], results[1][1])


@pytest.mark.parametrize("nz", [14, 63, 66, 140])
@pytest.mark.parametrize("direction", [0, 2])
def test_means_weigh_the_26_neighbours_by_their_distance(direction, nz):
    """Against plain sums over neighbours, in random fields: a wrong bit or weight of one neighbour would show. Lines
    of more than 64 faces have theirs in several words."""
    rng = np.random.default_rng(7)
    shape = (12, 11, nz)
    b = (rng.random(shape) < 0.05) * 1.0
    F, u = (rng.random(shape) < 0.01) * 0.3, rng.standard_normal(shape)
    value = u.copy()
    mark = continued(all_columns(shape), b, None, F, value, direction)
    seen = []
    for kind, sources in ((CONTINUED, (HELD,)), (BEYOND, (HELD, CONTINUED, FREE))):
        given = np.isin(mark, sources)
        from_these = np.where((mark == CONTINUED) | (mark == FREE), value, u)  # films have stopped
        for i, j, k in np.argwhere(mark == kind):
            around = np.argwhere(given[i - 1 : i + 2, j - 1 : j + 2, k - 1 : k + 2]) - 1
            weight = 1.0 / (around**2).sum(axis=1)
            mean = (weight * from_these[tuple((around + [i, j, k]).T)]).sum() / weight.sum()
            assert value[i, j, k] == pytest.approx(mean, rel=1e-12, abs=1e-14)  # round-off of at most 26 terms
        seen.append(int((mark == kind).sum()))
    inside = (slice(G, -G),) * 3
    near = ndimage.binary_dilation(np.isin(mark, (HELD, CONTINUED, FREE)), np.ones((3, 3, 3)))[inside]
    none = mark[inside] == NONE
    assert not (near & none).any() and (value[inside][none] == 0.0).all()
    assert min(seen) > 10 * nz  # 14 nz or more


def test_a_film_stays_on_its_floor_and_marks_are_forgotten():
    """Films below and above their surface; and columns that the liquid has left give nothing any more."""
    columns, F = all_columns(SHAPE), np.zeros(SHAPE)
    F[5, 5, 4] = F[5, 5, 9] = 0.2
    A = np.ones(SHAPE)
    A[5, 5, 3] = A[5, 5, 9] = 0.0  # floor of the lower film, ceiling of the upper one
    w = np.zeros(SHAPE)
    w[5, 5, 4], w[5, 5, 8] = -2.0, 2.0
    beside = make_beside(SHAPE, (False, False, True))
    b, solid = [None, None, np.zeros(SHAPE)], np.ones(SHAPE[:2], np.int8)
    find_sources(Team(1), columns, columns[:0], b, [None, None, A], solid, F, (False,) * 3, 1e-9, beside)
    away = w.copy()
    away[5, 5, 4], away[5, 5, 8] = 2.0, -2.0
    continue_velocity(Team(1), columns, [None, None, w], beside)
    continue_velocity(Team(1), columns, [None, None, away], beside)
    assert w[5, 5, 4] == w[5, 5, 8] == 0.0
    assert away[5, 5, 4] == 2.0 and away[5, 5, 8] == -2.0
    find_sources(Team(1), columns[:0], columns, b, [None, None, A], solid, F, (False,) * 3, 1e-9, beside)
    assert not any(bits.any() for bits in (beside.held, beside.closed, beside.some))
