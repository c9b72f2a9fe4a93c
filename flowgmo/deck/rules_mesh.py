"""Rules of the mesh and its six sides."""

from collections.abc import Iterator

from .deck import Deck
from .errors import Problem

SIDES = ("Xmin", "Xmax", "Ymin", "Ymax", "Zmin", "Zmax")


def planes(deck: Deck) -> Iterator[Problem]:
    """Mesh planes are numbered without a gap and their positions increase."""
    for letter in "XYZ":
        name = f"P{letter}"
        given = {n for (n,) in deck.indices(name)}
        last = max(given, default=2)
        for n in range(2, last + 1):
            before, here = deck.at(name, n - 1), deck.at(name, n)
            if here is None:
                wrong = f"this plane is missing, {name.lower()}({last}) is given"
                yield deck.problem(name, n, wrong=wrong, write=f"Give {name.lower()}(1) to {name.lower()}({last})")
            elif before is not None and here <= before:
                wrong = f"the plane at {here:g} does not lie beyond {name.lower()}({n - 1})={before:g}"
                yield deck.problem(name, n, wrong=wrong, write=f"Let {name.lower()} increase")


def cells(deck: Deck) -> Iterator[Problem]:
    """Cells per direction and between planes fit each other."""
    for letter in "XYZ":
        plane, part, total = f"P{letter}", f"N{letter}CELL", f"N{letter}CELT"
        gaps = max((n for (n,) in deck.indices(plane)), default=2) - 1 or 1
        counts = {n: deck.at(part, n) for (n,) in deck.indices(part)}
        for n in (n for n in counts if n > gaps):
            wrong = f"there are {gaps + 1} planes {plane.lower()}, so {gaps} intervals"
            yield deck.problem(part, n, wrong=wrong, write=f"Remove it, or give {plane.lower()}({n + 1})")
        missing = [n for n in range(1, gaps + 1) if n not in counts]
        if counts and missing and not deck.given(total):
            wrong = "the number of cells of this interval is missing"
            yield deck.problem(part, missing[0], wrong=wrong, write=f"Give it for all {gaps} intervals")
        if counts and not missing and deck.given(total) and sum(counts.values()) != deck[total]:
            wrong = f"the intervals have {sum(counts.values())} cells together"
            yield deck.problem(total, wrong=wrong, write=f"Write {total.lower()}={sum(counts.values())}, or remove it")
        if deck.given(total) and deck[total] < gaps:
            wrong = f"there are {gaps} intervals between planes {plane.lower()}"
            yield deck.problem(total, wrong=wrong, write=f"Write {total.lower()}={gaps} or more")


def periodic(deck: Deck) -> Iterator[Problem]:
    """Periodic sides come in pairs."""
    for low in (1, 3, 5):
        pair = (low, low + 1)
        kinds = [deck.at("IBCT", side) for side in pair]
        if kinds.count(4) == 1:
            side, other = pair if kinds[0] == 4 else pair[::-1]
            wrong = f"{SIDES[side - 1]} is periodic and {SIDES[other - 1]} is not"
            yield deck.problem("IBCT", side, wrong=wrong, write=f"Write ibct({other})=4 too, or another type here")


RULES = (planes, cells, periodic)
