"""The work of contact forces over legs that may be cut short: booked when a leg ends, read off at any time before.

A contact that pushes with the impulse p over a leg of length h gives a's side the power p·u_a / h, b's -p·u_b / h. With
u linear in time its work until dt is (p/h)·(u(0) dt + (u(h) - u(0)) dt²/(2h)). What both sides together lose is
friction's; what a driven side gives is the driver's work.
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.arena import Arena, cross, joined
from flowgmo.state import FROM_PRESCRIBED, LOST_IN_FRICTION

#: One contact's leg: parties, start and length [time]; power lost and power given by drivers, at start and end.
ENTRY = np.dtype(
    [("a", "i8"), ("b", "i8"), ("t", "f8"), ("span", "f8"), ("lost", "f8", 2), ("driven", "f8", 2), ("force", "f8", 3)]
)


class Ledger:
    """The legs in progress of all contacts that push."""

    def __init__(self, arena: Arena) -> None:
        self.arena = arena
        self.entries = np.zeros(0, ENTRY)

    def open(self, held: np.ndarray, start: np.ndarray, ends: np.ndarray, now: float, end: float) -> None:
        """Add contacts (m,) with their impulses over [now, end]; start, ends (n,): twists then."""
        entries = np.zeros(len(held), ENTRY)
        entries["a"], entries["b"], entries["t"], entries["span"] = held["a"], held["b"], now, end - now
        entries["force"] = held["impulse"] / (end - now)
        n = self.arena.n
        for k, twists in enumerate((start, ends)):
            for side, sign in (("a", 1.0), ("b", -1.0)):
                party = held[side]
                arm = held["point"] - self.arena.responses["centre"][party]
                u = twists["v"][party] + cross(twists["w"][party], arm)
                power = sign * np.einsum("ki,ki->k", entries["force"], u)
                entries["lost"][:, k] -= power
                driven = (self.arena.movable[party] == 0) & (party < n)
                entries["driven"][:, k] -= np.where(driven, power, 0.0)
        self.entries = joined(self.entries, entries)

    def add_until(self, t: float, books: np.ndarray, which: np.ndarray | None = None) -> None:
        """Add to books (4,) what the legs (or those of `which`) have done by time t."""
        entries = self.entries if which is None else self.entries[which]
        if not len(entries):
            return
        dt = np.clip(t - entries["t"], 0.0, entries["span"])
        for name, place in (("lost", LOST_IN_FRICTION), ("driven", FROM_PRESCRIBED)):
            first, last = entries[name].T
            books[place] += float(np.sum(dt * (first + 0.5 * (last - first) * dt / entries["span"])))

    def close(self, t: float, books: np.ndarray, bodies: np.ndarray | None = None) -> None:
        """Book and forget the legs that end at t: all, or those of the bodies marked 1 in `bodies` (n+6,)."""
        which = np.ones(len(self.entries), dtype=bool)
        if bodies is not None:
            which = (bodies[self.entries["a"]] | bodies[self.entries["b"]]) == 1
        self.add_until(t, books, which)
        self.entries = self.entries[~which]

    def forces(self) -> np.ndarray:
        """(n, 3) contact force on every body now [force]."""
        out = np.zeros((len(self.arena.bodies), 3))
        np.add.at(out, self.entries["a"], self.entries["force"])
        np.subtract.at(out, self.entries["b"], self.entries["force"])
        return out[: self.arena.n]
