"""All accelerations but the pressure's, chosen once by what the deck asks for; what is off is not there.

a = - (u . grad) u + g + nu laplacian u + shear of walls          viscosity explicit, or implicit after the rest
"""

from __future__ import annotations

import numpy as np

from flowgmo.errors import StepTooLong
from flowgmo.flow.advection import add_advection, make_schemes
from flowgmo.flow.boundary import Sides
from flowgmo.flow.columns import all_columns
from flowgmo.flow.cut_faces import find_cut_faces
from flowgmo.flow.fields import Grid, Open
from flowgmo.flow.implicit_viscosity import add_implicit_viscosity
from flowgmo.flow.prediction import add
from flowgmo.flow.team import Team
from flowgmo.flow.viscosity import add_viscosity, make_viscosity, viscous_limit
from flowgmo.flow.wall_shear import find_side_walls
from flowgmo.flow_plan import FluidPlan
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
        self.cut = find_cut_faces(all_columns(shape), openings)
        self.nu = plan.mu / plan.rho if plan.mu else 0.0
        self.implicit = plan.implicit_viscosity and self.nu > 0.0
        self.operators, self.limit = None, np.inf
        if self.nu > 0.0:
            no_slip = tuple(plan.no_slip and side.kind == WALL for side in plan.sides)
            walls = tuple(find_side_walls(grid, openings, no_slip, self._speeds(), c, present) for c in range(3))
            self.operators = make_viscosity(team, grid, openings, self.cut, present, plan.no_slip, walls)
            self.limit = np.inf if self.implicit else viscous_limit(grid, self.nu, present)
        self.scratch = tuple(np.zeros(shape) for _ in range(4)) if self.implicit else ()

    def _speeds(self) -> np.ndarray:
        """(6, 3) [length/time]: how the walls slide."""
        found = np.zeros((6, 3))
        for side, values in enumerate(self.sides.values):
            if self.sides.plans[side].kind == WALL and values.velocity is not None:
                found[side] = values.velocity
        return found

    def add_accelerations(
        self,
        columns: np.ndarray,
        velocity: list,
        F: np.ndarray | None,
        acceleration: list,
        dt: float,
        gradients: tuple = (None, None, None),
    ) -> None:
        """Add them on the upper faces of the columns' cells. Ghosts of velocity are filled.

        gradients: grad p / rho of the last step on the cut faces, for slivers (cut_viscosity.py).
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
            add_viscosity(
                self.team, columns, self.operators, tuple(velocity), F, tuple(acceleration), self.nu, dt, gradients
            )

    @property
    def slivers(self) -> tuple:
        """Cut faces (n, 4) of u, v, w where the walls of slivers need the last step's pressure; None elsewhere."""
        if self.operators is None or self.implicit:
            return None, None, None
        return tuple(None if o is None or o.cut is None else o.cut.rows for o in self.operators)

    def diffuse(self, columns: np.ndarray, velocity: list, F: np.ndarray | None, dt: float) -> None:
        """Implicit viscosity: change the predicted velocity, ghosts filled before. Raises StepTooLong."""
        if not self.implicit:
            return
        free = tuple(self.sides.plans[2 * d + 1].kind in (PERIODIC, PRESSURE) for d in range(3))
        ended = add_implicit_viscosity(
            self.team, columns, self.grid, self.openings.V, self.operators, tuple(velocity), F, self.nu, dt,
            self.scratch, self.sides.fill_change, free,
        )  # fmt: skip
        if not all(solved.good for solved in ended):
            raise StepTooLong("the implicit viscosity did not converge")
        self.sides.fill_velocity(velocity)  # joined sides changed on one side only
