"""Balls of a tenth of a cell to three cells across: what they displace lifts them, wherever they are in the mesh."""

import numpy as np
import pytest
from flowgmo_wet import wet
from flowgmo_wet_bodies import begin, play

from flowgmo.step import liquid_values, step

CELL, G, RHO = 0.04, 9.81, 1000.0
MESH = "px=0.,.4, py=0.,.4, pz=0.,.48, nxcelt=10, nycelt=10, nzcelt=12,"


def ball(across, place, ratio=0.5, height=0.36, kind=4, end=1.0):
    """One ball of so many cells across at a place [length] in a tank, let go or held (kind 3); height None: no
    surface."""
    x, y, z = (float(c) for c in place)
    itb, fl = ("itb=0,", "") if height is None else ("itb=1,", f"flht={height},")
    return wet(
        f"twfin={end}, delt=1e-3, {itb} ipdis=1, gz={-G}, imobs=1,", fl=fl, mesh=MESH, bcdata="ibct=2,2,2,2,2,2,",
        obs=f"nobs=1, imo(1)={kind}, rhomvb(1)={ratio * RHO}, iob(1)=1, rsh(1)={0.5 * across * CELL!r}, trnx(1)={x!r}, "
        f"trny(1)={y!r}, trnz(1)={z!r},",
    )  # fmt: skip


def volume(across):
    return np.pi / 6.0 * (across * CELL) ** 3


@pytest.mark.parametrize("across", [0.1, 0.3, 0.5, 0.8, 1.0, 1.2, 1.5, 2.0, 3.0])
def test_its_lift_is_that_of_its_volume(across):
    """Held at random places, and with the centre in a corner, on an edge and on a face of the mesh: 5e-10 measured, the
    pressure's tolerance. Found by the corners of cells they had 0, 0, .08, .34, .67, .84, .95, 1, 1 of it at most."""
    places = [
        *np.random.default_rng(3).uniform(0.15, 0.25, (4, 3)),
        (0.2, 0.2, 0.2),
        (0.2, 0.2, 0.21),
        (0.2, 0.21, 0.19),
    ]
    for place in places:
        world, state = begin(ball(across, place, kind=3))
        covered = (1.0 - world.liquid.openings.V[2:-2, 2:-2, 2:-2]).sum() * CELL**3
        assert covered == pytest.approx(volume(across), rel=1e-9)
        step(world, state, 1e-3, np.zeros(0), landing=False)
        lift = world.wet_bodies.records.loads.total[0]
        assert lift[2] == pytest.approx(RHO * G * volume(across), rel=1e-8)
        assert np.abs(lift[:2]).max() < 1e-8 * lift[2]


def test_light_ones_have_a_tenth_of_the_liquid_s_mass():
    """Of 1e-4 of the liquid's density: .3, .8, 1.2 cells across rise with 4.8, 2.5, 3.7 m/s and the remainder by .065,
    .005, .012 of the largest kinetic energy; the first two with their own mass 118 and 205 m/s, .96 and .95."""
    for across, told in ((0.3, 0.1), (0.8, 0.1), (1.2, 1e-4)):
        rows = []

        def note(world, state, report, rows=rows):
            values = liquid_values(world, state)
            rows.append((values["energy/kinetic"], values["energy/remainder"], np.abs(state.v_WB).max()))

        world, _ = play(ball(across, (0.203, 0.195, 0.11), 1e-4, end=0.1), 400, each=note)
        assert world.arrays["mass"][0] == pytest.approx(told * RHO * volume(across), rel=1e-9)
        kinetic, remainder, speed = np.array(rows).T
        rise = (remainder - np.minimum.accumulate(np.minimum(remainder, 0.0))).max()
        assert speed.max() < 6.0
        assert rise < 0.2 * kinetic.max()


@pytest.mark.parametrize("height", [None, 0.44])
def test_potential_energy_knows_where_in_a_cell_it_is(height):
    """Held at heights a tenth of a cell apart under water: potential energy + rho g V z is the same to 3e-11 of rho g V
    cell; by the faces of cells alone it was off by up to .5."""
    for across in (0.4, 0.8, 1.2):
        found, unit = [], RHO * G * volume(across)
        for z in np.linspace(0.2, 0.28, 17):
            world, state = begin(ball(across, (0.203, 0.195, z), height=height, kind=3))
            found.append(liquid_values(world, state)["fluid/potential_energy"] / unit + z)
        assert np.ptp(found) < 1e-9 * CELL


@pytest.mark.parametrize("height", [None, 0.36])
def test_its_way_keeps_the_volume_and_makes_no_energy(height):
    """Balls of .4 and .8 cells across sink and rise through faces and cells. Volume to rounding; the remainder never
    rises. With the liquid somewhere in the cell around them it jumped by .05 of the largest kinetic energy."""
    for across, ratio, z in ((0.4, 3.0, 0.31), (0.8, 3.0, 0.31), (0.8, 0.5, 0.09)):
        rows = []

        def note(world, state, report, rows=rows):
            values = liquid_values(world, state)
            rows.append((values["energy/kinetic"], values["energy/remainder"], values.get("fluid/volume_error", 0.0)))

        _, state = play(ball(across, (0.203, 0.195, z), ratio, height, end=0.15), 200, each=note)
        kinetic, remainder, error = np.array(rows).T
        rise = (remainder - np.minimum.accumulate(np.minimum(remainder, 0.0))).max()
        assert (state.p_WB[0, 2] - z) * (1.0 - ratio) > 0.04  # through a plane of the mesh, the way it should
        assert rise < 1e-3 * kinetic.max()
        assert np.abs(error).max() < 1e-12
