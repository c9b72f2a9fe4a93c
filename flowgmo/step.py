"""One time step: the table of contents of the physics.

    move the bodies that nothing can hit         flight, prescribed motion, control loads, stops
    move the balls, impacts at their own times   collisions; absent where the deck has none

A scene with liquid adds, before these, the accelerations of the fluid, the average of the open fractions over the
bodies' motion, and the projection that finds pressure and bodies' velocities together; after them the open fractions
at the new pose and the motion of the liquid (not computed yet: `World.stages` has none of them).

Off means absent: `World.stages` holds only what the Model's effects ask for, and kernels get None for missing parts.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from flowgmo.bodies.arrays import POSE, STILL, pack
from flowgmo.bodies.energy import kinetic_energy, potential_energy
from flowgmo.bodies.laws import Laws
from flowgmo.bodies.move import move_alone
from flowgmo.errors import StepFailed
from flowgmo.model import Model
from flowgmo.records import IMPACT, LIMIT, Rows, no_impacts
from flowgmo.state import BOOKS, State, initial_state

KERNELS = "loading kernels"  # where the first call of every stage is booked
MAX_HITS = 4096  # stops that one step may record; further ones still act


@dataclass
class World:
    """What kernels need of a Model, made once: bodies (n,) of BODY, laws (None: all ballistic), stages, scratch."""

    model: Model
    arrays: np.ndarray
    laws: Laws | None
    movers: np.ndarray
    collisions: object | None
    stages: tuple[tuple[str, Callable], ...]
    scratch: np.ndarray
    energy_at_start: float
    ledger: tuple[tuple[str, int, float], ...]
    seconds: dict[str, float] = field(default_factory=dict)


@dataclass
class Report:
    """Rows and impacts of one step. Arrays as in records.Rows, books (k, 4)."""

    rows: Rows | None
    impacts: np.ndarray


def prepare(model: Model) -> World:
    """The World of a Model. Loads only the kernels that its effects need."""
    arrays, laws = pack(model.bodies, model.gravity)
    balls: tuple[int, ...] = model.contacts.balls if model.contacts else ()
    collisions = None
    stages: list[tuple[str, Callable]] = []
    moving = np.array([i for i, m in enumerate(arrays["motion"]) if m != STILL and i not in balls], dtype=np.int64)
    if moving.size:
        stages.append(("motion", _move_alone))
    if model.contacts is not None and any(arrays["motion"][i] != STILL for i in balls):
        from flowgmo.collision.stage import Collisions, move_colliding

        collisions = Collisions(model, arrays, laws)
        stages.append(("collisions", move_colliding))
    start = initial_state(model)
    energy = kinetic_energy(arrays, start.q_WB[None], start.v_WB[None], start.w_WB[None])[0]
    return World(
        model=model,
        arrays=arrays,
        laws=laws,
        movers=moving,
        collisions=collisions,
        stages=tuple(stages),
        scratch=poses_of(start),
        energy_at_start=float(energy[_coupled(model)].sum()),
        ledger=_ledger(model),
    )


def step(world: World, state: State, t1: float, asked: np.ndarray, landing: bool) -> Report:
    """Advance the scene from state.t to t1 [time].

    On return: every body is where its motion and its impacts bring it, no contact approaches, the books hold what was
    lost and given. asked (k,): times in (state.t, t1] whose exact states are wanted; they do not change the step.
    Raises StepFailed, with the state unchanged.
    """
    room = _Room(world, state, asked)
    for name, stage in world.stages:  # only what the deck asks for
        began = time.perf_counter()
        stage(world, state, t1, room)
        # a stage's first call compiles or loads its kernels: that is no cost of the effect
        booked = name if name in world.seconds else KERNELS
        world.seconds.setdefault(name, 0.0)
        world.seconds[booked] = world.seconds.get(booked, 0.0) + time.perf_counter() - began
    room.store(state)
    state.advance_clock(t1, landing)
    impacts = np.concatenate(room.impacts) if room.impacts else no_impacts()
    impacts = impacts[np.argsort(impacts["time"], kind="stable")]
    impacts["cluster"] = state.impacts + np.arange(len(impacts))
    state.impacts += len(impacts)
    rows = make_rows(world, asked, room.rows, room.contact_force, room.rows_books) if asked.size else None
    return Report(rows=rows, impacts=impacts)


def poses_of(state: State) -> np.ndarray:
    """The State's moving part as one array (n,) of dtype POSE."""
    poses = np.zeros(len(state.p_WB), POSE)
    for name, values in zip(POSE.names, _parts(state), strict=True):
        poses[name] = values
    return poses


def _parts(state: State) -> tuple[np.ndarray, ...]:
    """The State's arrays in the order of POSE."""
    return state.p_WB, state.q_WB, state.v_WB, state.w_WB, state.angle, state.hold, state.support


class _Room:
    """Where the stages of one step work: a copy of the state, so that a failed step leaves the state as it was.

    rows (k, n) of POSE start with the state, for bodies that do not move; rows_books (k, 4) with nothing.
    """

    def __init__(self, world: World, state: State, asked: np.ndarray) -> None:
        self.asked = asked
        self.motion = poses_of(state)
        self.books = state.books.copy()
        self.rows = np.repeat(self.motion[None], asked.size, axis=0)
        self.rows_books = np.zeros((asked.size, len(BOOKS)))
        self.contact_force = np.zeros((asked.size, len(self.motion), 3)) if world.collisions else None
        self.impacts: list[np.ndarray] = []

    def store(self, state: State) -> None:
        for name, values in zip(POSE.names, _parts(state), strict=True):
            values[...] = self.motion[name]
        state.books[:] = self.books


def rows_of_state(world: World, state: State) -> Rows:
    """One row: the state as it stands (used at t = 0)."""
    force = np.zeros((1, len(state.p_WB), 3)) if world.collisions else None
    return make_rows(world, np.array([state.t]), poses_of(state)[None], force, state.books[None])


def make_rows(
    world: World, t: np.ndarray, poses: np.ndarray, contact_force: np.ndarray | None, books: np.ndarray
) -> Rows:
    """History rows from states (k, n) of POSE: energies and residual loads are added here."""
    model, arrays = world.model, world.arrays
    p, q, v, w = (np.ascontiguousarray(poses[name]) for name in "pqvw")
    kinetic = kinetic_energy(arrays, q, v, w)
    residual = _residuals(world, t, poses)
    energy: dict[str, np.ndarray] = {}
    coupled = _coupled(model)
    if coupled.any():
        energy["kinetic"] = kinetic[:, coupled].sum(axis=1)
        energy["potential"] = potential_energy(arrays, p)[:, coupled].sum(axis=1)
        remainder = energy["kinetic"] + energy["potential"] - world.energy_at_start
        for name, place, sign in world.ledger:
            energy[name] = books[:, place]
            remainder = remainder - sign * books[:, place]
        energy["remainder"] = remainder
    has_mass = any(body.mass is not None for body in model.moving)
    return Rows(
        t=t,
        p_WB=p,
        q_WB=q,
        v_WB=v,
        w_WB=w,
        contact_force=contact_force,
        residual_force=residual[0] if residual else None,
        residual_torque=residual[1] if residual else None,
        kinetic_energy=kinetic if has_mass else None,
        energy=energy,
    )


def _residuals(world: World, t: np.ndarray, poses: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    if not world.model.has("residual"):
        return None
    from flowgmo.bodies.residual import residual_rows

    force, torque = np.zeros((*poses.shape, 3)), np.zeros((*poses.shape, 3))
    residual_rows(world.arrays, world.laws, t, poses, force, torque)
    return force, torque


def _ledger(model: Model) -> tuple[tuple[str, int, float], ...]:
    """Books that the scene's effects can write: name, place in State.books, +1 gives energy to the bodies, -1 takes."""
    calls = {
        "impacts": model.has("collisions") or model.has("stops"),
        "dissipated": model.has("friction"),
        "work_prescribed": model.has("prescribed") or model.has("residual"),
        "work_loads": model.has("control loads"),
    }
    return tuple((name, i, 1.0 if name.startswith("work") else -1.0) for i, name in enumerate(BOOKS) if calls[name])


def _coupled(model: Model) -> np.ndarray:
    return np.array([body.coupled for body in model.bodies], dtype=bool)


def _move_alone(world: World, state: State, t1: float, room: _Room) -> None:
    """Stage `motion`: bodies that nothing can hit; stops they meet become impacts with partner 0."""
    hits = np.zeros((MAX_HITS, 4))
    hit_body = np.zeros(MAX_HITS, dtype=np.int64)
    count, failed = move_alone(
        world.movers, world.arrays, world.laws, room.motion, room.books, state.t, t1, room.asked, room.rows,
        room.rows_books, hits, hit_body,
    )  # fmt: skip
    if failed >= 0:
        name = world.model.bodies[failed].name
        raise StepFailed(
            f"the motion of body {name} could not be integrated after t = {state.t:.6g}: its velocities grow without "
            "bound. Check its control loads, mass and inertia"
        )
    if count:
        room.impacts.append(_stop_records(world, state, hits[:count], hit_body[:count]))


def _stop_records(world: World, state: State, hits: np.ndarray, hit_body: np.ndarray) -> np.ndarray:
    """Records of stops met: partner 0, plastic; for an angle stop the impulse is the moment's, along the axis."""
    out = np.zeros(len(hits), IMPACT)
    out["time"] = hits[:, 0]
    out["a"] = hit_body + 1
    out["regime"] = LIMIT
    out["energy_loss"] = hits[:, 3]
    out["count"] = 1
    for i, (b, k, amount) in enumerate(zip(hit_body, hits[:, 1].astype(int), hits[:, 2], strict=True)):
        direction = np.eye(3)[k] if k < 3 else world.arrays["axis"][b]
        out["impulse"][i] = amount * direction
        out["normal"][i] = np.sign(amount) * direction
        out["point"][i] = state.p_WB[b] if k < 3 else world.arrays["point"][b]
    return out
