"""Contacts that stay: their forces over a leg, the paths of the bodies they hold, and the books of their work.

    1  twists at the end of the leg if nothing touched       exact flight (respond.free_twists)
    2  contact impulses so that no contact approaches then   persistent.solve, Coulomb friction with sticking
    3  constant forces over the leg: HELD paths              paths.py

Work of an impulse p over the leg is p · (u(start) + u(end)) / 2 with u the velocity at the contact: exact for
velocities linear in time.
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.arena import Arena
from flowgmo.collision.gather import approaches, no_contacts
from flowgmo.collision.ledger import Ledger
from flowgmo.collision.persistent import IMPOSSIBLE, solve
from flowgmo.collision.respond import free_twists, set_paths

TURN = 0.05  # rad that a held body turns in one leg: the error of its path is a part of TURN³ of its size
FALL = 1e-3  # of a body's reach that gravity moves it in one leg
TOLERANCE = 1e-10  # of the largest free normal speed: what remains when the forces count as found
MOST_SWEEPS = 2000
PARTING = 1e-9  # of the largest change of normal speed in the leg: a smaller speed is round-off of the solution


class Holder:
    """Contact forces of the contacts that stay. held: those of the present legs, sorted by pair."""

    def __init__(self, arena: Arena) -> None:
        self.arena = arena
        n = len(arena.bodies)
        self.ends = np.zeros(n, arena.twists.dtype)
        self.load_books = np.zeros((n, 4))
        self.hits = np.zeros((0, 7))
        self.ledger = Ledger(arena)
        self.sweeps, self.solved, self.impossible = 0, 0, 0  # for the log: sweeps of all solutions, how many, in vain
        self.leg = np.inf  # length of the step [time]
        self.worst = 0.0  # largest residual so far, for the log

    def longest_leg(self, contacts: np.ndarray) -> float:
        """Time that bodies with these contacts may run on one path [time]; infinity without contacts."""
        arena = self.arena
        if not len(contacts):
            return np.inf
        parties = np.unique(np.concatenate([contacts["a"], contacts["b"]]))
        parties = parties[arena.movable[parties] == 1]
        rate = np.linalg.norm(arena.motion["w"][parties], axis=1)
        reach = arena.reach[parties]
        with np.errstate(divide="ignore"):
            leg = np.min(TURN / rate, initial=np.inf)
            if arena.gravity > 0.0:
                leg = min(leg, float(np.sqrt(2.0 * FALL * reach.min() / arena.gravity)))
        return leg

    def hold(self, contacts: np.ndarray, which: np.ndarray, now: float, end: float) -> np.ndarray:
        """Set the paths of the parties `which` from now to end under the contacts (m,) that may press them.

        Contacts with parties outside `which` take these as they are on their paths. Returns the contacts that stay,
        with their impulses over the leg.
        """
        arena = self.arena
        bodies = which[arena.movable[which] == 1]
        parties = np.unique(np.concatenate([bodies, contacts["a"], contacts["b"]]))
        arena.respond(parties)
        start = arena.twists.copy()
        free_twists(
            parties, arena.bodies, arena.motion, arena.paths, arena.laws, arena.spare, end,
            self.ends, self.load_books, self.hits,
        )  # fmt: skip
        pressed = np.zeros(len(arena.bodies), dtype=np.int64)
        if len(contacts):
            span = end - now
            # a gap left by drift closes within a whole leg, not within what is left of this one
            bias = np.maximum(contacts["gap"], 0.0) / max(span, min(self.leg, self.longest_leg(contacts)))
            free = self.ends.copy()
            self._solve(contacts, bias)
            push = np.linalg.norm(contacts["impulse"], axis=1) > 0.0
            for side in ("a", "b"):
                pressed[contacts[side][push]] = 1
            pressed[arena.movable == 0] = 0
            ends = self.ends
            ends[pressed == 0] = free[pressed == 0]
        set_paths(parties, pressed, arena.bodies, arena.motion, arena.paths, arena.responses, self.ends, now, end)
        if not len(contacts):
            return no_contacts()
        return self._staying(contacts, start, now, end)

    def _solve(self, contacts: np.ndarray, bias: np.ndarray) -> None:
        """Contact impulses over the leg; self.ends become the twists with them."""
        sweeps, residual, status = solve(contacts, bias, self.arena.responses, self.ends, TOLERANCE, MOST_SWEEPS)
        self.sweeps += sweeps
        self.solved += 1
        self.worst = max(self.worst, residual)
        self.impossible += status == IMPOSSIBLE

    def _staying(self, contacts: np.ndarray, start: np.ndarray, now: float, end: float) -> np.ndarray:
        """The contacts that push, or touch without parting; their work goes to the ledger."""
        arena = self.arena
        before, after = np.empty(len(contacts)), np.empty(len(contacts))
        approaches(contacts, arena.responses, start, before)
        approaches(contacts, arena.responses, self.ends, after)
        push = np.linalg.norm(contacts["impulse"], axis=1) > 0.0
        parting = np.abs(after) > PARTING * np.abs(after - before).max(initial=0.0)
        stays = push | ~(parting & (after > 0.0))
        held = contacts[stays].copy()
        held["fresh"] = 0
        held["age"] += end - now
        self.ledger.open(held, start, self.ends, now, end)
        return held
