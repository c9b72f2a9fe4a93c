"""Restart = no restart, bit for bit, through the whole run: history.h5 and restart.h5 compared."""

import signal
from pathlib import Path

import h5py
import numpy as np
import pytest
from flowgmo_scenes import ball, deck, on_axis, rigid, solid

import flowgmo.step
from flowgmo.building import build_model
from flowgmo.deck import parse_deck
from flowgmo.run import DONE, INTERRUPTED, run

FLOOR = (2, 2, 2, 2, 2, 3)
OUTPUT = "tpltd(1)=0.3, tapltd(1)=0.1, thpltd(1)=0.017,"


def balls():
    """Bounces, a closed series, rolling, impacts of two, with friction."""
    return deck(
        ball((0, 0, 0.6), v=(0.4, 0.1, 0), w=(1, 2, 3)), ball((0.3, 0.05, 0.1), v=(0, 0.3, 0)), ball((-0.4, 0, 0.4)),
        solid((-2, -2, -1), (2, 2, 0)), lo=(-0.9, -0.9, -1), hi=(0.9, 0.9, 2), sides=FLOOR, g=(0, 0, -9.81), e=0.6,
        mu=0.2, end=1.2, dt=0.013, xput=OUTPUT,
    )  # fmt: skip


def bodies():
    """A top, a loaded body with a stop, a pendulum, a driven one."""
    inertia = np.array([[2.0, 0.3, -0.1], [0.3, 1.5, 0.2], [-0.1, 0.2, 1.1]])
    return deck(
        rigid(inertia, w=(1, 2, 3)),
        rigid(inertia, w=(1, 0, 3), more="igf(#)=1, fxtobs(1,#)=2.0, tytobs(1,#)=1.0, dxmcmax(#)=0.4,"),
        on_axis(0.7, (0, 1, 1), 2.0, (0.3, 0, -0.3), rate=0.5),
        "imo(#)=3, iob(#)=#, rsh(#)=0.1, iupre(#)=1, uamp(#)=1.0, ufre(#)=0.9, omztobs(1,#)=2.0,",
        g=(0, 0, -9.81), collide=False, end=1.2, dt=0.013, xput=OUTPUT,
    )  # fmt: skip


def contents(path):
    """All datasets of a file as bytes."""
    found = {}
    with h5py.File(path) as file:
        file.visititems(lambda name, item: found.update({name: item[()]}) if isinstance(item, h5py.Dataset) else None)
    return found


def same(one, two, but=()):
    a, b = contents(one), contents(two)
    assert a.keys() == b.keys()
    for name in a:
        if name not in but:
            assert np.array_equal(a[name], b[name]), name


def model(text):
    return build_model(parse_deck(text, Path("t.nml")))


@pytest.fixture
def stop_after(monkeypatch):
    """Makes a run send itself an interrupt in its n-th step."""
    original = flowgmo.step.step

    def arm(n):
        count = [0]

        def step(*args):
            count[0] += 1
            if count[0] == n:
                signal.raise_signal(signal.SIGINT)
            return original(*args)

        monkeypatch.setattr(flowgmo.step, "step", step)

    yield arm


@pytest.mark.parametrize("scene", [balls, bodies])
@pytest.mark.parametrize("steps", [(1,), (7, 24, 31), (40,)])
def test_interrupted_and_continued_is_the_run_without_a_stop(scene, steps, tmp_path, stop_after):
    """Interrupted between outputs, several times. A state that is not whole in the file, a step counted from another
    place, or a row written twice shows in the bits."""
    text = scene()
    assert run(model(text), tmp_path / "whole", None, "test") == DONE
    folder = tmp_path / "parts"
    restart = None
    for n in steps:
        stop_after(n)
        assert run(model(text), folder, restart, "test") == INTERRUPTED
        restart = folder / "restart.h5"
    stop_after(-1)
    assert run(model(text), folder, restart, "test") == DONE
    same(tmp_path / "whole" / "history.h5", folder / "history.h5")
    same(tmp_path / "whole" / "restart.h5", folder / "restart.h5")


@pytest.mark.parametrize("scene", [balls, bodies])
def test_history_intervals_do_not_change_the_result(scene, tmp_path):
    """Only TPLTD lands: other history and selected-data intervals give the same last state, bit for bit."""
    for name, text in (("a", scene()), ("b", scene().replace("thpltd(1)=0.017", "thpltd(1)=0.05")
                       .replace("tapltd(1)=0.1", "tapltd(1)=0.023"))):  # fmt: skip
        assert run(model(text), tmp_path / name, None, "test") == DONE
    same(tmp_path / "a" / "restart.h5", tmp_path / "b" / "restart.h5", but=("deck",))
    with h5py.File(tmp_path / "a" / "history.h5") as a, h5py.File(tmp_path / "b" / "history.h5") as b:
        if "collisions" in a:
            for name in a["collisions"]:
                assert np.array_equal(a["collisions"][name], b["collisions"][name]), name


def test_a_row_inside_a_step_is_the_state_of_a_step_that_ends_there(tmp_path):
    """History rows are exact states: the same times as rows of a coarse run and as ends of steps. Measured: 1e-13."""
    rows = {}
    for dt in ("0.017", "0.3"):
        text = balls().replace("delt=0.013", f"delt={dt}")
        assert run(model(text), tmp_path / dt, None, "test") == DONE
        with h5py.File(tmp_path / dt / "history.h5") as file:
            body = file["bodies"]["obs1"]
            rows[dt] = np.concatenate([body["position"][:10], body["velocity"][:10], body["orientation"][:10]], axis=1)
    np.testing.assert_allclose(rows["0.017"], rows["0.3"], atol=1e-11)
