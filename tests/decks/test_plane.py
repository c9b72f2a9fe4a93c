"""decks/plane: one rough impact of a ball, and balls on a slope."""

import numpy as np


def test_impact(runs):
    # Measured: 4e-15 m/s. 1e-10 would reveal friction integrated in steps of the impulse.
    runs.agree("plane", "impact", 1e-10)


def test_impact_regimes(runs):
    # |vt|/|vn| = 1 > 0.525, 2 > 1.26, 1 < 1.26 = 7/2 mu (1 + e)
    curves = runs.curves("plane", "impact")
    found = {int(a): curves.regimes[k] for a, k in zip(curves.impacts["a"], curves.impacts["regime"], strict=True)}
    assert found == {1: "slip", 2: "slip", 3: "stick"}


def test_incline(runs):
    # Measured: 4e-15 m, 2e-15 m/s. The validation bound of 1e-3 m is wider than what parts `above` from `below`
    # (0.7 mm, their friction is 0.1 % above and below 2/7 tan 30): 1e-8 tells which of them rolls.
    runs.agree("plane", "incline", 1e-8)


def test_force_of_the_slope(runs):
    # Measured: 6e-14 N of 103 N. Rolling takes 2/7 m g sin 30 along the slope, sliding mu m g cos 30.
    curves = runs.curves("plane", "incline")
    for ball, share in (("rough", 2 / 7 * np.sin(np.pi / 6)), ("smooth", 0.1 * np.cos(np.pi / 6))):
        weight = curves.mass[ball] * 9.81
        expected = [-share * weight, 0.0, np.cos(np.pi / 6) * weight]
        assert np.allclose(curves.bodies[ball]["contact_force"][1:], expected, rtol=1e-10, atol=1e-10 * weight)


def test_sliding_loses_what_the_books_say(runs):
    # Measured: 9e-15 J of 8.6 J. The force mu m g cos 30 over the way slipped, of the two that slide.
    curves = runs.curves("plane", "incline")
    expected = 0.0
    for ball, mu in (("below", 0.1648), ("smooth", 0.1)):
        force = mu * curves.mass[ball] * 9.81 * np.cos(np.pi / 6)
        slip = curves.at(ball, "velocity")[0] - 0.1 * curves.at(ball, "angular_velocity")[1]
        expected += 0.5 * force * slip  # t = 1 s, slip grows from 0
    assert abs(curves.energy["dissipated"][-1] - expected) <= 1e-10
