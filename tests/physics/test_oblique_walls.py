"""Water that slides on walls oblique to the mesh, without friction: as fast as gravity says, no energy from nothing."""

import math

import numpy as np
import pytest
from flowgmo_wet import wet
from flowgmo_wet_bodies import begin
from flowgmo_wet_runs import CLOSED, advance, start

from flowgmo.flow.columns import all_columns
from flowgmo.flow.observe.measures import total
from flowgmo.pace import Pace
from flowgmo.step import liquid_values

G = 9.81


def film(angle, thick, mesh, more=""):
    """A film on a slope that rises along x from z = .1 at x = 0, in a box; the slope is a solid cut out of the mesh."""
    t, high = math.tan(math.radians(angle)), 0.1 + thick / math.cos(math.radians(angle))
    return wet(
        "twfin=.3, delt=.005, itb=1, gz=-9.81,",
        mesh=mesh,
        fl=f"nfls={1 + bool(more)}, fcc(1)={-high!r}, fcx(1)={-t!r}, fcz(1)=1., {more}",
        bcdata=CLOSED,
        obs=f"nobs=1, iob(1)=1, cc(1)=-.1, cx(1)={-t!r}, cz(1)=1.,",
    )


@pytest.mark.parametrize("angle", [5.0, 10.0, 14.0, 20.0, 30.0, 38.0, 45.0, 60.0])
def test_a_film_starts_with_the_acceleration_along_the_slope(angle):
    """u = - g t sin cos, w = - g t sin2 after one step, on all faces of the film that the pressure acts on, far from
    its ends. Measured: off by 1.8 % of g t sin at most (14 degrees), .05 % from 20 to 38. Where thin cells were light
    whatever the slope of their wall: 20 times as much in tips of cells at 14 degrees, 1.8 to 6.8 times at the others,
    but 45, where the wall goes through the corners of cells."""
    high = 0.6 if angle < 25.0 else 2.2
    mesh = f"px=0., 1., nxcelt=20, py=0., .05, nycelt=1, pz=0., {high!r}, nzcelt={round(20 * high)},"
    liquid, flow, first = start(film(angle, 0.06, mesh))
    t, _, _ = advance(liquid, flow, first, most=1)
    th, middle, b = np.radians(angle), (slice(9, 14), 2, slice(2, -2)), liquid.projector.matrix.b
    for velocity, held, share in ((flow.u, b[0], np.cos(th)), (flow.w, b[2], np.sin(th))):
        acts = held[middle] > 0.0
        assert acts.sum() >= 5
        assert np.abs(velocity[middle][acts] / (G * t * np.sin(th)) + share).max() <= 0.03


@pytest.mark.parametrize("rise", [(0.364, 0.2), (0.577, 0.577), (0.2, 0.15), (1.2, 0.7), (-0.25, 0.12)])
def test_a_slope_may_fall_across_the_mesh(rise):
    """The same on a plane that rises by `rise` along x and y: g . (1 - n n) t. Measured: off by .6 % of it at most,
    where thin cells were light whatever their wall 4 to 14 times g t in corners of three faces."""
    n = np.array([-rise[0], -rise[1], 1.0]) / math.hypot(*rise, 1.0)
    low, high = 0.2637, 0.2637 + 0.1 / n[2]
    plane = f"cx(#)={-rise[0]}, cy(#)={-rise[1]}, cz(#)=1.,".replace("#", "1")
    text = wet(
        "twfin=.3, delt=.005, itb=1, gz=-9.81,",
        mesh="px=0., 1., nxcelt=16, py=0., 1., nycelt=16, pz=0., 2.5, nzcelt=40,",
        fl=f"nfls=1, fcc(1)={-float(high)!r}, " + plane.replace("c", "fc"),
        bcdata=CLOSED,
        obs=f"nobs=1, iob(1)=1, cc(1)={-low!r}, {plane}",
    )
    liquid, flow, first = start(text)
    t, _, _ = advance(liquid, flow, first, most=1)
    along = np.array([0.0, 0.0, -1.0]) + n * n[2]
    middle = (slice(8, 12), slice(8, 12), slice(2, -2))
    for velocity, b, share in zip(flow.velocity, liquid.projector.matrix.b, along, strict=True):
        acts = b[middle] > 0.0
        assert acts.sum() >= 20
        off = velocity[middle][acts] / (G * t) - share
        assert np.abs(off).max() <= 0.012 * np.linalg.norm(along)


def energies(text, end):
    """Rows (t, kinetic, potential) of a run, and the mean velocity (3,) of its liquid at the end."""
    world, state = begin(text)
    pace, rows = Pace(world.model, state), []

    def note():
        values = liquid_values(world, state)
        rows.append((state.t, values["fluid/kinetic_energy"], values["fluid/potential_energy"]))

    note()
    while state.t < end:
        pace.advance(world)
        note()
    liquid, flow, momentum = world.liquid, state.fluid, np.zeros(3)
    of = liquid.grid, liquid.openings, flow, liquid.plan.rho, liquid.gravity, 1e-6
    whole = total(liquid.team, all_columns(liquid.shape), *of, momentum)
    return np.array(rows), momentum / (liquid.plan.rho * whole.volume)


@pytest.mark.parametrize("angle", [14.0, 20.0, 30.0])
def test_a_film_runs_down_a_slope_as_fast_as_gravity_says(angle):
    """A film of .4 cells, .5 m long, let go before a wall. Measured after .3 s, kinetic energy over the fall of the
    potential and mean speed over g t sin: .96, 1.01 at 14 degrees, 1.11, 1.05 at 20, .93, .96 at 30 (.2 s). The wall
    behind gives 5 % of speed at 20; faces inside the solid count as at rest, which hides some of both.

    Where thin cells were light whatever the slope of their wall 14.7, 2.7; 1.44, 1.32; 1.56, 1.56."""
    mesh = "px=0., 1., nxcelt=20, py=0., .05, nycelt=1, pz=0., .9, nzcelt=18,"
    end = 0.3 if angle < 25.0 else 0.2
    rows, mean = energies(film(angle, 0.02, mesh, "fioh(2)=0, fxl(2)=-1., fxh(2)=.5,"), end)
    t, th = rows[-1, 0], np.radians(angle)
    along = -(mean[0] * np.cos(th) + mean[2] * np.sin(th)) / (G * t * np.sin(th))
    assert 0.85 <= rows[-1, 1] / (rows[0, 2] - rows[-1, 2]) <= 1.2
    assert 0.9 <= along <= 1.12


@pytest.mark.parametrize(("more", "gain"), [("", 0.1), ("con=.1, confs=.2,", 0.03)])
def test_water_that_sways_between_two_oblique_walls_gains_no_energy(more, gain):
    """A tank with walls of 45 degrees, its level tilted by a tenth: kinetic + potential energy above the start, in the
    largest fall of the potential. Measured in 2 s: .057, with short steps .003. Where thin cells were light whatever
    the slope of their wall: .22 (.38 in 4 s), .19."""
    text = wet(
        f"twfin=2., delt=.002, itb=1, gz=-9.81, {more}",
        mesh="px=0., 1., nxcelt=64, py=0., .1, nycelt=1, pz=0., .6, nzcelt=40,",
        fl="nfls=1, fcc(1)=-.28, fcx(1)=.1, fcz(1)=1.,",
        bcdata=CLOSED,
        obs="nobs=2, iob(1)=1,2, cc(1)=-.35, cx(1)=1., cz(1)=1., cc(2)=.65, cx(2)=-1., cz(2)=1.,",
    )
    rows, _ = energies(text, 2.0)
    above = rows[:, 1:].sum(axis=1) - rows[0, 1:].sum()
    assert above.max() <= gain * (rows[0, 2] - rows[:, 2].min())
