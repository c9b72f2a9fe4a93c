"""Who can touch whom, as arrays for the kernels of this package.

Parties are numbered as in Model.contacts: bodies 0 .. n-1, domain sides n .. n+5. A ball is a spherical body; a flat is
a rectangular box that does not move, with faces possibly at infinity: a domain side is a flat with one finite face.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flowgmo.bodies.arrays import BALLISTIC, DRIVEN, FORCED, HINGED
from flowgmo.bodies.laws import SINUSOID, Laws
from flowgmo.model import Model

#: One ball. body: its row; centre of the sphere from B, body axes; parabolic: its path between events has constant
#: acceleration; inverse_mass, inverse_inertia (about any axis) of a free ball, 0 where it is driven or hinged;
#: |acceleration of the centre| <= gain + swing (turn_gain + |w|²).
BALL = np.dtype(
    [
        ("body", "i8"),
        ("radius", "f8"),
        ("centre", "f8", 3),
        ("parabolic", "i8"),
        ("inverse_mass", "f8"),
        ("inverse_inertia", "f8"),
        ("gain", "f8"),
        ("swing", "f8"),
        ("turn_gain", "f8"),
    ],
    align=True,
)
#: One flat: points with lo <= axes (x - origin) <= hi, axes (rows) orthonormal, bounds may be infinite.
FLAT = np.dtype(
    [
        ("party", "i8"),
        ("origin", "f8", 3),
        ("axes", "f8", (3, 3)),
        ("lo", "f8", 3),
        ("hi", "f8", 3),
        ("face", "i8"),
        ("box", "f8", 6),
    ],
    align=True,
)
#: What two parties do: whether they may collide, restitution, friction.
PAIR = np.dtype([("allowed", "i8"), ("e", "f8"), ("mu", "f8")], align=True)


class Scene(NamedTuple):
    """balls (m,) of BALL, flats (f,) of FLAT, pairs (n + 6, n + 6) of PAIR.

    rough: None where no pair has friction, and then no code for sliding and rolling is compiled.
    FLAT.face is the axis of the only face of a half-space, -1 for any other box; FLAT.box its lowest and highest
    corner in space axes.
    """

    balls: np.ndarray
    flats: np.ndarray
    pairs: np.ndarray
    rough: np.ndarray | None


def build_scene(model: Model, arrays: np.ndarray, laws: Laws | None) -> Scene:
    """Arrays of the model's balls and flats; `arrays` (n,) of dtype BODY."""
    plan = model.contacts
    balls = np.zeros(len(plan.balls), BALL)
    for ball, row in zip(balls, plan.balls, strict=True):
        body = arrays[row]
        centre, radius = model.bodies[row].shape.as_sphere()
        ball["body"], ball["radius"], ball["centre"] = row, radius, centre - model.bodies[row].origin
        ball["parabolic"] = body["motion"] == BALLISTIC
        if body["motion"] in (BALLISTIC, FORCED):
            ball["inverse_mass"] = 1.0 / body["mass"]
            ball["inverse_inertia"] = 1.0 / body["moments"][1]
        ball["gain"], ball["swing"], ball["turn_gain"] = _acceleration_bounds(body, ball["centre"], laws)
    pairs = np.zeros(plan.allowed.shape, PAIR)
    pairs["allowed"], pairs["e"], pairs["mu"] = plan.allowed, plan.restitution, plan.friction
    rough = np.zeros(0) if (pairs["mu"][plan.allowed] > 0.0).any() else None
    return Scene(balls=balls, flats=_flats(model), pairs=pairs, rough=rough)


def _flats(model: Model) -> np.ndarray:
    """Boxes of the flat solids, then the sides that stop bodies."""
    rows = [
        (row, box.origin, box.axes, box.lo, box.hi)
        for row in model.contacts.flats
        for box in model.bodies[row].shape.as_boxes()
    ]
    bounds = model.mesh.bounds
    for side in model.mesh.sides:
        if not side.stops_bodies:
            continue
        k, upper = divmod(side.number, 2)
        lo, hi = np.full(3, -np.inf), np.full(3, np.inf)
        if upper:
            lo[k] = bounds[1, k]
        else:
            hi[k] = bounds[0, k]
        rows.append((len(model.bodies) + side.number, np.zeros(3), np.eye(3), lo, hi))
    flats = np.zeros(len(rows), FLAT)
    for flat, values in zip(flats, rows, strict=True):
        for name, value in zip(("party", "origin", "axes", "lo", "hi"), values, strict=True):
            flat[name] = value
        finite = np.isfinite(np.stack([flat["lo"], flat["hi"]]))
        flat["face"] = int(np.argmax(finite.any(axis=0))) if finite.sum() == 1 else -1
        flat["box"] = _bounding_box(flat)
    return flats


def _bounding_box(flat: np.void) -> np.ndarray:
    """(6,): lowest and highest corner of a flat in space axes; infinite where it has no end."""
    # each space coordinate is a sum over the flat's axes; a zero component takes nothing from an infinite bound
    with np.errstate(invalid="ignore"):
        ends = [np.where(flat["axes"] == 0.0, 0.0, flat["axes"] * flat[side][:, None]) for side in ("lo", "hi")]
    return np.concatenate(
        [flat["origin"] + np.minimum(*ends).sum(axis=0), flat["origin"] + np.maximum(*ends).sum(axis=0)]
    )


def _acceleration_bounds(body: np.void, centre: np.ndarray, laws: Laws | None) -> tuple[float, float, float]:
    """(gain, swing, turn_gain) of a ball: |acceleration of the centre| <= gain + swing (turn_gain + |w|²)."""
    motion = body["motion"]
    gravity = float(np.linalg.norm(body["gravity"]))
    if motion == BALLISTIC:
        return gravity, 0.0, 0.0
    if motion == FORCED:
        return gravity + _largest_force(body, laws) / body["mass"], 0.0, 0.0
    if motion == HINGED:
        arm = float(np.linalg.norm(np.cross(body["axis"], body["arm"] + centre)))
        lever = float(np.linalg.norm(body["arm"]))
        push = lever * (body["mass"] * gravity + _largest_force(body, laws)) + _largest_torque(body, laws)
        return 0.0, arm, push / body["hinge_moment"]
    if motion == DRIVEN:
        slopes = [_largest_slope(k, laws) for k in body["drive"]]
        arm = centre + body["arm"] if body["hinge"] else centre - body["reference"]
        size = float(np.linalg.norm(arm))
        rates = sum(_largest_value(k, laws) for k in body["drive"][3:])
        return float(np.linalg.norm(slopes[:3])) + size * rates**2, size, sum(slopes[3:])
    return 0.0, 0.0, 0.0


def _largest_value(k: int, laws: Laws) -> float:
    if k < 0:
        return 0.0
    law = laws.rows[k]
    if law["kind"] == SINUSOID:
        return abs(float(law["wave"][0]))
    return float(np.abs(laws.entries[law["first"] : law["last"] + 1, 1]).max())


def _largest_slope(k: int, laws: Laws) -> float:
    if k < 0:
        return 0.0
    law = laws.rows[k]
    if law["kind"] == SINUSOID:
        return abs(float(law["wave"][0] * 2.0 * np.pi * law["wave"][1]))
    t, y = laws.entries[law["first"] : law["last"] + 1].T
    return float(np.abs(np.diff(y) / np.diff(t)).max(initial=0.0))


def _largest_force(body: np.void, laws: Laws) -> float:
    every = [body["force"], *laws.loads["law"][body["first_load"] : body["last_load"]]]
    return sum(float(np.linalg.norm([_largest_value(k, laws) for k in three])) for three in every)


def _largest_torque(body: np.void, laws: Laws) -> float:
    total = float(np.linalg.norm([_largest_value(k, laws) for k in body["torque"]]))
    for load in laws.loads[body["first_load"] : body["last_load"]]:
        force = float(np.linalg.norm([_largest_value(k, laws) for k in load["law"]]))
        total += force * float(np.linalg.norm(load["arm"]))
    return total
