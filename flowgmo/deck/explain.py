"""The registry in readable text, for `flowgmo explain`."""

import difflib

from .defaults import default_text
from .row import INDEX, Row, show
from .variables import ALIASES, BLOCKS, REGISTRY, SPELLINGS, of_block

TYPES = {"int": "whole number", "real": "number", "char": "text", "logical": ".true. or .false."}
MARKS = {"computed": "", "accepted": "-", "known": "*", "alias": "="}
MARKS_TEXT = "- no effect on the answer   ~ for liquid   * known but not computed   = old name"


def explain(name: str) -> str:
    """Everything known about one variable. KeyError with the nearest names in `args` if there is none."""
    key = name.strip().upper().partition("(")[0]
    key = SPELLINGS.get(key, key)
    if key not in REGISTRY:
        raise KeyError(*(near.lower() for near in difflib.get_close_matches(key, list(REGISTRY), 5, 0.6)))
    row = REGISTRY[key]
    facts = [
        ("block", f"&{row.block.lower()}"),
        ("type", TYPES[row.type]),
        ("index", index_text(row)),
        ("default", default_text(row)),
        ("unit", "" if row.unit == "-" else row.unit),
        ("range", row.range_text()),
        ("times", row.time.lower()),
        ("class", class_text(row)),
        ("source", "" if row.sources in ("-", "") else row.sources),
    ]
    lines = [f"{row.key}   {row.meaning}", *(f"  {word:8} {text}" for word, text in facts if text)]
    return "\n".join(lines) + "\n"


def explain_all() -> str:
    """All names by block, each with the mark of its class."""
    parts = [MARKS_TEXT]
    for block in BLOCKS:
        names = [row.name.lower() + mark(row) for row in of_block(block)]
        parts.append(f"&{block.lower()}\n" + _columns(names))
    return "\n\n".join(parts) + "\n"


def mark(row: Row) -> str:
    """One sign for the class; nothing for a variable that does what it says."""
    if row.cls == "computed" and row.needs:
        return "~"
    return MARKS[row.cls]


def index_text(row: Row) -> str:
    """What the indices count, with their largest values."""
    words = [f"{letter} {INDEX[letter][0]}, up to {INDEX[letter][1]}" for letter in dict.fromkeys(row.shape)]
    return "; ".join(words)


def class_text(row: Row) -> str:
    """What flowgmo does with the variable."""
    if row.cls == "alias":
        target, index = ALIASES[row.name]
        return f"old name of {target.lower()}({','.join(map(str, index))})"
    if row.cls == "accepted":
        return "accepted, no effect on the answer"
    if row.cls == "known":
        if row.switch:
            return f"known, not computed; acts only together with {row.switch.lower()}"
        off = default_text(row)
        return "known, not computed" + ("" if off == "none" else f"; {off} is off")
    text = "computed, for liquid" if row.needs else "computed"
    if row.not_yet:
        text += f"; known, not computed: {', '.join(show(value) for value in row.not_yet)}"
    return text


def _columns(names: list[str], width: int = 76) -> str:
    """Names side by side."""
    step = max(map(len, names), default=1) + 2
    per_line = max(1, width // step)
    lines = ["".join(f"{name:{step}}" for name in names[k : k + per_line]) for k in range(0, len(names), per_line)]
    return "\n".join("  " + line.rstrip() for line in lines)
