"""What is sorted anew where bodies have changed open fractions is what a pass over the whole mesh finds, bit by bit."""

import numpy as np
import pytest
from flowgmo_wet import wet
from flowgmo_wet_bodies import begin

from flowgmo.flow.columns import all_columns
from flowgmo.flow.favor.changed_cells import REACH, merged, runs_around
from flowgmo.flow.favor.cut_faces import find_cut_faces
from flowgmo.flow.favor.near_surface import Pose
from flowgmo.flow.fields import G
from flowgmo.flow.momentum.viscosity import make_viscosity
from flowgmo.flow.momentum.wall_shear import find_side_walls
from flowgmo.flow.pressure.regions import Regions
from flowgmo.geometry.transform import rotation

#: A ball beside a bar that stands still, a box that comes through the sides of the domain, and a plate as wide as the
#: tank, which parts it in two; the mesh is graded.
BODIES = """nobs=4,
 obsid(1)='bar', imo(1)=0, iob(1)=1, xl(1)=.62, xh(1)=.71, zh(1)=.33, zl(1)=-1., rotz(1)=20.,
 obsid(2)='ball', imo(2)=3, iob(2)=2, rsh(2)=.14, trnx(2)=.5, trny(2)=.4, trnz(2)=.4, utobs(1,2)=1.,
 obsid(3)='box', imo(3)=3, iob(3)=3, xl(3)=-.1, xh(3)=.1, yl(3)=-.15, yh(3)=.15, zl(3)=-.08, zh(3)=.08, trnx(3)=.3,
  trny(3)=.3, trnz(3)=.3, utobs(1,3)=1.,
 obsid(4)='plate', imo(4)=3, iob(4)=4, xl(4)=-.05, xh(4)=.05, yl(4)=-3., yh(4)=3., zl(4)=-3., zh(4)=3., trnx(4)=.2,
  utobs(1,4)=1.,
"""
MESH = "px=0., .45, 1., nxcell=10, 8, py=0., .75, nycelt={ny}, pz=0., .75, nzcelt=11,"


def scene(ny=12, sides="ibct=2,2,2,2,2,2,", viscous=True):
    more = "ifvisc=1, iwsh=1," if viscous else ""
    return begin(wet(
        f"twfin=1., delt=.01, itb=1, gz=-9.81, imobs=1, {more}", props="rhof=1., mu1=.01,", mesh=MESH.format(ny=ny),
        bcdata=sides, obs=BODIES, fl="flht=.4,",
    ))  # fmt: skip


def same(a, b):
    assert (a is None) == (b is None)
    assert a is None or np.array_equal(a, b)


def check_sorted(liquid):
    """Everything that is sorted, against a pass over the mesh with the open fractions as they are."""
    m, every = liquid.momentum, all_columns(liquid.shape)
    whole = find_cut_faces(every, liquid.openings)
    same(m.cut.plain[G:-G, G:-G, G:-G], whole.plain[G:-G, G:-G, G:-G])
    for a, b in zip(m.cut.rows, whole.rows, strict=True):
        same(a, b)
    if m.operators is not None:
        walls = [
            find_side_walls(liquid.grid, liquid.openings, m._no_slip(), np.zeros((6, 3)), c, m.present)
            for c in range(3)
        ]
        of = m.present, m.plan.no_slip, tuple(walls)
        wanted = make_viscosity(liquid.team, liquid.grid, liquid.openings, whole, *of)
        for a, b in zip(m.operators, wanted, strict=True):
            for parts in ((a and a.cut, b and b.cut), (a and a.sides, b and b.sides)):
                for x, y in zip(*(p or () for p in parts), strict=True):
                    same(x, y)
    projector = liquid.projector
    whole = Regions(liquid.openings, projector.held, liquid.sides.periodic)
    same(projector.sealed.regions.label, whole.label)
    same(projector.sealed.cells, whole.cells)
    same(projector.sealed.reached, whole.reached)
    return len(whole.cells)


def wander(rng, turn=True):
    """Poses of ball, box, and plate: jumps and turns, through each other and through the sides."""
    turns = [rng.uniform(0.0, 90.0, 3) * turn, rng.uniform(0.0, 90.0, 3) * turn, (0.0, 0.0, 0.0)]
    ways = [rng.uniform(-0.4, 0.4, 3), rng.uniform(-0.4, 0.4, 3), (rng.uniform(-0.1, 0.7), 0.0, 0.0)]
    return [Pose(rotation(a), np.array(t)) for a, t in zip(turns, ways, strict=True)]


@pytest.mark.parametrize(
    ("ny", "sides", "viscous"),
    [(12, "ibct=2,2,2,2,2,2,", True), (12, "ibct=1,5,1,2,2,2,", False), (1, "ibct=2,2,1,1,2,1,", True)],
)
def test_sorted_anew_where_bodies_moved(ny, sides, viscous):
    """50 steps; some are given up after the bodies were expected somewhere, in others they come to stand elsewhere."""
    world, state = scene(ny, sides, viscous)
    rng, immersed, regions = np.random.default_rng(1), world.liquid.immersed, []
    renew = immersed.renew

    def checked(cells, meanwhile):
        renew(cells, meanwhile)
        regions.append(check_sorted(world.liquid))

    immersed.renew = checked
    zeros = np.zeros((3, 6))
    poses = wander(rng)
    for n in range(50):
        if n % 7 != 3:  # else they rest
            poses = wander(rng, turn=n % 2 == 0)
        immersed.begin(state.fluid, poses, wander(rng), zeros[:, :3], zeros, [None] * 3, 1.0)
        if n % 5 == 1:
            immersed.withdraw()
            continue
        if n % 3 == 0:
            poses = wander(rng)
        immersed.arrive(poses)
        immersed.settle()
    assert len(regions) == 50
    assert max(regions) > 1 or ny == 1


def test_runs_hold_what_is_near_and_nothing_else():
    rng = np.random.default_rng(2)
    shape = (14, 11, 40)
    for count in (0, 1, 5, 60):
        numbers = np.unique(rng.integers(0, np.prod(shape), count))
        cells = np.column_stack(np.unravel_index(numbers, shape)).astype(np.int32)
        marks, lines = rng.integers(0, 16, shape).astype(np.uint8), np.zeros((*shape[:2], 2), np.int32)
        before = marks.copy()
        columns = runs_around(cells, marks, lines)
        found = np.zeros(shape, int)
        for i, j, k0, k1 in columns:
            found[i, j, k0:k1] += 1
        at = np.indices(shape)
        wanted = np.zeros(shape, int)
        for cell in cells:
            wanted[np.abs(at - cell[:, None, None, None]).max(axis=0) <= REACH] = 1
        assert np.array_equal(found, wanted)
        assert np.array_equal(marks, before) and not lines.any()


def test_rows_are_merged_in_order():
    rng = np.random.default_rng(3)
    shape = (6, 5, 12)
    for _ in range(20):
        old = np.argwhere(rng.random(shape) < 0.3)
        region = np.zeros(shape, bool)
        columns = []
        for i, j in np.argwhere(rng.random(shape[:2]) < 0.4):
            a, b = sorted(rng.integers(0, 13, 2))
            region[i, j, a:b] = True
            columns.append((i, j, a, b))
        new = np.argwhere(region & (rng.random(shape) < 0.5))
        old, new = (np.column_stack([x, x[:, 2] + 1]).astype(np.int32) for x in (old, new))
        kept = ~region[tuple(old[:, :3].T)]
        wanted = np.concatenate([old[kept], new])
        order = np.lexsort(wanted[:, 2::-1].T)
        rows, source = merged(old, np.array(columns, np.int32).reshape(-1, 4), new)
        assert np.array_equal(rows, wanted[order])
        assert np.array_equal(source, np.append(np.flatnonzero(kept), np.full(len(new), -1))[order])
