"""Impacts cut steps short: which of them do, and how the next steps go on."""

from pathlib import Path

import numpy as np
import pytest
from flowgmo_wet import wet
from flowgmo_wet_bodies import begin, tank
from flowgmo_wet_runs import CLOSED

from flowgmo.errors import StepTooLong
from flowgmo.pace import Pace
from flowgmo.step import poses_of, step

LEAVE = Path(__file__).parents[3] / "decks" / "hard" / "wet_leave.nml"


def test_steps_go_on_from_what_was_allowed_before_an_impact():
    """A ball and a box that hop over the bed of a stream: 97 steps, each after a cut one as long as the one before it
    might have been, or as the flow at its begin allows; twice as many when steps grow again from the cut ones. Without
    an end where an impact in the last hundredth of a step shortens it by a part of 3e-15, again and again."""
    world, state = begin(LEAVE.read_text())
    pace = Pace(world.model, state)
    tries, regained = 0, []
    while state.t < world.model.clock.end and tries < 1000:
        before, cut = state.t, state.fluid.dt < 0.5 * state.fluid.pace
        allowed = state.fluid.pace
        pace.advance(world)
        tries += 1 + pace.cuts
        pace.cuts = 0
        if cut and state.fluid.pace == state.t - before:
            regained.append(1.0 if pace.bounded_by == "flow" else state.fluid.dt / allowed)
    assert state.t == world.model.clock.end
    assert state.step <= 150
    assert len(regained) >= 3
    assert min(regained) >= 0.8  # measured 1; .1 to .5 where steps grow from the cut ones


def reached(world, state, dt):
    """The Courant number of a step of dt, which is not made: the state stays."""
    t1 = state.t + dt
    keep = {name: getattr(state.fluid, name) for name in ("u", "v", "w", "p")}
    copies = {name: a.copy() for name, a in keep.items()}

    def stop(*_):
        raise StepTooLong("as asked")

    settle, world.wet_bodies.finish = world.wet_bodies.finish, stop
    with pytest.raises(StepTooLong):
        step(world, state, t1, np.zeros(0), landing=False)
    world.wet_bodies.finish = settle
    for name, a in copies.items():
        keep[name][...] = a
    return world.liquid.courant


def test_the_pressure_of_a_tiny_step_does_not_drive_a_long_one():
    """A ball and a box in a tank, a step of a ten-thousandth, then a long one: its Courant number is as after a long
    one, .2 % off (measured); 7140 where the first stage is pushed by the pressure of the tiny step."""
    world, state = begin(tank())
    pace = Pace(world.model, state)
    for _ in range(12):
        pace.advance(world)
    dt = 0.5 * state.fluid.dt
    plain = reached(world, state, dt)
    step(world, state, state.t + 1e-4 * dt, np.zeros(0), landing=False)
    assert abs(reached(world, state, dt) - plain) <= 0.02 * plain


def thrown(speed, approach):
    """A ball a hundredth of a cell over the bed, under water, that goes along it and comes down."""
    obs = (
        f"nobs=1, obsid(1)='ball', imo(1)=4, rhomvb(1)=2000., iob(1)=1, rsh(1)=.1, trnx(1)=.4, trny(1)=.3, "
        f"trnz(1)=.1005, utobs(1,1)={speed!r}, wtobs(1,1)={-approach!r},"
    )
    return wet(
        "twfin=1., delt=.01, itb=1, ipdis=1, imobs=1, iclid=1, strngmob=.5, gz=-9.81,", props="rhof=1000.,",
        mesh="px=0., 1., nxcelt=20, py=0., .6, nycelt=12, pz=0., .6, nzcelt=12,", bcdata=CLOSED, obs=obs, fl="flht=.4,",
    )  # fmt: skip


@pytest.mark.parametrize(("approach", "cuts"), [(0.06, False), (0.5, True)])
def test_only_blows_cut_a_step(approach, cuts):
    """A ball that touches the bed within the step while it goes along it with 2 m/s, of cells of .05 m: with .06 m/s it
    would be led astray by .4 % of a cell and the step goes on, with .5 m/s by 3 %. By its speed alone either cuts."""
    world, state = begin(thrown(2.0, approach))
    world.liquid.projector.ease = 0.01
    world.wet_bodies.liquid.projector.ease = 0.01
    end = 0.0005 / approach + 0.0016

    def foresee():
        world.wet_bodies.impacts.foresee(world, state, poses_of(state), end)

    if cuts:
        with pytest.raises(StepTooLong, match="will be hit"):
            foresee()
    else:
        foresee()
