"""decks/stack: tower, pyramid, wall and card house stand for a minute."""

import pytest

pytestmark = pytest.mark.slow  # minutes in all; the tests of tests/physics, hard and identity run every day


@pytest.mark.parametrize("deck", ["tower", "pyramid", "wall", "cards"])
def test_stands(deck, runs):
    # Bound of VALIDATION C: 1e-4 of a box in 60 s. Energy in weights of a box times its height: 1e-9 would reveal
    # corrections of positions that become motion.
    runs.agree("stack", deck, {"drift": 1e-4, "energy added": 1e-9})


@pytest.mark.parametrize("deck", ["tower", "pyramid", "wall", "cards"])
def test_floor_carries_all(deck, runs):
    # 1e-6 of the weight: sum of the contact forces on the pieces, those of sleepers as they were found last, is what
    # gravity takes
    curves = runs.curves("stack", deck)
    total = sum(body["contact_force"][-1] for body in curves.bodies.values())
    weight = -curves.gravity * sum(curves.mass.values())
    assert abs(total - weight).max() <= 1e-6 * weight[2]
