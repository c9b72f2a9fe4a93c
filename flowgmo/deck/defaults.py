"""Values of variables that a deck does not give.

A row's default is a literal, an expression in one other variable (`TWFIN/1000`, `RHOMVB(m)`), or `@name`, a function
of this file. The first line of such a function's docstring is the default in words.
"""

import math
import re
from collections.abc import Callable
from functools import cache
from typing import Protocol

from .row import Row, Value, literal


class Values(Protocol):
    """What a default may look at: the deck."""

    def __getitem__(self, name: str) -> Value: ...
    def at(self, name: str, *index: int) -> Value: ...
    def given(self, name: str, *index: int) -> bool: ...
    def indices(self, name: str) -> list[tuple[int, ...]]: ...


Default = Callable[[Values, Row, tuple[int, ...]], Value | None]

# The dimensional defaults of the format, by UNITS: standard atmosphere and air at 15 C; slug, foot, second for 'eng'.
ATMOSPHERE = {"si": 101325.0, "cgs": 1013250.0, "eng": 2116.22}
AIR = {"si": 1.225, "cgs": 1.225e-3, "eng": 2.3769e-3}
FREEZING = {"c": 0.0, "k": 273.15, "f": 32.0, "r": 491.67}


def delt(deck: Values, _row: Row, _index: tuple[int, ...]) -> float:
    """TWFIN/1000 (TWFIN/10000 when IFIN=2)"""
    return deck["TWFIN"] / (10000 if deck["IFIN"] == 2 else 1000)


def consft(deck: Values, _row: Row, _index: tuple[int, ...]) -> float:
    """1.0, with implicit surface tension 2.5"""
    return 2.5 if deck["IMPSFT"] else 1.0


def omega(deck: Values, _row: Row, _index: tuple[int, ...]) -> float:
    """1.0, with IGMRES=0 1.7, with IGMRES=2 along all lines 2.0"""
    if deck["IGMRES"] == 0:
        return 1.7
    return 2.0 if deck["IGMRES"] == 2 and all(deck[f"IADI{axis}"] for axis in "XYZ") else 1.0


def cdis1(deck: Values, _row: Row, _index: tuple[int, ...]) -> float:
    """1.44, with IFVIS=4 1.42"""
    return 1.42 if deck["IFVIS"] == 4 else 1.44


def rmtke(deck: Values, _row: Row, _index: tuple[int, ...]) -> float:
    """1.0, with IFVIS=4 1.39"""
    return 1.39 if deck["IFVIS"] == 4 else 1.0


def rmdtke(deck: Values, _row: Row, _index: tuple[int, ...]) -> float:
    """0.77, with IFVIS=4 1.39"""
    return 1.39 if deck["IFVIS"] == 4 else 0.77


def itmax(deck: Values, _row: Row, _index: tuple[int, ...]) -> int:
    """1000, 100, 200 for IGMRES 0, 1, 2"""
    return (1000, 100, 200)[deck["IGMRES"]]


def itdtmx(deck: Values, _row: Row, _index: tuple[int, ...]) -> int:
    """50/(1+IADIX+IADIY+IADIZ), with IGMRES=1 and IMPMOB=0 10"""
    if deck["IGMRES"] == 1 and deck["IMPMOB"] == 0:
        return 10
    return 50 // (1 + deck["IADIX"] + deck["IADIY"] + deck["IADIZ"])


def itvsmx(deck: Values, _row: Row, _index: tuple[int, ...]) -> int:
    """20, with IMPVIS=3 100"""
    return 100 if deck["IMPVIS"] == 3 else 20


def atmosphere(deck: Values, _row: Row, _index: tuple[int, ...]) -> float | None:
    """one atmosphere in the deck's UNITS"""
    return ATMOSPHERE.get(deck["UNITS"].lower())


def rhoair(deck: Values, _row: Row, _index: tuple[int, ...]) -> float | None:
    """1.225 kg/m3 in the deck's UNITS"""
    return AIR.get(deck["UNITS"].lower())


def freezing(deck: Values, _row: Row, _index: tuple[int, ...]) -> float | None:
    """0 C in the deck's TUNITS"""
    return FREEZING.get(deck["TUNITS"].lower())


def outside(deck: Values, _row: Row, _index: tuple[int, ...]) -> float | None:
    """0.0, with IPGAUGE=0 P_REFERENCE"""
    return deck["P_REFERENCE"] if deck["IPGAUGE"] == 0 else 0.0


def liquid(deck: Values, _row: Row, _index: tuple[int, ...]) -> int:
    """1 where FLHT is given, else 2 where VLIN is, else 0"""
    return 1 if deck.given("FLHT") else 2 if deck.given("VLIN") and deck["VLIN"] > 0 else 0


def unbounded(_deck: Values, row: Row, _index: tuple[int, ...]) -> float:
    """unbounded"""
    return -math.inf if row.name.endswith(("L", "MN")) else math.inf


def stl(_deck: Values, _row: Row, index: tuple[int, ...]) -> str:
    """stlf<nn>.inp, nn the subcomponent"""
    return f"stlf{index[0]:02d}.inp"


def inertia(deck: Values, row: Row, index: tuple[int, ...]) -> float | None:
    """off the diagonal the mirrored element if given, else 0; unset on the diagonal"""
    m, i, j = index
    if i == j:
        return None
    return deck.at(row.name, m, j, i) if deck.given(row.name, m, j, i) else 0.0


def axis(deck: Values, row: Row, index: tuple[int, ...]) -> float | None:
    """the axis that IMOAXS names, unless another component is given"""
    direction = deck.at("IMOAXS", *index)
    if direction not in (1, 2, 3):
        return None
    if direction == 1 and any(deck.given(f"AXIS{letter}", *index) for letter in "XYZ"):
        return 0.0
    return 1.0 if "XYZ"[direction - 1] == row.name[-1] else 0.0


def plane(deck: Values, row: Row, index: tuple[int, ...]) -> float | None:
    """0.0 for the first plane, the second 1.0 beyond it"""
    if index[0] == 1:
        return 0.0
    return deck.at(row.name, 1) + 1.0 if index[0] == 2 else None


def cells(deck: Values, row: Row, _index: tuple[int, ...]) -> int:
    """what NXCELL, SIZEX, SIZE, or NTOTAL ask for, at least 1 between two planes"""
    letter = row.name[1]
    if counts := deck.indices(f"N{letter}CELL"):
        return sum(deck.at(f"N{letter}CELL", *index) for index in counts)
    size = deck["SIZE"] if deck["IF_SIZE"] == 1 else _size_of_total(deck)
    planes = max((index[0] for index in deck.indices(f"P{letter}")), default=2)
    total = 0
    for n in range(1, max(planes, 2)):
        ends = [deck.at(f"SIZE{letter}", k) for k in (n, n + 1) if deck.given(f"SIZE{letter}", k)]
        wanted = sum(ends) / len(ends) if ends else size
        start, end = deck.at(f"P{letter}", n), deck.at(f"P{letter}", n + 1)
        parts = (end - start) / wanted if wanted and end is not None and end > start else 1.0
        total += max(1, round(min(parts, 2**31 - 1)))
    return total


def _extent(deck: Values, letter: str) -> float:
    last = max((index[0] for index in deck.indices(f"P{letter}")), default=2)
    end, start = deck.at(f"P{letter}", max(last, 2)), deck.at(f"P{letter}", 1)
    return max(0.0, end - start) if end is not None else 0.0


def _size_of_total(deck: Values) -> float:
    """Edge of a cubic cell of which NTOTAL fill the domain."""
    volume = math.prod(_extent(deck, letter) for letter in "XYZ")
    return (volume / deck["NTOTAL"]) ** (1 / 3) if deck["NTOTAL"] else 0.0


NAMED: dict[str, Default] = {
    f.__name__: f
    for f in (
        *(delt, consft, omega, cdis1, rmtke, rmdtke, itmax, itdtmx, itvsmx, atmosphere, rhoair, freezing),
        *(outside, liquid, unbounded, stl, inertia, axis, plane, cells),
    )
}


def _of_component(deck: Values, name: str, row: Row, index: tuple[int, ...]) -> Value | None:
    """A component's value for one of its subcomponents."""
    m = deck.at("IOB", index[0]) if row.shape == ("n",) else index[0]
    return deck.at(name, m) if m >= 1 else literal("0.0", row.type)


@cache
def compiled(text: str, kind: str) -> Default:
    """The function that a default stands for."""
    if text.startswith("@"):
        return NAMED[text[1:]]
    match = re.fullmatch(r"([A-Z]\w*)(\(m\))?(?:([*/])(\S+))?", text)
    if not match:
        constant = literal(text, kind)
        return lambda deck, row, index: constant
    name, of_component, operator, number = match.groups()
    if of_component:
        return lambda deck, row, index: _of_component(deck, name, row, index)
    if operator:
        factor = float(number)
        return lambda deck, row, index: deck[name] * factor if operator == "*" else deck[name] / factor
    return lambda deck, row, index: deck[name]


def default_of(deck: Values, row: Row, index: tuple[int, ...]) -> Value | None:
    """The value of an element that the deck does not set; None when it stays unset."""
    return compiled(row.default, row.type)(deck, row, index)


def default_text(row: Row) -> str:
    """The default in words, for `explain` and the reference page."""
    if row.default.startswith("@"):
        return (NAMED[row.default[1:]].__doc__ or "").splitlines()[0]
    return {"-": "none", "''": "blank"}.get(row.default, row.default)
