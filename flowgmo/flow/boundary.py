"""The six sides of the domain: ghost values of velocity, fraction and pressure. All ghosts are filled here.

kind          normal velocity on the side     ghosts of velocity      F           pressure equation
1 symmetry    0                               mirrored                mirrored    closed
2 wall        0                               mirrored (shear: wall_shear.py)     closed
3 continuative as inside                      as inside               as inside   closed, the flow out is given
4 periodic    of the other side               of the other side       other side  joined
5 pressure    found by the projection         as inside               given       held, half a cell outside
6 velocity    given                           given                   given       closed, the flow is given
8 outflow     leaves, as into the empty       as inside               as inside   closed, the flow out is given

index along a direction:   0   1 | 2  ..  n + 1 | n + 2  n + 3      faces on the sides: 1 and n + 1
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flowgmo.flow.fields import G, Grid
from flowgmo.flow.ghost_layers import GhostLayers
from flowgmo.flow.layers import fill_dry_layers, fill_layers, join_cells
from flowgmo.flow.outflow import emptying
from flowgmo.flow_plan import SidePlan, SideValues
from flowgmo.mesh import CONTINUATIVE, OUTFLOW, PERIODIC, PRESSURE, VELOCITY

GIVEN = (CONTINUATIVE, VELOCITY, OUTFLOW)  # the projection takes the side's velocity as it is


class Sides:
    """What holds on the six sides (`plans`, SidePlan) at one time.

    gravity (3,), rho: for the hydrostatic pressure under a given height (along z, as in the deck). streams: numbers of
    the outflow sides through which the liquid streams from the start (let_out). A (3,): open fractions of the faces,
    None without solids.
    """

    def __init__(
        self,
        plans: Sequence[SidePlan],
        grid: Grid,
        z: np.ndarray,
        rho: float,
        gravity: np.ndarray,
        streams: Sequence[int] = (),
        A: Sequence[np.ndarray | None] = (None, None, None),
    ) -> None:
        self.streams = frozenset(streams)
        self.plans, self.grid, self.z, self.rho, self.gravity = tuple(plans), grid, z, rho, gravity
        self.widths = (grid.dx, grid.dy, grid.dz)
        self.n = tuple(len(w) - 2 * G for w in self.widths)
        self.periodic = tuple(plans[2 * d].kind == PERIODIC for d in range(3))
        self.wider = [_wider(A[m // 2], m // 2, self.n[m // 2], m % 2 == 1) for m in range(6)]
        self.ghosts = GhostLayers(self.plans, self.n)
        self.set_time(0.0)

    def lower_face_acts(self, d: int) -> bool:
        """Whether the pressure moves the faces on the lower side along d."""
        return self.plans[2 * d].kind in (PRESSURE, PERIODIC)

    def set_time(self, t: float, since: float = np.inf) -> None:
        """Take the tables' values at this time; of velocities across sides the mean since another one, if earlier."""
        self.values = [plan.over(since, t) for plan in self.plans]
        self.ghosts.take(self.values)

    # ---- velocity

    def fill_normal(self, velocity: Sequence[np.ndarray | None]) -> None:
        """Only the velocities across the sides: on them, and in the ghosts beyond."""
        for d, a in enumerate(velocity):
            if a is not None:
                fill_layers(a, *self.ghosts.of_kind("across", d))

    def fill_velocity(self, velocity: Sequence[np.ndarray | None]) -> None:
        """Ghosts of u, v, w, and their values on sides where they are 0, given, or joined."""
        for e, a in enumerate(velocity):
            if a is not None:
                fill_layers(a, *self.ghosts.of_kind("around", e))

    def fill_change(self, c: int, a: np.ndarray) -> None:
        """Ghosts of a change of component c of the velocity: as of the velocity, 0 where that is given."""
        fill_layers(a, *self.ghosts.of_kind("changed", c))

    def let_out(
        self,
        old: Sequence[np.ndarray | None],
        new: Sequence[np.ndarray | None],
        dt: float,
        F: np.ndarray | None = None,
    ) -> None:
        """Predicted velocity on continuative, outflow, and pressure sides. The projection does the rest.

        Continuative: what passes one face inside, the liquid goes on outside as it is, still water stays still (what
        passes, not how fast: through a gap that widens towards the side the speed of the gap would let out more than
        the gap brings, the rest comes from beside, faster at every step, without bound). Outflow: what
        leaves is carried across the side at its own speed, u_t + u u_n = 0, and nothing comes back (Orlanski 1976, with
        the local speed); where no stream left at the start, water meets no liquid there (outflow.py). Pressure: where
        it leaves it gains what the face inside gains; what enters brings its own speed along, and gains gravity only.
        dt: of the whole step, in each of its stages. F: of the start of the step, None without a surface.
        """
        for d in range(3):
            if new[d] is None:
                continue
            for upper in (False, True):
                kind = self.plans[2 * d + upper].kind
                if kind not in (CONTINUATIVE, OUTFLOW, PRESSURE):
                    continue
                side, inside, sign = (self.n[d] + 1, self.n[d], 1.0) if upper else (1, 2, -1.0)
                if kind == PRESSURE:
                    gained = _plane(new[d], d, inside) - _plane(old[d], d, inside)
                    enters = _plane(old[d], d, side) * sign < 0.0
                    gained = np.where(enters, self.gravity[d] * dt, gained)
                    _plane(new[d], d, side)[...] = _plane(old[d], d, side) + gained
                    continue
                if kind == CONTINUATIVE:
                    _plane(new[d], d, side)[...] = _plane(new[d], d, inside) * self.wider[2 * d + upper]
                    continue
                here = _plane(old[d], d, side) * sign
                there = _plane(old[d], d, inside) * sign * self.wider[2 * d + upper]
                width = self.widths[d][side if upper else side + 1]
                share = np.minimum(np.maximum(here, there).clip(0.0) * (dt / width), 1.0)
                still = 2 * d + upper not in self.streams
                gain, turn = emptying(F, d, upper, there, self.widths, self.gravity) if still else (0.0, 0.0)
                share = np.where(gain > 0.0, np.minimum(turn * dt, 1.0), share)
                _plane(new[d], d, side)[...] = sign * np.maximum(here + share * (there + gain - here), 0.0)

    def follow(self, velocity: Sequence[np.ndarray | None], b: Sequence[np.ndarray | None]) -> None:
        """Faces of pressure sides that no liquid cell touches (b = 0): as one face inside.

        No pressure holds them there: what advection adds at every step would pile up without bound.
        """
        for d in range(3):
            if velocity[d] is None:
                continue
            for upper in (False, True):
                if self.plans[2 * d + upper].kind == PRESSURE:
                    side, inside = (self.n[d] + 1, self.n[d]) if upper else (1, 2)
                    u, free = velocity[d], _plane(b[d], d, side) == 0.0
                    _plane(u, d, side)[free] = _plane(u, d, inside)[free]

    def loosen(self, velocity: Sequence[np.ndarray | None], F: np.ndarray | None, least: float) -> None:
        """Closed sides that no liquid touches (F <= least beside them): as one face inside, ghosts too.

        The normal velocity 0 of a wall is that of liquid on it. Where there is air between, advection would carry it
        into liquid that moves away, as if the wall held on to it. `tighten` puts it back.
        """
        if F is None:
            return
        for d, a in enumerate(velocity):
            if a is not None:
                rows, _ = self.ghosts.of_kind("loose", d)
                beside = np.where(rows[:, 1] > G, self.n[d] + 1, G)
                fill_dry_layers(a, rows, F, beside, least)

    def tighten(self, velocity: Sequence[np.ndarray | None]) -> None:
        """Closed sides again, after `loosen`."""
        for d, a in enumerate(velocity):
            if a is not None:
                fill_layers(a, *self.ghosts.of_kind("shut", d))

    # ---- liquid

    def fill_fraction(self, F: np.ndarray | None) -> None:
        """Ghosts of F: given where liquid may enter (`spread` says how it lies there), mirrored or joined elsewhere."""
        if F is None:
            return
        for side, plan in enumerate(self.plans):
            d, upper = divmod(side, 2)
            if plan.kind in (PRESSURE, VELOCITY):
                for ghost, _, _ in self.ghosts.beyond(d, bool(upper)):
                    _plane(F, d, ghost)[...] = self._outside_fraction(self.values[side], d)
            else:
                fill_layers(F, *self.ghosts.of_kind("mirrored", side))

    @property
    def spread(self) -> tuple[float | None, ...]:
        """Of each side: F of what enters, evenly spread, where it is given and neither all liquid nor none; a height
        says where the liquid lies, and its ghosts have planes."""
        given = [values.fraction if values.height is None else None for values in self.values]
        return tuple(F if F is not None and 0.0 < F < 1.0 else None for F in given)

    def _outside_fraction(self, values: SideValues, d: int) -> np.ndarray | float:
        height = values.height
        if height is None:
            return 1.0 if values.fraction is None else values.fraction
        if d == 2:
            return 1.0 if height > self.z[0] else 0.0
        dz = self.grid.dz
        bottom = np.concatenate([[self.z[0] - dz[1] - dz[0], self.z[0] - dz[1]], self.z, [self.z[-1] + dz[-2]]])
        return np.clip((height - bottom) / dz, 0.0, 1.0)[None, :]

    # ---- pressure equation

    def outside_pressure(self, number: int, speed: np.ndarray) -> np.ndarray | float:
        """Pressure on a pressure side relative to the void's; speed: the velocity along each of its faces' normals
        into the domain, for a side at stagnation."""
        plan, values, d = self.plans[number], self.values[number], number // 2
        height, p = values.height, values.pressure
        if height is not None and d != 2:
            centre = np.concatenate([[self.z[0]] * G, 0.5 * (self.z[1:] + self.z[:-1]), [self.z[-1]] * G])
            p = p + np.maximum(-self.rho * self.gravity[2] * (height - centre), 0.0)[None, :]
        if plan.stagnation:
            p = p - 0.5 * self.rho * np.maximum(speed, 0.0) ** 2
        return p

    def set_coefficients(self, b: Sequence[np.ndarray | None], A: Sequence[np.ndarray | None], wet: np.ndarray) -> None:
        """b on the sides: 0 where closed or given, held at half a cell where the pressure is given."""
        for d in range(3):
            if b[d] is None:
                continue
            for upper in (False, True):
                kind = self.plans[2 * d + upper].kind
                side = self.n[d] + 1 if upper else 1
                if kind == PERIODIC:
                    if not upper:
                        _plane(b[d], d, 1)[...] = _plane(b[d], d, self.n[d] + 1)
                elif kind == PRESSURE:
                    inside = side if upper else side + 1
                    e, f = (k for k in range(3) if k != d)
                    area = np.multiply.outer(self.widths[e], self.widths[f])
                    if A[d] is not None:
                        area = area * _plane(A[d], d, side)
                    liquid = _plane(wet, d, inside)
                    _plane(b[d], d, side)[...] = area * liquid / (0.5 * self.widths[d][inside])
                else:
                    _plane(b[d], d, side)[...] = 0.0

    def fill_pressure(self, q: np.ndarray, dt: float, velocity: Sequence[np.ndarray | None]) -> None:
        """Ghosts of q = p dt / rho next to pressure sides, and joined ones; others stay as they are (their b is 0)."""
        for d in range(3):
            for upper in (False, True):
                plan = self.plans[2 * d + upper]
                ghost = self.n[d] + 2 if upper else 1
                if plan.kind == PRESSURE:
                    u = velocity[d]
                    into = 0.0 if u is None else _plane(u, d, self.n[d] + 1 if upper else 1) * (-1.0 if upper else 1.0)
                    _plane(q, d, ghost)[...] = self.outside_pressure(2 * d + upper, into) * (dt / self.rho)
        self.join(q)

    def join(self, a: np.ndarray) -> None:
        """Ghosts of a cell value at periodic sides."""
        join_cells(a, *self.periodic)


def join_faces(b: Sequence[np.ndarray | None], periodic: Sequence[bool]) -> None:
    """The faces on the lower side are those on the upper one."""
    for d in range(3):
        if periodic[d] and b[d] is not None:
            _plane(b[d], d, 1)[...] = _plane(b[d], d, b[d].shape[d] - 2 * G + 1)


def _wider(A: np.ndarray | None, d: int, n: int, upper: bool) -> np.ndarray | float:
    """Open area one face inside a side, in those of the side's own faces; 1 at most, and without solids."""
    if A is None:
        return 1.0
    side, inside = _plane(A, d, n + 1 if upper else 1), _plane(A, d, n if upper else 2)
    return np.minimum(inside, side) / np.where(side > 0.0, side, 1.0)


def _plane(a: np.ndarray, d: int, k: int) -> np.ndarray:
    """The layer k along direction d, a view."""
    return a[(slice(None),) * d + (k,)]
