"""How fast bodies can get: bounds that no motion of the deck exceeds. Built once, in numpy.

    |dω/dt| <= turn_gain + unevenness ω²        loads, driven rates; the free top's own wobble (Imax - Imin)/Imin
    |ω|     <= spread |ω0| + turn_gain t        energy: ω² <= ω·Iω / Imin
    |a_B|   <= gain + lever (|dω/dt| + ω²)      gravity and loads; the lever of B about what it turns around

The time-of-impact search (sweep.py) never steps farther than these allow.
"""

from __future__ import annotations

import numpy as np

from flowgmo.bodies.arrays import BALLISTIC, DRIVEN, FORCED, HINGED
from flowgmo.bodies.laws import SINUSOID, Laws

#: gain [length/time²], lever [length], turn_gain [rad/time²], unevenness, spread [-] as above.
BOUND = np.dtype(
    [("gain", "f8"), ("lever", "f8"), ("turn_gain", "f8"), ("unevenness", "f8"), ("spread", "f8")], align=True
)


def build_bounds(arrays: np.ndarray, laws: Laws | None) -> np.ndarray:
    """Bounds (n,) of BOUND of bodies (n,) of BODY."""
    out = np.zeros(len(arrays), BOUND)
    for bound, body in zip(out, arrays, strict=True):
        bound["spread"] = 1.0
        gravity = float(np.linalg.norm(body["gravity"]))
        motion = body["motion"]
        if motion in (BALLISTIC, FORCED):
            moments = _moments(body)
            bound["unevenness"] = (moments[-1] - moments[0]) / moments[0]
            bound["spread"] = np.sqrt(moments[-1] / moments[0])
            bound["gain"] = gravity
        if motion == FORCED:
            _of_forced(bound, body, laws, moments, gravity)
        elif motion == HINGED:
            lever = float(np.linalg.norm(body["arm"]))
            push = lever * (body["mass"] * gravity + largest_force(body, laws)) + largest_torque(body, laws)
            bound["lever"] = lever
            bound["turn_gain"] = push / body["hinge_moment"]
        elif motion == DRIVEN:
            _of_driven(bound, body, laws)
    return out


def _moments(body: np.void) -> np.ndarray:
    """Principal moments about B, or about the fixed point (Steiner), ascending."""
    inertia = body["inertia"]
    if body["hinge"] == 2:
        arm = body["arm"]
        inertia = inertia + body["mass"] * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return np.linalg.eigvalsh(inertia)


def _of_forced(bound: np.void, body: np.void, laws: Laws, moments: np.ndarray, gravity: float) -> None:
    """Loads, driven components and a fixed point; driven rates count as if they acted with all others."""
    slopes = [_largest_slope(k, laws) for k in body["drive"]]
    rates = sum(_largest_value(k, laws) for k in body["drive"][3:])
    ratio = moments[-1] / moments[0]
    force, torque = largest_force(body, laws), largest_torque(body, laws)
    arm = float(np.linalg.norm(body["arm"])) if body["hinge"] == 2 else 0.0
    torque += arm * (body["mass"] * gravity + force)
    turn_gain = torque / moments[0] + ratio * sum(slopes[3:]) + ratio * rates**2
    bound["turn_gain"] = turn_gain
    bound["gain"] += force / body["mass"] if body["mass"] > 0.0 else 0.0
    bound["gain"] += float(np.linalg.norm(slopes[:3]))
    bound["lever"] = arm if body["hinge"] == 2 else float(np.linalg.norm(body["reference"]))


def _of_driven(bound: np.void, body: np.void, laws: Laws) -> None:
    slopes = [_largest_slope(k, laws) for k in body["drive"]]
    bound["lever"] = float(np.linalg.norm(body["arm"] if body["hinge"] else body["reference"]))
    bound["gain"] = float(np.linalg.norm(slopes[:3]))
    bound["turn_gain"] = sum(slopes[3:])


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


def largest_force(body: np.void, laws: Laws) -> float:
    """Bound on the control force [force]."""
    every = [body["force"], *laws.loads["law"][body["first_load"] : body["last_load"]]]
    return sum(float(np.linalg.norm([_largest_value(k, laws) for k in three])) for three in every)


def largest_torque(body: np.void, laws: Laws) -> float:
    """Bound on the control torque about B [torque]."""
    total = float(np.linalg.norm([_largest_value(k, laws) for k in body["torque"]]))
    for load in laws.loads[body["first_load"] : body["last_load"]]:
        force = float(np.linalg.norm([_largest_value(k, laws) for k in load["law"]]))
        total += force * float(np.linalg.norm(load["arm"]))
    return total
