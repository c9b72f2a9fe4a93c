"""All accelerations but the pressure's, chosen once by what the deck asks for; what is off is not there.

a = - (u . grad) u + g + nu laplacian u + shear of walls          viscosity explicit, or implicit after the rest

Walls that slide by a table (`UBCT` ... of a wall) have the speed of the time at which a term holds: explicit terms that
of their stage, the implicit one that of the step's end. Constant tables are read once.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from flowgmo.errors import StepTooLong
from flowgmo.flow.boundary import Sides
from flowgmo.flow.columns import all_columns
from flowgmo.flow.favor.cut_faces import NO_SOLIDS, find_cut_faces, sort_again
from flowgmo.flow.fields import G, Grid, Open
from flowgmo.flow.immersed.friction import Friction
from flowgmo.flow.momentum.advection import add_advection, make_schemes
from flowgmo.flow.momentum.implicit_viscosity import add_implicit_viscosity
from flowgmo.flow.momentum.prediction import add
from flowgmo.flow.momentum.viscosity import add_viscosity, make_viscosity, viscous_limit
from flowgmo.flow.momentum.viscous_work import ViscousWork
from flowgmo.flow.momentum.wall_shear import find_side_walls, slide
from flowgmo.flow.team import Team
from flowgmo.flow_plan import FluidPlan, SidePlan, SideValues
from flowgmo.mesh import PERIODIC, PRESSURE, WALL


class Momentum:
    """The terms of one scene, with their factors on the mesh."""

    def __init__(
        self, plan: FluidPlan, grid: Grid, openings: Open, sides: Sides, gravity: np.ndarray, present: tuple, team: Team
    ) -> None:
        self.grid, self.openings, self.sides, self.team = grid, openings, sides, team
        self.gravity = gravity
        self.schemes = make_schemes(grid, plan.order)
        shape = tuple(len(d) for d in grid[:3])
        self.every = all_columns(shape)
        self.nu = plan.mu / plan.rho if plan.mu else 0.0
        self.implicit = plan.implicit_viscosity and self.nu > 0.0
        self.operators, self.limit, self.walls = None, np.inf, ()
        if self.nu > 0.0 and not self.implicit:
            self.limit = viscous_limit(grid, self.nu, present)
        self.plan, self.present = plan, present
        self.lines = np.zeros((*shape[:2], 2), np.int32)  # scratch of `renew`
        self.sort_faces()
        self.renew()
        self.scratch = tuple(np.zeros(shape) for _ in range(4)) if self.implicit else ()
        self.work: ViscousWork | None = None
        if self.nu > 0.0:
            joined = [sides.plans[2 * d].kind == PERIODIC for d in range(3)]
            self.work = ViscousWork(team, grid, openings, present, joined, plan.rho, self.nu)

    def sort_faces(self, cells: np.ndarray | None = None) -> None:
        """Sort the faces by the open fractions as they are now; `renew` has to follow.

        cells (n, 3) [with ghosts, in C order]: those whose fractions, or lower faces', are others than when this was
        last done; None: all.
        """
        if cells is None or self.cut is NO_SOLIDS:
            self.cut, self.sorted = find_cut_faces(self.every, self.openings), (None, None, None)
            self.sources = (None, None, None)
        else:
            self.cut, self.sources = sort_again(self.cut, self.openings, cells, self.lines)

    def renew(self, cells: np.ndarray | None = None) -> None:
        """Fit the operators to the sorted faces; walls that move have to be given anew. cells: as of sort_faces."""
        self.friction = None
        if self.nu > 0.0:
            plan, grid, openings, present = self.plan, self.grid, self.openings, self.present
            if cells is None or self._touch_walls(cells):
                self._find_walls()
            args = self.cut, present, plan.no_slip, self.side_walls, self.sorted, self.sources
            self.operators = self.sorted = make_viscosity(self.team, grid, openings, *args)

    def _find_walls(self) -> None:
        """The faces beside walls on the sides of the domain, as far as they are open."""
        plan = self.plan
        no_slip, speeds = self._no_slip(), self._speeds(self.sides.values)
        self.side_walls = tuple(
            find_side_walls(self.grid, self.openings, no_slip, speeds, c, self.present) for c in range(3)
        )
        if any(stick and _changes(side) for stick, side in zip(no_slip, plan.sides, strict=True)):
            self.walls = tuple(w for w in self.side_walls if w is not None)

    def _no_slip(self) -> tuple[bool, ...]:
        """(6,): sides at which the liquid sticks."""
        return tuple(self.plan.no_slip and side.kind == WALL for side in self.plan.sides)

    def _touch_walls(self, cells: np.ndarray) -> bool:
        """Whether cells (n, 3) beside sides at which the liquid sticks are among these."""
        for n, stick in enumerate(self._no_slip()):
            d, upper = divmod(n, 2)
            last = len(self.grid[d]) - G - 1
            if stick and len(cells) and (cells[:, d].max() >= last if upper else cells[:, d].min() <= G):
                return True
        return False

    def move_walls(self, friction: Friction) -> None:
        """The walls of bodies slide in the step to come, by the speeds that `friction` sets."""
        self.friction, operators, V = friction, list(self.operators), self.openings.V
        for c, (o, speed) in enumerate(zip(operators, friction.speeds, strict=True)):
            if speed is None:
                continue
            cut = o.cut._replace(speed=speed)
            if self.implicit:  # symmetric with the volumes that the product of its gradients has
                low, high = cut.rows[:, :3].T, cut.rows[:, :3].T + np.eye(3, dtype=np.int64)[c][:, None]
                cut = cut._replace(V=0.5 * (V[tuple(low)] + V[tuple(high)]))
            operators[c] = o._replace(cut=cut)
        self.operators = tuple(operators)

    def _speeds(self, values: Sequence[SideValues]) -> np.ndarray:
        """(6, 3) [length/time]: how the walls slide when these are the values of the sides."""
        found = np.zeros((6, 3))
        for side, of_side in enumerate(values):
            if self.sides.plans[side].kind == WALL and of_side.velocity is not None:
                found[side] = of_side.velocity
        return found

    def _slide(self, values: Sequence[SideValues]) -> None:
        """Give the walls the speeds of their tables, where any of them changes."""
        if self.walls:
            speeds = self._speeds(values)
            for walls in self.walls:
                slide(walls, speeds)

    def add_accelerations(
        self,
        columns: np.ndarray,
        velocity: list,
        F: np.ndarray | None,
        acceleration: list,
        dt: float,
        gradients: tuple = (None, None, None),
        time: float | None = None,
    ) -> None:
        """Add them on the upper faces of the columns' cells. Ghosts of velocity are filled.

        gradients: grad p / rho of the last step on the cut faces, for slivers (cut_viscosity.py). time: at which the
        walls slide, that of `velocity`; None: the time that the sides have now (Sides.set_time).
        """
        gradients = tuple(
            None if gradient is None else gradient + a[tuple(rows[:, :3].T)]  # what is there already is not slowed down
            for gradient, a, rows in zip(gradients, acceleration, self.cut.rows, strict=True)
        )
        for a, g in zip(acceleration, self.gravity, strict=True):
            if a is not None and g != 0.0:
                self.team.run(add, columns, float(g), a)
        add_advection(
            self.team, columns, self.schemes, self.openings, self.cut, tuple(velocity), F, tuple(acceleration)
        )
        if self.operators is not None and not self.implicit:
            now = self.sides.values if time is None or not self.walls else [p.at(time) for p in self.sides.plans]
            self._slide(now)
            if self.friction is not None:
                self.friction.meet(velocity)
            add_viscosity(
                self.team, columns, self.operators, tuple(velocity), F, tuple(acceleration), self.nu, dt, gradients,
                self.work.changes,
            )  # fmt: skip
            self.work.note_sides(self.side_walls, velocity, F)

    @property
    def slivers(self) -> tuple:
        """Cut faces (n, 4) of u, v, w where the walls of slivers need the last step's pressure; None elsewhere."""
        if self.operators is None or self.implicit:
            return None, None, None
        return tuple(None if o is None or o.cut is None else o.cut.rows for o in self.operators)

    def diffuse(self, columns: np.ndarray, velocity: list, F: np.ndarray | None, dt: float) -> None:
        """Implicit viscosity: change the velocity, ghosts filled before, and leave the change in `work.changes`; ghosts
        and joined sides are not filled again. Raises StepTooLong."""
        self._slide(self.sides.values)
        self.work.before(columns, velocity)
        if self.friction is not None:
            self.friction.diffuse(velocity, partial(self._solve, columns, velocity, F, dt, "all"),
                                  partial(self._solve, columns, velocity, F, dt, "walls"))  # fmt: skip
        else:
            self._solve(columns, velocity, F, dt, "all")
        self.work.after(columns, velocity)
        self.work.note_sides(self.side_walls, velocity, F)

    def _solve(self, columns: np.ndarray, velocity: list, F: np.ndarray | None, dt: float, by: str) -> None:
        """Implicit viscosity; by: see add_implicit_viscosity. Raises StepTooLong."""
        free = tuple(self.sides.plans[2 * d + 1].kind in (PERIODIC, PRESSURE) for d in range(3))
        ended = add_implicit_viscosity(
            self.team, columns, self.grid, self.openings.V, self.operators, tuple(velocity), F, self.nu, dt,
            self.scratch, self.sides.fill_change, free, by,
        )  # fmt: skip
        if not all(solved.good for solved in ended):
            raise StepTooLong("the implicit viscosity did not converge")


def _changes(side: SidePlan) -> bool:
    """Whether a side's velocity is another at some other time."""
    return side.velocity is not None and bool((side.velocity != side.velocity[0]).any())
