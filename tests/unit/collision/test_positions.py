"""Overlaps removed with the least motion: closed forms, an independent minimum, what is told without room."""

import contact_scenes as cs
import numpy as np
from contact_scenes import box, contact, party, scene
from scipy.optimize import minimize

from flowgmo.collision.contact import TWIST
from flowgmo.collision.contact_newton import CONVERGED, IMPOSSIBLE
from flowgmo.collision.positions import separate

TOLERANCE = 1e-11


def shifted(s, depths, tolerance=TOLERANCE):
    shifts = np.ones(len(s[2]), TWIST)
    contacts = s[0].copy()
    result = separate(s[0], np.asarray(depths, float), s[2], shifts, tolerance, 1000)
    np.testing.assert_array_equal(s[0], contacts)
    return result, shifts


def test_two_bodies_share_by_mass():
    """Free cubes of mass 1 and 3: 3/4 and 1/4 of the depth. Measured: 1e-18."""
    s = scene([box((0, 0, 0), (1, 1, 1), 1.0), box((0, 0, 1), (1, 1, 1), 3.0)], [contact(1, 0, (0, 0, 0.5))])
    result, shifts = shifted(s, [0.02])
    assert result[2] == CONVERGED
    np.testing.assert_allclose(shifts["v"], [[0, 0, -0.015], [0, 0, 0.005]], atol=1e-12)
    np.testing.assert_allclose(shifts["w"], 0, atol=1e-15)


def test_a_correction_does_not_push_others_together():
    """The lowest of three cubes sinks in: all rise, as the contacts between them may not close. Measured: 2e-14."""
    s = cs.stack(np.ones(3))
    _, shifts = shifted(s, [0.01] * 4 + [0.0] * 8)
    np.testing.assert_allclose(shifts["v"][:, 2], [0, 0.01, 0.01, 0.01], atol=1e-12)
    np.testing.assert_allclose(shifts["w"], 0, atol=1e-12)


def test_a_heavy_body_on_a_light_one_is_lifted():
    """The light one cannot go down, whatever the masses. Measured: 8e-14."""
    s = cs.stack([1.0, 1000.0])
    _, shifts = shifted(s, [0.0] * 4 + [0.01] * 4)
    np.testing.assert_allclose(shifts["v"][:, 2], [0, 0, 0.01], atol=1e-11)


def test_an_edge_that_sinks_in_turns_the_body():
    """Two of four corners sink by d: the cube rises and turns, no corner ends below the floor."""
    s = cs.stack([1.0])
    deep = np.where(s[0]["point"][:, 0] > 0, 0.01, 0.0)
    _, shifts = shifted(s, deep)
    rise = cs.contact_velocities(s[0], s[2], shifts)[:, 2]
    assert np.all(rise >= deep - 1e-12)
    assert shifts["w"][1, 1] < 0 < shifts["v"][1, 2]


def test_the_least_motion_against_scipy():
    """min ½ dᵀ M d by SLSQP on random piles of 2 bodies: never more motion than it finds."""
    rng = np.random.default_rng(17)
    for _ in range(20):
        s = cs.random_pile(rng, 2, 4, 0.5, ratio=4.0)
        depths = rng.uniform(0, 1, 4) * rng.integers(0, 2, 4)
        (_, _, status), shifts = shifted(s, depths)
        assert status == CONVERGED
        mass = np.zeros((12, 12))
        for b in range(2):
            mass[6 * b : 6 * b + 3, 6 * b : 6 * b + 3] = np.eye(3) / s[2]["wt"][b + 1, 0]
            mass[6 * b + 3 : 6 * b + 6, 6 * b + 3 : 6 * b + 6] = np.linalg.inv(cs.tensor(s[2]["wr"][b + 1]))

        def opening(d, s=s):
            twists = np.zeros(3, TWIST)
            twists["v"][1:], twists["w"][1:] = d.reshape(2, 6)[:, :3], d.reshape(2, 6)[:, 3:]
            return np.sum(cs.contact_velocities(s[0], s[2], twists) * s[0]["normal"], axis=1)

        best = minimize(
            lambda d, mass=mass: 0.5 * d @ mass @ d,
            np.zeros(12),
            jac=lambda d, mass=mass: mass @ d,
            constraints={"type": "ineq", "fun": lambda d, depths=depths, opening=opening: opening(d) - depths},
            method="SLSQP",
            options={"ftol": 1e-14, "maxiter": 500},
        )
        ours = np.concatenate([shifts["v"][1:], shifts["w"][1:]], axis=1).ravel()
        assert np.all(opening(ours) >= depths - 1e-9)
        assert 0.5 * ours @ mass @ ours <= best.fun + 1e-6 * abs(best.fun) + 1e-12


def test_no_room_is_shared_and_reported():
    """A cube between a floor and a lid, both immovable, too deep in each: half of what lacks stays at each side."""
    s = cs.crusher()
    result, shifts = shifted(s, [0.01] * 4 + [0.02] * 4)
    assert result[2] == IMPOSSIBLE and 0 < result[1] <= 1
    np.testing.assert_allclose(shifts["v"][1], [0, 0, -0.005], atol=1e-5)
    assert not shifts["v"][2].any()


def test_nothing_too_deep_nothing_moved():
    s = cs.stack(np.ones(3))
    result, shifts = shifted(s, np.zeros(12))
    assert result == (0, 0.0, CONVERGED) and not shifts["v"].any() and not shifts["w"].any()


def test_scaled_by_powers_of_two_the_same_bits():
    s, other = cs.stack([1.0, 1000.0, 3.0]), cs.stack([1.0, 1000.0, 3.0])
    depths = np.linspace(0, 0.01, 12)
    other[0]["point"] *= 8
    other[2]["centre"] *= 8
    other[2]["wt"] /= 2
    other[2]["wr"] /= 128
    result, shifts = shifted(s, depths)
    again, scaled = shifted(other, 8 * depths)
    assert result == again
    np.testing.assert_array_equal(8 * shifts["v"], scaled["v"])
    np.testing.assert_array_equal(shifts["w"], scaled["w"])


def test_held_bodies_only_turn():
    """A body on a fixed axis turns out of the floor; the axis stays."""
    hinge = party((0, 0, 0))
    hinge["wr"] = cs.six(np.outer([0, 1.0, 0], [0, 1.0, 0]))
    s = scene([party((0, 0, 0)), hinge], [contact(1, 0, (1, 0, 0))])
    _, shifts = shifted(s, [0.01])
    np.testing.assert_allclose(shifts["w"][1], [0, -0.01, 0], atol=1e-12)
    assert not shifts["v"][1].any()
