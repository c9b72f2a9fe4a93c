"""decks/domino: report 4.4, VALIDATION C."""

import importlib.util

import numpy as np
import pytest

from flowgmo.building import build_model
from flowgmo.deck import read_deck

pytestmark = pytest.mark.slow  # minutes in all; the tests of tests/physics, hard and identity run every day


def _pushes_module(decks):
    spec = importlib.util.spec_from_file_location("domino_pushes", decks / "domino" / "pushes.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("deck", ["plastic", "elastic"])
def test_geometry(deck, runs):
    # 32 blocks, gaps of 2.191 cm, the first turning about its front lower edge, which stands still
    model = build_model(read_deck(runs.measure.DECKS / "domino" / f"{deck}.nml"))
    bounds = np.array([body.shape.bounds() for body in model.bodies])
    assert len(bounds) == 32
    assert np.abs(bounds[1:, 0, 0] - bounds[:-1, 1, 0] - 2.191).max() <= 1e-12
    assert np.abs(np.ptp(bounds, axis=1) - [0.758, 2.19, 4.178]).max() <= 1e-12
    first = runs.curves("domino", deck).bodies["block1"]
    arm = np.array([0.758, 0.0, 0.0]) - first["position"][0]
    edge = first["velocity"][0] + np.cross(first["angular_velocity"][0], arm)
    assert np.abs(edge).max() <= 1e-12


def test_plastic(runs):
    # Bounds of VALIDATION C. 0.5 cm/s would reveal impacts of the train resolved one after the other; 0.3 % of a hit's
    # time a push or a first block that slides differently.
    hits = {f"hit of block {k}": 0.003 * t for k, t in zip(range(1, 5), (0.0553, 0.1206, 0.1706, 0.2141), strict=True)}
    runs.agree("domino", "plastic", hits | {"front speed": 0.5})


BETWEEN = "87.4 (deviation 2.6): the floor answers between two hits of the same pair, within one instant"


@pytest.mark.parametrize(
    "multiple",
    ["simultaneous", pytest.param("sequential", marks=pytest.mark.xfail(reason=BETWEEN, strict=True))],
)
def test_elastic(multiple, runs):
    # VALIDATION C: 82.5 +- 3 cm/s where contacts of an instant are equally stiff or follow one another, as the mean of
    # at least six pushes: one push scatters by 3. Measured: simultaneous 85.2 (82.3). More than 3 would reveal a floor
    # that answers within the impact of two blocks (91.5), or a push that is not forgotten.
    pushes = _pushes_module(runs.measure.DECKS)
    assert len(pushes.SPINS) >= 6
    speeds = []
    for spin in pushes.SPINS:
        path = runs.folder / f"elastic_{multiple}_{spin:g}.nml"
        path.write_text(pushes.pushed("elastic", spin, multiple), encoding="utf-8")
        results = runs.compute(path, path.with_suffix(".out"))
        speeds.append(runs.measure.measure(results, "domino", "elastic")["front speed"])
    assert abs(np.mean(speeds) - 82.5) <= 3.0, speeds


@pytest.mark.parametrize("deck", ["plastic", "elastic"])
def test_energy_never_rises(deck, runs):
    curves = runs.curves("domino", deck)
    total = curves.energy["kinetic"] + curves.energy["potential"]
    assert np.diff(total).max() <= 1e-10 * np.ptp(total)
