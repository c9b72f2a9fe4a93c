"""The book of momentum where bodies move in liquid: what liquid and coupled bodies have, and who gave it since t = 0.

    total = total at t = 0 + gravity + walls + prescribed + contacts + loads + streams + remainder

    gravity      g (rho volume + masses) dt
    walls        pressure and shear of closed sides and of solids that stand still (flow/observe/side_forces.py), and
                 films beside them: a film pushes both its walls, so that those that do not move get what is left over
    prescribed   minus the liquid's load on bodies that are wholly prescribed
    contacts     on coupled bodies: contacts, stops and impacts, and what keeps prescribed components of their motion
    loads        control loads
    streams      liquid through open sides with its velocity, and the pressure there

Between liquid and coupled bodies momentum is exchanged. What contacts give is what the motion of the coupled bodies
shows beyond all else that acts on them,

    contacts = sum of m (v1 - v0) - dt (loads of the liquid + control loads + m g) - what impacts make the liquid give

so that contacts between two of them cancel. The remainder is what nothing above knows: advection is not conservative,
cells cut by bodies have another inertia in the pressure equation than their volume, films on solids.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flowgmo.bodies.kicks import control_loads_at
from flowgmo.flow.observe.body_loads import pressure_loads
from flowgmo.flow.observe.side_forces import Pressed, by_shear, by_sides, by_solids
from flowgmo.mesh import PERIODIC, SYMMETRY, WALL
from flowgmo.world import poses_of

if TYPE_CHECKING:
    from flowgmo.flow.observe.watch import Watch
    from flowgmo.model import Model
    from flowgmo.state import State
    from flowgmo.wet_bodies import WetBodies

GIVERS = ("gravity", "walls", "prescribed", "contacts", "loads", "streams")
GRAVITY, WALLS, PRESCRIBED, CONTACTS, LOADS, STREAMS = range(len(GIVERS))


class MomentumBook:
    """Of one scene. watch: knows the liquid as a whole, and the walls of solids that stand still. Flow.momenta (7, 3)
    holds the book: the total at t = 0, GIVERS."""

    def __init__(self, model: Model, bodies: WetBodies, watch: Watch) -> None:
        self.model, self.bodies, self.watch, self.liquid = model, bodies, watch, bodies.liquid
        self.walls = list(watch.walls.values())
        self.kinds = [side.kind for side in model.fluid.sides]
        self.there = np.array(self.liquid.present, dtype=float)  # the liquid of other directions has no momentum
        has = {
            "prescribed": len(bodies.driven) > 0,
            "contacts": len(bodies.coupled) > 0,
            "loads": model.has("control loads"),
            "streams": any(kind not in (SYMMETRY, WALL, PERIODIC) for kind in self.kinds),
            "gravity": bool(np.any(model.gravity)),
        }
        self.given = [name for name in GIVERS if has.get(name, True)]
        self.answered = np.zeros((len(GIVERS), 3)), np.zeros(3)

    # ---- what there is

    def total(self, state: State, beside: np.ndarray) -> np.ndarray:
        """(3,) [mass length/time] of the liquid and the coupled bodies as they stand; beside (3,): of liquid that the
        bodies' walls carry along."""
        mass, coupled = self.bodies.arrays["mass"], self.bodies.coupled
        own = (mass[coupled, None] * state.v_WB[coupled]).sum(axis=0)
        return own + self.watch.whole(state.step, state.fluid)[1] + beside

    def open(self, state: State) -> None:
        """At t = 0: nothing was given."""
        state.fluid.momenta = np.zeros((1 + len(GIVERS), 3))
        beside = self.bodies.records.carried_along(state, self.bodies.middles(poses_of(state)))[1]
        state.fluid.momenta[0] = self.total(state, beside)

    def values(self, state: State, beside: np.ndarray) -> dict[str, np.ndarray]:
        """As in history.h5; beside as in `total`."""
        start, given = state.fluid.momenta[0], state.fluid.momenta[1:]
        total = self.total(state, beside)
        out = {"momentum/total": total.copy()}
        out |= {f"momentum/{name}": given[GIVERS.index(name)].copy() for name in self.given}
        return out | {"momentum/remainder": total - start - given.sum(axis=0)}

    # ---- what is given

    def answer(self, given_to_bodies: np.ndarray) -> None:
        """Impacts have been answered by a pressure without time (wet_impacts.py), which gave the wet bodies
        given_to_bodies (wet, 6): it pushed walls too."""
        of, rho = self.bodies, self.liquid.plan.rho
        pressed = Pressed(rho * self.liquid.projector.q, self.liquid.projector.matrix.diagonal, rho, np.zeros(3))
        given = self._by_pressure(pressed, None)
        given[PRESCRIBED] = -self._on_driven(pressed)
        coupled = np.isin(of.wet, of.coupled)
        self.answered = given, given_to_bodies[coupled, :3].sum(axis=0)

    def step(self, state: State, motion: np.ndarray, dt: float) -> np.ndarray:
        """momenta (7, 3) after a step from state to motion (n,) POSE, whose pressure and velocities are the liquid's
        newest; state is as before it."""
        of, liquid, flow = self.bodies, self.liquid, state.fluid
        if flow.momenta is None:  # a liquid that no start_liquid has begun
            self.open(state)
        rho, g = liquid.plan.rho, np.asarray(self.model.gravity, dtype=float)
        mass, coupled = of.arrays["mass"], of.coupled
        given, back = self.answered
        self.answered = np.zeros((len(GIVERS), 3)), np.zeros(3)
        pressed = Pressed(liquid.p, liquid.projector.matrix.diagonal, rho, liquid.gravity)
        step = self._by_pressure(pressed, flow.F, liquid.predicted)
        step[WALLS] += self._by_friction(flow.F)
        volume = flow.start_volume + float(flow.passed.sum())
        step[GRAVITY] = self.there * g * rho * volume + g * mass[coupled].sum()
        loads = of.records.loads
        on = dict(zip(of.movers.tolist(), loads.total[:, :3], strict=True))
        step[PRESCRIBED] = -sum((on[int(b)] for b in of.driven), np.zeros(3))
        if loads.film is not None:
            step[WALLS] += loads.film[:, :3].sum(axis=0)
        control = np.zeros((len(motion), 6))
        control_loads_at(coupled, of.arrays, of.laws, motion, state.t + 0.5 * dt, control)
        step[LOADS] = control[coupled, :3].sum(axis=0)
        moved = (mass[coupled, None] * (motion["v"][coupled] - state.v_WB[coupled])).sum(axis=0)
        acting = sum((on[int(b)] for b in coupled), np.zeros(3)) + step[LOADS] + g * mass[coupled].sum()
        given = given + dt * step
        given[CONTACTS] = moved - dt * acting - back
        return flow.momenta + np.vstack([np.zeros(3), given])

    def _by_pressure(self, pressed: Pressed, F: np.ndarray | None, stream: list | None = None) -> np.ndarray:
        """(6, 3) [force] of sides and solids that stand still on the liquid."""
        liquid, out = self.liquid, np.zeros((len(GIVERS), 3))
        at_sides = liquid.predicted, F, liquid.openings, liquid.grid, self.kinds
        out[WALLS], out[STREAMS] = by_sides(pressed, *at_sides, stream)
        out[WALLS] += self.there * by_solids(pressed, self.walls)
        return out

    def _on_driven(self, pressed: Pressed) -> np.ndarray:
        """(3,) of the pressure on wholly prescribed bodies."""
        of = self.bodies
        fluxes = [self.liquid.immersed.fluxes[of.place[int(b)]]._replace(edge=None) for b in of.driven]
        return pressure_loads(fluxes, pressed.wet, pressed.p, pressed.rho, pressed.gravity)[:, :3].sum(axis=0)

    def _by_friction(self, F: np.ndarray | None) -> np.ndarray:
        """(3,) [force] of the friction of sides and solids that stand still on the liquid."""
        liquid, momentum = self.liquid, self.liquid.momentum
        if momentum.operators is None or not liquid.plan.no_slip:
            return np.zeros(3)
        cuts = []
        for c, one in enumerate(momentum.operators):
            if one is None or one.cut is None:
                cuts.append(None)
                continue
            still = np.ones(len(one.cut.rows))
            for faces in self.bodies.friction.walls if self.bodies.friction is not None else ():
                for of_body in faces:
                    if of_body.c == c:
                        still[of_body.at] -= of_body.share
            some = (still > 1e-12) & (one.cut.s > 0.0)  # 1e-12: shares add up to 1 to rounding
            cuts.append((np.ascontiguousarray(one.cut.rows[some]), still[some] * one.cut.s[some]))
        sides = [None if one is None else (one.rows, one.s, one.speed) for one in momentum.side_walls]
        return by_shear(liquid.team, liquid.predicted, F, liquid.grid, liquid.plan.mu, cuts, sides)
