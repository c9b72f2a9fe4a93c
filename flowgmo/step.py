"""One time step: the table of contents of the physics.

    move the bodies that nothing can hit         flight, prescribed motion, control loads, stops
    move the others, impacts at their own times  collisions; absent where the deck has none

A scene with liquid has, before these,

    open fractions for the step                  mean of now and of where bodies that move are expected
    predict u* = u + dt a                        advection, gravity, viscosity
    project: u, p, and velocities of bodies      the faces of every liquid cell let out what they let in

and after them

    move the liquid                              with the projection's fluxes, into what the bodies leave open now

Off means absent: `World.stages` holds only what the Model's effects ask for, and kernels get None for missing parts.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from flowgmo.bodies.arrays import STILL, pack
from flowgmo.bodies.laws import Laws
from flowgmo.bodies.move import move_alone
from flowgmo.errors import StepFailed, StepTooLong
from flowgmo.model import Model
from flowgmo.records import CLUSTER, IMPACT, LIMIT, Rows, no_impacts
from flowgmo.rows import energy_at_start, ledger_of, make_rows, wet_energy
from flowgmo.state import State, initial_state
from flowgmo.world import Room, World, poses_of

KERNELS = "loading kernels"  # where the first call of every stage is booked
MAX_HITS = 64  # stops that one step may record; further ones still act


@dataclass
class Report:
    """Rows and impacts of one step. Arrays as in records.Rows, books (k, 4)."""

    rows: Rows | None
    impacts: np.ndarray


def prepare(model: Model) -> World:
    """The World of a Model. Loads only the kernels that its effects need."""
    arrays, laws = pack(model.bodies, model.gravity)
    plan = model.contacts
    before, after, liquid, wet = _flow_stages(model, arrays, laws)
    flying, flying_laws = (arrays, laws) if wet is None else (wet.flying, wet.flying_laws)
    colliding = set(np.flatnonzero(plan.allowed.any(axis=1)).tolist()) if plan else set()
    collisions = None
    stages: list[tuple[str, Callable]] = []
    moving = np.array([i for i, m in enumerate(arrays["motion"]) if m != STILL and i not in colliding], dtype=np.int64)
    if moving.size:
        stages.append(("motion", _move_alone))
    if any(arrays["motion"][i] != STILL for i in colliding if i < len(arrays)):
        from flowgmo.collision.stage import Collisions, move_colliding

        collisions = Collisions(model, flying, flying_laws)
        stages.append(("collisions", move_colliding))
    watch = None
    if liquid is not None:
        from flowgmo.flow.observe.shear_of_solids import shear_of_solids
        from flowgmo.flow.observe.watch import watch_of

        (block,) = model.mesh.blocks
        shear = shear_of_solids(liquid, block.planes) if model.fluid.loads else {}
        watch = watch_of(model, liquid, liquid.walls, shear)
    momentum = None
    if wet is not None and wet.explicit is None:
        from flowgmo.momentum_book import MomentumBook

        momentum = MomentumBook(model, wet, watch)
    return World(
        model=model,
        arrays=arrays,
        laws=laws,
        movers=moving,
        collisions=collisions,
        liquid=liquid,
        wet_bodies=wet,
        flying=flying,
        flying_laws=flying_laws,
        watch=watch,
        stages=(*before, *stages, *after),
        scratch=poses_of(initial_state(model)),
        energy_at_start=energy_at_start(model, arrays),
        ledger=ledger_of(model),
        momentum=momentum,
    )


def _flow_stages(model: Model, arrays: np.ndarray, laws: Laws | None) -> tuple[list, list, object, object]:
    """Stages before and after the bodies' motion, the Liquid and WetBodies that they work with; none in a dry scene."""
    if model.fluid is None:
        return [], [], None, None
    from flowgmo.flow import stages
    from flowgmo.flow.build import build_liquid

    liquid = build_liquid(model)

    def predict(world: World, state: State, t1: float, room: Room) -> None:
        stages.predict(liquid, state.fluid, t1, t1 - state.t)

    def project(world: World, state: State, t1: float, room: Room) -> None:
        stages.project(liquid, state.fluid, t1 - state.t)

    if liquid.immersed is not None:
        return _stages_with_bodies(model, arrays, laws, liquid, predict)

    def move_liquid(world: World, state: State, t1: float, room: Room) -> None:
        stages.move_liquid(liquid, state.fluid, t1 - state.t, state.step)

    after = [("liquid", move_liquid)] if model.fluid.free_surface else []
    return [("momentum", predict), ("pressure", project)], after, liquid, None


def _stages_with_bodies(
    model: Model, arrays: np.ndarray, laws: Laws | None, liquid: object, predict: Callable
) -> tuple[list, list, object, object]:
    """As _flow_stages, where bodies move in the liquid."""
    from flowgmo.flow import stages
    from flowgmo.wet_bodies import WetBodies
    from flowgmo.wet_stops import book_hits

    wet = WetBodies(model, arrays, laws, liquid)
    alone = wet.explicit

    def expect(world: World, state: State, t1: float, room: Room) -> None:
        told = None if alone is None else alone.foresee(state, room.motion, t1)
        wet.impacts.foresee(world, state, room.motion if told is None else told, t1)
        wet.expect(state, room.motion, t1, told)

    def project(world: World, state: State, t1: float, room: Room) -> None:
        dt = t1 - state.t
        wet.kick(state.fluid, state, room.motion, state.t, t1)
        try:
            stages.project(liquid, state.fluid, dt, wet.couple)
        except StepFailed as error:
            raise wet.explained(error) from error
        liquid.immersed.restore_short()
        wet.finish(liquid.projector.q, room.motion, room.rows, partial(wet.impacts.meet, world, state, room.motion, t1))
        shear = wet.shear_loads() if wet.friction is not None else None
        wet.records.note(liquid.p, shear, wet.squeezed[wet.movers] if wet.film is not None else None)

    def project_after_bodies(world: World, state: State, t1: float, room: Room) -> None:
        try:
            stages.project(liquid, state.fluid, t1 - state.t)
        except StepFailed as error:
            raise wet.explained(error) from error
        liquid.immersed.restore_short()
        alone.finish(room.motion, room.rows, room.owed)

    def arrive(world: World, state: State, t1: float, room: Room) -> None:
        wet.impacts.check_ways(poses_of(state), room.motion, room.impacts, state.t, t1)
        liquid.immersed.arrive(wet.poses(room.motion))
        of = poses_of(state), room.motion, wet.wet, wet.blows
        wet.records.book(room.books, *of, wet.middle, t1 - state.t)

    def move_liquid(world: World, state: State, t1: float, room: Room) -> None:
        stages.move_liquid(liquid, state.fluid, t1 - state.t, state.step)

    def answer_impacts(world: World, state: State, t1: float, room: Room) -> None:
        _record_stops(world, room)
        given = wet.impacts.settle(state.fluid, room.motion, room.owed, room.met)
        if given is None:
            return
        if world.momentum is not None:
            world.momentum.answer(given)
        book_hits(wet.arrays, room.motion, room.met, wet.wet, wet.reached, given, room.books)

    solve = project if alone is None else project_after_bodies
    before = [("open fractions", expect), ("momentum", predict), ("pressure", solve)]
    after = [("open fractions", arrive)]
    if model.fluid.free_surface:
        after.append(("liquid", move_liquid))
    stops = alone is None and (arrays["stopped"][wet.coupled] == 1).any()
    if model.contacts.wet if wet.loaded else stops:
        after.append(("wet impacts", answer_impacts))
    return before, after, liquid, wet


def start_liquid(world: World, state: State) -> None:
    """Give the state its liquid at t = 0, where the scene has any and the state none (it was not read from a file).

    On return the open fractions are those of the state's poses, and planes are found with the state's moments.
    """
    if world.liquid is None:
        return
    if world.wet_bodies is not None:
        world.wet_bodies.stand(poses_of(state), state.held_parts, state.held_values)
    if state.fluid is None:
        from flowgmo.flow.build import initial_flow

        state.fluid = initial_flow(world.liquid, world.model)
        if world.wet_bodies is not None:
            world.wet_bodies.records.at_start(state.fluid, state.p_WB)
            state.fluid.start_energy += world.wet_bodies.records.around_balls(state.fluid)
        if world.momentum is not None:
            world.momentum.open(state)
    world.liquid.take_moments(state.fluid)


def step(world: World, state: State, t1: float, asked: np.ndarray, landing: bool) -> Report:
    """Advance the scene from state.t to t1 [time].

    On return: every body is where its motion and its impacts bring it, no contact approaches, the books hold what was
    lost and given. asked (k,): times in (state.t, t1] whose exact states are wanted; they do not change the step.
    Raises StepFailed, with the state unchanged.
    """
    room = Room(world, state, asked)
    t0, liquid = state.t, liquid_values(world, state) if asked.size else {}
    for name, stage in world.stages:  # only what the deck asks for
        began = time.perf_counter()
        try:
            stage(world, state, t1, room)
        except (StepFailed, StepTooLong):
            if world.wet_bodies is not None:
                world.liquid.immersed.withdraw()
            raise
        # a stage's first call compiles or loads its kernels: that is no cost of the effect
        booked = name if name in world.seconds else KERNELS
        world.seconds.setdefault(name, 0.0)
        world.seconds[booked] = world.seconds.get(booked, 0.0) + time.perf_counter() - began
    _check_finite(world, room, t1)
    momenta = None if world.momentum is None else world.momentum.step(state, room.motion, t1 - state.t)
    rates = state.rates if world.wet_bodies is None else world.wet_bodies.rates(state, room.motion, t1)
    room.store(state)
    state.rates[...] = rates
    if world.liquid is not None:
        world.liquid.store(state.fluid, t1 - state.t)
        state.fluid.momenta = momenta
    state.advance_clock(t1, landing)
    _record_stops(world, room)
    impacts = _in_order(room.impacts, state)
    if not asked.size:
        return Report(rows=None, impacts=impacts)
    if world.watch is not None:
        from flowgmo.flow.observe.watch import between

        liquid = between(liquid, liquid_values(world, state), t0, t1, asked)
    loads = None
    if world.wet_bodies is not None:
        loads = world.wet_bodies.records.of_all(len(state.p_WB))
        liquid |= world.wet_bodies.records.values(world.wet_bodies.names, asked.size)
    rows = make_rows(world, asked, room.rows, room.contact_force, room.rows_books, liquid, loads)
    return Report(rows=rows, impacts=impacts)


def liquid_values(world: World, state: State) -> dict:
    """What is recorded of the liquid as it stands, found once a step; {} in a dry scene."""
    if world.watch is None:
        return {}
    if world.measured is not None and world.measured[0] == state.step:
        return world.measured[1]
    began, flow = time.perf_counter(), state.fluid
    values = world.watch.at(state.step, flow, flow.start_volume, flow.passed)
    if world.wet_bodies is not None:
        wet = world.wet_bodies
        kinetic, momentum = wet.records.carried_along(state, wet.middles(poses_of(state)))
        values = values | wet.records.wet_parts(flow, wet.names, state.p_WB)
        if around := wet.records.around_balls(flow):
            values["fluid/potential_energy"] += around
        values = values | wet_energy(world, state, values, kinetic)
        if world.momentum is not None:
            values = values | world.momentum.values(state, momentum)
    world.measured = state.step, values
    booked = "gauges" if "gauges" in world.seconds else KERNELS
    world.seconds.setdefault("gauges", 0.0)
    world.seconds[booked] = world.seconds.get(booked, 0.0) + time.perf_counter() - began
    return values


def _in_order(tables: list[np.ndarray], state: State) -> np.ndarray:
    """One table of impacts by time; each table is one cluster, or (cluster 0 in all rows) impacts apart."""
    for table in tables:
        many = table["regime"] == CLUSTER
        table["cluster"] = np.where(many, 0, np.arange(len(table)))
    impacts = []
    for table in tables:
        table["cluster"] += state.impacts
        state.impacts = int(table["cluster"].max(initial=state.impacts - 1)) + 1
        impacts.append(table)
    together = np.concatenate(impacts) if impacts else no_impacts()
    return together[np.argsort(together["time"], kind="stable")]


def _check_finite(world: World, room: Room, t1: float) -> None:
    """No infinity or nan may enter the state."""
    finite = np.isfinite(room.books).all()
    for name in ("p", "q", "v", "w"):
        good = np.isfinite(room.motion[name]).all(axis=1)
        if not good.all():
            body = world.model.bodies[int(np.argmin(good))].name
            raise StepFailed(f"the motion of body {body} leaves the range of numbers before t = {t1:.6g}")
    if not finite:
        raise StepFailed(f"the energy of the bodies leaves the range of numbers before t = {t1:.6g}")


def _move_alone(world: World, state: State, t1: float, room: Room) -> None:
    """Stage `motion`: bodies that nothing can hit; stops they meet become impacts with partner 0."""
    hits = np.zeros((MAX_HITS, 7))
    hit_body = np.zeros(MAX_HITS, dtype=np.int64)
    count, failed = move_alone(
        world.movers, world.flying, world.flying_laws, room.motion, room.books, state.t, t1, room.asked, room.rows,
        room.rows_books, hits, hit_body,
    )  # fmt: skip
    if failed >= 0:
        name = world.model.bodies[failed].name
        raise StepFailed(
            f"the motion of body {name} could not be integrated after t = {state.t:.6g}: its velocities grow without "
            "bound. Check its control loads, mass and inertia"
        )
    if count:
        _add_stops(world, room, hits[:count], hit_body[:count])


def _record_stops(world: World, room: Room) -> None:
    """Stops that colliding bodies met become impacts."""
    if room.stops:
        _add_stops(world, room, np.array([row for _, row in room.stops]), np.array([body for body, _ in room.stops]))
        room.stops.clear()


def _add_stops(world: World, room: Room, hits: np.ndarray, hit_body: np.ndarray) -> None:
    """Records of stops met, and who met them."""
    table = _stop_records(world, hits, hit_body)
    room.impacts.append(table)
    room.met += [(int(b), int(hit[1]), row) for b, hit, row in zip(hit_body, hits, table, strict=True)]


def _stop_records(world: World, hits: np.ndarray, hit_body: np.ndarray) -> np.ndarray:
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
        out["point"][i] = hits[i, 4:7]
    return out
