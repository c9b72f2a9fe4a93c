"""A run at any time: bodies, surfaces of a snapshot moved to the poses that history.h5 gives, and the liquid.

x(t) = p(t) + R(t) R(t0)^T (x(t0) - p(t0))
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from postproc.errors import PostprocError, WrongRequest
from postproc.results import Results

SOLID = 0  # `kind` of a stationary component in the .vtp files


@dataclass(frozen=True)
class Surface:
    """One body: number and name, whether it is stationary, points (n, 3), faces (m, 3), speed of its point."""

    number: int
    name: str
    stationary: bool
    points: np.ndarray
    faces: np.ndarray
    speed: float


class Scene:
    """All surfaces of a run: those of bodies, and the liquid's."""

    liquid_times: np.ndarray = np.zeros(0)
    liquid_files: tuple[Path, ...] = ()

    def __init__(self, results: Results) -> None:
        self.results = results
        parts = _read_collection(results.folder / "vtk" / "case.pvd")
        self.times, self.files = parts.get("bodies", (np.zeros(0), []))
        self._start = _read_surfaces(self.files[0], self.names) if self.files else []
        if "surface" in parts:
            self.liquid_times, self.liquid_files = parts["surface"]
            self.times = self.times if self.files else self.liquid_times

    @property
    def has_liquid(self) -> bool:
        return len(self.liquid_files) > 0

    def shown_time(self, t: float) -> float:
        """The time that a picture of t shows: liquid is there at its snapshots only."""
        return float(self.liquid_times[np.abs(self.liquid_times - t).argmin()]) if self.has_liquid else t

    def liquid(self, t: float) -> tuple[np.ndarray, np.ndarray] | None:
        """Points (n, 3) and triangles (m, 3) of the liquid's surface at the snapshot nearest to t; None without."""
        if not self.has_liquid:
            return None
        data = _read_polydata(self.liquid_files[int(np.abs(self.liquid_times - t).argmin())])
        return (_points(data), _faces(data)) if data.GetNumberOfCells() else None

    @cached_property
    def names(self) -> dict[int, str]:
        if not self.results.path.is_file():
            return {}
        return self.results.parties | {number: name for name, number in self.results.bodies.items()}

    @property
    def time_unit(self) -> str:
        return self.results.time_unit if self.has_history else ""

    @property
    def moving(self) -> list[int]:
        """Numbers of the bodies that move."""
        return [surface.number for surface in self._start if not surface.stationary]

    @property
    def speed_label(self) -> str:
        first = next(iter(self.results.bodies), None) if self.has_history else None
        unit = self.results.curve(f"bodies/{first}/velocity").unit if first else ""
        return f"speed [{unit}]" if unit else "speed"

    @property
    def end(self) -> float:
        return max(float(self.times[-1]), float(self.results.t[-1]) if self.has_history else 0.0)

    @cached_property
    def has_history(self) -> bool:
        """Whether there is a history with rows."""
        return self.results.path.is_file() and len(self.results.t) > 0

    @property
    def _last_row(self) -> float:
        """Time of the last row of the history; the snapshots' times are rounded."""
        return float(self.results.t[-1]) * (1.0 + 1e-6)

    @cached_property
    def bounds(self) -> np.ndarray:
        """(2, 3): the domain; without a history, what the solids and the moving bodies reach."""
        if self.has_history and self.results.domain is not None:
            return self.results.domain
        points = np.concatenate([p for t in (self.times[0], self.end) for p in self._all_points(t)] or [np.eye(3)])
        return np.array([points.min(axis=0), points.max(axis=0)])

    def _all_points(self, t: float) -> list[np.ndarray]:
        liquid = self.liquid(t)
        return [s.points for s in self.at(t)] + ([liquid[0]] if liquid else [])

    def at(self, t: float) -> list[Surface]:
        """Surfaces at a time: exact poses where there is a history, else those of the nearest snapshot.

        A run that was killed has snapshots after the last row of its history.
        """
        if not self._start:
            return []
        if not self.has_history or (self.files and min(t, float(self.times[-1])) > self._last_row):
            return self.snapshot(t)
        return [self._moved(surface, t) for surface in self._start]

    def snapshot(self, t: float) -> list[Surface]:
        """Surfaces of the snapshot nearest to a time, as they were written; [] without bodies."""
        return _read_surfaces(self.files[int(np.abs(self.times - t).argmin())], self.names) if self.files else []

    def track(self, surface: Surface) -> tuple[np.ndarray, np.ndarray] | None:
        """Positions (n, 3) and orientations (n, 4; w x y z) of a body in the rows of the history; None without it."""
        if not self.has_history or surface.name not in self.results.bodies:
            return None
        return self._tracks(surface.name)[:2]

    def pose(self, surface: Surface, t: float) -> tuple[np.ndarray, np.ndarray]:
        """Position (3,) and orientation (4,) at a time, of a body that has a track."""
        p, q = (np.array([np.interp(t, self.results.t[: len(y)], c) for c in y.T]) for y in self.track(surface))
        return p, q

    def _moved(self, surface: Surface, t: float) -> Surface:
        if surface.stationary or surface.name not in self.results.bodies:
            return surface
        p0, R0, _ = self._pose(surface.name, float(self.times[0]))
        p, R, speed = self._pose(surface.name, t)
        points = p + (surface.points - p0) @ (R @ R0.T).T
        return Surface(surface.number, surface.name, False, points, surface.faces, speed)

    def _pose(self, name: str, t: float) -> tuple[np.ndarray, np.ndarray, float]:
        """Position (3,), rotation (3, 3), and speed of a body, linear between rows."""
        p, q, v = self._tracks(name)
        rows = self.results.t[: len(p)]

        def at(values: np.ndarray) -> np.ndarray:
            return np.array([np.interp(t, rows, column) for column in values.T])

        return at(p), rotation(at(q)), float(np.linalg.norm(at(v)))

    def _tracks(self, name: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        if name not in self._known:
            names = ("position", "orientation", "velocity")
            self._known[name] = tuple(self.results.curve(f"bodies/{name}/{part}").y for part in names)
        return self._known[name]

    @cached_property
    def _known(self) -> dict[str, tuple[np.ndarray, np.ndarray, np.ndarray]]:
        return {}


def rotation(q: np.ndarray) -> np.ndarray:
    """Rotation matrix (3, 3) of a quaternion w x y z of any length."""
    w, x, y, z = q / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def _read_collection(path: Path) -> dict[str, tuple[np.ndarray, list[Path]]]:
    """Times (n,) and files of the snapshots of "bodies", "surface" (of the liquid), "fields"."""
    if not path.is_file():
        raise WrongRequest(f"{path.parent.parent} holds no vtk/case.pvd, so there is nothing to picture")
    try:
        entries = [(float(e.attrib["timestep"]), e.attrib["file"]) for e in ET.parse(path).iter("DataSet")]
    except (ET.ParseError, KeyError, ValueError) as error:
        raise PostprocError(f"{path} is damaged: {error}") from error
    parts: dict[str, list] = {}
    for t, name in entries:
        parts.setdefault(Path(name).name.partition("_")[0], []).append((t, path.parent / name))
    if not {"bodies", "surface"} & set(parts):
        raise WrongRequest(f"{path} lists no snapshot of bodies or of a liquid's surface yet")
    return {part: (np.array([t for t, _ in taken]), [file for _, file in taken]) for part, taken in parts.items()}


def _read_surfaces(path: Path, names: dict[int, str]) -> list[Surface]:
    """Split a .vtp file into its bodies."""
    from vtkmodules.util.numpy_support import vtk_to_numpy

    data = _read_polydata(path)
    cells = data.GetCellData()
    if not data.GetNumberOfCells() or not cells.HasArray("component"):
        raise PostprocError(f"the snapshot {path} is damaged")
    points, faces = _points(data), _faces(data)
    owner, kind, speed = (vtk_to_numpy(cells.GetArray(name)) for name in ("component", "kind", "speed"))
    surfaces = []
    for number in np.unique(owner):
        mine = np.flatnonzero(owner == number)
        used, local = np.unique(faces[mine], return_inverse=True)
        name = names.get(int(number), f"obs{number}")
        stationary = bool(kind[mine[0]] == SOLID)
        surfaces.append(
            Surface(int(number), name, stationary, points[used], local.reshape(-1, 3), float(speed[mine[0]]))
        )
    return surfaces


def _read_polydata(path: Path) -> object:
    """The vtkPolyData of a .vtp file."""
    from vtkmodules.vtkCommonCore import vtkCommand
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

    if not path.is_file():
        raise PostprocError(f"the snapshot {path} is missing")
    failed: list[str] = []
    reader = vtkXMLPolyDataReader()
    reader.AddObserver(vtkCommand.ErrorEvent, lambda *_: failed.append("error"))
    reader.SetFileName(str(path))
    reader.Update()
    if failed:
        raise PostprocError(f"the snapshot {path} is damaged")
    return reader.GetOutput()


def _points(data: object) -> np.ndarray:
    from vtkmodules.util.numpy_support import vtk_to_numpy

    return vtk_to_numpy(data.GetPoints().GetData()).astype(float)


def _faces(data: object) -> np.ndarray:
    from vtkmodules.util.numpy_support import vtk_to_numpy

    return vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3)
