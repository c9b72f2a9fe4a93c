"""Curves that jump at impacts: exact in free flight, and never worse than the rows alone."""

import numpy as np
import pytest

from postproc.steps import stepped


def test_a_bounce_between_rows_jumps_at_its_time():
    """v falls from 0 with g, at t = 0.537 it turns to +3: the sides are exact, the rest is the rows."""
    t, g, at = np.linspace(0, 1, 11), 9.81, 0.537
    y = np.where(t < at, -g * t, 3.0 - g * (t - at))
    times, values = stepped(t, y, np.array([at]))
    assert times[6:8].tolist() == [at, at] and np.allclose(values[6:8], [-g * at, 3.0], rtol=1e-13)
    assert np.array_equal(np.delete(times, [6, 7]), t) and np.array_equal(np.delete(values, [6, 7]), y)


@pytest.mark.parametrize("late", [0.0, 1e-13])
def test_an_impact_at_a_row_is_in_that_row(late):
    """Level before and after: a vertical stroke at the row, also when the impact's time is rounded up."""
    t = np.linspace(0, 1, 11)
    y = np.where(np.arange(11) < 5, -1.0, 0.5)
    times, values = stepped(t, y, np.array([t[5] + late]))
    assert values.tolist() == [-1.0] * 6 + [0.5] * 7 and times[5] == times[6] == times[7]


def test_it_is_linear_so_that_sums_stay_level():
    t = np.linspace(0, 1, 21)
    kinetic, lost = np.where(t < 0.33, 2.0 + t, 1.0 + t), np.where(t < 0.33, 0.0, 1.0)
    sides = [stepped(t, y, np.array([0.33]))[1] for y in (kinetic, lost, kinetic + lost)]
    assert np.allclose(sides[0] + sides[1], sides[2], rtol=1e-14)


def test_what_cannot_be_known_is_left_as_it_is():
    """Two impacts in one interval; impacts in all of them; none; beyond the rows; too few rows."""
    t = np.linspace(0, 1, 11)
    y = np.where(t < 0.5, 0.0, 1.0)
    for impacts in ([0.42, 0.47], t[:-1] + 0.03, [], [-1.0, 2.0]):
        assert np.array_equal(stepped(t, y, np.array(impacts))[1], y)
    assert stepped(t[:2], y[:2], np.array([0.05]))[1].tolist() == y[:2].tolist()


@pytest.mark.parametrize("seed", range(10))
def test_points_stay_in_order_and_near_the_rows(seed):
    """Arbitrary values and impacts: times do not fall, values within a quarter of each change, all finite."""
    random = np.random.default_rng(seed)
    t = np.cumsum(random.uniform(0.01, 1, 50))
    y, impacts = random.normal(size=50), random.uniform(t[0] - 1, t[-1] + 1, 20)
    times, values = stepped(t, y, impacts)
    assert (np.diff(times) >= 0).all() and np.isfinite(values).all() and np.isin(t, times).all()
    reach = 0.25 * np.abs(np.diff(y)).max()
    assert values.max() <= y.max() + reach and values.min() >= y.min() - reach
