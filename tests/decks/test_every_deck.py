"""Every deck of decks/: checks without a notice, runs two steps, has its page and its reference numbers, and what it
writes is complete and agrees with itself."""

import json
import re
from pathlib import Path

import h5py
import numpy as np
import pytest

from flowgmo.building import build_model
from flowgmo.deck import read_deck

DECKS = Path(__file__).parents[2] / "decks"
ALL = sorted(path for path in DECKS.glob("*/*.nml") if not path.name.startswith("wet_"))
#: Bodies in liquid, run to their ends and measured by tests/hard/test_wet_bodies.py; no reference numbers.
WET = sorted((DECKS / "hard").glob("wet_*.nml"))
DIVERGES = "wet_explicit"  # what it is for: tests/hard/test_wet_explicit.py
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
MEANT = {"gate", "heave", "settling", "bounce_in_oil", "stones", "logs", "water_entry"}
OWN = ("reaches outside the domain", "thinner than two cells", "pierces the side")  # of these scenes
SHORT = 0.1  # of the decks' time units, at most: the wet ones' first splash
REPORTED = ("wet_gate", "wet_bubbles")  # a driven body and a coupled one, a crowd; the others in `make test-all`
each = pytest.mark.parametrize("path", ALL, ids=lambda path: f"{path.parent.name}/{path.stem}")
whole = pytest.mark.parametrize(
    "path",
    [pytest.param(p, marks=pytest.mark.slow if p.parent.name in LONG else ()) for p in ALL],
    ids=lambda path: f"{path.parent.name}/{path.stem}",
)


def test_there_are_decks():
    assert len({path.parent for path in ALL}) >= 8


@pytest.mark.parametrize("path", [*ALL, *WET], ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_checks_clean(path):
    # a notice in a deck that users copy is a notice in all of theirs
    # some are the scene's own: a quarter of it is computed, a gate is a gate, hard scenes are coarse
    coarse = "thinner than two cells", "of the mass of as much liquid"
    meant = OWN if path.parent.name in MEANT else coarse if path in WET else ()
    meant += ("impmob=0",) if path.stem == DIVERGES else ()
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


@pytest.mark.parametrize("path", WET, ids=lambda path: path.stem)
def test_wet_has_its_line_on_the_page(path):
    assert f"`{path.name}`" in (path.parent / "README.md").read_text(encoding="utf-8")


@whole
def test_energy_books_close(path, runs):
    # Measured: at most 2e-12 of the largest entry (hard/corner). 1e-11 would reveal an entry that is missing, counted
    # twice, or lost from one step to the next, as the energy of shifts was (7e-3 of incline/rocking at delt .002).
    case, deck = path.parent.name, path.stem
    energy = runs.curves(case, deck).energy
    if case in runs.measure.WET:  # among liquid the remainder is what the method loses
        agrees_with_itself(runs.results(case, deck))
        return
    if not energy:
        assert case == "piston"  # no coupled body, no books of energy
        return
    largest = max(np.abs(values).max() for values in energy.values())
    assert np.abs(energy["remainder"]).max() <= 1e-11 * largest


@pytest.fixture(scope="session")
def short(runs):
    """The results folder of a wet deck that runs for a tenth of a second at most, computed at the first use."""
    done = {}

    def compute(path):
        if path not in done:
            text = path.read_text()
            end = min(SHORT, float(re.search(r"twfin=([.0-9]+)", text)[1]))
            (runs.folder / path.name).write_text(re.sub(r"(twfin|tpltd\(1\))=[.0-9]+", rf"\1={end}", text))
            done[path] = runs.compute(runs.folder / path.name, runs.folder / f"{path.stem}_short.out")
        return done[path]

    return compute


@pytest.mark.parametrize("path", [p for p in WET if p.stem != DIVERGES], ids=lambda path: path.stem)
def test_what_a_wet_deck_writes_agrees_with_itself(path, short, tmp_path):
    from postproc.slices import draw_slice

    folder = short(path)
    agrees_with_itself(folder)
    assert draw_slice(folder, tmp_path / "slice.png", None, None, None).stat().st_size > 10_000


@pytest.mark.parametrize(
    "path",
    [pytest.param(p, marks=() if p.stem in REPORTED else pytest.mark.slow) for p in WET if p.stem != DIVERGES],
    ids=lambda path: path.stem,
)
def test_a_wet_deck_is_reported(path, short, tmp_path):
    from postproc.report import report
    from postproc.results import Results

    told = []
    assert report(Results(short(path)), tmp_path / "report.png", told.append).stat().st_size > 50_000
    assert all("curves of 4 of" in text for text in told), told


def agrees_with_itself(folder):
    """What holds for the results of any run with liquid: files, books of volume and energy, parts of the forces."""
    assert json.loads((folder / "run.json").read_text())["status"] == "done"
    for name in ("deck.resolved.nml", "run.log", "restart.h5", "fields.h5", "vtk/case.pvd"):
        assert (folder / name).stat().st_size > 0
    for name in re.findall(r'file="([^"]+)"', (folder / "vtk/case.pvd").read_text()):
        assert (folder / "vtk" / name).stat().st_size > 0
    with h5py.File(folder / "history.h5") as file:
        rows = {name: data[:] for name, data in _curves(file).items()}
        kinds = {name: group.attrs["kind"] for name, group in file["bodies"].items() if "kind" in group.attrs}
    n = len(rows["time"])
    assert n >= 2 and all(len(y) == n for y in rows.values())
    assert all(np.isfinite(y).all() for y in rows.values())
    # Volume: measured 1e-15 of it.
    volume = rows["fluid/volume"]
    came = sum(y for name, y in rows.items() if name.startswith("boundaries/"))
    if "fluid/volume_error" in rows:
        assert np.abs(volume - volume[0] - came).max() <= 1e-10 * max(volume.max(), np.abs(came).max(initial=0.0))
        assert np.abs(rows["fluid/volume_error"]).max() <= 1e-10
    energy = {name.split("/")[1]: y for name, y in rows.items() if name.startswith("energy/")}
    if energy:
        # Measured 5e-16 of the largest entry: the remainder is what the others leave, and all of them are in the file.
        kept = sum(energy.get(name, 0.0) for name in ("kinetic", "potential", "dissipated", "impacts"))
        given = sum(energy.get(name, 0.0) for name in ("work_prescribed", "work_loads", "work_boundaries"))
        books = kept - given - (kept - given)[0] - energy["remainder"]
        assert np.abs(books).max() <= 1e-12 * max(np.abs(y).max() for y in energy.values())
        # Rows between steps are linear, of velocities and of energies; the first and the last one are states.
        parts = [rows[f"bodies/{name}/kinetic_energy"] for name, kind in kinds.items() if kind == "coupled"]
        kinetic = (rows["fluid/kinetic_energy"] + sum(parts))[[0, -1]]
        assert np.abs(kinetic - energy["kinetic"][[0, -1]]).max() <= 1e-12 * np.abs(energy["kinetic"]).max(initial=0.0)
    for name, whole_force in rows.items():
        if name.endswith("/force"):  # measured 0
            parts = sum(y for part, y in rows.items() if part.startswith(f"{name}_"))
            assert np.abs(whole_force - parts).max() <= 1e-12 * np.abs(whole_force).max()


def _curves(file):
    """Name -> dataset of all that has a value in each row."""
    found = {}
    file.visititems(lambda name, item: found.update({name: item}) if isinstance(item, h5py.Dataset) else None)
    fixed = re.compile("deck|collisions/.*|probes/[0-9]+/x")  # a probe's x is where it is
    return {name: data for name, data in found.items() if not fixed.fullmatch(name)}
