"""Overlaps that drift has left are taken away by small shifts that do not touch velocities: no kinetic energy comes in.

The potential energy that a shift gives or takes is part of the run's remainder.
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.arena import Arena
from flowgmo.collision.positions import separate
from flowgmo.collision.shift import shift_all

TOLERANCE = 1e-6  # of the deepest overlap: what is left is taken away in the next step
MOST_SWEEPS = 500


class Corrector:
    """Shifts overlapping bodies apart; deepest: the largest overlap [length] that it met in the run."""

    def __init__(self, arena: Arena) -> None:
        self.arena = arena
        self.deepest = 0.0

    def correct(self, contacts: np.ndarray) -> np.ndarray:
        """Shift the bodies of arena.motion so that no contact (m,) overlaps; the contacts with their new gaps."""
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
        shift_all(parties[arena.movable[parties] == 1], arena.bodies, arena.motion, arena.responses, shifts)
        contacts = contacts.copy()
        contacts["gap"] += depths
        return contacts
