"""Projectors of small boxes, for tests of the pressure equation."""

import numpy as np

from flowgmo.flow.boundary import Sides
from flowgmo.flow.fields import G, Open, grid_of, zeros
from flowgmo.flow.pressure.projection import Projector
from flowgmo.flow.team import Team
from flowgmo.flow_plan import SidePlan
from flowgmo.mesh import WALL, Block

NO_SOLIDS = Open(None, None, None, None)
g, RHO = 9.81, 1000.0


def block_of(shape, lengths=(1.0, 1.0, 1.0), graded=True):
    """A block whose cells vary by up to 40 %."""
    planes = []
    for n, length in zip(shape, lengths, strict=True):
        s = np.linspace(0.0, 1.0, n + 1)
        planes.append(length * (s + (0.06 * np.sin(2 * np.pi * s) if graded and n > 1 else 0.0)))
    return Block(*planes, neighbours=())


def projector(block, kinds=(WALL,) * 6, openings=NO_SOLIDS, threads=1, gravity=(0.0, 0.0, -g), plain=False, **side):
    """A Projector of a block; `side`: pressure tables by number, as p0=..."""
    one = np.zeros(1)
    plans = [
        SidePlan(k, kind, one, pressure=np.array([side.get(f"p{k}", 0.0)]), fraction=np.ones(1))
        for k, kind in enumerate(kinds)
    ]
    grid = grid_of(block)
    sides = Sides(plans, grid, block.z, RHO, np.array(gravity))
    return Projector(grid, openings, sides, Team(threads), RHO, plain=plain)


def level_pool(block, height):
    """F of still liquid up to a height."""
    F = zeros(block)
    F[G:-G, G:-G, G:-G] = np.clip((height - block.z[:-1]) / np.diff(block.z), 0.0, 1.0)
    return F


def net_outflow(block, velocity, openings=NO_SOLIDS):
    """Sum over the faces of each real cell of outward A S u (nx, ny, nz)."""
    grid = grid_of(block)
    total = 0.0
    for d, (a, A) in enumerate(zip(velocity, openings[1:], strict=True)):
        if a is None:
            continue
        flow = a if A is None else a * A
        for e in range(3):
            if e != d:
                flow = flow * np.expand_dims(grid[e], tuple(k for k in range(3) if k != e))
        total = total + (flow - np.roll(flow, 1, d))[G:-G, G:-G, G:-G]
    return total
