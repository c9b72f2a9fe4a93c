"""Load of the liquid on bodies that stand still: pressure on the wall that each cell holds of it.

    a      =  (S_b of the upper - S_b of the lower face) x face area        into the body b, for each direction
    force  =  sum of p a  +  rho g volume ((S_b upper + S_b lower) / 2 - V_b)
    torque =  sum of (x - x0) x that force                                   x the cell's centre

S_b is the share of a face that b covers, V_b of the cell's volume. p is the pressure of the cell's centre, but the wall
lies elsewhere. In liquid at rest p(x) = p + rho g . (x - centre), and by Gauss' theorem over the open part of the cell

    integral over the wall of p n  =  integral of grad p over the open part - integral over the open faces of p n

whose component d is, with A = 1 - S_b and V = 1 - V_b, the expression above: exact, wherever the wall is cut. A body
under still water then feels the weight of the water that it displaces, and constant pressure gives nothing, since the
sum of a is zero.

Of a cell that several solids share, each has the part of the covered volume that it has of the covered faces.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flowgmo.flow.fields import Flow, Grid, Open


class Wall(NamedTuple):
    """The wall of one body: cells (m, 3) int [with ghosts], places (m, 3) of their centres [length], areas (m, 3)
    [length2] into the body, lifts (m, 3) [length3] as above, without rho g."""

    cells: np.ndarray
    places: np.ndarray
    areas: np.ndarray
    lifts: np.ndarray


class Load(NamedTuple):
    """Of the liquid on the body: force [force], torque [torque] (3,) about the asked point, wetted area [length2]."""

    force: np.ndarray
    torque: np.ndarray
    wetted_area: float


def find_wall(cells: np.ndarray, faces: np.ndarray, grid: Grid, openings: Open, centres: list[np.ndarray]) -> Wall:
    """The Wall of what a body covers: cells (m, 3) [with ghosts] and the shares (m, 6) of their faces, lower x, upper
    x, lower y ... (fractions.Shares); centres: of cells, a (n + 4,) for each direction."""
    cells, faces = np.asarray(cells, dtype=np.intp).reshape(-1, 3), np.asarray(faces, dtype=float).reshape(-1, 6)
    dx, dy, dz = (d[cells[:, e]] for e, d in enumerate(grid[:3]))
    areas = (faces[:, 1::2] - faces[:, ::2]) * np.column_stack([dy * dz, dz * dx, dx * dy])
    covered = np.zeros(len(cells)) if openings.V is None else 1.0 - openings.V[tuple(cells.T)]
    closed = _closed_faces(cells, openings)
    mine = np.divide(faces.sum(axis=1), closed, out=np.zeros(len(cells)), where=closed > 0.0)
    means = 0.5 * (faces[:, 1::2] + faces[:, ::2])
    lifts = (means - (covered * mine)[:, None]) * (dx * dy * dz)[:, None]
    places = np.column_stack([centres[e][cells[:, e]] for e in range(3)])
    return Wall(cells, places, areas, lifts)


def _closed_faces(cells: np.ndarray, openings: Open) -> np.ndarray:
    """Sum (m,) over the six faces of each cell of the share that all solids cover."""
    closed = np.zeros(len(cells))
    for d, A in enumerate(openings[1:]):
        if A is not None:
            below = cells - np.eye(3, dtype=np.intp)[d]
            closed += 2.0 - A[tuple(cells.T)] - A[tuple(below.T)]
    return closed


def pressure_load(wall: Wall, flow: Flow, rho: float, gravity: np.ndarray, point: np.ndarray) -> Load:
    """Load by pressure. Where the cell's centre is dry (F < 1/2) its pressure is the void's, 0."""
    at = tuple(wall.cells.T)
    F = np.ones(len(wall.cells)) if flow.F is None else flow.F[at]
    liquid = (F >= 0.5)[:, None]
    each = np.where(liquid, flow.p[at][:, None] * wall.areas + rho * gravity * wall.lifts, 0.0)
    sizes = np.linalg.norm(wall.areas, axis=1)
    return Load(_sum(each), _sum(np.cross(wall.places - point, each)), float(sizes @ F.clip(0.0, 1.0)))


def shear_load(places: np.ndarray, forces: np.ndarray, point: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Force and torque (3,) of wall shear forces (m, 3) at places (m, 3); what the liquid exerts on the body."""
    return _sum(forces), _sum(np.cross(places - point, forces))


def _sum(rows: np.ndarray) -> np.ndarray:
    """(3,), in a fixed order."""
    return rows.sum(axis=0) if len(rows) else np.zeros(3)
