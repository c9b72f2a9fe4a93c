"""Stage `collisions`: the closed forms of balls where they do, the contact engine elsewhere.

A scene of balls and flats starts with the closed forms (collision/balls). When a ball comes to rest on something that
they do not know, the step is done again by the contact engine, which goes on from there: State.general remembers it.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from flowgmo.bodies.laws import Laws
from flowgmo.collision.contact import CONTACT
from flowgmo.model import Model
from flowgmo.state import State
from flowgmo.world import Room, World


class Collisions:
    """Made once in a run; each engine when it is first needed."""

    def __init__(self, model: Model, arrays: np.ndarray, laws: Laws | None) -> None:
        self.model, self.arrays, self.laws = model, arrays, laws
        self._balls = self._engine = None

    def notices(self) -> list[str]:
        """What the user should know of the contacts so far."""
        return self._engine.notices() if self._engine is not None else []

    @property
    def balls(self):  # noqa: ANN201 (balls.stage.Balls: importing it loads its kernels)
        if self._balls is None:
            from flowgmo.collision.balls.stage import Balls

            self._balls = Balls(self.model, self.arrays, self.laws)
        return self._balls

    @property
    def engine(self):  # noqa: ANN201 (engine.Engine: importing it loads its kernels)
        if self._engine is None:
            self._engine = _make_engine(self.model, self.arrays, self.laws)
        return self._engine


def _make_engine(model: Model, arrays: np.ndarray, laws: Laws | None):  # noqa: ANN202 (Engine or MicroEngine)
    """The engine with the search, the laws and the treatment of rest that the deck chose."""
    from flowgmo.collision.ahead import compile_ahead
    from flowgmo.collision.arena import Arena
    from flowgmo.collision.laws import choose_law

    compile_ahead()
    arena, law = Arena(model, arrays, laws), choose_law(model.contacts)
    if model.contacts.search == "grid":
        from flowgmo.collision.grid_watch import GridWatch as Search
    else:
        from flowgmo.collision.watch import Watch as Search
    if model.contacts.resting == "micro":
        from flowgmo.collision.micro import MicroEngine as Chosen
    else:
        from flowgmo.collision.engine import Engine as Chosen
    return Chosen(arena, law, Search(arena))


def move_colliding(world: World, state: State, t1: float, room: Room) -> None:
    """Move all bodies that may collide to t1 [time] through their impacts; records go to room.impacts.

    Raises StepFailed; step.py then leaves the state as it was.
    """
    collisions = world.collisions
    wet = world.wet_bodies is not None  # loads that change from step to step: no closed forms, and nobody sleeps
    closed = not wet and world.model.contacts.closed_form and not state.general
    if closed and collisions.balls.move(world, state, t1, room):
        return
    engine = collisions.engine
    if wet:
        engine.arena.reload(world.flying)
        engine.arena.owed[:] = 0.0
        engine.arena.wet = world.wet_bodies.impacts.response if world.model.contacts.wet else None
        engine.sleep.on = False
    engine.held = _held_of(state)
    engine.sleep.load(state.asleep, state.quiet)
    engine.busy = state.busy
    engine.move(state.t, t1, room)
    if wet:
        room.owed += engine.arena.owed
    room.held = (*_parts_of(engine.held), *engine.sleep.store(), engine.busy)


def meetings(
    world: World, state: State, motion: np.ndarray, coasting: np.ndarray, t1: float
) -> Iterator[tuple[float, np.ndarray, float]]:
    """See Engine.meetings; none where contacts are not located in time."""
    engine = world.collisions.engine
    if not getattr(engine, "watch", None) or not engine.watch.located:
        return iter(())
    engine.held = _held_of(state)
    return engine.meetings(coasting, motion, state.t, t1)


def _held_of(state: State) -> np.ndarray:
    """The contacts that stayed, from the State's arrays."""
    held = np.zeros(len(state.held_parts), CONTACT)
    for k, name in enumerate(("a", "b", "feature")):
        held[name] = state.held_parts[:, k]
    held["point"], held["normal"] = state.held_values[:, :3], state.held_values[:, 3:6]
    held["impulse"], held["age"] = state.held_values[:, 6:9], state.held_values[:, 9]
    return held


def _parts_of(held: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The State's arrays (m, 3) and (m, 10) of contacts that stayed."""
    parts = np.stack([held["a"], held["b"], held["feature"]], axis=1).astype(np.int64)
    values = np.concatenate([held["point"], held["normal"], held["impulse"], held["age"][:, None]], axis=1)
    return parts, values
