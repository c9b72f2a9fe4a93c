"""Friction on stationary bodies, as it is recorded."""

import numpy as np
import pytest
from flowgmo_wet import wet
from flowgmo_wet_runs import advance, start

from flowgmo.flow.observe.shear_of_solids import shear_of_solids

PLANES = [np.linspace(0.0, 1.0, 9), np.linspace(0.0, 0.5, 5), np.linspace(0.0, 1.0, 17)]


def channel(obs, xput="", nz=16):
    """Liquid of nu = 1 along x, driven by g = 1, between what the obstacles leave open; periodic in x and y."""
    return wet(
        f"twfin=1., delt=.0005, itb=0, ifvisc=1, gx=1., {xput}", props="rhof=2., mu1=2.,", fl="",
        mesh=f"px=0., 1., nxcelt=8, py=0., .5, nycelt=4, pz=0., 1., nzcelt={nz},",
        bcdata="ibct=4,4,4,4,2,2,", obs=obs,
    )  # fmt: skip


def forces(text):
    """Body number -> (force (3,), torque (3,) about the origin) when the flow is steady."""
    liquid, flow, first = start(text)
    advance(liquid, flow, first, end=1.5)  # the slowest mode is down to exp(-pi^2 1.5) = 4e-7
    found = {}
    for number, shear in shear_of_solids(liquid, PLANES).items():
        places, each = shear(flow)
        found[number] = each.sum(axis=0), np.cross(places, each).sum(axis=0)
    return found


def test_walls_hold_the_weight_of_the_liquid():
    """Two plates that end inside cells, .7 apart: each holds half of rho g V = .7. Measured .35 to 3e-14; a
    sliver (V .04) whose wall does not hold against gravity, or a face booked twice, gives some per cent."""
    found = forces(channel("nobs=2, iob(1)=1, zh(1)=.11, iob(2)=2, zl(2)=.81,"))
    for number, z in ((1, 0.11), (2, 0.81)):
        force, torque = found[number]
        assert force == pytest.approx([0.35, 0.0, 0.0], abs=1e-9)
        assert torque[1] == pytest.approx(0.35 * z, abs=0.35 / 16)  # at the faces beside the wall, within a cell of it
        assert abs(torque[2]) == pytest.approx(0.35 * 0.25, rel=1e-3)  # in the middle of y


def test_bodies_side_by_side_share_a_wall():
    """The lower plate as two bodies, .125 and .375 wide: they hold it in proportion.

    Measured to 6e-5 and 1.3 %: where two bodies touch, the fractions leave a notch of .02 of a cell."""
    one, two = "iob(1)=1, zh(1)=.11, yh(1)=.125,", "iob(2)=2, zh(2)=.11, yl(2)=.125,"
    found = forces(channel(f"nobs=3, {one} {two} iob(3)=3, zl(3)=.81,"))
    narrow, wide, upper = (found[n][0][0] for n in (1, 2, 3))
    assert narrow + wide == pytest.approx(upper, rel=1e-3)
    assert narrow / wide == pytest.approx(1.0 / 3.0, rel=0.02)


def test_walls_that_do_not_hold_have_none():
    liquid, _, _ = start(channel("nobs=1, iob(1)=1, zh(1)=.11,", xput="iwsh=0,"))
    assert shear_of_solids(liquid, PLANES) == {}
