"""Rules of time and output control, and of all tables of time."""

from collections.abc import Iterator

from .deck import Deck
from .errors import DeckError, Notice, Problem
from .variables import REGISTRY


def steps(deck: Deck) -> Iterator[Problem]:
    """DTMIN <= DELT <= TWFIN; that they are positive is checked one by one."""
    if deck.given("DELT") and deck["DELT"] > deck["TWFIN"]:
        wrong = f"the first step is longer than the run, twfin={deck['TWFIN']:g}"
        yield deck.problem("DELT", wrong=wrong, write=f"Write delt={deck['TWFIN'] / 1000:g}, or remove it")
    if deck["DTMIN"] > deck["DELT"]:
        wrong = f"the smallest step is larger than the first one, delt={deck['DELT']:g}"
        yield deck.problem("DTMIN", wrong=wrong, write=f"Write dtmin={deck['DELT'] * 1e-5:g}, or remove it")


def intervals(deck: Deck) -> Iterator[Problem]:
    """The end times of intervals increase."""
    for name in ("TEDIT", "TEDITDT"):
        ends = [(k, deck.at(name, k)) for (k,) in deck.indices(name)]
        for (_, before), (k, end) in zip(ends, ends[1:], strict=False):
            if end <= before:
                wrong = f"the interval ends at {end:g}, not after the one before it ({before:g})"
                yield deck.problem(name, k, wrong=wrong, write="Let the end times increase")


def times(deck: Deck) -> Iterator[Problem]:
    """The times of tables are complete and increase."""
    for name in sorted({row.time for row in REGISTRY.values() if row.time}):
        given = {t for (t,) in deck.indices(name)}
        last = max(given, default=0)
        for t in range(2, last + 1):
            if t not in given:
                wrong = f"this time is missing, {name.lower()}({last}) is given"
                yield deck.problem(name, t, wrong=wrong, write=f"Give {name.lower()}(1) to {name.lower()}({last})")
            elif (t - 1 in given or t == 2) and deck.at(name, t) <= deck.at(name, t - 1):
                wrong = f"the time does not come after {name.lower()}({t - 1})={deck.at(name, t - 1):g}"
                yield deck.problem(name, t, wrong=wrong, write="Let the times increase")


def tables(deck: Deck) -> Iterator[Problem]:
    """Every table of time has as many values as times, and every table file can be read."""
    for row in REGISTRY.values():
        if not row.time or row.cls != "computed":
            continue
        for index in deck.tabled(row.name):
            try:
                deck.series(row.name, *index)
            except DeckError as error:
                yield from error.problems


def old_names(deck: Deck) -> Iterator[Notice]:
    """MUI stands for MU1 where MU1 is not given."""
    if deck.given("MUI") and not deck.given("MU1"):
        yield deck.notice("MUI", wrong="old name, read as mu1")


RULES = (steps, intervals, times, tables, old_names)
