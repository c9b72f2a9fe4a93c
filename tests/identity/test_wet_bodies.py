"""Bodies that move in liquid, told in another way: with more threads, in other units, mirrored, with a pause."""

import signal

import h5py
import numpy as np
import pytest
from flowgmo_wet import wet
from flowgmo_wet_bodies import model_of, play, tank
from flowgmo_wet_runs import CLOSED, REAL

import flowgmo.flow.team
import flowgmo.step
from flowgmo.flow.solid_lines import SolidLines
from flowgmo.run import DONE, INTERRUPTED, run

STEPS = 20


def arrays(state):
    flow = state.fluid
    return [*(a for a in (flow.u, flow.v, flow.w, flow.p, flow.F) if a is not None), *bodies(state)]


def bodies(state):
    return [state.p_WB, state.q_WB, state.v_WB, state.w_WB]


@pytest.fixture(scope="module")
def plain():
    return play(tank(), STEPS)[1]


def test_two_threads_are_one_bit_for_bit(plain, monkeypatch):
    monkeypatch.setattr(flowgmo.flow.team, "WORTHWHILE", 0)  # so that small jobs are shared too
    for a, b in zip(arrays(plain), arrays(play(tank(), STEPS, threads=2)[1]), strict=True):
        assert np.array_equal(a, b)


@pytest.mark.parametrize("bodies", ["ball", "box"])
def test_open_fractions_of_lines_without_bodies_need_not_be_read(bodies, monkeypatch):
    world, state = play(tank(bodies=bodies), STEPS)
    near = world.liquid.lines != 0
    closed = np.any([(a < 1.0).any(axis=2) for a in world.liquid.openings], axis=0)
    assert near[closed].all() and not near.all()
    monkeypatch.setattr(SolidLines, "of", lambda self, opened: np.ones(opened.V.shape[:2], np.int8))
    _, all_read = play(tank(bodies=bodies), STEPS)
    for a, b in zip(arrays(state), arrays(all_read), strict=True):
        assert np.array_equal(a, b)


@pytest.mark.parametrize(("size", "time", "mass"), [(4.0, 2.0, 1.0), (0.5, 0.25, 64.0), (1024.0, 1 / 32, 1 / 8)])
def test_powers_of_two_give_the_same_bits(plain, size, time, mass):
    state = play(tank(size, time, mass), STEPS)[1]
    speed = size / time
    assert state.t / time == plain.t
    assert np.array_equal(state.q_WB, plain.q_WB)
    assert np.array_equal(state.p_WB, plain.p_WB * size)
    assert np.array_equal(state.v_WB, plain.v_WB * speed)
    assert np.array_equal(state.w_WB, plain.w_WB / time)
    assert np.array_equal(state.fluid.F, plain.fluid.F)
    assert np.array_equal(state.fluid.u, plain.fluid.u * speed)
    assert np.array_equal(state.fluid.p, plain.fluid.p * (mass / (size * time**2)))


@pytest.mark.parametrize(("scene", "most"), [("pushed, full", 1e-10), ("floats", 1e-8), ("both", 1e-8)])
def test_mirrored_is_mirrored(scene, most):
    """Measured in F 0, 6e-13, 8e-13, in v 7e-15, 2e-13, 2e-13, of bodies 0, 7e-16, 2e-15. Without surface_normals.TIE
    5e-7 in F of `floats`, without covered_cells.TOUCH (a cell with V = 1 - 6e-16 is one that a wall cuts) 8e-4 in
    `both`. A body that closes its cells in an order, or a cell that opens without a past, gives 5e-5 in v within six
    steps of
    `pushed`."""
    of = {"pushed, full": {"bodies": "ball", "full": True}, "floats": {"bodies": "box"}, "both": {}}[scene]
    tight = "epsadj=1e-8,"
    one = play(tank(xput=tight, **of), STEPS)[1]
    two = play(tank(xput=tight, mirrored=True, **of), STEPS)[1]
    turn = np.array([-1.0, 1.0, 1.0])
    assert np.abs(one.p_WB - two.p_WB * turn - [1.0, 0.0, 0.0]).max() <= 1e-8
    assert np.abs(one.v_WB - two.v_WB * turn).max() <= 1e-8
    assert np.abs(one.w_WB + two.w_WB * turn).max() <= 1e-8
    for name in ("v", "w"):
        here, there = getattr(one.fluid, name)[REAL], getattr(two.fluid, name)[REAL][::-1]
        wet_cells = True if one.fluid.F is None else one.fluid.F[REAL] > 0.01
        assert (np.abs(here - there) * wet_cells).max() <= 10.0 * most
    if one.fluid.F is not None:
        assert np.abs(one.fluid.F[REAL] - two.fluid.F[REAL][::-1]).max() <= most


def pair(unit=1.0, order="ab", mirrored=False):
    """A ball that meets a heavier box under water, half as heavy as water and 1.5 times; unit: of length, in metres."""
    x, side = (1.0, -1.0) if mirrored else (0.0, 1.0)
    m = 1.0 / unit

    def at(value):
        return repr((x + side * value) * m)

    parts = {
        "a": f"obsid(#)='a',imo(#)=4, rhomvb(#)={500.0 * unit**3!r}, iob(#)=#, rsh(#)={0.1 * m!r}, trnx(#)={at(0.36)}, "
        f"trny(#)={0.25 * m!r}, trnz(#)={0.3 * m!r}, utobs(1,#)={side * 2.5 * m!r},",
        "b": f"obsid(#)='b',imo(#)=4, rhomvb(#)={1500.0 * unit**3!r}, iob(#)=#, xl(#)={-0.1 * m!r}, xh(#)={0.1 * m!r}, "
        f"yl(#)={-0.08 * m!r}, yh(#)={0.08 * m!r}, zl(#)={-0.07 * m!r}, zh(#)={0.07 * m!r}, roty(#)={side * 10.0!r}, "
        f"trnx(#)={at(0.6)}, trny(#)={0.25 * m!r}, trnz(#)={0.3 * m!r},",
    }  # fmt: skip
    return wet(
        f"twfin=.15, delt=.004, itb=1, ipdis=1, gz={-9.81 * m!r}, imobs=1, iclid=1, strngmob=.5, frcmob=.2, "
        "epsadj=1e-6,",
        props=f"rhof={1000.0 * unit**3!r},", bcdata=CLOSED, fl=f"flht={0.4 * m!r},",
        mesh=f"px=0.,{1.0 * m!r}, py=0.,{0.5 * m!r}, pz=0.,{0.6 * m!r}, nxcelt=20, nycelt=10, nzcelt=12,",
        obs="nobs=2,\n" + "\n".join(parts[name].replace("#", str(n)) for n, name in enumerate(order, start=1)),
    )  # fmt: skip


@pytest.fixture(scope="module")
def met():
    return play_pair(pair())


def play_pair(text):
    """(state at .15 s, impacts) of `pair`."""
    impacts = []
    _, state = play(text, 1000, each=lambda world, state, report: impacts.extend(report.impacts))
    return state, impacts


@pytest.mark.parametrize(
    ("told", "bound"),
    [({"unit": 0.01}, 1e-11), ({"order": "ba"}, 1e-9), ({"mirrored": True}, 1e-7)],
    ids=["centimetres", "renumbered", "mirrored"],
)
def test_an_impact_under_water_is_the_same_however_it_is_told(met, told, bound):
    """Positions after .15 s, the impact at .03 s: measured 3e-13, 4e-11, 6e-9 m. In other order 9e-5 before: a wall
    that passes a face at once took what the walls of all bodies had left there."""
    state, (impact,) = met
    other, (same,) = play_pair(pair(**told))
    places, unit = other.p_WB, told.get("unit", 1.0)
    places = places[::-1] if told.get("order") else places
    places = places * unit
    if told.get("mirrored"):
        places = [1.0, 0.0, 0.0] + [-1.0, 1.0, 1.0] * places
    assert np.abs(places - state.p_WB).max() <= bound
    assert same["time"] == pytest.approx(impact["time"], rel=1e-9)
    assert abs(np.linalg.norm(same["impulse"]) * unit - np.linalg.norm(impact["impulse"])) <= 1e-6


def contents(path):
    """All datasets of a file."""
    found = {}
    with h5py.File(path) as file:
        file.visititems(lambda name, item: found.update({name: item[()]}) if isinstance(item, h5py.Dataset) else None)
    return found


def same(one, two):
    a, b = contents(one), contents(two)
    assert a.keys() == b.keys()
    for name in a:
        assert np.array_equal(a[name], b[name]), name


def test_no_velocity_is_kept_where_a_body_was():
    """Closed faces have the body's velocity, in the air too. Where it had been its old velocities stayed behind, in one
    of two arrays that take turns: a restart did not know them."""
    text, shown = tank(bodies="box").replace("zh(1)=0.09375", "zh(1)=0.22, utobs(1,1)=-2."), 0  # a tall one

    def look(world, state, report):
        nonlocal shown
        liquid, near = world.liquid, np.zeros(world.liquid.shape, bool)
        for i, j, low, high in liquid.held[0]:  # of the step just made
            near[i, j, low:high] = True
        for u, held in zip(state.fluid.velocity, liquid.immersed.held, strict=True):
            known = near.copy()
            known.reshape(-1)[held[0]] = True
            shown += int(known.sum() - near.sum())
            assert not u[REAL][~known[REAL]].any()

    play(text, 30, each=look)
    assert shown > 20  # faces of the body in the air; 32 in the first steps, before water is thrown up


OUTPUT = "tpltd(1)=.13, tapltd(1)=.05, thpltd(1)=.017,"
SCENES = {
    "pushed, full": tank(output=OUTPUT, bodies="ball", full=True),
    "leaves": tank(output=OUTPUT, bodies="box").replace("roty(1)", "wtobs(1,1)=3., roty(1)"),  # the water
    "oil": tank(output=OUTPUT, bodies="box", xput="ifvisc=1, iwsh=1,").replace("rhof=1000.0,", "rhof=1000., mu1=8.,"),
    "both": tank(output=OUTPUT, grafic="xloc(1)=.41, yloc(1)=.35, zloc(1)=.31,", flowgmo="planex(1)=.5,"),
}


@pytest.mark.parametrize("scene", SCENES)
def test_interrupted_and_continued_is_the_run_without_a_stop(scene, tmp_path, monkeypatch):
    original, count = flowgmo.step.step, [0, -1]

    def step(*args):
        count[0] += 1
        if count[0] == count[1]:
            signal.raise_signal(signal.SIGINT)
        return original(*args)

    monkeypatch.setattr(flowgmo.step, "step", step)
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    text = SCENES[scene].replace("twfin=2.0", "twfin=.2")
    assert run(model_of(text), whole, None, "test") == DONE
    restart = None
    for n in (1, 5, 3):
        count[:] = [0, n]
        assert run(model_of(text), parts, restart, "test") == INTERRUPTED
        restart = parts / "restart.h5"
    count[:] = [0, -1]
    assert run(model_of(text), parts, restart, "test") == DONE
    for name in ("history.h5", "restart.h5", "fields.h5"):
        same(whole / name, parts / name)
