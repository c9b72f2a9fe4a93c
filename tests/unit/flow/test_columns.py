"""Columns, what leaves them, and the threads that share them."""

import numpy as np
import pytest

from flowgmo.flow.columns import all_columns, clear_left, columns_among, columns_under, columns_where, tabulate, widen
from flowgmo.flow.fields import G
from flowgmo.flow.momentum.prediction import fill
from flowgmo.flow.team import REMEMBERED, Team

SHAPE = (9, 8, 12)
REAL = (slice(G, -G),) * 3


def marked(seed, share=0.15):
    a = np.zeros(SHAPE)
    a[REAL] = np.random.default_rng(seed).random(a[REAL].shape) < share
    return a


def cells_of(columns):
    a = np.zeros(SHAPE, bool)
    for i, j, k0, k1 in columns:
        a[i, j, k0:k1] = True
    return a


def test_columns_hold_the_marked_cells_from_the_lowest_to_the_highest():
    a = marked(1)
    columns = columns_where(a, 0.5)
    assert len(columns) == (a > 0.5).any(axis=2).sum()
    for i, j, k0, k1 in columns:
        assert a[i, j, k0] > 0.5 and a[i, j, k1 - 1] > 0.5
    assert not (a > 0.5)[~cells_of(columns)].any()


def test_wider_columns_hold_every_neighbour_and_no_ghost():
    columns = columns_where(marked(2, 0.03), 0.5)
    wide = cells_of(widen(columns, 2, SHAPE, np.zeros((*SHAPE[:2], 2), np.int32)))
    for i, j, k in np.argwhere(cells_of(columns)):
        assert wide[max(i - 2, G) : i + 3, max(j - 2, G) : j + 3, max(k - 2, G) : k + 3][:3, :3, :3].any()
        block = tuple(slice(max(x - 2, G), min(x + 3, n - G)) for x, n in zip((i, j, k), SHAPE, strict=True))
        assert wide[block].all()
    wide[REAL] = False
    assert not wide.any()


@pytest.mark.parametrize("by", [1, 2])
@pytest.mark.parametrize("seed", range(4))
def test_wider_columns_reach_no_further_than_asked(by, seed):
    """One by one: each line holds what the lines within reach hold, so many cells longer, in real cells."""
    columns, ends = columns_where(marked(seed, 0.04), 0.5), np.ones((*SHAPE[:2], 2), np.int32)
    expected = np.zeros((*SHAPE[:2], 2), int)
    expected[..., 0] = 99
    for i, j, k0, k1 in columns:
        for m in range(max(i - by, G), min(i + by + 1, SHAPE[0] - G)):
            for n in range(max(j - by, G), min(j + by + 1, SHAPE[1] - G)):
                expected[m, n, 0] = min(expected[m, n, 0], max(k0 - by, G))
                expected[m, n, 1] = max(expected[m, n, 1], min(k1 + by, SHAPE[2] - G))
    wide = widen(columns, by, SHAPE, ends)
    there = expected[..., 0] < expected[..., 1]
    assert np.array_equal(wide[:, :2], np.argwhere(there)) and np.array_equal(wide[:, 2:], expected[there])
    assert np.array_equal(ends[there], expected[there]) and (ends[~there][:, 0] >= ends[~there][:, 1]).all()


def test_coarse_columns_hold_all_fine_cells():
    columns = columns_where(marked(3), 0.5)
    ends = np.full(((SHAPE[0] - 2 * G + 1) // 2 + 2 * G, SHAPE[1] - 2 * G + 2 * G, 2), 99, np.int32)
    coarse = columns_under(columns, (2, 1, 4), ends)
    held = {(i, j, k) for i, j, k0, k1 in coarse for k in range(k0, k1)}
    for i, j, k in np.argwhere(cells_of(columns)):
        assert ((i - G) // 2 + G, j, (k - G) // 4 + G) in held
    table = np.zeros_like(ends)
    tabulate(coarse, table)
    assert np.array_equal(table, ends)


@pytest.mark.parametrize("seed", range(5))
def test_what_left_is_zero_and_what_stayed_is_kept(seed):
    old, new = columns_where(marked(seed, 0.1), 0.5), columns_where(marked(seed + 100, 0.1), 0.5)
    a, ends = np.where(cells_of(old), 7.0, 0.0), np.zeros((*SHAPE[:2], 2), np.int32)
    tabulate(new, ends)
    Team(1).run(clear_left, old, ends, a)
    assert np.array_equal(a, np.where(cells_of(old) & cells_of(new), 7.0, 0.0))


def test_threads_do_every_column_once_and_keep_their_shares(monkeypatch):
    monkeypatch.setattr("flowgmo.flow.team.WORTHWHILE", 0)
    team, a = Team(3), np.zeros(SHAPE)
    columns = all_columns(SHAPE)
    assert len(team.parts(columns, 3)) == 3
    team.run(fill, columns, 1.0, a)
    assert a.sum() == a[REAL].size
    for n in range(2 * REMEMBERED):  # other tables, often where an old one lay in memory
        some = columns[: 5 + n % 30].copy()
        assert team.parts(some, 3)[-1][1] == len(some)
    assert team.parts(columns, 3)[-1][1] == len(columns)


def test_an_error_of_any_thread_is_raised_and_the_team_works_on():
    def broken(columns, first, last):
        raise ArithmeticError("here")

    def elsewhere(columns, first, last):
        if first > 0:
            raise ArithmeticError("there")

    team, columns = Team(2), all_columns((54, 54, 54))
    for kernel in (broken, elsewhere):
        with pytest.raises(ArithmeticError):
            team.run(kernel, columns)
    a = np.zeros((54, 54, 54))
    team.run(fill, columns, 2.0, a)
    assert a.max() == 2.0


@pytest.mark.parametrize("seed", range(3))
def test_columns_among_wider_ones_are_those_of_all_cells(seed):
    """Also where the wider ones begin in the ghosts, as those of the liquid do."""
    a = marked(seed, 0.1)
    wider = all_columns(a.shape) + np.array([0, 0, -1, 1], np.int32)
    beyond = np.array([[1, 3, 1, 4], [a.shape[0] - 2, 2, 2, 3]], np.int32)
    among = columns_among(np.concatenate([beyond, wider]), a, 0.5)
    assert np.array_equal(among, columns_where(a, 0.5))
