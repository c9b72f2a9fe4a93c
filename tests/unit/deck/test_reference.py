"""What is generated from the registry: the reference page, and the list of all names."""

from pathlib import Path

from flowgmo.deck.explain import explain_all
from flowgmo.deck.reference import page
from flowgmo.deck.variables import BLOCKS, REGISTRY

DOCS = Path(__file__).parents[3] / "docs"


def test_reference_page_is_current() -> None:
    """`make docs` has been run since the registry was last changed."""
    assert (DOCS / "deck-reference.md").read_text() == page()


def test_all_names() -> None:
    """By block, each name with the mark of its class."""
    text = explain_all()
    assert all(f"&{block.lower()}\n" in text for block in BLOCKS)
    words = {word.rstrip("-~*=") for word in text.split()}
    assert {name.lower() for name in REGISTRY} <= words
    assert {"twfin", "lpr-", "con~", "ifsft*", "wl="} <= set(text.split())
