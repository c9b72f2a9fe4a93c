"""Bodies of any shape that touch, hit, rest and slide on each other: one step as a chain of legs and events.

    leg      from now to the end of the step, or less where bodies are held in contact:
      1  find what touches                          gather.py
      2  resolve the impacts among it               strike.py
      3  find the forces of the contacts that stay  hold.py; bodies then run on paths (paths.py)
      4  find when something touches anew           watch.py
    event    the earliest of these: bring the bodies that are joined in it there, and do 1 - 4 for them alone

Steps with too many events for that go on in short legs: crowd.py.

What is not concerned by an event is not moved and not looked at again. The age of a contact decides what it is: a new
one that approaches is an impact, one that was there before is a constraint.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from flowgmo.collision.arena import Arena, dots, joined
from flowgmo.collision.correct import Corrector
from flowgmo.collision.crowd import SHALLOW, Crowd
from flowgmo.collision.gather import mark_joined, no_contacts
from flowgmo.collision.grid_watch import GridWatch
from flowgmo.collision.hold import Holder
from flowgmo.collision.laws import Law
from flowgmo.collision.paths import HELD
from flowgmo.collision.sleep import Sleep
from flowgmo.collision.strike import Striker
from flowgmo.collision.watch import Watch
from flowgmo.errors import StepTooLong
from flowgmo.world import Room

MOST_EVENTS = 3000  # in one leg, after which all impacts are plastic: at 3 ms each a user waits ten seconds
LEAST_LOST = 1e-3  # of 1 - e: with less, 1000 bounces are none that end soon
MOST_LEGS = 1e5  # in a step: minutes to hours of it, for bodies that turn by 1e4 in it
AT_ONCE = 1e-6  # of a leg: events nearer to each other than this count as at one time
STALLED = 50  # events at one time after which impacts with e < 1 are plastic
CRUSHED = 200  # events at one time after which all are: a driven body leaves an elastic one ever less room
LEFT = 400  # events at one time after which the bodies are left alone until the next leg
REBOUND, INELASTIC, RIGID = 0.0, 1.0, np.inf  # restitution below which impacts are plastic: none, not elastic, all


class Engine:
    """Moves the bodies of an arena through their contacts; `held` are the contacts that stayed, for the next step."""

    def __init__(self, arena: Arena, law: Law, watch: Watch | GridWatch) -> None:
        self.arena = arena
        self.striker = Striker(arena, law)
        self.watch = watch
        self.holder = Holder(arena, watch)
        self.corrector = Corrector(arena)
        self.sleep = Sleep(arena)
        self.held = no_contacts()
        self.crowd = Crowd(arena)
        self.busy = False  # State.busy
        self.left = 0  # events after which bodies were left alone until the next leg

    def notices(self) -> list[str]:
        """What the user should know of the run so far: what had no solution, what overlapped."""
        holder, striker, corrector = self.holder, self.striker, self.corrector
        found = []
        if holder.impossible:
            found.append(
                f"{holder.impossible} of {holder.solved} solutions for contact forces leave an approach: a driven "
                "body presses another where it cannot give way; least violation was taken"
            )
        if holder.unfinished:
            found.append(
                f"{holder.unfinished} of {holder.solved} solutions for contact forces did not reach their tolerance; "
                f"largest residual {holder.worst:.1e} of the free speed"
            )
        if striker.lost:
            found.append(f"{striker.lost} clusters of impacts had no joint solution and were resolved pair by pair")
        if self.left:
            found.append(f"{self.left} times bodies hit each other without end in no time: the rest was left for later")
        if self.crowd.later:
            found.append(
                f"{self.crowd.later} meetings of bodies in crowded steps were left to the end of a short part of the "
                f"step, at overlaps of no more than {SHALLOW:g} of a body; a smaller DELT finds their times"
            )
        if corrector.deepest > 0.0:
            found.append(
                f"deepest overlap taken away by a shift: {corrector.deepest:.2e} (length); shifts gave the bodies "
                f"{corrector.given:.2e} (energy) in all, booked as dissipated with the other sign"
            )
        return found

    def move(self, t0: float, t1: float, room: Room) -> None:
        """Bring room.motion (n,) from t0 to t1 through all impacts; room gets rows, records and books."""
        self.arena.load(room.motion, t0)
        self.sleep.begin()
        self.room, self.books, self.step, self.row = room, np.zeros(4), t1 - t0, 0
        self.crowd.begin(self.busy, self.step)
        self.holder.leg = self.step
        now = t0
        while now < t1:
            now = self._leg(now, t1)
        self.busy = self.crowd.stays()
        self._rows_until(np.inf)
        movers = self.arena.movers
        room.motion[movers] = self.arena.motion[movers]
        room.books += self.books

    def meetings(
        self, coasting: np.ndarray, motion: np.ndarray, t0: float, t1: float
    ) -> Iterator[tuple[float, np.ndarray, float]]:
        """Times before t1, in order, pairs (k, 2), and speeds of approach [length/time] of touches that are none of
        self.held, if the bodies `coasting` (rows) go on with their velocities of motion (n,) POSE at t0: of each pair
        the first. Nothing is changed but the paths."""
        arena = self.arena
        arena.load(motion, t0)
        arena.paths["mode"][coasting] = HELD
        self.watch.start(self.held, t0, t1, arena.wakeful)
        self.watch.forget(np.stack([self.held["a"], self.held["b"]], axis=1))
        while True:
            t, pairs = self.watch.next()
            if not t < t1:
                return
            yield t, pairs, self._approach(t, pairs)
            self.watch.forget(pairs)

    def _approach(self, t: float, pairs: np.ndarray) -> float:
        """The largest speed [length/time] with which pairs (k, 2) that meet at t approach there; inf where they are not
        found to touch."""
        rows = self.arena.motion.copy()
        rows[self.arena.movers], _ = self.arena.poses(t)
        contacts = self.watch.touching_now(self.held[:0], pairs, rows)
        if not len(contacts):
            return np.inf
        at = [rows[contacts[side]] for side in "ab"]
        v, other = (x["v"] + np.cross(x["w"], contacts["point"] - x["p"]) for x in at)
        return max(float(dots(other - v, contacts["normal"]).max()), 0.0)

    def _leg(self, now: float, t1: float) -> float:
        """One leg from now; returns its end, at which all bodies stand. Raises StepTooLong."""
        arena = self.arena
        contacts, resting = self._touching()
        if self.watch.located:
            contacts = self.corrector.correct(contacts, self.books)
            if self.crowd.busy and len(contacts):
                self._measure(contacts)
        contacts = self._strike(contacts, now, REBOUND)
        longest = self.holder.longest_legs(contacts).min(initial=np.inf)
        longest = min(longest, self.watch.longest(), self.crowd.longest_leg(contacts))
        legs = max(1, int(np.ceil((t1 - now) / longest * (1.0 - 1e-9)))) if np.isfinite(longest) else 1
        if legs > MOST_LEGS:
            raise StepTooLong(f"bodies that touch move so fast that the step would need {legs:.1e} parts")
        end = t1 if legs == 1 else now + (t1 - now) / legs
        awake = arena.movers[self.sleep.asleep[arena.movers] == 0]
        self.held = merge(resting, self.holder.hold(contacts, awake, now, end, self.crowd.busy))
        self.watch.start(self.held, now, end, self.sleep.awake())
        end = self._events(now, end)
        self._rows_until(end)
        self.holder.ledger.close(end, self.books)
        self._bring(arena.movers, end)
        self.sleep.fall_asleep(self.held)
        return end

    def _measure(self, contacts: np.ndarray) -> None:
        """Points, normals and gaps of contacts (m,) as the bodies stand: after large shifts they are elsewhere.

        Balls whose arms are not along their normals would turn their slip, and cost ten times as much.
        """
        there, found = self.watch.again(contacts, self.arena.motion)
        for name in ("point", "normal", "gap"):
            contacts[name][found] = there[name]

    def _touching(self) -> tuple[np.ndarray, np.ndarray]:
        """Contacts of all parties that are awake, and the held ones among those that sleep; touched sleepers wake."""
        while True:
            awake = self.sleep.awake()
            rests = (awake[self.held["a"]] | awake[self.held["b"]]) == 0
            contacts = self.watch.touching(self.held[~rests], awake)
            touched = self.arena.parties_of(contacts)
            touched = touched[self.sleep.asleep[touched] == 1]
            if not touched.size:
                return contacts, self.held[rests]
            self.sleep.wake(touched, self.held)

    def _events(self, now: float, end: float) -> float:
        """All events until the end of the leg, the earliest first. Returns its end: earlier where the step is busy."""
        busy = self.crowd.busy
        events, stalls, last = 0, 0, now
        while True:
            t, met_now = self.watch.next()
            stop, stops = self.holder.limits.next()
            t, met_now, stops = (stop, met_now[:0], stops) if stop < t else (t, met_now, stops[:0])
            if t >= end:
                return end
            if self.crowd.busy:
                if not busy:
                    return t
                if self.crowd.waits(met_now, end - t):
                    self.watch.forget(met_now)
                    continue
            events += 1
            stalls = stalls + 1 if t - last <= AT_ONCE * (end - now) else 0
            last = max(t, last)
            leave = stalls > LEFT or events > MOST_EVENTS + LEFT
            self.left += leave
            self._rows_until(last)
            crushed = stalls > CRUSHED or events > MOST_EVENTS
            plastic = RIGID if crushed else INELASTIC if stalls > STALLED else REBOUND
            self._event(met_now, stops, last, end, plastic, leave)

    def _event(self, met: np.ndarray, stops: np.ndarray, t: float, end: float, plastic: float, leave: bool) -> None:
        """Pairs met (k, 2) touch at time t, or held bodies meet stops (j,) of limits.STOP.

        It is resolved with everything that is joined to them, and they go on from there.

        plastic: restitution below which impacts do not rebound; leave: these bodies hit without end, and what touches
        them anew is left until the next leg.
        """
        joined = np.zeros(len(self.arena.bodies), dtype=np.int64)
        joined[met] = self.arena.movable[met]
        joined[stops["body"]] = 1
        mark_joined(self.held, self.arena.movable, joined)
        mine = (joined[self.held["a"]] | joined[self.held["b"]]) == 1
        bodies = np.flatnonzero(joined)
        self.holder.ledger.close(t, self.books, joined)
        self._bring(self.arena.parties_of(self.held[mine], met.ravel(), stops["body"]), t)
        self.holder.limits.snap(stops)
        self.sleep.wake(bodies, self.held)  # now, and not before: it has not moved since the leg began
        contacts = self.watch.touching_now(self.held[mine], met)
        contacts = self._strike(contacts, t, plastic)
        held = self.holder.hold(contacts, bodies, t, end, self.crowd.busy)
        self.held = merge(self.held[~mine], held)
        self.watch.renew(self.held, bodies, t, leave)

    def _strike(self, contacts: np.ndarray, t: float, plastic: float) -> np.ndarray:
        """Resolve impacts; returns the contacts that may stay: not those that part."""
        limits = self.holder.limits
        if not len(contacts) or not (limits.any or contacts["fresh"].any()):
            return contacts  # what was there before is no impact
        self.striker.busy = self.crowd.busy
        forces = contacts["impulse"].copy()
        m, span = len(contacts), self._span(contacts)
        if limits.any:
            contacts = np.concatenate([contacts, limits.contacts(self.arena.parties_of(contacts))])
            span = np.concatenate([span, np.zeros(len(contacts) - m)])
        outcome = self.striker.strike(contacts, t, span, plastic, self.books)
        self.room.impacts.extend(outcome.records)
        self.crowd.work += int(outcome.struck.sum())
        contacts, struck, span = contacts[:m], outcome.struck[:m], span[:m]
        fresh = struck | (contacts["fresh"] == 1)
        parts = fresh & self.striker.parts(contacts, outcome.speed[:m], span)
        contacts["impulse"] = forces
        return contacts[~parts]

    def _span(self, contacts: np.ndarray) -> np.ndarray:
        """(m,) time [time] within which a series of bounces must end for its contact to rest now.

        A search that does not locate contacts in time sees a bounce only if it lasts two looks: 2 e v / a > 2 step.
        """
        if self.watch.located:
            return np.minimum(self.step, self.holder.longest_legs(contacts))
        return 2.0 * self.step / np.maximum(1.0 - contacts["e"], LEAST_LOST)

    def _bring(self, which: np.ndarray, t: float) -> None:
        for body, row in self.arena.bring(np.asarray(which, dtype=np.int64), t, self.books):
            self.room.stops.append((body, row))

    def _rows_until(self, t: float) -> None:
        """History rows of the asked times up to t, from the paths as they are now."""
        room = self.room
        while self.row < room.asked.size and room.asked[self.row] <= t:
            at = room.asked[self.row]
            poses, books = self.arena.poses(at)
            self.holder.ledger.add_until(at, books)
            movers = self.arena.movers
            room.rows[self.row, movers] = poses
            room.rows_books[self.row] += self.books + books
            forces = self.holder.ledger.forces()
            self.sleep.add_forces(forces, self.held)
            room.contact_force[self.row, movers] = forces[movers]
            self.row += 1


def merge(one: np.ndarray, two: np.ndarray) -> np.ndarray:
    """Two lists of contacts as one, sorted by pair."""
    if not len(one):
        one, two = two, one
    both = joined(one, two)
    a, b = both["a"], both["b"]
    later = (a[1:] > a[:-1]) | (a[1:] == a[:-1]) & (b[1:] >= b[:-1])
    return both if later.all() else both[np.lexsort((b, a))]
