"""Which contacts are struck, when a bounce series is closed, and what the books get (strike.py)."""

import numpy as np
import pytest
from arenas import G, arena_of
from flowgmo_scenes import ball, deck, driven

from flowgmo.collision.contact import CONTACT
from flowgmo.collision.gather import approaches
from flowgmo.collision.laws import choose_law
from flowgmo.collision.strike import Striker
from flowgmo.records import REST, SLIP
from flowgmo.state import FROM_PRESCRIBED, LOST_IN_IMPACTS

FLOOR = (3, 3, 3, 3, 2, 3)
ZMIN = 4  # place of this side after the bodies
E, SPEED = 0.5, 2.0
SERIES = 2 * E * SPEED / (G * (1 - E))  # the time after the first impact in which all bounces are over


def struck(span, plastic=False, e=E):
    """A ball hits the floor at SPEED, `span` before the end: outcome, its speed upwards, the books, its mass."""
    arena = arena_of(deck(ball((0, 0, 0.1), v=(0, 0, -SPEED)), lo=(-1, -1, 0), hi=(1, 1, 2), sides=FLOOR,
                          g=(0, 0, -G), e=e))  # fmt: skip
    contact = np.zeros(1, CONTACT)
    contact["a"], contact["b"], contact["normal"], contact["fresh"], contact["e"] = 0, 1 + ZMIN, (0, 0, 1), 1, e
    books = np.zeros(4)
    outcome = Striker(arena, choose_law(arena.model.contacts)).strike(contact, 0.5, span, plastic, books)
    return outcome, arena.motion["v"][0, 2], books, arena.bodies["mass"][0]


@pytest.mark.parametrize("part", [0.5, 1 - 1e-9, 1 + 1e-9, 3.0])
def test_a_series_that_ends_within_the_span_is_closed(part):
    """2 e v/(g (1 - e)) is the time of all bounces: if shorter than the span, the ball is at rest at once.

    The record keeps the deck's e and says `rest`; the books lose all of ½ m v², or (1 - e²) of it.
    """
    outcome, up, books, mass = struck(SERIES / part)
    closed = part < 1
    (record,) = outcome.records[0]
    assert up == pytest.approx(0.0 if closed else E * SPEED, abs=1e-14)
    assert record["regime"] == (REST if closed else SLIP) and record["e"] == E and record["time"] == 0.5
    assert (record["a"], record["b"]) == (1, -5)
    lost = 0.5 * mass * SPEED**2 * (1.0 if closed else 1 - E**2)
    assert books[LOST_IN_IMPACTS] == pytest.approx(lost, rel=1e-13) == record["energy_loss"]
    assert outcome.struck.all() and outcome.speed[0] == pytest.approx(up, abs=1e-14)


@pytest.mark.parametrize(("e", "after"), [(0.0, 0.0), (E, 0.0), (1.0, SPEED)])
def test_stalled_impacts_are_plastic_but_for_elastic_ones(e, after):
    """Impacts in no time end without rebound; e = 1 keeps its energy whatever happens, and no span closes it."""
    assert struck(1e-9, plastic=True, e=e)[1] == pytest.approx(after, abs=1e-14)
    if e == 1.0:
        assert struck(1e9, e=e)[1] == pytest.approx(SPEED, abs=1e-14)


def test_what_does_not_approach_is_no_impact():
    """At rest, parting, or there before: nothing is struck, velocities keep their bits."""
    arena = arena_of(deck(ball((0, 0, 0.1)), lo=(-1, -1, 0), hi=(1, 1, 2), sides=FLOOR, g=(0, 0, -G), e=E))
    striker, contact, books = Striker(arena, choose_law(arena.model.contacts)), np.zeros(1, CONTACT), np.zeros(4)
    contact["a"], contact["b"], contact["normal"], contact["fresh"], contact["e"] = 0, 1 + ZMIN, (0, 0, 1), 1, E
    for speed, fresh in ((0.0, 1), (1.0, 1), (-1e-13, 1), (-1.0, 0)):
        arena.motion["v"][0], contact["fresh"] = (0.3, 0, speed), fresh
        outcome = striker.strike(contact.copy(), 0.0, 1.0, False, books)
        assert not outcome.records and not outcome.struck.any()
        np.testing.assert_array_equal(arena.motion["v"][0], [0.3, 0, speed])
        assert outcome.speed[0] == speed
    assert not books.any()


def test_a_driver_gives_the_work_of_an_impact():
    """A plate driven at V hits a ball at rest, e = 1: the ball leaves with 2 V; its energy 2 m V² came from the driver,
    whose force did the work J V = 2 m V²."""
    arena = arena_of(deck(ball((0, 0, 0)), driven((-0.2, 0, 0), v=(1.5, 0, 0)), e=1.0))
    contact, books = np.zeros(1, CONTACT), np.zeros(4)
    contact["a"], contact["b"], contact["point"], contact["normal"] = 0, 1, (-0.1, 0, 0), (1, 0, 0)
    contact["fresh"], contact["e"] = 1, 1.0
    Striker(arena, choose_law(arena.model.contacts)).strike(contact, 0.0, 1.0, False, books)
    assert arena.motion["v"][0, 0] == pytest.approx(3.0, rel=1e-14)
    assert books[FROM_PRESCRIBED] == pytest.approx(2 * arena.bodies["mass"][0] * 1.5**2, rel=1e-13)
    speed = np.empty(1)
    approaches(contact, arena.responses, arena.twists, speed)
    assert speed[0] == pytest.approx(1.5, rel=1e-14)
