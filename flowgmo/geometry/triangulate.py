"""A closed surface for drawing: the shape's own triangles where it has them, else dual contouring of the membership.

    one vertex per grid cell that the surface crosses, where the tangent planes of its crossings meet best:
    minimise  Σ (n_i . (v - p_i))²;   one quad per crossed grid edge

Source  Ju, Losasso, Schaefer & Warren 2002.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from flowgmo.geometry.mass import apart, refuse_unbounded
from flowgmo.geometry.primitives import Box, Mesh

if TYPE_CHECKING:
    from flowgmo.geometry.component import Component

FLAT = 0.1  # of the largest eigenvalue: weaker directions stay at the mean of the crossings (Ju et al. 2002)
Membership = Callable[[np.ndarray], np.ndarray]
HALVINGS = 24  # of an edge: crossings to 1e-7 of a cell


def triangles(component: Component, resolution: int, clip: np.ndarray | None) -> Mesh:
    """Vertices (v,3) and outward faces (f,3)."""
    bounds = component.bounds()
    clipped = clip is not None and bool((bounds[0] < clip[0]).any() or (bounds[1] > clip[1]).any())
    if not clipped:
        refuse_unbounded(bounds)
        mesh = own_faces(component, resolution)
        return mesh if mesh is not None else contour(component, bounds, None, resolution)
    boxes = _clipped_boxes(component, np.asarray(clip, float))
    if boxes is not None:
        return _joined([box.faces(resolution) for box in boxes])
    low, high = np.maximum(bounds[0], clip[0]), np.minimum(bounds[1], clip[1])
    return contour(component, np.array([low, high]), Box(*np.asarray(clip, float)), resolution)


def own_faces(component: Component, resolution: int) -> Mesh | None:
    """The closed forms' triangles, on the surface with all their vertices; None where contouring must do."""
    if component.merged is not None:
        return component.merged.faces(resolution)
    solids = component.solids
    if any(role != "solid" for role in component.roles):
        return None
    if not all(apart(a, b) for k, a in enumerate(solids) for b in solids[:k]):
        return None
    meshes = [solid.faces(resolution) for solid in solids]
    return _joined(meshes) if all(mesh is not None for mesh in meshes) else None


def _joined(meshes: list[Mesh]) -> Mesh:
    starts = np.cumsum([0] + [len(vertices) for vertices, _ in meshes])
    vertices = np.vstack([np.empty((0, 3)), *(v for v, _ in meshes)])
    return vertices, np.vstack([np.empty((0, 3), int), *(f + s for (_, f), s in zip(meshes, starts, strict=False))])


def _clipped_boxes(component: Component, clip: np.ndarray) -> list[Box] | None:
    """Boxes along the axes of space cut by the clip box; None when the body is something else."""
    boxes = component.as_boxes()
    if boxes is None or any((np.abs(box.axes) > 1e-12).sum() != 3 for box in boxes):  # rounding of a rotation
        return None
    cut = []
    for box in boxes:
        to = np.abs(box.axes).argmax(0)
        flip = box.axes.sum(0) < 0
        low, high = np.where(flip, -box.hi[to], box.lo[to]), np.where(flip, -box.lo[to], box.hi[to])
        low, high = np.maximum(low + box.origin, clip[0]), np.minimum(high + box.origin, clip[1])
        if (low < high).all():
            cut.append(Box(low, high))
    return cut


def contour(component: Component, bounds: np.ndarray, clip: Box | None, resolution: int) -> Mesh:
    """Dual contouring in a grid around bounds (2,3), one cell wider on every side."""

    def inside(x: np.ndarray) -> np.ndarray:
        return component.inside(x) if clip is None else component.inside(x) & clip.inside(x)

    def normal(x: np.ndarray) -> np.ndarray:
        n = component.normal(x)
        return n if clip is None else np.where((clip.distance(x) > component.distance(x))[:, None], clip.normal(x), n)

    size = (bounds[1] - bounds[0]).max()
    h = size / resolution
    if not np.isfinite(h) or h <= 0:
        return np.empty((0, 3)), np.empty((0, 3), int)
    count = np.ceil((bounds[1] - bounds[0]) / h).astype(int) + 3
    origin = (bounds[0] + bounds[1]) / 2 - (count - 1) / 2 * h
    nodes = origin + h * np.stack(np.meshgrid(*map(np.arange, count), indexing="ij"), -1)
    full = inside(nodes.reshape(-1, 3)).reshape(count)
    edges, crossing = _crossings(full, nodes, h, inside)
    cells = np.vstack([edges[:, 1:] + _offset(edges[:, 0], k) for k in range(4)])
    used, cell = np.unique(np.ravel_multi_index(cells.T, count), return_inverse=True)
    corner = origin + h * np.stack(np.unravel_index(used, count), 1)
    vertices = _vertices(cell, np.tile(crossing, (4, 1)), np.tile(normal(crossing), (4, 1)), corner, h)
    quad = cell.reshape(4, -1).T
    out = full[tuple(edges[:, 1:].T)]  # from inside to outside along the axis
    quad = np.where(out[:, None], quad, quad[:, ::-1])
    return vertices, np.vstack([quad[:, [0, 1, 2]], quad[:, [0, 2, 3]]])


def _crossings(full: np.ndarray, nodes: np.ndarray, h: float, inside: Membership) -> tuple[np.ndarray, np.ndarray]:
    """Edges (m,4) as axis, i, j, k of the lower node, and where the surface crosses them (m,3)."""
    edges = []
    for axis in range(3):
        here, next_ = np.delete(full, -1, axis), np.delete(full, 0, axis)
        found = np.argwhere(here != next_)
        edges.append(np.column_stack([np.full(len(found), axis), found]))
    edges = np.vstack(edges)
    start, step = nodes[tuple(edges[:, 1:].T)], h * np.eye(3)[edges[:, 0]]
    inner = full[tuple(edges[:, 1:].T)]
    low, high = np.zeros(len(edges)), np.ones(len(edges))
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        same = inside(start + middle[:, None] * step) == inner
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return edges, start + ((low + high) / 2)[:, None] * step


def _offset(axis: np.ndarray, k: int) -> np.ndarray:
    """The k-th cell (m,3) around an edge, counterclockwise about its axis, relative to the edge's lower node."""
    u, v = ((0, 0), (-1, 0), (-1, -1), (0, -1))[k]
    eye = np.eye(3, dtype=int)
    return u * eye[(axis + 1) % 3] + v * eye[(axis + 2) % 3]


def _vertices(cell: np.ndarray, p: np.ndarray, n: np.ndarray, corner: np.ndarray, h: float) -> np.ndarray:
    count = np.bincount(cell)
    mean = np.stack([np.bincount(cell, p[:, k]) for k in range(3)], 1) / count[:, None]
    offset = (n * (p - mean[cell])).sum(1)
    A, b = np.zeros((len(count), 3, 3)), np.zeros((len(count), 3))
    np.add.at(A, cell, n[:, :, None] * n[:, None, :])
    np.add.at(b, cell, n * offset[:, None])
    values, axes = np.linalg.eigh(A)
    strong = values > FLAT * values[:, -1:]
    inverse = np.where(strong, 1 / np.where(strong, values, 1.0), 0.0)
    move = np.einsum("cij,cj,ckj,ck->ci", axes, inverse, axes, b)
    return np.clip(mean + move, corner, corner + h)
