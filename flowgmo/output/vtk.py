"""vtk/: the surfaces of all bodies at the snapshots, and case.pvd, which ParaView opens.

    bodies_000012.vtp   points [length]; point data velocity [length/time]; cell data component (number in the deck),
                        kind (0 solid, 1 prescribed, 2 coupled), speed of the body's point [length/time]
    case.pvd            the times; valid after every snapshot

A surface is cut into triangles once and moved rigidly: x(t) = p + R (x(0) - p(0)), v(x) = v + w × (x - p).
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np

from flowgmo.bodies.body import COUPLED, PRESCRIBED, SOLID, Body
from flowgmo.model import Model
from flowgmo.output.errors import NotContinued, make_folder, replacing, writing
from flowgmo.state import State

KINDS = (SOLID, PRESCRIBED, COUPLED)
FINE, COARSE, MANY = 48, 24, 50  # triangles around a circle: fine, or coarse from so many bodies on (file size)


class Snapshots:
    """The series of snapshots of a run. `resume_at` [time]: continue, drop snapshots after that time."""

    def __init__(self, folder: Path, model: Model, resume_at: float | None = None) -> None:
        self.folder = Path(folder) / "vtk"
        self.model = model
        self._times: list[float] = []
        self._surfaces: Surfaces | None = None
        if not model.bodies:
            return
        make_folder(self.folder)
        with writing(self.folder / "case.pvd"):
            if resume_at is not None and (self.folder / "case.pvd").exists():
                self._times = [t for t in self._read_times() if t <= resume_at]
            for file in sorted(self.folder.glob("bodies_*.vtp"))[len(self._times) :]:
                file.unlink()
        self._write_times()

    def write(self, state: State) -> None:
        """Add the bodies at the state's time; a second snapshot of the same time replaces the first."""
        if not self.model.bodies:
            return
        if self._surfaces is None:
            self._surfaces = Surfaces(self.model)
        if self._times and self._times[-1] == state.t:
            self._times.pop()
        write_polydata(self.folder / self._name(len(self._times)), self._surfaces, state)
        self._times.append(float(state.t))
        self._write_times()

    @staticmethod
    def _name(k: int) -> str:
        return f"bodies_{k:06d}.vtp"

    def _write_times(self) -> None:
        lines = [f'    <DataSet timestep="{t!r}" part="0" file="{self._name(k)}"/>' for k, t in enumerate(self._times)]
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

    def _read_times(self) -> list[float]:
        path = self.folder / "case.pvd"
        try:
            return [float(entry.attrib["timestep"]) for entry in ET.parse(path).iter("DataSet")]
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


def write_polydata(path: Path, surfaces: Surfaces, state: State) -> None:
    """One .vtp file, compressed, numbers in single precision."""
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData

    points, velocity = surfaces.at(state)
    speed = np.where(surfaces.moves, np.linalg.norm(state.v_WB, axis=1), 0.0)
    owner = surfaces.face_owner

    def array(values: np.ndarray, kind: type, name: str) -> object:
        made = numpy_to_vtk(np.ascontiguousarray(values, dtype=kind), deep=True)
        made.SetName(name)
        return made

    data, corners, cells = vtkPolyData(), vtkPoints(), vtkCellArray()
    corners.SetData(array(points, np.float32, "Points"))
    ends = np.arange(0, 3 * len(surfaces.faces) + 1, 3)
    cells.SetData(array(ends, np.int32, "offsets"), array(surfaces.faces.ravel(), np.int32, "connectivity"))
    data.SetPoints(corners)
    data.SetPolys(cells)
    data.GetPointData().SetVectors(array(velocity, np.float32, "velocity"))
    data.GetCellData().AddArray(array(owner + 1, np.int32, "component"))
    data.GetCellData().AddArray(array(surfaces.kinds[owner], np.int8, "kind"))
    data.GetCellData().AddArray(array(speed[owner], np.float32, "speed"))
    data.GetFieldData().AddArray(array([state.t], np.float64, "TimeValue"))
    with replacing(path) as temporary:
        temporary.write_bytes(_encoded(data))


def _encoded(data: object) -> bytes:
    """The content of a .vtp file. Python writes it, since VTK prints what fails instead of raising it."""
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

    writer = vtkXMLPolyDataWriter()
    writer.SetInputData(data)
    writer.SetDataModeToAppended()
    writer.EncodeAppendedDataOff()
    writer.SetCompressorTypeToZLib()
    writer.WriteToOutputStringOn()
    writer.Write()
    content = writer.GetOutputString()  # bytes, or text where they happen to be UTF-8
    return content.encode() if isinstance(content, str) else content
