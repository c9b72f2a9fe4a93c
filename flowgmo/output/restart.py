"""restart.h5: the exact State. What is read is bit for bit what was written."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path

import h5py
import numpy as np

from flowgmo.flow.fields import Flow
from flowgmo.mesh import GHOST_LAYERS
from flowgmo.model import Model
from flowgmo.output.deck_text import assignments
from flowgmo.output.errors import RestartError, make_folder, reason_of, replacing, writing
from flowgmo.output.software import versions
from flowgmo.state import State, initial_state

FORMAT = "flowgmo restart"
FORMAT_VERSION = 12  # raised whenever State changes

#: Deck variables that may change between a run and its continuation: the end, the steps (their defaults follow from
#: the end), how far the pressure is solved (a run in which it does not converge ends, and asks for that), and when
#: output is written.
MAY_CHANGE = {
    "twfin", "itwfin", "frcfin", "tstdy", "delt", "dtmin", "tdtmax", "teditdt", "itmax", "epsadj",
    "tpltd", "tapltd", "thpltd", "tprtd", "tsprtd", "tedit", "esprtdt", "restart_dt", "remark",
}  # fmt: skip
GROWING = ("held_parts", "held_values")  # one row per contact
MOST_DIFFERENCES = 5  # shown in an error text


def write_restart(path: Path, model: Model, state: State) -> None:
    """Write the state beside the old file, then put it in its place.

    The file is made in memory: HDF5 does not survive a disk that fills up while it writes.
    """
    path = Path(path)
    make_folder(path.parent)
    with writing(path), h5py.File(path.name, "w", driver="core", backing_store=False) as file:
        file.attrs.update({"format": FORMAT, "format_version": FORMAT_VERSION, "title": model.title})
        file.attrs.update({f"version_{name}": value for name, value in versions().items()})
        file.create_dataset("deck", data=model.resolved_deck or "\n", dtype=h5py.string_dtype())
        file.create_dataset("bodies", data=[_identity(body) for body in model.bodies], dtype=h5py.string_dtype())
        group = file.create_group("state")
        for field in fields(State):
            value = getattr(state, field.name)
            if isinstance(value, Flow):
                _write_flow(group.create_group(field.name), value)
            elif value is not None:
                group.create_dataset(field.name, data=value)
        file.flush()
        image = file.id.get_file_image()
    with replacing(path) as temporary:
        temporary.write_bytes(image)


def read_restart(path: Path, model: Model) -> State:
    """The state in a file of `write_restart` of the same scene. Raises RestartError with what is wrong."""
    path = Path(path)
    if not path.is_file():
        raise RestartError(f"there is no restart file {path}")
    try:
        with h5py.File(path, "r", locking=False) as file:
            _check_kind(path, file)
            _check_scene(path, file, model)
            return _state(path, file["state"], model)
    except (OSError, RuntimeError, KeyError, ValueError, TypeError) as error:
        raise RestartError(f"{path} is not a readable restart file: {reason_of(error)}") from error


def _identity(body) -> str:  # noqa: ANN001 (a Body)
    return f"{body.name} ({body.kind}, {body.constraint})"


def _check_kind(path: Path, file: h5py.File) -> None:
    if file.attrs.get("format") != FORMAT:
        raise RestartError(f"{path} is not a restart file of flowgmo")
    version = file.attrs["format_version"]
    if version != FORMAT_VERSION:
        writer = file.attrs.get("version_flowgmo", "unknown")
        raise RestartError(
            f"{path} has restart format {version}, written by flowgmo {writer}; this one reads format {FORMAT_VERSION}"
        )


def _check_scene(path: Path, file: h5py.File, model: Model) -> None:
    """The bodies and every deck line that acts on the answer must be the same."""
    there = [name.decode() for name in file["bodies"][:]]
    here = [_identity(body) for body in model.bodies]
    if len(there) != len(here):
        raise RestartError(f"{path} holds {len(there)} bodies, the deck has {len(here)}")
    for number, (old, new) in enumerate(zip(there, here, strict=True), start=1):
        if old != new:
            raise RestartError(f"{path} was written for another deck: component {number} was {old}, is {new}")
    old, new = (assignments(text) for text in (file["deck"][()].decode(), model.resolved_deck or "\n"))
    differ = [k for k in sorted({*old, *new}) if old.get(k) != new.get(k) and _base(k) not in MAY_CHANGE]
    if differ:
        shown = [f"{k.upper()} was {old.get(k, 'not there')}, is {new.get(k, 'not there')}" for k in differ]
        more = f"; and {len(shown) - MOST_DIFFERENCES} more" if len(shown) > MOST_DIFFERENCES else ""
        raise RestartError(f"{path} was written for another deck: {'; '.join(shown[:MOST_DIFFERENCES])}{more}")


def _base(key: str) -> str:
    return key.partition("(")[0]


def _state(path: Path, group: h5py.Group, model: Model) -> State:
    state = initial_state(model)
    for field in fields(State):
        old = getattr(state, field.name)
        if old is None:
            continue
        value = group[field.name][()]
        if isinstance(old, np.ndarray):
            shape = value.shape[1:] if field.name in GROWING else value.shape
            wanted = old.shape[1:] if field.name in GROWING else old.shape
            if shape != wanted or value.dtype != old.dtype:
                raise RestartError(f"{path} is damaged: {field.name} has shape {value.shape} instead of {old.shape}")
            if value.dtype.kind == "f" and not np.isfinite(value).all():
                raise RestartError(f"{path} is damaged: {field.name} is not finite")
        else:
            value = type(old)(value)
        setattr(state, field.name, value)
    if model.fluid is not None:
        state.fluid = _flow(path, group["fluid"], model)
    return state


def _write_flow(group: h5py.Group, flow: Flow) -> None:
    for field in fields(Flow):
        value = getattr(flow, field.name)
        if value is not None:
            group.create_dataset(field.name, data=value)


def _flow(path: Path, group: h5py.Group, model: Model) -> Flow:
    """The liquid: arrays of the mesh's size with ghosts, books, numbers."""
    wanted = tuple(n + 2 * GHOST_LAYERS for n in model.mesh.blocks[0].shape)
    values = {field.name: group[field.name][()] if field.name in group else None for field in fields(Flow)}
    for name, value in values.items():
        if value is None:
            continue
        if (np.ndim(value) >= 3 and value.shape[:3] != wanted) or not np.isfinite(value).all():
            raise RestartError(f"{path} is damaged: fluid/{name} has shape {np.shape(value)}, or is not finite")
        values[name] = float(value) if np.ndim(value) == 0 else value
    return Flow(**values)
