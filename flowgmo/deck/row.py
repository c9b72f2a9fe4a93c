"""One row of the registry: everything flowgmo knows about one deck variable.

Rows are written as lines of text, one per variable or family of variables, because a table is easier to read and to
compare with the manual than six hundred constructor calls:

    = computed, needs liquid
    NAME [NAME..] | type | shape | default | unit | allowed | sources | meaning

shape    index letters, outermost first as in the deck; `t:TOBS` names the table of times. Empty for a scalar.
default  a literal; `-` unset; `TWFIN/1000`, `RHOMVB(m)` another variable's value; `@name` a function of `defaults.py`.
allowed  `> 0`, `>= 0`, `0..1`, `1..` or a list of values. A starred value is part of the format but not computed.
meaning  may hold {axis} and {side}, filled for families of two, three, or six names.
"""

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

Value = int | float | str | bool

# letter: what the index counts, largest value. The limits are the format's own (500 components and so on).
INDEX = {
    "m": ("component", 500),
    "n": ("subcomponent", 500),
    "r": ("region", 500),
    "t": ("time", 500),
    "i": ("row", 3),
    "j": ("column", 3),
    "mf": ("point force", 5),
    "nsp": ("spring", 100),
    "side": ("boundary, 1 Xmin .. 6 Zmax", 6),
    "plane": ("mesh plane", 500),
    "k": ("number", 500),
    "wave": ("wave component", 500),
}
AXES = "xyz"
SIDES = ("lower", "upper")


@dataclass(frozen=True)
class Row:
    """One variable. `allowed` is None (anything), a tuple of values, or (low, high, low is excluded)."""

    name: str
    block: str
    type: str  # int, real, char, logical
    shape: tuple[str, ...]
    default: str  # as written in the table; `defaults.py` gives it a value
    unit: str
    allowed: tuple[Value, ...] | None
    bounds: tuple[float, float, bool] | None
    not_yet: tuple[Value, ...]  # allowed by the format, not computed
    cls: str  # computed, accepted, known, alias
    needs: str  # "" or "liquid"
    switch: str  # known variables that act only together with this one
    time: str  # the table of times of the first index, "" without one
    sources: str
    meaning: str
    table: str = ""  # for F<name> and I<name>C: the array that comes from the file

    @property
    def key(self) -> str:
        """The name with its index letters, as a user writes it."""
        return self.name.lower() + (f"({','.join(self.shape)})" if self.shape else "")

    @property
    def limits(self) -> tuple[int, ...]:
        return tuple(INDEX[letter][1] for letter in self.shape)

    def range_text(self) -> str:
        """The allowed values in words, empty when anything goes."""
        if self.allowed is not None:
            return ", ".join(show(value) for value in self.allowed)
        if self.bounds is None:
            return ""
        low, high, open_low = self.bounds
        if math.isinf(high):
            return f"{'>' if open_low else '>='} {low:g}"
        return f"{low:g} .. {high:g}"

    def admits(self, value: Value) -> bool:
        """Whether the format knows this value, computed or not."""
        if self.allowed is not None:
            return (value.strip().lower() if isinstance(value, str) else value) in self.allowed
        if self.bounds is None:
            return True
        low, high, open_low = self.bounds
        return (value > low if open_low else value >= low) and value <= high


def show(value: Value | None) -> str:
    """A value as namelist text."""
    if value is None:
        return "-"
    if isinstance(value, bool):
        return ".true." if value else ".false."
    if isinstance(value, str):
        return "'" + value.replace("'", "''") + "'"
    return repr(value)


def literal(text: str, kind: str) -> Value | None:
    """The value of a literal of a table; None when it is unset or not a literal."""
    if text == "-":
        return None
    if kind == "char":
        return text.strip("'") if text.startswith("'") else None
    if kind == "logical":
        return {".true.": True, ".false.": False}.get(text)
    try:
        return int(text) if kind == "int" else float(text)
    except ValueError:
        return None


def _allowed(text: str, kind: str) -> tuple[tuple | None, tuple | None, tuple]:
    if not text:
        return None, None, ()
    if match := re.fullmatch(r"(>=?)\s*(\S+)", text):
        return None, (float(match[2]), math.inf, match[1] == ">"), ()
    if match := re.fullmatch(r"(\S+?)\.\.(\S*)", text):
        return None, (float(match[1]), float(match[2] or "inf"), False), ()
    tokens = text.split()
    values = tuple(literal(token.rstrip("*"), kind) for token in tokens)
    return values, None, tuple(v for v, token in zip(values, tokens, strict=True) if token.endswith("*"))


def _words(count: int, number: int) -> dict[str, str]:
    """{axis} and {side} of name `number` in a family of `count`."""
    if count == 2:
        return {"axis": "", "side": SIDES[number]}
    if count == 6:
        return {"axis": AXES[number // 2], "side": SIDES[number % 2]}
    return {"axis": AXES[number % 3], "side": ""}


def rows(block: str, table: str) -> Iterator[Row]:
    """The rows of a table of text (see the module's docstring)."""
    cls, needs, switch = "computed", "", ""
    for line in table.strip().splitlines():
        line = line.strip()
        if not line:
            continue
        if line.startswith("="):
            words = [word.strip() for word in line[1:].split(",")]
            cls = words[0]
            needs = next((word[6:] for word in words[1:] if word.startswith("needs ")), "")
            switch = next((word[5:] for word in words[1:] if word.startswith("with ")), "")
            continue
        names, kind, shape, default, unit, allowed, sources, meaning = (part.strip() for part in line.split("|", 7))
        letters = [word.partition(":") for word in shape.split()]
        values, bounds, not_yet = _allowed(allowed, kind)
        family = names.split()
        for number, name in enumerate(family):
            yield Row(
                name=name,
                block=block,
                type=kind,
                shape=tuple(letter for letter, _, _ in letters),
                default=default,
                unit=unit,
                allowed=values,
                bounds=bounds,
                not_yet=not_yet,
                cls=cls,
                needs=needs,
                switch=switch,
                time=next((table for _, _, table in letters if table), ""),
                sources=sources,
                meaning=meaning.format(**_words(len(family), number)),
            )


def external(row: Row) -> Iterator[Row]:
    """The two variables that let a time-dependent array come from a file: F<name> and I<name>C."""
    shared = dict(block=row.block, shape=row.shape[1:], unit="-", not_yet=(), cls=row.cls, needs=row.needs)
    shared |= dict(switch=row.switch, time="", sources="M", allowed=None, table=row.name)
    yield Row(
        name=f"F{row.name}",
        type="char",
        default="''",
        bounds=None,
        meaning=f"file with a table of {row.name}, first column time",
        **shared,
    )
    yield Row(
        name=f"I{row.name}C",
        type="int",
        default="0",
        bounds=(0, 500, False),
        meaning=f"column of {row.name} in that file (2 or more)",
        **shared,
    )


def elements(shape: tuple[str, ...], counts: dict[str, int]) -> Iterator[tuple[int, ...]]:
    """All index tuples of a shape when its letters count up to `counts`."""
    return product(*(range(1, counts.get(letter, 0) + 1) for letter in shape))
