"""Rules of the mass data: a coupled body has them, once, and they belong to a possible body."""

from collections.abc import Iterator

import numpy as np

from .deck import Deck
from .errors import Notice, Problem
from .rules_bodies import components, subcomponents

CENTRE = ("XMCMVB0", "YMCMVB0", "ZMCMVB0")
ROUND_OFF = 1e-6  # moments of a flat body fulfil the triangle rule just so; decks carry six digits


def _heavy(deck: Deck) -> set[int]:
    """Components with a density, their own or a subcomponent's."""
    solid = [n for n in subcomponents(deck) if deck.at("IOH", n) and deck.at("RHOSUB", n) > 0]
    return {deck.at("IOB", n) for n in solid} | {m for m in components(deck) if deck.at("RHOMVB", m) > 0}


def densities(deck: Deck) -> Iterator[Problem]:
    """With IPRPMVB=0 a coupled body has a density, its own or its subcomponents'."""
    heavy = _heavy(deck)
    for m in components(deck):
        if deck.at("IPRPMVB", m) != 0 or m in heavy:
            continue
        if deck.given("MASSMVB", m):
            wrong = f"the mass is not used with iprpmvb({m})=0"
            yield deck.problem("MASSMVB", m, wrong=wrong, write=f"Write iprpmvb({m})=1")
        elif deck.at("IMO", m) == 4:
            wrong = f"component {m} moves freely (imo({m})=4) and has no density"
            write = f"Write rhomvb({m})=..., or iprpmvb({m})=1 with its mass"
            yield deck.problem("RHOMVB", m, wrong=wrong, write=write)


def integrated(deck: Deck) -> Iterator[Problem]:
    """With IPRPMVB=1 a coupled body has mass, centre, and inertia; a driven one has all of them or no mass."""
    for m in components(deck):
        moves = deck.at("IMO", m) == 4 or (deck.at("IMO", m) == 3 and deck.given("MASSMVB", m))
        if not moves or deck.at("IPRPMVB", m) != 1:
            continue
        needed = [("MASSMVB", (m,)), *((name, (m,)) for name in CENTRE)]
        if deck.at("IMOAXS", m) in (1, 2, 3):
            needed.append(("TJAXS", (m,)))
        else:
            needed += [("TJMVB", (m, i, i)) for i in (1, 2, 3)]
        for name, index in needed:
            if not deck.given(name, *index):
                wrong = f"the value is missing; iprpmvb({m})=1 says that mass data are given"
                element = f"{name.lower()}({','.join(map(str, index))})"
                write = f"Write {element}=..., or iprpmvb({m})=0 with rhomvb"
                yield deck.problem(name, *index, wrong=wrong, write=write)


def once(deck: Deck) -> Iterator[Problem]:
    """Mass data are given in one way."""
    heavy = _heavy(deck)
    for m in components(deck):
        if deck.given("MASSMVB", m) and m in heavy:
            wrong = f"the deck gives both a mass and a density of component {m}"
            write = f"Keep one: rhomvb, rhosub with iprpmvb({m})=0, or massmvb with iprpmvb({m})=1"
            yield deck.problem("MASSMVB", m, wrong=wrong, write=write)


def tensors(deck: Deck) -> Iterator[Problem | Notice]:
    """A given inertia tensor is symmetric, positive definite, and that of a body."""
    for m in sorted({index[0] for index in deck.indices("TJMVB")}):
        if not all(deck.given("TJMVB", m, i, i) for i in (1, 2, 3)):
            continue
        tensor = np.array([[deck.at("TJMVB", m, i, j) for j in (1, 2, 3)] for i in (1, 2, 3)])
        for i, j in ((1, 2), (1, 3), (2, 3)):
            # 1e-9: the two may differ by what printing them with ten digits leaves
            if abs(tensor[i - 1, j - 1] - tensor[j - 1, i - 1]) > 1e-9 * np.abs(tensor).max():
                wrong = f"the tensor is not symmetric, tjmvb({m},{j},{i})={tensor[j - 1, i - 1]:g}"
                yield deck.problem("TJMVB", m, i, j, wrong=wrong, write="Give both the same value, or one of them only")
                break
        else:
            largest = np.abs(tensor).max()
            moments = np.linalg.eigvalsh(tensor / largest) if largest > 0 else np.zeros(3)
            if moments[0] <= 0:
                wrong = "the tensor is not positive definite"
                yield deck.problem("TJMVB", m, 1, 1, wrong=wrong, write="Give moments of inertia above 0")
            elif moments[0] + moments[1] < moments[2] * (1 - ROUND_OFF):
                wrong = "no body has such a tensor: one principal moment is larger than the two others together"
                yield deck.notice("TJMVB", m, 1, 1, wrong=wrong)


RULES = (densities, integrated, once, tensors)
