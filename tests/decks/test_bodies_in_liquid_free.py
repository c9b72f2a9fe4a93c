"""Decks of bodies that the liquid moves, against closed forms and other programs."""

import json

import h5py
import numpy as np
import pytest

DENSITIES = (0.001, 0.1, 0.5, 0.9, 2.0, 7.8)  # over that of the liquid


def varied(runs, case, deck, name, *changes):
    """Results folder of a copy of the deck with pieces of its text exchanged: pairs (old, new)."""
    text = (runs.measure.DECKS / case / f"{deck}.nml").read_text()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path = runs.folder / f"{case}_{deck}_{name}.nml"
    path.write_text(text)
    return runs.compute(path, path.with_suffix(".out"))


def coarse(case):
    """Changes that halve the cells each way."""
    return {
        "released_sphere": [("=120", "=60")],
        "floating_prism": [("nxcelt=160", "nxcelt=80"), ("nzcelt=70", "nzcelt=35")],
    }[case]


@pytest.mark.parametrize("r", [0.001, 0.9, 7.8])
def test_released_sphere(runs, r):
    # Ten cells across, measured: +.35, -.07, -.03 %. VALIDATION E wants 3 %, 6 % at r .9, with 20. A load from the last
    # step, or an added mass of its own, would make the light ones swing to and fro from step to step.
    changes = [*coarse("released_sphere"), ("rhomvb(1)=500.", f"rhomvb(1)={1000.0 * r}")]
    found = runs.measure.measure(
        varied(runs, "released_sphere", "sphere", f"{r}", *changes), "released_sphere", "sphere"
    )
    assert found["acceleration over g"] == pytest.approx((1.0 - r) / (r + 0.5), rel=0.01)
    assert found["least of a step over mean"] >= 0.98
    assert found["largest of a step over mean"] <= 1.02
    assert found["speed sideways over speed"] <= 5e-3


@pytest.mark.slow
@pytest.mark.parametrize("r", DENSITIES)
def test_released_sphere_at_full_size(runs, r):
    # Measured: -.41, -.35, -.21, -.16, -.09, -.03 %, the walls' share among it.
    changes = [("rhomvb(1)=500.", f"rhomvb(1)={1000.0 * r}")]
    found = runs.measure.measure(
        varied(runs, "released_sphere", "sphere", f"full_{r}", *changes), "released_sphere", "sphere"
    )
    assert found["acceleration over g"] == pytest.approx((1.0 - r) / (r + 0.5), rel=0.01)


@pytest.mark.slow
@pytest.mark.parametrize("r", DENSITIES)
def test_acceleration_never_alternates(runs, r):
    # VALIDATION E, 50 steps. The way grows to a fifth of a cell a step.
    changes = [*coarse("released_sphere"), ("rhomvb(1)=500.", f"rhomvb(1)={1000.0 * r}"), ("itwfin=14", "itwfin=52")]
    with h5py.File(varied(runs, "released_sphere", "sphere", f"long_{r}", *changes) / "history.h5") as file:
        v = file["bodies/ball/velocity"][:, 2]
    assert len(v) >= 50
    assert np.all(np.diff(v) * (1.0 - r) > 0.0)


def looks_like_the_reference(runs, found, share=0.08):
    """VALIDATION E: 8 % of each extreme and .01 m."""
    there = runs.measure.reference("heave", "heave")
    for k in range(1, 5):
        value = there[f"extreme {k}"][0]
        assert abs(found[f"extreme {k}"] - value) <= share * abs(value) + 0.01
    assert found["period"] == pytest.approx(there["period"][0], rel=0.03)
    assert abs(found["rest level"]) <= 0.05
    assert found["volume error"] <= 1e-10


def test_heave(runs):
    # Measured: off by .007, .002, .004, .013 m, period -.1 %. A load that is late by a step would make
    # the swing grow; an earlier state swung out too soon (-.31 for the third extreme).
    looks_like_the_reference(runs, runs.measure.measure(runs.results("heave", "heave"), "heave", "heave"))


def test_heave_on_long_steps(runs):
    # Ten steps a swing: measured off by .001, .03, .044 to .052, .031 m, period -2.7 %.
    changes = [("con=0.25, confs=0.5", "con=0.45, confs=1.0")]
    found = runs.measure.measure(varied(runs, "heave", "heave", "long", *changes), "heave", "heave")
    looks_like_the_reference(runs, found, share=0.1)


@pytest.mark.slow
def test_heave_on_a_finer_mesh(runs):
    # Measured: off by .015, .005, .011, .014 m, period +.2 %.
    changes = [
        ("con=0.25, confs=0.5", "con=0.15, confs=0.3"),
        ("nxcell=10,14, sizex=.8,.8,8.", "nxcell=16,20, sizex=.5,.5,7."),
        ("nycell=10,14, sizey=.8,.8,8.", "nycell=16,20, sizey=.5,.5,7."),
        ("nzcell=8,17,6, sizez=2.5,.8,.8,2.", "nzcell=10,28,8, sizez=2.5,.5,.5,2."),
    ]
    found = runs.measure.measure(varied(runs, "heave", "heave", "fine", *changes), "heave", "heave")
    looks_like_the_reference(runs, found)


@pytest.mark.parametrize(("deck", "angle"), [("quarter", 26.565), ("half", 45.0)])
def test_floating_prism(runs, deck, angle):
    # Ten cells across, measured: 26.78 and 45.02. VALIDATION E: 2 degrees. A moment of buoyancy that depends on the
    # place in the mesh would hold it where it started.
    found = runs.measure.measure(
        varied(runs, "floating_prism", deck, "coarse", *coarse("floating_prism")), "floating_prism", deck
    )
    assert abs(found["angle"] - angle) <= 2.0
    assert found["volume error"] <= 1e-10


@pytest.mark.slow
@pytest.mark.parametrize(("deck", "angle"), [("quarter", 26.565), ("half", 45.0)])
def test_floating_prism_at_full_size(runs, deck, angle):
    # Measured: 26.53 and 44.98; 26.4 and 45.1 where what is displaced had its moment at the centres of cells.
    found = runs.measure.measure(runs.results("floating_prism", deck), "floating_prism", deck)
    assert abs(found["angle"] - angle) <= 2.0
    assert found["volume error"] <= 1e-10


def test_plate_shares_its_momentum_with_the_water(runs):
    # Measured: .372, +8 %, and +21 % on half as many cells each way: first order at the edges. A blow that the water
    # takes in more than the steps of its contact, or not at all, would leave another speed.
    found = runs.measure.measure(runs.results("water_entry", "plate"), "water_entry", "plate")
    assert found["speed after over before"] == pytest.approx(0.3455, rel=0.1)
    assert found["volume error"] <= 1e-10


def test_cylinder_meets_water_as_measured(runs):
    # Measured, 20 cells in a radius: mean of Cs over h/R .1 to .5 1.587, +2.5 % (40 cells: 1.623; 10: 1.744); over the
    # first tenth 4.25, +17 %, where the law of the experiments starts at 5.15 and Wagner's at 6.28; left over .7 %. A
    # blow that comes late or in one step would show in either, a mean of loads that misses steps in both.
    found = runs.measure.measure(runs.results("water_entry", "cylinder"), "water_entry", "cylinder")
    there = runs.measure.reference("water_entry", "cylinder")
    wagner = 6.2832  # 2 pi, at h = 0 where it is largest
    assert found["Cs, h/R 0.1 to 0.5"] == pytest.approx(there["Cs, h/R 0.1 to 0.5"][0], rel=0.06)
    results = runs.results("water_entry", "cylinder")
    spikes = json.loads((results / "run.json").read_text())["forces"]["cylinder"]
    with h5py.File(results / "history.h5") as file:
        rows = np.linalg.norm(file["bodies/cylinder/force"], axis=1)
    assert spikes["median"] < spikes["quantile_99"] <= spikes["largest"]
    assert rows.max() == pytest.approx(spikes["largest"], rel=1e-12)  # in a step that has a row
    assert there["Cs, h/R 0.0 to 0.1"][0] <= found["Cs, h/R 0.0 to 0.1"] <= min(wagner, 1.25 * 3.634)
    assert found["momentum left over"] <= 0.02
    assert found["volume error"] <= 1e-10


def test_sphere_meets_water(runs):
    # Measured, 10 cells in a radius: .975, +9 % (20 cells: .895, -.1 %).
    found = runs.measure.measure(runs.results("water_entry", "sphere"), "water_entry", "sphere")
    first = runs.measure.reference("water_entry", "sphere")["Cs, h/R 0.0 to 0.1"][0]
    assert found["Cs, h/R 0.0 to 0.1"] == pytest.approx(first, rel=0.13)
    assert found["momentum left over"] <= 0.02
    assert found["volume error"] <= 1e-10


@pytest.mark.slow
def test_sphere_meets_water_on_a_finer_mesh(runs):
    # Measured: .895, -.1 %.
    halves = [(f"={n},12, size{a}=.01,.01", f"={2 * n},16, size{a}=.005,.005") for n, a in ((20, "x"), (20, "y"))]
    halves += [("=12,15,10, sizez=.08,.01,.01,.03", "=18,30,16, sizez=.08,.005,.005,.02")]
    found = runs.measure.measure(varied(runs, "water_entry", "sphere", "fine", *halves), "water_entry", "sphere")
    first = runs.measure.reference("water_entry", "sphere")["Cs, h/R 0.0 to 0.1"][0]
    assert found["Cs, h/R 0.0 to 0.1"] == pytest.approx(first, rel=0.05)


def test_cylinder_held_under_water_is_lifted_by_its_buoyancy(runs):
    # Measured: 1.002 over one swing of the tank (1 s), 1.04 over one that starts .4 s later. A share of the blow that
    # stays in the pressure would lift it for good.
    found = runs.measure.measure(runs.results("water_entry", "held"), "water_entry", "held")
    assert found["lift over buoyancy"] == pytest.approx(1.0, abs=0.06)
    assert found["volume error"] <= 1e-10
