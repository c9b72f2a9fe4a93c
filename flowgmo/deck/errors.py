"""What a deck can have wrong, and where: the words in which every later stage speaks to the user."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple


class Where(NamedTuple):
    """A place in a deck; `line` is None when the block is absent."""

    file: str
    line: int | None
    block: str


def _sentence(text: str) -> str:
    text = text.strip()
    return text if not text or text[-1] in ".!?" else text + "."


@dataclass(frozen=True)
class Notice:
    """Something the user should know, though the run goes on.

    `variable` is written as in a deck, with its value where there is one (`imo(2)=7`); `wrong` says what was met,
    `write` what to write instead (empty when there is nothing to change).
    """

    file: str
    line: int | None
    block: str
    variable: str
    wrong: str
    write: str = ""

    def __str__(self) -> str:
        place = self.file if self.line is None else f"{self.file}:{self.line}"
        subject = " ".join(part for part in (self.block and f"&{self.block.lower()}", self.variable) if part)
        lead = f"{place}: {subject}: " if subject else f"{place}: "
        return " ".join(part for part in (lead + _sentence(self.wrong), _sentence(self.write)) if part)


@dataclass(frozen=True)
class Problem(Notice):
    """Something because of which the deck cannot be run."""


class DeckError(Exception):
    """Everything wrong with one deck, together; `problems` is never empty."""

    def __init__(self, problems: Iterable[Problem], notices: Iterable[Notice] = ()) -> None:
        self.problems = list(problems)
        self.notices = list(notices)
        super().__init__("\n".join(str(problem) for problem in self.problems))
