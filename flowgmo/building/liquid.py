"""&FL -> the liquid at the start."""

from __future__ import annotations

import numpy as np

from flowgmo.bodies.body import Body
from flowgmo.building.findings import Findings
from flowgmo.building.liquid_in_bodies import check_liquid_in_bodies
from flowgmo.building.shapes import build_limits, build_mesh, build_quadric, build_transform
from flowgmo.deck import Deck
from flowgmo.flow_plan import LiquidRegion, LiquidStart
from flowgmo.geometry import Component, GeometryError, Piece
from flowgmo.mesh import PRESSURE, VELOCITY, Mesh


def build_start(found: Findings, mesh: Mesh, bodies: tuple[Body, ...], void_pressure: float) -> LiquidStart:
    """The liquid at t = 0. Problems: regions without a shape or outside the mesh, more liquid than space, none, or none
    outside of the bodies. Notice: a height above the mesh."""
    deck = found.deck
    mode = int(deck["IFLINITTYP"]) if deck["ITB"] == 1 else 0
    regions = [_region(found, r, mesh, void_pressure) for r in _switched_on(deck)]
    start = LiquidStart(
        height=float(deck["FLHT"]) if mode == 1 else None,
        volume=float(deck["VLIN"]) if mode == 2 else None,
        velocity=_three(deck, "UI", "VI", "WI"),
        pressure=float(deck["PRESI"]) - void_pressure,
        regions=tuple(region for region in regions if region is not None),
        hydrostatic=deck["IPDIS"] == 1,
    )
    top = float(mesh.bounds[1, 2])
    if start.height is not None and start.height > top:
        found.notice("FLHT", wrong=f"this lies above the mesh, which ends at z = {top:.6g}: it is full to its top")
    space = float(np.prod(np.ptp(mesh.bounds, axis=0)))
    if start.volume is not None and start.volume > space:
        found.problem("VLIN", wrong=f"the domain holds {space:.6g} only", write="Write a smaller volume")
    if deck["ITB"] == 1 and not found.problems:
        entering = _enters(deck, mesh)
        if not entering and not _any_liquid(start, mesh):
            found.problem(
                "RHOF", wrong="there is no liquid at the start, and no side of the domain brings any",
                write="Write flht=... in &fl (or vlin, or a region, or itb=0 for a domain full of liquid)",
            )  # fmt: skip
        places = [_place(deck, r) for r in _switched_on(deck)]
        check_liquid_in_bodies(found, mesh, bodies, start, places, entering)
    return start


def _switched_on(deck: Deck) -> list[int]:
    """Numbers of the regions that count."""
    return [r for r in range(1, int(deck["NFLS"]) + 1) if deck.at("IF_FLREG_ENABLED", r)]


def _three(deck: Deck, *names_and_index: str | int) -> np.ndarray:
    names = [name for name in names_and_index if isinstance(name, str)]
    index = [k for k in names_and_index if not isinstance(k, str)]
    return np.array([deck.at(name, *index) for name in names], dtype=float)


def _region(found: Findings, r: int, mesh: Mesh, void_pressure: float) -> LiquidRegion | None:
    deck = found.deck
    name = str(deck.at("FLUIDREGIONNAME", r) or "").strip() or f"region {r}"
    place, stl = _place(deck, r), None
    if deck.at("IFDIS", r) == -1 and (stl := build_mesh(found, "FFSTL", r)) is None:
        return None
    try:
        piece = Piece(
            limits=build_limits(deck, "F", r), quadric=build_quadric(deck, "F", r), stl=stl,
            transform=build_transform(deck, "F", r), name=name,
        )  # fmt: skip
        shape = Component([piece])
        bounds = shape.bounds()
    except GeometryError as error:
        found.problem(*place, wrong=f"{name} of the liquid has no usable shape: {error}", write="Correct its limits")
        return None
    if not ((bounds[0] < mesh.bounds[1]) & (bounds[1] > mesh.bounds[0])).all():
        axis = int(np.argmin((bounds[0] < mesh.bounds[1]) & (bounds[1] > mesh.bounds[0])))
        (lo, hi), (first, last) = bounds[:, axis], mesh.bounds[:, axis]
        found.problem(
            *place, wrong=f"{name} of the liquid lies outside the mesh: {'xyz'[axis]} = {lo:.6g} to {hi:.6g}, the mesh "
            f"spans {first:.6g} to {last:.6g}", write="Move it, or remove it",
        )  # fmt: skip
        return None
    return LiquidRegion(
        shape=shape,
        adds=deck.at("FIOH", r) == 1,
        fraction=float(deck.at("FREG", r)),
        velocity=_three(deck, "UREG", "VREG", "WREG", r),
        pressure=float(deck.at("PREG", r)) - void_pressure,
        name=name,
    )


def _place(deck: Deck, r: int) -> tuple:
    """The variable of a region that the deck gives first; NFLS when it gives none."""
    limits = [f"F{axis}{end}" for axis in ("X", "Y", "Z", "RA", "RS", "ANGL", "CONE") for end in "LH"]
    rest = ["FCC", *(f"F{stem}" for stem in ("CX", "CY", "CZ", "CXY", "CXZ", "CYZ", "CX2", "CY2", "CZ2", "CRXY"))]
    moved = [f"F{stem}{axis}" for stem in ("TRN", "ROT", "MAGN") for axis in "XYZ"]
    given = [name for name in ("FFSTL", *limits, *rest, *moved) if deck.given(name, r)]
    return (min(given, key=lambda name: deck.where(name, r).line), r) if given else ("NFLS",)


def _any_liquid(start: LiquidStart, mesh: Mesh) -> bool:
    """Whether liquid stands somewhere at the start."""
    if start.height is not None and start.height > mesh.bounds[0, 2] or (start.volume or 0.0) > 0.0:
        return True
    return any(region.adds and region.fraction > 0.0 for region in start.regions)


def _enters(deck: Deck, mesh: Mesh) -> bool:
    """Whether liquid may come in through a side later."""
    for side in mesh.sides:
        if side.kind in (PRESSURE, VELOCITY):
            table = "FLHTBCT" if deck.at("IHPBCT", side.number + 1) else "FBCT"
            least = mesh.bounds[0, 2] if table == "FLHTBCT" else 0.0
            if deck.series(table, side.number + 1).y.max() > least:
                return True
    return False
