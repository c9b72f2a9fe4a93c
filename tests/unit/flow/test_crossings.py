"""Faces that a flat wall passes at once (flow/immersed/crossings.py)."""

import numpy as np
import pytest
from flowgmo_wet_bodies import begin

from flowgmo.flow.favor.shares import Shares
from flowgmo.flow.fields import Grid, Open
from flowgmo.flow.immersed.crossings import mend_crossings
from flowgmo.pace import Pace

STREAM = """ a box drifts with a stream
 &xput
  twfin=1., delt={dt}, tdtmax(1)={dt}, itb=1, imobs=1,
 /
 &limits
 /
 &props
  rhof=1000.,
 /
 &bcdata
  ibct=6,8,1,1,1,1, ubct(1,1)=1.,
 /
 &mesh
  px=0.,.6,1., nxcell=12,10, py=0.,.4, pz=0.,.4, nycelt=8, nzcelt=8,
 /
 &obs
  nobs=1,
  obsid(1)='box', imo(1)=3, rhomvb(1)=1000., iob(1)=1, {shape} utobs(1,1)=1.,
 /
 &fl
  ui=1., flht=.4,
 /
"""
PLUG = "xl(1)=.133, xh(1)=.317, yl(1)=0., yh(1)=.4, zl(1)=0., zh(1)=.4,"
BOX = "xl(1)=.133, xh(1)=.317, yl(1)=.11, yh(1)=.29, zl(1)=.07, zh(1)=.33,"


def drift(text, steps):
    """Largest difference of the liquid's velocity from that of the stream in so many steps, on open faces."""
    world, state = begin(text)
    pace, worst = Pace(world.model, state), 0.0
    for _ in range(steps):
        pace.advance(world)
        for u, A, stream in zip(state.fluid.velocity, world.liquid.openings[1:], (1.0, 0.0, 0.0), strict=True):
            inside = (slice(2, -2),) * 3
            worst = max(worst, float(np.abs(u - stream)[inside][A[inside] > 0.01].max()))
    return worst


@pytest.mark.parametrize("dt", [0.007, 0.011, 0.0173])
@pytest.mark.parametrize(("shape", "bound"), [(PLUG, 1e-5), (BOX, 0.05)], ids=["plug", "box"])
def test_flat_box_drifts_with_a_stream(shape, bound, dt):
    # Steps of .14, .22 and .35 cells. Measured: plug 4e-15 to 4e-7, box 1e-14 to .02, what AMISS leaves at its edges.
    # With the mean of three poses alone .18 to 1.6 m/s where a wall passes a face between two of them.
    assert drift(STREAM.format(dt=dt, shape=shape), 12) <= bound


def test_volumes_say_when_a_wall_passes():
    """A wall passes the face between two cells after .3 of a step: open for .7 of it, where three poses say 5/6."""
    cells = np.array([[3, 3, 3], [4, 3, 3]], np.int32)
    faces = np.zeros((2, 6))
    faces[:, 2:] = 0.9
    faces[1, 1] = 1.0
    faces[0, 1] = faces[1, 0] = 1.0 / 6.0
    widths = np.full(8, 0.1)
    grid = Grid(widths, widths, widths, widths, widths, widths)
    opened = Open(*(np.ones((8, 8, 8)) for _ in range(4)))
    now = Open(*(a.copy() for a in opened))
    opened.Ax[3, 3, 3] = 5.0 / 6.0
    left = [np.array([0.3 * 0.2, 0.7 * 0.2])]
    centres = [0.1 * np.arange(8)] * 3
    args = centres, np.zeros((1, 3)), np.array([[1.0, 0.0, 0.0, 0.0, 0.0, 0.0]]), [None], 0.02
    (mended,) = mend_crossings(opened, now, [Shares(cells, faces)], left, grid, *args)
    assert mended.faces[0, 1] == pytest.approx(0.3, abs=1e-12)
    assert mended.faces[1, 0] == pytest.approx(0.3, abs=1e-12)
    assert opened.Ax[3, 3, 3] == pytest.approx(0.7, abs=1e-12)
    assert np.array_equal(mended.faces[:, 2:], faces[:, 2:])


SQUEEZE = """ a plate sinks evenly towards the bed
 &xput
  twfin=.12, delt=.0005, tdtmax(1)=.001, itb=1, ipdis=1, gz=-9.81, imobs=1, thpltd(1)=.12, tpltd(1)=1.,
 /
 &limits
 /
 &props
  rhof=1000.,
 /
 &bcdata
  ibct=2,2,1,1,2,2,
 /
 &mesh
  px=0.,1.2, py=0.,.02, pz=0.,.72, nxcelt=60, nycelt=1, nzcelt=36,
 /
 &obs
  nobs=1,
  obsid(1)='plate', iob(1)=1, imo(1)=3, xl(1)=.4, xh(1)=.8, zl(1)=.06, zh(1)=.24, wtobs(1,1)=-.3,
 /
 &fl
  flht=.5,
 /
"""


def test_load_of_a_plate_that_passes_cells_is_smooth():
    """Its load rises slowly as the gap under it closes, but where its faces pass planes of the mesh, at two cells.

    Measured: steps of .044 at most; 1.9 times its neighbours there, 3.6 with the mean of three poses alone. With
    the plate's corners cut by its distance it had spikes of a hundredfold as it passed half a cell.
    """
    world, state = begin(SQUEEZE)
    pace, gaps, loads = Pace(world.model, state), [], []
    while state.t < 0.08:
        pace.advance(world)
        gaps.append(0.06 - 0.3 * state.t)
        loads.append(world.wet_bodies.records.loads.total[0, 2] / 0.02 - 1000.0 * 9.81 * 0.4 * 0.18)
    gaps, loads = np.array(gaps), np.array(loads)
    between = ((gaps[1:] > 0.0404) & (gaps[1:] < 0.054)) | (gaps[1:] < 0.0385)
    assert (np.abs(np.diff(loads)[between]) <= 0.1 * loads[1:][between]).all()
    assert loads[gaps < 0.05].max() <= 2.5 * loads[gaps > 0.0405][-1]
    assert (loads[10:] > 0.0).all()
