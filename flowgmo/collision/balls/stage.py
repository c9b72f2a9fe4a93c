"""From the Model's contact plan to the event kernel of balls, and its outcome back."""

from __future__ import annotations

import numpy as np

from flowgmo.bodies.laws import Laws
from flowgmo.collision.balls import resolve
from flowgmo.collision.balls.events import EVENT, MOST_EVENTS, run_events
from flowgmo.collision.balls.legs import LEG
from flowgmo.collision.balls.scene import build_scene
from flowgmo.errors import StepFailed
from flowgmo.mesh import SIDE_NAMES
from flowgmo.model import Model
from flowgmo.records import IMPACT
from flowgmo.state import State
from flowgmo.world import Room, World

#: Statuses that the contact engine can go on from.
FOR_THE_ENGINE = (resolve.SEVERAL_ROUGH, resolve.RESTS_ON_ROUND, resolve.LOCKED)


class Balls:
    """The scene's arrays and room to work, made once."""

    def __init__(self, model: Model, arrays: np.ndarray, laws: Laws | None) -> None:
        self.scene = build_scene(model, arrays, laws)
        self.legs = np.zeros(len(self.scene.balls), LEG)
        self.events = np.zeros(len(self.scene.balls), EVENT)
        self.others = self.events if len(self.scene.balls) > 1 else None
        self.count = np.zeros(1, dtype=np.int64)
        self.records = np.zeros((1024, resolve.WIDTH))

    def move(self, world: World, state: State, t1: float, room: Room) -> bool:
        """Move all balls to t1 [time] through their impacts; records go to room.impacts.

        False, with the room as it was: a ball comes to rest where no closed form holds. Raises StepFailed.
        """
        before = [part.copy() for part in self._parts(room)]
        books = np.zeros_like(room.books)  # what the collisions change: rows get the part until their time
        records, status, t, a, b = run_events(
            self.scene, world.arrays, world.laws, room.motion, self.legs, world.scratch, books, state.t, t1, room.asked,
            room.rows, room.contact_force, room.rows_books, self.records, self.count, self.events, self.others,
        )  # fmt: skip
        self.records = records
        if status in FOR_THE_ENGINE:
            for part, old in zip(self._parts(room), before, strict=True):
                part[...] = old
            return False
        if status != resolve.DONE:
            raise StepFailed(_reason(world.model, status, t, a, b))
        room.books += books
        if self.count[0]:
            room.impacts.append(_to_impacts(records[: self.count[0]], len(world.model.bodies)))
        return True

    @staticmethod
    def _parts(room: Room) -> tuple[np.ndarray, ...]:
        return room.motion, room.rows, room.contact_force, room.rows_books


def _to_impacts(records: np.ndarray, n: int) -> np.ndarray:
    """Kernel rows to the table of records.IMPACT: party numbers as in the deck, sides -1 .. -6."""
    out = np.zeros(len(records), IMPACT)
    out["time"] = records[:, resolve.TIME]
    for name, column in (("a", resolve.PARTY_A), ("b", resolve.PARTY_B)):
        party = records[:, column].astype(int)
        out[name] = np.where(party < n, party + 1, n - 1 - party)
    for name, column in (("point", resolve.POINT), ("normal", resolve.NORMAL), ("impulse", resolve.IMPULSE)):
        out[name] = records[:, column : column + 3]
    for name, column in (
        ("e", resolve.REST_E), ("mu", resolve.REST_MU), ("regime", resolve.REGIME),
        ("energy_loss", resolve.LOSS), ("count", resolve.COUNT),
    ):  # fmt: skip
        out[name] = records[:, column]
    return out


def _reason(model: Model, status: int, t: float, a: int, b: int) -> str:
    n = len(model.bodies)
    first = f"body {model.bodies[a].name}"
    second = "another body" if b < 0 else f"body {model.bodies[b].name}" if b < n else f"side {SIDE_NAMES[b - n]}"
    when = f"at t = {t:.6g}"
    if status == resolve.TOO_MANY:
        return (
            f"more than {MOST_EVENTS:,} impacts in one step, the last of them between {first} and {second} {when}: "
            "write a smaller delt, or smaller velocities"
        )
    return f"the motion of {first} could not be integrated {when}: its velocities grow without bound"
