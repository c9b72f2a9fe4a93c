"""Liquid where programs fail: full boxes, quiet sides, free fall, streams that start dry or stop at once."""

import numpy as np
import pytest
from flowgmo_wet import wet
from flowgmo_wet_runs import CLOSED, REAL, advance, fastest, start

XPUT = "twfin=2., delt=.005, itb=1, gz=-10.,"
MESH = "px=0., 1., nxcelt=10, py=0., .8, nycelt=8, pz=0., 1.2, nzcelt=12,"
OVER = 1e-5  # of a cell. Measured: 1.4e-6 in all scenes; a pressure of a cell that is dry by now gave 1e-2


def sides(low, high, more=""):
    return CLOSED.replace("(1)=2", f"(1)={low}").replace("(2)=2", f"(2)={high}") + more


def held(low, high, stream=False):
    """Pressure sides under given heights."""
    more = f"ihpbct(1)=1, ihpbct(2)=1, flhtbct(1,1)={low}, flhtbct(1,2)={high},"
    return sides(5, 5, more + ("ipbctp(1)=0, ipbctp(2)=0," if stream else ""))


@pytest.mark.parametrize("level", [0.6, 0.63, 0.68, 1.12, 1.17, 1.2])
def test_still_water_stays_still(level):
    """Up to a level in the top row under the lid, and full. Measured: 3e-12."""
    liquid, flow, first = start(wet(XPUT + "ipdis=1,", fl=f"flht={level},", mesh=MESH, bcdata=CLOSED))
    advance(liquid, flow, first, end=1.0)
    assert fastest(flow) <= 1e-9


def test_full_without_a_surface_stays_still():
    liquid, flow, first = start(wet("twfin=2., delt=.005, gz=-10., ipdis=1,", fl="", mesh=MESH, bcdata=CLOSED))
    advance(liquid, flow, first, end=1.0, most=50)
    assert fastest(flow) <= 1e-9


@pytest.mark.parametrize("level", [0.6, 0.63, 0.68])
def test_still_water_between_sides_of_its_own_height(level):
    """Measured: 2e-12. A side's pressure that is not that of the cells' centres drives a current at once."""
    text = wet(XPUT + "ipdis=1,", fl=f"flht={level},", mesh=MESH, bcdata=held(level, level))
    liquid, flow, first = start(text)
    advance(liquid, flow, first, end=1.0)
    assert fastest(flow) <= 1e-9
    assert np.abs(flow.passed).max() <= 1e-9


def test_free_fall():
    """A block in the air gains g t and nothing else. Measured: 4e-16 g t. Two cells from all walls."""
    mesh = "px=0., 1., nxcelt=10, py=0., .8, nycelt=8, pz=0., 1.6, nzcelt=16,"
    block = "flht=-1., nfls=1, fxl(1)=.3, fxh(1)=.7, fyl(1)=.3, fyh(1)=.6, fzl(1)=1., fzh(1)=1.3,"
    liquid, flow, first = start(wet(XPUT, fl=block, mesh=mesh, bcdata=CLOSED))

    def check(t, flow):
        held = flow.F[REAL] > 1e-9
        assert np.abs(flow.w[REAL][held] + 10.0 * t).max() <= 1e-12 * 10.0 * t
        assert max(np.abs(flow.u[REAL]).max(), np.abs(flow.v[REAL]).max()) <= 1e-12

    advance(liquid, flow, first, end=0.25, each=check)


TABLE = "timbct(1)=0., timbct(2)=.5, timbct(3)=.501, timbct(4)=9.,"
STOPS = TABLE + "".join(f"ubct({n},1)={u}, flhtbct({n},1)=.25," for n, u in ((1, 1.0), (2, 1.0), (3, 0.0), (4, 0.0)))
STREAMS = {  # level, sides, end, fastest that the head allows
    "dry start with inflow": (-1.0, sides(6, 8, "ubct(1,1)=1., flhtbct(1,1)=.25,"), 2.0, 8.0),
    "inflow stops at once": (0.25, sides(6, 8, STOPS), 1.5, 8.0),
    "outlet of no pressure": (0.53, sides(2, 5), 2.0, 8.0),
    "heights, at rest outside": (0.63, held(0.75, 0.5), 2.0, 8.0),
    "heights, stream outside": (0.63, held(0.75, 0.5, stream=True), 0.7, 8.0),
}


@pytest.mark.parametrize("name", STREAMS)
def test_streams_stay_bounded_and_keep_their_books(name):
    """Measured: fastest 1.2 to 5.5 of the sqrt(g) = 3.2 of a metre's head. A side that feeds itself gave 1e100."""
    level, bcdata, end, most = STREAMS[name]
    liquid, flow, first = start(wet(XPUT, fl=f"flht={level},", mesh=MESH, bcdata=bcdata))
    _, over, books = advance(liquid, flow, first, end=end)
    assert fastest(flow) <= most
    assert over <= OVER
    assert books <= 1e-12
