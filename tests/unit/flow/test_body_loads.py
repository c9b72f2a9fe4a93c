"""Loads of the liquid on bodies that move, what they displace, and the work that is booked."""

import numpy as np
import pytest
from flowgmo_wet import wet
from flowgmo_wet_bodies import begin, play, tank
from flowgmo_wet_runs import CLOSED, REAL

from flowgmo.bodies.arrays import BODY, FORCED, POSE
from flowgmo.bodies.energy import rotation_matrices
from flowgmo.flow.observe.gauges import find_probe
from flowgmo.rows import rows_of_state
from flowgmo.wet_loads import kept, way_of
from flowgmo.world import Room

GRADED = "px=0.,.5,1., nxcell=9,7, py=0.,.25,.75, nycell=5,8, pz=0.,.4,.75, nzcell=6,7,"
TWO = (
    "nobs=2, obsid(1)='ball', imo(1)=3, iob(1)=1, rsh(1)=.13, trnx(1)=.27, trny(1)=.35, trnz(1)=.31,\n"
    "utobs(1,1)=.75, omytobs(1,1)=2., omxtobs(1,1)=1., rhomvb(1)=3000.,\n"
    "obsid(2)='light', imo(2)=4, rhomvb(2)=100., iob(2)=2, xl(2)=-.1, xh(2)=.12, yl(2)=-.11, yh(2)=.1, zl(2)=-.12,\n"
    "zh(2)=.1, rotx(2)=20., roty(2)=30., trnx(2)=.71, trny(2)=.41, trnz(2)=.37,"
)
FULL = wet(
    "twfin=1., delt=.004, itb=0, ipdis=1, imobs=1, gx=1.5, gz=-8., thpltd(1)=1e-3,", fl="", mesh=GRADED,
    bcdata=CLOSED, obs=TWO,
)  # fmt: skip


@pytest.fixture(scope="module")
def projected():
    """A step of two bodies in a full graded tank, up to its pressure: (world, dt, velocities before, after)."""
    world, state = play(FULL, 3)
    dt = 0.5 * world.liquid.longest_step(state.fluid, 0.004)
    room = Room(world, state, np.zeros(0))
    before = []
    for name, stage in world.stages:
        if name == "pressure":
            before = [u.copy() for u in world.liquid.predicted]
        stage(world, state, state.t + dt, room)
        if name == "pressure":
            return world, dt, before, [u.copy() for u in world.liquid.predicted]


def test_the_liquid_gets_the_opposite(projected):
    """Pressure: momentum of the faces' open parts and what the sides hold. Measured: 1e-14 of the sum of |J| p."""
    world, dt, before, after = projected
    liquid, rho = world.liquid, 1000.0
    p, sizes = liquid.p, [d[2:-2] for d in liquid.grid[:3]]
    fluxes = liquid.immersed.fluxes
    on_bodies = sum(one.J.T @ p.reshape(-1)[one.cells] for one in fluxes)
    size = sum(np.abs(one.J).T @ np.abs(p.reshape(-1)[one.cells]) for one in fluxes)
    for d in range(3):
        A = np.moveaxis(liquid.openings[1 + d], d, 0)
        du = np.moveaxis(after[d] - before[d], d, 0)
        pressure = np.moveaxis(p, d, 0)
        others = [np.arange(3) != d][0]
        S = np.multiply.outer(*[s for s, other in zip(sizes, others, strict=True) if other])
        h = liquid.grid[3 + d]
        inner = (slice(2, -3), slice(2, -2), slice(2, -2))  # faces between real cells
        momentum = float((rho * A[inner] * S * h[2:-3, None, None] * du[inner]).sum())
        side = (slice(2, -2), slice(2, -2))
        sides = float((S * (pressure[2][side] * A[1][side] - pressure[-3][side] * A[-3][side])).sum())
        assert abs(momentum / dt + on_bodies[d] - sides) <= 1e-12 * size[d]


def test_lift_is_what_gravity_gives_faces_and_not_volumes(projected):
    """rho g of half the areas less that of the volume is - lift, cell by cell. Measured 1e-16 of the largest cell."""
    world, *_ = projected
    liquid = world.liquid
    total = np.zeros((*liquid.shape, 3)).reshape(-1, 3)
    for one in liquid.immersed.fluxes:
        np.add.at(total, one.cells, one.lift[:, :3])
    volume = np.einsum("i,j,k->ijk", *liquid.grid[:3])
    V = liquid.immersed.covers.open.V
    for d in range(3):
        A = liquid.openings[1 + d]
        mean = 0.5 * (A + np.roll(A, 1, axis=d))
        lift = total[:, d].reshape(liquid.shape)
        touched = lift != 0.0
        assert np.abs((mean - V) * volume + lift)[touched].max() <= 1e-14 * volume.max()


def test_a_coupled_body_is_moved_by_its_load():
    """m dv / dt = load + weight, to the rounding of two steps of v. It starts without spin: no gyroscopic moment."""
    world, state = begin(tank(bodies="box"))
    body = world.arrays[0]
    v, w, R = state.v_WB[0].copy(), state.w_WB[0].copy(), rotation_matrices(state.q_WB[0])
    from flowgmo.step import step

    step(world, state, 0.004, np.zeros(0), False)
    load = world.wet_bodies.records.loads.total[0]
    assert np.abs(load[:3]).max() > 10.0
    assert body["mass"] * (state.v_WB[0] - v) / 0.004 - body["mass"] * body["gravity"] == pytest.approx(
        load[:3], rel=1e-9, abs=1e-9 * np.abs(load).max()
    )
    inertia = R @ body["inertia"] @ R.T
    assert inertia @ (state.w_WB[0] - w) / 0.004 == pytest.approx(load[3:], rel=1e-8, abs=1e-9 * np.abs(load).max())


def test_what_floats_at_rest_is_carried():
    """The load at the start is the weight of the displaced water, at its centre. Measured: force to 1.3e-4, centre to
    .0009 of .25, arm of the load to .0006. With the covered parts at the centres of their cells the centre is .006 off.
    """
    world, state = begin(tank(bodies="box"))
    rows = rows_of_state(world, state)
    values = world.wet_bodies.records.wet_parts(state.fluid, ["box"], state.p_WB)
    force, torque = rows.liquid["bodies/box/force"][0], rows.liquid["bodies/box/torque"][0]
    volume, centre = _under_water(world.model.bodies[0].origin, np.radians(10.0), 0.484375)
    assert force[2] == pytest.approx(1000.0 * 8.0 * volume, rel=1e-3)
    assert np.abs(values["bodies/box/buoyancy_centre"] - centre).max() <= 0.0015
    moment = np.cross(centre - state.p_WB[0], [0.0, 0.0, force[2]])
    assert np.abs(torque - moment).max() <= 0.0015 * force[2]


def _under_water(origin, angle, level):
    """Volume and centre of the part below z = level of the box of `tank`, turned about y."""
    c, s = np.cos(angle), np.sin(angle)
    corners = [(-0.125, -0.09375), (0.125, -0.09375), (0.125, 0.09375), (-0.125, 0.09375)]
    points = [(origin[0] + c * x + s * z, origin[2] - s * x + c * z) for x, z in corners]
    cut = []
    for (x0, z0), (x1, z1) in zip(points, points[1:] + points[:1], strict=True):
        if z0 <= level:
            cut.append((x0, z0))
        if (z0 <= level) != (z1 <= level):
            cut.append((x0 + (x1 - x0) * (level - z0) / (z1 - z0), level))
    x, z = np.array(cut).T
    x1, z1 = np.roll(x, -1), np.roll(z, -1)
    cross = x * z1 - x1 * z
    area = 0.5 * cross.sum()
    centre = np.array([((x + x1) * cross).sum(), 0.0, ((z + z1) * cross).sum()]) / (6.0 * area)
    centre[1] = origin[1]
    return abs(area) * 0.2, centre


def test_constant_pressure_and_bodies_under_water():
    """A ball wholly under water: wetted all over, displaced all of it, its centre its own."""
    world, state = begin(tank(bodies="ball"))
    values = world.wet_bodies.records.wet_parts(state.fluid, ["ball"], state.p_WB)
    assert values["bodies/ball/buoyancy_centre"] == pytest.approx(state.p_WB[0], abs=1e-4)
    assert values["bodies/ball/wetted_area"] == pytest.approx(4.0 * np.pi * 0.125**2, rel=0.05)
    dry, still = begin(tank(bodies="ball", fl="flht=.1,"))
    values = dry.wet_bodies.records.wet_parts(still.fluid, ["ball"], still.p_WB)
    assert values["bodies/ball/wetted_area"] == 0.0
    assert np.array_equal(values["bodies/ball/buoyancy_centre"], still.p_WB[0])
    assert not dry.wet_bodies.records.loads.total.any()


def test_what_keeps_a_prescribed_motion_holds_the_liquid_too():
    """m a = residual + weight + load of the liquid, in every row; the coupled body needs nothing."""
    seen = []
    play(FULL, 4, each=lambda world, state, report: seen.append((world, report.rows)))
    for world, rows in seen:
        assert len(rows.t)
        mass, gravity = world.arrays[0]["mass"], world.arrays[0]["gravity"]
        force = rows.liquid["bodies/ball/force"]
        assert np.abs(force).max() > 1.0
        assert rows.residual_force[:, 0] + force + mass * gravity == pytest.approx(0.0, abs=1e-10 * mass)
        assert not rows.residual_force[:, 1].any() and not rows.residual_torque[:, 1].any()


def test_work_of_a_prescribed_body_is_that_of_its_load():
    """Sum of - load . way; and energies of an instant are those of the liquid and the coupled bodies."""
    work, end = [0.0], {}

    def each(world, state, report):
        load = world.wet_bodies.records.loads.total[0]
        dt = state.fluid.dt
        work[0] -= load[:3] @ state.v_WB[0] * dt + load[3:] @ state.w_WB[0] * dt
        end.update({name: values[-1] for name, values in report.rows.energy.items()}, t=report.rows.t[-1] - state.t)

    world, state = play(tank(bodies="ball", output="thpltd(1)=1e-4,"), 6, each=each)
    assert state.books[2] == pytest.approx(work[0], rel=1e-9) and work[0] > 0.0
    from flowgmo.step import liquid_values

    values = liquid_values(world, state)
    assert values["energy/work_prescribed"] == state.books[2]
    assert values["energy/kinetic"] == values["fluid/kinetic_energy"]
    assert -values["energy/remainder"] < 1.5 * work[0]  # an impulsive start: half of the work, see wet_energy
    assert end["work_prescribed"] == pytest.approx(state.books[2], rel=0.2)


@pytest.mark.parametrize("free", [(1, 1, 1, 1, 1, 1), (0, 1, 0, 1, 0, 1), (1, 0, 1, 0, 0, 1), (1, 1, 1, 0, 1, 1)])
@pytest.mark.parametrize("hinge", [0, 2])
def test_kept_is_the_solution_with_constraints(free, hinge):
    """The equations with a Lagrange multiplier for each prescribed component."""
    rng = np.random.default_rng(3)
    body = np.zeros(1, BODY)[0]
    A = rng.normal(size=(3, 3))
    R = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    R *= np.sign(np.linalg.det(R))
    body["motion"], body["mass"], body["hinge"], body["coupled"] = FORCED, 2.5, hinge, free
    body["inertia"], body["arm"] = A @ A.T + np.eye(3), [0.3, -0.2, 0.5] if hinge else 0.0
    load = rng.normal(size=6)
    got = kept(body, R, load)
    arm, inertia, moment = body["arm"], body["inertia"], R.T @ load[3:]
    if hinge:
        inertia = inertia + 2.5 * (arm @ arm * np.eye(3) - np.outer(arm, arm))
        moment = moment + np.cross(arm, R.T @ load[:3])
    mask = np.array(free[3:], bool)
    G = np.eye(3)[~mask]
    system = np.block([[inertia, -G.T], [G, np.zeros((len(G), len(G)))]])
    answer = np.linalg.solve(system, np.concatenate([moment, np.zeros(len(G))]))
    assert got[3:] == pytest.approx(R @ (G.T @ answer[3:]), abs=1e-12)
    assert got[:3] == pytest.approx(0.0 if hinge else np.where(free[:3], 0.0, -load[:3]), abs=1e-12)
    body["coupled"] = 0
    assert np.array_equal(kept(body, R, load), -load)


@pytest.mark.parametrize("angle", [0.0, 1e-9, 0.3, 3.0])
def test_the_way_between_two_poses(angle):
    axis = np.array([0.6, 0.0, -0.8])
    poses = np.zeros(2, POSE)
    poses["q"][0] = [0.5, 0.5, -0.5, 0.5]
    w, x, y, z = poses["q"][0]
    a, (b, c, d) = np.cos(angle / 2), np.sin(angle / 2) * axis
    turned = [a * w - b * x - c * y - d * z, a * x + b * w + c * z - d * y, a * y - b * z + c * w + d * x]
    poses["q"][1] = [*turned, a * z + b * y - c * x + d * w]
    poses["p"][1] = [1.0, 2.0, 3.0]
    for sign in (1.0, -1.0):
        poses["q"][1] *= sign
        assert way_of(*poses) == pytest.approx([1.0, 2.0, 3.0, *(angle * axis)], abs=1e-15)


def test_a_probe_that_a_body_passes_reads_what_is_open():
    """In every step it is the probe that would be found anew; while the ball is there too."""
    text = tank(bodies="ball", grafic="xloc(1)=.43, yloc(1)=.37, zloc(1)=.3,")
    closed = []

    def each(world, state, report):
        (standing,) = world.watch.probes
        fresh = find_probe(1, standing.point, standing.block, standing.openings)
        now = standing.now()
        assert np.array_equal(now.cells.index, fresh.cells.index)
        assert np.array_equal(now.cells.weight, fresh.cells.weight)
        assert np.array_equal(now.floors, fresh.floors) and np.array_equal(now.areas, fresh.areas)
        closed.append(float(world.liquid.openings.V[REAL][6, 5, 4]))

    play(text, 20, each=each)
    assert min(closed) == 0.0 and closed[0] > 0.99
