"""Triangles of curved surfaces, as fine as an accuracy asks for, and how accurate they are.

    error = the largest distance between the triangles and the true surface, measured both ways at many points

It falls with the square of the resolution (a chord's sagitta is l²/8R), which gives the next guess.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flowgmo.geometry.component import Component
from flowgmo.geometry.errors import GeometryError
from flowgmo.geometry.mesh_solid import MeshSolid
from flowgmo.geometry.primitives import Box, Mesh, unit
from flowgmo.geometry.triangulate import contour, own_faces

COARSEST = 16  # steps around a circle or along the longest side to begin with
SAMPLES = 2000  # triangles, and points of the surface, at which the error is measured
THICK = 0.125  # of the longest side: thinner bodies are stretched to this, so that some cells lie across them
FOUND = 1e-9  # of the size: points that came so near to the surface are on it


def refined(component: Component, accuracy: float, most: int, clip: np.ndarray) -> tuple[Mesh, float]:
    """Triangles of a surface, and how far [length] they and it are apart.

    Refined until that is less than `accuracy` of the size, as long as there are at most `most` triangles. clip (2,3):
    the box to which an infinite body is cut.
    """
    bounds = component.bounds()
    if not np.isfinite(bounds).all():
        bounds = np.clip(bounds, *clip)
    else:
        clip = None
    goal = accuracy * float(np.ptp(bounds, axis=0).max())
    resolution, best, limit = COARSEST, None, np.inf
    for _ in range(8):  # two guesses mostly do, more where the number of triangles is what stops it
        mesh = own_faces(component, resolution) if clip is None else None
        mesh = _contour(component, bounds, clip, resolution) if mesh is None else mesh
        count = max(len(mesh[1]), 1)
        if count > most:
            limit = min(limit, resolution)
            resolution = int(0.95 * resolution * np.sqrt(most / count))
        else:
            error = _error(component, mesh, bounds, clip)
            if best is None or error < best[1]:
                best = mesh, error
            if error <= goal:
                break
            limit = min(limit, int(resolution * np.sqrt(most / count)) + 1)
            guess = 1.1 * np.sqrt(error / goal)  # 1.1: lands below the goal
            resolution = max(resolution + 1, min(int(np.ceil(resolution * min(max(guess, 1.25), 4.0))), limit - 1))
        if resolution >= limit or resolution < COARSEST:
            break
    if best is None or not len(best[0][1]):
        raise GeometryError(f"no triangles are fine enough for {component.describe()}: {most} are allowed")
    return best


@dataclass(frozen=True, eq=False)
class _View:
    """A component in axes R (3,3, columns), drawn out along them by s (3,), as far as contouring asks for it."""

    component: Component
    R: np.ndarray
    s: np.ndarray

    def back(self, y: np.ndarray) -> np.ndarray:
        """Points (n,3) in space."""
        return (y / self.s) @ self.R.T

    def inside(self, y: np.ndarray) -> np.ndarray:
        return self.component.inside(self.back(y))

    def normal(self, y: np.ndarray) -> np.ndarray:
        return unit(self.component.normal(self.back(y)) @ self.R / self.s, np.array([0.0, 0.0, 1.0]))

    def distance(self, y: np.ndarray) -> np.ndarray:
        """Of the body as it is: only which is larger, this or the clip box's, counts."""
        return self.component.distance(self.back(y))


def _contour(component: Component, bounds: np.ndarray, clip: np.ndarray | None, resolution: int) -> Mesh:
    """Triangles from a grid along the axes of the first piece, its cells oblong where the body is thin."""
    R, box = np.eye(3), None
    solids = [solid for role, solid in zip(component.roles, component.solids, strict=True) if role == "solid"]
    if clip is None and solids:
        turned = component.solids[0].R
        ends = np.array([[[-solid.support(-axis), solid.support(axis)] for axis in turned.T] for solid in solids])
        own = np.stack([ends[..., 0].min(0), ends[..., 1].max(0)])
        R, bounds = (turned, own) if np.isfinite(own).all() else (R, bounds)
    extent = np.ptp(bounds, axis=0)
    s = np.exp2(np.ceil(np.log2(np.maximum(THICK * extent.max() / extent, 1.0))))
    if clip is not None:
        box = Box(*(clip * s))
    view = _View(component, R, s)
    vertices, faces = contour(view, bounds * s, box, resolution)
    return view.back(vertices), faces if np.linalg.det(R) > 0 else faces[:, ::-1]


def _error(component: Component, mesh: Mesh, within: np.ndarray, clip: np.ndarray | None) -> float:
    """Largest distance [length] between a mesh and the true surface, measured at samples of both.

    Of the mesh: middles of triangles and of their sides. Of the surface: where random points of the box `within` (2,3)
    come to when they follow the normal. Points on the sides of the clip box do not count: the mesh is closed there.
    """
    vertices, faces = mesh
    if not len(faces):
        return float(np.ptp(within, axis=0).max())
    corners = vertices[faces[:: max(1, len(faces) // SAMPLES)]]
    there = np.vstack([corners.mean(1), *((corners[:, k] + corners[:, k - 1]) / 2 for k in range(3))])
    here = np.random.default_rng(0).uniform(*within, (SAMPLES, 3))  # the same points each time
    for _ in range(8):  # more than one step where the distance is a lower bound
        here = here - component.distance(here)[:, None] * component.normal(here)
    here = here[np.abs(component.distance(here)) <= FOUND * np.ptp(within, axis=0).max()]
    if clip is not None:
        h = 1e-2 * np.ptp(clip, axis=0)  # the mesh's own edge at the clip box is as rounded as it is coarse
        there, here = (x[((x > clip[0] + h) & (x < clip[1] - h)).all(1)] for x in (there, here))
    off = np.abs(component.distance(there)).max(initial=0.0)
    return float(max(off, np.abs(MeshSolid(vertices, faces).distance(here)).max(initial=0.0)))
