"""fields.h5: snapshots of the liquid, for Python users; the same as the .vtr files.

    x y z          planes of the mesh (n + 1,) [length]          V   open fraction of the cells, where there are solids
    deck           complete deck
                                                             (among bodies that move one in each snapshot)
    000000/ ...    one group for each snapshot, attribute `time`: p, F (nx, ny, nz), velocity (nx, ny, nz, 3), float32

A cell [i, j, k] lies between x[i] and x[i + 1], and so on. The file is opened for each snapshot, made longer by a group
and closed: between snapshots it is whole and closed, whatever happens to the run. A snapshot that is being written has
no `time` until all of it is there; readers skip it (`snapshots`), and a run that continues removes it.
"""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np

from flowgmo.model import Model
from flowgmo.output.cells import cells_of, real
from flowgmo.output.errors import NotContinued, make_folder, make_sure_of_room, reason_of, writing
from flowgmo.output.software import versions
from flowgmo.output.units import unit
from flowgmo.state import State

FORMAT, FORMAT_VERSION = "flowgmo fields", 1
#: v108: as in history.py; no lock: someone who has the file open to look at it must not end the run
FILE = {"libver": ("v108", "v108"), "locking": False}
OVERHEAD = 64 << 10  # bytes of a snapshot besides its numbers: headers, index of the chunks
CHUNK = 1 << 18  # numbers in a chunk: 1 MB is quick to read, and compresses as well as larger ones
MEANING = {
    "p": ("pressure", "pressure; where there is no liquid that of the void"),
    "F": ("none", "liquid volume / open volume"),
    "velocity": ("velocity", "velocity x y z; 0 where there is no liquid"),
}


class Fields:
    """The series of snapshots of a run. `resume_at` [time]: continue, drop what is later.

    V: open fractions with ghosts, None without solids; may be set until the first `write`, which puts it in the file.
    """

    def __init__(self, folder: Path, model: Model, resume_at: float | None = None, V: np.ndarray | None = None) -> None:
        self.path = make_folder(Path(folder)) / "fields.h5"
        self.model, self.V = model, V
        if resume_at is not None and self.path.exists():
            self._reopen(resume_at)
        else:
            self.path.unlink(missing_ok=True)
            make_sure_of_room(self.path, 2 * len(model.resolved_deck) + OVERHEAD + 8 * sum(model.mesh.blocks[0].shape))
            with writing(self.path), h5py.File(self.path, "w", **FILE) as file:
                self._create(file)

    def write(self, state: State) -> None:
        """Add the liquid at the state's time; a second snapshot of the same time is left out."""
        cells = cells_of(state.fluid, self.V, self.model.fluid.void_pressure)
        arrays = {name: a for name, a in cells._asdict().items() if a is not None}
        room = sum(a.nbytes for a in arrays.values()) + cells.p.nbytes  # the last for V
        make_sure_of_room(self.path, room + OVERHEAD)
        with writing(self.path), h5py.File(self.path, "r+", **FILE) as file:
            there = snapshots(file)
            if there and there[-1][0] == state.t:
                return
            group = file.create_group(f"{len(there):06d}")
            place = group if self.model.moving else file
            if self.V is not None and "V" not in place:
                table = _table(place, "V", real(self.V).astype(np.float32))
                table.attrs.update({"unit": "1", "location": "cells", "meaning": "open volume / whole volume"})
            for name, values in arrays.items():
                quantity, meaning = MEANING[name]
                table = _table(group, name, values)
                table.attrs.update({"unit": unit(quantity, self.model.units), "location": "cells", "meaning": meaning})
            file.flush()
            group.attrs["step"] = state.step
            group.attrs["time"] = state.t

    def _create(self, file: h5py.File) -> None:
        model = self.model
        (block,) = model.mesh.blocks
        file.attrs.update({"format": FORMAT, "format_version": FORMAT_VERSION, "title": model.title})
        file.attrs.update({"units": model.units, "time_unit": unit("time", model.units)})
        file.attrs.update({f"version_{name}": value for name, value in versions().items()})
        file.create_dataset("deck", data=model.resolved_deck or "\n", dtype=h5py.string_dtype())
        file["deck"].attrs["meaning"] = "complete deck, defaults filled in"
        for name, planes in zip("xyz", block.planes, strict=True):
            table = file.create_dataset(name, data=planes)
            table.attrs.update({"unit": unit("length", model.units), "meaning": f"planes of the mesh along {name}"})

    def _reopen(self, resume_at: float) -> None:
        """Remove what is later than the restart, or not whole."""
        try:
            with h5py.File(self.path, "r+", **FILE) as file:
                if file.attrs.get("format") != FORMAT:
                    raise ValueError("it is not a file of flowgmo's fields")
                shape = tuple(len(file[name]) - 1 for name in "xyz")
                if shape != self.model.mesh.blocks[0].shape:
                    raise ValueError("it holds another mesh")
                kept = {name for t, name in snapshots(file) if t <= resume_at}
                for name in [n for n, item in file.items() if isinstance(item, h5py.Group) and n not in kept]:
                    del file[name]
        except (OSError, RuntimeError, ValueError, KeyError) as error:
            reason = f"it cannot be continued ({reason_of(error)}). Name another folder with -o"
            raise NotContinued(self.path, reason) from error


def snapshots(file: h5py.File) -> list[tuple[float, str]]:
    """Times and names of the whole snapshots, in order."""
    groups = [(name, item) for name, item in file.items() if isinstance(item, h5py.Group)]
    return sorted((float(item.attrs["time"]), name) for name, item in groups if "time" in item.attrs)


def _table(group: h5py.Group, name: str, values: np.ndarray) -> h5py.Dataset:
    """A compressed dataset; chunks are slabs of whole planes along the first direction."""
    slab = max(1, min(values.shape[0], CHUNK // max(1, int(np.prod(values.shape[1:])))))
    return group.create_dataset(
        name, data=values, chunks=(slab, *values.shape[1:]), compression="gzip", compression_opts=1, shuffle=True
    )
