"""The rectilinear mesh and where quantities live on it.

    face i     face i+1           cells   1 .. n     computed          (arrays have n + 2 ghost_layers entries)
      |  cell i  |                        0, n + 1   first ghost layer
      u    p     u                faces   u of cell i lies on its upper side, i + 1/2
           F V
      Ax         Ax

Cell centres: p, F, V. Faces: u with Ax on x-faces, v with Ay, w with Az. A block is a box of cells with ghost layers
and six neighbours (a side of the domain, or another block); kernels work on one block at a time. A scene without
liquid has a domain (sides, bounds, cell sizes) but no array of mesh size.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

GHOST_LAYERS = 2  # the second-order monotone advection reads two cells upstream (DESIGN 4)

SYMMETRY, WALL, CONTINUATIVE, PERIODIC, PRESSURE, VELOCITY, OUTFLOW = 1, 2, 3, 4, 5, 6, 8
SIDE_NAMES = ("Xmin", "Xmax", "Ymin", "Ymax", "Zmin", "Zmax")
SIDE_KINDS = {
    SYMMETRY: "symmetry",
    WALL: "wall",
    CONTINUATIVE: "continuative",
    PERIODIC: "periodic",
    PRESSURE: "pressure",
    VELOCITY: "velocity",
    OUTFLOW: "outflow",
}


@dataclass(frozen=True)
class Side:
    """One of the six sides of the domain; number 0 .. 5 in the order of SIDE_NAMES, kind a deck code (IBCT)."""

    number: int
    kind: int

    @property
    def name(self) -> str:
        return SIDE_NAMES[self.number]

    @property
    def stops_bodies(self) -> bool:
        """Walls and mirrors stop bodies; all other kinds let them leave."""
        return self.kind in (SYMMETRY, WALL)


@dataclass(frozen=True)
class Block:
    """A box of cells: planes (n + 1,) [length] in each direction, ghost layers outside, six neighbours.

    neighbours[s] is a Side, or the number of another block (one block for now).
    """

    x: np.ndarray
    y: np.ndarray
    z: np.ndarray
    neighbours: tuple[Side | int, ...]
    name: str = ""

    @property
    def planes(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return self.x, self.y, self.z

    @property
    def shape(self) -> tuple[int, int, int]:
        """Cells in x, y, z without ghosts."""
        return len(self.x) - 1, len(self.y) - 1, len(self.z) - 1

    @property
    def cells(self) -> int:
        nx, ny, nz = self.shape
        return nx * ny * nz

    @property
    def bounds(self) -> np.ndarray:
        """(2, 3) [length]: lowest and highest corner."""
        return np.array([[a[0] for a in self.planes], [a[-1] for a in self.planes]])


@dataclass(frozen=True)
class Mesh:
    """All blocks; the sides are those of the whole domain."""

    blocks: tuple[Block, ...]
    sides: tuple[Side, ...]

    @property
    def cells(self) -> int:
        return sum(block.cells for block in self.blocks)

    @property
    def bounds(self) -> np.ndarray:
        """(2, 3) [length]: lowest and highest corner of the domain."""
        every = np.array([block.bounds for block in self.blocks])
        return np.array([every[:, 0].min(axis=0), every[:, 1].max(axis=0)])


def graded_planes(anchors: np.ndarray, counts: list[int], sizes: list[float | None]) -> np.ndarray:
    """Planes (n + 1,) through the anchors (k,), counts[i] cells between anchors i and i + 1.

    Cell sizes vary geometrically inside an interval so that the first and last cell match `sizes` at its two anchors
    where both are given; with one size given the interval grades from it; with none it is uniform.
    """
    planes = [np.array([anchors[0]], dtype=float)]
    for i, n in enumerate(counts):
        length = anchors[i + 1] - anchors[i]
        widths = _interval_widths(length, n, sizes[i], sizes[i + 1])
        inner = anchors[i] + np.cumsum(widths)
        inner[-1] = anchors[i + 1]
        planes.append(inner)
    return np.concatenate(planes)


def _interval_widths(length: float, n: int, first: float | None, last: float | None) -> np.ndarray:
    """n widths that sum to length, with ratio constant; both ends given: their ratio, one end: found by bisection."""
    k = np.arange(n)
    if n == 1 or (first is None and last is None):
        return np.full(n, length / n)
    if first is not None and last is not None:
        widths = first * (last / first) ** (k / (n - 1))
        return widths * (length / widths.sum())
    end = first if first is not None else last
    lo, hi = 1e-3, 1e3  # ratio of neighbouring cells; beyond this no mesh is of use
    for _ in range(200):  # halves the bracket to round-off
        ratio = np.sqrt(lo * hi)
        lo, hi = (ratio, hi) if end * (ratio**k).sum() < length else (lo, ratio)
    widths = ratio**k
    widths *= length / widths.sum()
    return widths if first is not None else widths[::-1]
