"""Bodies at rest cost nothing: who sleeps, who falls asleep, who wakes (an effect, `sleep` in &FLOWGMO).

A body is quiet while it moves slower than QUIET sqrt(g R) at its surface. A set of bodies that touch each other falls
asleep when all of them have been quiet for LEGS legs and they touch nothing else that moves; its velocities are then
zero, which takes away less than QUIET² of m g R. Nothing is computed for it until something awake touches one of it.
A body with control loads or prescribed components does not sleep: they may move it at any time.
"""

from __future__ import annotations

import numpy as np

from flowgmo.bodies.arrays import DRIVEN
from flowgmo.collision.arena import Arena, lengths
from flowgmo.collision.gather import mark_joined
from flowgmo.collision.paths import ASLEEP, FREE

QUIET = 1e-8  # of sqrt(g R): solutions of the contact forces leave 1e-9 of g h, a tenth of that
LEGS = 10  # a body that turns round at the top of a hop is quiet for one


class Sleep:
    """asleep (n+6,): 1 for bodies that sleep; quiet (n+6,): legs for which a body has been quiet."""

    def __init__(self, arena: Arena) -> None:
        self.arena = arena
        n = len(arena.bodies)
        self.on = arena.model.contacts.sleep and arena.gravity > 0.0
        self.asleep, self.quiet = np.zeros(n, dtype=np.int64), np.zeros(n, dtype=np.int64)
        self.limit = QUIET * np.sqrt(arena.gravity * arena.finite_reach)
        self.driven = _driven(arena.bodies)

    def load(self, asleep: np.ndarray, quiet: np.ndarray) -> None:
        """Take (n,) each from the State."""
        n = self.arena.n
        self.asleep[:n], self.quiet[:n] = asleep, quiet

    def store(self) -> tuple[np.ndarray, np.ndarray]:
        """(n,) each for the State."""
        n = self.arena.n
        return self.asleep[:n].copy(), self.quiet[:n].copy()

    def add_forces(self, forces: np.ndarray, held: np.ndarray) -> None:
        """Contact forces (n, 3) of the bodies that sleep: those of the contacts held, as they were found last."""
        n = self.arena.n
        for side, sign in (("a", 1.0), ("b", -1.0)):
            rests = self.asleep[held[side]] == 1
            np.add.at(forces[:n], held[side][rests], sign * held["impulse"][rests])

    def awake(self) -> np.ndarray:
        """(n+6,) 1 for parties that may move now."""
        moves = (self.arena.movable == 1) | (self.arena.bodies["motion"] == DRIVEN)
        return (moves & (self.asleep == 0)).astype(np.int64)

    def begin(self) -> None:
        """Give the sleeping bodies their paths; called when a step's poses have been loaded."""
        self.arena.paths["mode"][self.asleep == 1] = ASLEEP

    def wake(self, bodies: np.ndarray, held: np.ndarray) -> np.ndarray:
        """Wake bodies (k,) and all sleeping ones joined to them by the contacts held; the numbers of those woken."""
        mark = np.zeros(len(self.asleep), dtype=np.int64)
        mark[bodies] = self.asleep[bodies]
        mark_joined(held, self.asleep, mark)
        woken = np.flatnonzero(mark)
        self.asleep[woken] = 0
        self.quiet[woken] = 0
        self.arena.paths["mode"][woken] = FREE
        return woken

    def fall_asleep(self, held: np.ndarray) -> None:
        """Count quiet legs, and let sets of bodies that have been quiet for long sleep; poses stand at a leg's end."""
        if not self.on:
            return
        arena = self.arena
        rows = arena.motion
        speed = lengths(rows["v"]) + lengths(rows["w"]) * arena.finite_reach
        rests = (speed <= self.limit) & (arena.movable == 1) & ~self.driven
        self.quiet = np.where(rests, self.quiet + 1, 0)
        tired = (self.quiet >= LEGS) & (self.asleep == 0)
        touched = np.zeros(len(tired), dtype=bool)  # only what lies on something rests
        touched[held["a"]] = touched[held["b"]] = True
        if not (tired & touched).any():
            return
        restless = np.where(self.quiet >= LEGS, 0, self.awake())  # what keeps those awake that it touches
        for one, two in (("a", "b"), ("b", "a")):
            restless[held[two][(restless[held[one]] == 1) & (arena.movable[held[two]] == 1)]] = 1
        mark_joined(held, arena.movable, restless)
        sleeps = np.flatnonzero(tired & touched & (restless == 0))
        self.asleep[sleeps] = 1
        rows["v"][sleeps] = 0.0
        rows["w"][sleeps] = 0.0


def _driven(bodies: np.ndarray) -> np.ndarray:
    """(k,) whether control loads act on a body, or a component of it is prescribed."""
    laws = np.concatenate([bodies["force"], bodies["torque"], bodies["drive"]], axis=1)
    loaded = (laws >= 0).any(axis=1) | (bodies["first_load"] < bodies["last_load"])
    return loaded & (bodies["mass"] > 0.0)
