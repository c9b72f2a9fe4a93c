"""What viscosity takes from the liquid's energy in a step, and what walls that slide give.

A step changes the velocity of a face by several terms, u' - u = sum of e, and with the inertia m that the kinetic
energy counts there (observe/measures.py: half of the liquid of either cell), the energy by

    m (u'^2 - u^2) / 2 = sum over the terms of  m e (u + u') / 2

exactly. So viscosity takes from the liquid

    taken = - sum of m e (u + u') / 2        e = dt (mean of the stages' viscous accelerations), or what the implicit
                                             solution changes; u before the step, u' after the pressure

with u' after the pressure, since before it u* falls by g dt in liquid at rest. It counts what was done to the liquid,
not grad u : grad u of some formula: the two differ by the order of the step. In slivers e holds what viscosity makes of
the other forces too (cut_viscosity.py). Part of `taken` moves walls, or comes from them:

    lost = taken + work of the walls on the liquid
         = nu [ sum m c_n (u_n - u)^2 / 2 + sum m s (u - u_wall)^2 ] >= 0          once u = u' = the stages' mean

The work of sides that slide is that of m nu s (u_wall - u) u_wall of the stages, that of bodies minus their load times
their way (wet_loads.py). Faces whose velocity is given (sides of the domain, faces in bodies' gaps) take no part.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from flowgmo.flow.favor.cut_faces import STEPS, U64, wet_face
from flowgmo.flow.fields import G, Grid, Open
from flowgmo.flow.momentum.prediction import fill
from flowgmo.flow.momentum.wall_shear import SideWalls
from flowgmo.flow.team import Team
from flowgmo.kernel import flow_kernel, inner

Array = np.ndarray


class ViscousLoss(NamedTuple):
    """Of one step [energy]: lost in viscosity; by_sides: given to the liquid by sides that slide."""

    lost: float
    by_sides: float


@inner
def _inertia(F, V, dx, dy, dz, i, j, k, ci, cj, ck):
    """Volume [length3] of liquid that moves with a face: half of that of its two cells."""
    a = i + ci
    b = j + cj
    h = k + ck
    below = dx[i] * dy[j] * dz[k]
    above = dx[a] * dy[b] * dz[h]
    if V is not None:
        below *= V[i, j, k]
        above *= V[a, b, h]
    if F is not None:
        below *= F[i, j, k]
        above *= F[a, b, h]
    return 0.5 * (below + above)


@flow_kernel
def work_of(columns, first, last, ci, cj, ck, ends, F, V, A, dx, dy, dz, change, old, new, sums):
    """sums (n,) = sum of inertia change (old + new) / 2 of each column; ends (3,): first faces that are left out."""
    for c in range(first, last):
        i = U64(columns[c, 0])
        j = U64(columns[c, 1])
        total = 0.0
        if i < ends[0] and j < ends[1]:
            for k in range(U64(columns[c, 2]), min(U64(columns[c, 3]), ends[2])):
                part = change[i, j, k] * (old[i, j, k] + new[i, j, k])
                if A is not None:
                    part = part if A[i, j, k] > 0.0 else 0.0
                total += _inertia(F, V, dx, dy, dz, i, j, k, ci, cj, ck) * part
        sums[c] = 0.5 * total


@flow_kernel
def work_of_sides(rows, first, last, ci, cj, ck, ends, F, V, dx, dy, dz, s, speed, q, out):
    """out (n,) = inertia s (speed - q) speed of faces beside sides; arguments as of SideWalls and work_of."""
    for r in range(first, last):
        i = U64(rows[r, 0])
        j = U64(rows[r, 1])
        k = U64(rows[r, 2])
        out[r] = 0.0
        if i < ends[0] and j < ends[1] and k < ends[2] and wet_face(F, i, j, k, ci, cj, ck):
            inertia = _inertia(F, V, dx, dy, dz, i, j, k, ci, cj, ck)
            out[r] = inertia * s[r] * (speed[r] - q[i, j, k]) * speed[r]


@flow_kernel
def put(columns, first, last, u, out):
    """out = u on the columns' upper faces."""
    for c in range(first, last):
        i = U64(columns[c, 0])
        j = U64(columns[c, 1])
        for k in range(U64(columns[c, 2]), U64(columns[c, 3])):
            out[i, j, k] = u[i, j, k]


@flow_kernel
def take_off(columns, first, last, u, out):
    """out = u - out on the columns' upper faces."""
    for c in range(first, last):
        i = U64(columns[c, 0])
        j = U64(columns[c, 1])
        for k in range(U64(columns[c, 2]), U64(columns[c, 3])):
            out[i, j, k] = u[i, j, k] - out[i, j, k]


class ViscousWork:
    """Of one scene, step by step: `begin`, the stages' `note_sides` with `changes` written, `close`.

    changes: an array of mesh size for each direction that is there, upper faces: the sum of the stages' viscous
    accelerations [length/time2] (explicit), or the change of velocity [length/time] (implicit: `before`, `after`).
    """

    def __init__(
        self, team: Team, grid: Grid, openings: Open, present: Sequence[bool], joined: Sequence[bool], rho: float,
        nu: float,
    ) -> None:  # fmt: skip
        """joined (3,): directions whose sides are periodic. rho [mass/length3], nu [length2/time]."""
        self.team, self.grid, self.openings, self.rho, self.nu = team, grid, openings, rho, nu
        shape = tuple(len(d) for d in grid[:3])
        self.changes = tuple(np.zeros(shape) if there else None for there in present)
        end = np.array(shape, np.uint64) - np.uint64(G)
        given = np.array([not one for one in joined])  # the velocity on the upper side is no unknown
        self.ends = tuple(tuple(end - np.uint64(1) * (given & (np.arange(3) == c))) for c in range(3))
        self.stages, self.slid, self.implicit = 0, 0.0, False

    def begin(self, columns: Array) -> None:
        """A step begins; columns: those of its faces."""
        self.stages, self.slid, self.implicit = 0, 0.0, False
        for change in self.changes:
            if change is not None:
                self.team.run(fill, columns, 0.0, change)

    def before(self, columns: Array, velocity: Sequence[Array | None]) -> None:
        """Implicit viscosity is about to change the velocity."""
        for u, change in zip(velocity, self.changes, strict=True):
            if change is not None:
                self.team.run(put, columns, u, change)

    def after(self, columns: Array, velocity: Sequence[Array | None]) -> None:
        """It has done so."""
        self.implicit = True
        for u, change in zip(velocity, self.changes, strict=True):
            if change is not None:
                self.team.run(take_off, columns, u, change)

    def note_sides(self, walls: Sequence[SideWalls | None], velocity: Sequence[Array | None], F: Array | None) -> None:
        """One more stage, with this velocity and the sides' speeds as they are."""
        self.stages += 1
        for c, (one, q) in enumerate(zip(walls, velocity, strict=True)):
            if one is None or q is None or not one.speed.any():
                continue
            out, V = np.empty(len(one.rows)), self.openings.V
            self.team.run(
                work_of_sides, one.rows, *STEPS[c], self.ends[c], F, V, *self.grid[:3], one.s, one.speed, q, out
            )
            self.slid += float(out.sum())

    def close(
        self, columns: Array, old: Sequence[Array | None], new: Sequence[Array | None], F: Array | None, dt: float,
        held: Sequence[Array | None] | None = None,
    ) -> ViscousLoss:  # fmt: skip
        """The step's ViscousLoss. old, new: velocities before the step and after the pressure; F [-] that they move;
        held: faces (flat) of each component that got a velocity after explicit viscosity."""
        factor = 1.0 if self.implicit else dt / max(self.stages, 1)
        total, sums = 0.0, np.empty(len(columns))
        for c, (change, u, v) in enumerate(zip(self.changes, old, new, strict=True)):
            if change is None:
                continue
            if held is not None and not self.implicit:
                change.reshape(-1)[held[c]] = 0.0
            where = F, self.openings.V, self.openings[1 + c], *self.grid[:3]
            self.team.run(work_of, columns, *STEPS[c], self.ends[c], *where, change, u, v, sums)
            total += float(sums.sum())
        by_sides = self.rho * self.nu * dt / max(self.stages, 1) * self.slid
        return ViscousLoss(by_sides - self.rho * factor * total, by_sides)
