"""Impacts among touching contacts at one time: who is in them, which law resolves them, and the record.

    islands of contacts that are joined through movable bodies, each with at least one fresh contact that approaches
    one contact        the law of a single pair      impact='exact' or 'euler'
    several            the law of clusters           multiple='simultaneous' or 'sequential'
                       pair after pair               more than MOST_TOGETHER, or a busy step (crowd.py)

End of a bounce series: a fresh contact that will rebound with e v and is pulled back with the acceleration a would
bounce on for 2 e v / (a (1 - e)). Where that ends within the step the impact is plastic: the contact is at rest then.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flowgmo.collision.arena import Arena, cross, dots, lengths, records_of
from flowgmo.collision.gather import KEPT, approaches, islands
from flowgmo.collision.limits import mark_limits
from flowgmo.collision.respond import set_all
from flowgmo.collision.sequential import AT_REST, TURNS
from flowgmo.collision.together import strike_in_turn
from flowgmo.errors import StepFailed
from flowgmo.records import REST
from flowgmo.state import FROM_PRESCRIBED, LOST_IN_IMPACTS

SLOW = 1e-10  # normal speed that counts as none, of the speeds at hand and sqrt(g R): round-off of earlier solutions
MOST_TOGETHER = 600  # contacts of a cluster; more would take a second, for an answer that round-off decides
BUSY_REST = 1e-3  # of the largest speed: approach that a busy step leaves to the contact forces
BUSY_TURNS = 3  # impacts a contact in a busy step before the rest is plastic
SETTLED = 1e-8  # part of an impact's speed that is rest after it


@dataclass
class Outcome:
    """What was resolved: records (k,) of IMPACT; struck (m,): contacts whose island was in an impact."""

    records: list[np.ndarray]
    struck: np.ndarray
    speed: np.ndarray  # (m,) normal velocity of every contact afterwards


def _is_finite(group: np.ndarray, twists: np.ndarray) -> bool:
    parties = np.concatenate([group["a"], group["b"]])
    return bool(np.isfinite(group["impulse"]).all() and np.isfinite(twists["v"][parties]).all())


class Striker:
    """Resolves impacts with the laws that the deck chose; `resolve` is the law of clusters, `single` that of a pair."""

    def __init__(self, arena: Arena, law: object) -> None:
        self.arena, self.law = arena, law
        self.busy = (
            False  # in steps full of impacts clusters are resolved pair after pair: seven times faster for balls
        )
        self.lost = 0  # clusters that were resolved pair after pair for want of a solution

    def strike(
        self, contacts: np.ndarray, t: float, span: np.ndarray | float, plastic: float, books: np.ndarray
    ) -> Outcome:
        """Resolve all impacts among contacts (m,) at time t; the parties' poses stand at t.

        span (m,) [time]: the leg in which a bounce series may end; plastic: contacts with an e below it do not rebound
        (stalled events).
        Changes velocities in arena.motion, contacts' impulse, regime, loss; books (4,) get the energy.
        """
        arena = self.arena
        parties = arena.parties_of(contacts)
        arena.respond(parties)
        speed = np.empty(len(contacts))
        approaches(contacts, arena.responses, arena.twists, speed)
        struck = np.zeros(len(contacts), dtype=bool)
        records: list[np.ndarray] = []
        hits = (contacts["fresh"] == 1) & (speed < 0.0)
        if hits.any():
            hits &= speed < -SLOW * self._scale(contacts)
        if not hits.any():
            return Outcome(records, struck, speed)
        arena.wet_responses(parties)
        twists = arena.twists.copy()
        spans, label = np.broadcast_to(span, len(contacts)), np.empty(len(contacts), dtype=np.int64)
        islands(contacts, arena.movable, label)
        for number in np.unique(label[hits]):
            member = np.flatnonzero(label == number)
            group = contacts[member]
            self._settle(group, speed[member], spans[member], plastic)
            self._resolve(group, t, books)
            contacts[member] = group
            struck[member] = True
            records.append(self._records(group, t, speed[member]))
        set_all(parties[arena.movable[parties] == 1], arena.bodies, arena.motion, arena.responses, arena.twists)
        arena.owe(parties, twists)
        before = speed.copy()
        approaches(contacts, arena.responses, arena.twists, speed)
        fastest = np.zeros(len(contacts))  # of each island: what happens in one does not change what rests in another
        np.maximum.at(fastest, label, np.abs(before))
        settled = struck & (np.abs(speed) <= SETTLED * fastest[label])
        speed[settled] = 0.0
        return Outcome(records, struck, speed)

    def _scale(self, contacts: np.ndarray) -> np.ndarray:
        """(m,) speeds that a contact's rounding is a part of [length/time]."""
        arena = self.arena
        total = np.zeros(len(contacts))
        for side in ("a", "b"):
            rows = arena.motion[contacts[side]]
            reach = arena.finite_reach[contacts[side]]
            total += lengths(rows["v"]) + lengths(rows["w"]) * reach
            total += np.sqrt(arena.gravity * reach)
        return total

    def _settle(self, group: np.ndarray, speed: np.ndarray, span: np.ndarray, plastic: float) -> None:
        """Take e = 0 for fresh contacts whose bounces would all end within the span, and for those with e < plastic."""
        ends = self.returns(group, group["e"] * np.maximum(-speed, 0.0), span)
        ends &= group["fresh"] == 1  # the floor under a block that is hit keeps its own e
        group["e"][ends | (group["e"] < plastic)] = 0.0

    def returns(self, contacts: np.ndarray, speed: np.ndarray, span: np.ndarray) -> np.ndarray:
        """(m,) whether contacts that part with `speed` [length/time] rest again within the span, bounces included."""
        pull = self._pull(contacts)
        return (pull > 0.0) & (2.0 * speed < span * pull * (1.0 - contacts["e"]))

    def parts(self, contacts: np.ndarray, speed: np.ndarray, span: np.ndarray) -> np.ndarray:
        """(m,) whether contacts that open with `speed` [length/time] leave; the others may press again within the span.

        A plastic contact that opens only because the bodies turn is left to the contact forces. One that rebounds
        leaves, unless gravity closes it for good within the span, or nothing pulls and it hardly moves.
        """
        arena = self.arena
        reach = np.minimum(arena.reach[contacts["a"]], arena.reach[contacts["b"]])
        slow = (self._pull(contacts) <= 0.0) & (contacts["e"] < 1.0) & (speed * span < KEPT * reach)
        return (speed > 0.0) & (contacts["e"] > 0.0) & ~slow & ~self.returns(contacts, speed, span)

    def _pull(self, group: np.ndarray) -> np.ndarray:
        """(k,) acceleration with which gravity presses each contact's sides together."""
        g = self.arena.pull
        return -dots(g[group["a"]] - g[group["b"]], group["normal"])

    def _resolve(self, group: np.ndarray, t: float, books: np.ndarray) -> None:
        arena = self.arena
        before, contacts = arena.twists.copy(), group.copy()
        if len(group) > (1 if self.busy else MOST_TOGETHER):
            strike_in_turn(group, arena.responses, arena.twists, BUSY_REST, BUSY_TURNS)
        else:
            self.law(group, arena.responses, arena.twists)
        if not _is_finite(group, arena.twists):  # a cluster that its law cannot resolve: pair after pair
            group[:], arena.twists[:] = contacts, before
            strike_in_turn(group, arena.responses, arena.twists, AT_REST, TURNS)
            self.lost += 1
            if not _is_finite(group, arena.twists):
                raise StepFailed(f"{len(group)} contacts that touch at t = {t:.6g} could not be resolved together")
        books[LOST_IN_IMPACTS] += group["loss"].sum()
        for side, sign in (("a", 1.0), ("b", -1.0)):
            party = group[side]
            driven = (arena.movable[party] == 0) & (party < arena.n)
            if driven.any():
                x = group["point"][driven] - arena.responses["centre"][party[driven]]
                u = before["v"][party[driven]] + cross(before["w"][party[driven]], x)
                books[FROM_PRESCRIBED] -= sign * float((group["impulse"][driven] * u).sum())

    def _records(self, group: np.ndarray, t: float, speed: np.ndarray) -> np.ndarray:
        """Contacts that took an impulse. A series closed within the step is a record of rest."""
        took = lengths(group["impulse"]) > 0.0
        rows = records_of(group[took], t, self.arena.n, 0)
        closed = (group["e"][took] == 0.0) & (self._given(group[took]) > 0.0)
        rows["regime"][closed] = REST
        rows["e"] = self._given(group[took])
        rows["fluid_impulse"] = self.arena.given_to_liquid(group[took])
        mark_limits(group[took], rows, self.arena)
        return rows

    def _given(self, group: np.ndarray) -> np.ndarray:
        return self.arena.plan["e"][group["a"], group["b"]]
