"""history.h5: how bodies and liquid moved, one dataset per body or gauge and quantity (layout: history_layout.py).

Rows wait in memory and go to the file in one go, each time followed by a flush of HDF5. When `flush()` returns, all
rows so far are safe: a run killed later leaves a readable file that lacks only what came after. Killed inside a flush
(milliseconds), the file still opens but the last rows of some datasets may be unreadable (measured: 2 of 40 kills of a
run that did nothing but flush). The file is only ever appended to, and may be read while a run goes on
(h5py.File(path, locking=False)).
"""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np

from flowgmo.mesh import SIDE_NAMES
from flowgmo.model import Model
from flowgmo.output import history_layout as layout
from flowgmo.output.errors import NotContinued, make_folder, make_sure_of_room, reason_of, writing
from flowgmo.output.software import versions
from flowgmo.output.units import unit
from flowgmo.records import IMPACT, REGIMES, Rows

LONGEST_CHUNK = 512  # rows; a vector of 512 rows is 12 kB, enough to read fast and little to waste on a short run
TABLE_OVERHEAD = 8 << 10  # bytes of a table besides its rows, at most: header, attributes, index of its chunks
FULL_BUFFER = 32 << 20  # bytes of rows kept in memory before they are written


class History:
    """The open history of a run. `resume_at` [time]: continue, keep rows up to and including that time."""

    def __init__(self, folder: Path, model: Model, resume_at: float | None = None) -> None:
        self.path = make_folder(Path(folder)) / "history.h5"
        self.model = model
        self._waiting: list[Rows] = []
        self._waiting_bytes = 0
        self._impacts: list[np.ndarray] = []
        self._tables: dict[str, h5py.Dataset] = {}
        self._has_tables = False
        expected = len(model.output.history.times(model.clock.end)) + 1
        self._chunk = int(np.clip(expected, 16, LONGEST_CHUNK))  # 16: HDF5 pays about 100 bytes for each chunk
        if resume_at is not None and self.path.exists():
            self._reopen(resume_at)
        else:
            self.path.unlink(missing_ok=True)
            make_sure_of_room(self.path, 2 * len(model.resolved_deck) + 50 * TABLE_OVERHEAD)
            with writing(self.path):
                self._create()

    def write(self, rows: Rows) -> None:
        """Add rows; they are in the file at the latest after the next `flush()`."""
        if len(rows.t) == 0:
            return
        self._waiting.append(rows)
        self._waiting_bytes += rows.p_WB.nbytes * 5 + sum(a.nbytes for a in rows.liquid.values())  # 5 vectors a body
        if self._waiting_bytes > FULL_BUFFER:
            self.flush()

    def write_impacts(self, impacts: np.ndarray) -> None:
        """Add impacts, an array of dtype records.IMPACT."""
        if len(impacts):
            self._impacts.append(impacts.copy())

    def flush(self) -> None:
        """Write what waits. What was given so far survives whatever happens to the run from now on."""
        if not (self._waiting or self._impacts):
            return
        make_sure_of_room(self.path, self._needed())
        with writing(self.path):
            if self._waiting:
                self._append_rows(self._waiting)
                self._waiting, self._waiting_bytes = [], 0
            if self._impacts:
                self._append_impacts(np.concatenate(self._impacts))
                self._impacts = []
            self._file.flush()

    def _needed(self) -> int:
        """Bytes that a flush adds to the file, at most: all rows in whole chunks."""
        rows = sum(len(r.t) for r in self._waiting)
        hits = sum(len(impacts) for impacts in self._impacts)
        width = sum(np.prod(column.columns, dtype=int) for column in layout.BODY) * len(self.model.moving)
        liquid = self._waiting[0].liquid if self._waiting else {}
        width += sum(np.prod(a.shape[1:], dtype=int) for a in liquid.values())
        tables = len(self._tables)
        if not self._has_tables:
            tables += len(layout.BODY) * len(self.model.moving) + len(liquid) + len(self.model.output.probes)
        chunks = (rows + self._chunk) * (1 + width + len(layout.ENERGY)) * 8
        return int(chunks + (hits + self._chunk) * IMPACT.itemsize + tables * TABLE_OVERHEAD)

    def close(self) -> None:
        """Write what waits and close the file; calling it again does nothing."""
        if not self._file:
            return
        try:
            self.flush()
        finally:
            with writing(self.path):
                self._file.close()

    # ---- the file

    def _create(self) -> None:
        # libver v108: a newer superblock would mark the file as open for writing and lock out readers after a kill
        self._file = h5py.File(self.path, "w", libver=("v108", "v108"))
        model, file = self.model, self._file
        file.attrs.update({"format": layout.FORMAT, "format_version": layout.FORMAT_VERSION, "title": model.title})
        file.attrs.update({"units": model.units, "bodies": len(model.bodies)})
        file.attrs.update({"domain": model.mesh.bounds, "gravity": model.gravity})
        file.attrs["length_unit"] = unit("length", model.units)
        file.attrs.update({f"version_{name}": value for name, value in versions().items()})
        file.create_dataset("deck", data=model.resolved_deck or "\n", dtype=h5py.string_dtype())
        file["deck"].attrs["meaning"] = "complete deck, defaults filled in"
        self._table("time", (), "time", "", "time of each row")
        group = file.create_group("collisions")
        group.attrs["names"] = _party_names(model)
        group.attrs["meaning"] = "one row per impact; a cluster has one row per contact"
        for name, (columns, quantity, meaning) in layout.COLLISIONS.items():
            where = "space axes" if columns else ""
            self._table(f"collisions/{name}", columns, quantity, where, meaning, IMPACT[name].base)
        group["regime"].attrs["names"] = list(REGIMES)
        file.create_group("bodies").attrs["meaning"] = (
            "bodies that move, or whose load is recorded, by their names in the deck (OBSID)"
        )
        file.create_group("energy").attrs["meaning"] = "books of energy"
        file.flush()

    def _table(
        self, name: str, columns: tuple[int, ...], quantity: str, location: str, meaning: str, kind: object = "f8"
    ) -> h5py.Dataset:
        """A growing dataset (0, *columns) with its unit, location, and meaning."""
        table = self._file.create_dataset(
            name, (0, *columns), kind, maxshape=(None, *columns), chunks=(self._chunk, *columns)
        )
        table.attrs["unit"] = unit(quantity, self.model.units)
        if location:
            table.attrs["location"] = location
        table.attrs["meaning"] = meaning
        self._tables[name] = table
        return table

    def _create_tables(self, rows: Rows) -> None:
        """Tables of what the first rows hold: None in them means that the scene does not have the quantity."""
        self._has_tables = True
        for body in self.model.moving:
            group = self._file["bodies"].create_group(body.name)
            group.attrs.update({"number": body.number, "kind": body.kind, "constraint": body.constraint})
            if body.mass is not None:
                group.attrs["mass"] = body.mass.mass
                group.attrs["mass_unit"] = unit("mass", self.model.units)
            for column in layout.BODY:
                if getattr(rows, column.source) is None:
                    continue
                name = f"bodies/{body.name}/{column.name}"
                table = self._table(name, column.columns, column.quantity, column.location, column.meaning)
                if column.name == "position":
                    table.attrs["point"] = "reference point" if body.mass is None else "mass centre"
        for name in rows.energy:
            self._table(f"energy/{name}", (), "energy", "whole scene", layout.ENERGY.get(name, name))
        for name in rows.liquid:
            column = layout.liquid_column(name, tuple(body.name for body in self.model.moving))
            self._table(name, column.columns, column.quantity, column.location, column.meaning)
        if rows.liquid:
            self._describe_gauges()

    def _describe_gauges(self) -> None:
        """What and where the gauges of the liquid are."""
        model, file = self.model, self._file
        for number, place in zip(model.output.probe_numbers, model.output.probes, strict=True):
            x = file.create_dataset(f"probes/{number}/x", data=place)
            x.attrs.update({"unit": unit("length", model.units), "meaning": "place of the probe"})
        for plane in model.fluid.planes:
            group = file[f"planes/{plane.number}"]
            group.attrs.update({"axis": "xyz"[plane.axis], "position": plane.position, "lo": plane.lo, "hi": plane.hi})
        for load in model.fluid.loads:
            body = model.bodies[load.body - 1]
            group = file[f"bodies/{body.name}"]
            group.attrs.update({"number": body.number, "kind": body.kind, "point": load.point})

    def _append_rows(self, waiting: list[Rows]) -> None:
        if not self._has_tables:
            self._create_tables(waiting[0])
        _append(self._tables["time"], np.concatenate([r.t for r in waiting]))
        for column in layout.BODY:
            if getattr(waiting[0], column.source) is None:
                continue
            values = np.concatenate([getattr(r, column.source) for r in waiting])
            by_body = np.ascontiguousarray(np.moveaxis(values, 1, 0))
            for body in self.model.moving:
                _append(self._tables[f"bodies/{body.name}/{column.name}"], by_body[body.number - 1])
        for name in waiting[0].energy:
            _append(self._tables[f"energy/{name}"], np.concatenate([r.energy[name] for r in waiting]))
        for name in waiting[0].liquid:
            _append(self._tables[name], np.concatenate([r.liquid[name] for r in waiting]))

    def _append_impacts(self, impacts: np.ndarray) -> None:
        for name in layout.COLLISIONS:
            _append(self._tables[f"collisions/{name}"], np.ascontiguousarray(impacts[name]))

    def _reopen(self, resume_at: float) -> None:
        try:
            self._file = h5py.File(self.path, "r+", libver=("v108", "v108"))
            wrong = self._remember_tables()
        except (OSError, RuntimeError, ValueError, KeyError) as error:
            wrong = f"it is damaged ({reason_of(error)})"
        if wrong:
            if hasattr(self, "_file"):
                self._file.close()
            raise NotContinued(self.path, f"{wrong}, so it cannot be continued. Name another folder with -o")
        with writing(self.path):
            self._forget_after(resume_at)

    def _remember_tables(self) -> str:
        """Find the tables of the file; what is wrong with it, empty if nothing is."""
        if self._file.attrs.get("format") != layout.FORMAT:
            return "it is not a history of flowgmo"
        self._file.visititems(self._remember)
        if not {"time", "collisions/time"} <= set(self._tables):
            return "it is damaged (tables are missing)"
        self._has_tables = any(name.startswith(("bodies/", "fluid/")) for name in self._tables)
        if self._has_tables and set(self._file["bodies"]) != self._recorded_bodies():
            return "it holds other bodies than the deck"
        return ""

    def _recorded_bodies(self) -> set[str]:
        """Names of the bodies that move, and of those whose load is recorded."""
        loads = self.model.fluid.loads if self.model.fluid is not None else ()
        return {body.name for body in self.model.moving} | {self.model.bodies[load.body - 1].name for load in loads}

    def _forget_after(self, resume_at: float) -> None:
        rows = int(np.searchsorted(self._tables["time"][:], resume_at, side="right"))
        keep = np.flatnonzero(self._tables["collisions/time"][:] <= resume_at)
        for name, table in self._tables.items():
            if not name.startswith("collisions/"):
                table.resize(min(rows, len(table)), axis=0)
                continue
            kept = table[:][keep]
            table.resize(len(keep), axis=0)
            table[...] = kept
        self._file.flush()

    def _remember(self, name: str, item: object) -> None:
        if isinstance(item, h5py.Dataset) and item.maxshape and item.maxshape[0] is None:
            self._tables[name] = item


def impacts_until(folder: Path, t: float) -> np.ndarray:
    """The impacts (dtype IMPACT) that a history holds up to time t; none where there is no history to go on with."""
    path = Path(folder) / "history.h5"
    out = np.zeros(0, IMPACT)
    try:
        with h5py.File(path) as file:
            group = file.get("collisions")
            if group is not None:
                out = np.zeros(len(group["time"]), IMPACT)
                for name in IMPACT.names:
                    out[name] = group[name][()]
    except (OSError, KeyError, ValueError):
        return np.zeros(0, IMPACT)  # History says what is wrong with it
    return out[out["time"] <= t]


def _append(table: h5py.Dataset, values: np.ndarray) -> None:
    """Add rows at the end, past h5py's high-level indexing, which costs more than the writing of a few rows."""
    start, count = table.shape[0], len(values)
    values = np.ascontiguousarray(values, dtype=table.dtype)
    columns = values.shape[1:]
    table.id.set_extent((start + count, *columns))
    place = table.id.get_space()
    place.select_hyperslab((start,) + (0,) * len(columns), values.shape)
    table.id.write(h5py.h5s.create_simple(values.shape), place, values)


def _party_names(model: Model) -> list[str]:
    """ "number name" of all that may take part in a collision."""
    sides = [f"{-1 - k} {name}" for k, name in enumerate(SIDE_NAMES)]
    return [*reversed(sides), "0 limit", *(f"{body.number} {body.name}" for body in model.bodies)]
