"""Bodies that go through a step with the velocities of its end, as the liquid does: those that nothing holds.

The liquid of a step fits U, the bodies' velocities at its end: what a body takes of the cells before it, and opens
behind it, is that of a way dt U. With the step's load as a constant force it goes dt (U0 + U) / 2 instead: where it
gains speed it leaves voids before it, and cells too full behind, by half of a dt2 each step; where it loses speed
the other way round. PUSH gives back half of it in each step: .0017 of a ball that a valve's flow takes along, .04 to
.08 of the cells behind light balls, under water, where nothing is void and nothing has room.

So a body goes with U from the step's begin on, as one does that nothing can hit (wet_bodies.py): at first it gets a
blow, after which nothing changes its velocity but impacts. The load works along the mean of both velocities: that is
what the motion gains. Between its steps the body's way is that of symplectic Euler, like the liquid's.

**Impacts in the step.** One has by its law the impulse J at the velocity V- that it meets, which becomes
V+ = V- + (M + A)^-1 J, and books what these lose; afterwards (wet_impacts.py) liquid and bodies go on with
U + (M + A)^-1 J:

    booked  - (V- + V+) . J / 2          lost  - (U + U + (M + A)^-1 J) . J / 2          booked - lost  (U - V-) . J

U - V- is what the load of the rest of the step makes of a velocity. The liquid has paid for it, or was paid, as if the
body had not been hit: energy that nobody gave. Bodies that go with U have V- = U: what an impact books is what bodies
and liquid lose. In steps that impacts have cut short pressure is no force at all, it is what surface and walls that
are elsewhere make of the velocities at once (ball of a tenth of the water's density near a lid: 1.52 -> 1.26 m/s in
4e-5 s).

**Where the load stays a force.** Bodies that others hold are pressed by it. And a blow a dt would throw what has just
come to rest, or nearly, against its bed again and again: a body that would meet something in the step no faster than
SOFT times what the load makes of the velocities keeps it too (WetImpacts.meet), unless the step is a short one, or cut
to end with an impact. So do bodies about fixed axes and points, at stops, or with a part of their turns prescribed.
What is prescribed of a body goes on as it does, and its load with it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

SHORT = 0.11  # of a step that nothing has shortened: those cut to wet_impacts.LEAST of it, and a little for rounding


class Blow(NamedTuple):
    """Of one body in one step. told (6,) [force, moment about B]: what it moves on with in place of the liquid's load
    and control loads, its weight taken back; way (6,): displacement and turn along which the liquid's load works, of
    components that are not prescribed; prescribed (6,) bool."""

    told: np.ndarray
    way: np.ndarray
    prescribed: np.ndarray

    def way_with(self, gone: np.ndarray) -> np.ndarray:
        """(6,): `way`, and of prescribed components what the body has gone (6,)."""
        return np.where(self.prescribed, gone, self.way)


def find_struck(arrays: np.ndarray, wet: list[int], motion: np.ndarray, held: np.ndarray) -> np.ndarray:
    """(k,) bool: which of the bodies `wet`, rows of arrays (n,) BODY and motion (n,) POSE, may go through a step with
    the velocities of its end. held (m, 2): parties of contacts that are kept."""
    which = np.array(wet, dtype=np.int64)
    turns = arrays["coupled"][which, 3:].astype(bool)
    free = (arrays["hinge"][which] == 0) & ~motion["hold"][which].any(axis=1) & (turns.all(axis=1) | ~turns.any(axis=1))
    return free & ~np.isin(which, held)


def strike(
    arrays: np.ndarray, wet: list[int], struck: np.ndarray, U: np.ndarray, loads: np.ndarray, ways: np.ndarray,
    motion: np.ndarray,
) -> dict[int, Blow]:  # fmt: skip
    """Bodies wet[n] with struck[n] get U (k, 6), their velocities at the end of the step, in motion (n,) POSE now; by
    row what they go on with. loads (k, 6): of liquid and control, for what is prescribed; ways (k, 6): as in Blow."""
    blows = {}
    for n in np.flatnonzero(struck):
        b = wet[n]
        solved, weight = arrays["coupled"][b].astype(bool), arrays["mass"][b] * arrays["gravity"][b]
        motion["v"][b] = np.where(solved[:3], U[n, :3], motion["v"][b])
        motion["w"][b] = np.where(solved[3:], U[n, 3:], motion["w"][b])
        told = np.where(solved, np.concatenate([-weight, np.zeros(3)]), loads[n])
        blows[b] = Blow(told, np.where(solved, ways[n], 0.0), ~solved)
    return blows
