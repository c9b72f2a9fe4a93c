"""Where everything stands in a deck: title, blocks, assignments, each with its line. Nothing is converted here.

A namelist reader that meets a damaged deck tends to lose whole groups without a word. So the text is cut up first,
line by line, and every cut that looks doubtful is reported: a block that is not closed, one that lost its `&`,
assignments that stand outside any block, a quote without its partner.
"""

import re
from bisect import bisect_right
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from .errors import Notice, Problem
from .variables import BLOCKS, REGISTRY

OPENING = re.compile(r"[ \t]*[&$]([A-Za-z_]\w*)")
# What matters inside a block: quoted text (a doubled quote stays inside), remarks, the end, a quote without partner.
MARK = re.compile(r"""'(?:[^']|'')*'|"(?:[^"]|"")*"|!.*|/|[&$][ \t]*end\b|['"]""", re.IGNORECASE)
ASSIGNMENT = re.compile(r"(?<![\w%.])([A-Za-z_]\w*+)\s*+(?:\(([^()=\x01]*+)\))?+\s*+=")
TOKEN = re.compile(r"""(?P<comma>,)|(?:\d+\*)?'(?:[^']|'')*'|(?:\d+\*)?"(?:[^"]|"")*"|[^\s,'"]+""")
# An assignment in a line outside blocks: free text may hold an equals sign, so a whole literal must follow it.
OUTSIDE = re.compile(
    r"""[ \t,/]*([A-Za-z_]\w*)[ \t]*(?:\([ \d,:]*\))?[ \t]*=[ \t]*"""
    r"""(?:[+-]?[\d.][\w.+*-]*|\.[a-z]+\.|'[^']*'|"[^"]*")[ \t]*(?:[,!/]|$|[A-Za-z_]\w*[ \t]*[(=])""",
    re.IGNORECASE,
)
FRACTION = re.compile(r"(?<!\w)[\d.]+$")  # a number right before a /
DIVISOR = re.compile(r"[\d.]+")
HIDDEN = "\x01"  # stands for quoted characters in the masked text


@dataclass
class Assignment:
    """`name(index) = tokens` as written; a token is None where the deck leaves a value out (`1,,3`)."""

    name: str
    index: str | None
    line: int
    tokens: list[tuple[str | None, int]]


@dataclass
class Block:
    """One block as it stands in the text; `clean` has no remarks, `masked` has no quoted text either."""

    name: str
    line: int
    clean: list[str] = field(default_factory=list)
    masked: list[str] = field(default_factory=list)


@dataclass
class Scan:
    """The parts of a deck's text."""

    file: str
    title: str = ""
    blocks: list[Block] = field(default_factory=list)
    problems: list[Problem] = field(default_factory=list)
    notices: list[Notice] = field(default_factory=list)
    open_quotes: set[int] = field(default_factory=set)  # lines whose last value is lost with its quote
    # Text outside blocks: one list of (line number, text) before the first block, and one after each.
    outside: list[list[tuple[int, str]]] = field(default_factory=lambda: [[]])

    def problem(self, line: int | None, block: str, wrong: str, write: str, variable: str = "") -> None:
        self.problems.append(Problem(self.file, line, block, variable, wrong, write))


def scan(text: str, file: str) -> Scan:
    """Cut a deck's text into title and blocks."""
    found = Scan(file)
    lines = text.split("\n")
    found.title = lines[0].strip()
    first = 1
    if OPENING.match(lines[0]):
        found.title, first = "", 0
        found.problem(1, "", "a deck starts with a title, this one with a block", "Put a line of text first")
    current: Block | None = None
    for number, line in enumerate(lines[first:], first + 1):
        current = _scan_line(found, current, number, line)
    if current is not None:
        found.problem(current.line, current.name, "the block is not closed", "Write / after its last line")
    _stray_text(found)
    return found


def _scan_line(found: Scan, current: Block | None, number: int, line: str) -> Block | None:
    """Take in one line; returns the block that is open at its end."""
    while True:
        opening = OPENING.match(line)
        if opening and opening[1].lower() != "end":
            if current is not None:
                wrong = f"the block is not closed before &{opening[1].lower()} opens in line {number}"
                found.problem(current.line, current.name, wrong, f"Write / before line {number}")
            current = Block(opening[1].upper(), number)
            found.blocks.append(current)
            found.outside.append([])
            line = " " * opening.end() + line[opening.end() :]
        if current is None:
            found.outside[-1].append((number, line))
            return None
        end = _take(found, current, number, line)
        if end is None:
            return current
        current, line = None, line[end:]
        if not line.strip():
            return None


def _take(found: Scan, block: Block, number: int, line: str) -> int | None:
    """Append a line to a block; returns where the rest begins when the block ends in it."""
    clean, masked, position = [], [], 0
    end = None
    for mark in MARK.finditer(line):
        text = mark[0]
        between = line[position : mark.start()]
        clean.append(between)
        masked.append(between)
        position = mark.end()
        if len(text) > 1 and text[0] in "'\"":
            clean.append(text)
            masked.append(HIDDEN * len(text))
        elif text[0] == "!":
            break
        elif text in "'\"":
            wrong = "a quote is opened and not closed in this line"
            found.problem(number, block.name, wrong, f"Close it; inside a text write {text}{text} for {text}")
            found.open_quotes.add(number)
            position = len(line)
            break
        else:
            end = mark.end()
            _fraction(found, block, number, line, mark.start())
            break
    else:
        clean.append(line[position:])
        masked.append(line[position:])
    block.clean.append("".join(clean))
    block.masked.append("".join(masked))
    return end


def _fraction(found: Scan, block: Block, number: int, line: str, slash: int) -> None:
    """Report `1/2`: the / ends the block, and all that follows would be lost."""
    if match := FRACTION.search(line[:slash]):
        divisor = DIVISOR.match(line, slash + 1)
        if divisor:
            wrong = f"{match[0]}/{divisor[0]} is no number; the / ends the block"
            found.problem(number, block.name, wrong, "Write the number itself, as 0.5")


def assignments(block: Block, found: Scan) -> Iterator[Assignment]:
    """The assignments of a block, in order; text that belongs to none is reported."""
    clean, masked = "\n".join(block.clean), "\n".join(block.masked)
    starts = [0]
    for part in block.clean:
        starts.append(starts[-1] + len(part) + 1)

    def line_at(offset: int) -> int:
        return block.line + bisect_right(starts, offset) - 1

    matches = list(ASSIGNMENT.finditer(masked))
    head = masked[: matches[0].start() if matches else len(masked)].strip(" \t\n,")
    if head:
        shown = head.replace(HIDDEN, "").split("\n")[0].strip()[:40] or "a text"
        offset = len(masked) - len(masked.lstrip(" \t\n,"))
        found.problem(line_at(offset), block.name, f"cannot read {shown}", "Write name=value, values in quotes if text")
    for number, match in enumerate(matches):
        stop = matches[number + 1].start() if number + 1 < len(matches) else len(masked)
        if (stray := masked.find("=", match.end(), stop)) >= 0:
            line_start = max(masked.rfind("\n", 0, stray), masked.rfind(",", match.end(), stray), match.end() - 1) + 1
            shown = masked[line_start : masked.find("\n", stray) if "\n" in masked[stray:] else stop]
            shown = shown.replace(HIDDEN, "").strip()[:40]
            found.problem(line_at(stray), block.name, f"cannot read {shown}", "Write name=value or name(index)=value")
            stop = line_start
        tokens = _tokens(clean, match.end(), stop, line_at)
        yield Assignment(match[1].upper(), match[2], line_at(match.start(1)), tokens)


def _tokens(clean: str, start: int, stop: int, line_at: Callable[[int], int]) -> list[tuple[str | None, int]]:
    """Values between two offsets; commas separate, a comma after a comma leaves a value out."""
    tokens: list[tuple[str | None, int]] = []
    open_place = True  # the next comma has no value before it
    for match in TOKEN.finditer(clean, start, stop):
        if not match["comma"]:
            tokens.append((match[0], line_at(match.start())))
            open_place = False
        elif open_place:
            tokens.append((None, line_at(match.start())))
        else:
            open_place = True
    return tokens


def _known_assignment(text: str) -> str:
    """The deck variable that a line outside blocks sets, or nothing if it is only a text with an equals sign."""
    match = OUTSIDE.match(text)
    return match[1].lower() if match and (match[1].upper() in REGISTRY or match[1].upper() == "REMARK") else ""


def _lost_block(lines: list[tuple[int, str]], position: int) -> str:
    """The block whose `&` seems to be missing in this line, or nothing."""
    name, _, rest = lines[position][1].strip().partition(" ")
    if name.upper() not in BLOCKS:
        return ""
    following = next((text for _, text in lines[position + 1 :] if text.strip()), "")
    if _known_assignment(rest) or (not rest.strip() and (_known_assignment(following) or following.strip()[:1] == "/")):
        return name.upper()
    return ""


def _stray_text(found: Scan) -> None:
    """Report text outside blocks that was meant to stand inside one. Tables after a line with # are left alone."""
    for lines in found.outside:
        tables = next((i for i, (_, text) in enumerate(lines) if text.lstrip().startswith("#")), len(lines))
        lines = lines[:tables]
        lost = next(((i, name) for i in range(len(lines)) if (name := _lost_block(lines, i))), None)
        stray = next(((place, name) for place, text in lines if (name := _known_assignment(text))), None)
        if lost:
            name = lost[1]
            found.problem(lines[lost[0]][0], name, "the block has lost its &", f"Write &{name.lower()}")
        elif stray:
            wrong = "the line stands outside any block and would be ignored"
            write = "Move it into its block, above the / that closes the block, or remove it"
            found.problem(stray[0], "", wrong, write, variable=stray[1])
