"""The liquid's surface as triangles: where F, taken to the nodes of the mesh, is one half.

A node takes the mean of the eight cells around it. Between the bottom (1 + F)/2 and the top F/2 of a surface cell one
half then lies exactly at the height F of it, also on a graded mesh. At the sides of the domain F goes on as it is: the
surface ends there, square to it, and where liquid touches a wall there is none. In solids F goes on as beside them, for
REACH cells, so that the surface reaches the wall; what of it lies in closed cells is cut away.

Along gravity this would lose films that are thinner than half a cell: under a cell that holds some liquid F goes on as
1, over the highest cell as 0.
"""

from __future__ import annotations

import numpy as np

REACH = 2  # cells: a node beside a wall asks for one, a corner of the wall for a second
FILM = 0.02  # of a cell: thinner films are not drawn


def liquid_surface(
    F: np.ndarray, closed: np.ndarray | None, planes: tuple[np.ndarray, ...], gravity: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 3) [length] and triangles (m, 3).

    F (nx, ny, nz) of real cells; closed, of the same shape, None without solids; planes (n + 1,) in x, y, z.
    """
    axis, up = int(np.abs(gravity).argmax()), -float(np.sign(gravity[np.abs(gravity).argmax()]))
    if closed is not None and closed.any():
        F = _continued(F, closed, axis, up)
    nodes = _at_nodes(F, axis, up)
    if not (nodes.min() < 0.5 <= nodes.max()):
        return np.zeros((0, 3)), np.zeros((0, 3), np.int64)
    places, faces = _half(nodes)
    if closed is not None and len(faces):
        middle = np.floor(places[faces].mean(axis=1)).astype(int)
        cell = tuple(np.clip(middle[:, d], 0, F.shape[d] - 1) for d in range(3))
        used, faces = np.unique(faces[~closed[cell]], return_inverse=True)
        places, faces = places[used], faces.reshape(-1, 3)
    points = [np.interp(places[:, d], np.arange(len(x)), x) for d, x in enumerate(planes)]
    return np.column_stack(points), faces


def _continued(F: np.ndarray, closed: np.ndarray, up_axis: int, up: float) -> np.ndarray:
    """F with the mean of the known neighbours in closed cells, REACH cells deep; 0 farther in. 1 under a film."""
    known, values = ~closed, np.where(closed, 0.0, F).astype(np.float32)
    if up != 0.0:
        lower, upper = _pair(up_axis) if up > 0.0 else _pair(up_axis)[::-1]
        under = np.zeros(F.shape, bool)
        under[lower] = closed[lower] & ~closed[upper] & (F[upper] > FILM)
        values[under], known = 1.0, known | under
    for _ in range(REACH):
        total, count = np.zeros(F.shape, np.float32), np.zeros(F.shape, np.int8)
        for axis in range(3):
            for a, b in (_pair(axis), _pair(axis)[::-1]):
                total[a] += np.where(known[b], values[b], 0.0)
                count[a] += known[b]
        new = ~known & (count > 0)
        values[new] = total[new] / count[new]
        known |= new
    return values


def _at_nodes(F: np.ndarray, up_axis: int, up: float) -> np.ndarray:
    """Mean of the cells around each node."""
    for axis in (up_axis, *(d for d in range(3) if d != up_axis)):
        ends = [(int(d == axis),) * 2 for d in range(3)]
        wide = np.pad(F.astype(np.float32, copy=False), ends, mode="edge")
        if axis == up_axis and up != 0.0:
            bottom, top = (_layer(axis, k) for k in ((0, -1) if up > 0.0 else (-1, 0)))
            wide[bottom], wide[top] = wide[bottom] > FILM, 0.0
        lower, upper = _pair(axis)
        F = 0.5 * (wide[lower] + wide[upper])
    return F


def _layer(axis: int, k: int) -> tuple:
    return (slice(None),) * axis + (k,)


def _pair(axis: int) -> tuple[tuple, tuple]:
    """All layers but the last along an axis, and all but the first."""
    return tuple((slice(None),) * axis + (s,) for s in (slice(None, -1), slice(1, None)))


def _half(nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 3) in units of cells and triangles (m, 3) of the surface nodes = 1/2."""
    from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D

    image = vtkImageData()
    image.SetDimensions(*nodes.shape)
    image.GetPointData().SetScalars(numpy_to_vtk(nodes.ravel(order="F"), deep=True))
    flying = vtkFlyingEdges3D()
    flying.SetInputData(image)
    flying.SetValue(0, 0.5)
    flying.ComputeNormalsOff()
    flying.ComputeGradientsOff()
    flying.ComputeScalarsOff()
    flying.Update()
    data = flying.GetOutput()
    if data.GetNumberOfPolys() == 0:
        return np.zeros((0, 3)), np.zeros((0, 3), np.int64)
    points = vtk_to_numpy(data.GetPoints().GetData()).astype(float)
    faces = vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3).astype(np.int64)
    return points, faces
