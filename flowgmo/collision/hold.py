"""Contacts that stay: their forces over a leg, the paths of the bodies they hold, and the books of their work.

    1  twists at the end of the leg if nothing touched       exact flight (respond.free_twists)
    2  contact impulses so that no contact approaches then   persistent.solve, Coulomb friction with sticking
    3  constant forces over the leg: HELD paths              paths.py

Normals and arms are those of the middle of the leg, found from the velocities at its start. The law is applied to

    J_mid v(end) + (J_mid - J_start) v(start) + n_mid (n_mid - n_start) · J_start v(start)

J: velocity of a's contact point relative to b's. It is the velocity at the end with the normals and arms of the end,
to second order: a point that was at rest on the other body at the start is so at the end, a body that turns about an
edge does not drift off it by h² per leg, nor does one that slides on a surface that turns (the last term). What is left
of it, h³, landing.py takes away.

Work of an impulse p over the leg is p · (u(start) + u(end)) / 2 with u the velocity at the contact: exact for
velocities linear in time.
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.arena import Arena, dots, lengths
from flowgmo.collision.gather import approaches, islands, no_contacts, relative_velocities
from flowgmo.collision.grid_watch import GridWatch
from flowgmo.collision.landing import Landing
from flowgmo.collision.ledger import Ledger
from flowgmo.collision.limits import FEATURE, Limits
from flowgmo.collision.persistent import IMPOSSIBLE, TOO_MANY, solve
from flowgmo.collision.respond import coast, free_twists, gyroscopic, set_paths
from flowgmo.collision.watch import Watch

TURN = 0.05  # rad that a held body turns in one leg: the error of its path is a part of TURN³ of its size
FALL = 1e-3  # of a body's reach that gravity moves it in one leg
TOLERANCE = 1e-9  # of the largest free normal speed: what remains when the forces count as found
BUSY_TOLERANCE = 0.01  # the same in a busy step: bodies that bounce at 1 m/s need not know g h to the sixth digit
MOST_SWEEPS = 300
PARTING = 1e-9  # of an island's largest change of normal speed in the leg: a smaller speed is round-off of the solution


SOON = 1e-4  # of g h²: a gap that closes within 1.4 % of the leg h, and so decides nothing about who carries how much
# of such a gap, a leg: g' = g - (3/10 g before + 3/10 g)/2 goes to zero without overshoot (x² - .85 x + .15 has real
# roots). As it is linear, gaps under one face, which fit each other, ask for velocities that fit each other
CLOSING = 0.3
COASTED = TURN**2 / 8.0  # of the reach: ½ ω v (h/2)² at most, with v no more than ω times the reach
SMALL_TURN = 1e-6  # of the change of turning, a hundredth of what TURN leaves: not worth a second solution
STILL_SPEED = 3.0  # of tolerance times g h: what several contacts' tolerances may add up to
STILL_PART = 1e-9  # of its reach: a party that moves less in a leg touches as it did


def relative(contacts: np.ndarray, arena: Arena, twists: np.ndarray) -> np.ndarray:
    """Velocities (m, 3) of a's contact points relative to b's, with the centres of arena.responses."""
    out = np.empty((len(contacts), 3))
    relative_velocities(contacts, arena.responses, twists, out)
    return out


def least_of_pairs(contacts: np.ndarray, values: np.ndarray) -> np.ndarray:
    """(m,) the least value (m,) of each pair's contacts (m > 0,), which are sorted by pair."""
    a, b = contacts["a"], contacts["b"]
    first = np.flatnonzero(np.concatenate([[True], (a[1:] != a[:-1]) | (b[1:] != b[:-1])]))
    return np.repeat(np.minimum.reduceat(values, first), np.diff(first, append=len(values)))


class Holder:
    """Contact forces of the contacts that stay. held: those of the present legs, sorted by pair."""

    def __init__(self, arena: Arena, watch: Watch | GridWatch) -> None:
        self.arena, self.watch = arena, watch
        n = len(arena.bodies)
        self.ends = np.zeros(n, arena.twists.dtype)
        self.correction = np.zeros(n, arena.twists.dtype)
        self.load_books = np.zeros((n, 4))
        self.hits = np.zeros((0, 7))
        self.ledger = Ledger(arena)
        self.limits = Limits(arena)
        self.landing = Landing(arena, watch)
        self.sweeps, self.solved, self.impossible = 0, 0, 0  # for the log: sweeps of all solutions, how many, in vain
        self.leg = np.inf  # length of the step [time]
        self.fall = np.full(n, np.inf)  # time in which gravity moves a body by FALL [time]
        falls = arena.movable == 1
        if arena.gravity > 0.0:
            self.fall[falls] = np.sqrt(2.0 * FALL * arena.reach[falls] / arena.gravity)
        self.tolerance = TOLERANCE
        self.unfinished = 0  # solutions that ended at the bound on sweeps
        self.worst = 0.0  # largest residual so far, for the log

    def longest_legs(self, contacts: np.ndarray) -> np.ndarray:
        """(m,) time that the two bodies of a contact may run on one path [time]: as far as they turn and fall."""
        rate = lengths(self.arena.motion["w"])
        turns = (rate > 0.0) & (self.arena.movable == 1)
        legs = self.fall.copy()  # of bodies
        legs[turns] = np.minimum(legs[turns], TURN / rate[turns])
        return np.minimum(legs[contacts["a"]], legs[contacts["b"]])

    def hold(self, contacts: np.ndarray, which: np.ndarray, now: float, end: float, busy: bool) -> np.ndarray:
        """Set the paths of the parties `which` from now to end under the contacts (m,) that may press them.

        busy: the leg is one of many in a step full of impacts, so that its forces need not be exact.
        All movable parties of the contacts are among `which`. Returns the contacts that stay, with their impulses.
        """
        arena = self.arena
        parties = arena.parties_of(contacts, which)
        self.limits.grip(parties, self._sides(contacts))  # what may be pressed counts as pressed at first
        arena.respond(parties)
        self.tolerance = BUSY_TOLERANCE if busy else TOLERANCE
        start = arena.twists.copy()
        free_twists(
            parties, self.limits.loose, arena.motion, arena.paths, arena.laws, arena.spare, end,
            self.ends, self.load_books, self.hits,
        )  # fmt: skip
        if not len(contacts):
            set_paths(parties, self._sides(contacts), arena.bodies, arena.motion, arena.paths, self.ends, now, end)
            return no_contacts()
        contacts["impulse"] *= end - now  # from one leg to the next they carry forces: the first guess
        m = len(contacts)
        if self.limits.any:
            contacts = np.concatenate([contacts, self.limits.contacts(arena.parties_of(contacts))])
        label = np.empty(len(contacts), dtype=np.int64)
        islands(contacts, arena.movable, label)
        free = self.ends.copy()
        middle = self._press(contacts, label, parties, start, now, end)
        contacts, middle, label = contacts[:m], middle[:m], label[:m]
        pressed = self._sides(contacts[lengths(contacts["impulse"]) > 0.0])
        self.limits.grip(parties, pressed)
        self.landing.forget(parties)
        set_paths(parties, pressed, arena.bodies, arena.motion, arena.paths, self.ends, now, end)
        moves = self._moves(contacts, label, end - now)
        due = np.zeros((len(contacts), 2))
        if moves.any() and not busy:
            due[moves] = self.landing.land(
                contacts[moves], middle[moves], label[moves], start, self.ends, pressed, now, end
            )  # fmt: skip
        arena.paths["excess"][parties] = arena.paths["debt"][parties] = 0.0
        return self._staying(contacts, middle, label, start, free, due, now, end)

    def _sides(self, contacts: np.ndarray) -> np.ndarray:
        """(n+6,) 1 for the movable parties of contacts (m,)."""
        mark = np.zeros(len(self.arena.bodies), dtype=np.int64)
        mark[contacts["a"]] = mark[contacts["b"]] = 1
        return mark * self.arena.movable

    def _press(
        self, contacts: np.ndarray, label: np.ndarray, parties: np.ndarray, start: np.ndarray, now: float, end: float
    ) -> np.ndarray:
        """Fill the impulses of contacts (m,); self.ends, free ones on entry, become the twists with them.

        Returns the contacts as they are in the middle of the leg.
        """
        free = self.ends.copy()
        middle, bias = self._in_the_middle(contacts, label, start, now, end)
        self._solve(middle, bias)
        further = self._turn_further(parties, contacts, label, free, end - now)
        if further.any():
            rows = middle[further]
            self._solve(rows, bias[further])
            middle[further] = rows
        self._still(parties, start, end - now)
        contacts["impulse"] = middle["impulse"]
        idle = self._sides(contacts[lengths(contacts["impulse"]) > 0.0]) == 0
        self.ends[idle] = free[idle]
        return middle

    def _still(self, parties: np.ndarray, start: np.ndarray, span: float) -> None:
        """Bodies that no more than the solution's tolerance moves, before and after, are at rest: they do not creep."""
        arena = self.arena
        parties = parties[arena.movable[parties] == 1]
        limit = STILL_SPEED * TOLERANCE * arena.gravity * span
        fast = np.zeros(len(parties))
        for twists in (start, self.ends):
            fast = np.maximum(
                fast, lengths(twists["v"][parties]) + lengths(twists["w"][parties]) * arena.reach[parties]
            )
        rests = parties[fast <= limit]
        self.ends["v"][rests] = 0.0
        self.ends["w"][rests] = 0.0

    def _turn_further(
        self, parties: np.ndarray, contacts: np.ndarray, label: np.ndarray, free: np.ndarray, span: float
    ) -> np.ndarray:
        """Add to the free twists what the impulses found change the turning by.

        Returns (m,) whether a contact's island is worth solving again; the ends of its bodies are the free ones then.
        """
        arena = self.arena
        part = gyroscopic(
            parties, arena.bodies, arena.motion, arena.responses, free, self.ends, span, self.correction
        )  # fmt: skip
        if part <= SMALL_TURN:
            return np.zeros(len(contacts), dtype=bool)
        number = np.full(len(arena.bodies), -1)
        number[contacts["a"]], number[contacts["b"]] = label, label
        turned = parties[(arena.movable[parties] == 1) & (number[parties] >= 0)]
        most, size = np.zeros((2, int(label.max()) + 1))
        np.maximum.at(most, number[turned], lengths(self.correction["w"][turned]))
        np.maximum.at(size, number[turned], lengths(self.ends["w"][turned] - free["w"][turned]))
        further = most > SMALL_TURN * size
        turned = turned[further[number[turned]]]
        free["w"][turned] += self.correction["w"][turned]
        self.ends[turned] = free[turned]
        return further[label]

    def _in_the_middle(
        self, contacts: np.ndarray, label: np.ndarray, start: np.ndarray, now: float, end: float
    ) -> tuple[np.ndarray, np.ndarray]:
        """The contacts as they will be in the middle of the leg, and their bias (m, 3) [length/time].

        arena.responses are then those of the middle, too. Islands where nothing turns or slides stay as they are.
        """
        arena, span = self.arena, end - now
        before = relative(contacts, arena, start)
        closing = self._closing(contacts, dots(before, contacts["normal"]), span)
        bias = closing[:, None] * contacts["normal"]
        middle = contacts.copy()
        moves = self._moves(contacts, label, span)
        if not moves.any():
            return middle, bias
        parties = arena.parties_of(contacts[moves])
        moves &= contacts["feature"] != FEATURE
        coast(parties, arena.bodies, arena.motion, arena.paths, arena.laws, 0.5 * span, arena.spare, self.hits)
        place = np.flatnonzero(moves)
        there, found = self.watch.again(contacts[place], arena.spare)
        middle[place[found]] = there
        if len(found) < len(place):  # bodies that coast for half a leg leave what they slide or roll round on
            place = np.delete(place, found)
            there, found = self.watch.again(contacts[place], arena.spare, wider=COASTED)
            middle[place[found]] = there
        arena.respond(parties, arena.spare)
        middle["impulse"], middle["e"], middle["mu"] = contacts["impulse"], contacts["e"], contacts["mu"]
        self.limits.place(middle)
        turned = np.einsum("ki,ki->k", middle["normal"] - contacts["normal"], before)
        bias += relative(middle, arena, start) - before + turned[:, None] * middle["normal"]
        return middle, bias

    def _closing(self, contacts: np.ndarray, speed: np.ndarray, span: float) -> np.ndarray:
        """(m,) speeds [length/time] at which contacts (m,) may approach at the end; speed (m,): they part with now.

        A gap left by drift closes within a whole leg, not within what is left of this one: the path is linear from the
        speed u now, so that (u - closing) leg / 2 = -gap. Gaps of one pair that hardly differ close as one, the least:
        the rest is a tilt or a turn of round-off's size, and points that stick cannot take it away. It would ask them
        for velocities that contradict each other, and redundant forces would drift (contact_newton.py).
        """
        arena = self.arena
        leg = np.maximum(span, np.minimum(self.leg, self.longest_legs(contacts)))
        soon = SOON * arena.gravity * leg**2
        # an overlap opens again, or a ball would sink with what forces leave, TOLERANCE g h, until a shift lifts it; a
        # search that does not find the times of contacts leaves real overlaps, which stay
        lowest = -arena.touch[contacts["a"], contacts["b"]] if self.watch.located else 0.0
        gap = np.maximum(contacts["gap"], lowest)
        least = least_of_pairs(contacts, gap)
        gap = np.where(gap - least <= soon, least, gap)
        closing = np.clip(2.0 * gap / leg + speed, 0.0, np.maximum(gap, 0.0) / leg)
        return np.where(gap <= soon, CLOSING * gap / leg, closing)

    def _moves(self, contacts: np.ndarray, label: np.ndarray, span: float) -> np.ndarray:
        """(m,) whether a party of a contact's island moves enough in the span to change where and how it touches."""
        arena = self.arena
        moves = np.zeros(len(contacts), dtype=bool)  # of islands, by their labels
        way = lengths(arena.motion["v"]) + lengths(arena.motion["w"]) * arena.finite_reach
        far = way * span > STILL_PART * np.maximum(arena.finite_reach, 1e-300)
        moves[label[far[contacts["a"]] | far[contacts["b"]]]] = True
        return moves[label]

    def _solve(self, contacts: np.ndarray, bias: np.ndarray) -> None:
        """Contact impulses over the leg; self.ends become the twists with them."""
        sweeps, residual, status = solve(contacts, bias, self.arena.responses, self.ends, self.tolerance, MOST_SWEEPS)
        self.sweeps += sweeps
        self.solved += 1
        self.worst = max(self.worst, residual)
        self.impossible += status == IMPOSSIBLE
        self.unfinished += status == TOO_MANY

    def _staying(
        self, contacts: np.ndarray, middle: np.ndarray, label: np.ndarray, start: np.ndarray, free: np.ndarray,
        due: np.ndarray, now: float, end: float,
    ) -> np.ndarray:  # fmt: skip
        """The contacts that push, or touch without parting; their work goes to the ledger.

        free: ends without them; due (m, 2): power that they take by right.
        """
        arena = self.arena
        before, after = np.empty(len(contacts)), np.empty(len(contacts))
        approaches(middle, arena.responses, start, before)
        approaches(middle, arena.responses, self.ends, after)
        push = lengths(contacts["impulse"]) > 0.0
        alone = np.empty(len(contacts))
        approaches(middle, arena.responses, free, alone)
        scale = np.zeros(len(contacts))  # of each island: what moves fast in one does not change what rests in another
        np.maximum.at(scale, label, np.maximum(np.abs(after - before), np.abs(alone - before)))
        parting = np.abs(after) > max(PARTING, self.tolerance) * scale[label]
        stays = push | ~(parting & (after > 0.0)) | (before < 0.0)  # one that dips before it opens is no new contact
        held = contacts[stays].copy()
        held["fresh"] = 0
        held["age"] += end - now
        held["impulse"] /= end - now
        self.ledger.open(middle[stays], due[stays], start, self.ends, now, end)
        return held
