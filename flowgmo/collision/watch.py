"""What may touch: the broad phase, the contacts of the moment, and the next events of all pairs in a leg.

Boxes around all that a party may sweep tell apart those that cannot meet (tree.overlapping); of the others sweep.py
finds the time. Of the pairs of a body whose path changed all is found anew; the rest stays as it was.
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.arena import Arena
from flowgmo.collision.contact import CONTACT
from flowgmo.collision.extents import pairs_of_boxes, pairs_with, sweep_boxes
from flowgmo.collision.gather import KEPT, gather
from flowgmo.collision.sweep import next_events
from flowgmo.collision.touching import MOST_POINTS
from flowgmo.errors import StepTooLong

NEVER = np.inf
TOGETHER = 1e-6  # of a leg: pairs that touch nearer to each other in time than this are looked at together
CLOSE = 1e-6  # of the smaller reach: points of one pair this near when it hits take part, as the ends of an edge do
SEARCHES = 100  # of one pair for its next event, of 2400 looks each, .2 to 1 s in all; then counts how far they came
MOST_SEARCHES = 1e4  # of one pair in a leg, a minute or two; some 500 in decks/domino, where blocks pass one another
# just apart; 1e9 and more where bodies turn so fast that each look may go on a little only
SLACK = 2.0  # times `touch`: searches for one and the same instant end anywhere between half of it and the whole


class Watch:
    """Pairs and their next events in the present leg."""

    located = True  # contacts are found at their times: what overlaps has drifted

    def __init__(self, arena: Arena) -> None:
        self.arena = arena
        n = len(arena.bodies)
        self.boxes = np.empty((n, 6))
        self.all = np.arange(n)
        self.order = np.arange(n)
        self.room = np.zeros((64, 2), dtype=np.int64)
        self.list = np.zeros((64, 2), dtype=np.int64)
        self.out = np.zeros(256, CONTACT)
        self.points = np.zeros(MOST_POINTS, CONTACT)
        self.no_hits = np.zeros((0, 7))
        self.pairs = np.zeros((0, 2), dtype=np.int64)
        self.times = np.zeros(0)
        self.sure = np.zeros(0, dtype=np.int64)
        self.deepest = 0.0
        # two that an impulse cannot move, or that may not collide, are never a pair
        self.allowed = arena.plan["allowed"].astype(bool)
        still = arena.movable == 0
        self.allowed[np.ix_(still, still)] = False

    def longest(self) -> float:
        """No bound on a leg comes from here."""
        return NEVER

    def touching(self, held: np.ndarray, awake: np.ndarray | None = None) -> np.ndarray:
        """All contacts now of parties awake (n+6,; None: all); arena.motion stands at one time. held: those before."""
        self._boxes(self.all, 0.0)
        pairs = self._overlapping(self.arena.wakeful if awake is None else awake)
        found = self._gather(pairs, held)
        new = found[found["fresh"] == 1]
        return self._gather(pairs, held, np.stack([new["a"], new["b"]], 1)) if len(new) else found

    def touching_now(self, held: np.ndarray, met: np.ndarray, rows: np.ndarray | None = None) -> np.ndarray:
        """Contacts of the pairs in `held` and of the pairs met (k, 2); rows (n+6,) of POSE: where not arena.motion."""
        pairs = np.concatenate([np.stack([held["a"], held["b"]], 1), met])
        return self._gather(self._once(pairs), held, met, slack=SLACK, rows=rows)

    def again(self, contacts: np.ndarray, rows: np.ndarray, wider: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
        """The same contacts (m,) with the parties at rows (n+6,) of POSE: those found (k,), their places in m (k,).

        wider: part of a party's reach that a gap may be wider than otherwise.
        """
        order = np.lexsort((contacts["b"], contacts["a"]))
        contacts = contacts[order]
        pairs = self._once(np.stack([contacts["a"], contacts["b"]], 1))
        found = self._gather(pairs, contacts, rows=rows, wider=wider)
        found = found[found["fresh"] == 0]
        _, first = np.unique(found["regime"], return_index=True)  # where two are the same contact: the first
        return found[first], order[found["regime"][first]]

    def start(self, held: np.ndarray, now: float, end: float, awake: np.ndarray) -> None:
        """Find the next events in [now, end) of all pairs of which one is awake (n+6,)."""
        self.now, self.end = now, end
        self._boxes(self.all, end - now)
        self.pairs = self._overlapping(awake)
        self.times, self.sure = self._events(self.pairs, held, now)

    def renew(self, held: np.ndarray, bodies: np.ndarray, t: float, leave: bool) -> None:
        """Find anew the events of all pairs with one of the bodies, whose paths start at t; leave: none for them."""
        self._boxes(bodies, self.end - t)
        changed = np.zeros(len(self.boxes), dtype=bool)
        changed[bodies] = True
        kept = ~changed[self.pairs].any(axis=1)
        pairs = self._pairs_of(bodies)
        if leave:
            pairs = pairs[:0]
        times, sure = self._events(pairs, held, t)
        self.pairs = np.concatenate([self.pairs[kept], pairs])
        self.times = np.concatenate([self.times[kept], times])
        self.sure = np.concatenate([self.sure[kept], sure])
        self.held = held

    def next(self) -> tuple[float, np.ndarray]:
        """Time and pairs (k, 2) of the earliest event; infinity if there is none. What gave up is taken up again.

        With it come the pairs that touch within TOGETHER of a leg: what is symmetric stays so. Raises StepTooLong where
        one pair is taken up without end.
        """
        searches: dict[int, list[float]] = {}  # how many, and from when on
        while len(self.times):
            k = int(np.argmin(self.times))
            first = float(self.times[k])
            if not np.isfinite(first):
                break
            if self.sure[k]:
                which = (self.times <= first + TOGETHER * (self.end - self.now)) & (self.sure == 1)
                return first, self.pairs[which]
            searches.setdefault(k, [0, first])[0] += 1
            count, since = searches[k]
            if count > SEARCHES and count * (self.end - since) > MOST_SEARCHES * (first - since):
                raise StepTooLong(self._without_end(self.pairs[k]))
            times, sure = self._events(self.pairs[k : k + 1], self.held, first)
            self.times[k], self.sure[k] = times[0], sure[0]
        return NEVER, self.pairs[:0]

    def _without_end(self, pair: np.ndarray) -> str:
        """What to say of a pair (2,) whose next event is not found."""
        arena = self.arena
        one, two = (arena.name(int(b)) for b in pair)
        fastest = max(float(np.linalg.norm(arena.motion["w"][b])) for b in pair)
        return (
            f"no end to the search for when {one} and {two} touch: they turn with up to {fastest:.3g} a unit of time, "
            "too fast for the step"
        )

    def forget(self, met: np.ndarray) -> None:
        """Pairs met (k, 2) have no more events in this leg."""
        for a, b in met:
            self.times[(self.pairs[:, 0] == a) & (self.pairs[:, 1] == b)] = NEVER

    def _once(self, pairs: np.ndarray) -> np.ndarray:
        """Pairs (k, 2), sorted, each once."""
        n = len(self.boxes)
        keys = np.sort(pairs[:, 0] * n + pairs[:, 1])
        keys = keys[np.diff(keys, prepend=-1) > 0]
        return np.stack([keys // n, keys % n], 1)

    def _boxes(self, which: np.ndarray, sweep: float) -> None:
        a = self.arena
        sweep_boxes(which, sweep, a.shapes, a.bodies, a.motion, a.paths, a.bounds, KEPT, self.boxes)

    def _overlapping(self, awake: np.ndarray) -> np.ndarray:
        while True:
            count = pairs_of_boxes(self.boxes, self.allowed, self.order, self.list)
            if count <= len(self.list):
                pairs = self.list[:count]
                pairs = pairs[(awake[pairs[:, 0]] | awake[pairs[:, 1]]) == 1]
                return pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]
            self.list = np.zeros((2 * count, 2), dtype=np.int64)

    def _pairs_of(self, bodies: np.ndarray) -> np.ndarray:
        """Pairs of the bodies with all parties whose boxes overlap theirs, lower number first, each once."""
        while True:
            count = pairs_with(bodies, self.boxes, self.allowed, self.list)
            if count <= len(self.list):
                pairs = self.list[:count]
                return pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]
            self.list = np.zeros((2 * count, 2), dtype=np.int64)

    def _gather(
        self,
        pairs: np.ndarray,
        held: np.ndarray,
        met: np.ndarray | None = None,
        slack: float = 1.0,
        rows: np.ndarray | None = None,
        wider: float = 0.0,
    ) -> np.ndarray:
        """Contacts of pairs (k, 2); those met (j, 2) have just come to touch somewhere."""
        a = self.arena
        rows = a.motion if rows is None else rows
        touch = a.touch
        if wider > 0.0:
            touch = touch + wider * np.minimum(a.finite_reach[:, None], a.reach)
        if met is not None:
            touch, (i, j) = slack * a.touch, met.T
            touch[i, j] = np.maximum(touch[i, j], CLOSE * np.minimum(a.reach[i], a.reach[j]))
        first = self._first(pairs, held)
        while True:
            total, most, deepest = gather(
                a.shapes, pairs, len(pairs), rows, a.plan, touch, held, first, self.out, self.room, self.points
            )
            if total <= len(self.out) and most <= len(self.room):
                self.deepest = max(self.deepest, deepest)
                return self.out[:total].copy()
            self._enlarge(total, most)

    def _events(self, pairs: np.ndarray, held: np.ndarray, now: float) -> tuple[np.ndarray, np.ndarray]:
        a = self.arena
        self.held = held
        times, sure = np.empty(len(pairs)), np.ones(len(pairs), dtype=np.int64)
        first = self._first(pairs, held)
        while True:
            most = next_events(
                a.shapes, pairs, len(pairs), a.bodies, a.laws, a.motion, a.paths, a.bounds, a.spare, now, self.end,
                a.touch, held, first, times, sure, self.room, self.no_hits,
            )  # fmt: skip
            if most <= len(self.room):
                return times, sure
            self._enlarge(0, most)

    def _enlarge(self, contacts: int, pieces: int) -> None:
        if contacts > len(self.out):
            self.out = np.zeros(2 * contacts, CONTACT)
        if pieces > len(self.room):
            self.room = np.zeros((2 * pieces, 2), dtype=np.int64)

    def _first(self, pairs: np.ndarray, held: np.ndarray) -> np.ndarray:
        """(k, 2): the held contacts of every pair go from first[k, 0] to first[k, 1] - 1."""
        n = len(self.arena.bodies)
        keys = held["a"] * n + held["b"]
        wanted = pairs[:, 0] * n + pairs[:, 1]
        first = np.empty((len(pairs), 2), dtype=np.int64)
        first[:, 0], first[:, 1] = keys.searchsorted(wanted, "left"), keys.searchsorted(wanted, "right")
        return first
