"""decks/domino: report 4.4, VALIDATION C."""

import numpy as np
import pytest

from flowgmo.building import build_model
from flowgmo.deck import read_deck

pytestmark = pytest.mark.slow  # minutes in all; the tests of tests/physics, hard and identity run every day


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


def test_elastic(runs):
    # Bound of VALIDATION C for contacts of equal stiffness; one push scatters, see decks/domino/pushes.py.
    runs.agree("domino", "elastic", 3.0)


@pytest.mark.parametrize("deck", ["plastic", "elastic"])
def test_energy_never_rises(deck, runs):
    curves = runs.curves("domino", deck)
    total = curves.energy["kinetic"] + curves.energy["potential"]
    assert np.diff(total).max() <= 1e-10 * np.ptp(total)
