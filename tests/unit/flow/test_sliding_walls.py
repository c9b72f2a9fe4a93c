"""Walls whose speed is a table of time: the liquid follows them, in every stage of a step."""

import numpy as np
import pytest
from flowgmo_wet import wet
from flowgmo_wet_runs import REAL, advance, start
from scipy.integrate import solve_ivp

from flowgmo.flow.columns import all_columns
from flowgmo.flow.fields import Open
from flowgmo.flow.momentum import momentum as momentum_of
from flowgmo.flow.momentum.wall_shear import find_side_walls, slide
from flowgmo.mesh import WALL

NU, N, END = 0.1, 8, 1.0
TABLE = np.array([[0.0, 0.0], [0.3, 1.5], [0.7, -1.0], [1.5, 0.2]])  # time, speed: bends inside the run
NONE = Open(None, None, None, None)


def lid(axis="x", side=6, xput="", table=TABLE, solid=""):
    """A channel in z, periodic in x and y, whose side slides along `axis` by the table."""
    name = {"x": "ubct", "y": "vbct"}[axis]
    times = ", ".join(f"timbct({n})={t}" for n, (t, _) in enumerate(table, 1))
    speeds = ", ".join(f"{name}({n},{side})={u}" for n, (_, u) in enumerate(table, 1))
    return wet(
        f"twfin={END}, itb=0, ifvisc=1, {xput}", props=f"rhof=2., mu1={2.0 * NU},", fl="", obs=solid,
        mesh=f"px=0., .5, nxcelt=2, py=0., .5, nycelt=2, pz=0., 1., nzcelt={N},",
        bcdata=f"ibct=4,4,4,4,2,2, {times}, {speeds},",
    )  # fmt: skip


def discrete(side=6, end=END):
    """The profile at the end by the same differences in space, and none in time (tolerance 1e-12)."""
    h = 1.0 / N

    def rate(t, u):
        wall = np.interp(t, *TABLE.T)
        below, above = (-u[0], 2.0 * wall - u[-1]) if side == 6 else (2.0 * wall - u[0], -u[-1])
        return NU * np.diff(np.diff(np.concatenate([[below], u, [above]]))) / h**2

    bends = [t for t in TABLE[:, 0] if 0.0 < t < end]
    u, t = np.zeros(N), 0.0
    for stop in [*bends, end]:
        u, t = solve_ivp(rate, (t, stop), u, method="DOP853", rtol=1e-12, atol=1e-14).y[:, -1], stop
    return u


def profile(text, dt):
    liquid, flow, _ = start(text)
    liquid.longest_step = lambda flow, first: dt
    advance(liquid, flow, dt, END)
    return flow


@pytest.mark.parametrize("axis, side, xput", [("x", 6, ""), ("y", 5, ""), ("x", 6, "impvis=1,")])
def test_the_liquid_follows_the_lid(axis, side, xput):
    """Errors of the profile at steps of 1/80 and 1/160, of speeds up to 1.5: measured 4.4e-3 and 2.4e-3 explicit
    (with the walls of both stages at the step's end; less if each has its own), 3.8e-3 and 1.9e-3 implicit. A lid that
    keeps its speed of t = 0 stays at rest."""
    wanted = discrete(side)
    errors = []
    for steps in (80, 160):
        flow = profile(lid(axis, side, xput), END / steps)
        u = flow.velocity["xy".index(axis)][REAL]
        assert np.ptp(u, axis=(0, 1)).max() < 1e-12
        errors.append(np.abs(u[0, 0] - wanted).max())
    assert errors[1] < 3e-3 and errors[0] > 1.8 * errors[1]


def test_stages_at_their_own_times_are_of_second_order():
    """Heun's method with the walls of each stage's time, as stages.predict passes them; the bends of the table lie on
    steps. Measured 2.08 and 2.04, and 2e-5 at last; walls of one time for both stages give 1."""
    wanted, errors = discrete(), []
    for steps in (50, 100, 200):
        liquid, flow, _ = start(lid())
        dt, u = END / steps, flow.velocity
        columns = all_columns(liquid.shape)

        def rate(velocity, t, liquid=liquid, columns=columns, dt=dt):
            a = [np.zeros_like(q) for q in velocity]
            liquid.sides.fill_velocity(velocity)
            liquid.momentum.add_accelerations(columns, velocity, None, a, dt, time=t)
            return a

        for n in range(steps):
            first = rate(u, n * dt)
            second = rate([q + dt * a for q, a in zip(u, first, strict=True)], (n + 1) * dt)
            u = [q + 0.5 * dt * (a + b) for q, a, b in zip(u, first, second, strict=True)]
        errors.append(np.abs(u[0][REAL][0, 0] - wanted).max())
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert (orders > 1.9).all() and errors[-1] < 3e-5, (errors, orders)


def test_a_step_that_is_tried_again_reads_its_own_time():
    """A failed step of four times the length leaves no trace."""
    flows = []
    for failed in (False, True):
        liquid, flow, _ = start(lid())
        for n in range(20):
            if failed:
                momentum_of_the_step(liquid, flow, n * 0.01, 0.04)
            advance_once(liquid, flow, n * 0.01, 0.01)
        flows.append(flow)
    assert np.array_equal(flows[0].u, flows[1].u) and flows[0].u.any()


def momentum_of_the_step(liquid, flow, t, dt):
    from flowgmo.flow import stages

    stages.predict(liquid, flow, t + dt, dt)


def advance_once(liquid, flow, t, dt):
    from flowgmo.flow import stages

    stages.predict(liquid, flow, t + dt, dt)
    stages.project(liquid, flow, dt)
    liquid.store(flow, dt)


def test_constant_tables_are_read_once(monkeypatch):
    """Also those with many times, those of walls that do not hold, and those of other kinds of sides."""
    monkeypatch.setattr(momentum_of, "slide", None)
    level = TABLE * [1.0, 0.0] + [0.0, 0.7]
    for text in (lid(table=level), lid(xput="iwsh=0,"), lid().replace("ibct=4,4,4,4,2,2", "ibct=4,4,4,4,2,6")):
        liquid, flow, _ = start(text)
        assert liquid.momentum.walls == ()
        advance(liquid, flow, 0.01, most=2)
    assert len(start(lid())[0].momentum.walls) == 2


def test_sides_that_meet_in_an_edge_slide_apart():
    """Their mean, each by its share of s; sides square to the component, and absent ones, say nothing."""
    from momentum_scenes import mesh

    grid = mesh((4, 3, 5), (1.0, 0.9, 0.5), 0.3)
    no_slip = (True,) * 6
    walls = find_side_walls(grid, NONE, no_slip, np.zeros((6, 3)), 0, (True,) * 3)
    assert not walls.speed.any()
    speeds = np.arange(18.0).reshape(6, 3) + 1.0
    slide(walls, speeds)
    for row, s, speed in zip(walls.rows, walls.s, walls.speed, strict=True):
        own = [(2.0 / grid.dy[row[1]] ** 2, speeds[2 + (row[1] > 2), 0])] if row[1] in (2, 4) else []
        own += [(2.0 / grid.dz[row[2]] ** 2, speeds[4 + (row[2] > 2), 0])] if row[2] in (2, 6) else []
        assert s == pytest.approx(sum(a for a, _ in own), rel=1e-14)
        assert speed == pytest.approx(sum(a * b for a, b in own) / s, rel=1e-14)
    before = walls.speed.copy()
    speeds[:2], speeds[:, 1:] = 99.0, -99.0
    slide(walls, speeds)
    assert np.array_equal(walls.speed, before)


def test_the_deck_gives_the_table():
    liquid, _, _ = start(lid())
    side = liquid.plan.sides[5]
    assert side.kind == WALL and side.at(0.5).velocity == pytest.approx([0.25, 0.0, 0.0])
