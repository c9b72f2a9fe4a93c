"""Paths of held bodies against closed forms; velocities from twists and back; the path made for a given end."""

import numpy as np
import pytest
from arenas import TENSOR, arena_of, kinds, loose, scene_of
from flowgmo_scenes import on_axis, rigid
from scipy.spatial.transform import Rotation

from flowgmo.collision.contact import TWIST
from flowgmo.collision.paths import FREE, HELD
from flowgmo.collision.respond import coast, free_twists, set_all, set_paths


def held(text, acc=(0, 0, 0), alp=(0, 0, 0)):
    arena = arena_of(text)
    arena.paths["mode"][0], arena.paths["acc"][0], arena.paths["alp"][0] = HELD, acc, alp
    return arena


def test_a_held_free_body_runs_on_a_parabola():
    """x0 + v t + a t²/2 and v + a t; about one axis the angle w t + α t²/2. Measured: 2e-16."""
    v, acc, w, alp = np.array([1.0, 2, 3]), np.array([0.3, -2, 5]), 2.0, -0.7
    arena = held(loose(rigid(TENSOR, 1.5, v=v, w=(0, 0, w))), acc, (0, 0, alp))
    start = arena.motion["p"][0].copy()
    for t in (0.4, 1.1):  # in two parts: a path goes on where it was left
        arena.bring(np.array([0]), t, np.zeros(4))
    row = arena.motion[0]
    np.testing.assert_allclose(row["p"], start + v * t + acc * t**2 / 2, atol=1e-14)
    np.testing.assert_allclose(row["v"], v + acc * t, atol=1e-14)
    angle = w * t + alp * t**2 / 2
    np.testing.assert_allclose(row["q"], [np.cos(angle / 2), 0, 0, np.sin(angle / 2)], atol=1e-14)
    assert row["w"][2] == pytest.approx(w + alp * t, abs=1e-15)


def test_a_held_body_turns_as_its_equation_integrated():
    """q' = ½ ω q with ω = w + α t in another direction, against 20 000 small turns.

    Measured: 1.9e-7 rad (vectors.turned_linearly leaves 1.4e-6 a sub-step at most). A wrong sign of w × α shows as .1.
    """
    w, alp, t, n = np.array([1.0, -2, 0.5]), np.array([0.4, 1.0, 3.0]), 1.3, 20_000
    arena = held(loose(rigid(TENSOR, 1.5, w=w)), alp=alp)
    arena.bring(np.array([0]), t, np.zeros(4))
    turn = Rotation.identity()
    for k in range(n):
        turn = Rotation.from_rotvec((w + alp * t * (k + 0.5) / n) * t / n) * turn
    c, x, y, z = arena.motion["q"][0]
    assert (Rotation.from_quat([x, y, z, c]) * turn.inv()).magnitude() < 1e-6
    np.testing.assert_allclose(arena.motion["w"][0], w + alp * t, atol=1e-15)


def test_a_held_hinge_turns_about_its_axis_only():
    """angle = ½ α t² + ω t whatever else the angular acceleration holds; B stays on its circle. Measured: 2e-16."""
    axis = np.array([0, 1, 1]) / np.sqrt(2)
    arena = held(loose(on_axis(0.7, (0, 1, 1), 2.0, (0.3, 0.1, -0.3), rate=0.5)), alp=3 * axis + [5, 0, 0])
    arm = arena.bodies["arm"][0]
    arena.bring(np.array([0]), 0.9, np.zeros(4))
    row, angle = arena.motion[0], 0.5 * 0.9 + 1.5 * 0.81
    assert row["angle"] == pytest.approx(angle, rel=1e-14)
    np.testing.assert_allclose(row["p"], Rotation.from_rotvec(angle * axis).apply(arm), atol=1e-14)
    np.testing.assert_allclose(row["w"], (0.5 + 2.7) * axis, atol=1e-14)
    np.testing.assert_allclose(row["v"], np.cross(row["w"], row["p"]), atol=1e-14)


def test_a_held_body_on_a_point_keeps_its_distance():
    """B = point + R arm, v = ω × (R arm), to the last digits: the point is never left. Measured: 1e-16."""
    arena = held(scene_of("fixed point"), alp=(1, -3, 2))
    arm = arena.bodies["arm"][0]
    arena.bring(np.array([0]), 1.7, np.zeros(4))
    row = arena.motion[0]
    w, x, y, z = row["q"]
    np.testing.assert_allclose(
        row["p"], arena.bodies["point"][0] + Rotation.from_quat([x, y, z, w]).apply(arm), atol=1e-14
    )
    np.testing.assert_allclose(row["v"], np.cross(row["w"], row["p"]), atol=1e-14)


# ---- respond.py


@pytest.mark.parametrize("name", [n for n in kinds() if n != "driven"])
def test_velocities_from_twists_and_back(name):
    """set_all undoes respond_all: the velocity of B of every kind of body to round-off."""
    arena = arena_of(scene_of(name))
    arena.bring(np.array([0]), 0.3, np.zeros(4))
    before = arena.motion[:1].copy()
    which = np.array([0])
    arena.respond(which)
    arena.motion["v"][0] = arena.motion["w"][0] = np.nan
    set_all(which, arena.bodies, arena.motion, arena.responses, arena.twists)
    for part in ("v", "w"):
        np.testing.assert_allclose(arena.motion[part][0], before[part][0], rtol=0, atol=1e-14 * 20)


@pytest.mark.parametrize("name", ["ballistic", "hinged", "fixed point"])
def test_a_held_path_ends_with_the_twist_it_was_made_for(name):
    """set_paths: constant accelerations bring a body to the given twist at the end of its leg. Measured: 4e-16."""
    arena = arena_of(scene_of(name))
    which, end = np.array([0]), 0.2
    ends, books = np.zeros(len(arena.bodies), TWIST), np.zeros((len(arena.bodies), 4))
    free_twists(
        which, arena.bodies, arena.motion, arena.paths, arena.laws, arena.spare, end, ends, books, np.zeros((0, 7))
    )
    assert arena.paths["mode"][0] == FREE
    ends["v"][0] += [0.1, 0.2, 0.3]
    ends["w"][0] *= 1.5
    pressed = np.zeros(len(arena.bodies), dtype=np.int64)
    pressed[0] = 1
    set_paths(which, pressed, arena.bodies, arena.motion, arena.paths, ends, 0.0, end)
    arena.bring(which, end, np.zeros(4))
    arena.respond(which)
    if name == "ballistic":
        np.testing.assert_allclose(arena.twists["v"][0], ends["v"][0], atol=1e-13)
    np.testing.assert_allclose(arena.twists["w"][0], ends["w"][0], atol=1e-13)


def test_coasting_goes_straight_on():
    """x + v t and a turn by w t: where a contact will be in the middle of its leg; the pose itself is not moved."""
    arena = arena_of(loose(rigid(TENSOR, 1.5, v=(1, 2, 3), w=(0, 0, 2))))
    before = arena.motion.copy()
    coast(np.array([0]), arena.bodies, arena.motion, arena.paths, arena.laws, 0.25, arena.spare, np.zeros((0, 7)))
    np.testing.assert_allclose(arena.spare["p"][0], [0.25, 0.5, 0.75], atol=1e-15)
    np.testing.assert_allclose(arena.spare["q"][0], [np.cos(0.25), 0, 0, np.sin(0.25)], atol=1e-15)
    assert before.tobytes() == arena.motion.tobytes()
