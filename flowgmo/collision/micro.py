"""Lasting contact as the report has it: a series of small collisions, one look a step (resting='micro').

    1  move everything freely to the end of the step
    2  find what touches or overlaps and approaches there
    3  resolve it as impacts; velocities change, places do not

Nothing is located in time and no overlap is corrected: bodies that rest on each other sink by what gravity moves them
in a step, and the more the larger the step and the smaller e. Kept to compare with.
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.arena import Arena
from flowgmo.collision.gather import no_contacts
from flowgmo.collision.grid_watch import GridWatch
from flowgmo.collision.laws import Law
from flowgmo.collision.ledger import Ledger
from flowgmo.collision.sleep import Sleep
from flowgmo.collision.strike import Striker
from flowgmo.collision.watch import Watch
from flowgmo.world import Room


class MicroEngine:
    """Same interface as engine.Engine; nothing is held."""

    def __init__(self, arena: Arena, law: Law, watch: Watch | GridWatch) -> None:
        self.arena, self.watch = arena, watch
        self.striker = Striker(arena, law)
        self.sleep = Sleep(arena)  # its bodies never sleep: only for the State
        self.held = no_contacts()
        self.busy = False  # always: only for the State
        self.ledger = Ledger(arena)
        self.deepest = 0.0

    def notices(self) -> list[str]:
        """What the user should know of the run so far."""
        if self.deepest == 0.0:
            return []
        return [f"deepest overlap of bodies: {self.deepest:.2e} (length); micro-collisions do not take it away"]

    def move(self, t0: float, t1: float, room: Room) -> None:
        """Bring room.motion (n,) from t0 to t1; room gets rows, records and books."""
        arena = self.arena
        arena.load(room.motion, t0)
        books, now, row = np.zeros(4), t0, 0
        while now < t1:
            longest = self.watch.longest()
            steps = max(1, int(np.ceil((t1 - now) / longest))) if np.isfinite(longest) else 1
            end = t1 if steps == 1 else now + (t1 - now) / steps
            while row < room.asked.size and room.asked[row] <= end:
                poses, lost = arena.poses(room.asked[row])
                room.rows[row, arena.movers] = poses
                room.rows_books[row] += books + lost
                row += 1
            room.stops.extend(arena.bring(arena.movers, end, books))
            contacts = self.watch.touching(self.held, arena.wakeful)
            contacts["fresh"] = 1
            self.deepest = max(self.deepest, float(-contacts["gap"].min(initial=0.0)))
            if len(contacts):
                room.impacts.extend(self.striker.strike(contacts, end, 0.0, False, books).records)
            now = end
        room.motion[arena.movers] = arena.motion[arena.movers]
        room.books += books
