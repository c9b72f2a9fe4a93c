"""Decks with bodies in liquid that a search over combinations found to break flowgmo, reduced; each failed before."""

import numpy as np
import pytest
from flowgmo_wet import wet
from flowgmo_wet_bodies import play
from flowgmo_wet_runs import CLOSED

XPUT = "twfin=1., delt=.002, itb=1, ipdis=1, gz=-9.81, imobs=1, iclid=1,"
CUBE = "px=0.,1., nxcelt=10, py=0.,1., nycelt=10, pz=0.,1., nzcelt=10,"
BALL = "nobs=1, imo(1)=4, rhomvb(1)={}, iob(1)=1, rsh(1)=.15, trnx(1)=.5, trny(1)=.5, trnz(1)={}, wtobs(1,1)={},"


@pytest.mark.parametrize(("density", "speed", "most"), [(500.0, 1.0, 42), (2000.0, 3.0, 25)])
def test_a_ball_that_hits_the_lid_of_a_full_tank(density, speed, most):
    """e = 1: it comes back no faster than it came. Full, but with `itb=1`.

    Measured: 1.0779 and -1.0770 m/s, as with `itb=0`. The pressure of the whole tank, which nothing determines, pushed
    the ball, which touched the lid, back with 4.1 m/s: kinetic energy 158 J after 10.
    """
    found = []
    text = wet(XPUT, fl="flht=1.,", mesh=CUBE, bcdata=CLOSED, obs=BALL.format(density, 0.7, speed))
    play(text, most, each=lambda world, state, report: found.append(state.v_WB[0, 2]))
    v = np.array(found)
    hit = int(np.flatnonzero(v < 0.0)[0])
    assert -1.02 * v[:hit].max() <= v[hit:].min() <= -0.9 * v[hit - 1]


@pytest.mark.parametrize("implicit", [0, 1])
def test_a_dry_body_near_viscous_liquid(implicit):
    """Along some direction its walls touch no liquid: no friction there. It was a traceback (largest arm of no face).

    Measured: .23 % less than free fall (2e-16 without viscosity), as cells of the surface lie beside its lowest ones,
    .8 of a cell above; a cell higher 1.7e-6."""
    xput = XPUT + f"ifvisc=1, impvis={implicit},"
    obs = BALL.format(500.0, 0.66, 0.0)
    world, state = play(wet(xput, "rhof=1000., mu1=1.,", "flht=.43,", CUBE, bcdata=CLOSED, obs=obs), 6)
    assert abs(state.v_WB[0, 2] + 9.81 * state.t) <= 0.004 * 9.81 * state.t


@pytest.mark.parametrize(("x", "y"), [(0.45, 0.31), (0.46, 0.3), (0.46, 0.31)])
def test_an_upright_box_afloat_stays_upright(x, y):
    """Half as heavy as water, its edges between planes of the mesh. Measured: 1e-11 rad/s after 15 steps; where arms
    end at the centres of cells .4 (it is hardly stable)."""
    mesh = "px=0.,.9, nxcelt=24, py=0.,.6, nycelt=16, pz=0.,.75, nzcelt=20,"
    obs = (
        "nobs=1, imo(1)=4, rhomvb(1)=500., iob(1)=1, xl(1)=-.1, xh(1)=.1, yl(1)=-.08, yh(1)=.08, zl(1)=-.07,"
        f"zh(1)=.07, trnx(1)={x}, trny(1)={y}, trnz(1)=.4,"
    )
    _, state = play(wet(XPUT, fl="flht=.4,", mesh=mesh, bcdata=CLOSED, obs=obs), 15)
    assert np.abs(state.w_WB).max() <= 1e-8
    assert np.abs(state.v_WB).max() <= 1e-9


FINE = "px=0.,.9, nxcelt=24, py=0.,.6, nycelt=16, pz=0.,.75, nzcelt=20,"
GRADED = "px=0.,.3,.6,1., nxcell=8,10,6, sizex(2)=.03, py=0.,.6, nycelt=16, pz=0.,.2,.5,.8, nzcell=4,14,6,"
BOX = "nobs=1, imo(1)=4, rhomvb(1)={}, iob(1)=1, xl(1)=-.1, xh(1)=.1, yl(1)=-.08, yh(1)=.08, zl(1)=-.07, zh(1)=.07,"


@pytest.mark.parametrize("mesh", [FINE, GRADED])
@pytest.mark.parametrize("turn", ["groty(1)=20.,", "grotx(1)=20., groty(1)=33.,"])
def test_a_turned_box_as_heavy_as_the_liquid_rests(mesh, turn):
    """Under water, with a surface. Measured: 3e-10 rad/s after .3 s; .007 to .025 where the moment of what it displaces
    was known by its shares of faces."""
    obs = BOX.format(1000.0) + turn + "gtrnx(1)=.45, gtrny(1)=.31, gtrnz(1)=.35,"
    text = wet(XPUT.replace("twfin=1.", "twfin=.3"), fl="flht=.62,", mesh=mesh, bcdata=CLOSED, obs=obs)
    _, state = play(text, 100)
    assert state.t == 0.3
    assert np.abs(state.w_WB).max() <= 1e-8 and np.abs(state.v_WB).max() <= 1e-9
