"""Bodies in liquid that reach their stops, and leave them."""

import numpy as np
import pytest
from flowgmo_wet import wet
from flowgmo_wet_bodies import play

FLAP = (
    "nobs=1, obsid(1)='flap', imo(1)=4, imoaxs(1)=2, xaxs0(1)=.4, yaxs0(1)=.01, zaxs0(1)=.28, rhomvb(1)=4500., "
    "iob(1)=1, xl(1)=.38, xh(1)=.42, zl(1)=.06, zh(1)=.28, yl(1)=0., yh(1)=.02, anglmin(1)=10., anglmax(1)=10.,\n"
    "igf(1)=1, tobs(1)=0., tobs(2)=.2, tobs(3)=.201, tytobs(1,1)=-1.5, tytobs(2,1)=-1.5, tytobs(3,1)=0.,"
)


@pytest.mark.parametrize("collisions", ["", "iclid=1,"])
def test_a_flap_comes_back_from_its_stop(collisions):
    """A torque lifts it by 10 degrees until t = .2, then its weight brings it back. Without contact engine it stayed at
    its stop for ever: bodies fly without weight and loads there, so that nothing ever pulled. Measured: both at
    9.2 degrees at t = .3 to 2 %, on their way to swing through 0."""
    text = wet(
        f"twfin=.3, delt=.002, itb=0, imobs=1, gz=-9.81, ipdis=1, {collisions}", fl="",
        mesh="px=0.,.8, nxcelt=40, py=0.,.02, nycelt=1, pz=0.,.3, nzcelt=15,",
        bcdata="ibct(1)=5, ibct(2)=5, ibct(3)=1, ibct(4)=1, ibct(5)=2, ibct(6)=2,", obs=FLAP,
    )  # fmt: skip
    angles = []
    play(text, 2000, each=lambda world, state, report: angles.append((state.t, float(np.degrees(state.angle[0])))))
    angles = np.array(angles)
    at_stop = (angles[:, 0] > 0.15) & (angles[:, 0] < 0.2)
    assert np.abs(angles[at_stop, 1] + 10.0).max() <= 1e-9
    assert -9.9 < angles[-1, 1] < -8.0
