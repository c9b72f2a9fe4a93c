"""Bodies that leave the domain with the liquid."""

import numpy as np
import pytest
from flowgmo_wet import wet
from flowgmo_wet_bodies import play

SIDES = {
    "continuative": "ibct=6,3,1,1,2,5,",
    "outflow": "ibct=6,8,1,1,2,5,",
    "velocity": "ibct=6,6,1,1,2,5, ubct(1,2)=1., ihpbct(2)=1, flhtbct(1,2)=.4,",
    "pressure": "ibct=6,5,1,1,2,5, ihpbct(2)=1, flhtbct(1,2)=.4,",
}


@pytest.mark.parametrize("side", SIDES)
def test_a_floating_ball_goes_out_with_the_stream(side):
    """Half under water, half as heavy, with a stream of 1 m/s through the side. What lay outside was not pressed: it
    left with 2.81, 2.72, 2.31, 1.82 m/s. Measured .87, .89, 1.12, 1.07."""
    text = wet(
        "twfin=.45, delt=.004, itb=1, ipdis=1, gz=-9.81, imobs=1, iclid=1, strngmob=.5, frcmob=.2,",
        mesh="px=0.,1., py=0.,.5, pz=0.,.6, nxcelt=20, nycelt=10, nzcelt=12,",
        fl="flht=.4, nfls=1, fxl(1)=0., fzh(1)=.4, ureg(1)=1.,",
        bcdata=SIDES[side] + " ubct(1,1)=1., ihpbct(1)=1, flhtbct(1,1)=.4,",
        obs="nobs=1, obsid(1)='ball', imo(1)=4, rhomvb(1)=500., iob(1)=1, rsh(1)=.1, trnx(1)=.75, trny(1)=.25, "
        "trnz(1)=.4, utobs(1,1)=1.,",
    )  # fmt: skip
    rows = []
    play(text, 1000, each=lambda world, state, report: rows.append((*state.p_WB[0], *state.v_WB[0])))
    rows = np.array(rows)
    inside, out = rows[rows[:, 0] < 0.88], rows[rows[:, 0] > 1.1]
    assert np.abs(inside[:, 3] - 1.0).max() <= 0.15
    assert len(out) and 0.75 <= out[0, 3] <= 1.25 and np.abs(out[:, 4]).max() <= 0.1


def test_half_a_body_outside_is_pressed_on_both_sides():
    """A ball held across an open side in still water: no force along the side's normal; measured 3e-12 of its buoyancy,
    where the water inside had pushed as hard as .76 of it."""
    text = wet(
        "twfin=.1, delt=.004, itb=1, ipdis=1, gz=-9.81, imobs=1,", fl="flht=.4,",
        mesh="px=0.,1., py=0.,.5, pz=0.,.6, nxcelt=20, nycelt=10, nzcelt=12,",
        bcdata="ibct=2,5,1,1,2,1, ihpbct(2)=1, flhtbct(1,2)=.4,",
        obs="nobs=1, obsid(1)='ball', imo(1)=3, iob(1)=1, rsh(1)=.1, trnx(1)=.983, trny(1)=.237, trnz(1)=.27,",
    )  # fmt: skip
    world, _ = play(text, 10)
    force = world.wet_bodies.records.loads.total[0, :3]
    assert abs(force[0]) <= 1e-6 * abs(force[2]) and force[2] > 0.0
