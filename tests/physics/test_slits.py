"""Water that runs through a slit that widens, under a block that stands still: no jet that drives itself."""

import numpy as np
import pytest
from flowgmo_wet_bodies import begin

from flowgmo.pace import Pace
from flowgmo.step import liquid_values

DECK = """a block askew in a channel, its gap 2 mm at one end and 4 at the other
 &xput
  twfin=.5, delt=.005, itb=1, ipdis=1, gz=-9.81,
 /
 &limits
 /
 &props
  rhof=1000.,
 /
 &bcdata
  ibct=2,2,2,2,2,2,
 /
 &mesh
  px=0.,1.2, py=0.,.2, pz=0.,.4, nxcelt=30, nycelt=5, nzcelt=10,
 /
 &obs
  nobs=1, obsid(1)='block', iob(1)=1,
  xl(1)=-.065, xh(1)=.065, yl(1)=-.12, yh(1)=.12, zl(1)=-.16, zh(1)=.25,
  roty(1)={turn}, trnx(1)={x}, trny(1)=.1, trnz(1)={z},
 /
 &fl
  nfls=2, fxh(1)={low}, fzh(1)={left}, fxl(2)={high}, fzh(2)={right},
 /
"""

SETTLED = 0.1  # s: until then the water at the start falls into its place


@pytest.mark.parametrize("mirrored", [False, True])
def test_slit_that_widens_makes_no_energy(mirrored):
    """Measured: 1.94 m/s where the slit is narrowest, .98 at its end (sqrt(2 g .08 m) = 1.25); the energy
    rises by .003 J.

    Where what comes in through a large face counted by that face and not by the little open volume behind it, the water
    that came in was hardly slowed down and what left was sped up: 3.8 m/s after .25 s, 24 after .35, 100 after .37, and
    20 J from nothing."""
    if mirrored:
        text = DECK.format(turn=1.27, x=1.2 - 0.7043, z=0.1624, low=0.42, high=0.56, left=0.18, right=0.26)
    else:
        text = DECK.format(turn=-1.27, x=0.7043, z=0.1624, low=0.64, high=0.78, left=0.26, right=0.18)
    world, state = begin(text)
    pace, energies = Pace(world.model, state), []
    while state.t < world.model.clock.end:
        pace.advance(world)
        values = liquid_values(world, state)
        if state.t > SETTLED:
            energies.append(values["fluid/kinetic_energy"] + values["fluid/potential_energy"])
        assert np.abs(state.fluid.u).max() <= 2.5
    energies = np.array(energies)
    rise = (energies - np.minimum.accumulate(energies)).max()
    assert rise <= 0.01  # of .1 J of motion


CELL = 0.04  # m


def kinetic_energy(world, state):
    """[J]: with the inertia (A S)^2 / b that a face has for the pressure."""
    found = 0.0
    of_faces = world.liquid.openings[1:], state.fluid.velocity, world.liquid.projector.matrix.b
    for A, u, b in zip(*of_faces, strict=True):
        acts = b > 0.0
        found += 500.0 * float(((A * CELL**2 * u)[acts] ** 2 / b[acts]).sum())
    return found


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize(
    "corner, gap, slope", [(0.3333, 0.0001, 0.016), (0.625, 0.0004, 0.01), (0.875, 0.001, 0.03)]
)  # of a cell; m; -
def test_slit_that_begins_inside_a_cell_makes_no_energy(corner, gap, slope, mirrored):
    """The corner that shuts most of a face stands amid the cell before it, of which so much is open.

    Measured: the energy falls in every step; 1.86 to 1.90 m/s. Where (A u) / V alone carries, water that comes in is
    hardly slowed down, and all of these slits pass 200 m/s within .3 s (cut_advection.py)."""
    x, s, c = 0.64 + corner * CELL, np.sin(slope), np.cos(slope)
    x, z, middle = x + 0.065 * c - 0.16 * s, gap + 0.065 * s + 0.16 * c, x + 0.06
    if mirrored:
        place = {"turn": np.degrees(slope), "x": 1.2 - x, "low": 1.2 - middle, "left": 0.18, "right": 0.26}
        text = DECK.format(**place, z=z, high=1.2 - middle)
    else:
        text = DECK.format(turn=-np.degrees(slope), x=x, z=z, low=middle, high=middle, left=0.26, right=0.18)
    world, state = begin(text)
    pace, energies = Pace(world.model, state), []
    while state.t < 0.3:
        pace.advance(world)
        values = liquid_values(world, state)
        energies.append(kinetic_energy(world, state) + values["fluid/potential_energy"])
        assert np.abs(state.fluid.u).max() <= 2.5
    assert np.diff(energies).max() <= 1e-7  # of .013 to .034 J of motion at the end
