"""The bodies of a Model as arrays for kernels, one row per component (row = deck number - 1)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flowgmo.bodies.body import (
    FIXED_AXIS,
    FIXED_POINT,
    PRESCRIBED,
    SIX_DEGREES,
    SOLID,
    Body,
    ControlLoads,
    Sinusoid,
)
from flowgmo.bodies.laws import LawBook, Laws

# How a body is moved: the cheapest way that is exact for it.
STILL = 0  # stationary
BALLISTIC = 1  # coupled, gravity only: parabola and free top, closed form
FORCED = 2  # equations of motion integrated: control loads, fixed points, partly prescribed, turning about several axes
HINGED = 3  # coupled, fixed axis: one equation for the angle
DRIVEN = 4  # prescribed: integrals of the laws, closed form


class Arrays(NamedTuple):
    """n bodies, k point loads. Arms are in body axes, relative to B unless said otherwise.

    motion (n,); mass (n,), 0 where there is none; inertia (n, 3, 3) about B; moments (n, 3) ascending and axes
    (n, 3, 3) principal; hinge (n,) 0 none, 1 axis, 2 point; point, axis (n, 3) space; arm (n, 3) from the hinge to B;
    hinge_moment (n,) about the axis; reference (n, 3) the driven point from B; coupled (n, 6); drive (n, 6) laws;
    force, torque (n, 3) laws, load_in_body (n,); first_load (n + 1,), load_law (k, 3), load_arm (k, 3),
    load_axes (k,) 1 in body axes; lo, hi (n, 4) stops: displacement of B, angle; origin (n, 3); gravity (3,).
    """

    motion: np.ndarray
    mass: np.ndarray
    inertia: np.ndarray
    moments: np.ndarray
    axes: np.ndarray
    hinge: np.ndarray
    point: np.ndarray
    axis: np.ndarray
    arm: np.ndarray
    hinge_moment: np.ndarray
    reference: np.ndarray
    coupled: np.ndarray
    drive: np.ndarray
    force: np.ndarray
    torque: np.ndarray
    load_in_body: np.ndarray
    first_load: np.ndarray
    load_law: np.ndarray
    load_arm: np.ndarray
    load_axes: np.ndarray
    lo: np.ndarray
    hi: np.ndarray
    origin: np.ndarray
    gravity: np.ndarray


def pack(bodies: tuple[Body, ...], gravity: np.ndarray) -> tuple[Arrays, Laws | None]:
    """Arrays of all bodies, and their laws; None where every body is stationary or ballistic."""
    book = LawBook()
    rows = [_row(body, book) for body in bodies]
    columns = {name: np.array([row[name] for row in rows]) for name in rows[0]} if rows else {}
    first, law, arm, in_body = _point_loads(bodies, book)
    arrays = Arrays(
        **columns, first_load=first, load_law=law, load_arm=arm, load_axes=in_body, gravity=np.array(gravity, dtype=float)
    )
    laws = book.pack() if np.any(arrays.motion > BALLISTIC) else None
    return arrays, laws


def _row(body: Body, book: LawBook) -> dict[str, object]:
    hinge = {SIX_DEGREES: 0, FIXED_AXIS: 1, FIXED_POINT: 2}[body.constraint]
    zero = np.zeros(3)
    point = body.point if body.point is not None else zero
    mass = body.mass
    inertia = mass.inertia if mass is not None and mass.inertia is not None else np.zeros((3, 3))
    moments, axes = np.linalg.eigh(inertia)
    if np.allclose(inertia, np.diag(np.diag(inertia)), rtol=0.0, atol=1e-15 * np.abs(inertia).max(initial=0.0)):
        order = np.argsort(np.diag(inertia), kind="stable")  # a diagonal tensor keeps its axes exactly
        moments, axes = np.diag(inertia)[order], np.eye(3)[:, order]
    if np.linalg.det(axes) < 0.0:
        axes[:, 0] = -axes[:, 0]
    loads = body.loads
    return {
        "motion": _motion(body),
        "mass": mass.mass if mass else 0.0,
        "inertia": inertia,
        "moments": moments,
        "axes": np.ascontiguousarray(axes),
        "hinge": hinge,
        "point": point,
        "axis": body.axis if body.axis is not None else zero,
        "arm": body.origin - point if hinge else zero,
        "hinge_moment": _hinge_moment(body),
        "reference": (body.reference - body.origin) if body.reference is not None else zero,
        "coupled": np.array([d.coupled for d in body.drives] or [False] * 6),
        "drive": np.array([-1 if d.coupled else book.add(d.law) for d in body.drives] or [-1] * 6, dtype=np.int64),
        "force": np.array([book.add(f) for f in loads.force] if loads else [-1] * 3, dtype=np.int64),
        "torque": np.array([book.add(f) for f in loads.torque] if loads else [-1] * 3, dtype=np.int64),
        "load_in_body": bool(loads and loads.in_body_axes),
        "lo": np.array([*body.stops.lo, body.stops.angle_lo]),
        "hi": np.array([*body.stops.hi, body.stops.angle_hi]),
        "origin": np.array(body.origin, dtype=float),
    }


def _motion(body: Body) -> int:
    if body.kind == SOLID:
        return STILL
    if body.kind == PRESCRIBED:
        turning = [d for d in body.drives[3:] if isinstance(d.law, Sinusoid) or not d.law.is_zero]
        return DRIVEN if body.constraint == FIXED_AXIS or len(turning) <= 1 else FORCED
    if body.constraint == FIXED_AXIS:
        return HINGED if body.drives[3].coupled else DRIVEN
    loaded = isinstance(body.loads, ControlLoads)
    return FORCED if loaded or body.constraint == FIXED_POINT or not all(d.coupled for d in body.drives) else BALLISTIC


def _hinge_moment(body: Body) -> float:
    """J [mass length²] about the fixed axis: given, or aᵀ I a + m |a × arm|² (Steiner)."""
    if body.constraint != FIXED_AXIS or body.mass is None:
        return 0.0
    if body.mass.axis_moment is not None:
        return body.mass.axis_moment
    arm = np.cross(body.axis, body.origin - body.point)
    return float(body.axis @ body.mass.inertia @ body.axis + body.mass.mass * arm @ arm)


def _point_loads(bodies: tuple[Body, ...], book: LawBook) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    first, law, arm, in_body = [0], [], [], []
    for body in bodies:
        for load in body.loads.points if body.loads else ():
            law.append([book.add(f) for f in load.force])
            arm.append(load.point - body.origin)
            in_body.append(load.in_body_axes)
        first.append(len(law))
    return (
        np.array(first, dtype=np.int64),
        np.array(law, dtype=np.int64).reshape(-1, 3),
        np.array(arm, dtype=float).reshape(-1, 3),
        np.array(in_body, dtype=bool),
    )
