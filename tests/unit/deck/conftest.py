"""A sound dry deck to vary, and what reading a text gives."""

from collections.abc import Callable
from pathlib import Path

import pytest

from flowgmo.deck import DeckError, parse_deck

XPUT = "twfin=1.0, imobs=1, iclid=1,"
MESH = "px=0., 1., py=0., 1., pz=0., 1.,"
OBS = "nobs=1, imo(1)=4, rhomvb(1)=1000., iob(1)=1, xl(1)=.1, xh(1)=.2,"


def text_of(xput: str = XPUT, mesh: str = MESH, obs: str = OBS, more: str = "", **blocks: str) -> str:
    """A deck; `more` is added to &obs, `add_xput` to &xput, other blocks by their names."""
    xput += blocks.pop("add_xput", "")
    others = "\n".join(f"&{name}\n{body}\n/" for name, body in blocks.items())
    return f"a title\n&xput\n{xput}\n/\n{others}\n&mesh\n{mesh}\n/\n&obs\n{obs}\n{more}\n/\n"


@pytest.fixture
def text() -> Callable[..., str]:
    return text_of


@pytest.fixture
def read() -> Callable:
    """Reads a deck made of blocks, or a whole text; its path is deck.nml."""
    return lambda whole=None, **blocks: parse_deck(whole or text_of(**blocks), Path("deck.nml"))


@pytest.fixture
def error(read: Callable) -> Callable[..., DeckError]:
    """The DeckError of a deck."""

    def catch(whole: str | None = None, **blocks: str) -> DeckError:
        with pytest.raises(DeckError) as caught:
            read(whole, **blocks)
        return caught.value

    return catch
