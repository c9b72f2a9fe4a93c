"""What is read: bounces, poses between snapshots, names."""

import h5py
import numpy as np
import pytest

from postproc.bounces import bouncing_body, rebounds, vertical_axis
from postproc.results import Results
from postproc.scene import Scene, rotation


def test_rebounds_are_those_of_the_closed_form(anvil):
    """Stronge 2000: h_i = e^(2i) h_0, t_i = sqrt(2 h_0/g) (-1 - e^i + 2 sum_{j=0}^i e^j)."""
    results = Results(anvil)
    assert bouncing_body(results) == "ball"
    found = rebounds(results, "ball")
    i = np.arange(1, len(found) + 1)
    whole = ~np.isnan([bounce.top for bounce in found])
    assert whole.sum() == 5
    e, height, drop = 0.8, 0.5, np.sqrt(2 * 0.5 / 9.81)
    tops = drop * (-1 - e**i + 2 * (1 - e ** (i + 1)) / (1 - e))
    assert np.allclose([bounce.top for bounce in found], tops, rtol=1e-9)
    assert np.allclose([bounce.height for bounce in found], e ** (2 * i) * height, rtol=1e-9)


def test_no_bouncing_body_in_a_crowd(crowd):
    assert bouncing_body(Results(crowd)) is None


def test_up_is_against_gravity(anvil):
    assert vertical_axis(Results(anvil)) == (2, 1.0)


def test_poses_between_snapshots_are_those_of_the_history(scenes, anvil):
    """At t = 0.31 the ball is where its history has it, at any snapshot interval; it has turned about x by 0.31."""
    scene = Scene(Results(anvil))
    ball, plate = scene.at(0.31)
    assert (ball.name, plate.name) == ("ball", "anvil") and plate.stationary and not ball.stationary
    z, _ = scenes.flight(np.array([0.31]))
    assert np.allclose((ball.points.min(axis=0) + ball.points.max(axis=0)) / 2, [0, 0, z[0] + 0.1], atol=1e-3)
    start = scene.at(0.0)[0]
    turn = rotation(np.array([np.cos(0.155), np.sin(0.155), 0, 0]))
    assert np.allclose(ball.points - [0, 0, z[0] + 0.1], (start.points - [0, 0, 0.6]) @ turn.T, atol=1e-5)
    assert ball.speed == pytest.approx(9.81 * 0.31, rel=1e-3)


def test_without_a_history_the_nearest_snapshot_is_shown(scenes, tmp_path):
    scenes.write_anvil(tmp_path)
    (tmp_path / "history.h5").unlink()
    scene = Scene(Results(tmp_path))
    assert scene.end == 2.0 and [s.name for s in scene.at(0.23)] == ["obs1", "obs2"]
    z, _ = scenes.flight(np.array([0.2]))
    assert np.allclose(scene.at(0.23)[0].points[:, 2].min(), z[0], atol=1e-3)


def test_the_history_itself_may_be_named(anvil):
    assert Results(anvil / "history.h5").bodies == {"ball": 1}
    assert Results(anvil).parties[-5] == "Zmin" and Results(anvil).parties[2] == "anvil"


def test_after_the_last_row_of_a_killed_run_the_nearest_snapshot_is_shown(scenes, tmp_path):
    scenes.write_anvil(tmp_path)
    with h5py.File(tmp_path / "history.h5", "r+") as file:
        rows = int(np.searchsorted(file["time"][:], 1.05))
        shorten(file, rows)
    scene = Scene(Results(tmp_path))
    for t, shown in ((1.0, 1.0), (1.43, 1.4), (2.0, 2.0)):
        z, _ = scenes.flight(np.array([shown]))
        assert np.allclose(scene.at(t)[0].points[:, 2].min(), z[0], atol=1e-3)


def shorten(group, rows):
    """Only the first rows of the history are left."""
    length = len(group.file["time"])
    for name, item in list(group.items()):
        if isinstance(item, h5py.Group):
            if name != "collisions":
                shorten(item, rows)
        elif name != "time" and item.shape and len(item) == length:
            values, attributes = item[:rows], dict(item.attrs)
            del group[name]
            group[name] = values
            group[name].attrs.update(attributes)
    if group.name == "/":
        values, attributes = group["time"][:rows], dict(group["time"].attrs)
        del group["time"]
        group["time"] = values
        group["time"].attrs.update(attributes)
