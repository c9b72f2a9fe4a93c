"""The complete deck as text: what was read and what was filled in, to be stored beside the results."""

import math
import os.path
from collections.abc import Iterator
from pathlib import Path

from .deck import Deck
from .row import Row, Value, elements, show
from .rules_bodies import subcomponents
from .rules_motion import FLAGS
from .store import Index
from .variables import BLOCKS, of_block


def resolved(deck: Deck, folder: Path | None = None) -> str:
    """Namelist text that reads back to the same values, each line marked `! deck` or `! default`.

    It holds every computed variable with a value (those of the liquid only where there is liquid) and whatever else
    the deck gives. Tables of time, pairs, and tensors keep the elements that are given. Names of files are written
    relative to `folder`, where the text will be stored.
    """
    lines = [deck.title or "no title"]
    for block in BLOCKS:
        body = [line for row in of_block(block) for line in _lines(deck, row, folder)]
        if body or block in deck.blocks:
            lines += ["", f"&{block.lower()}", *body, "/"]
    return "\n".join(lines) + "\n"


def _lines(deck: Deck, row: Row, folder: Path | None) -> Iterator[str]:
    for index in sorted({*deck.indices(row.name), *_defaults(deck, row)}):
        value = deck.at(row.name, *index)
        given = deck.given(row.name, *index)
        if value is None or (isinstance(value, float) and not math.isfinite(value)):
            continue  # unset, and unbounded, are said by leaving the variable out
        element = row.name.lower() + (f"({','.join(map(str, index))})" if index else "")
        yield f"  {element}={_text(deck, row, value, folder)} ! {'deck' if given else 'default'}"


def _defaults(deck: Deck, row: Row) -> Iterator[Index]:
    """Elements that are written though the deck does not give them."""
    if row.cls != "computed" or row.table or (row.needs == "liquid" and not deck.given("RHOF")):
        return iter(())
    if len(row.shape) > 1 or row.shape in (("t",), ("mf",), ("r",)) or (row.type == "char" and row.shape):
        return iter(())
    if row.name in FLAGS:  # they speak of bodies that the loads move, and of no others
        return iter([(m,) for m in range(1, deck["NOBS"] + 1) if deck.at("IMO", m) == 4])
    counts = {"m": deck["NOBS"], "side": 6, "plane": 2 if row.name in ("PX", "PY", "PZ") else 0}
    if row.shape == ("k",):
        counts["k"] = 1 if row.name.endswith("PLTD") else 0
    if row.shape == ("n",):
        return iter([(n,) for n in subcomponents(deck)])
    return elements(row.shape, counts)


def _text(deck: Deck, row: Row, value: Value, folder: Path | None) -> str:
    names_file = row.name in ("FSTL", "FFSTL") or (row.table and row.type == "char")
    if folder is not None and names_file and value:
        value = os.path.relpath(deck.path.parent / value, folder)
    return show(value)
