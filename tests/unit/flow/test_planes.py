"""Planes that are kept for one F: those that every cell's own neighbours give, and not those of another F."""

import numpy as np
from flowgmo_spheres import Counted
from flowgmo_wet import wet
from flowgmo_wet_runs import advance, start
from liquid_scenes import NO_SOLIDS, even, fractions, mesh

from flowgmo.flow.liquid import Liquid
from flowgmo.flow.surface.planes import Planes
from flowgmo.flow.surface.plic import EMPTY, FULL
from flowgmo.flow.team import Team
from flowgmo.step import liquid_values

DAM = """Water runs against a block that does not fit the mesh
 &xput
  remark='SI units', twfin=1.0, delt=0.002, itb=1, ifvisc=0, gz=-9.81,
 /
 &limits
 /
 &props
  units='si', rhof=1000.0,
 /
 &bcdata
  ibct(1)=2, ibct(2)=2, ibct(3)=2, ibct(4)=2, ibct(5)=2, ibct(6)=2,
 /
 &mesh
  px(1)=0.0, px(2)=1.0, nxcelt=20, py(1)=0.0, py(2)=0.5, nycelt=10, pz(1)=0.0, pz(2)=0.6, nzcelt=12,
 /
 &obs
  nobs=1, obsid(1)='block', iob(1)=1, xl(1)=0.52, xh(1)=0.67, yl(1)=0.13, yh(1)=0.38, zl(1)=0.0, zh(1)=0.17,
 /
 &fl
  nfls=1, fxh(1)=0.42, fzh(1)=0.41,
 /
"""


def plane_scene():
    block, grid, _ = mesh(even(8), even(6), even(7))
    return grid, fractions(block, lambda x, y, z: 0.3 * x - 0.2 * y + z < 0.5)


def mixed_cells(F):
    return (F > EMPTY) & (F < FULL)


def test_planes_are_those_of_find_planes_until_they_are_forgotten():
    grid, F = plane_scene()
    planes, team = Planes(grid), Team(1)
    planes.find(team, F, NO_SOLIDS)
    assert planes.are_of(F) and not planes.are_of(F.copy())
    mixed = mixed_cells(F)
    before = planes.at.copy()
    F[mixed] *= 0.5
    planes.find(team, F, NO_SOLIDS)  # known: nothing is done
    assert np.array_equal(planes.at, before)
    planes.forget()
    planes.find(team, F, NO_SOLIDS)
    anew = Planes(grid)
    anew.find_in(team, planes.columns, F, NO_SOLIDS)
    mixed = mixed_cells(F)
    mixed[[0, -1]] = mixed[:, [0, -1]] = mixed[:, :, [0, -1]] = False  # the outermost ghosts have none
    assert np.array_equal(planes.at[mixed], anew.at[mixed]) and np.any(planes.at[mixed] != before[mixed])


def run(steps):
    liquid, flow, first = start(DAM)
    args = liquid.team, liquid.openings
    advance(liquid, flow, first, most=steps, each=lambda t, flow: liquid.planes.find(args[0], flow.F, args[1]))
    return liquid, flow


def test_planes_that_are_kept_change_no_bit(monkeypatch):
    """From the end of a step over the pressure to the first sweep of the next."""
    liquid, kept = run(12)  # each step's end asks for them, as the energies do
    assert liquid.planes_last
    monkeypatch.setattr(Liquid, "planes_last", False)
    _, anew = run(12)
    for a, b in zip((*kept.velocity, kept.p, kept.F), (*anew.velocity, anew.p, anew.F), strict=True):
        assert np.array_equal(a, b)


THROWN = wet(
    "twfin=1., delt=.002, itb=1, gz=-9.81, imobs=1,", fl="flht=.31,",
    mesh="px=0.,1., nxcelt=20, py=0.,.5, nycelt=10, pz=0.,.6, nzcelt=12,", bcdata="ibct=2,2,1,1,2,2,",
    obs="nobs=2, obsid(1)='wall', iob(1)=1, xl(1)=.82, xh(1)=.87, zl(1)=0., zh(1)=.17, roty(1)=10., "
    "obsid(2)='box', iob(2)=2, xl(2)=-.08, xh(2)=.08, yl(2)=-.06, yh(2)=.06, zl(2)=-.05, zh(2)=.05, rotx(2)=20., "
    "rotz(2)=30., trnx(2)=.4, trny(2)=.1, trnz(2)=.38, imo(2)=4, rhomvb(2)=600., utobs(1,2)=1., omztobs(1,2)=-1.5,",
)  # fmt: skip


def test_where_a_body_moves_planes_found_anew_are_those_of_all(monkeypatch):
    """Every time they are asked for in 25 steps: of the state, whose energy is asked for in every other step, of the
    mean of the step, before the liquid is carried."""
    find, partial = Planes.find, []
    scene = Counted(THROWN)

    def checked(planes, team, F, opened):
        partial.append(planes.columns_are_of(F) and not planes.are_of(F))
        find(planes, team, F, opened)
        anew = Planes(scene.world.liquid.grid)
        find(anew, team, F, opened)
        mixed = mixed_cells(F)
        mixed[[0, -1]] = mixed[:, [0, -1]] = mixed[:, :, [0, -1]] = False
        assert np.array_equal(planes.columns, anew.columns)
        assert np.array_equal(planes.at[mixed], anew.at[mixed])

    monkeypatch.setattr(Planes, "find", checked)
    for n in range(25):
        scene.step()
        if n % 2:
            liquid_values(scene.world, scene.state)
    assert sum(partial) >= 30 and not all(partial)
