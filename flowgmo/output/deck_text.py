"""A resolved deck as plain assignments, to compare two of them. Not a deck reader: that is `flowgmo.deck`."""

from __future__ import annotations

import re

_QUOTED = re.compile(r"'(?:[^'\n]|'')*'|\"(?:[^\"\n]|\"\")*\"")
_COMMENT = re.compile(r"!.*")
_BLOCK = re.compile(r"^\s*[&$]\w+|/\s*$|^\s*\$end\b", re.MULTILINE | re.IGNORECASE)
_FIRST = re.compile(r"^\s*[&$]\w", re.MULTILINE)
_NAME = re.compile(r"([A-Za-z_]\w*\s*(?:\([^()]*\))?)\s*=(?!=)")


def assignments(text: str) -> dict[str, str]:
    """`name(index)` in small letters -> value text without spaces; comments, which say where a value is from, ignored.

    A name given several times (repeated blocks) keeps all its values, joined.
    """
    first = _FIRST.search(text)
    text = text[first.start() :] if first else text  # a title may hold anything
    quotes: list[str] = []

    def hide(match: re.Match) -> str:
        quotes.append(match.group())
        return f"\x00{len(quotes) - 1}\x00"

    plain = _BLOCK.sub(" ", _COMMENT.sub("", _QUOTED.sub(hide, text)))
    found: dict[str, str] = {}
    parts = _NAME.split(plain)  # text before, name, value, name, value ...
    for name, value in zip(parts[1::2], parts[2::2], strict=True):
        key = re.sub(r"\s", "", name).lower()
        clean = re.sub(r"[\s,]+", " ", value).strip()
        clean = re.sub(r"\x00(\d+)\x00", lambda m: quotes[int(m.group(1))], clean)
        found[key] = f"{found[key]} | {clean}" if key in found else clean
    return found
