"""The bodies of a Model as arrays for kernels, one row per component (row = deck number - 1)."""

from __future__ import annotations

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


#: One body. Arms are in body axes, relative to B unless said otherwise.
#: mass 0 where there is none; inertia about B; moments ascending, axes (columns) principal; hinge 0 none, 1 axis,
#: 2 point; arm from the hinge to B; hinge_moment about the axis; reference the driven point from B; drive, force,
#: torque laws; point loads first_load <= j < last_load in Laws; lo, hi stops: displacement of B, angle.
BODY = np.dtype(
    [
        ("motion", "i8"),
        ("mass", "f8"),
        ("inertia", "f8", (3, 3)),
        ("moments", "f8", 3),
        ("axes", "f8", (3, 3)),
        ("hinge", "i8"),
        ("point", "f8", 3),
        ("axis", "f8", 3),
        ("arm", "f8", 3),
        ("hinge_moment", "f8"),
        ("reference", "f8", 3),
        ("coupled", "i8", 6),
        ("drive", "i8", 6),
        ("force", "i8", 3),
        ("torque", "i8", 3),
        ("load_in_body", "i8"),
        ("first_load", "i8"),
        ("last_load", "i8"),
        ("lo", "f8", 4),
        ("hi", "f8", 4),
        ("stopped", "i8"),
        ("origin", "f8", 3),
        ("gravity", "f8", 3),
    ],
    align=True,
)

#: The moving part of the State, one row a body: a kernel gets one array in place of seven.
POSE = np.dtype(
    [
        ("p", "f8", 3),
        ("q", "f8", 4),
        ("v", "f8", 3),
        ("w", "f8", 3),
        ("angle", "f8"),
        ("hold", "i8", 4),
        ("support", "i8", 3),
    ],
    align=True,
)


def pack(bodies: tuple[Body, ...], gravity: np.ndarray) -> tuple[np.ndarray, Laws | None]:
    """Bodies (n,) of dtype BODY, and their laws; None where every body is stationary or ballistic."""
    book = LawBook()
    arrays = np.zeros(len(bodies), BODY)
    for row, body in zip(arrays, bodies, strict=True):
        for name, value in _row(body, book).items():
            row[name] = value
        row["gravity"] = gravity
    _point_loads(arrays, bodies, book)
    motion = arrays["motion"]
    if not np.any(motion > BALLISTIC):
        return arrays, None
    present = {"ballistic": motion == BALLISTIC, "hinged": motion == HINGED, "forced": motion == FORCED}
    return arrays, book.pack(
        **{name: bool(np.any(which)) for name, which in present.items()}, stops=bool(np.any(arrays["stopped"]))
    )


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
        "stopped": body.stops.any,
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


def _point_loads(arrays: np.ndarray, bodies: tuple[Body, ...], book: LawBook) -> None:
    for row, body in zip(arrays, bodies, strict=True):
        row["first_load"] = book.loads
        for load in body.loads.points if body.loads else ():
            book.add_load(load, body.origin)
        row["last_load"] = book.loads
