"""From assignments to elements of variables: names, index, type, and range are checked here, one by one."""

import difflib
import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from .errors import Notice
from .row import Row, Value, show
from .scan import Assignment, Block, Scan
from .values import MOST_REPEATS, convert, fault, repeated
from .variables import ALIASES, ALSO_IN, OPEN, REGISTRY, SPELLINGS, of_block

RANGE = re.compile(r"\s*([+-]?\d+)\s*(?::\s*([+-]?\d+)\s*)?")
UNSET = {"RHOF": -1.0, "RHOF2": -1.0}  # the vendor's default, which means: not given
MEANS = {"IFVOF": {5: 6, 3: 4}}  # one way to move liquid stands for two of the vendor's
WHOLE, DECIMALS = re.compile(r"[+-]?\d+"), re.compile(r"\d+(?:[eEdD][+-]?\d+)?")  # before and behind a decimal sign
MOST_SHOWN = 3  # of values that are too many
MOST_HINTS = 20  # nearest names are looked up for so many unknown ones; a wrong file has thousands

Index = tuple[int, ...]


@dataclass
class Store:
    """What a deck sets: for each variable the values of its elements, and the line of each."""

    values: dict[str, dict[Index, Value]] = field(default_factory=dict)
    lines: dict[str, dict[Index, int]] = field(default_factory=dict)
    broken: set[str] = field(default_factory=set)  # variables with a value that could not be read


class Filler:
    """Fills stores from blocks and collects what is wrong on the way."""

    def __init__(self, scan: Scan) -> None:
        self.scan = scan
        self.hints = MOST_HINTS
        self.waiting: list[tuple[Store, Row, Index, str, int]] = []
        self.lists: dict[tuple[str, Index], str] = {}  # elements that got a later value of a list, and that list

    def take(self, block: Block, store: Store, assignments: Iterator[Assignment]) -> None:
        """Put a block's assignments into a store; their values wait for `finish`."""
        for assignment in assignments:
            if assignment.name == "REMARK":
                continue
            name = SPELLINGS.get(assignment.name, assignment.name)
            row = REGISTRY.get(name)
            if row is None:
                self._unknown(block, assignment)
                continue
            if row.block != block.name and block.name not in ALSO_IN.get(name, ()):
                wrong = f"the variable does not belong into &{block.name.lower()}"
                write = f"Move it to &{row.block.lower()}"
                self._problem(assignment.line, block.name, name.lower(), wrong, write)
                store.broken.add(name)
            self._elements(store, row, assignment)

    def finish(self) -> None:
        """Convert all values that were taken, check their range, and store them."""
        values = convert([(row.type, token) for _, row, _, token, _ in self.waiting])
        for (store, row, index, token, line), value in zip(self.waiting, values, strict=True):
            if value == UNSET.get(row.name):
                continue
            if not row.admits(value):
                store.broken.add(row.name)
                wrong, write = _range_fault(row, index)
                self._problem(line, row.block, f"{_written(row, index)}={token[:40]}", wrong, write)
                continue
            if row.allowed is not None and isinstance(value, str):
                value = value.lower()
            if (means := MEANS.get(row.name, {}).get(value)) is not None:
                text = f"taken as {_written(row, index)}={means}"
                self.scan.notices.append(
                    Notice(self.scan.file, line, row.block, f"{_written(row, index)}={value}", text)
                )
                value = means
            store.values.setdefault(row.name, {})[index] = value
        self.waiting = []

    def _problem(self, line: int, block: str, variable: str, wrong: str, write: str) -> None:
        self.scan.problem(line, block, wrong, write, variable)

    def _unknown(self, block: Block, assignment: Assignment) -> None:
        name, line = assignment.name.lower(), assignment.line
        if block.name in OPEN:
            notice = Notice(self.scan.file, line, block.name, name, "unknown and without effect")
            self.scan.notices.append(notice)
            return
        hint = "Remove it"
        if self.hints > 0:
            self.hints -= 1
            here = difflib.get_close_matches(name.upper(), [row.name for row in of_block(block.name)], 1, 0.7)
            near = here or difflib.get_close_matches(name.upper(), list(REGISTRY), 1, 0.7)
            if near:
                place = "" if here else f" (in &{REGISTRY[near[0]].block.lower()})"
                hint = f"Did you mean {near[0].lower()}{place}?"
        self._problem(line, block.name, name, "there is no variable of this name", hint)

    def _elements(self, store: Store, row: Row, assignment: Assignment) -> None:
        """Find out which element each value of an assignment is for."""
        places = self._places(row, assignment)
        if places is None:
            store.broken.add(row.name)
            return
        fixed, tokens = places
        if row.name in ALIASES:
            row, index = self._alias(row, assignment.line)
            fixed = [index] if tokens else []
        given = store.lines.setdefault(row.name, {})
        written = _shown(assignment, tokens)
        for index, (token, line) in zip(fixed, tokens, strict=False):
            if token is None:
                continue
            variable = _written(row, index)
            if wrong := fault(row, token, variable):
                store.broken.add(row.name)
                self._problem(line, row.block, variable, *wrong)
            elif index in given:
                store.broken.add(row.name)
                wrong = self._twice(row, index, given[index], line)
                self._problem(line, row.block, variable, wrong, "Keep one of the two")
            else:
                given[index] = line
                if index != fixed[0]:
                    self.lists[row.name, index] = written
                self.waiting.append((store, row, index, token, line))

    def _twice(self, row: Row, index: Index, first: int, line: int) -> str:
        """Where an element was set before; by a list (`zh(1)=0,6` sets zh(2) too), which one."""
        by = self.lists.get((row.name, index))
        before = f" by {by}" if by else ""
        if first == line:
            return "set twice in this line" + (f", once{before}" if by else "")
        return f"set twice, in line {first}{before} and in line {line}"

    def _alias(self, row: Row, line: int) -> tuple[Row, Index]:
        name, index = ALIASES[row.name]
        target = REGISTRY[name]
        text = f"old name, read as {_written(target, index)}"
        self.scan.notices.append(Notice(self.scan.file, line, row.block, row.name.lower(), text))
        return target, index

    def _places(self, row: Row, assignment: Assignment) -> tuple[list[Index], list] | None:
        """The elements an assignment fills and its values one by one; None when they do not fit."""
        line, shown = assignment.line, f"{row.name.lower()}"
        tokens: list[tuple[str | None, int]] = []
        for token, token_line in assignment.tokens:
            count, text = repeated(token) if token is not None else (1, None)
            if len(tokens) + count > MOST_REPEATS:
                self._problem(line, row.block, shown, "more values than any variable has", "Give fewer values")
                return None
            tokens += [(text, token_line)] * count
        while tokens and tokens[-1][0] is None:
            tokens.pop()
        if not tokens:
            if line not in self.scan.open_quotes:
                wrong, write = "there is no value after the =", f"Write a value, or remove {shown}"
                self._problem(line, row.block, shown, wrong, write)
            return None
        try:
            if not row.shape and assignment.index is None and len(tokens) > 1:
                raise ValueError(*_too_many(row, tokens))
            return _index_list(row, assignment.index, len(tokens)), tokens
        except ValueError as error:
            wrong, write = error.args
            shown += f"({assignment.index.strip()})" if assignment.index is not None else ""
            self._problem(line, row.block, shown, wrong, write)
            return None


def _too_many(row: Row, tokens: list[tuple[str | None, int]]) -> tuple[str, str]:
    """What is wrong with several values for a variable that has one, and what to write: 9,81 is meant as 9.81."""
    values = [text or "" for text, _ in tokens]
    wrong = f"one value is needed, here are {len(values)}: {_listed(values)}"
    if row.type == "real" and len(values) == 2 and WHOLE.fullmatch(values[0]) and DECIMALS.fullmatch(values[1]):
        return wrong, f"Write {row.key}={values[0]}.{values[1]}, decimals behind a point, or one value"
    return wrong, f"Write {row.key}= with one value"


def _shown(assignment: Assignment, tokens: list[tuple[str | None, int]]) -> str:
    """The beginning of an assignment as the deck has it."""
    place = f"({assignment.index.strip()})" if assignment.index is not None else ""
    return f"{assignment.name.lower()}{place}={_listed([text or '' for text, _ in tokens[: MOST_SHOWN + 1]])}"


def _listed(values: list[str]) -> str:
    more = ",..." if len(values) > MOST_SHOWN else ""
    return ",".join(value[:20] for value in values[:MOST_SHOWN]) + more


def _index_list(row: Row, text: str | None, count: int) -> list[Index]:
    """The elements that `count` values after name(text) are for; ValueError(wrong, write) when they do not fit."""
    if not row.shape:
        if text is not None:
            raise ValueError("the variable has no index", f"Write {row.key}=...")
        return [()]
    if text is None and len(row.shape) > 1:
        raise ValueError("the index is missing", f"Write {row.key}=...")
    parts = text.split(",") if text is not None else ["1"]
    if len(parts) != len(row.shape):
        needed = "one index is" if len(row.shape) == 1 else f"{len(row.shape)} indices are"
        raise ValueError(f"{needed} needed, not {len(parts)}", f"Write {row.key}=...")
    ranges = [_range(row, part, number) for number, part in enumerate(parts)]
    if all(first == last for first, last, colon in ranges if not colon) and not any(r[2] for r in ranges):
        first, rest = ranges[0][0], tuple(r[0] for r in ranges[1:])
        _within(row, 0, first + count - 1)
        return [(first + k, *rest) for k in range(count)]
    places = [()]
    for first, last, _ in reversed(ranges):  # the first index runs fastest
        places = [(k, *rest) for rest in places for k in range(first, last + 1)]
    if len(places) != count:
        example = f"{row.name.lower()}({text})={len(places)}*value" if count == 1 else f"{len(places)} values"
        raise ValueError(f"the index names {len(places)} elements, here are {count} values", f"Write {example}")
    return places


def _range(row: Row, part: str, number: int) -> tuple[int, int, bool]:
    """First and last value of one index, and whether it was written with a colon."""
    match = RANGE.fullmatch(part)
    if not match:
        raise ValueError(f"{part.strip()[:40] or 'nothing'} is not an index", f"Write {row.key}=... with whole numbers")
    first, last = int(match[1][:12]), int((match[2] or match[1])[:12])
    _within(row, number, first)
    _within(row, number, last)
    if last < first:
        raise ValueError(f"the index runs from {first} to {last}", "Give the smaller one first")
    return first, last, match[2] is not None


def _within(row: Row, number: int, index: int) -> None:
    if not 1 <= index <= row.limits[number]:
        raise ValueError(f"the index {index} is not in 1 .. {row.limits[number]}", f"Write {row.key}=... in that range")


def _written(row: Row, index: Index) -> str:
    return row.name.lower() + (f"({','.join(map(str, index))})" if index else "")


def _range_fault(row: Row, index: Index) -> tuple[str, str]:
    element, text = _written(row, index), row.range_text()
    if row.allowed is not None:
        computed = [value for value in row.allowed if value not in row.not_yet]
        return f"the value must be one of {text}", f"Write for example {element}={show(computed[-1])} ({row.meaning})"
    return f"the value must be {'in ' if '..' in text else ''}{text}", f"Give {element} a value in that range"
