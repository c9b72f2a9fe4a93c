"""A deck that has been read: effective values by name and index, and where each of them stands."""

from functools import cached_property
from pathlib import Path

import numpy as np

from .defaults import default_of
from .errors import DeckError, Notice, Problem, Where
from .row import Row, Value, show
from .series import Series, TableError, read_table
from .store import Index, Store
from .variables import REGISTRY


class Deck:
    """Values of a deck under their deck names, in any case; indices count from 1 in the deck's own order.

    `deck["TWFIN"]` and `deck.at("IMO", 2)` are effective values: what the deck gives, else the default, else None.
    An unknown name or a wrong number of indices is a KeyError: a mistake of the program, not of the deck.
    """

    def __init__(self, path: Path, title: str, store: Store, blocks: dict[str, int]) -> None:
        self.path = path
        self.title = title
        self.notices: list[Notice] = []
        self.blocks = blocks  # line in which each block opens
        self.mesh_lines: list[int] = []  # where the mesh blocks open that are switched on
        self.broken = store.broken  # variables with a value that could not be read; a deck without any is returned
        self._values = store.values
        self._lines = store.lines
        self._tables: dict[Path, np.ndarray | TableError] = {}

    def row(self, name: str, index: Index | None = None) -> Row:
        """The registry's row of a variable."""
        row = REGISTRY[name.upper()]
        if index is not None and len(index) != len(row.shape):
            raise KeyError(f"{row.key} has {len(row.shape)} indices, not {len(index)}")
        return row

    def __getitem__(self, name: str) -> Value | None:
        return self.at(name)

    def at(self, name: str, *index: int) -> Value | None:
        """The effective value of one element."""
        row = self.row(name, index)
        given = self._values.get(row.name)
        if given is not None and index in given:
            return given[index]
        return default_of(self, row, index)

    def given(self, name: str, *index: int) -> bool:
        """Whether the deck sets this element, or without an index any element."""
        row = self.row(name, index or None)
        given = self._values.get(row.name)
        return bool(given) and (not index or index in given)

    def drop(self, name: str, *index: int) -> None:
        """Forget an element: its default holds from now on (only while the deck is being checked)."""
        self._values[self.row(name, index).name].pop(index)
        self.__dict__.pop("_groups", None)

    def indices(self, name: str) -> list[Index]:
        """The elements that the deck sets, in order."""
        return sorted(self._values.get(self.row(name).name, ()))

    def where(self, name: str, *index: int) -> Where:
        """The line that sets a variable; of its block's opening if none does, None if there is no such block."""
        row = self.row(name)
        lines = self._lines.get(row.name, {})
        line = lines.get(index) if index or not row.shape else min(lines.values(), default=None)
        return Where(str(self.path), line if line is not None else self.blocks.get(row.block), row.block)

    def problem(self, name: str, *index: int, wrong: str, write: str) -> Problem:
        """A Problem at the place of a variable."""
        return Problem(*self.where(name, *index), self._shown(name, index), wrong, write)

    def notice(self, name: str, *index: int, wrong: str, write: str = "") -> Notice:
        """A Notice at the place of a variable."""
        return Notice(*self.where(name, *index), self._shown(name, index), wrong, write)

    def _shown(self, name: str, index: Index) -> str:
        row = self.row(name)
        text = row.name.lower() + (f"({','.join(map(str, index))})" if index else "")
        value = self._values.get(row.name, {}).get(index)
        return text if value is None else f"{text}={show(value)}"

    @cached_property
    def _groups(self) -> dict[str, dict[Index, dict[int, Value]]]:
        """For each time-dependent array its values by time index, for each set of trailing indices."""
        groups: dict[str, dict[Index, dict[int, Value]]] = {}
        for name, values in self._values.items():
            if REGISTRY[name].time:
                group = groups.setdefault(name, {})
                for (t, *rest), value in values.items():
                    group.setdefault(tuple(rest), {})[t] = value
        return groups

    def tabled(self, name: str) -> list[Index]:
        """Trailing indices for which the deck gives a time-dependent array, in the deck or by a file."""
        row = self.row(name)
        files = [index for index in self.indices(f"F{row.name}") if self.at(f"F{row.name}", *index)]
        return sorted({*self._groups.get(row.name, ()), *files})

    def series(self, name: str, *index: int) -> Series:
        """A time-dependent array as a table of time for given trailing indices.

        Constant with t = [0.] when the deck gives one value or none. Raises DeckError when the table is not sound;
        for a deck that `read_deck` has returned it is.
        """
        row = self.row(name)
        if not row.time or len(index) != len(row.shape) - 1:
            raise KeyError(f"{row.key} is no table of time with {len(index)} trailing indices")
        values = self._groups.get(row.name, {}).get(index, {})
        if self.at(f"F{row.name}", *index):
            return self._from_file(row, index, values)
        if set(values) <= {1}:
            value = values.get(1, default_of(self, row, (1, *index)))
            return Series(np.zeros(1), np.array([value], float))
        count = max((t for (t,) in self.indices(row.time)), default=1)
        last = max(values)
        if last > count:
            wrong = f"there are {last} values and {count} times in {row.time.lower()}"
            write = f"Give {row.time.lower()}({count + 1}) to {row.time.lower()}({last})"
            raise DeckError([self.problem(row.name, last, *index, wrong=wrong, write=write)])
        missing = [t for t in range(1, count + 1) if t not in values]
        if missing:
            wrong = f"the value at time {missing[0]} of {row.time.lower()} is missing"
            write = f"Give all {count} values, or only the first one for a constant"
            raise DeckError([self.problem(row.name, missing[0], *index, wrong=wrong, write=write)])
        times = [self.at(row.time, t) for t in range(1, count + 1)]
        return Series(np.array(times, float), np.array([values[t] for t in range(1, count + 1)], float))

    def _from_file(self, row: Row, index: Index, values: dict[int, Value]) -> Series:
        """The column of an external table that stands for an array."""
        file, column = f"F{row.name}", self.at(f"I{row.name}C", *index)
        if values:
            wrong = f"there is a table in the deck too ({row.name.lower()})"
            raise DeckError([self.problem(file, *index, wrong=wrong, write="Keep one of the two")])
        if column < 2:
            wrong = "the column of the file is not given; column 1 is time"
            write = f"Write i{row.name.lower()}c({','.join(map(str, index))})=2 or more"
            raise DeckError([self.problem(file, *index, wrong=wrong, write=write)])
        path = self.path.parent / self.at(file, *index)
        if path not in self._tables:
            try:
                self._tables[path] = read_table(path)
            except TableError as error:
                self._tables[path] = error
        table = self._tables[path]
        if isinstance(table, TableError):
            raise DeckError([self.problem(file, *index, wrong=str(table), write="Correct the table")])
        if column > table.shape[1]:
            wrong = f"the file {path} has {table.shape[1]} columns"
            raise DeckError([self.problem(f"I{row.name}C", *index, wrong=wrong, write="Give one of them")])
        return Series(table[:, 0].copy(), table[:, column - 1].copy())

    def resolved(self, folder: Path | None = None) -> str:
        """The complete deck as namelist text, defaults filled in; see `resolved.py`."""
        from .resolved import resolved

        return resolved(self, folder)
