"""Impacts of bodies in liquid within a step: what the liquid answers, and what it gets.

An impact takes no time. The body answers its impulse with (M + A)^-1 (flow/immersed/added_mass.py), and the liquid
takes A dU of it: at the end of the step, when bodies and liquid have moved, one more pressure, without time,

    U  = U+ + M^-1 A dU + rho M^-1 J^T q          u = u - grad q
    (A_fluid + sum over b of rho J_b M_b^-1 J_b^T) q = - sum over b that were hit of J_b (U+ + M^-1 A dU - U before)

makes the liquid fit the velocities that the impacts have left. Of a body that is alone q brings back M^-1 A dU, so that
it goes on with U+; bodies near it are pushed away. So the next step starts without a jump: its pressure is that of its
own forces, however short it is.

Rows J, areas and b are those of the step's pressure, widened faces included (flow/immersed/narrow_faces.py), and what
flows besides, by the growth of the cells or through slits, is the same before and after. So with K of that
file an impact takes K(u, U) - K(u+, U+) = - (U + U+) . (M + A) (U+ - U) / 2, what its law books where it meets U
(wet_blows.py), and what pockets that it shuts take.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flowgmo.bodies.inverse_masses import block_diagonal, inverse_masses
from flowgmo.errors import StepTooLong
from flowgmo.flow import stages
from flowgmo.flow.immersed.added_mass import added_mass, wet_inverse
from flowgmo.flow.immersed.coupling import Coupling
from flowgmo.wet_loads import way_of
from flowgmo.wet_stops import halted, time_to_stop

if TYPE_CHECKING:
    from flowgmo.state import State
    from flowgmo.wet_bodies import WetBodies
    from flowgmo.world import World

ASTRAY = 0.01  # of a cell: farther from where the pressure took it to be a body that was hit may not end a step
FAR = 0.1  # of a cell: the same for one that was not, whose contacts turned out to be others than those foreseen
AFTER = 1.01  # of the time to an impact: a step ends so far behind it, since a shorter step moves it a little
CLOSE = 0.995  # a step that should be this share of itself, or more, ends where it should: else tries had no end
SOFT = 4.0  # of what a step's load makes of velocities: impacts no faster are its work (wet_blows.py); a choice
LEAST = 0.1  # of a step that an impact shortens: it is tried again as often as it takes
SHORTEST = 0.05  # of a step that nothing has shortened: shorter ones are not cut again for an impact


class WetImpacts:
    """Of one scene, a step at a time."""

    def __init__(self, bodies: WetBodies) -> None:
        self.bodies = bodies
        self.cut = np.nan  # [time] begin of the last step that was cut to end with an impact
        self.begin()

    def begin(self) -> None:
        """A step begins: nothing is known of it."""
        self.found: dict[int, tuple[np.ndarray, np.ndarray]] = {}

    def response(self, b: int) -> tuple[np.ndarray, np.ndarray]:
        """(M + A)^-1 and A (6, 6) of body b (row) about B, for impacts within the step: found when the first is met."""
        of = self.bodies
        if b not in of.wet:
            return np.zeros((6, 6)), np.zeros((6, 6))
        if b not in self.found:
            n, projector = of.wet.index(b), of.liquid.projector
            A = added_mass(of.coupling.fluxes[n], projector.respond, projector.q.shape, of.model.fluid.rho)
            self.found[b] = wet_inverse(of.each_inverse[n], A), A
        return self.found[b]

    def foresee(self, world: World, state: State, motion: np.ndarray, t1: float) -> None:
        """Raise StepTooLong where a body will be hit within the step, and led astray: the step should end with it.

        It would be tried again in any case (check_ways), and where the body is expected beyond what it hits, the volume
        that it takes there is missing elsewhere. How far astray follows from the speed with which the two approach: a
        stone that slides along its bed, and is hit by every bump, goes on.
        """
        of, dt = self.bodies, t1 - state.t
        if dt <= SHORTEST * of.liquid.projector.ease:
            return
        self._foresee_stops(state.t, dt, motion)
        if world.collisions is None:
            return
        from flowgmo.collision.stage import meetings

        speeds = of.ways.speeds(motion["v"], motion["w"])
        for hit, pairs, approach in meetings(world, state, motion, of.coupled, t1):
            bodies = [b for b in np.unique(pairs) if b in of.place]
            most = min(approach, sum(speeds[of.place[b]] for b in bodies))
            share = max(AFTER * (hit - state.t) / dt, LEAST)
            if 2.0 * most * (t1 - hit) / of.ways.cell > ASTRAY and share < CLOSE:
                self.cut = state.t
                raise StepTooLong(f"body {of.names[of.place[bodies[0]]]} will be hit in the step", share)

    def _foresee_stops(self, t0: float, dt: float, motion: np.ndarray) -> None:
        """As foresee, of stops that bodies would meet with the velocities of motion (n,) POSE."""
        of = self.bodies
        for b in of.coupled[of.arrays["stopped"][of.coupled] == 1]:
            k, row = of.place[int(b)], motion[b]
            first, turns = time_to_stop(of.arrays[b], row)
            speed = np.linalg.norm(row["w"]) * of.ways.reach[k] if turns else np.abs(row["v"]).max()
            share = max(AFTER * first / dt, LEAST)
            if first < dt and 2.0 * speed * (dt - first) / of.ways.cell > ASTRAY and share < CLOSE:
                self.cut = t0
                raise StepTooLong(f"body {of.names[k]} will meet its stop in the step", share)

    def meet(
        self, world: World, state: State, motion: np.ndarray, t1: float, U: np.ndarray, which: np.ndarray
    ) -> np.ndarray:
        """(wet,) bool: of the wet bodies, those that meet something before t1, and no faster than the step's load makes
        them, where `which` (wet,) bool of them go with U (wet, 6) from now, motion (n,) POSE, on."""
        from flowgmo.collision.stage import meetings

        of, then, wet = self.bodies, motion.copy(), np.array(self.bodies.wet, dtype=np.int64)
        then["v"][wet[which]], then["w"][wet[which]] = U[which, :3], U[which, 3:]
        gained = dict(zip(of.movers, of.ways.speeds(then["v"] - motion["v"], then["w"] - motion["w"]), strict=True))
        soft = np.zeros(len(wet), bool)
        if world.collisions is None:
            return soft
        for _, pairs, approach in meetings(world, state, then, of.coupled, t1):
            if approach <= SOFT * sum(gained.get(b, 0.0) for b in np.unique(pairs)):
                soft |= np.isin(wet, pairs)
        return soft

    def check_ways(
        self, before: np.ndarray, after: np.ndarray, impacts: list[np.ndarray], t0: float, t1: float
    ) -> None:
        """Raise StepTooLong where impacts or contacts lead a body away from where the pressure took it to be.

        before, after (n,) POSE. A ball that rebounds from the bed would leave a void under it, or push into what does
        not know of it: such a step ends with the impact, and the next one starts with the velocities after it.
        """
        of, dt = self.bodies, t1 - t0
        if not of.loaded or dt <= SHORTEST * of.liquid.projector.ease:
            return  # where impacts follow each other the ways stay apart however short the step
        for n, b in enumerate(of.wet):
            astray = way_of(before[b], after[b]) - dt * of.planned[n]
            k = of.place[b]
            reach = of.ways.reach[k] if of.balls[k] is None else 0.0
            off = float(np.linalg.norm(astray[:3]) + reach * np.linalg.norm(astray[3:])) / of.ways.cell
            hit = first_impact(impacts, b)
            pushed = hit < t1 and float(of.squeezed[b] @ way_of(before[b], after[b])) > 0.0  # films hold back
            if off <= ASTRAY and not pushed:
                continue
            share = max(AFTER * (hit - t0) / dt, LEAST)
            if share < CLOSE or off > FAR:
                text = f"contacts lead body {of.names[k]} {off:.3g} of a cell away from its way"
                self.cut = t0 if share < CLOSE else self.cut
                raise StepTooLong(text, share if share < CLOSE else None)

    def settle(self, flow: object, motion: np.ndarray, owed: np.ndarray, met: list) -> np.ndarray | None:
        """The liquid gets what impacts owe it, owed (n, 6), which is then nothing, and halts with bodies that have met
        stops (Room.met): velocities of liquid and bodies, motion (n,) POSE, change. On return the step's velocities
        fit, as after its pressure. Returns impulses and moments about B (wet, 6) that the liquid
        gives the bodies, None without impacts."""
        of = self.bodies
        which = np.array(of.wet, dtype=np.int64)
        if not len(which):
            return None
        rows = motion[which]
        stopped = halted(rows, which, met)
        hit = np.flatnonzero(owed[which].any(axis=1) | stopped)
        if not len(hit):
            return None
        W = of.each_inverse.copy()
        W[stopped] = inverse_masses(of.arrays[which[stopped]], rows[stopped])
        U = np.hstack([motion["v"][which], motion["w"][which]])
        kicked = U + np.einsum("bij,bj->bi", W, owed[which])
        push = kicked[hit] - of.reached[hit]
        coupling = Coupling(of.coupling.fluxes, block_diagonal(W), of.model.fluid.rho)

        def right(into: np.ndarray) -> None:
            for n, jump in zip(hit, push, strict=True):
                one = coupling.fluxes[n]
                into.reshape(-1)[one.cells] -= one.J @ jump

        q = stages.answer_impulses(of.liquid, flow, right, coupling, of.dt)
        U = kicked + coupling.velocities(q).reshape(-1, 6)
        motion["v"][which], motion["w"][which] = U[:, :3], U[:, 3:]
        owed[which] = 0.0
        return of.model.fluid.rho * coupling.loads(q).reshape(-1, 6)


def first_impact(impacts: list[np.ndarray], b: int) -> float:
    """Time of body b's first impact in these tables; inf if it has none."""
    times = [float(x["time"][(x["a"] == b + 1) | (x["b"] == b + 1)].min(initial=np.inf)) for x in impacts]
    return min(times, default=np.inf)
