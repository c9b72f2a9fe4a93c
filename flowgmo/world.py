"""What a run keeps beside the Model and the State: kernels' arrays made once, and the room in which one step works."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from flowgmo.bodies.arrays import POSE
from flowgmo.bodies.laws import Laws
from flowgmo.model import Model
from flowgmo.state import State


@dataclass
class World:
    """What kernels need of a Model, made once: bodies (n,) of BODY, laws (None: all ballistic), stages, scratch.

    wet_bodies: those that move in the liquid (wet_bodies.py); flying (n,) BODY: what the motion of bodies uses, the
    same array as `arrays` but for those; with flying_laws. momentum: its book (momentum_book.py), where they do.
    measured: number of a step, and what was recorded of the liquid after it.
    """

    model: Model
    arrays: np.ndarray
    laws: Laws | None
    movers: np.ndarray
    collisions: object | None
    liquid: object | None
    wet_bodies: object | None
    flying: np.ndarray
    flying_laws: Laws | None
    watch: object | None
    stages: tuple[tuple[str, Callable], ...]
    scratch: np.ndarray
    energy_at_start: float
    ledger: tuple[tuple[str, int, float], ...]
    momentum: object | None = None
    measured: tuple[int, dict] | None = None
    seconds: dict[str, float] = field(default_factory=dict)


class Room:
    """Where the stages of one step work: a copy of the state, so that a failed step leaves the state as it was.

    rows (k, n) of POSE and rows_books (k, 4) start with the state; every stage adds what it changes until each row.
    """

    def __init__(self, world: World, state: State, asked: np.ndarray) -> None:
        self.asked = asked
        self.motion = poses_of(state)
        self.books = state.books.copy()
        self.owed = state.owed.copy()
        self.rows = np.repeat(self.motion[None], asked.size, axis=0)
        self.rows_books = np.repeat(state.books[None], asked.size, axis=0)
        self.contact_force = np.zeros((asked.size, len(self.motion), 3)) if world.collisions else None
        self.impacts: list[np.ndarray] = []
        self.stops: list[tuple[int, np.ndarray]] = []  # stops that colliding bodies met: body, row of forced.note_hit
        self.met: list[tuple[int, int, np.ndarray]] = []  # stops in records: body, component 0 .. 3, its row of IMPACT
        self.held: tuple | None = None  # contacts that stay, sleep, busy, if the contact engine ran

    def store(self, state: State) -> None:
        """Make this the state."""
        for name, values in zip(POSE.names, _parts(state), strict=True):
            values[...] = self.motion[name]
        state.books[:] = self.books
        state.owed[:] = self.owed
        if self.held is not None:
            state.held_parts, state.held_values, state.asleep, state.quiet, state.busy = self.held
            state.general = True


def poses_of(state: State) -> np.ndarray:
    """The State's moving part as one array (n,) of dtype POSE."""
    poses = np.zeros(len(state.p_WB), POSE)
    for name, values in zip(POSE.names, _parts(state), strict=True):
        poses[name] = values
    return poses


def _parts(state: State) -> tuple[np.ndarray, ...]:
    """The State's arrays in the order of POSE."""
    return state.p_WB, state.q_WB, state.v_WB, state.w_WB, state.angle, state.hold, state.support
