"""Reads a triangle mesh and refuses what is not the closed surface of a body.

Binary and ASCII are told apart by size and content, never by the first word: many binary files begin with "solid".
"""

from __future__ import annotations

import contextlib
import io
import re
import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from flowgmo.geometry.errors import GeometryError
from flowgmo.geometry.stl_mend import mend

HEADER, RECORD = 84, 50  # bytes of a binary file before the triangles, and of each triangle


@dataclass(frozen=True, eq=False)
class StlMesh:
    """Closed mesh: vertices (v,3), outward oriented faces (f,3); notices say what was mended."""

    vertices: np.ndarray
    faces: np.ndarray
    name: str = ""
    notices: tuple[str, ...] = ()


def read_stl(path: str | Path) -> StlMesh:
    """The closed mesh in a file, ASCII or binary; GeometryError names the file and what is wrong with it."""
    path = Path(path)
    try:
        corners = _corners(path)
        if not np.isfinite(corners).all():
            bad = int(np.flatnonzero(~np.isfinite(corners).all((1, 2)))[0]) + 1
            raise GeometryError(f"facet {bad} has a coordinate that is not a finite number")
        vertices, faces, notices = mend(corners)
    except GeometryError as error:
        raise GeometryError(f"STL file {path}: {error}") from None
    return StlMesh(vertices, faces, path.name, tuple(f"STL file {path}: {text}" for text in notices))


def mesh_from(corners: np.ndarray, name: str = "") -> StlMesh:
    """A mesh from the corners (f,3,3) of its triangles, checked and mended like one from a file."""
    vertices, faces, notices = mend(np.asarray(corners, float))
    return StlMesh(vertices, faces, name, tuple(notices))


def _corners(path: Path) -> np.ndarray:
    """Corners (f,3,3) in the order of the file."""
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        raise GeometryError("there is no such file") from None
    except OSError as error:
        raise GeometryError(f"cannot be read: {error.strerror}") from None
    if not data.strip():
        raise GeometryError("the file is empty")
    _check_text(data) if _is_text(data) else _check_binary(data)
    return _by_meshio(path)


def _is_text(data: bytes) -> bool:
    """A binary file has the size that its count announces, or bytes that no text has."""
    if len(data) >= HEADER and HEADER + RECORD * int.from_bytes(data[80:84], "little") == len(data):
        return False
    return data[:5].lower() == b"solid" and not (set(data[:4096]) - set(range(32, 127)) - set(b"\t\r\n\f\v"))


def _check_binary(data: bytes) -> None:
    count = int.from_bytes(data[80:84], "little") if len(data) >= HEADER else 0
    if len(data) < HEADER:
        raise GeometryError(
            f"neither an ASCII STL (no 'solid') nor a binary one ({len(data)} bytes, less than a header)"
        )
    if count == 0:
        raise GeometryError("the file holds no triangles")
    expected = HEADER + RECORD * count
    if len(data) != expected:
        state = "truncated" if len(data) < expected else "too long"
        raise GeometryError(f"the binary file is {state}: {count} triangles need {expected} bytes, it has {len(data)}")


def _check_text(data: bytes) -> None:
    text = data.decode("ascii", errors="replace").lower()
    facets, ends, vertices = (len(re.findall(rf"^\s*{word}\b", text, re.M)) for word in ("facet", "endfacet", "vertex"))
    if facets == 0:
        raise GeometryError("the file holds no triangles")
    if not facets == ends or vertices != 3 * facets or not re.search(r"^\s*endsolid", text, re.M):
        raise GeometryError(
            f"the text is incomplete: {facets} 'facet', {ends} 'endfacet', {vertices} 'vertex' lines, and "
            f"{'an' if 'endsolid' in text else 'no'} 'endsolid'"
        )


def _by_meshio(path: Path) -> np.ndarray:
    import meshio

    silent = io.StringIO()
    try:
        with contextlib.redirect_stdout(silent), contextlib.redirect_stderr(silent), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            mesh = meshio.read(path, file_format="stl")
            return np.asarray(mesh.points, float)[mesh.get_cells_type("triangle")]
    except (Exception, SystemExit) as error:  # meshio leaves with sys.exit on some damaged files
        raise GeometryError(f"cannot be understood ({error or type(error).__name__})") from None
