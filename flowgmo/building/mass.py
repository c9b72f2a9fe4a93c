"""Mass, mass centre and inertia of a component: integrated from its shape, or given."""

from __future__ import annotations

import numpy as np

from flowgmo.bodies.body import FIXED_AXIS, MassData
from flowgmo.building.findings import Findings
from flowgmo.deck import Deck
from flowgmo.geometry import Component, GeometryError, check_inertia


def build_mass(found: Findings, m: int, shape: Component, constraint: str) -> tuple[MassData | None, bool]:
    """Mass data of component m (None where the deck gives none), and whether they are sound."""
    deck = found.deck
    if deck.at("IPRPMVB", m) == 1:
        return _given(found, m, constraint)
    density = float(deck.at("RHOMVB", m))
    if density <= 0.0 and not any(p.density for p in shape.pieces if p.role != "hole"):
        return None, True
    try:
        whole = shape.mass_properties(density)
    except GeometryError as error:
        found.problem(
            "RHOMVB", m,
            wrong=f"the mass cannot be integrated from the shape: {error}",
            write=f"Close the shape with limiters, or give the mass: iprpmvb({m})=1, massmvb({m})=...",
        )  # fmt: skip
        return None, False
    if not _usable(whole.mass, whole.inertia):
        found.problem(
            "RHOMVB", m, wrong=f"the body's mass is {whole.mass:.6g}, with which no motion can be computed",
            write="Give a positive density to every part, or use other units",
        )  # fmt: skip
        return None, False
    return MassData(whole.mass, np.array(whole.centre), np.array(whole.inertia), error=float(whole.error)), True


def _usable(mass: float, inertia: np.ndarray) -> bool:
    """Whether mass and moments are positive, and they and their inverses are numbers."""
    tiny, huge = np.finfo(float).tiny, np.finfo(float).max
    return tiny < mass < huge and bool((np.diag(inertia) > tiny).all() and (np.abs(inertia) < huge).all())


def _given(found: Findings, m: int, constraint: str) -> tuple[MassData | None, bool]:
    deck = found.deck
    if deck.at("MASSMVB", m) is None:
        return None, True
    mass = float(deck.at("MASSMVB", m))
    centre = np.array([deck.at(f"{a}MCMVB0", m) for a in "XYZ"], dtype=float)
    if constraint == FIXED_AXIS:
        return MassData(mass, centre, None, axis_moment=float(deck.at("TJAXS", m))), True
    inertia = _tensor(deck, m)
    wrong = check_inertia(mass, inertia)
    if wrong:
        found.problem("TJMVB", m, 1, 1, wrong=wrong, write=f"Give the tensor about the mass centre, tjmvb({m},i,j)")
        return None, False
    return MassData(mass, centre, inertia), True


def _tensor(deck: Deck, m: int) -> np.ndarray:
    """TJMVB (3, 3); an element given on one side of the diagonal only holds on both."""
    tensor = np.zeros((3, 3))
    for i in range(3):
        for j in range(3):
            one, other = (i + 1, j + 1), (j + 1, i + 1)
            use = one if deck.given("TJMVB", m, *one) or not deck.given("TJMVB", m, *other) else other
            tensor[i, j] = float(deck.at("TJMVB", m, *use) or 0.0)
    return 0.5 * (tensor + tensor.T)
