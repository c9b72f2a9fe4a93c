"""Decks as text (tests/helpers) and the Model, or the problems, that building them gives."""

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from flowgmo.building import build_model
from flowgmo.deck import DeckError, parse_deck

HELPERS = next(p / "helpers" for p in Path(__file__).parents if (p / "helpers").is_dir())
sys.path.insert(0, str(HELPERS))


@pytest.fixture
def build() -> Callable:
    """The Model of a deck text."""
    return lambda text: build_model(parse_deck(text, Path("deck.nml")))


@pytest.fixture
def problems(build: Callable) -> Callable:
    """The problems of a deck text, as the user reads them."""

    def catch(text: str) -> list[str]:
        with pytest.raises(DeckError) as caught:
            build(text)
        return [str(problem) for problem in caught.value.problems]

    return catch
