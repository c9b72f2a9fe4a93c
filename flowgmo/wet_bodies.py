"""Bodies that move in the liquid: where the step expects them, how the pressure moves them, where they arrive.

    expect    poses at the end of the step, were there no pressure to come: prescribed ones as they will be
    kick      velocities of coupled bodies by gravity, control loads, and the water at rest that they displace
    couple    the same after the pressure
    arrive    open volumes at the poses that the motion of the bodies (with impacts) has reached

Coupled bodies that the liquid touches move through the step with the velocity of its end, as the liquid does: their
rows of World.flying have no gravity and no loads. Bodies that it does not touch fly as in a dry scene.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from flowgmo.bodies.arrays import DRIVEN, HINGED, STILL
from flowgmo.bodies.energy import rotation_matrices
from flowgmo.bodies.kicks import kick
from flowgmo.bodies.laws import Laws
from flowgmo.bodies.move import move_alone
from flowgmo.errors import StepTooLong
from flowgmo.flow.favor.near_surface import Pose
from flowgmo.flow.immersed.body_fluxes import BodyFluxes, weight_of_displaced
from flowgmo.flow.immersed.coupling import Coupling
from flowgmo.flow.liquid import Liquid
from flowgmo.model import Model

TRAVEL = 0.5  # of a cell: no point of a body crosses more in a step (DESIGN 3)


class WetBodies:
    """Of one scene. arrays (n,) BODY, laws: as the deck has them. flying (n,): those that the motion uses, changed."""

    def __init__(self, model: Model, arrays: np.ndarray, laws: Laws | None, liquid: Liquid) -> None:
        self.model, self.arrays, self.laws, self.liquid = model, arrays, laws, liquid
        self.flying = arrays.copy()
        motion = arrays["motion"]
        self.movers = np.flatnonzero(motion != STILL)
        solved = [bool(np.any(row["coupled"])) and row["mass"] > 0.0 for row in arrays]
        self.coupled = np.array([b for b in self.movers if motion[b] != DRIVEN and solved[b]], dtype=np.int64)
        self.driven = np.array([b for b in self.movers if b not in self.coupled], dtype=np.int64)
        self.place = {int(b): k for k, b in enumerate(self.movers)}  # among the moving ones
        self.reach = np.array([_reach(model.bodies[b].shape, arrays[b]["origin"]) for b in self.movers])
        self.cell = min(float(np.diff(x).min()) for x, n in zip(
            model.mesh.blocks[0].planes, model.mesh.blocks[0].shape, strict=True
        ) if n > 1)  # fmt: skip
        self.velocities = np.zeros((len(self.movers), 6))
        self.coupling: Coupling | None = None

    # ---- the length of a step

    def longest_step(self, v: np.ndarray, w: np.ndarray) -> float:
        """[time] in which no point of a moving body crosses more than TRAVEL cells. v, w (n, 3) of all bodies."""
        speed = self._speed(v[self.movers], w[self.movers])
        return TRAVEL * self.cell / speed if speed > 0.0 else np.inf

    def _speed(self, v: np.ndarray, w: np.ndarray) -> float:
        spin = np.where(np.isfinite(self.reach), self.reach, 0.0) * np.linalg.norm(w, axis=1)
        return float((np.linalg.norm(v, axis=1) + spin).max(initial=0.0))

    # ---- stages

    def expect(self, flow: object, motion: np.ndarray, t0: float, t1: float) -> None:
        """Open fractions for the step from motion (n,) POSE at t0 to where the bodies are expected at t1."""
        then = motion.copy()
        dt = t1 - t0
        self._drive(then, t0, t1)
        for b in self.coupled:
            then["p"][b] += dt * motion["v"][b]
            then["q"][b] = turned(motion["q"][b], dt * motion["w"][b])
            if self.arrays[b]["hinge"]:
                arm = rotation_matrices(then["q"][b : b + 1])[0] @ self.arrays[b]["arm"]
                then["p"][b] = self.arrays[b]["point"] + arm
        m = self.movers
        speed = self._speed(then["v"][m], then["w"][m])
        if speed * dt > 2.0 * TRAVEL * self.cell:
            raise StepTooLong(f"a body crosses {speed * dt / self.cell:.3g} of a cell in a step")
        places = 0.5 * (motion["p"][m] + then["p"][m])
        self.velocities = np.hstack([then["v"][m], then["w"][m]])
        self.liquid.immersed.begin(flow, self.poses(then), places, self.velocities, with_fluxes=len(self.coupled) > 0)
        self.liquid.find_columns(flow.F)
        self.liquid.immersed.fill_short(self.liquid.near, flow.F)

    def _drive(self, then: np.ndarray, t0: float, t1: float) -> None:
        """Prescribed bodies of then (n,) POSE at t0 come to t1."""
        if len(self.driven):
            none, n = np.zeros(0), len(then)
            move_alone(
                self.driven, self.arrays, self.laws, then, np.zeros(4), t0, t1, none, np.zeros((0, n), then.dtype),
                np.zeros((0, 4)), np.zeros((64, 7)), np.zeros(64, dtype=np.int64),
            )  # fmt: skip

    def kick(self, flow: object, motion: np.ndarray, t0: float, t1: float) -> None:
        """motion["v"], ["w"] of coupled bodies that the liquid touches: U* (bodies/kicks.py); they fly freely then."""
        self.flying[:] = self.arrays
        self.wet = []
        if not len(self.coupled):
            return
        F = None if flow.F is None else flow.F.reshape(-1)
        for b in self.coupled:
            cells = self.liquid.immersed.fluxes[self.place[int(b)]].cells
            if len(cells) and (F is None or (F[cells] > 0.0).any()):
                self.wet.append(int(b))
        which = np.array(self.wet, dtype=np.int64)
        kick(which, self.arrays, self.laws, motion, t0, t1)
        row = self.flying
        for name in ("gravity", "first_load", "last_load"):
            row[name][which] = 0
        for name in ("force", "torque"):
            row[name][which] = -1
        self.inverse_mass = inverse_masses(self.arrays[which], motion[which])

    def coupling_of(self, motion: np.ndarray, rho: float, gravity: np.ndarray, dt: float) -> Callable | None:
        """For Projector.project: the bodies as the present liquid cells couple them; adds to its right-hand side."""
        if not self.wet:
            return None
        fluxes = [self.liquid.immersed.fluxes[self.place[b]] for b in self.wet]
        expected = np.array([self.velocities[self.place[b]] for b in self.wet])
        start = np.array([np.concatenate([motion["v"][b], motion["w"][b]]) for b in self.wet])

        def couple(diagonal: np.ndarray, right: np.ndarray) -> Coupling:
            flat, into = diagonal.reshape(-1), right.reshape(-1)
            parts, lifts = [], []
            for one in fluxes:
                liquid = flat[one.cells] != 0.0
                parts.append(BodyFluxes(*(a[liquid] for a in one)))
                lifts.append(weight_of_displaced(parts[-1], slice(None), rho, gravity))
            self.lifts = np.array(lifts)
            self.start = start + dt * np.einsum("bij,bj->bi", self.inverse_mass, self.lifts)
            for part, U, U0 in zip(parts, self.start, expected, strict=True):
                into[part.cells] -= part.J @ (U - U0)
            self.coupling = Coupling(parts, self.inverse_mass, rho)
            return self.coupling

        return couple

    def couple(self, q: np.ndarray, motion: np.ndarray, rows: np.ndarray) -> None:
        """Velocities of the wet bodies in motion (n,) and in rows (k, n) POSE, with the pressure q = p dt / rho."""
        if not self.wet:
            return
        U = self.start + self.coupling.velocities(q)
        for b, own in zip(self.wet, U, strict=True):
            for to in (motion, *rows):
                to["v"][b], to["w"][b] = own[:3], own[3:]

    def poses(self, motion: np.ndarray) -> list[Pose]:
        """Of the moving bodies, from motion (n,) POSE: x = R x0 + t, x0 the place at t = 0."""
        R = rotation_matrices(motion["q"][self.movers])
        t = motion["p"][self.movers] - np.einsum("bij,bj->bi", R, self.arrays["origin"][self.movers])
        return [Pose(*one) for one in zip(R, t, strict=True)]


def turned(q: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """q (4,) turned by the rotation vector angle (3,) in space axes."""
    size = float(np.linalg.norm(angle))
    s = 0.5 * np.sinc(0.5 * size / np.pi)  # sin(size / 2) / size
    a, (b, c, d) = np.cos(0.5 * size), s * angle
    w, x, y, z = q
    new = np.array([
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y - b * z + c * w + d * x,
        a * z + b * y - c * x + d * w,
    ])  # fmt: skip
    return new / np.linalg.norm(new)


def inverse_masses(bodies: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """(b, 6, 6): changes of velocity of B and spin (space axes) by an impulse and its moment about B; zero for what is
    prescribed, or held at a stop."""
    out = np.zeros((len(bodies), 6, 6))
    R = rotation_matrices(rows["q"])
    for M, body, row, turn in zip(out, bodies, rows, R, strict=True):
        arm = turn @ body["arm"]
        if body["motion"] == HINGED:
            if not row["hold"][3]:
                g = np.concatenate([np.cross(body["axis"], arm), body["axis"]])
                M[...] = np.outer(g, g) / body["hinge_moment"]
            continue
        free = body["coupled"].astype(bool) & ~np.concatenate([row["hold"][:3] != 0, np.zeros(3, bool)])
        inertia = body["inertia"]
        if body["hinge"] == 2:
            a = body["arm"]
            inertia = inertia + body["mass"] * (a @ a * np.eye(3) - np.outer(a, a))
        spin = np.zeros((3, 3))
        F = np.flatnonzero(free[3:])
        if len(F):
            spin[np.ix_(F, F)] = np.linalg.inv(inertia[np.ix_(F, F)])
        spin = turn @ spin @ turn.T
        if body["hinge"] == 2:
            G = np.vstack([_times(arm), np.eye(3)])  # v = w x arm = - arm x w
            M[...] = G @ spin @ G.T
        else:
            M[:3, :3] = np.diag(free[:3] / body["mass"])
            M[3:, 3:] = spin
    return out


def _times(arm: np.ndarray) -> np.ndarray:
    """The matrix of w -> w x arm."""
    x, y, z = arm
    return np.array([[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]])


def _reach(shape: object, origin: np.ndarray) -> float:
    """Farthest point of a shape from `origin` [length], at most; inf where it has no end."""
    low, high = shape.bounds()
    return float(np.linalg.norm(np.maximum(np.abs(low - origin), np.abs(high - origin))))
