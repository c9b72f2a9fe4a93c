"""The work of contact forces over legs that may be cut short: booked when a leg ends, read off at any time before.

What contacts take from bodies that an impulse moves is booked with their paths (paths.py). Here is what the others
give: a contact that pushes a driven body with the impulse p over a leg of length h takes the power p·u/h from its
driver, with u linear in time (p/h)·(u(0) dt + (u(h) - u(0)) dt²/(2h)) until dt. What the movable side does not get of
it is lost. `due`, likewise linear, is what contacts take by right (accounts.py): until a leg is cut it goes to
PATH.excess.
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.arena import Arena, cross, joined
from flowgmo.state import FROM_PRESCRIBED, LOST_IN_FRICTION

#: One contact's leg: parties, start and length [time]; power lost and power given by drivers, at start and end.
ENTRY = np.dtype(
    [("a", "i8"), ("b", "i8"), ("t", "f8"), ("span", "f8"), ("driven", "f8", 2), ("due", "f8", 2), ("force", "f8", 3)]
)


class Ledger:
    """The legs in progress of all contacts that push."""

    def __init__(self, arena: Arena) -> None:
        self.arena = arena
        self.entries = np.zeros(0, ENTRY)

    def open(
        self, held: np.ndarray, due: np.ndarray, start: np.ndarray, ends: np.ndarray, now: float, end: float
    ) -> None:
        """Add contacts (m,) with their impulses over [now, end]; start, ends (n,): twists then."""
        entries = np.zeros(len(held), ENTRY)
        entries["a"], entries["b"], entries["t"], entries["span"] = held["a"], held["b"], now, end - now
        entries["force"], entries["due"] = held["impulse"] / (end - now), due
        n = self.arena.n
        for k, twists in enumerate((start, ends)):
            for side, sign in (("a", 1.0), ("b", -1.0)):
                party = held[side]
                arm = held["point"] - self.arena.responses["centre"][party]
                u = twists["v"][party] + cross(twists["w"][party], arm)
                power = sign * np.einsum("ki,ki->k", entries["force"], u)
                driven = (self.arena.movable[party] == 0) & (party < n)
                entries["driven"][:, k] -= np.where(driven, power, 0.0)
        self.entries = joined(self.entries, entries)

    def add_until(self, t: float, books: np.ndarray, which: np.ndarray | None = None) -> None:
        """Add to books (4,) what the legs (or those of `which`) have done by time t."""
        entries = self.entries if which is None else self.entries[which]
        if not len(entries):
            return
        given = float(_work(entries, "driven", t).sum())
        books[FROM_PRESCRIBED] += given
        books[LOST_IN_FRICTION] += given

    def close(self, t: float, books: np.ndarray, bodies: np.ndarray | None = None) -> None:
        """Book and forget the legs that end at t: all, or those of the bodies marked 1 in `bodies` (n+6,)."""
        which = np.ones(len(self.entries), dtype=bool)
        if bodies is not None:
            which = (bodies[self.entries["a"]] | bodies[self.entries["b"]]) == 1
        self.add_until(t, books, which)
        done, movable = self.entries[which], self.arena.movable
        party = np.where(movable[done["a"]] == 1, done["a"], done["b"])
        np.add.at(self.arena.paths["excess"], party, _work(done, "due", t))
        self.entries = self.entries[~which]

    def forces(self) -> np.ndarray:
        """(n, 3) contact force on every body now [force]."""
        out = np.zeros((len(self.arena.bodies), 3))
        np.add.at(out, self.entries["a"], self.entries["force"])
        np.subtract.at(out, self.entries["b"], self.entries["force"])
        return out[: self.arena.n]


def _work(entries: np.ndarray, name: str, t: float) -> np.ndarray:
    """(m,) work by time t of powers that are linear in time."""
    dt = np.clip(t - entries["t"], 0.0, entries["span"])
    first, last = entries[name].T
    return dt * (first + 0.5 * (last - first) * dt / entries["span"])
