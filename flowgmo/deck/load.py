"""The text of a deck file, or one Problem that says why there is none."""

import stat
from pathlib import Path

from .errors import DeckError, Notice, Problem

LARGEST = 32 * 2**20  # bytes; 500 bodies with all their data need about 1 MiB


def load(path: Path) -> tuple[str, list[Notice]]:
    """The text with plain line ends."""
    raw = _bytes(path)
    notices: list[Notice] = []
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = _windows(path, raw)
        notices.append(Notice(str(path), None, "", "", "the file is not UTF-8 and was read as Windows-1252"))
    text = text.replace("\r\n", "\n").replace("\r", "\n").rstrip("\x1a")
    # Line ends, tab, and form feed are the only control characters that a text file has.
    if any(ord(sign) < 32 and sign not in "\n\t\f" for sign in set(text)):
        raise _error(path, "this is not a text file", "Name the deck")
    if not text.strip():
        raise _error(path, "the file is empty", "Write a title line and the blocks &xput and &mesh")
    return text.replace("\f", " "), notices


def _bytes(path: Path) -> bytes:
    try:
        status = path.stat()
        if stat.S_ISDIR(status.st_mode):
            raise _error(path, "this is a folder", "Name the deck in it")
        if not stat.S_ISREG(status.st_mode):
            raise _error(path, "this is not a plain file", "Name the deck")
        if status.st_size > LARGEST:
            raise _error(path, f"the file has {status.st_size} bytes, no deck is that large", "Name the deck")
        return path.read_bytes()
    except FileNotFoundError:
        raise _error(path, "there is no such file", _neighbours(path)) from None
    except PermissionError:
        raise _error(path, "there is no permission to read the file", "Ask its owner, or check its rights") from None
    except (OSError, ValueError) as error:
        raise _error(path, f"the file cannot be read: {error}", "Check the path") from None


def _windows(path: Path, raw: bytes) -> str:
    try:
        return raw.decode("cp1252")
    except UnicodeDecodeError:
        raise _error(path, "this is not a text file", "Name the deck, and store it as UTF-8") from None


def _neighbours(path: Path) -> str:
    """Decks that do exist in that folder."""
    try:
        decks = sorted(other.name for other in path.parent.iterdir() if other.suffix in (".nml", ".inp"))
    except (OSError, ValueError):
        decks = []
    return f"In that folder there is {', '.join(decks[:5])}" if decks else "Check the path"


def _error(path: Path, wrong: str, write: str) -> DeckError:
    return DeckError([Problem(str(path), None, "", "", wrong, write)])
