"""Checks of a deck as a whole: combinations of variables, and what the deck asks for that flowgmo does not compute.

A rule is a small function of the deck that yields Problems and Notices. All rules run, whatever the others find, so
that a user sees everything at once; what a rule says about a variable that could not even be read is dropped.
"""

from collections.abc import Iterator

from .deck import Deck
from .defaults import default_of
from .errors import Notice, Problem
from .row import Row, Value, show
from .rules_bodies import RULES as BODIES
from .rules_bodies import components
from .rules_fluid import RULES as FLUID
from .rules_fluid import density
from .rules_mass import RULES as MASS
from .rules_mesh import RULES as MESH
from .rules_motion import RULES as MOTION
from .rules_time import RULES as TIME
from .rules_units import RULES as UNITS
from .rules_wet_bodies import RULES as WET_BODIES
from .store import Index
from .variables import REGISTRY

IGNORE = "or run without it by &flowgmo ignore_unsupported=.true."


def check(deck: Deck) -> tuple[list[Problem], list[Notice]]:
    """All that the rules find."""
    findings = [*not_computed(deck), *several_meshes(deck), *periodic_bodies(deck)]
    findings += [*density(deck)]
    if deck["IGNORE_UNSUPPORTED"]:
        findings = [Notice(*vars(finding).values()) for finding in findings]
        _switch_off(deck)
    for rule in (*TIME, *UNITS, *MESH, *BODIES, *MOTION, *MASS, *((*FLUID, *WET_BODIES) if deck.given("RHOF") else ())):
        findings += rule(deck)
    problems = [f for f in findings if isinstance(f, Problem)]
    notices = [f for f in findings if not isinstance(f, Problem)]
    return [p for p in problems if p.variable.partition("(")[0].partition("=")[0].upper() not in deck.broken], notices


def _asked(deck: Deck, row: Row) -> list[Index]:
    """The elements with a value that is known but not computed. A value equal to the default never is."""
    if row.cls not in ("known", "computed") or row.switch or (row.cls == "computed" and not row.not_yet):
        return []
    if row.needs == "liquid" and not deck.given("RHOF"):
        return []  # acts on liquid alone, and there is none
    found = []
    for index in deck.indices(row.name):
        value = deck.at(row.name, *index)
        off = default_of(deck, row, index)
        if value in row.not_yet or (row.cls == "known" and value != off):
            found.append(index)
    return found


def not_computed(deck: Deck) -> Iterator[Problem]:
    """One Problem for each variable that asks for something flowgmo knows and does not compute."""
    for row in REGISTRY.values():
        if not (asked := _asked(deck, row)):
            continue
        index = asked[0]
        off = default_of(deck, row, index)
        more = f" (and {len(asked) - 1} more)" if len(asked) > 1 else ""
        element = row.name.lower() + (f"({','.join(map(str, index))})" if index else "")
        instead = _instead(row, element, off)
        wrong = f"known but not computed{more}: {row.meaning}"
        yield deck.problem(row.name, *index, wrong=wrong, write=f"{instead}, {IGNORE}")


def _instead(row: Row, element: str, off: Value | None) -> str:
    """The values that are computed, where some of a list are; else the one that switches it off."""
    computed = [show(value) for value in row.allowed or () if value not in row.not_yet] if row.not_yet else []
    if len(computed) > 1:
        return f"Write {element}={', '.join(computed[:-1])} or {computed[-1]}"
    return f"Write {element}={show(off)}" if off is not None else "Remove it"


def several_meshes(deck: Deck) -> Iterator[Problem]:
    """More than one mesh block."""
    for line in deck.mesh_lines[1:2]:
        wrong = f"known but not computed: {len(deck.mesh_lines)} mesh blocks"
        yield Problem(str(deck.path), line, "MESH", "", wrong, f"Keep one, {IGNORE}")


def periodic_bodies(deck: Deck) -> Iterator[Problem]:
    """Bodies do not come in again on the other side of a periodic domain."""
    moving = any(deck.at("IMO", m) in (3, 4) for m in components(deck))
    side = next((side for side in range(1, 7) if deck.at("IBCT", side) == 4), None)
    if moving and side:
        wrong = "known but not computed: moving bodies with periodic sides; they would leave the domain"
        yield deck.problem("IBCT", side, wrong=wrong, write=f"Write ibct({side})=1, or 3 to let bodies leave, {IGNORE}")


def _switch_off(deck: Deck) -> None:
    """Let the defaults hold in place of what is not computed."""
    for row in REGISTRY.values():
        for index in _asked(deck, row):
            deck.drop(row.name, *index)
