"""VTK's XML files: triangles (.vtp) and rectilinear cells (.vtr), compressed, numbers in single precision.

Python writes the files, since VTK prints what fails instead of raising it.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from flowgmo.output.errors import replacing


def numbers(values: np.ndarray, kind: type, name: str) -> object:
    """A named VTK array (n,) or (n, 3)."""
    from vtkmodules.util.numpy_support import numpy_to_vtk

    made = numpy_to_vtk(np.ascontiguousarray(values, dtype=kind), deep=True)
    made.SetName(name)
    return made


def triangles(points: np.ndarray, faces: np.ndarray, t: float) -> object:
    """vtkPolyData of points (n, 3) and faces (m, 3) at a time."""
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData

    data, corners, cells = vtkPolyData(), vtkPoints(), vtkCellArray()
    corners.SetData(numbers(points.reshape(-1, 3), np.float32, "Points"))
    ends = np.arange(0, 3 * len(faces) + 1, 3)
    cells.SetData(numbers(ends, np.int32, "offsets"), numbers(faces.ravel(), np.int32, "connectivity"))
    data.SetPoints(corners)
    data.SetPolys(cells)
    data.GetFieldData().AddArray(numbers([t], np.float64, "TimeValue"))
    return data


def rectilinear(planes: tuple[np.ndarray, ...], cells: dict[str, np.ndarray], t: float) -> object:
    """vtkRectilinearGrid with planes (n + 1,) in x, y, z and cell values (nx, ny, nz) or (nx, ny, nz, 3)."""
    from vtkmodules.vtkCommonDataModel import vtkRectilinearGrid

    data = vtkRectilinearGrid()
    data.SetDimensions(*(len(x) for x in planes))
    data.SetXCoordinates(numbers(planes[0], np.float64, "x"))
    data.SetYCoordinates(numbers(planes[1], np.float64, "y"))
    data.SetZCoordinates(numbers(planes[2], np.float64, "z"))
    for name, values in cells.items():
        x_fastest = np.swapaxes(values, 0, 2).reshape(-1, *values.shape[3:])
        data.GetCellData().AddArray(numbers(x_fastest, np.float32, name))
    data.GetFieldData().AddArray(numbers([t], np.float64, "TimeValue"))
    return data


def write(path: Path, data: object) -> None:
    """Write vtkPolyData or a vtkRectilinearGrid. Raises OutputError; then nothing is left of the file."""
    with replacing(path) as temporary:
        temporary.write_bytes(encoded(data))


def encoded(data: object) -> bytes:
    """The content of a file. Python writes it, since VTK prints what fails instead of raising it."""
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter, vtkXMLRectilinearGridWriter

    writer = vtkXMLRectilinearGridWriter() if data.IsA("vtkRectilinearGrid") else vtkXMLPolyDataWriter()
    writer.SetInputData(data)
    writer.SetDataModeToAppended()
    writer.EncodeAppendedDataOff()
    writer.SetCompressorTypeToZLib()
    writer.SetCompressionLevel(1)  # of 9: those above take three times as long for some percent
    writer.WriteToOutputStringOn()
    writer.Write()
    content = writer.GetOutputString()  # bytes, or text where they happen to be UTF-8
    return content.encode() if isinstance(content, str) else content
