"""How work is shared among threads."""

import math

import numpy as np
import pytest

from flowgmo.flow.columns import cells_in
from flowgmo.flow.team import COLUMN, PIECES, Team


def fill(columns, first, last, seen):
    seen[first:last] += 1


def uneven_columns():
    """Long columns on one side, short ones on the other: a dam and the puddle before it."""
    lengths = np.repeat([40, 3], [500, 3000])
    n = len(lengths)
    return np.column_stack([np.arange(n), np.zeros(n), np.full(n, 2), 2 + lengths]).astype(np.int32)


def test_every_column_is_done_once_however_it_is_shared(monkeypatch):
    monkeypatch.setattr("flowgmo.flow.team.WORTHWHILE", 0)
    columns = uneven_columns()
    for threads in (1, 2, 3):
        team = Team(threads)
        for run in (team.run, team.run_uneven):
            seen = np.zeros(len(columns), int)
            run(fill, columns, seen)
            assert (seen == 1).all()
        assert len(team.parts(columns, PIECES * threads)) == PIECES * threads


@pytest.mark.parametrize("worthwhile, shared", [(math.inf, False), (0.0, True)])
def test_what_took_too_short_a_time_is_done_by_one(monkeypatch, worthwhile, shared):
    monkeypatch.setattr("flowgmo.flow.team.WORTHWHILE", worthwhile)
    calls = []

    def note(columns, first, last):
        calls.append((first, last))

    team, columns = Team(2), uneven_columns()
    for run in (team.run, team.run_uneven):
        run(note, columns)  # nothing is known of it yet, or what was known is used
        calls.clear()
        run(note, columns)
        assert (len(calls) > 1) == shared
        assert sum(b - a for a, b in calls) == len(columns)


def test_short_columns_count_more_than_their_cells():
    """Halves of equal cost, not of equal cells: by cells the half with the puddle took 1.4 times its time."""
    columns = uneven_columns()
    (_, cut), _ = Team(2).parts(columns, 2)
    cost = [cells_in(part) + COLUMN * len(part) for part in (columns[:cut], columns[cut:])]
    assert abs(cost[0] - cost[1]) <= 40 + COLUMN  # one column
    assert cells_in(columns[:cut]) > 1.2 * cells_in(columns[cut:])  # 1.7; by cells it would be 1.0


def test_errors_of_a_thread_reach_the_caller():
    def fail(columns, first, last):
        if first > 0:
            raise ValueError("here")

    team, columns = Team(2), uneven_columns()
    for run in (team.run, team.run_uneven):
        try:
            run(fail, columns)
        except ValueError as error:
            assert str(error) == "here"
        else:
            raise AssertionError("no error")
