"""Components and subcomponents of &OBS -> geometry."""

from __future__ import annotations

import numpy as np

from flowgmo.building.findings import Findings
from flowgmo.deck import Deck
from flowgmo.geometry import Component, GeometryError, Limits, Piece, Quadric, StlMesh, Torus, Transform, read_stl

ROLES = {1: "solid", 0: "hole", -1: "complement"}
COEFFICIENTS = ("CC", "CX", "CY", "CZ", "CXY", "CXZ", "CYZ", "CX2", "CY2", "CZ2", "CRXY")


def build_shape(found: Findings, m: int) -> Component | None:
    """The shape of component m in space at t = 0; None, with a problem, if it cannot be made."""
    deck = found.deck
    numbers = [n for (n,) in deck.indices("IOB") if deck.at("IOB", n) == m and deck.at("IFSUBCOMPENABLED", n)]
    pieces = [piece for n in numbers if (piece := _piece(found, n)) is not None]
    if len(pieces) < len(numbers):
        return None
    try:
        return Component(pieces, build_transform(deck, "G", m))
    except GeometryError as error:
        found.problem(
            "IOB", numbers[0], wrong=f"component {m} has no usable shape: {error}", write="Correct its subcomponents"
        )
        return None


def _piece(found: Findings, n: int) -> Piece | None:
    deck = found.deck
    stl = None
    if deck.at("IGEN", n) == 3:
        stl = build_mesh(found, "FSTL", n)
        if stl is None:
            return None
    density = float(deck.at("RHOSUB", n)) if deck.given("RHOSUB", n) else None
    inner, outer = deck.at("RTORIN", n), deck.at("RTOROUT", n)
    return Piece(
        role=ROLES[int(deck.at("IOH", n))],
        limits=build_limits(deck, "", n),
        quadric=build_quadric(deck, "", n),
        torus=Torus(float(inner), float(outer)) if (outer or -1.0) > 0.0 else None,
        stl=stl,
        transform=build_transform(deck, "", n),
        density=density,
        name=str(deck.at("SUBCMPID", n) or n),
    )


def build_limits(deck: Deck, prefix: str, n: int) -> Limits:
    """Limiters of subcomponent n (prefix ''), or of region n of the liquid ('F'); None where unbounded."""

    def bound(name: str) -> float | None:
        value = deck.at(name, n) if deck.given(name, n) else None
        return None if value is None or not np.isfinite(value) else float(value)

    def pair(stem: str) -> tuple[float | None, float | None]:
        return bound(f"{prefix}{stem}L"), bound(f"{prefix}{stem}H")

    return Limits(
        x=pair("X"),
        y=pair("Y"),
        z=pair("Z"),
        radius=pair("RA"),
        sphere=pair("RS"),
        angle=pair("ANGL"),
        cone=pair("CONE"),
    )


def build_quadric(deck: Deck, prefix: str, n: int) -> Quadric | None:
    """The quadric of a subcomponent or region; None where only limiters act: a constant that holds everywhere."""
    values = [float(deck.at(f"{prefix}{name}", n)) for name in COEFFICIENTS]
    if not any(values[1:]) and values[0] <= 0.0:
        return None
    return Quadric(*values)


def build_transform(deck: Deck, prefix: str, k: int) -> Transform:
    """Magnify, rotate, translate of a subcomponent (prefix ''), a component ('G'), or a region of the liquid ('F')."""

    def three(stem: str) -> tuple[float, float, float]:
        return tuple(float(deck.at(f"{prefix}{stem.replace('*', axis)}", k)) for axis in "XYZ")

    return Transform(
        magnify=float(deck.at(f"{prefix}MAGN", k)),
        magnify_axes=three("MAGN*"),
        rotate=three("ROT*"),
        translate=three("TRN*"),
        centre=three("*TRFC"),
    )


def build_mesh(found: Findings, variable: str, n: int) -> StlMesh | None:
    """The mesh of the file that a subcomponent (FSTL) or a region of the liquid (FFSTL) names; None, with a problem, if
    it is no closed surface."""
    deck = found.deck
    try:
        mesh = read_stl(deck.path.parent / str(deck.at(variable, n)))
    except GeometryError as error:
        found.problem(variable, n, wrong=str(error), write="Repair the file, or name another one")
        return None
    for text in mesh.notices:
        found.notice(variable, n, wrong=text)
    return mesh
