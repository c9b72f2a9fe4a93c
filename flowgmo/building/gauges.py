"""Planes whose flow is recorded (&FLOWGMO), and stationary components whose load is (&OBS)."""

from __future__ import annotations

import numpy as np

from flowgmo.bodies.body import SOLID, Body
from flowgmo.building.findings import Findings
from flowgmo.flow_plan import FlowPlane, LoadPlan
from flowgmo.mesh import Mesh


def build_planes(found: Findings, mesh: Mesh) -> tuple[FlowPlane, ...]:
    """Planes in the order of their numbers k. Problems: two for one number, outside the mesh, limits without room."""
    deck = found.deck
    numbers = sorted({k for axis in "XYZ" for (k,) in deck.indices(f"PLANE{axis}")})
    planes = []
    for k in numbers:
        axes = [axis for axis in range(3) if deck.given(f"PLANE{'XYZ'[axis]}", k)]
        names = [f"plane{'xyz'[axis]}({k})" for axis in axes]
        if len(axes) > 1:
            found.problem(
                f"PLANE{'XYZ'[axes[1]]}", k, wrong=f"{names[0]} is given too, and a plane has one position",
                write="Give the second plane a number of its own",
            )  # fmt: skip
            continue
        axis = axes[0]
        plane = FlowPlane(
            number=k,
            axis=axis,
            position=float(deck.at(f"PLANE{'XYZ'[axis]}", k)),
            lo=np.array([deck.at(f"PLANE{a}L", k) for a in "XYZ"], dtype=float),
            hi=np.array([deck.at(f"PLANE{a}H", k) for a in "XYZ"], dtype=float),
        )
        if _is_sound(found, plane, mesh):
            planes.append(plane)
    _check_limits_belong(found, numbers)
    return tuple(planes)


def _is_sound(found: Findings, plane: FlowPlane, mesh: Mesh) -> bool:
    name, (lo, hi) = f"PLANE{'XYZ'[plane.axis]}", mesh.bounds
    if not lo[plane.axis] <= plane.position <= hi[plane.axis]:
        found.problem(
            name, plane.number, wrong=f"the plane lies outside the mesh, {lo[plane.axis]:.6g} to {hi[plane.axis]:.6g}",
            write="Move it, or remove it",
        )  # fmt: skip
        return False
    for axis in range(3):
        if axis != plane.axis and not max(plane.lo[axis], lo[axis]) < min(plane.hi[axis], hi[axis]):
            ends = [f"PLANE{'XYZ'[axis]}{end}" for end in "LH"]
            end = next(e for e in ends if found.deck.given(e, plane.number))
            found.problem(
                end, plane.number, wrong=f"the limits {plane.lo[axis]:.6g} to {plane.hi[axis]:.6g} of the plane leave "
                "nothing of it inside the mesh", write="Give a lower limit below the upper one, and inside the mesh",
            )  # fmt: skip
            return False
    return True


def _check_limits_belong(found: Findings, numbers: list[int]) -> None:
    for end in (f"PLANE{axis}{side}" for axis in "XYZ" for side in "LH"):
        for (k,) in found.deck.indices(end):
            if k not in numbers:
                found.problem(
                    end, k, wrong=f"there is no plane {k}",
                    write=f"Give planex({k}), planey({k}) or planez({k}), or remove it",
                )  # fmt: skip


def build_loads(found: Findings, bodies: tuple[Body, ...]) -> tuple[LoadPlan, ...]:
    """Stationary components with IFRCO = 1."""
    deck = found.deck
    _note_references(found, bodies)
    return tuple(
        LoadPlan(
            body=body.number,
            point=np.array([deck.at(f"{axis}FRCO", body.number) for axis in "XYZ"], dtype=float),
            wetted_area=deck.at("IFWETAR", body.number) == 1,
        )
        for body in bodies
        if body.kind == SOLID and deck.at("IFRCO", body.number) == 1
    )


def _note_references(found: Findings, bodies: tuple[Body, ...]) -> None:
    """Notices: what of &OBS says nothing of a component that stands still."""
    deck = found.deck
    for body in (body for body in bodies if body.kind == SOLID):
        n = body.number
        if deck.at("IBUOYO", n) == 1:
            found.notice("IBUOYO", n, wrong="recorded of bodies that the liquid moves only (imo=4)")
        other = "IPREF" if deck.at("IPREF", n) == 2 else "PREFMBW" if deck.at("PREFMBW", n) != deck["PVOID"] else None
        if other is not None and deck.at("IFRCO", n) == 1:
            found.notice(other, n, wrong="the load on a component that stands still is that against pvoid")


def check_probes(found: Findings, mesh: Mesh) -> None:
    """Problems: probes without all three coordinates, or outside the mesh."""
    deck = found.deck
    for k in sorted({k for axis in "XYZ" for (k,) in deck.indices(f"{axis}LOC")}):
        if not deck.at("IF_PROBE_ENABLED", k):
            continue
        missing = next((axis for axis in "XYZ" if not deck.given(f"{axis}LOC", k)), None)
        if missing:
            found.problem(
                f"{missing}LOC", k, wrong=f"a coordinate of probe {k} is missing",
                write=f"Give xloc({k}), yloc({k}) and zloc({k})",
            )  # fmt: skip
            continue
        for axis, (lo, hi) in zip("XYZ", mesh.bounds.T, strict=True):
            if not lo <= deck.at(f"{axis}LOC", k) <= hi:
                found.problem(
                    f"{axis}LOC", k, wrong=f"probe {k} lies outside the mesh, {lo:.6g} to {hi:.6g}",
                    write="Move it, or write " + f"if_probe_enabled({k})=0",
                )  # fmt: skip
                break
