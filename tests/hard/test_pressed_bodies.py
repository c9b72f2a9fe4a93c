"""Bodies that the liquid can hardly follow: closed chambers, jumps of prescribed velocity."""

import json

import numpy as np
import pytest
from flowgmo_wet import wet
from flowgmo_wet_bodies import model_of, play
from flowgmo_wet_runs import CLOSED

from flowgmo.run import DONE, FAILED, run

PISTON = (
    "nobs=1, obsid(1)='piston', imo(1)=3, iob(1)=1, xl(1)=.3, xh(1)=.425, yl(1)=-.1, yh(1)=.35, zl(1)=-.1, zh(1)=.35,"
    "utobs(1,1)={speed},"
)
DUCT = "px=0.,1., nxcelt=16, py=0.,.25, nycelt=4, pz=0.,.25, nzcelt=4,"


def duct(speed=0.1, props="rhof=1000.,", bcdata=CLOSED):
    xput = "twfin=.05, delt=.002, itb=0, gz=-9.81, imobs=1,"
    return wet(xput, props=props, fl="", mesh=DUCT, bcdata=bcdata, obs=PISTON.format(speed=speed))


@pytest.mark.parametrize(("speed", "place"), [(0.1, "x = 0.375 to 1"), (-0.1, "x = 0 to 0.3125")])
def test_a_piston_in_a_closed_duct_is_told(speed, place, tmp_path):
    """Which body, what it does, which chamber and how large it is, what to write."""
    assert run(model_of(duct(speed)), tmp_path / "r", None, "test") == FAILED
    reason = json.loads((tmp_path / "r" / "run.json").read_text())["reason"]
    for part in ("body piston presses liquid together", place, "cells", "opening", "rcsql"):
        assert part in reason, reason


@pytest.mark.parametrize("kind", [3, 8])
def test_a_chamber_that_lets_out_is_not_the_one_named(kind, tmp_path):
    """The liquid before the piston leaves through Xmax; that behind it has no way in."""
    text = duct(bcdata=CLOSED.replace("(2)=2", f"(2)={kind}"))
    assert run(model_of(text), tmp_path / "r", None, "test") == FAILED
    reason = json.loads((tmp_path / "r" / "run.json").read_text())["reason"]
    assert "body piston pulls liquid apart" in reason and "x = 0 to 0.3125" in reason, reason


@pytest.mark.filterwarnings("ignore::RuntimeWarning")  # as the command line does
def test_a_velocity_near_the_largest_number(tmp_path):
    """Steps of 0 did not advance the clock, and something divided by them."""
    assert run(model_of(duct(1e308)), tmp_path / "r", None, "test") == FAILED
    reason = json.loads((tmp_path / "r" / "run.json").read_text())["reason"]
    assert "dtmin" in reason and "bodies" in reason, reason


@pytest.mark.parametrize(
    "scene",
    [{"props": "rhof=1000., rcsql=1e-9,"}, {"bcdata": CLOSED.replace("(1)=2", "(1)=5").replace("(2)=2", "(2)=5")}],
)
def test_with_an_opening_or_liquid_that_gives_way_it_runs(scene, tmp_path):
    """And the pressure of the closed chamber is what its volume lost divided by beta, to a tenth (waves)."""
    text = duct(**scene)
    assert run(model_of(text), tmp_path / "r", None, "test") == DONE
    if "props" in scene:
        world, state = play(text, 40)
        lost = 0.1 * state.t / (1.0 - 0.425)  # of the chamber's length
        assert state.fluid.p[-3, 3, 3] == pytest.approx(lost / 1e-9, rel=0.1)


JUMPS = (
    "tobs(1)=0.,.02,.0201, utobs(1,1)=0.,0.,3.",
    "tobs(1)=0.,.02,.021,.024,.025, utobs(1,1)=0.,0.,9.,9.,0.",
)


@pytest.mark.parametrize("table", JUMPS)
def test_a_jump_of_velocity_shortens_the_step(table):
    """The step is tried again until no point crosses a cell, and the run goes on; in the second table the velocity is
    over at the step's end, so that only the way tells."""
    body = "nobs=1, imo(1)=3, iob(1)=1, rsh(1)=.1, trnx(1)=.3, trny(1)=.25, trnz(1)=.25, "
    mesh = "px=0.,1., nxcelt=20, py=0.,.5, nycelt=10, pz=0.,.5, nzcelt=10,"
    text = wet(
        "twfin=.1, delt=.015, itb=1, ipdis=1, gz=-9.81, imobs=1,", fl="flht=.3,", mesh=mesh, bcdata=CLOSED,
        obs=body + table,
    )  # fmt: skip
    ways = []
    places = [np.array([0.3, 0.25, 0.25])]

    def each(world, state, report):
        ways.append(float(np.abs(state.p_WB[0] - places[-1]).max()))
        places.append(state.p_WB[0].copy())

    world, state = play(text, 12, each=each)
    assert world.liquid.tally.shortened > 0 and max(ways) > 0.005
    assert max(ways) <= 0.05 * (1.0 + 1e-9)
    assert np.isfinite(state.fluid.p).all()
