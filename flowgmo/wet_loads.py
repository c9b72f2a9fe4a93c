"""What the liquid does to bodies that move in it, for the records: loads, what keeps a prescribed motion, work.

A load is that of the step just made (flow/observe/body_loads.py). What keeps prescribed components has to give back
what the load does to them: all of it for a wholly prescribed body, and for one of which some turns are solved for

    T_kept = I_kf I_ff^-1 L_f - L_k        body axes; f solved for, k prescribed; L the moment about B (a fixed point)

Work of a step is load times the way of the step, which is that of the velocities at its end (wet_bodies.py); of a
prescribed body the way that its law goes. What the liquid's friction gives to a body, and viscosity so does not lose
(flow/momentum/viscous_work.py), is load times the mean of its velocities before and after: what its motion has of it.
"""

from __future__ import annotations

import numpy as np

from flowgmo.bodies.arrays import FORCED
from flowgmo.bodies.energy import rotation_matrices
from flowgmo.bodies.kicks import control_loads_at
from flowgmo.bodies.laws import Laws
from flowgmo.flow.immersed.body_fluxes import cross
from flowgmo.flow.observe.beside_balls import around_balls
from flowgmo.flow.observe.beside_bodies import beside_bodies
from flowgmo.flow.observe.body_loads import BodyLoads, pressure_loads, resting_fluxes, wetted_area
from flowgmo.flow.observe.buoyancy import buoyancy_centre
from flowgmo.flow.observe.spikes import Spikes
from flowgmo.state import FROM_LOADS, FROM_PRESCRIBED, LOST_IN_FRICTION, State
from flowgmo.wet_blows import Blow


class WetLoads:
    """Of one scene. movers (k,): rows of the bodies that move; driven: those of them that are wholly prescribed."""

    def __init__(
        self,
        arrays: np.ndarray,
        laws: Laws | None,
        movers: np.ndarray,
        driven: np.ndarray,
        liquid: object,
        *,
        pushed: bool,
    ) -> None:
        """pushed: the contact engine moves the coupled bodies, with the liquid's load as one more force on them."""
        self.arrays, self.laws, self.movers, self.driven, self.liquid = arrays, laws, movers, driven, liquid
        self.pushed = pushed
        self.loads: BodyLoads | None = None
        self.spikes = Spikes(len(movers))
        g = float(np.linalg.norm(liquid.gravity))
        self.up = -liquid.gravity / g if g > 0.0 else np.array([0.0, 0.0, 1.0])

    # ---- loads

    def note(self, p: np.ndarray, shear: np.ndarray | None = None, film: np.ndarray | None = None) -> None:
        """After the projection: the mean loads of the step. p (mesh) [mass/length/time2]: its pressure; shear
        (movers, 6): of the liquid's friction, film (movers, 6): of thin films; None without."""
        liquid = self.liquid
        wet = liquid.projector.matrix.diagonal
        found = pressure_loads(liquid.immersed.fluxes, wet, p, liquid.plan.rho, liquid.gravity)
        self.loads = BodyLoads(found, shear, film)

    def at_start(self, flow: object, p_WB: np.ndarray) -> None:
        """The loads of the pressure as it stands, bodies where they are."""
        liquid = self.liquid
        around = liquid.immersed
        surface = around.surface(flow)
        fluxes = [
            resting_fluxes(cover, liquid.grid, around.centres, p_WB[b], surface)
            for b, cover in zip(self.movers, around.covers.covers, strict=True)
        ]
        liquid.projector.set_surface(flow.F)
        wet = liquid.projector.wet
        rubs = liquid.momentum.operators is not None and liquid.plan.no_slip
        shear = np.zeros((len(self.movers), 6)) if rubs else None
        found = pressure_loads(fluxes, wet, flow.p, liquid.plan.rho, liquid.gravity)
        self.loads = BodyLoads(found, shear, None if liquid.plan.film is None else np.zeros_like(found))

    def of_all(self, count: int) -> np.ndarray:
        """(count, 6): force and torque about B on every body of the deck, 0 where it stands still."""
        out = np.zeros((count, 6))
        out[self.movers] = self.loads.total
        return out

    def values(self, names: list[str], rows: int) -> dict[str, np.ndarray]:
        """The loads as in history.h5, the same in each of so many rows; names of the moving bodies."""
        out = {}
        total = self.loads.total
        for k, name in enumerate(names):
            one = {"force": total[k, :3], "torque": total[k, 3:], "force_pressure": self.loads.pressure[k, :3]}
            if self.loads.shear is not None:
                one["force_shear"] = self.loads.shear[k, :3]
            if self.loads.film is not None:
                one["force_film"] = self.loads.film[k, :3]
            out |= {f"bodies/{name}/{part}": np.repeat(value[None], rows, axis=0) for part, value in one.items()}
        return out

    def wet_parts(self, flow: object, names: list[str], p_WB: np.ndarray) -> dict[str, float | np.ndarray]:
        """Wetted area and centre of buoyancy (of a dry body: B) of the moving bodies where they are."""
        out: dict[str, float | np.ndarray] = {}
        liquid, covers = self.liquid, self.liquid.immersed.covers
        for b, name, cover in zip(self.movers, names, covers.covers, strict=True):
            out[f"bodies/{name}/wetted_area"] = wetted_area(cover, flow, covers.open.V, liquid.grid)
            centre, volume = buoyancy_centre(
                cover, flow, covers.open.V, liquid.grid, liquid.immersed.centres, self.up
            )  # fmt: skip
            out[f"bodies/{name}/buoyancy_centre"] = centre if volume > 0.0 else p_WB[b].copy()
        return out

    def carried_along(self, state: State, middles: list[np.ndarray | None]) -> tuple[float, np.ndarray]:
        """Kinetic energy and momentum (3,) of liquid that the walls of the moving bodies carry along
        (flow/observe/beside_bodies.py); at t = 0 they have not yet begun to. middles: of WetBodies.middles."""
        if state.step == 0:
            return 0.0, np.zeros(3)
        liquid, around, m = self.liquid, self.liquid.immersed, self.movers
        U = np.hstack([state.v_WB[m], state.w_WB[m]])
        of = around.covers.covers, state.fluid, around.covers.open, liquid.grid, around.centres
        kinetic, momentum = beside_bodies(*of, state.p_WB[m], U, middles)
        return liquid.plan.rho * kinetic, liquid.plan.rho * momentum

    def around_balls(self, flow: object) -> float:
        """Potential energy that the liquid around balls within a cell has beyond what the gauges find
        (flow/observe/beside_balls.py)."""
        around = self.liquid.immersed
        of = around.covers.covers, flow, around.covers.open, self.liquid.grid, around.centres
        planes = None if flow.F is None else self.liquid.planes.at
        return self.liquid.plan.rho * around_balls(*of, around.gravity, planes)

    # ---- work

    def book(
        self, books: np.ndarray, before: np.ndarray, after: np.ndarray, wet: list[int], blows: dict[int, Blow],
        middle: float, dt: float,
    ) -> None:  # fmt: skip
        """Add a step's work to the books: before, after (n,) POSE; wet: coupled bodies that the liquid touches, blows:
        of wet_blows.py, by row; middle [time] of the step."""
        loads = dict(zip(self.movers.tolist(), self.loads.total, strict=True))
        if self.loads.film is not None:
            for b, film in zip(self.movers, self.loads.film, strict=True):
                books[LOST_IN_FRICTION] -= film @ self._way(b, before, after, blows)
        if self.loads.shear is not None:
            self.liquid.friction[0] -= self._work_of_shear(before, after, wet, blows, dt)
        for b in self.driven:
            books[FROM_PRESCRIBED] -= loads[int(b)] @ way_of(before[b], after[b])
        if self.pushed:  # the engine booked the liquid's load as it books control loads
            self._book_pushed(books, before, after, wet, blows, middle)
            return
        control, R = self._control(before, wet, middle), rotation_matrices(before["q"])
        for b in wet:  # they fly without weight and control loads
            U, body = np.concatenate([after["v"][b], after["w"][b]]), self.arrays[b]
            weight = np.concatenate([body["mass"] * body["gravity"], np.zeros(3)])
            books[FROM_LOADS] += dt * control[b] @ U
            books[FROM_PRESCRIBED] += dt * kept(body, R[b], control[b] + weight + loads[b]) @ U

    def _work_of_shear(
        self, before: np.ndarray, after: np.ndarray, wet: list[int], blows: dict[int, Blow], dt: float
    ) -> float:
        """[energy] that the liquid's friction gives the bodies in a step; arguments as of `book`."""
        work = 0.0
        for b, shear in zip(self.movers, self.loads.shear, strict=True):
            if self.pushed or b not in wet:
                work += float(shear @ self._way(b, before, after, blows))
            else:  # they go the way of the end's velocity; their motion gains by the mean of both
                ends = [np.concatenate([one[b]["v"], one[b]["w"]]) for one in (before, after)]
                work += 0.5 * dt * float(shear @ (ends[0] + ends[1]))
        return work

    @staticmethod
    def _way(b: int, before: np.ndarray, after: np.ndarray, blows: dict[int, Blow]) -> np.ndarray:
        """(6,): along which the load of the liquid on body b works in a step."""
        way = way_of(before[b], after[b])
        return blows[b].way_with(way) if b in blows else way

    def _control(self, motion: np.ndarray, wet: list[int], middle: float) -> np.ndarray:
        """(n, 6): control loads on bodies `wet` of motion (n,) POSE; zero for others."""
        out = np.zeros((len(motion), 6))
        control_loads_at(np.array(wet, dtype=np.int64), self.arrays, self.laws, motion, middle, out)
        return out

    def _book_pushed(
        self, books: np.ndarray, before: np.ndarray, after: np.ndarray, wet: list[int], blows: dict[int, Blow],
        middle: float,
    ) -> None:  # fmt: skip
        """Take from FROM_LOADS what the engine has booked there beside the work of control loads."""
        loads = dict(zip(self.movers.tolist(), self.loads.total, strict=True))
        control = self._control(before, wet, middle) if blows else None
        for b in wet:
            way = way_of(before[b], after[b])
            if b not in blows:
                books[FROM_LOADS] -= loads[b] @ way
                continue
            books[FROM_LOADS] += control[b] @ blows[b].way_with(way) - blows[b].told @ way


def way_of(before: np.void, after: np.void) -> np.ndarray:
    """(6,) displacement [length] of B and rotation vector [rad], space axes, from one POSE to another."""
    w0, v0 = before["q"][0], before["q"][1:]
    w1, v1 = after["q"][0], after["q"][1:]
    w, v = w1 * w0 + v1 @ v0, w0 * v1 - w1 * v0 - cross(v1, v0)  # q1 times the conjugate of q0
    size = float(np.linalg.norm(v))
    angle = 2.0 * np.arctan2(size, abs(w)) * (1.0 if w >= 0.0 else -1.0)
    return np.concatenate([after["p"] - before["p"], v * (angle / size) if size > 0.0 else np.zeros(3)])


def kept(body: np.void, R: np.ndarray, load: np.ndarray) -> np.ndarray:
    """(6,) force and torque (about B, or its fixed point) by which what keeps a body's prescribed components answers a
    load (6,) on it, space axes; R: its attitude. body: one of BODY."""
    free = body["coupled"].astype(bool)
    out = np.zeros(6)
    if not free.any():
        return -load
    if body["motion"] != FORCED:
        return out
    moment, inertia = R.T @ load[3:], body["inertia"]
    if body["hinge"] == 2:
        a = body["arm"]
        moment = moment + np.cross(a, R.T @ load[:3])
        inertia = inertia + body["mass"] * (a @ a * np.eye(3) - np.outer(a, a))
    else:
        out[:3] = np.where(free[:3], 0.0, -load[:3])
    f, k = np.flatnonzero(free[3:]), np.flatnonzero(~free[3:])
    answer = np.zeros(3)
    answer[k] = -moment[k]
    if len(f) and len(k):
        answer[k] += inertia[np.ix_(k, f)] @ np.linalg.solve(inertia[np.ix_(f, f)], moment[f])
    out[3:] = R @ answer
    return out
