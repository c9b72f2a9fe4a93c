"""Decks: reading, checking, and explaining FLOW-3D style namelist input.

    deck = read_deck("case.nml")      # DeckError with all problems together
    deck["TWFIN"], deck.at("IMO", 2)  # effective values, defaults filled in
    deck.series("UTOBS", 1)           # tables of time

Every variable has one row in the registry (`variables*.py`); checks, messages, `explain`, and the reference page
come from it.
"""

from .deck import Deck
from .errors import DeckError, Notice, Problem, Where
from .reader import parse_deck, read_deck
from .series import Series

__all__ = ["Deck", "DeckError", "Notice", "Problem", "Series", "Where", "parse_deck", "read_deck"]
