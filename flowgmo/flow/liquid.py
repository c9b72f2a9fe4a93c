"""The liquid of a scene: what its steps need and keep, made once.

Bytes per cell: fields 48, open fractions 32, here 110 (with viscosity 134), pressure equation 56 + 33
(projection.py, multigrid.py).
"""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np

from flowgmo.flow.boundary import Sides
from flowgmo.flow.columns import all_columns, clear_left, columns_among, columns_where, tabulate, widen
from flowgmo.flow.fields import Flow, G, Grid, Open
from flowgmo.flow.immersed.immersed import Immersed
from flowgmo.flow.momentum.extrapolation import make_beside
from flowgmo.flow.momentum.momentum import Momentum
from flowgmo.flow.observe.tally import Tally
from flowgmo.flow.pressure.projection import Projector
from flowgmo.flow.pressure.thin_cells import find_thin_faces
from flowgmo.flow.solid_lines import SolidLines
from flowgmo.flow.surface.donor_acceptor import donor_acceptor_flux
from flowgmo.flow.surface.liquid_flux import plic_flux
from flowgmo.flow.surface.planes import Planes
from flowgmo.flow.surface.surface_tracking import tracking_of
from flowgmo.flow.team import Team
from flowgmo.flow.time_step import courant_rate, surface_limit
from flowgmo.flow_plan import MOST_ALONG, MOST_COURANT, MOST_SUM, FluidPlan, speed_in_sight
from flowgmo.mesh import PRESSURE, VELOCITY

DUST = 1e-6  # of a cell: less takes no part; it is what the pressure's tolerance leaves in a step (stages.TOLERANCE).
# Nothing holds the faces beside it: they would fall by g t as long as it is there, and bound the step

HIGH = 100.0  # Reynolds number of a cell: its viscous forces are a hundredth of what turns the flow

#: `IFVOF`: how the liquid crosses faces
CARRY = {"plic": plic_flux, "donor": donor_acceptor_flux}


class Rates(NamedTuple):
    """How fast the liquid crosses cells [1/time].

    summed: largest of a cell (time_step.py); dt times this is the Courant number. bounding: the same, and with a CON
    above MOST_COURANT the larger of the largest along one direction and of the sums by their own weight: MOST_ALONG is
    aimed at. trying: the same by the weight of the largest CON, whatever the deck's: a step in which it gets above
    MOST_COURANT is tried again.
    """

    summed: float
    bounding: float
    trying: float


class Liquid:
    """Constant: plan (FluidPlan), grid, openings, sides. Scratch: accelerations, the new velocities and fractions.

    near: columns of cells that hold liquid; faces: one cell wider, whose upper faces hold
    all that liquid touches; about: two cells wider, where velocities are wanted.
    """

    def __init__(
        self,
        plan: FluidPlan,
        grid: Grid,
        openings: Open,
        sides: Sides,
        gravity: np.ndarray,
        threads: int,
        still: Open | None = None,
    ) -> None:
        """openings: what all bodies leave open, still: what those leave that never move, None where all are such."""
        self.plan, self.grid, self.openings, self.sides = plan, grid, openings, sides
        self.gravity = np.asarray(gravity, dtype=float)
        self.team = Team(threads)
        self.shape = tuple(len(d) for d in grid[:3])
        self.present = tuple(n > 1 + 2 * G for n in self.shape)
        self.momentum = Momentum(plan, grid, openings, sides, self.gravity, self.present, self.team)
        still = openings if still is None else still
        thin = find_thin_faces(still, grid) if inertia_rules(plan, grid, self.gravity) else (None, None, None)
        self.solid_lines = SolidLines(watched=True)
        self.planes = Planes(grid, self.solid_lines) if plan.free_surface else None
        self.projector = Projector(
            grid, openings, sides, self.team, plan.rho, plain=plan.pressure.plain_sor, thin=thin, still=still,
            beta=plan.compressibility, planes=self.planes, solid_lines=self.solid_lines,
        )  # fmt: skip
        self.acceleration = self._per_direction()
        self.predicted = self._per_direction()
        self.everywhere = all_columns(self.shape)
        self.held = self.everywhere, np.zeros((0, 4), np.int32)  # columns of the state's and the new velocity
        self.p = np.zeros(self.shape)
        self.F = None if not plan.free_surface else np.zeros(self.shape)
        self.beside = make_beside(self.shape, self.present) if plan.free_surface else None
        self.written = [np.zeros(self.shape[:2], np.int8) for _ in range(2)]  # lines where bodies wrote in the state's
        # velocity, and in `predicted`
        self.marked = np.zeros((0, 4), np.int32)  # columns of what `beside` knows
        self.ends = np.zeros((*self.shape[:2], 2), np.int32)
        self.surface_limit = surface_limit(grid, self.gravity, self.present) if plan.free_surface else np.inf
        self.tracking = None
        if plan.free_surface:
            self.tracking = tracking_of(grid, CARRY[plan.tracking], self.planes, sides.periodic)
        self.entered = np.zeros(6)  # [length3] liquid that came in through each side in the step just made
        self.friction = np.zeros(2)  # [energy] of the step just made, as Flow.friction
        self.walls = {}  # body number -> (cells (n, 3), face shares (n, 6)) of the wall it makes
        self.near = self.faces = self.about = all_columns(self.shape)
        self._found = None  # the fraction whose columns these are, until the next one is stored
        self.immersed: Immersed | None = None  # bodies that move in the liquid
        self.regains = self.momentum.operators is None  # steps go on from what was allowed before an impact cut one:
        # not with viscosity, where friction and films are guessed from the pressure of the last step
        self.limiting = ""
        self.courant = 0.0  # of the step just made (Rates.summed)
        self.stride = 0.0  # its length in that of the longest that the liquid's velocities allow
        self.tally = Tally()

    def renew(self, cells: np.ndarray | None = None, meanwhile: Callable[[], None] | None = None) -> None:
        """The open fractions have changed, of cells (n, 3) [in C order] and their lower faces, or (None) anywhere:
        sort faces and regions anew. meanwhile: done by whichever thread is free."""
        if self.planes is not None:
            self.planes.outdate()
        self._note_written()
        self.solid_lines.renew(self.openings, cells)
        works = [partial(self.momentum.sort_faces, cells), partial(self.projector.renew, cells)]
        self.team.run_all([*works, *([meanwhile] if meanwhile is not None else [])])
        self.momentum.renew(cells)

    @property
    def lines(self) -> np.ndarray | None:
        """Lines along z that solids come near (solid_lines.py)."""
        return self.solid_lines.of(self.openings)

    @property
    def planes_last(self) -> bool:
        """Whether planes of F hold from the end of a step to the sweeps of the next, but where bodies move: no side
        gives what lies beyond it."""
        return not any(plan.kind in (PRESSURE, VELOCITY) for plan in self.sides.plans)

    def forget_planes(self) -> None:
        """F or the open fractions are others than those that planes were found for."""
        if self.planes is not None:
            self.planes.forget()

    def take_moments(self, flow: Flow) -> None:
        """From now on planes are found with the moments of this state, which may have been read from a file."""
        if self.planes is not None and self.planes.moments is not flow.moments:
            self.planes.forget()
            self.planes.moments = flow.moments

    def _per_direction(self) -> list:
        return [np.zeros(self.shape) if there else None for there in self.present]

    def find_columns(self, F: np.ndarray | None, changed: tuple[np.ndarray, np.ndarray] | None = None) -> None:
        """Set `near`, `faces` and `about` to where the liquid is. changed: cells (n, 3) of F that are others than when
        this was last done, and what they held then (n,)."""
        if F is not None and (F is not self._found or changed is not None and self._have_left(F, *changed)):
            self._found = F
            known = self.planes.columns_are_of(F)
            self.near = columns_among(self.planes.columns, F, DUST) if known else columns_where(F, DUST)
            self.faces = widen(self.near, 1, self.shape, self.ends)
            self.about = widen(self.near, 2, self.shape, self.ends)
            if self.immersed is None:  # bodies have velocities in the air too
                self.sides.ghosts.stay_near(self.about)

    def _have_left(self, F: np.ndarray, cells: np.ndarray, before: np.ndarray) -> bool:
        """Whether other columns hold the liquid than `near`, since cells (n, 3) held `before` (n,)."""
        now = F[tuple(cells.T)] > DUST
        if not np.array_equal(now, before > DUST):
            line = self.near[:, 0].astype(np.int64) * self.shape[1] + self.near[:, 1]
            own = cells[:, 0].astype(np.int64) * self.shape[1] + cells[:, 1]
            at = np.searchsorted(line, own).clip(0, max(len(line) - 1, 0))
            ends = self.near[at, 2:] if len(line) else np.zeros((len(own), 2))
            inside = (ends[:, 0] < cells[:, 2]) & (
                cells[:, 2] < ends[:, 1] - 1
            )  # not at an end, which may be another now
            return not (len(line) and (line[at] == own) & inside).all()
        return False

    def clear_beyond(self) -> None:
        """Zero in `predicted` where its velocities are two steps old and no liquid is near: no restart knows those."""
        kept, left = self.held
        if self.immersed is not None:  # which writes velocities of bodies, and of what they uncover, in the air too
            self._note_written()
            written = self.written[1][G:-G, G:-G].ravel() != 0
            left = np.concatenate([left, self.everywhere[written]])
            self.written[1][...] = self.lines
        tabulate(self.about, self.ends)
        for a in self.predicted:
            if a is not None:
                self.team.run(clear_left, left, self.ends, a)
        self.held = kept, self.about

    def _note_written(self) -> None:
        """Bodies have written velocities in the lines that they have come near."""
        if self.immersed is not None:
            self.written[1] |= self.lines

    def store(self, flow: Flow, dt: float) -> None:
        """Make the new values the state's, and the state's old arrays scratch."""
        self._found = None
        self.forget_planes()
        old = flow.velocity
        flow.u, flow.v, flow.w = self.predicted
        self._note_written()
        self.predicted, self.held, self.written = old, self.held[::-1], self.written[::-1]
        flow.p, flow.p_before, self.p = self.p, flow.p, flow.p_before if flow.p_before is not None else flow.p.copy()
        if flow.F is not None:
            flow.F, self.F = self.F, flow.F
            if self.tracking.pieces is not None:
                self.tracking.pieces.keep_moments()
                flow.moments = self.planes.moments
        flow.passed = flow.passed + self.entered
        flow.friction = flow.friction + self.friction
        flow.dt = flow.pace = dt
        if self.immersed is not None:
            self.immersed.settle()

    def rates(self, F: np.ndarray | None, velocity: list) -> Rates:
        """How fast the liquid crosses cells with these velocities; its columns are found."""
        courant = self.plan.steps.courant
        summed, along = courant_rate(self.team, self.near, self.grid, self.openings, self.lines, F, DUST, velocity)
        if courant <= MOST_COURANT:
            return Rates(summed, summed, summed)
        return Rates(summed, max(along, MOST_ALONG / courant * summed), max(along, MOST_ALONG / MOST_SUM * summed))

    def longest_step(self, flow: Flow, start: float, bodies: float = np.inf) -> float:
        """How long the next step may be [time]; `limiting` names what bounds it. start: DELT, for the first step;
        bodies: how long for those that move in the liquid."""
        plan = self.plan
        self.find_columns(flow.F)
        rate, aim = self.rates(flow.F, flow.velocity).bounding, plan.steps.courant
        aim = min(aim, MOST_ALONG)  # up to 1/2 too: a tenth to spare for what grows within a step
        carried, spread = aim / rate if rate > 0.0 else np.inf, self.momentum.limit
        least, other = min(carried, spread), max(carried, spread)
        limits = {
            # a new value is a mean of old ones around it up to dt (1 / carried + 1 / spread) = 1
            "flow" if carried <= spread else "viscosity": least / (1.0 + least / other) if least < np.inf else np.inf,
            "surface": plan.steps.surface_courant * self.surface_limit,
            "bodies": bodies,
            "growth": flow.pace * plan.steps.growth if flow.pace > 0.0 else start,
        }
        self.limiting = min(limits, key=limits.get)
        if self.immersed is not None:  # a step cut short by a blow must not drive out at its pace what the blow left
            free = min(limit for name, limit in limits.items() if name != "growth")
            self.projector.ease = free if free < np.inf else 0.0
        return limits[self.limiting]


def inertia_rules(plan: FluidPlan, grid: Grid, gravity: np.ndarray) -> bool:
    """Whether the Reynolds number of a cell at the largest speed in sight is far above one."""
    if not plan.mu:
        return True
    extent = np.array([d[G:-G].sum() for d in grid[:3]])
    cell = min(float(d[G:-G].min()) for d in grid[:3] if len(d) > 1 + 2 * G)
    return plan.rho * speed_in_sight(plan, gravity, extent) * cell > HIGH * plan.mu


def default_threads() -> int:
    """The processors this process may use, or as many as `--threads` says."""
    asked = os.environ.get("NUMBA_NUM_THREADS", "")
    if asked.isdigit():
        return int(asked)
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else (os.cpu_count() or 1)
