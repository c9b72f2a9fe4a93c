"""A results folder as arrays: everything that `history.h5` holds, read when asked for.

The file may be read while the run still goes on; what is seen then is the last flush of the run.
"""

from __future__ import annotations

import difflib
import re
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import h5py
import numpy as np

from postproc.errors import PostprocError, WrongRequest

SIDES = ("Xmin", "Xmax", "Ymin", "Ymax", "Zmin", "Zmax")
NOT_CURVES = ("deck", "time")


@dataclass(frozen=True)
class Curve:
    """A quantity over time: t (n,), y (n, columns), unit and names of the columns ("" for a scalar)."""

    name: str
    t: np.ndarray
    y: np.ndarray
    unit: str
    meaning: str
    columns: tuple[str, ...]


class Results:
    """The results folder of a run, or its history.h5."""

    def __init__(self, folder: Path) -> None:
        folder = Path(folder)
        if folder.name == "history.h5":
            folder = folder.parent
        if not folder.is_dir():
            raise WrongRequest(f"there is no results folder {folder}")
        self.folder = folder
        self.path = folder / "history.h5"

    @cached_property
    def file(self) -> h5py.File:
        if not self.path.is_file():
            raise WrongRequest(f"{self.folder} holds no history.h5; is it the results folder of a run?")
        try:
            file = h5py.File(self.path, "r", locking=False)
            if file.attrs.get("format") != "flowgmo history" or "time" not in file:
                raise PostprocError(f"{self.path} is not a history of flowgmo")
        except (OSError, RuntimeError, KeyError) as error:
            raise PostprocError(f"{self.path} is damaged: {' '.join(str(error).split())}") from error
        return file

    @property
    def title(self) -> str:
        return str(self.file.attrs.get("title", "")) or self.folder.stem

    @cached_property
    def t(self) -> np.ndarray:
        """Times of the rows (n,)."""
        return self._read("time")

    @property
    def time_unit(self) -> str:
        return str(self.file["time"].attrs.get("unit", "time"))

    @property
    def domain(self) -> np.ndarray | None:
        """Lowest and highest corner of the domain (2, 3)."""
        return np.asarray(self.file.attrs["domain"]) if "domain" in self.file.attrs else None

    @property
    def length_unit(self) -> str:
        """Unit of lengths; "" where an older history does not say."""
        return str(self.file.attrs.get("length_unit", ""))

    @cached_property
    def walls(self) -> set[str]:
        """Sides of the domain that are walls (IBCT 2), "Xmin" to "Zmax", as the deck kept in the file has them."""
        deck = self._read("deck") if "deck" in self.file else ""
        text = deck.decode() if isinstance(deck, bytes) else str(deck)
        return {SIDES[int(k) - 1] for k in re.findall(r"(?im)^\s*ibct\(([1-6])\)\s*=\s*2\b", text)}

    @cached_property
    def quantities(self) -> list[str]:
        """Names of everything that can be drawn, as in the file."""
        names: list[str] = []
        self.file.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
        return [name for name in names if name not in NOT_CURVES and name != "collisions/time"]

    @cached_property
    def bodies(self) -> dict[str, int]:
        """Names of the bodies that move -> their numbers, in the order of the deck."""
        group = self.file.get("bodies", {})
        numbers = {name: int(group[name].attrs.get("number", 0)) for name in group if "position" in group[name]}
        return dict(sorted(numbers.items(), key=lambda item: item[1]))

    @cached_property
    def parties(self) -> dict[int, str]:
        """Names of all that may collide, by number; sides of the domain are negative."""
        names = self.file["collisions"].attrs.get("names", []) if "collisions" in self.file else []
        split = (str(entry).split(" ", 1) for entry in names)
        return {int(number): name for number, name in split}

    @cached_property
    def impacts(self) -> dict[str, np.ndarray]:
        """Column -> values of all impacts; {} where the file has none."""
        group = self.file.get("collisions", {})
        columns = {name: self._read(f"collisions/{name}") for name in group}
        shortest = min((len(c) for c in columns.values()), default=0)
        return {name: c[:shortest] for name, c in columns.items()}

    def curve(self, name: str) -> Curve:
        """One quantity over time. Raises WrongRequest with the nearest names."""
        if name not in self.file or not isinstance(self.file[name], h5py.Dataset) or name in NOT_CURVES:
            raise WrongRequest(f"no quantity {name!r} in {self.path}{self.hint(name)}")
        t = self.impacts["time"] if name.startswith("collisions/") else self.t
        y = self._read(name)
        rows = min(len(t), len(y))  # a run that goes on may just be adding a row
        attrs = self.file[name].attrs
        y = y[:rows].reshape(rows, -1)
        columns = {1: ("",), 3: ("x", "y", "z"), 4: ("w", "x", "y", "z")}.get(y.shape[1])
        columns = columns or tuple(str(k + 1) for k in range(y.shape[1]))
        return Curve(name, t[:rows], y, str(attrs.get("unit", "")), str(attrs.get("meaning", "")), columns)

    def hint(self, name: str) -> str:
        """ "; did you mean ..." with up to three names near to a wrong one."""
        tail = name.rsplit("/", 1)[-1]
        near = difflib.get_close_matches(name, self.quantities, 3, 0.6)
        near += [q for q in self.quantities if difflib.SequenceMatcher(None, q.rsplit("/", 1)[-1], tail).ratio() > 0.8]
        near = list(dict.fromkeys(near))[:3]
        return f"; did you mean {' or '.join(near)}?" if near else "; --list shows what there is"

    def resolve(self, quantity: str, body: str | None) -> list[str]:
        """Full names of what the user calls `quantity`: `bodies/ball/position`, or `position` of one body or of all."""
        if body is not None and body not in self.bodies:
            near = difflib.get_close_matches(body, self.bodies, 1, 0.4)
            told = f"did you mean {near[0]}?" if near else f"there are {', '.join(list(self.bodies)[:8]) or 'none'}"
            raise WrongRequest(f"no moving body {body!r} in {self.path}; {told}")
        quantity = quantity.strip("/")
        if quantity in self.quantities:
            return [quantity]
        names = [body] if body is not None else list(self.bodies)
        found = [full for name in names if (full := f"bodies/{name}/{quantity}") in self.quantities]
        return found or [quantity if body is None or "/" in quantity else f"bodies/{body}/{quantity}"]

    def _read(self, name: str) -> np.ndarray:
        try:
            return self.file[name][()]
        except (OSError, RuntimeError, KeyError) as error:
            raise PostprocError(f"{self.path} is damaged at {name}: {' '.join(str(error).split())}") from error
