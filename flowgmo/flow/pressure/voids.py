"""What is left empty beside closed faces, during one projection: how much may flow in, and what is full by then.

Two kinds: lids (lids.py), liquid cells with their surface inside, and pockets (pockets.py), cut cells beside the
liquid that it has not reached the centre of. Both let liquid in at zero pressure until their bound is reached:

    begin       all are open
    enter       into the matrix and the right-hand side of the next solution
    shut_full   those that would take more than their bound: they are given it, and the pressure is solved again

Pockets that would shut liquid in though void is beyond them stay open (ways_out.py).

Those begin shut that the first guess of the pressure would fill beyond their bound: few guesses are wrong then (1.4
solutions a step where it takes 2.1 with those that were shut in the step before). A wrong one costs two iterations.

Where the solution has other contacts of bodies than was assumed (contact_rows.py), those that are shut and need no
pressure open once more. Voids under a ball that a gate pinched were shut with the contacts first assumed and stayed so
with others: what filled them was drawn in at -55 kPa, in jets of 10 m/s, and brought .14 of the energy (hard/wet_gate,
five of ten starts a hair apart).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from flowgmo.flow.fields import Grid, Open
from flowgmo.flow.pressure.lids import ABSENT, OPEN, SHUT, Lids, bound, find_lids, no_lids, outflow
from flowgmo.flow.pressure.pockets import pocket_flows, take_pockets
from flowgmo.flow.pressure.ways_out import WaysOut
from flowgmo.flow.surface.planes import Planes
from flowgmo.flow.team import Team
from flowgmo.flow_plan import SidePlan
from flowgmo.mesh import SYMMETRY, WALL


def closed_sides(plans: tuple[SidePlan, ...], present: tuple[bool, ...]) -> np.ndarray:
    """(6,) int8: OPEN, SHUT or ABSENT (lids.py) for the sides of the domain."""
    kinds = [SHUT if plan.kind in (SYMMETRY, WALL) else OPEN for plan in plans]
    return np.array([kind if present[n // 2] else ABSENT for n, kind in enumerate(kinds)], np.int8)


class Voids:
    """Of one scene; found anew for every surface (`find`). shut (lids + pockets,): which are full by now."""

    def __init__(self, team: Team, grid: Grid, openings: Open, planes: Planes, closed: np.ndarray) -> None:
        self.team, self.grid, self.openings, self.closed = team, grid, openings, closed
        self.planes = planes
        self.lids: Lids = no_lids()
        self.pockets = self.cells = np.empty((0, 3), np.int32)
        self.ways_out = WaysOut(openings)
        self.opening: Callable[[np.ndarray], np.ndarray] | None = None

    def find(self, columns: np.ndarray, counts: np.ndarray, F: np.ndarray, wet: np.ndarray) -> None:
        """As mark_liquid left `wet` and the counts of the columns; pockets are 0 in `wet` after, or 1 amid liquid."""
        self.pockets = np.empty((int(counts.sum()) if self.openings.V is not None else 0, 3), np.int32)
        if len(self.pockets):
            self.pockets = self.pockets[
                : take_pockets(columns, counts, F, self.openings, self.closed, wet, self.pockets)
            ]
        self.lids = find_lids(self.team, columns, counts, F, self.openings, self.planes, self.grid, self.closed, wet)
        self.cells = np.concatenate([self.lids.cells, self.pockets])
        self.volume = np.concatenate([self.lids.volume, np.prod([
            d[k] for d, k in zip(self.grid[:3], self.pockets.T, strict=True)
        ], axis=0)])  # fmt: skip

    def outflow(self, velocity: list) -> np.ndarray:
        """(lids,) [length3/time]: what predicted velocities let out through the planes."""
        return outflow(self.lids, velocity)

    def begin(
        self,
        out: np.ndarray,
        velocity: list,
        b: tuple,
        F: np.ndarray | None,
        q: np.ndarray,
        wet: np.ndarray,
        dt: float,
        guess: bool,
        opened: tuple[np.ndarray, np.ndarray] | None = None,
    ) -> None:
        """Take the predicted velocities, and what goes out of lids by them.

        All voids are open, or, guess, as the first guess q of the pressure has it. opened: V0 and what they grow by of
        lids and pockets (pockets.py), None where nothing moves. `opening` is set later, where the pressure moves
        bodies: what their velocities with q open of the pockets beyond that.
        """
        self.wet, n = wet, len(self.lids.cells)
        self.known, self.opened, self.opening = (velocity, b, F, dt), self._unmoved(), None
        if opened is not None and F is not None:
            V0, grown = opened
            self.lids = self.lids._replace(room=np.maximum(1.0 - F[self.lids.at], 0.0) * self.lids.volume * V0[:n])
            self.opened = V0[n:], grown[n:]
        own = tuple(self.pockets.T)
        pressed = q[own] * guess
        q[own] = 0.0
        self.shut = np.zeros(n + len(self.pockets), bool)
        self.predicted = out
        self._look(q)
        if guess:
            self.shut[:] = self.flow > self.most
        wet[own] = self.shut_pockets
        self.ways_out.begin(self.pockets)
        self._open_ways_out()
        q[own] = pressed * self.shut_pockets

    def _open_ways_out(self) -> None:
        """Open the pockets that shut liquid in; `wet` has those that are shut."""
        self.ways_out.open(self.shut_pockets, self.lids.cells[~self.shut_lids], self.wet, self.known[1])

    def _unmoved(self) -> tuple[np.ndarray, np.ndarray]:
        """V0 and grown of the pockets where no body opens them."""
        n = len(self.pockets)
        return self.openings.V[tuple(self.pockets.T)] if n else np.zeros(0), np.zeros(n)

    def _look(self, q: np.ndarray) -> None:
        """Flows and bounds (voids,) [length3/time] with the pressure q."""
        velocity, b, F, dt = self.known
        lids, n = self.lids, len(self.lids.cells)
        most = bound(lids, self.grid, self.openings, velocity, b, q, dt)
        V0, grown = self.opened
        grown = grown if self.opening is None else grown + self.opening(q)
        of = self.openings, self.planes.steps, self.grid, velocity, b, q, dt, V0, grown
        at = pocket_flows(self.pockets, F, *of)
        self.pocket_inflow = at[:, 0]
        self.flow = np.concatenate([self.predicted + lids.conductance * q[lids.at], at[:, 1]])
        self.most = np.concatenate([most, at[:, 2]])
        self.shut_lids, self.shut_pockets = self.shut[:n], self.shut[n:]

    @property
    def held(self) -> np.ndarray:
        """(lids,) [length]: what the open lids add to the diagonal."""
        return np.where(self.shut_lids, 0.0, self.lids.conductance)

    @property
    def open_lids(self) -> tuple:
        """Indices of the liquid cells that have a surface inside."""
        return tuple(self.lids.cells[~self.shut_lids].T)

    @property
    def full(self) -> tuple[tuple, np.ndarray]:
        """Indices of shut voids, and what they take [length3/time]."""
        return tuple(self.cells[self.shut].T), self.most[self.shut]

    def enter(self, right: np.ndarray) -> None:
        """Into the right-hand side of the liquid cells' predicted net inflow."""
        n, self.taken = len(self.lids.cells), self.most
        right[self.lids.at] -= np.where(self.shut_lids, self.most[:n], self.predicted)
        own = tuple(self.pockets[self.shut_pockets].T)
        right[own] = (self.pocket_inflow - self.most[n:])[self.shut_pockets]

    def shut_full(self, q: np.ndarray, slack: float, *, release: bool) -> bool:
        """Shut what takes more than its bound and `slack` [1/time] of its cell; whether anything changed.

        release: open again what needs no pressure, shut by a guess or while bodies had other contacts. Not twice: from
        then on pressures only rise.
        """
        if not len(self.shut):
            return False
        self._look(q)
        n, before = len(self.lids.cells), self.shut.copy()
        more = self.flow > self.most + slack * self.volume
        more[n:] &= ~(self.shut_pockets | self.ways_out.kept_open)
        kept = np.concatenate(
            [self.flow[:n] > self.most[:n] - slack * self.volume[:n], q[tuple(self.pockets.T)] >= 0.0]
        )
        self.shut[:] = more | (self.shut & kept if release else self.shut)
        own = tuple(self.pockets.T)
        self.wet[own] = self.shut_pockets
        self._open_ways_out()
        q[own] *= self.shut_pockets
        return bool((self.shut != before).any())

    def wait(self, dt: float) -> None:
        """From now on bounds are for steps of dt, and flows those of the velocities as they have become; nothing more
        opens."""
        self.known, self.opened, self.opening = (*self.known[:-1], dt), self._unmoved(), None

    def shut_pockets_hit(self, q: np.ndarray, slack: float, right: np.ndarray) -> bool:
        """Shut open pockets that an impulse q drives more into than their bound and `slack` [1/time] of their cell, and
        enter what is left to them into `right`; whether there are any."""
        if not len(self.pockets):
            return False
        self._look(q)
        n = len(self.lids.cells)
        hit = (self.flow[n:] > self.most[n:] + slack * self.volume[n:]) & ~self.shut_pockets
        hit &= ~self.ways_out.kept_open
        own = tuple(self.pockets[hit].T)
        self.shut[n:] |= hit
        self.wet[own] = 1
        right[own] = (self.pocket_inflow - self.most[n:])[hit]
        self._open_ways_out()
        q[tuple(self.pockets.T)] *= self.shut_pockets
        return bool(hit.any())
