"""The book of momentum where bodies move in liquid."""

import numpy as np
import pytest
from flowgmo_wet_bodies import begin, play, tank

from flowgmo.momentum_book import GIVERS
from flowgmo.step import liquid_values

STEPS = 30


def book_of(**scene):
    """name -> (3,) after STEPS, and the largest of any of them but gravity's and what holds it."""
    world, state = play(tank(**scene), STEPS)
    book = {k.partition("/")[2]: v for k, v in liquid_values(world, state).items() if k.startswith("momentum/")}
    return book, state


@pytest.fixture(scope="module")
def both():
    return book_of()


def test_it_adds_up(both):
    book, state = both
    assert set(book) == {"total", "gravity", "walls", "prescribed", "contacts", "remainder"}
    given = sum(book[name] for name in GIVERS if name in book)
    missed = book["total"] - state.fluid.momenta[0] - given - book["remainder"]
    assert np.abs(missed).max() <= 1e-12 * np.abs(book["gravity"]).max()


def test_little_is_missing(both):
    """A ball driven from rest at once and a box let go. Measured .063 of the walls' along x, 6e-6 of gravity's."""
    book, _ = both
    assert np.abs(book["remainder"][:2]).max() < 0.12 * np.abs(book["walls"][:2]).max()
    assert abs(book["remainder"][2]) < 1e-3 * abs(book["gravity"][2])
    assert np.abs(book["contacts"]).max() < 1e-12 * abs(book["gravity"][2])  # nothing touches the box


def test_of_the_mirrored_scene_it_is_mirrored(both):
    book, _ = both
    there, _ = book_of(mirrored=True)
    for name, value in book.items():
        assert there[name] * [-1, 1, 1] == pytest.approx(value, rel=1e-3, abs=2e-3 * np.abs(book["total"]).max()), name


def test_absent_without_bodies_that_move_or_with_one_after_the_other():
    assert begin(tank(bodies="box", xput="impmob=0,"))[0].momentum is None


def test_scaled_by_powers_of_two_gives_the_same_bits():
    here, _ = book_of()
    there, _ = book_of(size=4.0, time=2.0, mass=8.0)
    for name, value in here.items():
        assert np.array_equal(there[name], value * 8.0 * 4.0 / 2.0), name
