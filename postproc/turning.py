"""How far a body turns, and whether turning is what it does; from history.h5 alone."""

from __future__ import annotations

import numpy as np

from postproc.results import Results

HINGED = ("fixed axis", "fixed point")  # `constraint` of a body in the history
LEAST_TURN = 1e-3  # rad; less is not seen in a figure
STEADY = 1e-6  # of the largest angular velocity; an axis that strays less is fixed
STILL = 1e-9  # of the domain's diagonal; the rounding of a position


def turns(results: Results, name: str) -> bool:
    """Whether a body turns rather than travels: it is hinged, or stays, or its kinetic energy is mostly of turning.

    A ball that rolls has 2/5 as much energy of turning as of travel, a hoop as much; both travel.
    """
    curves = {q: results.curve(f"bodies/{name}/{q}") for q in ("angular_velocity", "position", "velocity")}
    t, w = curves["angular_velocity"].t, curves["angular_velocity"].y
    if _integral(np.linalg.norm(w, axis=1), t) < LEAST_TURN:
        return False
    attrs = results.file[f"bodies/{name}"].attrs
    diagonal = 0.0 if results.domain is None else np.linalg.norm(np.diff(results.domain, axis=0))
    if str(attrs.get("constraint", "")) in HINGED:
        return True
    if np.ptp(curves["position"].y, axis=0).max() <= STILL * diagonal:
        return True
    energy = f"bodies/{name}/kinetic_energy"
    if "mass" not in attrs or energy not in results.file:
        return False
    whole = _integral(results.curve(energy).y[:, 0], t)
    travel = _integral(float(attrs["mass"]) * (curves["velocity"].y ** 2).sum(axis=1) / 2, t)
    return whole - travel > travel


def _integral(y: np.ndarray, t: np.ndarray) -> float:
    """Trapezoidal rule; numpy changed the name of its own."""
    return float(((y[1:] + y[:-1]) / 2 * np.diff(t)).sum())


def fixed_axis(w: np.ndarray) -> np.ndarray | None:
    """Unit vector that angular velocities (n, 3) keep to, its largest component positive; None where there is none."""
    size = np.linalg.norm(w, axis=1)
    if size.max(initial=0.0) == 0.0:
        return None
    axis = w[size.argmax()] / size.max()
    axis = axis * np.sign(axis[np.abs(axis).argmax()])
    astray = np.abs(w - np.outer(w @ axis, axis)).max()
    return axis if astray <= STEADY * size.max() else None


def angle_turned(t: np.ndarray, q: np.ndarray, w: np.ndarray) -> np.ndarray:
    """Angle (n,) [degrees] from orientations q (n, 4; w x y z) and angular velocities w (n, 3).

    About a fixed axis: signed, and counted on beyond 180 degrees; the angular velocity tells the whole turns between
    two rows. Without one: how far the orientation is from that of t = 0, 0 to 180.
    """
    axis = fixed_axis(w)
    if axis is None:
        return np.degrees(2 * np.arctan2(np.linalg.norm(q[:, 1:], axis=1), np.abs(q[:, 0])))
    angle = 2 * np.arctan2(q[:, 1:] @ axis, q[:, 0])
    rate = w @ axis
    change, expected = np.diff(angle), (rate[1:] + rate[:-1]) / 2 * np.diff(t)
    change += 2 * np.pi * np.round((expected - change) / (2 * np.pi))
    start = (angle[0] + np.pi) % (2 * np.pi) - np.pi
    return np.degrees(start + np.concatenate([[0.0], np.cumsum(change)]))
