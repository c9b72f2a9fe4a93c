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
              What no contact changes is not scaled (accounts.find_common): a velocity that an island has as a whole
              where nothing outside pushes it that way, and the spin of a body that is pushed through its centre.

Measured (block that rocks, 15 legs a swing): overlap 2e-6 -> none, energy won between landings 3e-3 -> 1e-11 of all,
time of the fifth landing ten times nearer; scaling after shifts alone, without the path, made it worse.

An event may cut a leg where its energy is in between (a force works on the way into the overlap that d takes away):
the difference until then, PATH.excess, goes into the sum of the next leg of the same bodies. So does what a shift
(correct.py) has given them, PATH.debt.
"""

from __future__ import annotations

import numpy as np

from flowgmo.bodies.arrays import BALLISTIC
from flowgmo.collision.accounts import find_common, find_due, find_gains
from flowgmo.collision.arena import Arena, lengths
from flowgmo.collision.gather import islands
from flowgmo.collision.grid_watch import GridWatch
from flowgmo.collision.paths import poses_at
from flowgmo.collision.positions import separate
from flowgmo.collision.shift import shift_all
from flowgmo.collision.sweep import KEPT
from flowgmo.collision.watch import Watch

TOLERANCE = 1e-9  # of the deepest overlap; 1e-6 leaves mirrored points different gaps, hold.py contradictory data
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
        arena = self.arena
        due = np.zeros((len(contacts), 2))
        if not self.watch.located:
            return due
        plain = self._all_of(~self.odd, contacts, label)
        if not plain.any():
            return due
        contacts, middle, label = contacts[plain], middle[plain], label[plain]
        which = arena.parties_of(contacts)
        bodies = which[(arena.movable[which] == 1) & (pressed[which] == 1)]
        poses_at(
            which, arena.bodies, arena.motion, arena.paths, arena.laws, end, arena.spare, self.no_books, self.no_hits
        )  # fmt: skip
        shifts = self._shifts(contacts, label, which, bodies)
        push = lengths(middle["impulse"]) > 0.0
        if push.any():
            right = self._balance(contacts[push], middle[push], bodies, start, ends, shifts, now, end)
            due[np.flatnonzero(plain)[push]] = right
        return due

    def _balance(
        self, contacts: np.ndarray, middle: np.ndarray, bodies: np.ndarray, start: np.ndarray, ends: np.ndarray,
        shifts: np.ndarray, now: float, end: float,
    ) -> np.ndarray:  # fmt: skip
        """Bend the paths of bodies (k,) by shifts (n+6,) and by the energy of each island of contacts (m,) that push.

        Returns (m, 2): power that contacts take by right, now and at the end.
        """
        arena, span = self.arena, end - now
        label = np.empty(len(contacts), dtype=np.int64)
        count = islands(contacts, arena.movable, label)
        number = np.zeros(len(arena.bodies), dtype=np.int64)
        number[contacts["a"]], number[contacts["b"]] = label, label
        right = np.empty((len(contacts), 2))
        find_due(
            contacts, middle, arena.motion, arena.finite_reach, arena.movable, arena.responses, start, ends, span,
            arena.touch, right,
        )  # fmt: skip
        common, turned = np.empty((count, 3)), np.zeros(len(number), dtype=np.int64)
        find_common(
            contacts, middle, label, bodies, number, arena.bodies, arena.spare, arena.movable, arena.responses, common,
            turned,
        )  # fmt: skip
        still = (arena.movable == 0) & (lengths(start["v"]) + lengths(start["w"]) == 0.0)
        rough = ROUGH * arena.gravity * span * lengths(middle["impulse"])
        own = self._all_of(self.own & (still | (arena.movable == 1)), contacts, label)
        taken = span * right[own].mean(axis=1)
        part = self._parts(bodies, number, common, turned, label[own], taken, rough[own], now)
        less = np.sqrt(1.0 - part[number[bodies]]) - 1.0
        change = np.zeros_like(ends)
        change["v"][bodies] = less[:, None] * (ends["v"][bodies] - common[number[bodies]])
        change["w"][bodies] = (less * turned[bodies])[:, None] * ends["w"][bodies]
        self._bend(bodies, change, shifts, ends, span)
        mine = np.zeros(count, dtype=bool)
        mine[label[own]] = True
        self.group[bodies] = np.where(mine[number[bodies]], number[bodies] + self.group.max() + 1, -1)
        self.until[bodies] = end
        return right

    def forget(self, parties: np.ndarray) -> None:
        """Begin the paths of the parties without displacements."""
        self.arena.paths["span"][parties] = 0.0

    def _all_of(self, of: np.ndarray, contacts: np.ndarray, label: np.ndarray) -> np.ndarray:
        """(m,) whether all parties of a contact's island have a property of parties (n+6,)."""
        has = of[contacts["a"]] & of[contacts["b"]]
        if has.all():
            return has
        out = np.ones(int(label.max()) + 1, dtype=bool)
        out[label[~has]] = False
        return out[label]

    def _shifts(self, contacts: np.ndarray, label: np.ndarray, which: np.ndarray, bodies: np.ndarray) -> np.ndarray:
        """(n+6,) of TWIST [length, rad]: displacements after which the parties at arena.spare do not overlap.

        The bodies at arena.spare have them, then. label (m,): islands; those where nothing overlaps stay as they are.
        """
        arena = self.arena
        shifts = np.zeros_like(arena.twists)
        there, place = self.watch.again(contacts, arena.spare)
        overlaps = there["gap"] < -arena.touch[there["a"], there["b"]]
        if not overlaps.any():
            return shifts
        deep = np.zeros(int(label.max()) + 1, dtype=bool)
        deep[label[place[overlaps]]] = True
        there = there[deep[label[place]]]
        number = np.zeros(len(arena.bodies), dtype=np.int64)
        number[contacts["a"]], number[contacts["b"]] = label, label
        bodies = bodies[deep[number[bodies]]]
        kept = arena.responses[which], arena.twists[which]
        arena.respond(which, arena.spare)
        separate(there, np.maximum(-there["gap"], 0.0), arena.responses, shifts, TOLERANCE, MOST_SWEEPS)
        reach = arena.finite_reach[bodies]
        # more is no drift, and boxes of the broad phase are wider by KEPT
        far = np.maximum(lengths(shifts["v"][bodies]), lengths(shifts["w"][bodies]) * reach) > KEPT * reach
        if far.any():
            deep[number[bodies[far]]] = False
            bodies = bodies[deep[number[bodies]]]
            moved = np.zeros(len(shifts), dtype=bool)
            moved[bodies] = True
            shifts[~moved] = 0
        shift_all(bodies, arena.bodies, arena.spare, arena.responses, shifts)
        arena.responses[which], arena.twists[which] = kept
        self.lifts += 1
        return shifts

    def _parts(
        self,
        bodies: np.ndarray,
        number: np.ndarray,
        common: np.ndarray,
        turned: np.ndarray,
        label: np.ndarray,
        taken: np.ndarray,
        rough: np.ndarray,
        now: float,
    ) -> np.ndarray:
        """(islands,) part of what contacts can change of an island's kinetic energy (find_common) that is too much.

        At arena.spare; zero but for `label` (m,).
        """
        arena = self.arena
        energy, excess, noise = np.zeros((3, len(common)))
        mine = np.zeros(energy.size, dtype=bool)
        mine[label] = True
        first, last, gains = np.empty((3, len(bodies)))
        find_gains(
            bodies, arena.bodies, arena.motion, arena.spare, number, common, turned, first, last, gains
        )  # fmt: skip
        np.add.at(energy, number[bodies], last)
        debt = arena.paths["debt"][bodies]
        np.add.at(excess, number[bodies], gains + debt + self._owed(bodies, first, now))
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
        groups, place = np.unique(self.group[bodies[cut]], return_inverse=True)
        won, size = np.zeros((2, len(groups)))
        at = np.minimum(np.searchsorted(groups, self.group), len(groups) - 1)
        known = groups[at] == self.group
        np.add.at(won, at[known], self.arena.paths["excess"][known])
        np.add.at(size, place, kinetic[cut])
        share = np.zeros(len(bodies))
        share[cut] = np.divide(won, size, out=np.zeros(len(groups)), where=size > 0.0)[place] * kinetic[cut]
        return share

    def _bend(self, bodies: np.ndarray, change: np.ndarray, shifts: np.ndarray, ends: np.ndarray, span: float) -> None:
        """Change (n+6,) of TWIST the velocities at the ends of the paths of bodies (k,), and displace these ends."""
        paths = self.arena.paths
        for name, rate, place in (("v", "acc", "lift"), ("w", "alp", "twist")):
            faster = change[name][bodies]
            ends[name][bodies] += faster
            paths[rate][bodies] += faster / span
            paths[place][bodies] = shifts[name][bodies] - 0.5 * span * faster  # the end of the path stays
        paths["began"][bodies] = paths["t"][bodies]
        paths["span"][bodies] = span
