"""Contacts found on the mesh (search_grid.py), with the interface of watch.Watch: no events, only what is there now.

No body point may cross more than half a cell between two looks; `longest` tells the engine how far it may go.
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.arena import Arena, lengths
from flowgmo.collision.contact import CONTACT
from flowgmo.collision.extents import pairs_of_boxes, sweep_boxes
from flowgmo.collision.search_grid import MOST, NODE, grid_contacts
from flowgmo.collision.shapes import PIECE

NEVER = np.inf
HALF_CELL = 0.5


class GridWatch:
    """What lies in both bodies of a pair, on the nodes of the deck's mesh."""

    located = False  # contacts are seen late by up to a cell: overlaps are not corrected

    def __init__(self, arena: Arena) -> None:
        self.arena = arena
        n = len(arena.bodies)
        probe = np.zeros(1, PIECE)
        probe["axes"] = np.eye(3)
        self.pieces = np.concatenate([arena.shapes.pieces, probe])
        self.planes = arena.model.mesh.blocks[0].planes
        self.cell = min(float(np.diff(p).min()) for p in self.planes)
        self.boxes, self.all, self.order = np.empty((n, 6)), np.arange(n), np.arange(n)
        self.list = np.zeros((max(64, n), 2), dtype=np.int64)
        self.out, self.nodes = np.zeros(64, CONTACT), np.zeros(256, NODE)
        self.allowed = arena.plan["allowed"].astype(bool)
        still = arena.movable == 0
        self.allowed[np.ix_(still, still)] = False

    def longest(self) -> float:
        """Time in which the fastest body point crosses half a cell [time]."""
        arena = self.arena
        rows = arena.motion[arena.movers]
        reach = np.where(np.isfinite(arena.reach[arena.movers]), arena.reach[arena.movers], 0.0)
        speed = np.linalg.norm(rows["v"], axis=1) + np.linalg.norm(rows["w"], axis=1) * reach
        fastest = float(speed.max(initial=0.0))
        half = HALF_CELL * self.cell
        if arena.gravity > 0.0:  # half = v t + g t²/2
            return 2.0 * half / (fastest + np.sqrt(fastest**2 + 2.0 * arena.gravity * half))
        return half / fastest if fastest > 0.0 else NEVER

    def touching(self, held: np.ndarray, awake: np.ndarray | None = None) -> np.ndarray:
        """All contacts of the moment. held: those before, whose impulses are the first guess."""
        a = self.arena
        sweep_boxes(self.all, 0.0, a.shapes, a.bodies, a.motion, a.paths, a.bounds, 0.0, self.boxes)
        while True:
            count = pairs_of_boxes(self.boxes, self.allowed, self.order, self.list)
            if count <= len(self.list):
                break
            self.list = np.zeros((2 * count, 2), dtype=np.int64)
        pairs = self.list[:count]
        awake = a.wakeful if awake is None else awake
        pairs = pairs[(awake[pairs[:, 0]] | awake[pairs[:, 1]]) == 1]
        pairs = pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]
        if MOST * len(pairs) > len(self.out):
            self.out = np.zeros(2 * MOST * len(pairs), CONTACT)
        n = len(a.bodies)
        kept = np.isin(pairs[:, 0] * n + pairs[:, 1], held["a"] * n + held["b"]).astype(np.int64)
        while True:
            total, most = grid_contacts(
                a.shapes, self.pieces, pairs, kept, self.boxes, a.motion, a.plan, *self.planes, self.nodes, self.out
            )  # fmt: skip
            if most <= len(self.nodes):
                break
            self.nodes = np.zeros(2 * most, NODE)
        contacts = self.out[:total].copy()
        self._remember(contacts, held)
        return contacts

    def _remember(self, contacts: np.ndarray, held: np.ndarray) -> None:
        """A pair that was held before keeps its age, and the impulse of the nearest node of then."""
        n = len(self.arena.bodies)
        keys = held["a"] * n + held["b"]
        for contact in contacts:
            found = np.flatnonzero(keys == contact["a"] * n + contact["b"])
            if found.size:
                nearest = found[np.argmin(lengths(held["point"][found] - contact["point"]))]
                contact["fresh"], contact["age"] = 0, held["age"][nearest]
                contact["impulse"] = held["impulse"][nearest]

    def again(self, contacts: np.ndarray, rows: np.ndarray, wider: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
        """Contacts at other poses: the mesh does not see them move."""
        return contacts[:0], np.zeros(0, dtype=np.int64)

    def touching_now(self, held: np.ndarray, met: np.ndarray) -> np.ndarray:
        """Contacts in the middle of a leg, when a held body meets a stop: those of the last look."""
        return held.copy()

    def start(self, held: np.ndarray, now: float, end: float, awake: np.ndarray) -> None:
        """Nothing to predict."""

    def renew(self, held: np.ndarray, bodies: np.ndarray, t: float, leave: bool) -> None:
        """Nothing to predict."""

    def next(self) -> tuple[float, np.ndarray]:
        """No event between two looks."""
        return NEVER, self.list[:0]
