"""History rows from states: energies, the books that the scene's effects can write, residual loads."""

from __future__ import annotations

import numpy as np

from flowgmo.bodies.arrays import DRIVEN, FORCED
from flowgmo.bodies.energy import kinetic_energy, potential_energy, rotation_matrices
from flowgmo.model import Model
from flowgmo.records import Rows
from flowgmo.state import BOOKS, State, initial_state
from flowgmo.world import World, poses_of

ENERGY = "energy/"  # what begins the names of the books of energy in history.h5


def rows_of_state(world: World, state: State, liquid: dict[str, np.ndarray] | None = None) -> Rows:
    """One row: the state as it stands (used at t = 0); liquid as in records.Rows."""
    force = np.zeros((1, len(state.p_WB), 3)) if world.collisions else None
    loads = None
    if world.wet_bodies is not None:
        loads = world.wet_bodies.records.of_all(len(state.p_WB))
        liquid = (liquid or {}) | world.wet_bodies.records.values(world.wet_bodies.names, 1)
    return make_rows(world, np.array([state.t]), poses_of(state)[None], force, state.books[None].copy(), liquid, loads)


def make_rows(
    world: World,
    t: np.ndarray,
    poses: np.ndarray,
    contact_force: np.ndarray | None,
    books: np.ndarray,
    liquid: dict[str, np.ndarray] | None = None,
    loads: np.ndarray | None = None,
) -> Rows:
    """History rows from states (k, n) of POSE: energies and residual loads are added here.

    liquid: as in records.Rows, and in a scene whose bodies move in it `energy/...` too; loads (n, 6): of the liquid on
    every body, force and torque about B.
    """
    model, arrays = world.model, world.arrays
    p, q, v, w = (np.ascontiguousarray(poses[name]) for name in "pqvw")
    kinetic = kinetic_energy(arrays, q, v, w)
    residual = _residuals(world, t, poses, loads)
    energy = {name[len(ENERGY) :]: a for name, a in (liquid or {}).items() if name.startswith(ENERGY)}
    coupled = coupled_bodies(model)
    if coupled.any() and not energy:
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
        liquid={name: a for name, a in (liquid or {}).items() if not name.startswith(ENERGY)},
    )


def wet_energy(world: World, state: State, liquid: dict, beside: float) -> dict[str, float]:
    """`energy/...` of an instant of a scene whose bodies move in liquid: coupled bodies and liquid together.

    liquid: its values, as of flow/observe/watch.py; beside [energy]: of what the bodies' walls carry along. The
    remainder is what the step's method makes or loses: the liquid's advection and surface, the impulsive start of
    bodies, U of the end of the step along its way. What the liquid lost in viscosity is in `dissipated`, beside what
    contacts and films took.
    `fluid/kinetic_energy` comes back with what the liquid beside the bodies has.
    """
    coupled, arrays = coupled_bodies(world.model), world.arrays
    kinetic = kinetic_energy(arrays, state.q_WB[None], state.v_WB[None], state.w_WB[None])[0, coupled].sum()
    potential = potential_energy(arrays, state.p_WB[None])[0, coupled].sum()
    of_liquid = liquid["fluid/kinetic_energy"] + beside
    energy = {
        "kinetic": float(kinetic) + of_liquid,
        "potential": float(potential) + liquid["fluid/potential_energy"],
    }
    remainder = energy["kinetic"] + energy["potential"] - world.energy_at_start - state.fluid.start_energy
    for name, place, sign in world.ledger:
        energy[name] = float(state.books[place])
        remainder -= sign * energy[name]
    for name, sign in (("dissipated", -1.0), ("work_boundaries", 1.0)):
        if f"fluid/{name}" in liquid:
            energy[name] = energy.get(name, 0.0) + liquid[f"fluid/{name}"]
            remainder -= sign * liquid[f"fluid/{name}"]
    energy["remainder"] = remainder
    return {"fluid/kinetic_energy": of_liquid} | {ENERGY + name: value for name, value in energy.items()}


def _residuals(
    world: World, t: np.ndarray, poses: np.ndarray, loads: np.ndarray | None
) -> tuple[np.ndarray, np.ndarray] | None:
    if not world.model.has("residual"):
        return None
    from flowgmo.bodies.residual import residual_rows

    force, torque = np.zeros((*poses.shape, 3)), np.zeros((*poses.shape, 3))
    residual_rows(world.arrays, world.laws, t, poses, force, torque)
    if loads is not None:
        from flowgmo.wet_loads import kept

        for b in np.flatnonzero(needs_residual(world.arrays)):
            for k, R in enumerate(rotation_matrices(poses["q"][:, b])):
                answer = kept(world.arrays[b], R, loads[b])
                force[k, b] += answer[:3]
                torque[k, b] += answer[3:]
    return force, torque


def needs_residual(arrays: np.ndarray) -> np.ndarray:
    """(n,) which bodies have a residual load: those with mass that are prescribed in whole or in part."""
    return (arrays["mass"] > 0.0) & np.isin(arrays["motion"], (DRIVEN, FORCED))


def ledger_of(model: Model) -> tuple[tuple[str, int, float], ...]:
    """Books that the scene's effects can write: name, place in State.books, +1 gives energy to the bodies, -1 takes."""
    calls = {
        "impacts": model.has("collisions") or model.has("stops"),
        # friction, what contact forces take from bodies that come to rest, and films
        "dissipated": model.has("collisions") or model.has("film"),
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
