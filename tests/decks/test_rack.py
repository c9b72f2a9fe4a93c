"""decks/rack: the break of 15 touching balls, VALIDATION C."""

import numpy as np
import pytest

from flowgmo.building import build_model
from flowgmo.deck import read_deck

ROWS = [[f"ball{k}" for k in row] for row in ([1], [2, 3], [4, 5, 6], [7, 8, 9, 10], [11, 12, 13, 14, 15])]


def touching(path):
    """Distances over diameters of all pairs of object balls closer than 1.1 diameters, from the deck."""
    bodies = [b for b in build_model(read_deck(path)).bodies if b.name.startswith("ball")]
    centres = np.array([b.shape.as_sphere()[0] for b in bodies])
    radii = np.array([b.shape.as_sphere()[1] for b in bodies])
    i, j = np.triu_indices(len(bodies), 1)
    ratio = np.linalg.norm(centres[i] - centres[j], axis=1) / (radii[i] + radii[j])
    return ratio[ratio < 1.1]


@pytest.mark.parametrize("deck", ["rack/rack", "pool/smooth", "pool/break"])
def test_rack_touches_exactly(deck, runs):
    # Measured: 30 contacts, 2e-15 of a diameter. A gap of more than `touch` (1e-9 radii) would make another break.
    ratio = touching(runs.measure.DECKS / f"{deck}.nml")
    assert len(ratio) == 30
    assert np.abs(ratio - 1.0).max() <= 1e-12


def test_break(runs):
    # The reference is a computation of its own (rack/reference.csv). 1e-3 m/s would reveal contacts resolved one after
    # the other, or another contact law (linear: tenths of a metre per second).
    runs.agree("rack", "rack", 1e-3)


def test_energy_and_momentum(runs):
    # 1e-9 of the energy, 1e-10 of the momentum: the cue alone has both at the start
    curves = runs.curves("rack", "rack")
    kinetic = curves.energy["kinetic"]
    assert np.abs(kinetic / kinetic[0] - 1.0).max() <= 1e-9
    total = sum(curves.mass[b] * curves.at(b, "velocity") for b in curves.bodies)
    assert np.abs(total - [curves.mass["cue"] * 10.0, 0.0, 0.0]).max() <= 1e-10 * curves.mass["cue"] * 10.0


def test_mirror_symmetry(runs):
    # 1e-10 of the cue's speed. Would reveal an answer that depends on the order of the contacts.
    curves = runs.curves("rack", "rack")
    for row in ROWS:
        for one, two in zip(row, reversed(row), strict=True):
            left, right = curves.at(one, "velocity"), curves.at(two, "velocity")
            assert np.abs(left - right * [1.0, -1.0, 1.0]).max() <= 1e-9
