"""`impmob=0`: first the bodies, moved by the pressure of the step before, then the liquid around what moves as told.

    U_new = U + dt M^-1 (J^T p_old + lift + friction_old + weight + control loads)       contacts that press hold

The liquid then sees bodies of known velocity: no part of its pressure equation, as with prescribed motion. An
acceleration a of the body comes back in the next step as the load - A a of its added mass A,

    a_new = - M^-1 A a_old + ...

which changes its sign in every step, and grows wherever an eigenvalue of M^-1 A exceeds one: of a body lighter than
its added mass. The length of the step is not in it; no step is short enough. Source: Causin, Gerbeau and Nobile 2005,
"Added-mass effect in the design of partitioned algorithms for fluid-structure problems".

Momentum: the friction of a step is the body's in the next one as an impulse, State.owed, and the pressure as a force.
Impacts know nothing of the liquid (wetimpact='dry'). Loads in the records are those that moved the body, of the step
before, so that m a = load + weight holds in them.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from flowgmo.bodies.inverse_masses import block_diagonal, inverse_masses
from flowgmo.bodies.kicks import kick
from flowgmo.errors import StepFailed
from flowgmo.flow.fields import Flow
from flowgmo.flow.immersed.added_mass import added_mass
from flowgmo.flow.immersed.body_fluxes import BodyFluxes
from flowgmo.flow.observe.body_loads import pressure_loads, resting_fluxes
from flowgmo.flow.stages import settle_pressure
from flowgmo.state import State
from flowgmo.wet_contacts import pressing

if TYPE_CHECKING:
    from flowgmo.wet_bodies import WetBodies

SWINGS = 3  # changes of sign in a row, each larger than the one before: waves and blows make one or two
GROWN = 10.0  # times, in them: a swing that hardly grows may yet die


class Explicit:
    """Of one scene; `bodies` do the rest of a step. After `foresee`: wet (k,) rows of bodies that the liquid touches,
    U (k, 6) their velocities at the end of the step, loads (k, 6) what the liquid does to them in it."""

    def __init__(self, bodies: WetBodies) -> None:
        self.bodies = bodies
        self.lighter: dict[str, str] = {}  # names of bodies lighter than their added mass, with both
        self.time = -np.inf
        self.swings = {int(b): Swing() for b in bodies.coupled}

    # ---- a step

    def foresee(self, state: State, motion: np.ndarray, t1: float) -> np.ndarray:
        """motion (n,) POSE at state.t with the velocities that coupled bodies have at t1. Raises StepFailed where their
        accelerations swing to and fro and grow."""
        b, t0, dt = self.bodies, state.t, t1 - state.t
        loads, wet = self._loads(state.fluid, motion)
        wet |= state.owed[b.coupled].any(axis=1)
        self.wet = which = b.coupled[wet]
        self.friction = state.owed[which] / dt
        self.loads = loads[wet] + self.friction
        told, after = b.poses_then(motion, t0, t1), motion.copy()
        kick(which, b.arrays, b.laws, after, t0, t1)
        W = inverse_masses(b.arrays[which], motion[which])
        kicked = np.hstack([after["v"][which], after["w"][which]])
        free = kicked + dt * np.einsum("bij,bj->bi", W, self.loads)
        self._watch(motion, free, t0, dt)
        b.wet, b.dt, b.middle = [int(n) for n in which], dt, 0.5 * (t0 + t1)
        b.velocities = np.hstack([told["v"][b.movers], told["w"][b.movers]])
        self.U = free
        if len(state.held_parts) and len(which):
            slack = b.slack()
            U = pressing(b.contacts_held(state, motion), block_diagonal(W), free.reshape(-1), slack)
            self.U = U.reshape(-1, 6)
        after["v"][which], after["w"][which] = self.U[:, :3], self.U[:, 3:]
        return after

    def _loads(self, flow: Flow, motion: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(coupled, 6) force and moment about B of the pressure as it stands, and which of them liquid touches.

        Of the state alone, so that a restart goes on with the same bits.
        """
        b = self.bodies
        p, rho = flow.p, b.model.fluid.rho
        liquid = np.ones(p.shape, bool) if flow.F is None else flow.F >= 0.5  # cells of the pressure equation
        fluxes = self._fluxes(flow, motion)
        wet = [len(one.cells) > 0 and bool(liquid.reshape(-1)[one.cells].any()) for one in fluxes]
        return pressure_loads(fluxes, liquid, p, rho, b.liquid.gravity), np.array(wet, dtype=bool)

    def _fluxes(self, flow: Flow, motion: np.ndarray) -> list[BodyFluxes]:
        """Of the coupled bodies where they stand."""
        b, around = self.bodies, self.bodies.liquid.immersed
        covers = around.covers.covers
        middles, grid = b.middles(motion), b.liquid.grid
        surface = around.surface(flow)
        return [
            resting_fluxes(covers[k], grid, around.centres, motion["p"][n], surface, middles[k], around.open_sides)
            for n, k in ((int(n), b.place[int(n)]) for n in b.coupled)
        ]

    def finish(self, motion: np.ndarray, rows: np.ndarray, owed: np.ndarray) -> None:
        """After the pressure: bodies go on with what was foreseen; owed (n, 6): this step's friction, for the next."""
        b = self.bodies
        b.flying[:] = b.unloaded
        b.go_on(self.U, self.loads, motion, rows)
        records = b.records
        records.note(b.liquid.p, b.shear_loads() if b.friction is not None else None)
        shear = b.shear_loads()
        owed[self.wet] = 0.0
        for n in b.coupled:
            k = b.place[int(n)]
            owed[n] = b.dt * shear[k]
            records.loads.pressure[k] = 0.0
            if records.loads.shear is not None:
                records.loads.shear[k] = 0.0
        for n, load, rub in zip(self.wet, self.loads, self.friction, strict=True):
            k = b.place[int(n)]
            records.loads.pressure[k] = load - rub
            if records.loads.shear is not None:
                records.loads.shear[k] = rub

    # ---- divergence

    def _watch(self, motion: np.ndarray, free: np.ndarray, t0: float, dt: float) -> None:
        """Raise StepFailed where accelerations to velocities free (wet, 6) swing and grow. A step that is tried again
        starts with the same load, and counts once."""
        if t0 <= self.time:
            return
        self.time = t0
        b, touched = self.bodies, set(self.wet.tolist())
        for n, swing in self.swings.items():
            if n not in touched:
                swing.calm()
        least = float(np.linalg.norm(b.model.gravity))
        for n, U in zip(self.wet, free, strict=True):
            k = b.place[int(n)]
            a = (U - np.concatenate([motion["v"][n], motion["w"][n]])) / dt
            a[3:] *= b.ways.reach[k] if np.isfinite(b.ways.reach[k]) else 0.0
            if self.swings[int(n)].grows(a, least):
                raise StepFailed(self._diverged(b.names[k], self.swings[int(n)], t0))

    def _diverged(self, name: str, swing: Swing, t: float) -> str:
        how = self.lighter.get(name, "more of it is wet by now than at the start")
        return (
            f"the motion of body {name} diverges: at t = {t:.6g} its acceleration changes its sign from step to step "
            f"and has grown {swing.grown:.3g} times in {swing.count} steps. With impmob=0 the liquid's load is that of "
            f"the step before, and no step is short enough for a body lighter than its added mass ({how}). Write "
            "impmob=1, which solves for bodies and pressure together"
        )

    # ---- before the first step

    def compare_masses(self, flow: Flow, motion: np.ndarray, dt: float) -> list[str]:
        """Texts about the bodies that are lighter than their added mass, found with the liquid as it stands; dt [time]
        the first step."""
        liquid = self.bodies.liquid
        try:
            settle_pressure(liquid, replace(flow, p=flow.p.copy()), dt)  # sets the pressure equation; its p is not used
        except StepFailed:
            return []  # the first step will say why there is no pressure
        projector, out = liquid.projector, []
        diagonal = projector.matrix.diagonal.reshape(-1)
        b = self.bodies
        inverse = inverse_masses(b.arrays[b.coupled], motion[b.coupled])
        for n, one, W in zip(b.coupled, self._fluxes(flow, motion), inverse, strict=True):
            some = diagonal[one.cells] != 0.0
            A = added_mass(
                BodyFluxes(one.cells[some], one.J[some], one.lift[some]),
                projector.respond,
                flow.p.shape,
                liquid.plan.rho,
            )
            ratio = largest_ratio(W, A)
            if ratio <= 1.0:
                continue
            name, mass = b.names[b.place[int(n)]], float(b.arrays["mass"][n])
            how = f"mass {mass:.3g}, added mass up to {np.linalg.eigvalsh(A[:3, :3]).max():.3g}"
            self.lighter[name] = how
            much = f"{ratio:.3g} times as much where it is worst"
            out.append(f"{name} is lighter than its added mass ({how}; {much}): impmob=0 diverges then. Write impmob=1")
        return out


def largest_ratio(W: np.ndarray, A: np.ndarray) -> float:
    """Largest eigenvalue of W A, both (6, 6), symmetric and >= 0: inverse mass and added mass."""
    values, vectors = np.linalg.eigh(W)
    root = (vectors * np.sqrt(np.maximum(values, 0.0))) @ vectors.T
    return float(np.linalg.eigvalsh(root @ A @ root).max())


class Swing:
    """How often the acceleration of a body has turned round and grown, step by step. count, grown: since it began."""

    def __init__(self) -> None:
        self.calm()

    def calm(self) -> None:
        """Nothing known."""
        self.last, self.count, self.grown = np.zeros(6), 0, 1.0

    def grows(self, a: np.ndarray, least: float) -> bool:
        """Take the acceleration a (6,) of a step, turns times a length; whether it diverges: SWINGS turns, GROWN, and
        larger than `least`, gravity's."""
        before, now = float(np.linalg.norm(self.last)), float(np.linalg.norm(a))
        turned = float(a @ self.last) < 0.0 and now > before
        self.count, self.grown = (self.count + 1, self.grown * now / before) if turned else (0, 1.0)
        self.last = a
        return self.count >= SWINGS and self.grown >= GROWN and now > least
