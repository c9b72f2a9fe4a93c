"""Hits: points of one hit together, sums kept, rebounds counted once; marks, counts and table of them."""

import h5py
import numpy as np
import pytest
from matplotlib import pyplot as plt

from postproc.bounces import rebounds
from postproc.impacts import hits
from postproc.marks import MANY, counts_of, mark_impacts
from postproc.results import Results
from postproc.tables import MOST_ROWS, draw_table, impact_rows

T = np.linspace(0, 2, 41)


@pytest.fixture
def recorded(tmp_path):
    """A function that writes `/collisions` by hand: rows of (time, a, b, cluster, impulse)."""

    def write(rows, t=T, position=None, velocity=None):
        with h5py.File(tmp_path / "history.h5", "w") as file:
            file.attrs.update({"format": "flowgmo history", "gravity": [0.0, 0.0, -9.81], "title": "A test"})
            file["time"] = t
            body = file.create_group("bodies/box")
            body.attrs["number"] = 1
            body["position"] = np.zeros((len(t), 3)) if position is None else position
            body["velocity"] = np.zeros((len(t), 3)) if velocity is None else velocity
            group = file.create_group("collisions")
            group.attrs["names"] = ["-5 Zmin", "1 box", "2 ball", "3 stone"]
            for k, name in enumerate(("time", "a", "b", "cluster")):
                group[name] = np.array([row[k] for row in rows], dtype=float if k == 0 else np.int64)
            group["impulse"] = np.array([row[4] for row in rows], dtype=float)
            group["normal"] = np.tile([0.0, 0.0, 1.0], (len(rows), 1))
            group["count"] = np.ones(len(rows), dtype=np.int64)
            group["energy_loss"] = np.arange(len(rows)) + 1.0
        return Results(tmp_path)

    return write


def test_corners_of_a_box_are_one_hit(recorded):
    """Four points give one row with the sum 4, not four rows; a second landing is a hit of its own."""
    corners = [(0.5, 1, -5, 0, (0, 0, 1.0))] * 4
    found = hits(recorded([*corners, (1.0, 1, -5, 1, (0, 0, 2.0))]))
    assert found.points.tolist() == [4, 1] and found.time.tolist() == [0.5, 1.0]
    assert found.size.tolist() == [4.0, 2.0] and found.loss.tolist() == [10.0, 5.0]


def test_who_is_named_first_does_not_matter(recorded):
    """Impulse on a = - impulse on b: rows 1-2 and 2-1 of one hit add up, they do not cancel."""
    found = hits(recorded([(0.5, 2, 1, 0, (1.0, 2, 3)), (0.5, 1, 2, 0, (-1.0, -2, -3))]))
    assert (found.a.tolist(), found.b.tolist()) == ([2], [1])
    assert found.impulse.tolist() == [[2.0, 4.0, 6.0]]


def test_pairs_of_a_cluster_are_told_apart_and_so_are_clusters_of_a_continued_run(recorded):
    rows = [(0.5, 1, 2, 0, (1, 0, 0)), (0.5, 2, 3, 0, (1, 0, 0)), (0.7, 1, 2, 0, (1, 0, 0))]
    found = hits(recorded(rows))
    assert found.time.tolist() == [0.5, 0.5, 0.7] and found.points.tolist() == [1, 1, 1]


@pytest.mark.parametrize("seed", range(5))
def test_sums_over_hits_are_those_over_rows(recorded, seed):
    """What each body gets, the energy, and the number of points are the record's, however it is grouped.

    Measured 2e-15; a lost or doubled row misses by 1e-2.
    """
    random = np.random.default_rng(seed)
    rows = []
    for cluster, time in enumerate(np.sort(random.uniform(0, 2, 40))):
        for _ in range(random.integers(1, 9)):
            a, b = random.permutation([-5, 1, 2, 3])[:2]
            rows.append((time, a, b, cluster, random.normal(size=3)))
    results = recorded(rows)
    found, raw = hits(results), results.impacts
    for body in (-5, 1, 2, 3):
        got = found.impulse[found.a == body].sum(axis=0) - found.impulse[found.b == body].sum(axis=0)
        given = raw["impulse"][raw["a"] == body].sum(axis=0) - raw["impulse"][raw["b"] == body].sum(axis=0)
        assert np.allclose(got, given, rtol=0, atol=1e-12)
    assert found.points.sum() == len(rows) and found.loss.sum() == pytest.approx(raw["energy_loss"].sum(), rel=1e-12)
    assert (np.diff(found.time) >= 0).all()
    pairs = {(r[3], min(r[1], r[2]), max(r[1], r[2])) for r in rows}
    assert len(found) == len(pairs)


def test_no_impacts(recorded):
    assert len(hits(recorded([]))) == 0


def test_a_box_that_lands_flat_rebounds_once(recorded):
    """Rows at t > 0.5 rise with 2 m/s: one rebound of height v^2/(2 g) = 0.2039, though four corners hit."""
    t = np.linspace(0, 1, 101)
    v = np.where(t < 0.5, -1.0, 2.0 - 9.81 * (t - 0.5))
    z = np.where(t < 0.5, 0.5 - t, 2 * (t - 0.5) - 9.81 * (t - 0.5) ** 2 / 2)
    up = np.array([0.0, 0.0, 1.0])
    results = recorded([(0.5, 1, -5, 0, up)] * 4, t, np.outer(z, up), np.outer(v, up))
    found = rebounds(results, "box")
    assert len(found) == 1
    assert (found[0].top, found[0].height) == (pytest.approx(0.5 + 2 / 9.81), pytest.approx(2 / 9.81))


def test_the_table_has_the_first_hits_and_the_largest(recorded):
    """20 hits of two points each; the 15th is the largest: nine rows, and that one."""
    rows = [(0.1 * k, 1, -5, k, (0, 0, 9.0 if k == 14 else 1.0)) for k in range(20) for _ in range(2)]
    table = impact_rows(recorded(rows))
    assert table.title == "Impacts (first 9 of 20; below: largest)" and len(table.rows) == MOST_ROWS
    assert table.rows[0][1:] == ["box", "Zmin", "2", "2.000"] and table.rows[-1][3:] == ["2", "18.000"]
    few = impact_rows(recorded(rows[:6]))
    assert few.title == "Impacts" and [row[3] for row in few.rows] == ["2", "2", "2"]


def test_cells_of_the_table_do_not_overlap(recorded):
    """Also with the longest names and times on a narrow page: each text lies within its column."""
    results = recorded([(1e-5 * k, 1, -5, k, (0, 0, 123.456)) for k in range(3)])
    with h5py.File(results.path, "a") as file:
        file["collisions"].attrs["names"] = ["1 a_very_long_name", "-5 WWWWWWWWWWW"]
        file["collisions/impulse"].attrs["unit"] = "dyn s"
    figure = plt.figure(figsize=(4, 3))
    axes = figure.add_axes((0, 0, 1, 0.9))
    draw_table(axes, Results(results.folder), 4.0)
    figure.canvas.draw()
    texts = {place: cell.get_text().get_window_extent() for place, cell in axes.tables[0].get_celld().items()}
    plt.close(figure)
    for (row, column), box in texts.items():
        assert column == 0 or texts[row, column - 1].x1 < box.x0
        assert box.x0 >= 0 and box.x1 <= 4 * figure.dpi


@pytest.mark.parametrize("t1", [0.02, 1.0, 7.3, 1e4])
def test_every_impact_is_counted_once(recorded, t1):
    """Also those at the very start and end; at most 200 spans, at least 20."""
    times = np.concatenate([[0.0], np.random.default_rng(1).uniform(0, t1, 300), [t1]])
    found = hits(recorded([(t, 1, -5, k, (0, 0, 1.0)) for k, t in enumerate(times)]))
    counts, edges = counts_of(found, 0.0, t1)
    assert counts.sum() == len(times) == len(found) and 20 <= len(counts) <= 200
    assert np.allclose(np.diff(edges[:-1]), edges[1] - edges[0])


@pytest.mark.parametrize("n", [MANY - 1, MANY])
def test_few_impacts_are_marks_and_many_are_bars(recorded, n):
    found = hits(recorded([(2 * k / n, 1, -5, k, (0, 0, 1.0)) for k in range(n)]))
    figure, axes = plt.subplots()
    mark_impacts(axes, found, 0.0, 2.0, "s")
    (text,) = axes.get_legend_handles_labels()[1]
    marks, bars = len(axes.lines), len(axes.patches)
    plt.close(figure)
    assert (marks, bars > 0) == ((1, False) if n < MANY else (0, True))
    assert text == ("impact" if n < MANY else "impacts, up to 1 in 0.02 s")
