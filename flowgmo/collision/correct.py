"""Overlaps taken away by small shifts that do not touch velocities: no kinetic energy comes in.

The paths of held bodies end without overlap (landing.py); shifts are for what that leaves: hinges and stops, legs that
events cut, new points of contact, crowds. A shift lifts a body, or turns it, and so changes its energy all the same: it
is booked as what contact forces take (`dissipated`), and PATH.debt: the paths that follow pay it back where they can.
`given` says how much the shifts alone gave, which falls with h².
"""

from __future__ import annotations

import numpy as np

from flowgmo.bodies.energy import kinetic_energy, potential_energy
from flowgmo.collision.arena import Arena
from flowgmo.collision.positions import separate
from flowgmo.collision.shift import shift_all
from flowgmo.state import LOST_IN_FRICTION

TOLERANCE = 1e-9  # of the deepest overlap: more would leave the points of one edge at odds, a gap over a leg is a speed
MOST_SWEEPS = 500


class Corrector:
    """Shifts overlapping bodies apart; deepest [length]: largest overlap of the run, given [energy]: by all shifts."""

    def __init__(self, arena: Arena) -> None:
        self.arena = arena
        self.deepest, self.given = 0.0, 0.0

    def correct(self, contacts: np.ndarray, books: np.ndarray) -> np.ndarray:
        """Shift the bodies of arena.motion so that no contact (m,) overlaps; the contacts with their new gaps.

        books (4,) get the energy that the bodies gain, as a loss of contact forces with the other sign.
        """
        if not len(contacts):
            return contacts
        arena = self.arena
        touch = arena.touch[contacts["a"], contacts["b"]]
        if (contacts["gap"] >= -touch).all():
            return contacts
        depths = np.maximum(-contacts["gap"], 0.0)
        self.deepest = max(self.deepest, float(depths.max()))
        parties = np.unique(np.concatenate([contacts["a"], contacts["b"]]))
        arena.respond(parties)
        shifts = np.zeros_like(arena.twists)
        separate(contacts, depths, arena.responses, shifts, TOLERANCE, MOST_SWEEPS)
        parties = parties[arena.movable[parties] == 1]
        before = self._energy(parties)
        shift_all(parties, arena.bodies, arena.motion, arena.responses, shifts)
        gained = self._energy(parties) - before
        arena.paths["debt"][parties] += gained
        self.given += float(gained.sum())
        books[LOST_IN_FRICTION] -= float(gained.sum())
        contacts = contacts.copy()
        contacts["gap"] += depths
        return contacts

    def _energy(self, parties: np.ndarray) -> np.ndarray:
        """(k,) kinetic and potential energy of movable parties as they stand."""
        bodies, rows = self.arena.bodies[parties], self.arena.motion[parties]
        kinetic = kinetic_energy(bodies, rows["q"][None], rows["v"][None], rows["w"][None])
        return (kinetic + potential_energy(bodies, rows["p"][None]))[0]
