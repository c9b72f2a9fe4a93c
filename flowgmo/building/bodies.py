"""&OBS: mass, constraint, motion, loads and stops of one component -> Body."""

from __future__ import annotations

import numpy as np

from flowgmo.bodies.body import (
    COUPLED,
    FIXED_AXIS,
    FIXED_POINT,
    PRESCRIBED,
    SIX_DEGREES,
    SOLID,
    Body,
    ControlLoads,
    Drive,
    MassData,
    PointLoad,
    Sinusoid,
    Stops,
    Table,
)
from flowgmo.building.findings import Findings
from flowgmo.building.mass import build_mass
from flowgmo.building.shapes import build_shape
from flowgmo.deck import Deck
from flowgmo.geometry import Component, GeometryError

KINDS = {0: SOLID, 3: PRESCRIBED, 4: COUPLED}
CONSTRAINTS = {0: SIX_DEGREES, 1: FIXED_AXIS, 2: FIXED_AXIS, 3: FIXED_AXIS, 4: FIXED_POINT}
TRANSLATIONS, ROTATIONS = ("U", "V", "W"), ("OMX", "OMY", "OMZ")
UNLIMITED = 1e19  # the deck's default for "no limit"


def build_body(found: Findings, m: int, domain: np.ndarray) -> Body | None:
    """Component m as a Body; None, with problems, if something is missing. domain (2, 3) bounds of the mesh."""
    deck = found.deck
    if not deck.at("IFCOMPENABLED", m):
        found.problem(
            "IFCOMPENABLED", m, wrong="components that are left out are not computed yet",
            write="Remove the component from the deck and number the others anew",
        )  # fmt: skip
        return None
    shape = build_shape(found, m)
    if shape is None:
        return None
    kind = KINDS[int(deck.at("IMO", m))]
    common = {
        "number": m,
        "name": str(deck.at("OBSID", m) or "").strip() or f"obs{m}",
        "shape": shape,
        "kind": kind,
        "restitution": float(deck.at("CRSTRNG", m)),
        "friction": float(deck.at("CFRC", m)),
    }
    if kind == SOLID:
        return Body(**common, origin=np.zeros(3))
    fixed = int(deck.at("IMOAXS", m))
    constraint = CONSTRAINTS[fixed]
    mass, sound = build_mass(found, m, shape, constraint)
    if not sound:
        return None
    point, axis = _hinge(deck, m, fixed)
    reference = _reference(found, m, shape, mass, domain) if constraint == SIX_DEGREES else None
    if constraint == SIX_DEGREES and reference is None:
        return None
    origin = mass.centre if mass is not None else reference if reference is not None else point
    drives = _drives(deck, m, kind, fixed)
    velocity, spin = _start(drives, kind, constraint, origin, reference, point, axis)
    return Body(
        **common,
        origin=np.array(origin, dtype=float),
        constraint=constraint,
        point=point,
        axis=axis,
        mass=mass,
        drives=drives,
        reference=reference if kind == PRESCRIBED else None,
        velocity=velocity,
        spin=spin,
        stops=_stops(deck, m, constraint),
        loads=_loads(deck, m, origin) if kind == COUPLED else None,
    )


def _hinge(deck: Deck, m: int, fixed: int) -> tuple[np.ndarray | None, np.ndarray | None]:
    """A point of the fixed axis, or the fixed point (3,); direction of the axis (3,) unit."""
    if fixed == 0:
        return None, None
    point = np.array([deck.at(f"{a}AXS0", m) for a in "XYZ"], dtype=float)
    if fixed == 4:
        return point, None
    axis = np.array([deck.at(f"AXIS{a}", m) for a in "XYZ"], dtype=float)
    return point, axis / np.linalg.norm(axis)


def _reference(
    found: Findings, m: int, shape: Component, mass: MassData | None, domain: np.ndarray
) -> np.ndarray | None:
    """The point whose velocity the deck gives: XREF0 …, else the mass centre, else the geometric centre."""
    deck = found.deck
    given = [deck.at(f"{a}REF0", m) for a in "XYZ"]
    prescribed = int(deck.at("IMO", m)) == 3
    if mass is not None and not (prescribed and any(g is not None for g in given)):
        return mass.centre
    if all(g is not None for g in given):
        return np.array(given, dtype=float)
    bounds = shape.bounds()
    try:
        centre = mass.centre if mass is not None else shape.mass_properties(1.0).centre
    except GeometryError:
        # reaches out of the domain without end: the middle of what lies inside
        centre = np.clip(bounds, domain[0], domain[1]).mean(axis=0)
    return np.array([c if g is None else g for c, g in zip(centre, given, strict=True)], dtype=float)


def _law(deck: Deck, m: int, name: str, flag: str) -> Table | Sinusoid:
    if deck.at(flag, m) == 1:
        amplitude, frequency, phase = (float(deck.at(f"{name}{part}", m)) for part in ("AMP", "FRE", "PHS"))
        return Sinusoid(amplitude, frequency, np.radians(phase))
    series = deck.series(f"{name}TOBS", m)
    return Table(np.array(series.t, dtype=float), np.array(series.y, dtype=float))


def _drives(deck: Deck, m: int, kind: str, fixed: int) -> tuple[Drive, ...]:
    """Six components; with a fixed axis the only one that counts is drives[3]."""
    names = [(n, f"I{n}MCAL", f"I{n}PRE") for n in TRANSLATIONS] + [(n, f"I{n}CAL", f"I{n}PRE") for n in ROTATIONS]
    drives = []
    for name, coupled, flag in names:
        solved = kind == COUPLED and bool(deck.at(coupled, m))
        drives.append(Drive(solved, _law(deck, m, name, flag)))
    if 1 <= fixed <= 3:
        none = Table(np.zeros(1), np.zeros(1))
        drives = [Drive(False, none)] * 3 + [drives[2 + fixed]] + [Drive(False, none)] * 2
    elif fixed == 4:
        none = Table(np.zeros(1), np.zeros(1))
        drives[:3] = [Drive(False, none)] * 3
    return tuple(drives)


def _value(law: Table | Sinusoid) -> float:
    """The law at t = 0."""
    if isinstance(law, Sinusoid):
        return law.amplitude * np.sin(law.phase)
    return float(np.interp(0.0, law.t, law.y))


def _start(
    drives: tuple[Drive, ...],
    kind: str,
    constraint: str,
    origin: np.ndarray,
    reference: np.ndarray | None,
    point: np.ndarray | None,
    axis: np.ndarray | None,
) -> tuple[np.ndarray, np.ndarray]:
    """Velocity of B and spin at t = 0: of coupled components element t = 1 of the tables, of others their law at 0."""
    first = [float(d.law.y[0]) if d.coupled and isinstance(d.law, Table) else _value(d.law) for d in drives]
    v, w = np.array(first[:3]), np.array(first[3:])
    if constraint == FIXED_AXIS:
        turning = w[0] * axis
        return np.cross(turning, origin - point), np.array([w[0], 0.0, 0.0])
    if constraint == FIXED_POINT:
        return np.cross(w, origin - point), w
    if kind == PRESCRIBED:
        return v + np.cross(w, origin - reference), w
    return v, w


def _stops(deck: Deck, m: int, constraint: str) -> Stops:
    def limit(name: str) -> float:
        value = abs(float(deck.at(name, m)))
        return value if deck.given(name, m) and value < UNLIMITED else np.inf

    lo = np.array([-limit(f"D{a}MCMIN") for a in "XYZ"])
    hi = np.array([limit(f"D{a}MCMAX") for a in "XYZ"])
    if constraint == FIXED_AXIS:
        return Stops(angle_lo=-np.radians(limit("ANGLMIN")), angle_hi=np.radians(limit("ANGLMAX")))
    return Stops(lo=lo, hi=hi)


def _loads(deck: Deck, m: int, origin: np.ndarray) -> ControlLoads | None:
    """IGF 1: total force and torque; 2: forces at points."""
    mode = int(deck.at("IGF", m))
    if mode == 0:
        return None
    none = Table(np.zeros(1), np.zeros(1))

    def three(stem: str, *index: int) -> tuple[Table, Table, Table]:
        tables = (deck.series(stem.replace("*", a), *index) for a in "XYZ")
        return tuple(Table(np.array(s.t, dtype=float), np.array(s.y, dtype=float)) for s in tables)

    if mode == 1:
        force, torque = three("F*TOBS", m), three("T*TOBS", m)
        absent = all(table.is_zero for table in (*force, *torque))
        return None if absent else ControlLoads(force, torque, in_body_axes=int(deck.at("IREFGF", m)) == 2)
    numbers = sorted({mf for a in "XYZ" for (k, mf) in deck.tabled(f"F{a}TOBSM") if k == m})
    points = []
    for mf in numbers:
        given = [deck.at(f"{a}FPNT", m, mf) for a in "XYZ"]
        place = np.array([o if g is None else g for o, g in zip(origin, given, strict=True)], dtype=float)
        force = three("F*TOBSM", m, mf)
        if not all(table.is_zero for table in force):
            points.append(PointLoad(force, place, int(deck.at("IREFGFM", m, mf)) == 2))
    if not points:
        return None
    return ControlLoads((none,) * 3, (none,) * 3, in_body_axes=False, points=tuple(points))
