"""`impmob=0`, bodies and liquid one after the other: right for heavy bodies; of light ones it says that it diverges.

decks/hard/wet_explicit.nml; the theory is in flowgmo/wet_explicit.py.
"""

from pathlib import Path

import h5py
import numpy as np
import pytest
from flowgmo_wet_bodies import begin, model_of, play, tank

from flowgmo import run as run_module
from flowgmo.errors import StepFailed
from flowgmo.flow import team
from flowgmo.pace import Pace
from flowgmo.run import DONE, FAILED, INTERRUPTED, Job, run
from flowgmo.step import poses_of
from flowgmo.wet_explicit import GROWN, Swing

DECKS = Path(__file__).parents[2] / "decks" / "hard"
LIGHT = (DECKS / "wet_explicit.nml").read_text()
HEAVY = LIGHT.replace("rhomvb(1)=100.0", "rhomvb(1)=7800.")
VISCOUS = HEAVY.replace("rhof=1000.,", "rhof=1000., mu1=20.,").replace("impmob=0", "ifvisc=1, impmob=0, iwsh=1")
DRIVEN = tank(xput="impmob=0,").replace("rhomvb(2)=500.0", "rhomvb(2)=2000.0")


def together(text):
    return text.replace("impmob=0", "impmob=1")


def fall(text):
    """Times and vertical velocities of the first 15 steps."""
    rows = [(0.0, 0.0)]
    play(text, 15, each=lambda world, state, report: rows.append((state.t, state.v_WB[0, 2])))
    return np.array(rows).T


@pytest.mark.parametrize("lid", [True, False])
def test_a_heavy_ball_falls_as_with_both_solved_together(lid):
    # r = 7.8, added mass .07 of it. Measured after .1 s: 1.0022 under a lid, 1.0021 with a surface: the first step
    # knows of no added mass and is 6 % too large. A load that lags by more, or misses the lift, would change the slope.
    text = HEAVY.replace("itb=1", "itb=0").replace("flht=.55", "") if lid else HEAVY
    (t, w), (t1, w1) = fall(text), fall(together(text))
    assert w[-1] / t[-1] == pytest.approx(w1[-1] / t1[-1], rel=0.004)
    late = slice(4, None)
    slopes = [np.polyfit(a[late], b[late], 1)[0] for a, b in ((t, w), (t1, w1))]
    assert slopes[0] == pytest.approx(slopes[1], rel=0.004)


def test_friction_reaches_a_heavy_ball_a_step_late():
    # Oil of 20 Pa s. Measured: 1.7 % faster than with both solved together in steps of 4 ms, .6 % in such of 1 ms:
    # first order. Friction that is not paid, or paid twice, would leave 15 % in short steps too.
    late = []
    for dt in (0.004, 0.001):
        ends = []
        for text in (VISCOUS, together(VISCOUS)):
            text = text.replace("twfin=0.1", f"twfin=0.06, tdtmax(1)={dt}")
            ends.append(play(text, 100)[1].v_WB[0, 2])
        late.append(ends[0] / ends[1] - 1.0)
    assert 0.0 < late[0] <= 0.022
    assert late[1] <= 0.5 * late[0]


@pytest.mark.parametrize("r", [0.001, 0.1])
def test_a_light_ball_diverges_and_says_so(r):
    # a = -q a with q = C_a / r: 5.6 and 530 measured, 5.37 and 537 from the added mass. It takes four steps.
    rows = []
    text = LIGHT.replace("rhomvb(1)=100.0", f"rhomvb(1)={1000.0 * r}")
    with pytest.raises(StepFailed, match=r"body ball diverges.*impmob=0.*mass .*, added mass up to .*Write\s+impmob=1"):
        world, state = begin(text)
        assert len(world.wet_bodies.explicit.compare_masses(state.fluid, poses_of(state), 0.002)) == 1
        pace = Pace(world.model, state)
        while True:
            before, t = state.v_WB[0, 2], state.t
            pace.advance(world)
            rows.append((state.v_WB[0, 2] - before) / (state.t - t))
    a = np.array(rows)
    assert len(a) <= 6
    assert (a[1:] * a[:-1] < 0.0).all()
    assert -a[-1] / a[-2] == pytest.approx(0.535 / r, rel=0.1)


def test_a_run_that_diverges_keeps_its_last_good_state(tmp_path):
    assert run(model_of(LIGHT), tmp_path, None, "test") == FAILED
    log = (tmp_path / "run.log").read_text()
    assert log.count("ball is lighter than its added mass") == 1
    assert "motion of body ball diverges" in " ".join(log.split())
    with h5py.File(tmp_path / "history.h5") as file:
        assert np.isfinite(file["bodies/ball/velocity"][:]).all()
    assert (tmp_path / "restart.h5").exists()


@pytest.mark.slow
def test_twenty_light_balls_under_a_lid_diverge_and_say_so():
    text = (DECKS / "wet_bubbles.nml").read_text().replace("imobs=1", "imobs=1, impmob=0")
    with pytest.raises(StepFailed, match="diverges"):
        play(text, 200)


def test_a_heavy_ball_comes_to_rest_on_the_bed():
    # A ball five times as heavy as water falls on the bed and stays there, as with both solved together.
    text = HEAVY.replace("7800.", "5000.").replace("imobs=1,", "imobs=1, iclid=1, strngmob=.3,")
    text = text.replace("twfin=0.1", "twfin=.6").replace("trnz(1)=0.301", "trnz(1)=0.121")
    for one in (text, together(text)):
        _, state = play(one, 600)
        assert state.p_WB[0, 2] == pytest.approx(0.1, abs=1e-6)
        assert abs(state.v_WB[0, 2]) <= 1e-6  # it rolls a little


@pytest.mark.parametrize("scene", [VISCOUS, DRIVEN])
def test_restart_goes_on_with_the_same_bits(tmp_path, monkeypatch, scene):
    """The friction of a step is paid in the next: it is in the state."""
    text = scene.replace("twfin=2.0", "twfin=.05")
    count = [0, -1]
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    assert run(model_of(text), whole, None, "test") == DONE
    real = Pace.advance

    def stopping(self, world):
        count[0] += 1
        if count[0] == 5:
            jobs[-1].stop_asked = True
        return real(self, world)

    jobs, init = [], Job.__init__

    def noted(self, *args, **kwargs):
        init(self, *args, **kwargs)
        jobs.append(self)

    monkeypatch.setattr(Job, "__init__", noted)
    monkeypatch.setattr(run_module.Pace, "advance", stopping)
    assert run(model_of(text), parts, None, "test") == INTERRUPTED
    assert run(model_of(text), parts, parts / "restart.h5", "test") == DONE
    with h5py.File(whole / "restart.h5") as one, h5py.File(parts / "restart.h5") as two:
        same = []
        one.visititems(lambda name, item: same.append(name) if isinstance(item, h5py.Dataset) else None)
        for name in same:
            assert np.array_equal(one[name][()], two[name][()]), name


def test_the_load_recorded_is_what_moved_the_body():
    # M dv = (weight + force) dt to round-off, in every step.
    world, state = begin(VISCOUS)
    pace, mass = Pace(world.model, state), world.arrays["mass"][0]
    for _ in range(10):
        before, t = state.v_WB[0].copy(), state.t
        pace.advance(world)
        force = world.wet_bodies.records.loads.total[0, :3]
        weight = mass * np.asarray(world.model.gravity)
        given = (state.t - t) * (force + weight)
        assert np.abs(mass * (state.v_WB[0] - before) - given).max() <= 1e-12 * np.abs(weight).max() * state.t


def explicit_tank(*units, **more):
    return tank(*units, xput="impmob=0, epsadj=1e-6,", **more)


def test_the_same_scene_told_in_another_way(monkeypatch):
    """A pushed ball and a floating box that begins to diverge, until then: other units, two threads, mirrored."""
    monkeypatch.setattr(team, "WORTHWHILE", 0)  # so that small jobs are shared too
    plain = play(explicit_tank(), 3)[1]
    assert np.array_equal(plain.v_WB, play(explicit_tank(), 3, threads=2)[1].v_WB)
    for size, time, mass in ((4.0, 2.0, 1.0), (0.5, 0.25, 64.0)):
        other = play(explicit_tank(size, time, mass), 3)[1]
        assert np.array_equal(other.v_WB, plain.v_WB * (size / time))
        assert np.array_equal(other.p_WB, plain.p_WB * size)
    mirrored = play(explicit_tank(mirrored=True), 3)[1]
    assert np.abs(plain.v_WB - mirrored.v_WB * [-1.0, 1.0, 1.0]).max() <= 1e-8


def test_swings_that_are_none():
    """Turns that die out, one blow, and growth to one side are not divergence; in any units."""
    a = np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
    for series in ([(-0.9) ** k for k in range(40)], [1, 1, 500, -60, 3, -1], [2.0**k for k in range(30)]):
        swing = Swing()
        assert not any(swing.grows(s * a, 0.0) for s in series)
    for unit in (2.0**-60, 1.0, 2.0**60):
        swing = Swing()
        found = [swing.grows((-1.5) ** k * unit * a, 0.5 * unit) for k in range(10)]
        assert found.index(True) == int(np.ceil(np.log(GROWN) / np.log(1.5)))
    swing = Swing()
    assert not any(swing.grows((-1.5) ** k * a, 1e9) for k in range(10))  # round-off may swing: less than gravity
