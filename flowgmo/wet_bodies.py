"""Bodies that move in the liquid: where the step expects them, how the pressure moves them, where they arrive.

    expect    poses at the end of the step, were there no pressure to come: prescribed ones as they will be
    kick      velocities of coupled bodies by gravity, control loads, the liquid's friction, and the water at rest that
              they displace
    couple    the same after the pressure
    arrive    open volumes at the poses that the motion of the bodies (with impacts) has reached

Coupled bodies that the liquid touches move through the step with the velocity of its end, as the liquid does: their
rows of World.flying have no gravity and no loads. Bodies that it does not touch fly as in a dry scene.

In a scene with collisions the contact engine moves the bodies. Those that nothing holds go with the velocity of the
step's end there too (wet_blows.py). What presses a stone on the bed must be known as a load and not as a velocity: on
such bodies the liquid's load of the step is a constant force and moment, two more laws of each body, and contacts that
were held take part in the pressure equation (flow/immersed/contact_rows.py).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from flowgmo.bodies.arrays import DRIVEN, STILL, pack
from flowgmo.bodies.body import ControlLoads, Table
from flowgmo.bodies.energy import rotation_matrices
from flowgmo.bodies.inverse_masses import block_diagonal, inverse_masses, turned
from flowgmo.bodies.kicks import control_loads_at, kick
from flowgmo.bodies.laws import Laws
from flowgmo.bodies.move import move_alone
from flowgmo.errors import StepFailed
from flowgmo.flow.favor.near_surface import Pose
from flowgmo.flow.immersed.body_fluxes import BodyFluxes, closed_sum, fluxes_in, weight_of_displaced
from flowgmo.flow.immersed.contact_rows import constrain
from flowgmo.flow.immersed.coupling import Coupling
from flowgmo.flow.immersed.friction import Friction
from flowgmo.flow.liquid import Liquid
from flowgmo.flow.observe.streams import is_open
from flowgmo.flow.pressure.overfull import strongest
from flowgmo.flow_plan import speed_in_sight
from flowgmo.mesh import SYMMETRY, WALL
from flowgmo.model import Model
from flowgmo.pressed import explained
from flowgmo.state import State
from flowgmo.wet_blows import SHORT, Blow, find_struck, strike
from flowgmo.wet_contacts import Contacts, held_contacts
from flowgmo.wet_explicit import Explicit
from flowgmo.wet_foresight import expected_motion, next_rates
from flowgmo.wet_impacts import WetImpacts
from flowgmo.wet_loads import WetLoads
from flowgmo.wet_seams import SEAM, faces_set_back
from flowgmo.wet_shapes import axis_of, ball_centre
from flowgmo.wet_stops import let_go
from flowgmo.wet_ways import Ways
from flowgmo.world import poses_of

if TYPE_CHECKING:
    from flowgmo.film import Film, StepFilms

EDGE = 0.1  # of a cell: of bodies from a hundredth of the liquid's density on nothing is taken away
SLACK = 1e-3  # of the speed that gravity gives in a step: an approach that a contact row may leave
MOST_TURNS = 6  # solutions in a step in which the contacts that press have changed


class WetBodies:
    """Of one scene. arrays (n,) BODY, laws: as the deck has them. flying (n,): those that the motion uses, changed."""

    def __init__(self, model: Model, arrays: np.ndarray, laws: Laws | None, liquid: Liquid) -> None:
        self.model, self.arrays, self.laws, self.liquid = model, arrays, laws, liquid
        self.loaded = model.contacts is not None
        self.unloaded, self.flying_laws = pack_with_loads(model) if self.loaded else (arrays, laws)
        self.flying = self.unloaded.copy()
        motion = arrays["motion"]
        self.movers = np.flatnonzero(motion != STILL)
        solved = [bool(np.any(row["coupled"])) and row["mass"] > 0.0 for row in arrays]
        self.coupled = np.array([b for b in self.movers if motion[b] != DRIVEN and solved[b]], dtype=np.int64)
        self.driven = np.array([b for b in self.movers if b not in self.coupled], dtype=np.int64)
        self.place = {int(b): k for k, b in enumerate(self.movers)}  # among the moving ones
        self.ways = Ways(model, arrays, self.movers)
        self.axes = [axis_of(model.bodies[b].shape, arrays[b]["origin"]) for b in self.movers]
        self.balls = [ball_centre(model.bodies[b].shape, arrays[b]["origin"]) for b in self.movers]
        self.velocities = np.zeros((len(self.movers), 6))
        low, high = model.mesh.bounds
        self.in_sight = speed_in_sight(model.fluid, np.asarray(model.gravity, float), np.subtract(high, low))
        liquid.immersed.weight = model.fluid.rho * np.asarray(model.gravity)
        liquid.immersed.rho, liquid.immersed.in_sight = model.fluid.rho, self.in_sight
        liquid.immersed.gravity = np.asarray(model.gravity, float)
        liquid.immersed.solved = np.isin(self.movers, self.coupled)
        liquid.immersed.no_exit = not any(plan.kind not in (SYMMETRY, WALL) for plan in liquid.sides.plans)
        liquid.immersed.open_sides = [plan.number for plan in liquid.sides.plans if is_open(plan.kind)]
        self.coupling: Coupling | None = None
        self.wet: list[int] = []
        self.records = WetLoads(arrays, laws, self.movers, self.driven, liquid, pushed=self.loaded)
        self.names = [body.name for body in model.moving]
        self.impacts = WetImpacts(self)
        self.friction: Friction | None = None
        self.explicit = None if model.fluid.coupled_together else Explicit(self)
        self.solved = self.coupled if self.explicit is None else self.coupled[:0]  # those the pressure moves
        self.film: Film | None = None
        if model.fluid.film is not None and len(self.solved):
            from flowgmo.film import Film

            self.film = Film(model, self.coupled, liquid.immersed.covers.open.V)
        self.squeezed = np.zeros((len(arrays), 6))  # by films
        self.struck, self.blows = np.zeros(0, bool), dict[int, Blow]()

    def stand(self, motion: np.ndarray, parts: np.ndarray, values: np.ndarray) -> None:
        """Before the first step: the open fractions are those of the poses motion (n,) POSE, t = 0 or of a file; parts,
        values: of contacts that are kept, as in the state."""
        self.set_back = faces_set_back(self, motion, parts, values)
        self.liquid.immersed.covers.sweep(self.poses(motion))
        self.liquid.immersed.settle()

    # ---- stages

    def expect(self, state: State, motion: np.ndarray, t1: float, told: np.ndarray | None = None) -> None:
        """Open fractions for the step from `state` to where the bodies are expected at t1. motion (n,) POSE: of the
        state; told: with the velocities they will have, where known."""
        flow, t0, held = state.fluid, state.t, state.held_parts[:, :2]
        dt = t1 - t0
        if told is None:
            told = expected_motion(motion, state.rates, self.coupled[~np.isin(self.coupled, held)], dt)
        then = self.poses_then(told, t0, t1)
        middle = self.poses_then(told, t0, 0.5 * (t0 + t1))
        m = self.movers
        self.set_back = faces_set_back(self, motion, state.held_parts, state.held_values)
        fastest = max(self.in_sight, self.ways.check(motion, then, dt))
        places = 0.5 * (motion["p"][m] + then["p"][m])
        self.velocities = np.hstack([then["v"][m], then["w"][m]])
        self.liquid.immersed.begin(
            flow, self.poses(then), self.poses(middle), places, self.velocities, self.middles(then), dt
        )
        self._bound_edges(dt)
        self.liquid.projector.strength = strongest(self.model.fluid.rho, fastest)
        self.liquid.find_columns(flow.F, self.liquid.immersed.uncovered)
        self._meet_walls(flow, motion, t0, t1, places, held)
        self.liquid.immersed.fill_short(self.liquid.team, self.liquid.faces, self.liquid.lines, flow, dt)

    def _bound_edges(self, dt: float) -> None:
        """What the waterline adds to the load of a body (waterline.py) has no liquid in the pressure equation whose
        inertia would go with it: of a feather it is no more than moves it by EDGE of a cell in a step."""
        fluxes = self.liquid.immersed.fluxes
        for b in self.coupled:
            k, mass = self.place[int(b)], float(self.arrays["mass"][b])
            edge = fluxes[k].edge
            if edge is None:
                continue
            size = self.model.fluid.rho * float(np.abs(edge).sum())
            most = EDGE * self.ways.cell * mass / dt**2
            if size > most:
                fluxes[k] = fluxes[k]._replace(edge=edge * (most / size))

    def middles(self, motion: np.ndarray) -> list[np.ndarray | None]:
        """Of each moving ball from B to its centre, of each body of revolution its axis (body_fluxes.py); else None."""
        R = rotation_matrices(motion["q"][self.movers])
        whole = [ball if ball is not None else axis for ball, axis in zip(self.balls, self.axes, strict=True)]
        return [None if one is None else one @ turn.T for one, turn in zip(whole, R, strict=True)]

    def poses_then(self, motion: np.ndarray, t0: float, t1: float) -> np.ndarray:
        """motion (n,) POSE at t1: prescribed bodies as they will be, others as they move now."""
        then = motion.copy()
        self._drive(then, t0, t1)
        for b in self.coupled:
            then["p"][b] += (t1 - t0) * motion["v"][b]
            then["q"][b] = turned(motion["q"][b], (t1 - t0) * motion["w"][b])
            if self.arrays[b]["hinge"]:
                arm = rotation_matrices(then["q"][b : b + 1])[0] @ self.arrays[b]["arm"]
                then["p"][b] = self.arrays[b]["point"] + arm
        return then

    def _meet_walls(
        self, flow: object, motion: np.ndarray, t0: float, t1: float, places: np.ndarray, held: np.ndarray
    ) -> None:
        """The liquid's friction on the walls of the bodies in this step (flow/immersed/friction.py)."""
        self.friction = None
        momentum, immersed = self.liquid.momentum, self.liquid.immersed
        if momentum.operators is None or not self.liquid.plan.no_slip:
            return
        m, dt = self.movers, t1 - t0
        now = np.hstack([motion["v"][m], motion["w"][m]])
        share = 1.0 if momentum.implicit else 0.5  # of the prescribed velocities at the end: the mean of the stages
        U0 = np.where(np.isin(m, self.solved)[:, None], now, now + share * (self.velocities - now))
        W = np.zeros((len(m), 6, 6))
        at = np.array([self.place[int(b)] for b in self.solved], dtype=np.int64)
        if len(at):
            W[at] = inverse_masses(self.arrays[self.solved], motion[self.solved])
            resting = np.isin(self.solved, held)  # what holds them up is not known yet
            U0[at[~resting]] = self._foreseen(flow, motion, t0, t1, W)[at[~resting]]
        self.friction = immersed.friction(momentum, self.liquid.plan.mu, flow.F, places, U0, W, dt)

    def _foreseen(self, flow: object, motion: np.ndarray, t0: float, t1: float, W: np.ndarray) -> np.ndarray:
        """(movers, 6): velocities at t1 by gravity, control loads, and the pressure as it is now, without friction.

        Of the state alone, so that a restart goes on with the same bits.
        """
        after, loads = motion.copy(), self._loads_by_pressure(flow)
        kick(self.coupled, self.arrays, self.laws, after, t0, t1)
        U = np.hstack([after["v"][self.movers], after["w"][self.movers]])
        return U + (t1 - t0) * np.einsum("bij,bj->bi", W, loads)

    def _loads_by_pressure(self, flow: object) -> np.ndarray:
        """(movers, 6) of the pressure as it is, on the coupled bodies."""
        loads, rho = np.zeros((len(self.movers), 6)), self.model.fluid.rho
        p, F = flow.p.reshape(-1), None if flow.F is None else flow.F.reshape(-1)
        for b in self.coupled:
            k = self.place[int(b)]
            fluxes = self.liquid.immersed.fluxes[k]
            liquid = np.ones(len(fluxes.cells), bool) if F is None else F[fluxes.cells] >= 0.5  # as loads.pressure_load
            pressed = fluxes.J[liquid].T @ p[fluxes.cells[liquid]]
            loads[k] = pressed + weight_of_displaced(fluxes, liquid, rho, self.model.gravity)
        return loads

    def shear_loads(self) -> np.ndarray:
        """(movers, 6): force and moment about B of the liquid's friction in this step, the mean; zero without."""
        return np.zeros((len(self.movers), 6)) if self.friction is None else self.friction.loads

    def _drive(self, then: np.ndarray, t0: float, t1: float) -> None:
        """Prescribed bodies of then (n,) POSE at t0 come to t1."""
        if len(self.driven):
            none, n = np.zeros(0), len(then)
            move_alone(
                self.driven, self.arrays, self.laws, then, np.zeros(4), t0, t1, none, np.zeros((0, n), then.dtype),
                np.zeros((0, 4)), np.zeros((64, 7)), np.zeros(64, dtype=np.int64),
            )  # fmt: skip

    def kick(self, flow: object, state: State, motion: np.ndarray, t0: float, t1: float) -> None:
        """U* of the coupled bodies that the liquid touches: by gravity, control loads (bodies/kicks.py), friction."""
        self.dt, self.middle, self.wet = t1 - t0, 0.5 * (t0 + t1), []
        self.flying[:] = self.unloaded
        F = None if flow.F is None else flow.F.reshape(-1)
        shear = self.shear_loads()
        for b in self.coupled:
            cells = self.liquid.immersed.fluxes[self.place[int(b)]].cells
            rubbed = bool(shear[self.place[int(b)]].any())
            if rubbed or len(cells) and (F is None or (F[cells] > 0.0).any()):
                self.wet.append(int(b))
        which = np.array(self.wet, dtype=np.int64)
        after = motion.copy()
        kick(which, self.arrays, self.laws, after, t0, t1)
        self.each_inverse = inverse_masses(self.arrays[which], motion[which])
        self.kicked = np.hstack([after["v"][which], after["w"][which]])
        self.impacts.begin()
        self.expected = self.velocities[[self.place[b] for b in self.wet]].reshape(-1, 6)
        self.rubbed = shear[[self.place[b] for b in self.wet]].reshape(-1, 6)
        self.kicked += self.dt * np.einsum("bij,bj->bi", self.each_inverse, self.rubbed)
        self.contacts = self.contacts_held(state, motion) if self.wet and len(state.held_parts) else None
        self.short = self.dt <= SHORT * self.liquid.projector.ease or self.impacts.cut == t0
        self.struck = self.loaded & find_struck(self.arrays, self.wet, motion, state.held_parts[:, :2])
        self.films = self._films(flow, motion) if self.film is not None and self.wet else None
        self.turns, self.parts = 0, {}

    def _films(self, flow: object, motion: np.ndarray) -> StepFilms | None:
        """Thin films beside the bodies, as strong as fits the way they would go with the pressure as it is now."""
        mean = self.loaded and not self.struck.all()
        films = self.film.of_step(flow.F, motion, self.wet, self._of_all(motion), self.dt, mean=mean)
        if films is not None:
            loads = self._loads_by_pressure(flow)[[self.place[b] for b in self.wet]]
            foreseen = self.kicked + self.dt * np.einsum("bij,bj->bi", self.each_inverse, loads)
            films.squeeze.guess(block_diagonal(self.each_inverse), foreseen.reshape(-1))
        return films

    def _of_all(self, motion: np.ndarray) -> np.ndarray:
        """(n, 6) velocities of all bodies in the step, as far as they are known before the pressure."""
        out = np.zeros((len(motion), 6))
        out[self.movers] = self.velocities
        return out

    def contacts_held(self, state: State, motion: np.ndarray) -> Contacts:
        """The contacts that the bodies keep."""
        return held_contacts(self.model, state, motion, self._of_all(motion), self.wet, self.dt)

    @property
    def couple(self) -> WetBodies | None:
        """For Projector.project; None where no body is moved by the pressure."""
        return self if self.wet else None

    def begin(self, diagonal: np.ndarray, right: np.ndarray) -> Coupling:
        """See pressure/bodies.Couple."""
        rho, flat, into = self.model.fluid.rho, diagonal.reshape(-1), right.reshape(-1)
        parts = [self._wet_part(b, flat) for b in self.wet]
        self.lifts = np.array([self.parts[b][2] for b in self.wet])
        self.free = (self.kicked + self.dt * np.einsum("bij,bj->bi", self.each_inverse, self.lifts)).reshape(-1)
        W = block_diagonal(self.each_inverse)
        if self.films is not None:
            W, self.free = self.films.squeeze.soften(W, self.free)
        self.free_inverse, self.start = W, self.free
        if self.contacts is not None:
            W, self.start, self.inverse = constrain(W, self.free, *self.contacts.pressed(), self.contacts.known)
        for n, part in enumerate(parts):
            into[part.cells] -= part.J @ (self.start[6 * n : 6 * n + 6] - self.expected[n])
        self.coupling = Coupling(parts, W, rho)
        return self.coupling

    def _wet_part(self, b: int, diagonal: np.ndarray) -> BodyFluxes:
        """Body b's fluxes in the cells of the equation, diagonal (mesh, flat) != 0; found anew only where these change
        between the solutions of a step."""
        k, immersed = self.place[b], self.liquid.immersed
        one = immersed.fluxes[k]
        liquid = diagonal[one.cells] != 0.0
        known = self.parts.get(b)
        closed = bool(immersed.closed[k])
        if known is None or known[3] != closed or not np.array_equal(known[0], liquid):
            J = one.J[liquid]
            part = BodyFluxes(one.cells[liquid], closed_sum(J) if closed else J, one.lift[liquid])
            weight = weight_of_displaced(one, liquid, self.model.fluid.rho, self.model.gravity)
            known = self.parts[b] = liquid, part, weight, closed
        return known[1]

    def opening(self, cells: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
        """See pressure/bodies.Couple."""
        fluxes = [self.liquid.immersed.fluxes[self.place[b]] for b in self.wet]
        J = fluxes_in(fluxes, self.liquid.immersed.numbers(cells))
        return lambda q: J @ (self.start - self.expected.reshape(-1) + self.coupling.velocities(q))

    def contacts_changed(self, q: np.ndarray) -> bool:
        """See pressure/bodies.Couple."""
        if (self.contacts is None and self.films is None) or self.turns >= MOST_TURNS:
            return False
        self.turns += 1
        U = self.start + self.coupling.velocities(q)
        if self.films is not None and self.films.squeeze.unfit(U):
            return True
        if self.contacts is None:
            return False
        free = self.free + self.model.fluid.rho * (self.free_inverse @ self.coupling.loads(q))
        return self.contacts.look(U, free, self.inverse, self.slack())

    def slack(self) -> float:
        """[length/time] that a contact may approach with."""
        return SLACK * float(np.linalg.norm(self.model.gravity)) * self.dt

    def finish(self, q: np.ndarray, motion: np.ndarray, rows: np.ndarray, meet: Callable) -> None:
        """After the pressure q = p dt / rho: velocities of the wet bodies in motion (n,) and rows (k, n) POSE, or the
        loads with which they move on. meet: WetImpacts.meet of the step."""
        U, loads = np.zeros((0, 6)), np.zeros((0, 6))
        self.squeezed[:] = 0.0
        if self.wet:
            U = (self.start + self.coupling.velocities(q)).reshape(-1, 6)
            if self.films is not None:
                self.squeezed = self.films.loads(U.reshape(-1))
            pressed = (self.model.fluid.rho / self.dt) * self.coupling.loads(q).reshape(-1, 6)
            loads = pressed + self.lifts + self.rubbed + self.squeezed[self.wet]
        self.reached = U  # what the liquid's velocities fit
        if not self.short and self.struck.any():
            self.struck &= ~meet(U, self.struck)
        self.go_on(U, loads, motion, rows)

    def go_on(self, U: np.ndarray, loads: np.ndarray, motion: np.ndarray, rows: np.ndarray) -> None:
        """Velocities U (wet, 6) at the end of the step into motion and rows, or loads (wet, 6) to move on with."""
        if self.loaded:
            self.planned = 0.5 * (U + np.hstack([motion["v"][self.wet], motion["w"][self.wet]]))
            on_bodies = self._loads_with_control(loads, motion)
            ways, of = self.dt * self.planned, on_bodies[self.wet]
            self.blows = strike(self.arrays, self.wet, self.struck, U, of, ways, motion)
            self.planned[self.struck] = U[self.struck]
            self._load(on_bodies)
            return
        if motion["hold"][self.wet].any():
            control = np.zeros((len(motion), 6))
            control_loads_at(self.coupled, self.arrays, self.laws, motion, self.middle, control)
            let_go(self.arrays, motion, self.wet, loads + control[self.wet])
        for b, own in zip(self.wet, U, strict=True):
            for to in (motion, *rows):
                to["v"][b], to["w"][b] = own[:3], own[3:]
            self.flying["gravity"][b] = 0.0
            self.flying["first_load"][b] = self.flying["last_load"][b] = 0
            self.flying["force"][b] = self.flying["torque"][b] = -1

    def _loads_with_control(self, of_liquid: np.ndarray, motion: np.ndarray) -> np.ndarray:
        """(n, 6): loads of this step on B, of control, and of the liquid (wet, 6)."""
        loads = np.zeros((len(motion), 6))
        control_loads_at(self.coupled, self.arrays, self.laws, motion, self.middle, loads)
        loads[self.wet] += of_liquid
        return loads

    def _load(self, loads: np.ndarray) -> None:
        """Give the constant laws of `flying` the loads (n, 6), to bodies that go with the velocities of the end what
        keeps these."""
        for b, blow in self.blows.items():
            loads[b] = blow.told
        entries, first = self.flying_laws.entries, self.flying_laws.rows["first"]
        for b in self.coupled:
            for name, of_body in (("force", loads[b, :3]), ("torque", loads[b, 3:])):
                entries[first[self.flying[name][b]], 1] = of_body

    def rates(self, state: State, motion: np.ndarray, t1: float) -> np.ndarray:
        """State.rates after the step from `state` to motion (n,) POSE at t1."""
        which = np.array([] if self.explicit else self.wet, dtype=np.int64)
        cell, reach = self.ways.cell, self.ways.reach[[self.place[int(b)] for b in which]]
        reach = np.column_stack([np.ones(len(which)), np.where(np.isfinite(reach), reach, cell)]) / cell
        U = self.reached if len(which) else np.zeros((0, 6))
        return next_rates(state.rates, which, U, poses_of(state), motion, reach, t1 - state.t)

    def explained(self, error: StepFailed) -> StepFailed:
        """The error, or one that says which body presses what."""
        (block,), sealed = self.model.mesh.blocks, self.liquid.projector.sealed
        return explained(error, sealed, self.liquid.immersed, self.velocities, self.names, block)

    def poses(self, motion: np.ndarray) -> list[Pose]:
        """Of the moving bodies, from motion (n,) POSE: x = R x0 + t, x0 the place at t = 0."""
        R = rotation_matrices(motion["q"][self.movers])
        t = motion["p"][self.movers] - np.einsum("bij,bj->bi", R, self.arrays["origin"][self.movers])
        back = SEAM * self.ways.cell
        return [Pose(turn, way, back, faces) for turn, way, faces in zip(R, t, self.set_back, strict=True)]


def pack_with_loads(model: Model) -> tuple[np.ndarray, Laws | None]:
    """The bodies as arrays, coupled ones with a constant force and moment on B that are set in every step."""
    some = Table(np.zeros(1), np.ones(1))  # not zero, so that each becomes a law of its own
    load = ControlLoads((some,) * 3, (some,) * 3, in_body_axes=False)
    bodies = tuple(replace(body, loads=load) if body.coupled else body for body in model.bodies)
    return pack(bodies, model.gravity)
