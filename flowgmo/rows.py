"""History rows from states: energies, the books that the scene's effects can write, residual loads."""

from __future__ import annotations

import numpy as np

from flowgmo.bodies.energy import kinetic_energy, potential_energy
from flowgmo.model import Model
from flowgmo.records import Rows
from flowgmo.state import BOOKS, State, initial_state
from flowgmo.world import World, poses_of


def rows_of_state(world: World, state: State, liquid: dict[str, np.ndarray] | None = None) -> Rows:
    """One row: the state as it stands (used at t = 0); liquid as in records.Rows."""
    force = np.zeros((1, len(state.p_WB), 3)) if world.collisions else None
    return make_rows(world, np.array([state.t]), poses_of(state)[None], force, state.books[None].copy(), liquid)


def make_rows(
    world: World,
    t: np.ndarray,
    poses: np.ndarray,
    contact_force: np.ndarray | None,
    books: np.ndarray,
    liquid: dict[str, np.ndarray] | None = None,
) -> Rows:
    """History rows from states (k, n) of POSE: energies and residual loads are added here."""
    model, arrays = world.model, world.arrays
    p, q, v, w = (np.ascontiguousarray(poses[name]) for name in "pqvw")
    kinetic = kinetic_energy(arrays, q, v, w)
    residual = _residuals(world, t, poses)
    energy: dict[str, np.ndarray] = {}
    coupled = coupled_bodies(model)
    if coupled.any():
        energy["kinetic"] = kinetic[:, coupled].sum(axis=1)
        energy["potential"] = potential_energy(arrays, p)[:, coupled].sum(axis=1)
        remainder = energy["kinetic"] + energy["potential"] - world.energy_at_start
        for name, place, sign in world.ledger:
            energy[name] = books[:, place]
            remainder = remainder - sign * books[:, place]
        energy["remainder"] = remainder
    has_mass = any(body.mass is not None for body in model.moving)
    return Rows(
        t=t,
        p_WB=p,
        q_WB=q,
        v_WB=v,
        w_WB=w,
        contact_force=contact_force,
        residual_force=residual[0] if residual else None,
        residual_torque=residual[1] if residual else None,
        kinetic_energy=kinetic if has_mass else None,
        energy=energy,
        liquid=liquid or {},
    )


def _residuals(world: World, t: np.ndarray, poses: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    if not world.model.has("residual"):
        return None
    from flowgmo.bodies.residual import residual_rows

    force, torque = np.zeros((*poses.shape, 3)), np.zeros((*poses.shape, 3))
    residual_rows(world.arrays, world.laws, t, poses, force, torque)
    return force, torque


def ledger_of(model: Model) -> tuple[tuple[str, int, float], ...]:
    """Books that the scene's effects can write: name, place in State.books, +1 gives energy to the bodies, -1 takes."""
    calls = {
        "impacts": model.has("collisions") or model.has("stops"),
        "dissipated": model.has("collisions"),  # friction, and what contact forces take from bodies that come to rest
        "work_prescribed": model.has("prescribed") or model.has("residual"),
        "work_loads": model.has("control loads"),
    }
    return tuple((name, i, 1.0 if name.startswith("work") else -1.0) for i, name in enumerate(BOOKS) if calls[name])


def coupled_bodies(model: Model) -> np.ndarray:
    return np.array([body.coupled for body in model.bodies], dtype=bool)


def energy_at_start(model: Model, arrays: np.ndarray) -> float:
    """Kinetic energy of the coupled bodies at t = 0; their potential energy counts from there."""
    start = initial_state(model)
    kinetic = kinetic_energy(arrays, start.q_WB[None], start.v_WB[None], start.w_WB[None])[0]
    return float(kinetic[coupled_bodies(model)].sum())
