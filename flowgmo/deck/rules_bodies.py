"""Rules of components and their geometry."""

import re
from collections.abc import Iterator

from .deck import Deck
from .errors import Problem
from .variables import REGISTRY

NAME = re.compile(r"(?=.*[A-Za-z0-9])[A-Za-z0-9_.-]+")  # becomes a group of the HDF5 files, so not '.' alone
PAIRS = tuple((f"{axis}L", f"{axis}H") for axis in ("X", "Y", "Z", "RA", "RS", "ANGL", "CONE"))


def components(deck: Deck) -> list[int]:
    """Numbers of the components that are switched on."""
    return [m for m in range(1, deck["NOBS"] + 1) if deck.at("IFCOMPENABLED", m)]


def subcomponents(deck: Deck) -> list[int]:
    """Numbers of the subcomponents that the deck describes and that are switched on."""
    described = {n for name in _of_subcomponents() for (n,) in deck.indices(name)}
    return [n for n in sorted(described) if deck.at("IFSUBCOMPENABLED", n)]


def _of_subcomponents() -> list[str]:
    return [row.name for row in REGISTRY.values() if row.shape == ("n",)]


def numbers(deck: Deck) -> Iterator[Problem]:
    """No component beyond NOBS is described; one Problem for each that is."""
    if "NOBS" in deck.broken:
        return
    beyond: dict[int, tuple[str, tuple[int, ...]]] = {}
    for row in REGISTRY.values():
        if row.block not in ("OBS", "FLOWGMO") or "m" not in row.shape:
            continue
        places = [place for place, letter in enumerate(row.shape) if letter == "m"]
        for index in deck.indices(row.name):
            for m in (index[place] for place in places):
                if m > deck["NOBS"]:
                    beyond.setdefault(m, (row.name, index))
    for m, (name, index) in sorted(beyond.items()):
        wrong = f"there is no component {m}, nobs={deck['NOBS']}"
        yield deck.problem(name, *index, wrong=wrong, write=f"Write nobs={max(beyond)}, or remove the component")


def membership(deck: Deck) -> Iterator[Problem]:
    """Every subcomponent belongs to a component, and every component has a solid one."""
    if "NOBS" in deck.broken or "IOB" in deck.broken:
        return
    solid: set[int] = set()
    for n in subcomponents(deck):
        m = deck.at("IOB", n)
        if not 1 <= m <= deck["NOBS"]:
            wrong = f"subcomponent {n} belongs to no component (nobs={deck['NOBS']})"
            write = f"Write iob({n})=m, m the number of its component"
            place = "IOB" if deck.given("IOB", n) else next(v for v in _of_subcomponents() if deck.given(v, n))
            yield deck.problem(place, n, wrong=wrong, write=write)
        elif deck.at("IOH", n) != 0:
            solid.add(m)
    for m in components(deck):
        if m not in solid and not deck.at("IVRT", m):
            wrong = f"component {m} has no solid subcomponent"
            write = f"Write iob(n)={m} for a subcomponent n with limits or a quadric, or lower nobs"
            yield deck.problem("OBSID", m, wrong=wrong, write=write)


def limits(deck: Deck) -> Iterator[Problem]:
    """Lower limits lie below upper ones."""
    for n in subcomponents(deck):
        for low, high in PAIRS:
            below, above = deck.at(low, n), deck.at(high, n)
            if below >= above:
                wrong = f"the lower limit is not below {high.lower()}({n})={above:g}"
                yield deck.problem(low, n, wrong=wrong, write=f"Give {low.lower()}({n}) < {high.lower()}({n})")
        inner, outer = deck.at("RTORIN", n), deck.at("RTOROUT", n)
        if (inner >= 0 or outer >= 0) and inner >= outer:
            wrong = f"the inner radius of the torus is not below rtorout({n})={outer:g}"
            yield deck.problem("RTORIN", n, wrong=wrong, write=f"Give rtorin({n}) < rtorout({n})")


def files(deck: Deck) -> Iterator[Problem]:
    """STL files exist."""
    for n in subcomponents(deck):
        if deck.at("IGEN", n) == 3:
            yield from missing_file(deck, "FSTL", n)


def missing_file(deck: Deck, variable: str, n: int) -> Iterator[Problem]:
    """A Problem where the STL file that a variable names is not there."""
    name = deck.at(variable, n)
    try:
        there = bool(name) and (deck.path.parent / name).is_file()
    except (OSError, ValueError):
        there = False
    if not there:
        wrong = f"there is no file {name} beside the deck"
        yield deck.problem(variable, n, wrong=wrong, write="Give an STL file by its path from the deck's folder")


def names(deck: Deck) -> Iterator[Problem]:
    """Names of components can stand in results, and differ."""
    taken: dict[str, int] = {}
    for m in range(1, deck["NOBS"] + 1):
        name = deck.at("OBSID", m)
        if name and not NAME.fullmatch(name):
            plain = re.sub(r"[^A-Za-z0-9_.-]+", "_", name).strip("_") or f"obs{m}"
            wrong = "a name has letters, digits and _ . - only"
            yield deck.problem("OBSID", m, wrong=wrong, write=f"Write obsid({m})='{plain}'")
        key = (name or f"obs{m}").lower()
        if key in taken:
            wrong = f"component {taken[key]} has this name already (large and small letters are the same)"
            yield deck.problem("OBSID", m, wrong=wrong, write="Give every component its own name")
        taken.setdefault(key, m)


RULES = (numbers, membership, limits, files, names)
