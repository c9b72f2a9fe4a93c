"""Every deck of decks/: checks without a notice, runs two steps, and has its page and its reference numbers."""

from pathlib import Path

import numpy as np
import pytest

from flowgmo.building import build_model
from flowgmo.deck import read_deck

DECKS = Path(__file__).parents[2] / "decks"
#: hard/wet_*: bodies in liquid, run and measured by tests/hard/test_wet_bodies.py
ALL = sorted(path for path in DECKS.glob("*/*.nml") if not path.name.startswith("wet_"))
LONG = {
    "pool",
    "domino",
    "stack",
    "hard",
    "dam_break",
    "cavity",
    "cylinder",
    "martin_moyce",
    "wall_impact",
    "settling",
    "released_sphere",
    "heave",
    "floating_prism",
    "wavemaker",
    "bounce_in_oil",
    "hulme",
    "valve",
    "stones",
    "logs",
}  # whole runs of these take minutes: `make test-all`
MEANT = {"gate", "heave", "settling", "bounce_in_oil", "stones", "logs"}
each = pytest.mark.parametrize("path", ALL, ids=lambda path: f"{path.parent.name}/{path.stem}")
whole = pytest.mark.parametrize(
    "path",
    [pytest.param(p, marks=pytest.mark.slow if p.parent.name in LONG else ()) for p in ALL],
    ids=lambda path: f"{path.parent.name}/{path.stem}",
)


def test_there_are_decks():
    assert len({path.parent for path in ALL}) >= 8


@each
def test_checks_clean(path):
    # a notice in a deck that users copy is a notice in all of theirs
    # two are the scene's own: a quarter of it is computed, and a gate is a gate
    meant = (
        ("reaches outside the domain", "thinner than two cells", "pierces the side")
        if path.parent.name in MEANT
        else ()
    )
    notices = build_model(read_deck(path)).notices
    assert [notice for notice in notices if not any(text in notice for text in meant)] == []


@each
def test_runs_two_steps(path):
    from flowgmo.step import initial_state, prepare, start_liquid, step

    model = build_model(read_deck(path))
    world, state = prepare(model), initial_state(model)
    start_liquid(world, state)
    for _ in range(2):
        step(world, state, state.t + model.clock.dt, np.zeros(0), landing=False)
    assert state.step == 2
    assert state.t == 2 * model.clock.dt
    assert np.isfinite(state.p_WB).all()
    assert np.isfinite(state.v_WB).all()


@whole
def test_has_page_and_reference(path, runs):
    page = (path.parent / "README.md").read_text(encoding="utf-8")
    assert path.name in page
    numbers = runs.measure.reference(path.parent.name, path.stem)
    assert numbers
    assert all(np.isfinite(value) for value, _ in numbers.values())
    assert (path.parent / "reference.csv").read_text(encoding="utf-8").startswith("#"), "the source stands on top"


@pytest.mark.parametrize("page", sorted(DECKS.glob("*/README.md")), ids=lambda page: page.parent.name)
def test_pictures_are_small_and_there(page):
    for picture in page.parent.glob("*.png"):
        assert picture.stat().st_size < 150_000
        assert picture.name in page.read_text(encoding="utf-8")


@whole
def test_energy_books_close(path, runs):
    # Measured: at most 2e-12 of the largest entry (hard/corner). 1e-11 would reveal an entry that is missing, counted
    # twice, or lost from one step to the next, as the energy of shifts was (7e-3 of incline/rocking at delt .002).
    case, deck = path.parent.name, path.stem
    energy = runs.curves(case, deck).energy
    if not energy:
        assert case == "piston" or case in runs.measure.WET  # no coupled body, no books of energy
    if not energy or case in runs.measure.WET:  # among liquid the remainder is what the method loses
        return
    largest = max(np.abs(values).max() for values in energy.values())
    assert np.abs(energy["remainder"]).max() <= 1e-11 * largest
