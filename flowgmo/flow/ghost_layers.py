"""Which layers the ghosts of a velocity or a cell value are copies of, by the kinds of the sides (table: boundary.py).

closed       -a  0 | a       the side itself 0, mirrored beyond with the other sign
joined        b  c | .. b c  the cells of the other side
given         U  U | a       along the side as across it
all others    a  a | a       mirrored along the side; across it, as on the side

Velocities need no ghosts at a closed side that is far from the liquid: nothing reads them. Those above and below lie in
another line of memory for each column, so that it takes as long to fill them as all the others.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flowgmo.flow.columns import extent_of
from flowgmo.flow.fields import G
from flowgmo.flow.layers import SET, Layers, as_arguments
from flowgmo.flow_plan import SidePlan, SideValues
from flowgmo.mesh import PERIODIC, SYMMETRY, VELOCITY, WALL

CLOSED = (SYMMETRY, WALL)
FAR = 2  # cells between the widest columns that kernels visit and a side: as far as they read beside them
OF_VELOCITY = ("across", "around", "shut", "loose")


class GhostLayers:
    """Of sides of these plans around n (3,) cells; `take` gives the values of the sides at one time."""

    def __init__(self, plans: Sequence[SidePlan], n: tuple[int, ...]) -> None:
        self.plans, self.n = tuple(plans), n
        self.values: Sequence[SideValues] = ()
        self.far = (False,) * 6
        self.kept: dict[tuple, tuple[np.ndarray, np.ndarray]] = {}

    def stay_near(self, columns: np.ndarray) -> None:
        """Velocities are read in these columns, and beside them as far as FAR, only: leave sides beyond as they are."""
        ends = extent_of(columns, np.array(self.n) + 2 * G)
        away = [(low - G, n + G - high) for (low, high), n in zip(ends, self.n, strict=True)]
        away = [cells for pair in away for cells in pair]
        self.far = tuple(plan.kind in CLOSED and int(m) >= FAR for plan, m in zip(self.plans, away, strict=True))

    def take(self, values: Sequence[SideValues]) -> None:
        """The values of the sides from now on."""
        self.values = values
        if any(plan.kind == VELOCITY for plan in self.plans):
            self.kept.clear()

    def of_kind(self, kind: str, number: int) -> tuple[np.ndarray, np.ndarray]:
        """Arguments of layers.fill_layers, made once for all values of the sides.

        kind: across (component `number` on and beyond its own sides), around (at all sides), shut (at its closed
        sides), changed (a change of it), loose (its closed sides as one face inside), mirrored (cells beyond side
        `number`).
        """
        far = self.far if kind in OF_VELOCITY else ()
        key = kind, number, far
        if key not in self.kept:
            layers = getattr(self, "_" + kind)(number)
            self.kept[key] = as_arguments([row for row in layers if not (any(far) and far[self._side_of(*row[:2])])])
        return self.kept[key]

    def _side_of(self, d: int, layer: int) -> int:
        """The side that a ghost layer along d, or the layer of a side's own faces, belongs to."""
        return 2 * d + (layer > G)

    def beyond(self, d: int, upper: bool) -> list[tuple[int, int, int]]:
        """(ghost, its mirror image inside, its image on the other side) of both layers."""
        n = self.n[d]
        first = [(n + 2 + m, n + 1 - m, 2 + m) if upper else (1 - m, 2 + m, n + 1 - m) for m in range(G)]
        return [(g, min(max(i, G), n + 1), min(max(j, G), n + 1)) for g, i, j in first]

    def _across(self, d: int) -> Layers:
        return self._normal(d, False) + self._normal(d, True)

    def _around(self, e: int) -> Layers:
        rows = []
        for side, plan in enumerate(self.plans):
            d, upper = divmod(side, 2)
            given = self.values[side].velocity if plan.kind == VELOCITY else None
            along = None if given is None else given[e]
            rows += self._normal(d, bool(upper)) if e == d else self._along(side, along)
        return rows

    def _shut(self, d: int) -> Layers:
        closed = [bool(upper) for upper in range(2) if self.plans[2 * d + upper].kind in CLOSED]
        return [row for upper in closed for row in self._normal(d, upper)]

    def _changed(self, c: int) -> Layers:
        rows = []
        for side, plan in enumerate(self.plans):
            d, upper = divmod(side, 2)
            if plan.kind != VELOCITY:
                rows += self._normal(d, bool(upper)) if c == d else self._along(side, None)
                continue
            layers = [ghost for ghost, _, _ in self.beyond(d, bool(upper))]
            layers += [self.n[d] + 1 if upper else 1] if c == d else []
            rows += [(d, layer, SET, 0.0) for layer in layers]
        return rows

    def _loose(self, d: int) -> Layers:
        n, rows = self.n[d], []
        for upper in range(2):
            if self.plans[2 * d + upper].kind in CLOSED:
                inside, beyond = (n, (n + 1, n + 2, n + 3)) if upper else (2, (1, 0))
                rows += [(d, layer, inside, 1.0) for layer in beyond]
        return rows

    def _mirrored(self, side: int) -> Layers:
        return self._along(side, None)

    def _normal(self, d: int, upper: bool) -> Layers:
        """Velocity across a side: on the side itself and in the ghosts."""
        n, plan = self.n[d], self.plans[2 * d + upper]
        side, ghosts = (n + 1, (n + 2, n + 3)) if upper else (1, (0,))
        if plan.kind in CLOSED:
            inside = [side - m if upper else side + m for m in range(1, len(ghosts) + 1)]
            mirrored = [(d, k, min(max(i, 1), n + 1), -1.0) for k, i in zip(ghosts, inside, strict=True)]
            return [(d, side, SET, 0.0), *mirrored]
        if plan.kind == PERIODIC:
            pairs = ((n + 2, 2), (n + 3, min(3, n + 1))) if upper else ((1, n + 1), (0, n))
            return [(d, ghost, image, 1.0) for ghost, image in pairs]
        given = []
        if plan.kind == VELOCITY:
            given = [(d, side, SET, float(self.values[2 * d + upper].velocity[d]))]
        return given + [(d, k, side, 1.0) for k in ghosts]

    def _along(self, side: int, given: float | None) -> Layers:
        """Velocity along a side, or a value of cells: the ghosts."""
        d, upper = divmod(side, 2)
        ghosts = self.beyond(d, bool(upper))
        if given is not None:
            return [(d, ghost, SET, float(given)) for ghost, _, _ in ghosts]
        joined = self.plans[side].kind == PERIODIC
        return [(d, ghost, image if joined else inside, 1.0) for ghost, inside, image in ghosts]
