"""vtk/: bodies, the liquid's surface, and the fields in all cells at the snapshots; case.pvd, which ParaView opens.

    bodies_000012.vtp   points [length]; point data velocity [length/time]; cell data component (number in the deck),
                        kind (0 solid, 1 prescribed, 2 coupled), speed of the body's point [length/time]
    surface_000012.vtp  triangles of the liquid's surface (surface.py); none in it where there is none
    fields_000012.vtr   cell data p [pressure], F, velocity [length/time], V (cells.py); at full snapshots only
    case.pvd            the times, parts 0 bodies, 1 surface, 2 fields; valid after every snapshot

A surface is cut into triangles once and moved rigidly: x(t) = p + R (x(0) - p(0)), v(x) = v + w × (x - p).
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np

from flowgmo.bodies.body import COUPLED, PRESCRIBED, SOLID, Body
from flowgmo.model import Model
from flowgmo.output import vtk_files as files
from flowgmo.output.cells import cells_of, real
from flowgmo.output.errors import NotContinued, make_folder, replacing, writing
from flowgmo.output.surface import liquid_surface
from flowgmo.state import State

PARTS = {"bodies": "vtp", "surface": "vtp", "fields": "vtr"}
DIGITS = 6  # of the number in a file's name
KINDS = (SOLID, PRESCRIBED, COUPLED)
FINE, COARSE, MANY = 48, 24, 50  # triangles around a circle: fine, or coarse from so many bodies on (file size)


class Snapshots:
    """The series of snapshots of a run. `resume_at` [time]: continue, drop snapshots after that time.

    V: open fractions with ghosts, None without solids or liquid; may be set until the first `write`.
    """

    def __init__(self, folder: Path, model: Model, resume_at: float | None = None, V: np.ndarray | None = None) -> None:
        self.folder = Path(folder) / "vtk"
        self.model, self.V = model, V
        self._taken: list[tuple[float, list[str]]] = []  # times, and the parts written at each
        self._surfaces: Surfaces | None = None
        if not model.bodies and model.fluid is None:
            return
        make_folder(self.folder)
        with writing(self.folder / "case.pvd"):
            if resume_at is not None and (self.folder / "case.pvd").exists():
                self._taken = [(t, parts) for t, parts in self._read_times() if t <= resume_at]
            for part in PARTS:
                for file in self.folder.glob(f"{part}_*"):
                    if not file.stem[-DIGITS:].isdigit() or int(file.stem[-DIGITS:]) >= len(self._taken):
                        file.unlink()
        self._write_times()

    def write(self, state: State, full: bool = True) -> None:
        """Add what there is at the state's time; a second snapshot of the same time replaces the first.

        full: with the fields in all cells; else bodies and the liquid's surface only.
        """
        if not self.model.bodies and self.model.fluid is None:
            return
        if self._taken and self._taken[-1][0] == state.t:
            self._taken.pop()
        k, parts = len(self._taken), []
        if self.model.bodies:
            self._surfaces = self._surfaces or Surfaces(self.model)
            write_bodies(self._path("bodies", k), self._surfaces, state)
            parts.append("bodies")
        if state.fluid is not None and state.fluid.F is not None:
            self._write_surface(self._path("surface", k), state)
            parts.append("surface")
        if state.fluid is not None and full:
            self._write_fields(self._path("fields", k), state)
            parts.append("fields")
        self._taken.append((float(state.t), parts))
        self._write_times()

    def _write_surface(self, path: Path, state: State) -> None:
        closed = None if self.V is None else real(self.V) == 0.0
        points, faces = liquid_surface(
            real(state.fluid.F), closed, self.model.mesh.blocks[0].planes, self.model.gravity
        )
        files.write(path, files.triangles(points, faces, state.t))

    def _write_fields(self, path: Path, state: State) -> None:
        cells = cells_of(state.fluid, self.V, self.model.fluid.void_pressure)._asdict()
        if self.V is not None:
            cells["V"] = real(self.V)
        shown = {name: a for name, a in cells.items() if a is not None}
        files.write(path, files.rectilinear(self.model.mesh.blocks[0].planes, shown, state.t))

    def _path(self, part: str, k: int) -> Path:
        return self.folder / f"{part}_{k:0{DIGITS}d}.{PARTS[part]}"

    def _write_times(self) -> None:
        lines = [
            f'    <DataSet timestep="{t!r}" part="{list(PARTS).index(part)}" file="{self._path(part, k).name}"/>'
            for k, (t, parts) in enumerate(self._taken)
            for part in parts
        ]
        text = "\n".join(
            [
                '<?xml version="1.0"?>',
                '<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">',
                "  <Collection>",
                *lines,
                "  </Collection>",
                "</VTKFile>",
                "",
            ]
        )
        with replacing(self.folder / "case.pvd") as temporary:
            temporary.write_text(text)

    def _read_times(self) -> list[tuple[float, list[str]]]:
        path = self.folder / "case.pvd"
        try:
            taken: dict[float, list[str]] = {}
            for entry in ET.parse(path).iter("DataSet"):
                part = entry.attrib["file"].partition("_")[0]
                taken.setdefault(float(entry.attrib["timestep"]), []).append(part)
            return sorted(taken.items())
        except (ET.ParseError, KeyError, ValueError) as error:
            raise NotContinued(path, f"it is damaged, so it cannot be continued ({error})") from error


class Surfaces:
    """Triangles of all bodies, cut once: points at t = 0 relative to each body's point B, faces, owners."""

    def __init__(self, model: Model) -> None:
        domain = model.mesh.bounds
        resolution = FINE if len(model.bodies) < MANY else COARSE
        pieces = [_triangles(body, domain, resolution) for body in model.bodies]
        sizes = [len(points) for points, _ in pieces]
        starts = np.concatenate([[0], np.cumsum(sizes)])
        self.point_owner = np.repeat(np.arange(len(pieces)), sizes)
        self.face_owner = np.repeat(np.arange(len(pieces)), [len(faces) for _, faces in pieces])
        origins = np.array([body.origin for body in model.bodies], dtype=float)
        self.arms = np.concatenate([points for points, _ in pieces]) - origins[self.point_owner]
        self.faces = np.concatenate([faces + start for (_, faces), start in zip(pieces, starts, strict=False)])
        self.kinds = np.array([KINDS.index(body.kind) for body in model.bodies], dtype=np.int8)
        self.moves = np.array([body.moves for body in model.bodies])

    def at(self, state: State) -> tuple[np.ndarray, np.ndarray]:
        """Points (m, 3) [length] and their velocities (m, 3) [length/time]."""
        arms = np.einsum("mij,mj->mi", rotation(state.q_WB)[self.point_owner], self.arms)
        v, w = (np.where(self.moves[:, None], a, 0.0)[self.point_owner] for a in (state.v_WB, state.w_WB))
        return state.p_WB[self.point_owner] + arms, v + np.cross(w, arms)


def rotation(q: np.ndarray) -> np.ndarray:
    """Rotation matrices (n, 3, 3), body to space, of unit quaternions (n, 4) w x y z."""
    w, x, y, z = q.T
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    ).transpose(2, 0, 1)


def _triangles(body: Body, domain: np.ndarray, resolution: int) -> tuple[np.ndarray, np.ndarray]:
    """Stationary solids end at the domain, and so does what has no end of its own; other bodies are shown whole."""
    bounded = np.isfinite(body.shape.bounds()).all()
    clip = None if body.moves and bounded else domain
    points, faces = body.shape.triangles(resolution, clip)
    return np.asarray(points, dtype=float).reshape(-1, 3), np.asarray(faces, dtype=np.int64).reshape(-1, 3)


def write_bodies(path: Path, surfaces: Surfaces, state: State) -> None:
    """One .vtp file of all bodies."""
    points, velocity = surfaces.at(state)
    speed = np.where(surfaces.moves, np.linalg.norm(state.v_WB, axis=1), 0.0)
    owner = surfaces.face_owner
    data = files.triangles(points, surfaces.faces, state.t)
    data.GetPointData().SetVectors(files.numbers(velocity, np.float32, "velocity"))
    data.GetCellData().AddArray(files.numbers(owner + 1, np.int32, "component"))
    data.GetCellData().AddArray(files.numbers(surfaces.kinds[owner], np.int8, "kind"))
    data.GetCellData().AddArray(files.numbers(speed[owner], np.float32, "speed"))
    files.write(path, data)
