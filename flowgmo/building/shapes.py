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
        return Component(pieces, _transform(deck, "G", m))
    except GeometryError as error:
        found.problem(
            "IOB", numbers[0], wrong=f"component {m} has no usable shape: {error}", write="Correct its subcomponents"
        )
        return None


def _piece(found: Findings, n: int) -> Piece | None:
    deck = found.deck
    stl = None
    if deck.at("IGEN", n) == 3:
        stl = _stl(found, n)
        if stl is None:
            return None
    density = float(deck.at("RHOSUB", n)) if deck.given("RHOSUB", n) else None
    inner, outer = deck.at("RTORIN", n), deck.at("RTOROUT", n)
    return Piece(
        role=ROLES[int(deck.at("IOH", n))],
        limits=Limits(
            x=_range(deck, "XL", "XH", n),
            y=_range(deck, "YL", "YH", n),
            z=_range(deck, "ZL", "ZH", n),
            radius=_range(deck, "RAL", "RAH", n),
            sphere=_range(deck, "RSL", "RSH", n),
            angle=_range(deck, "ANGLL", "ANGLH", n),
            cone=_range(deck, "CONEL", "CONEH", n),
        ),
        quadric=_quadric(deck, n),
        torus=Torus(float(inner), float(outer)) if (outer or -1.0) > 0.0 else None,
        stl=stl,
        transform=_transform(deck, "", n),
        density=density,
        name=str(deck.at("SUBCMPID", n) or f"subcomponent {n}"),
    )


def _range(deck: Deck, low: str, high: str, n: int) -> tuple[float | None, float | None]:
    """Limiters as a pair; None where the deck gives none or an infinite one."""

    def bound(name: str) -> float | None:
        value = deck.at(name, n) if deck.given(name, n) else None
        return None if value is None or not np.isfinite(value) else float(value)

    return bound(low), bound(high)


def _quadric(deck: Deck, n: int) -> Quadric | None:
    """None where only limiters act: all coefficients but the constant are zero."""
    values = [float(deck.at(name, n)) for name in COEFFICIENTS]
    if not any(values[1:]):
        return None
    return Quadric(*values)


def _transform(deck: Deck, prefix: str, k: int) -> Transform:
    """Magnify, rotate, translate of a subcomponent (prefix '') or a component ('G')."""

    def three(stem: str) -> tuple[float, float, float]:
        return tuple(float(deck.at(f"{prefix}{stem.replace('*', axis)}", k)) for axis in "XYZ")

    return Transform(
        magnify=float(deck.at(f"{prefix}MAGN", k)),
        magnify_axes=three("MAGN*"),
        rotate=three("ROT*"),
        translate=three("TRN*"),
        centre=three("*TRFC") if not prefix else tuple(float(deck.at(f"G{axis}TRFC", k)) for axis in "XYZ"),
    )


def _stl(found: Findings, n: int) -> StlMesh | None:
    deck = found.deck
    name = deck.at("FSTL", n)
    try:
        mesh = read_stl(deck.path.parent / str(name))
    except GeometryError as error:
        found.problem("FSTL", n, wrong=str(error), write="Repair the file, or name another one")
        return None
    for text in mesh.notices:
        found.notice("FSTL", n, wrong=text)
    return mesh
