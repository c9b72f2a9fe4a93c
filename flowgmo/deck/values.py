"""From the text of a value to the value: its form is checked first, f90nml then converts what is known to be sound.

f90nml alone would turn a misspelt number into a text and lose groups (see `scan.py`), so it never sees deck text, only
lists of literals whose form has passed the tests below. One list for many values: its time grows with the square of
the number of variables in a group, and only linearly with the length of a list.
"""

import re

import f90nml

from .row import Row, Value, show

# The forms a literal may have, and how a user would call them.
FORMS = {
    "int": (re.compile(r"[+-]?\d+"), "a whole number"),
    "real": (re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][+-]?\d+)?"), "a number"),
    "char": (re.compile(r"""'(?:[^']|'')*'|"(?:[^"]|"")*\""""), "a text in quotes"),
    "logical": (re.compile(r"\.(?:true|false|t|f)\.|true|false|[tf]", re.IGNORECASE), ".true. or .false."),
}
LARGEST_INT = 2**31 - 1  # the format's integers are Fortran's default ones
QUOTES = "'\"`´‘’‚“”„«»"  # what editors and other languages write for the straight quotes of a deck
REPEAT = re.compile(r"(\d+)\*(.*)", re.DOTALL)
MOST_REPEATS = 500**2  # elements of the largest array of the format, a table of 500 times for 500 bodies
CHUNK = 2000  # literals per f90nml list, so that a list stays short


def repeated(token: str) -> tuple[int, str | None]:
    """`3*2.0` is (3, '2.0'), `3*` is (3, None), everything else stands once."""
    match = REPEAT.fullmatch(token)
    return (int(match[1][:9]), match[2] or None) if match else (1, token)


def fault(row: Row, token: str, element: str) -> tuple[str, str] | None:
    """What is wrong with the form of a literal for this element, and what to write; None when it is sound."""
    form, words = FORMS[row.type]
    if form.fullmatch(token):
        return _size_fault(row, token)
    if row.type == "char":
        return f"{token[:40]} is not a text in quotes", f"Write {element}={show(token[:40].strip(QUOTES))}"
    if re.fullmatch(r"[+-]?(nan|inf|infinity)(\(.*)?", token, re.IGNORECASE):
        return f"{token[:40]} is no number", "Give a finite value"
    if row.type == "int" and FORMS["real"][0].fullmatch(token):
        return f"{token[:40]} is not a whole number", f"Write {element}={_whole(token)}"
    return f"{token[:40]} is not {words}", f"Write {words}"


def _whole(token: str) -> str:
    value = float(token.lower().replace("d", "e"))
    return str(round(value)) if abs(value) < LARGEST_INT else "a whole number"


def _size_fault(row: Row, token: str) -> tuple[str, str] | None:
    if row.type == "real" and abs(float(token.lower().replace("d", "e"))) == float("inf"):
        return f"{token[:40]} is too large", "Give a finite value, below 1e308"
    if row.type == "int" and (len(token) > 40 or abs(int(token)) > LARGEST_INT):
        return f"{token[:40]} is too large for a whole number", f"Give a value up to {LARGEST_INT}"
    return None


def convert(literals: list[tuple[str, str]]) -> list[Value]:
    """Values of (type, literal) pairs that have passed `fault`."""
    values: list[Value] = []
    for start in range(0, len(literals), CHUNK):
        part = literals[start : start + CHUNK]
        # The leading value keeps a list of one from coming back as a scalar.
        group = f90nml.reads("&values v = 0, " + ",\n".join(_plain(kind, text) for kind, text in part) + " /\n")
        values += [_typed(kind, value) for (kind, _), value in zip(part, group["values"]["v"][1:], strict=True)]
    return values


def _plain(kind: str, text: str) -> str:
    """A literal in the one spelling of it that f90nml never takes for something else."""
    if kind == "logical":
        return ".true." if text.strip(".")[0] in "tT" else ".false."
    return text


def _typed(kind: str, value: Value) -> Value:
    if kind == "real":
        return float(value)
    return value.strip() if kind == "char" else value
