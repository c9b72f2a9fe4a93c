"""decks/incline: blocks that hold, slide and tip; Housner's rocking block. VALIDATION A."""

import numpy as np


def test_block(runs):
    # Distances 1e-6 m (VALIDATION 1e-3): tells `holds` from `just`, whose friction is 0.1 % above and below tan 20.
    # The block that tips turns about its edge: 1e-3 degrees.
    bounds = {f"way of {b}": 1e-6 for b in ("holds", "just", "slides", "squat")}
    runs.agree("incline", "block", bounds | {"turn of tips": 1e-3})


def test_only_one_block_turns(runs):
    # 1e-6 degrees: friction acts at the base, so a sliding block is pressed unevenly, but it must not lift
    curves = runs.curves("incline", "block")
    for block in ("holds", "just", "slides", "squat"):
        turn = np.linalg.norm(curves.bodies[block]["orientation"][:, 1:], axis=1)
        assert np.degrees(2.0 * np.arcsin(turn)).max() <= 1e-6


def test_rocking(runs):
    # 1e-3 of the speed is VALIDATION A; times 1e-4 s. Would reveal an edge that takes part in the landing of the other.
    runs.agree("incline", "rocking", {"first landing": 1e-6, "fifth landing": 1e-4, "speed after over before": 1e-4})
