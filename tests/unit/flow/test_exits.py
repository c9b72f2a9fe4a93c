"""Continuative and outflow sides of a full domain let out what comes in."""

import numpy as np
import pytest
from flowgmo_wet import wet
from flowgmo_wet_runs import advance, start

REAL = (slice(2, -2),) * 3


def stream(sides, obs="", mesh="px=0., 2., nxcelt=16, py=0., .5, nycelt=4, pz=0., 1., nzcelt=8,", **more):
    return wet(
        "twfin=5., delt=.01, itb=0, ifvisc=1,", props="rhof=1., mu1=.02,", fl="ui=1., wi=.2,", mesh=mesh,
        bcdata=f"{sides}, ubct(1,1)=1.,", obs=obs, **more,
    )  # fmt: skip


def outflow(flow, liquid):
    """Volume a unit of time through Xmin and Xmax."""
    area = np.multiply.outer(liquid.grid.dy[2:-2], liquid.grid.dz[2:-2])
    Ax = liquid.openings.Ax
    layers = (1, flow.u.shape[0] - 3)
    return [float((flow.u[n, 2:-2, 2:-2] * area * (1.0 if Ax is None else Ax[n, 2:-2, 2:-2])).sum()) for n in layers]


@pytest.mark.parametrize("kind", [3, 8])
def test_what_comes_in_goes_out(kind):
    """Past a block, until its wake has crossed the side: inflow .5, outflow the same to the tolerance. Without it the
    run stops: liquid is pressed together."""
    block = "nobs=1, iob(1)=1, xl(1)=.5, xh(1)=.83, zl(1)=-1., zh(1)=.44,"
    liquid, flow, first = start(stream(f"ibct=6,{kind},1,1,2,2", obs=block))
    advance(liquid, flow, first, end=4.0)
    into, out = outflow(flow, liquid)
    assert into == pytest.approx(out, rel=1e-6)
    assert np.isfinite(flow.u).all() and np.abs(flow.u).max() < 5.0


def test_each_region_through_its_own_exit():
    """A wall along the stream makes two channels, .4375 and .5 high: each lets out what it takes in."""
    wall = "nobs=1, iob(1)=1, zl(1)=.4375, zh(1)=.5,"
    mesh = "px=0., 2., nxcelt=16, py=0., .5, nycelt=4, pz=0., 1., nzcelt=16,"
    liquid, flow, first = start(stream("ibct=6,8,1,1,2,2", obs=wall, mesh=mesh))
    advance(liquid, flow, first, end=1.0)
    last = flow.u.shape[0] - 3
    for layers, height in ((slice(2, 9), 0.4375), (slice(10, 18), 0.5)):
        assert flow.u[last, 2:-2, layers].mean(axis=0).sum() / 16.0 == pytest.approx(height, rel=1e-6)


def test_an_even_stream_stays_even():
    """Nothing is taken from or added to a stream that fits: u = 1 on every face, to round-off."""
    text = stream("ibct=6,8,1,1,1,1").replace("wi=.2", "wi=0.")
    liquid, flow, first = start(text)
    advance(liquid, flow, first, most=20)
    assert np.abs(flow.u[REAL] - 1.0).max() <= 1e-12
