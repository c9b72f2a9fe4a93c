"""Where the paths of held bodies end: on the surfaces that hold them, with the energy that contacts leave them.

Forces constant over a leg h leave velocities that do not approach at its end, but two errors of third order where
contacts turn. With a contact's velocity u(t) = c₁ t + c₂ t² in the leg, u(h) = 0 asks for c₁ = -c₂ h, and the gap then
ends at c₁ h²/2 + c₂ h³/3 = -c₂ h³/6: a block that pivots on an edge sinks a little on every leg. And the forces, which
no such contact lets do work, do that of the same order. Both are removed before the bodies move, in two projections:

    place     Find the displacements d, least in M, after which no contact overlaps at the end (positions.py); the path
              gets them in the course of the leg (paths.py). As a projection step of SHAKE or RATTLE does (Ryckaert,
              Ciccotti & Berendsen 1977; Andersen 1983), and like there velocities come from their own condition.

    energy    E(end) = E(start) - D in every island, where D is what contacts take by right (accounts.py). All
              velocities of the island are scaled by one factor

                  s² = 1 - (E(end) - E(start) + D) / T(end)          T: kinetic energy

              which keeps "no approach", linear in them (Shampine 1986: projection on the energy). The difference is
              d · (mean acceleration of the contacts): the path sinks and the lift gives that back but for this.
              It is done where nothing outside gives energy: no driven parties that move, no control loads, hinges or
              stops. E never rises from one end to the next, but for what the forces' tolerance leaves (ROUGH).

Measured (block that rocks, 15 legs a swing): overlap 2e-6 -> none, energy won between landings 3e-3 -> 1e-11 of all,
time of the fifth landing ten times nearer; scaling after shifts alone, without the path, made it worse.

An event may cut a leg where its energy is in between (a force works on the way into the overlap that d takes away):
the difference until then, PATH.excess, goes into the sum of the next leg of the same bodies.
"""

from __future__ import annotations

import numpy as np

from flowgmo.bodies.arrays import BALLISTIC
from flowgmo.collision.accounts import find_due, find_gains
from flowgmo.collision.arena import Arena, lengths
from flowgmo.collision.grid_watch import GridWatch
from flowgmo.collision.paths import poses_at
from flowgmo.collision.positions import separate
from flowgmo.collision.shift import shift_all
from flowgmo.collision.sweep import KEPT
from flowgmo.collision.watch import Watch

TOLERANCE = 1e-6  # of the deepest overlap: what is left is taken away in the next leg
MOST_SWEEPS = 500  # as in correct.py
MOST_PAID = 0.1  # of the kinetic energy, where a body turns back and has little; a loss beyond it is a real one

ROUGH = 1e-8  # of p g h, times 10 the tolerance of the solution for contact forces: what that leaves of the energy


class Landing:
    """Bends the paths of held bodies. lifts: sets of displacements; paid [energy]: taken by factors, in all."""

    def __init__(self, arena: Arena, watch: Watch | GridWatch) -> None:
        self.arena, self.watch = arena, watch
        self.no_hits, self.no_books = np.zeros((0, 7)), np.zeros(4)
        moves, stopped = arena.movable == 1, arena.bodies["stopped"] == 1
        self.odd = moves & ((arena.bodies["hinge"] != 0) | stopped)
        self.own = ~moves | ((arena.bodies["motion"] == BALLISTIC) & ~stopped)  # only gravity gives it energy
        self.group = np.full(len(moves), -1)  # islands of the present legs: -1 where energies are not kept
        self.until = np.full(len(moves), -np.inf)  # ends of the present legs [time]
        self.lifts, self.paid = 0, 0.0

    def land(
        self, contacts: np.ndarray, middle: np.ndarray, label: np.ndarray, start: np.ndarray, ends: np.ndarray,
        pressed: np.ndarray, now: float, end: float,
    ) -> np.ndarray:  # fmt: skip
        """Bend the HELD paths of arena from now to end that contacts (m,) press; ends (n+6,) of TWIST become theirs.

        contacts stand at the start, middle with their impulses in the middle; label (m,): islands, of which all
        contacts are there; pressed (n+6,). Returns (m, 2): power that contacts take by right, now and at the end.
        """
        arena, span = self.arena, end - now
        due = np.zeros((len(contacts), 2))
        odd = self._of_islands(self.odd, contacts, label, np.logical_or)
        if not self.watch.located or odd.all():
            return due
        contacts, middle, label = contacts[~odd], middle[~odd], label[~odd]
        which = arena.parties_of(contacts)
        bodies = which[(arena.movable[which] == 1) & (pressed[which] == 1)]
        poses_at(
            which, arena.bodies, arena.motion, arena.paths, arena.laws, end, arena.spare, self.no_books, self.no_hits
        )  # fmt: skip
        number = np.zeros(len(arena.bodies), dtype=np.int64)
        number[contacts["a"]], number[contacts["b"]] = label, label
        shifts = self._shifts(contacts, which, bodies, number)
        right = np.empty((len(contacts), 2))
        find_due(
            contacts, middle, arena.motion, arena.finite_reach, arena.movable, arena.responses, start, ends, span,
            arena.touch, right,
        )  # fmt: skip
        due[~odd] = right
        still = (arena.movable == 0) & (lengths(start["v"]) + lengths(start["w"]) == 0.0)
        rough = ROUGH * arena.gravity * span * lengths(middle["impulse"])
        own = self._of_islands(self.own & (still | (arena.movable == 1)), contacts, label, np.logical_and)
        part = self._parts(bodies, number, label[own], span * right[own].mean(axis=1), rough[own], now)
        self._bend(bodies, np.sqrt(1.0 - part[number[bodies]]), shifts, ends, span)
        mine = np.isin(number[bodies], label[own])
        self.group[bodies] = np.where(mine, number[bodies] + self.group.max() + 1, -1)
        self.until[bodies] = end
        return due

    def forget(self, parties: np.ndarray) -> None:
        """Begin the paths of the parties without displacements; what was lost or won on those before is no more."""
        paths = self.arena.paths
        for name in ("jerk", "sway", "twirl"):
            paths[name][parties] = 0.0

    def _of_islands(self, of: np.ndarray, contacts: np.ndarray, label: np.ndarray, both: np.ufunc) -> np.ndarray:
        """(m,) `both` (and, or) of a property of parties (n+6,) over all parties of a contact's island."""
        out = np.full(int(label.max()) + 1, both is np.logical_and)
        both.at(out, label, both(of[contacts["a"]], of[contacts["b"]]))
        return out[label]

    def _shifts(self, contacts: np.ndarray, which: np.ndarray, bodies: np.ndarray, number: np.ndarray) -> np.ndarray:
        """(n+6,) of TWIST [length, rad]: displacements after which the parties at arena.spare do not overlap.

        The bodies at arena.spare have them, then.
        """
        arena = self.arena
        shifts = np.zeros_like(arena.twists)
        there, _ = self.watch.again(contacts, arena.spare)
        if not (there["gap"] < -arena.touch[there["a"], there["b"]]).any():
            return shifts
        kept = arena.responses[which], arena.twists[which]
        arena.respond(which, arena.spare)
        separate(there, np.maximum(-there["gap"], 0.0), arena.responses, shifts, TOLERANCE, MOST_SWEEPS)
        reach = arena.finite_reach[bodies]
        # boxes of the broad phase follow the acceleration alone, which leads 2 d past the end, and are wider by KEPT
        far = np.maximum(2.0 * lengths(shifts["v"][bodies]), lengths(shifts["w"][bodies]) * reach) > KEPT * reach
        left = np.ones(len(shifts), dtype=bool)
        left[bodies] = np.isin(number[bodies], number[bodies[far]])
        shifts[left] = 0
        shift_all(bodies, arena.bodies, arena.spare, arena.responses, shifts)
        arena.responses[which], arena.twists[which] = kept
        self.lifts += 1
        return shifts

    def _parts(
        self,
        bodies: np.ndarray,
        number: np.ndarray,
        label: np.ndarray,
        taken: np.ndarray,
        rough: np.ndarray,
        now: float,
    ) -> np.ndarray:
        """(islands,) part of an island's kinetic energy at arena.spare that is too much; zero but for `label` (m,)."""
        arena = self.arena
        energy, excess, noise = np.zeros((3, int(number.max()) + 1))
        mine = np.zeros(energy.size, dtype=bool)
        mine[label] = True
        first, last, gains = np.empty((3, len(bodies)))
        find_gains(bodies, arena.bodies, arena.motion, arena.spare, first, last, gains)
        np.add.at(energy, number[bodies], last)
        np.add.at(excess, number[bodies], gains + self._owed(bodies, first, now))
        np.add.at(excess, label, taken)
        np.add.at(noise, label, rough)
        excess[np.abs(excess) <= noise] = 0.0
        part = np.zeros(energy.size)
        np.divide(excess, energy, out=part, where=mine & (energy > 0.0))
        part = np.where(part < -MOST_PAID, 0.0, np.minimum(part, MOST_PAID))  # a great loss is real
        self.paid += float(np.sum(part * energy))
        return part

    def _owed(self, bodies: np.ndarray, kinetic: np.ndarray, now: float) -> np.ndarray:
        """(k,) what the bodies' islands won on legs that were cut, shared as the kinetic energies (k,)."""
        cut = (self.group[bodies] >= 0) & (self.until[bodies] > now)
        if not cut.any():
            return np.zeros(len(bodies))
        known = self.group >= 0
        won, size = np.zeros((2, int(self.group.max()) + 1))
        np.add.at(won, self.group[known], self.arena.paths["excess"][known])
        np.add.at(size, self.group[bodies[cut]], kinetic[cut])
        share = np.zeros(len(bodies))
        share[cut] = won[self.group[bodies[cut]]] * kinetic[cut]
        return np.divide(share, size[self.group[bodies]], out=np.zeros(len(bodies)), where=cut & (share != 0.0))

    def _bend(self, bodies: np.ndarray, factor: np.ndarray, shifts: np.ndarray, ends: np.ndarray, span: float) -> None:
        """Give the paths of bodies (k,) factors (k,) of the velocities at their ends, and displacements."""
        paths = self.arena.paths
        less = (factor - 1.0)[:, None]
        for name, second, third in (("v", "acc", "jerk"), ("w", "alp", "twirl")):
            change = less * ends[name][bodies]
            shift = shifts[name][bodies] - 0.5 * span * change  # the end of the path stays
            ends[name][bodies] += change
            paths[second][bodies] += change / span + 6.0 / span**2 * shift
            paths[third][bodies] = -12.0 / span**3 * shift
            if name == "w":
                paths["sway"][bodies] = 6.0 / span**2 * shift
