"""Make the predicted velocities fit each other and the walls, and find the pressure that does it.

    u = u* - (1 / rho) dt grad p         on every open face of a liquid cell
    sum over faces (A S u) = source      in every liquid cell

The source is 0, but for cells that hold more than their volume (F > 1, left over by the tolerance of earlier
solutions): they push it out; and for voids beside closed faces (voids.py), for which this is solved again until none
takes more than it holds. Liquid that gives way (beta = 1 / (rho c2), `rcsql`) adds beta (p - p_before) / dt times the
volume to the sum; F is then rho / rho0 = 1 + beta p at most. Liquid that is shut in everywhere (no surface, no pressure
side) has a pressure up to a constant, and its flows must add up to nothing; region by region the mean is removed, and a
flow that does not add up is an error.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from flowgmo.flow.boundary import Sides
from flowgmo.flow.columns import all_columns, cells_in, clear_left, columns_among, widen
from flowgmo.flow.fields import G, Grid, Open
from flowgmo.flow.pressure.conjugate_gradients import ConjugateGradients, Solved, dots
from flowgmo.flow.pressure.exits import Exits
from flowgmo.flow.pressure.face_flows import difference, net_inflow, push
from flowgmo.flow.pressure.multigrid import Multigrid
from flowgmo.flow.pressure.overfull import none_overfull, overfull
from flowgmo.flow.pressure.pressure_matrix import (
    add_give,
    clear,
    diagonals,
    face_coefficients,
    foresee,
    scale_into,
    scale_liquid,
    surface_coefficients,
)
from flowgmo.flow.pressure.relaxation import Relaxation
from flowgmo.flow.pressure.sealed import Sealed
from flowgmo.flow.pressure.surface_distance import mark_liquid
from flowgmo.flow.pressure.thin_cells import ThinFaces, add_rest, multiply
from flowgmo.flow.pressure.voids import Voids, closed_sides
from flowgmo.flow.solid_lines import SolidLines
from flowgmo.flow.surface.planes import Planes
from flowgmo.flow.team import Team
from flowgmo.mesh import PRESSURE

if TYPE_CHECKING:
    from flowgmo.flow.immersed.coupling import Coupling
    from flowgmo.flow.pressure.bodies import Couple, Opening

HALF = 0.1  # F below it: the centre is dry, also in cells that a solid cuts, whose centres lie in the open
MOST_SOLUTIONS = (
    20  # for the voids; 4 at most in boxes of 1200 cells. What is not shut by then overfills, and is pushed out later
)
MUCH = 1e200  # [1/time] of a cell: an answer is asked for, whatever a sealed region would not take


@dataclass
class Matrix:
    """The pressure equation of the present surface: b of faces, diagonal; columns of liquid cells and of faces."""

    bx: np.ndarray | None
    by: np.ndarray | None
    bz: np.ndarray | None
    diagonal: np.ndarray
    columns: np.ndarray
    faces: np.ndarray

    @property
    def b(self) -> tuple:
        return self.bx, self.by, self.bz

    @property
    def arrays(self) -> tuple:
        return self.bx, self.by, self.bz, self.diagonal


class Projector:
    """The pressure equation and its solver, with their arrays: 7 of float64 and 8 of float32 of mesh size.

    beta [time2 length/mass]: 1 / (rho c2) of liquid that gives way, None where it does not. solves: how many systems
    were solved so far; more than one a projection where a void is filled within the step (lids.py).
    """

    def __init__(
        self,
        grid: Grid,
        openings: Open,
        sides: Sides,
        team: Team,
        rho: float,
        *,
        plain: bool = False,
        thin: tuple[ThinFaces | None, ...] = (None, None, None),
        still: Open | None = None,
        beta: float | None = None,
        planes: Planes | None = None,
        solid_lines: SolidLines | None = None,
    ) -> None:
        self.grid, self.openings, self.sides, self.team, self.rho, self.beta = grid, openings, sides, team, rho, beta
        self.ease = 0.0  # [time] in which PUSH of an excess leaves, where steps are shorter
        self.strength = np.inf  # [stress] with which it is pushed out at most (overfull.py)
        self.over = none_overfull()
        shape = tuple(len(d) for d in (grid.dx, grid.dy, grid.dz))
        b = [np.zeros(shape) if n > 1 + 2 * G else None for n in shape]
        none = np.zeros((0, 4), np.int32)
        self.matrix = Matrix(*b, np.zeros(shape), none, none)
        self.right, self.q = np.zeros(shape), np.zeros(shape)
        ends = [float(np.median(d[G:-G])) for d in (grid.dx, grid.dy, grid.dz)]
        widths = (grid.dx, grid.dy, grid.dz)
        self.multigrid = None if plain else Multigrid(shape, tuple(ends), sides.periodic, team)
        self.solver = (
            Relaxation(shape, widths, sides.periodic, team)
            if plain
            else ConjugateGradients(shape, widths, self.multigrid, team)
        )
        self.wet = np.zeros(shape, np.int8)
        self.solid_lines = solid_lines or SolidLines()
        self.planes = planes or Planes(grid, self.solid_lines)
        self.thin = thin
        self.eased = (still, grid) if any(t is not None for t in thin) else None
        self.every = all_columns(shape)
        self.held = tuple(plan.kind == PRESSURE for plan in sides.plans)
        self.sealed = Sealed(openings, shape, self.held, sides.periodic)
        self.exits = Exits(grid, openings, sides, self.sealed.label)
        closed = closed_sides(sides.plans, tuple(a is not None for a in b))
        self.voids, self.solves = Voids(team, grid, openings, self.planes, closed), 0
        self.ends = np.zeros((*shape[:2], 2), np.int32)  # of `widen`: where the columns of faces begin and end
        self.areas = [[np.ones_like(w) if e == d else w for e, w in enumerate(grid[:3])] for d in range(3)]
        self.lower_faces = [self._lower_faces(d) if sides.lower_face_acts(d) else None for d in range(3)]
        self.matrix_scale = 2.0 ** -np.frexp(min(ends))[1]

    @property
    def lines(self) -> np.ndarray | None:
        """Lines along z that solids come near (solid_lines.py)."""
        return self.solid_lines.of(self.openings)

    def _lower_faces(self, d: int) -> np.ndarray:
        """Columns of the ghost cells whose upper faces lie on the lower side along d."""
        every = all_columns(self.q.shape)
        if d == 2:
            every[:, 2:] = (G - 1, G)
            return every
        every = every[every[:, d] == G]
        every[:, d] = G - 1
        return every

    def renew(self, cells: np.ndarray | None = None) -> None:
        """The open fractions have changed: of cells (n, 3) [in C order] and their lower faces, None: anywhere."""
        self.sealed.renew(cells)
        self.exits = Exits(self.grid, self.openings, self.sides, self.sealed.label)

    def set_surface(self, F: np.ndarray | None, *, lasting: bool = False) -> None:
        """Fit the coefficients to where the liquid is. F with ghosts filled; lasting: what is known of its planes
        holds."""
        run, m, before = self.team.run, self.matrix, self.matrix.faces
        if not lasting:
            self.planes.forget()
        if F is not None:
            self.planes.find(self.team, F, self.openings)
        run(clear, before, self.wet)
        near = self.every if F is None else columns_among(self.planes.columns, F, HALF)
        if F is not None and self.openings.V is not None:  # cells that a solid cuts beside the liquid
            near = widen(near, 1, self.q.shape, self.ends)
        counts = np.zeros(len(near), np.int32)
        solids, at = (self.openings.V, self.openings, self.lines), self.planes.at
        self.team.run_uneven(mark_liquid, near, F, *solids, at, self.voids.closed, self.wet, counts)
        m.columns = columns_among(near, self.wet, 0)
        m.faces = widen(m.columns, 1, self.q.shape, self.ends)
        if F is not None:
            self.voids.find(near, counts, F, self.wet)
        self.sides.join(self.wet)
        for b in m.b:  # what the liquid has left
            if b is not None:
                clear_left(before, 0, len(before), self.ends, b)
        for a in self.solver.unknowns:
            run(clear, before, a)
        run(face_coefficients, m.faces, self.grid, *self.openings[1:], self.lines, self.wet, *m.b)
        if F is not None:
            self._reach_surface(F)
        for d, (b, thin) in enumerate(zip(m.b, self.thin, strict=True)):
            if thin is not None:
                run(multiply, *thin, self.wet, int(d == 0), int(d == 1), int(d == 2), b)
        self.sides.set_coefficients(m.b, self.openings[1:], self.wet)

    def _reach_surface(self, F: np.ndarray) -> None:
        """b of the faces at which the free surface ends what a cell is coupled to."""
        m, V = self.matrix, self.openings.V
        for d in range(3):
            if m.b[d] is not None:
                self.team.run_uneven(
                    surface_coefficients, m.faces, self.grid[d], *self.areas[d], self.grid[3 + d], self.openings[1 + d],
                    np.int64(d), F, V, self.openings, self.planes.at, self.wet, m.b[d],
                )  # fmt: skip

    def project(
        self,
        velocity: list,
        p: np.ndarray,
        F: np.ndarray | None,
        dt: float,
        tolerance: float,
        most: int,
        before: np.ndarray | None = None,
        bodies: Opening | None = None,
        couple: Couple | None = None,
    ) -> Solved:
        """Change velocity [u, v, w] and p (of the last step, then the result) so that what is above holds.

        before: p of the step before the last one, for the first guess. tolerance: largest share of a cell that its
        faces may miss within dt. `set_surface` was called with this F. bodies: those that move (immersed.py);
        couple: those that the pressure moves.
        Returns how it went; on failure velocity and p are as they were.
        """
        run, m, voids = self.team.run, self.matrix, self.voids
        run(scale_liquid, m.faces, p, dt / self.rho, self.wet, self.q)
        own = tuple(voids.pockets.T)
        self.q[own] = p[own] * (dt / self.rho)
        self.sides.fill_pressure(self.q, dt, velocity)
        guess = self.beta is not None or not self.sealed.may_be_full(cells_in(m.columns))
        out = voids.outflow(velocity)  # a lid holds its void at the distance of its plane: not eased
        self.ease_gravity(velocity, dt)
        opened = None if bodies is None else bodies.opened(voids.cells, dt)
        voids.begin(out, velocity, m.b, F, self.q, self.wet, dt, guess, opened)
        if before is not None:
            run(foresee, m.faces, p, before, dt / self.rho, self.wet, self.q)
        ease = max(dt, self.ease)
        if F is not None and self.strength < np.inf and self.beta is None:
            of = F, self.openings.V, p, self.grid, self.rho, self.strength
            self.over = overfull(self.planes.columns, *of, dt, ease)
        iterations, again, last = 0, True, self.solves + MOST_SOLUTIONS
        changed, release = None, guess  # once for these contacts: if often, a thin cell ended at 160 kPa of suction

        def full(slack: float) -> bool:
            """Shut the voids that are full, and open what the guess shut wrongly; whether that changed any."""
            nonlocal changed, release
            if self.solves + 1 >= last:
                return False
            before = voids.shut.copy()
            found = voids.shut_full(self.q, slack, release=release)
            changed = voids.shut != before
            release = release and not found
            return found

        while again:
            free = self._set_matrix(dt, changed)
            scene = self.grid, *self.openings, self.lines
            run(net_inflow, m.columns, *scene, *velocity, F, p, self.beta, dt, ease, self.right)
            voids.enter(self.right)
            if bodies is not None:
                bodies.source(m.diagonal, dt, ease, self.right)
            coupled = () if couple is None else (couple.begin(m.diagonal, self.right),)
            if couple is not None and len(voids.pockets):
                voids.opening = couple.opening(voids.pockets)
            if self.beta is None:
                self._balance(velocity, F, dt, tolerance)
            solved = self.solver.solve(m.columns, m.arrays, self.right, self.q, tolerance / dt, most, full, *coupled)
            m.diagonal[self.over.cells] = free  # answers to impacts take no time, in which nothing gives way
            self.solves += 1
            iterations += solved.iterations
            if not solved.converged:
                self.ease_gravity(velocity, -dt)
                return replace(solved, iterations=iterations)
            again = solved.interrupted or full(tolerance / dt)
            if not again and couple is not None:
                again = couple.contacts_changed(self.q) and self.solves < last
                release = again  # what has shut voids may have been bodies with other contacts
        self.sides.join(self.q)
        self.push(velocity)
        p.fill(0.0)
        run(scale_into, m.columns, self.q, self.rho / dt, p)
        return replace(solved, iterations=iterations)

    def respond(self, right: np.ndarray, q: np.ndarray, digits: float) -> Callable[[np.ndarray], float]:
        """q = the answer of the liquid to right [length3/time], with the equation as it was last solved; to so many
        digits of the largest value. Where the liquid is shut in, right is made to add up to nothing. Returns `left`.
        """
        m, volume = self.matrix, float(np.prod([d[G:-G].min() for d in self.grid[:3]]))
        self.sealed.balance(m.columns, self.wet, right, MUCH)
        self.solver.solve(m.columns, m.arrays, right, q, digits * float(np.abs(right).max()) / volume, 100)
        return self.left

    def left(self, q: np.ndarray) -> float:
        """q . what the last solution has left of its right-hand side [of q's unit, length3/time]."""
        r, columns = self.solver.r, self.matrix.columns
        both = np.zeros((2, len(columns)))
        self.team.run(dots, columns, q, r, r, both)
        return float(both[0].sum())

    def answer(self, velocity: list, coupling: Coupling, tolerance: float) -> Solved:
        """Push velocity by q = the answer of liquid and bodies to self.right [length3/time], with the equation as it
        was last solved. tolerance [1/time]: share of a cell that its faces may miss in a unit of time.

        An impulse has no length to bind what it drives into a pocket: that is bound by the room of a step to come.
        """
        m, voids, last = self.matrix, self.voids, self.solves + MOST_SOLUTIONS
        dt, self.over = voids.known[-1], none_overfull()
        voids.wait(max(dt, self.ease))
        self.q.fill(0.0)
        while True:
            self.sealed.balance(m.columns, self.wet, self.right, MUCH)
            solved = self.solver.solve(m.columns, m.arrays, self.right, self.q, tolerance, 100, None, coupling)
            self.solves += 1
            before = voids.shut.copy()
            if not solved.converged or self.solves >= last or not voids.shut_pockets_hit(self.q, tolerance, self.right):
                break
            self._set_matrix(dt, voids.shut != before)
        self.sides.join(self.q)
        self.push(velocity)
        return solved

    def _set_matrix(self, dt: float, changed: np.ndarray | None = None) -> np.ndarray:
        """The diagonal, with the lids that are open, and the preconditioner. Returns what it is in overfull cells
        without what these give way.

        changed (voids,): which were shut or opened since it was last set, None at the start of a step.
        """
        m, V, voids = self.matrix, self.openings.V, self.voids
        lids, held = voids.lids.at, voids.held
        at = tuple(voids.cells[changed].T) if changed is not None else ()
        before = m.diagonal[at]
        give = None if self.beta is None else self.beta * self.rho / dt**2
        self.team.run(diagonals, m.faces, self.grid, V, self.wet, *m.b, give, m.diagonal)
        m.diagonal[lids] += held
        over = self.over.cells
        free = m.diagonal[over]
        yielding = np.where(free > 0.0, self.over.give, 0.0)
        m.diagonal[over] += yielding

        def hold(surface: np.ndarray, scale: float) -> None:
            surface[over] += (scale * yielding).astype(surface.dtype)
            if give is not None:
                self.team.run(add_give, m.columns, self.grid, V, self.wet, give, scale, surface)
            surface[lids] += (scale * held).astype(surface.dtype)

        if self.multigrid is None:
            return free
        if changed is None:
            self.multigrid.rebuild(m.faces, m.columns, self.ends, m.arrays, self.matrix_scale, hold)
        else:  # an open lid adds to its cell's diagonal, an open pocket is no unknown any more
            more = np.where(np.flatnonzero(changed) < len(held), 1.0, -1.0) * (m.diagonal[at] - before)
            self.multigrid.mend(voids.cells[changed], m.diagonal[at], more, self.matrix_scale)
        return free

    def _balance(self, velocity: list, F: np.ndarray | None, dt: float, tolerance: float) -> None:
        """The flows of sealed liquid add up to nothing."""
        volume = float(np.prod([d[G:-G].min() for d in self.grid[:3]]))
        rooms = None if F is None else (self.grid, self.openings.V, F)
        self.sealed.balance(
            self.matrix.columns, self.wet, self.right, tolerance / dt * volume,
            lambda surplus: self.exits.let_out(surplus, velocity, self.right),
            self.voids.open_lids, *self.voids.full, rooms, dt,
        )  # fmt: skip

    def ease_gravity(self, velocity: list, dt: float) -> None:
        """What gravity gives the faces of thin cells more than others, where the pressure acts on them."""
        for u, b, g, thin in zip(velocity, self.matrix.b, self.sides.gravity, self.thin, strict=True):
            if u is not None and thin is not None and g != 0.0:
                self.team.run(add_rest, thin.columns, thin.acts, dt * float(g), b, u)

    def gradients(self, p: np.ndarray, rows: tuple, velocity: list) -> tuple:
        """grad p / rho [length/time2] on faces rows (n, 4) of u, v, w, None where that is; by the present surface."""
        if all(r is None for r in rows):
            return None, None, None
        self.team.run(scale_liquid, self.matrix.faces, p, 1.0 / self.rho, self.wet, self.q)
        self.sides.fill_pressure(self.q, 1.0, velocity)
        found = []
        for d, faces in enumerate(rows):
            out = None
            if faces is not None:
                out = np.zeros(len(faces))
                step = (int(d == 0), int(d == 1), np.uint64(d == 2))
                A = self.openings[1 + d]
                args = (self.matrix.b[d], *self.areas[d], self.eased, A, self.wet, self.q, step, out)
                self.team.run(difference, faces, *args)
            found.append(out)
        return tuple(found)

    def push(self, velocity: list) -> None:
        """velocity -= grad q on all faces that the pressure acts on, those of sides included."""
        m = self.matrix
        for d in range(3):
            if velocity[d] is not None:
                step = (int(d == 0), int(d == 1), np.uint64(d == 2))
                args = (m.b[d], *self.areas[d], self.openings[1 + d], self.lines, self.q, step, velocity[d])
                self.team.run(push, m.faces, *args)
                outer = self.lower_faces[d]
                if outer is not None:
                    self.team.run(push, outer, *args)
