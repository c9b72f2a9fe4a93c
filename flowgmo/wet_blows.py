"""Steps that impacts have cut short: their pressure is a blow, which bodies have got before anything hits them.

The liquid of a step fits U, the bodies' velocities at its end. An impact within the step has by its law the impulse J
at the velocity V- that it meets, which becomes V+ = V- + (M + A)^-1 J, and books what these lose; afterwards
(wet_impacts.py) liquid and bodies go on with U + (M + A)^-1 J:

    booked  - (V- + V+) . J / 2          lost  - (U + U + (M + A)^-1 J) . J / 2          booked - lost  (U - V-) . J

U - V- is what the load of the rest of the step makes of a velocity. The liquid has paid for it, or was paid, as if the
body had not been hit: energy that nobody gave. Where a step ends right behind its impact (wet_impacts.AFTER) nearly
nothing of the load is left: 2e-3 of what is booked. A step is cut to wet_impacts.LEAST of itself at once, though, and
short ones are not cut again, so that in these the impact is anywhere. And in so short a time pressure is no force: it
is what surface and walls that are elsewhere make of the velocities at once (ball of a tenth of the water's density
near a lid: 1.52 -> 1.26 m/s in 4e-5 s). So a body goes with U through a short step, and through one of any length
that was cut to end with an impact, as bodies do that nothing can hit; an impact meets that, and what it books is what
bodies and liquid lose.

Bodies that others hold need the load as a force, to be pressed by it, and keep it; so do those of which something is
prescribed.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

SHORT = 0.11  # of a step that nothing has shortened: those cut to wet_impacts.LEAST of it, and a little for rounding


class Blow(NamedTuple):
    """Of one body in one step. told (6,) [force, moment about B]: what it moves on with in place of the liquid's load
    and control loads, its weight taken back; way (6,): displacement and turn along which the liquid's load works."""

    told: np.ndarray
    way: np.ndarray


def find_struck(arrays: np.ndarray, wet: list[int], held: np.ndarray) -> np.ndarray:
    """(k,) bool: which of the bodies `wet`, rows of arrays (n,) BODY, may go through a step with the velocities of its
    end. held (m, 2): parties of contacts that are kept."""
    which = np.array(wet, dtype=np.int64)
    free = (arrays["hinge"][which] == 0) & arrays["coupled"][which].astype(bool).all(axis=1)
    return free & ~np.isin(which, held)


def strike(
    arrays: np.ndarray, wet: list[int], struck: np.ndarray, U: np.ndarray, ways: np.ndarray, motion: np.ndarray
) -> dict[int, Blow]:
    """Bodies wet[n] with struck[n] get U (k, 6), their velocities at the end of the step, in motion (n,) POSE now; by
    row what they go on with. ways (k, 6): as in Blow."""
    blows = {}
    for b, own, way in ((wet[n], U[n], ways[n]) for n in np.flatnonzero(struck)):
        motion["v"][b], motion["w"][b] = own[:3], own[3:]
        blows[b] = Blow(np.concatenate([-arrays["mass"][b] * arrays["gravity"][b], np.zeros(3)]), way)
    return blows
