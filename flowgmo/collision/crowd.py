"""Steps full of impacts: when to give up their order for a bounded cost.

A heap of spheres that still bounce meets hundreds of times a step, and each event concerns all that is joined. When the
impacts of a step have had MUCH contacts to do with, the leg ends and the rest of the step goes on in short legs: what
would overlap by no more than SHALLOW until the leg's end waits for it and is resolved with all the rest, others are met
at their time as ever. Clusters are then resolved pair after pair, and contact forces to a hundredth. Nothing passes,
nothing gains energy; what is lost is the order within a short leg. A step that has a fifth of that to
do besides leaves the next one so, too (State.busy): a heap that comes to rest returns to the exact way by itself.
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.arena import Arena, lengths

MUCH = 1500  # contacts in the clusters of impacts, summed over a step: a tenth of a second
SHALLOW = 0.04  # of the smaller reach: an overlap at the end of a busy leg that is taken away in the next
MOST_LEGS = 10  # of a busy step: what is too fast for them is still met at its time


class Crowd:
    """The work of the present step; later: meetings that were left to the end of their leg."""

    def __init__(self, arena: Arena) -> None:
        self.arena = arena
        self.work, self.later = 0, 0
        self.step = 0.0

    @property
    def busy(self) -> bool:
        """Whether what comes now is resolved in short legs."""
        return self.work > MUCH

    def begin(self, busy: bool, step: float) -> None:
        """A step [time] begins; busy: State.busy."""
        self.work = MUCH + 1 if busy else 0
        self.step = step

    def stays(self) -> bool:
        """State.busy after this step."""
        return self.work > MUCH + MUCH // 5

    def longest_leg(self, contacts: np.ndarray) -> float:
        """Time in which bodies in contact do not overlap by more than SHALLOW in a busy step; else no bound."""
        if not self.busy or not len(contacts):
            return np.inf
        arena = self.arena
        which = arena.parties_of(contacts)
        which = which[arena.movable[which] == 1]
        speed = lengths(arena.motion["v"][which]).max()  # two of them may meet: half the way for each
        leg = SHALLOW * arena.reach[which].min() / (2.0 * speed) if speed > 0.0 else np.inf
        return max(leg, self.step / MOST_LEGS)

    def waits(self, met: np.ndarray, span: float) -> bool:
        """Whether pairs met (k, 2) that went on as they are for a span [time] would hardly overlap."""
        arena = self.arena
        rows, reach = arena.motion, arena.finite_reach
        a, b = met.T
        speed = lengths(rows["v"][a] - rows["v"][b]) + arena.gravity * span
        speed += lengths(rows["w"][a]) * reach[a] + lengths(rows["w"][b]) * reach[b]
        shallow = (speed * span <= SHALLOW * np.minimum(arena.reach[a], arena.reach[b])).all()
        self.later += len(met) * bool(shallow)
        return bool(shallow) and len(met) > 0
