"""What is met while a Model is built: all of it is reported together."""

from __future__ import annotations

from flowgmo.deck import Deck, Notice, Problem


class Findings:
    """Problems and notices collected while a Model is built."""

    def __init__(self, deck: Deck) -> None:
        self.deck = deck
        self.problems: list[Problem] = []
        self.notices: list[Notice] = list(deck.notices)

    def problem(self, name: str, *index: int, wrong: str, write: str) -> None:
        self.problems.append(self.deck.problem(name, *index, wrong=wrong, write=write))

    def notice(self, name: str, *index: int, wrong: str, write: str = "") -> None:
        self.notices.append(self.deck.notice(name, *index, wrong=wrong, write=write))
