"""A tank in which water sloshes around a box, for the tests of output and postproc: no deck, no solver, a formula.

First standing wave of linear theory:  surface s = h + a cos(k x) cos(omega t),  potential
phi = - a omega / k cosh(k z) / sinh(k h) cos(k x) sin(omega t)
"""

from types import SimpleNamespace

import numpy as np
from flowgmo_flows import DOWN, RHO, at_faces, block_of, centres, flow_of, openings_of, with_ghosts

from flowgmo.flow.fields import grid_of
from flowgmo.flow.observe.watch import Asked, Watch, at_once, between
from flowgmo.flow.team import Team
from flowgmo.flow_plan import FlowPlane, LoadPlan, SidePlan
from flowgmo.mesh import Mesh
from flowgmo.model import Effect
from flowgmo.output import Fields, History, Snapshots, write_restart, write_run_json
from flowgmo.records import Rows
from flowgmo.state import initial_state

LENGTH, WIDTH, TALL, DEEP, HIGH = 2.0, 0.8, 0.8, 0.4, 0.12
ROCK = np.array([[0.7, 0.25, 0.0], [1.0, 0.55, 0.28]])
K = np.pi / LENGTH
OMEGA = np.sqrt(9.81 * K * np.tanh(K * DEEP))
PROBES = ((1, (0.7, 0.4, 0.1)), (3, (1.9, 0.4, 0.05)))


def tank(scenes, n=(40, 16, 20), end=1.5, rock=True, ratio=1.3, bodies=None, **more):
    """Model of a tank with two probes, a plane, and the load of the rock. `made` holds its Open and walls."""
    block = block_of(n, hi=(LENGTH, WIDTH, TALL), ratio=ratio)
    sides = tuple(SidePlan(s, 2, np.zeros(1), np.array([[0.3 * (s == 5), 0.0, 0.0]])) for s in range(6))
    inf = np.full(3, np.inf)
    bodies = ([scenes.box(1, "rock", *ROCK)] if rock else []) if bodies is None else bodies
    plan = SimpleNamespace(
        rho=RHO,
        mu=1.0,
        no_slip=True,
        void_pressure=0.0,
        free_surface=True,
        sides=sides,
        planes=(FlowPlane(1, 0, 1.2, -inf, inf),),
        loads=(LoadPlan(1, np.zeros(3), True),) if rock else (),
    )
    values = {
        "title": "Water sloshes in a tank",
        "stem": "tank",
        "mesh": Mesh((block,), block.neighbours),
        "gravity": DOWN,
        "fluid": plan,
        "effects": (Effect("liquid", "a free surface", "RHOF"),),
        "resolved_deck": "A tank\n &bcdata\n  ibct(1)=2\n ibct(5)=2\n /\n",
    }
    model = scenes.build(bodies, end=end, **(values | more))
    object.__setattr__(model.output, "probes", np.array([x for _, x in PROBES]))
    object.__setattr__(model.output, "probe_numbers", tuple(k for k, _ in PROBES))
    return model


def solids(model):
    """Open and Shares of the rock."""
    block = model.mesh.blocks[0]
    return openings_of(block, [ROCK]) if model.bodies else openings_of(block, [])


def flow_at(model, t):
    """The wave at time t."""
    block = model.mesh.blocks[0]
    x, _, z = np.meshgrid(*centres(block), indexing="ij")
    surface = DEEP + HIGH * np.cos(K * x) * np.cos(OMEGA * t)
    planes = with_ghosts(block.z)
    F = np.clip((surface - planes[:-1]) / np.diff(planes), 0, 1)
    p = np.where(F >= 0.5, RHO * 9.81 * (surface - z), 0.0)
    size = HIGH * OMEGA / np.sinh(K * DEEP) * np.sin(OMEGA * t)
    u = at_faces(block, 0, lambda x, y, z: size * np.cosh(K * z) * np.sin(K * x))
    w = at_faces(block, 2, lambda x, y, z: -size * np.sinh(K * z) * np.cos(K * x))
    return flow_of(block, F, p, u, None if block.shape[1] == 1 else np.zeros_like(u), w)


def watch_of(model):
    block, (openings, walls) = model.mesh.blocks[0], solids(model)
    numbers, points = zip(*PROBES, strict=True)
    asked = Asked(numbers, np.array(points), {1: "rock"}, {1: walls[0]} if walls else {}, {})
    return Watch(model.fluid, block, grid_of(block), openings, DOWN, Team(1), asked)


def rows_of(model, t, liquid):
    n, k = len(model.bodies), len(t)
    still = np.zeros((k, n, 3))
    p = still + np.array([b.origin for b in model.bodies]).reshape(n, 3)
    q = np.tile([1.0, 0, 0, 0], (k, n, 1))
    return Rows(np.asarray(t, dtype=float), p, q, still, still, None, None, None, None, {}, liquid)


def write_tank(scenes, folder, snapshots=7, **more):
    """The results folder of a sloshing tank, as a run leaves it."""
    model = tank(scenes, **more)
    V = solids(model)[0].V if model.bodies else None
    watch, history = watch_of(model), History(folder, model)
    taken, cells = Snapshots(folder, model, V=V), Fields(folder, model, V=V)
    start = watch.measure(flow_at(model, 0.0), 0.0, np.zeros(6))["fluid/volume"]
    times = np.linspace(0, model.clock.end, 31)
    state = initial_state(model)
    before = watch.measure(flow_at(model, 0.0), start, np.zeros(6))
    history.write(rows_of(model, [0.0], at_once(before)))
    for t0, t1 in zip(times[:-1], times[1:], strict=True):
        after = watch.measure(flow_at(model, t1), start, np.zeros(6))
        asked = np.linspace(t0, t1, 4)[1:]
        history.write(rows_of(model, asked, between(before, after, t0, t1, asked)))
        before = after
    history.close()
    for t in np.linspace(0, model.clock.end, snapshots):
        state.t, state.fluid = float(t), flow_at(model, t)
        taken.write(state)
        cells.write(state)
    write_restart(folder / "restart.h5", model, state)
    write_run_json(
        folder / "run.json", {"status": "done", "reason": "TWFIN reached", "steps": 30, "t": model.clock.end}
    )
    return model
