"""The reference page of all deck variables: `python -m flowgmo.deck.reference > docs/deck-reference.md`."""

from .defaults import default_text
from .explain import class_text
from .row import INDEX, Row
from .variables import BLOCKS, REGISTRY, of_block

HEAD = """# Deck variables

Generated from the registry (`flowgmo/deck/variables*.py`) by `make docs`; do not edit it by hand.

{count} variables in {blocks} blocks. *Class* says what flowgmo does with a variable: **computed** (does what it says),
**accepted** (read, no effect on the answer), **known** (would change the answer and is not computed: a value other than
the one that switches it off stops the run, unless `&flowgmo ignore_unsupported=.true.`), **for liquid** (no effect in a
dry deck, one without `rhof`). A time-dependent array `a(t,...)` may come from a file:
`fa(...)` names it, `iac(...)` is its column (column 1 is time).

Sources: M the vendor's list of variables, D1-D4 real decks, T the report, S1/S2 the ancestor codes, I inferred.

Indices: {indices}.
"""
COLUMNS = "| variable | type | default | unit | range | class | meaning | source |\n|---|---|---|---|---|---|---|---|"


def page() -> str:
    """The whole page."""
    indices = "; ".join(f"`{letter}` {word} (up to {limit})" for letter, (word, limit) in INDEX.items())
    parts = [HEAD.format(count=len(REGISTRY), blocks=len(BLOCKS), indices=indices)]
    for block in BLOCKS:
        lines = [_line(row) for row in of_block(block) if not row.table]
        parts.append(f"## &{block.lower()}\n\n{COLUMNS}\n" + "\n".join(lines) + "\n")
    return "\n".join(parts)


def _line(row: Row) -> str:
    cells = (
        f"`{row.key}`",
        row.type,
        default_text(row),
        row.unit,
        row.range_text(),
        class_text(row),
        row.meaning,
        row.sources,
    )
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


if __name__ == "__main__":
    print(page(), end="")
