"""Tables of a quantity against time, from the deck or from a file."""

import math
import re
import stat
from pathlib import Path
from typing import NamedTuple

import numpy as np

from .values import FORMS

NUMBER = FORMS["real"][0]
LARGEST_TABLE = 64 * 2**20  # bytes; a million rows of six columns


class Series(NamedTuple):
    """Piecewise linear between the times, constant before the first and after the last one; one value is constant."""

    t: np.ndarray  # (n,) strictly increasing
    y: np.ndarray  # (n,)


class TableError(Exception):
    """What is wrong with a table file: `place` is the file with its line."""

    def __init__(self, place: str, wrong: str) -> None:
        super().__init__(f"{place}: {wrong}")
        self.place, self.wrong = place, wrong


def read_table(path: Path) -> np.ndarray:
    """All columns of a table file (rows, columns); column 0 is time, strictly increasing.

    Separators are blanks, tabs, commas, semicolons. A header /* .. */ may stand at the top, lines with # anywhere.
    """
    try:
        status = path.stat()
        if not stat.S_ISREG(status.st_mode):
            raise TableError(str(path), "this is not a plain file")
        if status.st_size > LARGEST_TABLE:
            raise TableError(str(path), "the file is too large for a table")
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, ValueError) as error:
        reason = "there is no such file" if isinstance(error, FileNotFoundError) else f"cannot be read, {error}"
        raise TableError(str(path), reason) from None
    rows: list[list[float]] = []
    previous = -math.inf
    for number, line in enumerate(_without_header(path, text).split("\n"), 1):
        line = line.partition("#")[0].strip(" \t\r,;")
        if not line:
            continue
        place = f"{path}:{number}"
        row = _numbers(place, line)
        if rows and len(row) != len(rows[0]):
            raise TableError(place, f"{len(row)} columns, the rows before have {len(rows[0])}")
        if row[0] <= previous:
            raise TableError(place, f"the time {row[0]:g} does not come after {previous:g}")
        previous = row[0]
        rows.append(row)
    if not rows:
        raise TableError(str(path), "there are no numbers in the table")
    return np.array(rows)


def _without_header(path: Path, text: str) -> str:
    """The text with a leading /* .. */ turned into blank lines, so that line numbers stay."""
    if not text.lstrip().startswith("/*"):
        return text
    end = text.find("*/")
    if end < 0:
        raise TableError(str(path), "the header /* is not closed by */")
    return "\n" * text.count("\n", 0, end) + text[end + 2 :]


def _numbers(place: str, line: str) -> list[float]:
    numbers = []
    for word in re.split(r"\s*[,;]\s*|\s+", line):
        value = float(word.lower().replace("d", "e")) if NUMBER.fullmatch(word) else math.nan
        if not math.isfinite(value):
            raise TableError(place, f"{word[:40]} is not a finite number")
        numbers.append(value)
    return numbers
