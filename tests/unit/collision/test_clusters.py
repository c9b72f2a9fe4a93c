"""Clusters: the energy law of Liu, Zhao & Brogliato with friction, against references and symmetries."""

import cluster_scenes as scenes
import numpy as np
import pytest
from cluster_scenes import after
from scipy.integrate import solve_ivp

from flowgmo.records import SLIP, STICK


@pytest.mark.parametrize(
    ("eta", "speeds"), [(1.5, (-0.070952, 0.076403, 0.994549)), (1.0, (-0.130262, 0.150230, 0.980032))]
)
def test_three_touching_balls(eta, speeds):
    """VALIDATION C. Error 4e-5, 5e-5; it falls with the square of the step (a kink or a late start would cost that)."""
    _, twists = after(scenes.row(3), eta)
    np.testing.assert_allclose(twists["v"][:, 0], speeds, atol=1e-4)
    error = [np.abs(after(scenes.row(3), eta, f)[1]["v"][:, 0] - speeds).max() for f in (0.1, 0.05, 0.025)]
    assert error[0] > 3 * error[1] > 9 * error[2]


def test_rack():
    """VALIDATION C, to 1e-3. Measured 5e-4 (cue), 8e-5; energy 2e-15, symmetry 8e-15."""
    _, twists = after(scenes.rack())
    v = twists["v"]
    assert np.linalg.norm(v[11]) == pytest.approx(5.597, abs=1e-3)
    assert v[13, 0] == pytest.approx(2.6335, abs=1e-3)
    assert v[0, 0] == pytest.approx(-1.792, abs=1e-3)
    assert (v**2).sum() == pytest.approx(100, rel=1e-12)
    np.testing.assert_allclose(v[11] * (1, -1, 1), v[15], atol=1e-10)
    np.testing.assert_allclose(v[12] * (1, -1, 1), v[14], atol=1e-10)
    assert abs(v[[0, 1, 5, 13], 1]).max() < 1e-10


@pytest.mark.parametrize("seed", range(5))
def test_renumbering_changes_nothing(seed):
    """Balls and contacts of the rack in another order. Measured 5e-14."""
    rng = np.random.default_rng(seed)
    order = rng.permutation(16)
    contacts, responses, twists = scenes.rack(order)
    _, other = after((contacts[rng.permutation(len(contacts))], responses, twists))
    _, twists = after(scenes.rack())
    np.testing.assert_allclose(other["v"], twists["v"][order], atol=1e-10)


@pytest.mark.parametrize("order", [(0, 1, 2, 3), (2, 0, 3, 1), (3, 1, 0, 2)])
@pytest.mark.parametrize("e", [1.0, 0.7, 0.1, 0.01, 1e-3, 0.0])
def test_flat_box_rebounds_flat(e, order):
    """VALIDATION C: v = e, ω = 0; the corners share equally. Measured 1e-15, ω 1e-13."""
    contacts, twists = after(scenes.box(e, order=order))
    np.testing.assert_allclose(twists["v"][0], (0, 0, e), atol=1e-12)
    np.testing.assert_allclose(twists["w"][0], 0, atol=1e-11)
    np.testing.assert_allclose(contacts["impulse"][:, 2], (1 + e) / 4, atol=1e-11)


@pytest.mark.parametrize("seed", range(60))
def test_one_contact_without_friction_is_newtons(seed):
    """-(1 + e) v3 / K33 at any size of the step: the energy comes back exactly."""
    contacts, responses, twists = scenes.random_cluster(seed, mu=0.0)
    contacts = contacts[:1]
    v = scenes.velocities(contacts, responses, twists)[0]
    n, e = contacts["normal"][0], contacts["e"][0]
    got, twists = after((contacts, responses, twists), fraction=0.2)
    w = scenes.velocities(contacts, responses, twists)[0]
    assert w @ n == pytest.approx(v @ n if v @ n > 0 else -e * (v @ n), abs=1e-11)
    assert got["regime"][0] == SLIP
    assert got["loss"][0] == pytest.approx(-0.5 * (v + w) @ got["impulse"][0], abs=1e-11)


ROD = [
    (45, 0.3, 2.0, 0.855932203390, 0.5),
    (45, 0.3, -0.2, -0.748780487805, 0.5),
    (45, 0.3, 0.2, -0.439654470328, 0.463944441118),
    (45, 0.7, 0.2, 0, 0.443343936638),
    (45, 0.7, 1.0, 0, 0.342573271535),
    (64, 1.6, -0.5, 0, 0.581289565749),
]


@pytest.mark.parametrize(("angle", "mu", "v1", "w1", "w3"), ROD)
def test_one_rough_contact_is_stronges(angle, mu, v1, w1, w3):
    """The rod of VALIDATION B: slip, reversal, stick, jam. Measured 3e-6 at 0.05, 3e-9 at 0.00625."""
    for fraction, bound in ((0.05, 2e-5), (0.00625, 1e-7)):
        scene = scenes.rod(angle, mu, 0.5, v1)
        contacts, twists = after(scene, fraction=fraction)
        w = scenes.velocities(*scene[:2], twists)[0]
        np.testing.assert_allclose(w, (w1, 0, w3), atol=bound)
        assert contacts["regime"][0] == (STICK if w1 == 0 else SLIP)


@pytest.mark.parametrize(
    ("mu", "w", "bound"),
    [(0.176, (-97.138789748, -29.463157834, 78.904632551), 3e-2), (0.5, (0, 0, 75.964427761), 1e-4)],
)
def test_one_rough_contact_in_space(mu, w, bound):
    """The box corner of VALIDATION B, |v| = 100: slip that swerves past a minimum (9e-3), slip that halts (2e-5)."""
    scene = scenes.box_corner(mu)
    _, twists = after(scene)
    np.testing.assert_allclose(scenes.velocities(*scene[:2], twists)[0], w, atol=bound)


@pytest.mark.parametrize("e", [1.0, 0.8, 0.3])
def test_against_another_integrator(e):
    """Four balls of different mass in a row: the same law by scipy with rtol 1e-10. Measured 3e-5."""
    contacts, responses, twists = scenes.row(4, e)
    masses = np.array([1.0, 0.3, 2.0, 0.7])
    responses["wt"][:, :3] = 1 / masses[:, None]

    def slopes(_, y):
        v, depth = y[:4], np.maximum(y[4:], 0)
        f = depth**1.5
        closing = v[:-1] - v[1:]
        rate = np.where(closing > 0, closing, closing / e**2) * ((y[4:] > 0) | (closing > 0))
        return np.concatenate([(np.append(0, f) - np.append(f, 0)) / masses, rate])

    y = np.array([1.0, 0, 0, 0, 0, 0, 0])
    y = solve_ivp(slopes, (0, 40), y, rtol=1e-10, atol=1e-12, max_step=0.01).y[:4, -1]
    np.testing.assert_allclose(after((contacts, responses, twists))[1]["v"][:, 0], y, atol=2e-4)


def test_powers_of_two_give_the_same_bits():
    """Lengths by 8, masses by 2^-7, times by 32."""
    contacts, responses, twists = scenes.domino()
    length, mass, time = 8.0, 2.0**-7, 32.0
    _, one = after((contacts, responses, twists))
    contacts["point"] *= length
    responses["centre"] *= length
    responses["wt"] /= mass
    responses["wr"] /= mass * length**2
    twists["v"] *= length / time
    twists["w"] /= time
    _, two = after((contacts, responses, twists))
    np.testing.assert_array_equal(one["v"] * (length / time), two["v"])
    np.testing.assert_array_equal(one["w"] / time, two["w"])


@pytest.mark.parametrize("e", [0.846, 0.0])
def test_dominoes_stay_in_their_plane(e):
    """Eight rough contacts, redundant across the plane: what leaves it is what sweeps leave. Measured 9e-8 of 10."""
    _, twists = after(scenes.domino(e))
    assert abs(twists["v"][:2, 1]).max() < 1e-6
    assert abs(twists["w"][:2, [0, 2]]).max() < 1e-6


@pytest.mark.parametrize("e", [0.846, 0.0])
def test_renumbering_rough_contacts(e):
    """The order of contacts decides what sweeps leave, no more. Measured 2e-8 of 14."""
    contacts, responses, twists = scenes.domino(e)
    _, one = after((contacts, responses, twists))
    for seed in range(4):
        order = np.random.default_rng(seed).permutation(len(contacts))
        _, two = after((contacts[order], responses, twists))
        np.testing.assert_allclose(one["v"], two["v"], atol=1e-6)


@pytest.mark.parametrize("tiny", [1e-3, 1e-5, 1e-7])
def test_a_grazing_contact(tiny):
    """Approach far below the slip: restitution and Coulomb's law all the same. A threshold on v would swallow it."""
    contacts, responses, twists = scenes.balls([(0, 0, 0), (1, 0, 0)], [(tiny, 1, 0), (0, 0, 0)], e=0.5, mu=0.1)
    got, end = after((contacts, responses, twists))
    v = end["v"][0] - end["v"][1]
    assert v[0] == pytest.approx(-0.5 * tiny, rel=1e-4)
    assert got["impulse"][0, 1] == pytest.approx(0.1 * got["impulse"][0, 0], rel=1e-6)
