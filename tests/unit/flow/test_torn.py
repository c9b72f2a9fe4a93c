"""What a gate uncovers that stands on its bed: void, where liquid could not come as fast."""

import re
from pathlib import Path

import numpy as np
import pytest
from flowgmo_wet_bodies import begin

from flowgmo.flow.fields import Grid
from flowgmo.flow.immersed.torn import Around, torn
from flowgmo.pace import Pace

GATE = Path(__file__).parents[3] / "decks" / "gate" / "gate.nml"
U, DEPTH, CELL = 3.0, 0.4, 0.02
RHO = 1000.0


@pytest.mark.parametrize("dt", [1e-6, 1e-5, 1e-4, 1e-3])
def test_no_jet_under_a_gate_that_leaves_its_bed(dt):
    """A slit that has to be full after the step would draw thickness / dt: 1.5e4 m/s in the shortest of these."""
    world, state = begin(re.sub(r"delt=[0-9.]+", f"delt={dt!r}", GATE.read_text()))
    pace, held = Pace(world.model, state), state.fluid.start_volume
    for _ in range(12):
        pace.advance(world)
        flow = state.fluid
        fastest = max(float(np.abs(u).max()) for u in flow.velocity if u is not None)
        assert fastest <= 2.0 * max(U, np.sqrt(2.0 * 9.81 * DEPTH))
        volume = float((flow.F * world.liquid.openings.V)[2:-2, 2:-2, 2:-2].sum()) * CELL**3
        assert abs(volume - held) <= 1e-14 * held


def row_of(n, areas, F, p=0.0):
    """n + 2 cells along x, the ends open and filled to F; those between are closed and open by `areas` (n + 1,)."""
    shape = (n + 6, 5, 5)
    V, filled, pressure = np.zeros(shape), np.zeros(shape), np.zeros(shape)
    A = [np.zeros(shape) for _ in range(3)]
    for at in (2, n + 3):
        V[at, 2, 2], filled[at, 2, 2], pressure[at, 2, 2] = 1.0, F, p
    A[0][2 : n + 3, 2, 2] = areas
    widths = [np.full(k, CELL) for k in shape]
    cells = np.column_stack([np.arange(3, n + 3), np.full(n, 2), np.full(n, 2)])
    return cells, Around(V, A, filled, pressure), Grid(*widths, *widths)


@pytest.mark.parametrize("n", [1, 2, 5])
@pytest.mark.parametrize("p", [0.0, 4000.0])
def test_what_liquid_can_fill_depends_on_the_way_in_of_all_that_opens_together(n, p):
    area, speed = 0.01, 0.5
    cells, around, grid = row_of(n, np.full(n + 1, area), 1.0, p)
    most = 2.0 * max(speed, np.sqrt(2.0 * p / RHO)) * 2.0 * area * CELL**2  # [length3/time] through both ends
    for share in (0.99, 1.01):
        rates = np.full(n, share * most / n)
        assert (torn(cells, rates, np.full(n, speed), around, grid, RHO) == (share > 1.0)).all()


def test_a_wall_between_cells_parts_them():
    """The cell with the wide way in fills, the other one, which opens as fast, does not."""
    cells, around, grid = row_of(2, np.array([0.5, 0.0, 0.01]), 1.0)
    rates = np.full(2, 0.1 * CELL**2)
    assert torn(cells, rates, np.full(2, 1.0), around, grid, RHO).tolist() == [False, True]


def test_void_fills_nothing():
    cells, around, grid = row_of(1, np.full(2, 1.0), 0.0)
    assert torn(cells, np.full(1, 1e-9), np.ones(1), around, grid, RHO).all()
