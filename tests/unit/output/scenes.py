"""Small scenes and results for the tests of output and postproc: no deck, no solver, closed-form motion."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from flowgmo.bodies.body import COUPLED, FIXED_AXIS, PRESCRIBED, SOLID, Body, MassData
from flowgmo.mesh import SYMMETRY, WALL, Block, Mesh, Side
from flowgmo.model import ClockPlan, Effect, Intervals, Model, OutputPlan
from flowgmo.output import History, Snapshots, write_restart, write_run_json
from flowgmo.records import IMPACT, SLIP, Rows
from flowgmo.state import initial_state

GRAVITY = 9.81


class BallShape:
    """Stands for a geometry.Component that is a ball."""

    def __init__(self, centre, radius):
        self.centre, self.radius = np.asarray(centre, dtype=float), radius

    def bounds(self):
        return np.array([self.centre - self.radius, self.centre + self.radius])

    def triangles(self, resolution=48, clip=None):
        n, m = resolution, resolution // 2
        around, down = np.meshgrid(2 * np.pi * np.arange(n) / n, np.pi * np.arange(m + 1) / m)
        points = np.stack([np.sin(down) * np.cos(around), np.sin(down) * np.sin(around), np.cos(down)], axis=-1)
        k, j = np.meshgrid(np.arange(m), np.arange(n), indexing="ij")
        a, b = (k * n + j).ravel(), (k * n + (j + 1) % n).ravel()
        faces = np.concatenate([np.stack([a, a + n, b], 1), np.stack([b, a + n, b + n], 1)])
        return self.centre + self.radius * points.reshape(-1, 3), faces


class BoxShape:
    """Stands for a geometry.Component that is a box; clipped by intersecting it."""

    def __init__(self, lo, hi):
        self.lo, self.hi = np.asarray(lo, dtype=float), np.asarray(hi, dtype=float)

    def bounds(self):
        return np.array([self.lo, self.hi])

    def triangles(self, resolution=48, clip=None):
        lo, hi = (self.lo, self.hi) if clip is None else (np.maximum(self.lo, clip[0]), np.minimum(self.hi, clip[1]))
        points = lo + (hi - lo) * np.array([[i, j, k] for k in (0, 1) for j in (0, 1) for i in (0, 1)])
        squares = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
        return points, np.array([t for a, b, c, d in squares for t in ((a, b, c), (a, c, d))])


def ball(number, name, centre, radius=0.1, **more):
    mass = 4.2e3 * radius**3
    data = MassData(mass, np.asarray(centre, dtype=float), 0.4 * mass * radius**2 * np.eye(3))
    more = {"kind": COUPLED, "mass": data} | more
    return Body(number, name, BallShape(centre, radius), origin=np.asarray(centre, dtype=float), **more)


def box(number, name, lo, hi, **more):
    middle = (np.asarray(lo, dtype=float) + hi) / 2
    return Body(number, name, BoxShape(lo, hi), origin=middle, **({"kind": SOLID} | more))


def build(bodies, lo=(-0.3, -0.3, -0.1), hi=(0.3, 0.3, 0.9), end=2.0, units="si", **more):
    planes = [np.linspace(a, b, 11) for a, b in zip(lo, hi, strict=True)]
    sides = tuple(Side(k, WALL if k > 3 else SYMMETRY) for k in range(6))
    every = Intervals(np.array([end / 10]), np.zeros(0))
    often = Intervals(np.array([end / 1000]), np.zeros(0))
    values = {
        "title": "A ball bounces on an anvil",
        "stem": "anvil",
        "units": units,
        "resolved_deck": "A ball\n &xput\n  twfin = 2.0, ! deck\n  gz = -9.81, ! deck\n  tpltd(1)=0.2\n /\n"
        " &obs obsid(1)='it''s ! a = name' /\n",
        "clock": ClockPlan(end, end / 1000, end * 1e-8, Intervals(np.array([1e10]), np.zeros(0)), 10**9),
        "output": OutputPlan(often, every, every, every, 600.0, np.zeros((0, 3))),
        "gravity": np.array([0.0, 0.0, -GRAVITY]),
        "mesh": Mesh((Block(*planes, neighbours=sides, name="all"),), sides),
        "bodies": tuple(bodies),
        "contacts": None,
        "effects": (Effect("collisions", "bodies hit each other", "ICLID=1"),),
        "fluid": None,
        "notices": ("IFVOF 5 means 6",),
    }
    return Model(**(values | more))


def anvil(**more):
    """A ball of radius 0.1 whose lowest point is 0.5 above an anvil that reaches out of the domain."""
    return build([ball(1, "ball", [0, 0, 0.6]), box(2, "anvil", [-1, -1, -0.5], [1, 1, 0])], **more)


def all_kinds(**more):
    """One body of every kind: coupled, prescribed without mass, solid, on a fixed axis."""
    mass = MassData(2.0, np.array([0.5, 0, 0]), None, axis_moment=0.3)
    lever = box(4, "lever", [0.4, -0.1, -0.1], [0.6, 0.1, 0.1], kind=COUPLED, constraint=FIXED_AXIS, mass=mass)
    piston = box(2, "piston", [-0.2, -0.2, -0.1], [0.2, 0.2, 0.0], kind=PRESCRIBED)
    return build([ball(1, "ball", [0, 0, 0.6]), piston, box(3, "rock", [-0.3, -0.3, -0.1], [0, 0, 0]), lever], **more)


def random_rows(model, t, seed=0, **absent):
    """Rows of arbitrary numbers at times t; `contact_force=None` etc. leave a quantity out."""
    random = np.random.default_rng(seed)
    k, n = len(t), len(model.bodies)
    vector = {
        name: random.normal(size=(k, n, 3))
        for name in ("p_WB", "v_WB", "w_WB", "contact_force", "residual_force", "residual_torque")
    }
    q = random.normal(size=(k, n, 4))
    energy = {name: random.normal(size=k) for name in ("kinetic", "potential", "impacts", "dissipated")}
    values = {
        "t": np.asarray(t, dtype=float),
        "q_WB": q / np.linalg.norm(q, axis=-1, keepdims=True),
        "kinetic_energy": random.normal(size=(k, n)),
        "energy": energy,
        **vector,
    }
    return Rows(**(values | absent))


def bounces(e=0.8, height=0.5, end=2.0):
    """Times of the impacts of a ball dropped from a height, and its speed after each."""
    t, speed, times, speeds = np.sqrt(2 * height / GRAVITY), np.sqrt(2 * GRAVITY * height), [], []
    while t < end and speed > 1e-3:
        speed *= e
        times.append(t)
        speeds.append(speed)
        t += 2 * speed / GRAVITY
    return np.array(times), np.array(speeds)


def flight(t, e=0.8, height=0.5):
    """Height of the lowest point and vertical velocity at times t."""
    times, speeds = bounces(e, height, end=1e9)
    k = np.searchsorted(times, t, side="right") - 1
    start, speed = np.append(times, 0.0)[k], np.append(speeds, 0.0)[k]
    z0 = np.where(k < 0, height, 0.0)
    past = t - start
    z, v = z0 + speed * past - GRAVITY * past**2 / 2, speed - GRAVITY * past
    rest = (k == len(times) - 1) | (z < 0)
    return np.where(rest, 0.0, z), np.where(rest, 0.0, v)


def anvil_rows(model, t):
    """Exact rows of the bouncing ball; it turns slowly about x."""
    z, v = flight(t)
    k = len(t)
    p, velocity, w, q = np.zeros((k, 2, 3)), np.zeros((k, 2, 3)), np.zeros((k, 2, 3)), np.zeros((k, 2, 4))
    p[:, 0, 2], velocity[:, 0, 2], w[:, 0, 0] = z + 0.1, v, 1.0
    p[:, 1] = model.bodies[1].origin
    q[:, :, 0], q[:, 0, 0], q[:, 0, 1] = 1.0, np.cos(t / 2), np.sin(t / 2)
    mass = model.bodies[0].mass.mass
    kinetic, potential = mass * v**2 / 2, mass * GRAVITY * z
    impacts = mass * GRAVITY * 0.5 - kinetic - potential
    energy = {"kinetic": kinetic, "potential": potential, "impacts": impacts, "remainder": np.zeros(k)}
    return Rows(t, p, q, velocity, w, None, None, None, np.stack([kinetic, 0 * kinetic], 1), energy)


def anvil_impacts(model, end=2.0):
    times, speeds = bounces(end=end)
    table = np.zeros(len(times), IMPACT)
    table["time"], table["a"], table["b"], table["normal"] = times, 1, 2, [0, 0, 1]
    table["impulse"][:, 2] = model.bodies[0].mass.mass * speeds * (1 + 1 / 0.8)
    table["energy_loss"] = model.bodies[0].mass.mass * speeds**2 * (1 / 0.64 - 1) / 2
    table["e"], table["regime"], table["cluster"], table["count"] = 0.8, SLIP, np.arange(len(times)), 1
    return table


def write_anvil(folder: Path, end=2.0):
    """The results folder of a bouncing ball, as a run leaves it."""
    model = anvil(end=end)
    history, snapshots = History(folder, model), Snapshots(folder, model)
    t = np.linspace(0, end, 1001)
    history.write(anvil_rows(model, t))
    history.write_impacts(anvil_impacts(model, end))
    history.close()
    state = initial_state(model)
    for t_k in np.linspace(0, end, 11):
        rows = anvil_rows(model, np.array([t_k]))
        state.t, state.p_WB, state.q_WB = float(t_k), rows.p_WB[0], rows.q_WB[0]
        state.v_WB, state.w_WB = rows.v_WB[0], rows.w_WB[0]
        snapshots.write(state)
    write_restart(folder / "restart.h5", model, state)
    write_run_json(folder / "run.json", {"status": "done", "reason": "TWFIN reached", "steps": 1000, "t": end})
    return model


def write_crowd(folder: Path, n=6, end=2.0):
    """Several balls of different sizes thrown over a floor: results with many bodies and tumbling boxes."""
    random = np.random.default_rng(3)
    bodies = [box(1, "floor", [-3, -3, -1], [3, 3, 0])]
    for k in range(n):
        place = np.array([0.5 * (k % 3) - 0.5, 0.6 * (k // 3) - 0.3, 0.3])
        if k % 2:
            size = np.array([0.12, 0.16, 0.07])
            mass = MassData(1.0 + k, place, np.eye(3))
            bodies.append(box(k + 2, f"box{k}", place - size, place + size, kind=COUPLED, mass=mass))
        else:
            bodies.append(ball(k + 2, f"ball{k}", place, 0.1 + 0.01 * k))
    model = build(bodies, lo=(-1.2, -1, -0.15), hi=(1.2, 1, 1.6), end=end, title="A crowd of bodies thrown up")
    t = np.linspace(0, end, 501)
    rows = random_rows(model, t, contact_force=None, residual_force=None, residual_torque=None)
    v0 = random.normal(size=(n, 3)) * [0.2, 0.2, 0.2] + [0, 0, 4.5]
    rows.p_WB[:] = [body.origin for body in bodies]
    rows.v_WB[:], rows.w_WB[:], rows.q_WB[:] = 0, 0, [1, 0, 0, 0]
    rows.kinetic_energy[:] = 0
    for k in range(n):
        rise = np.maximum(v0[k, 2] * t - GRAVITY * t**2 / 2, 0)
        rows.p_WB[:, k + 1, :2] += v0[k, :2] * t[:, None]
        rows.p_WB[:, k + 1, 2] += rise
        rows.v_WB[:, k + 1] = v0[k]
        rows.v_WB[:, k + 1, 2] = np.where(rise > 0, v0[k, 2] - GRAVITY * t, 0)
        rows.q_WB[:, k + 1, 0], rows.q_WB[:, k + 1, 1] = np.cos(k * t), np.sin(k * t)
    for name in rows.energy:
        rows.energy[name] = np.cumsum(np.abs(rows.energy[name])) / 500
    history, snapshots, state = History(folder, model), Snapshots(folder, model), initial_state(model)
    history.write(rows)
    impacts = np.zeros(20 * n, IMPACT)
    impacts["time"] = np.sort(random.uniform(0.85, 1.5, len(impacts)))
    impacts["a"], impacts["b"] = random.integers(2, n + 2, len(impacts)), random.integers(-6, 2, len(impacts))
    impacts["impulse"], impacts["normal"], impacts["count"] = random.normal(size=(len(impacts), 3)), [0, 0, 1], 1
    history.write_impacts(impacts)
    history.close()
    for k in range(0, 501, 50):
        state.t, state.p_WB, state.q_WB = float(t[k]), rows.p_WB[k], rows.q_WB[k]
        state.v_WB, state.w_WB = rows.v_WB[k], rows.w_WB[k]
        snapshots.write(state)
    return model
