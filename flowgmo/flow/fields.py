"""The mesh as kernels see it, and the arrays that change.

    index      0   1 | 2   3   ..  n + 1 | n + 2  n + 3
               ghost |    real cells     |    ghost

dx[i] is the width of cell i, hx[i] the distance of the centres of cells i and i + 1, which is where u[i] lies.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from flowgmo.mesh import GHOST_LAYERS, Block

G = GHOST_LAYERS


class Grid(NamedTuple):
    """Widths [length] of cells (n + 4,) and distances of neighbouring centres (n + 4,), per direction.

    A ghost cell is as wide as its mirror image inside, so that a mirrored side is a plane of symmetry.
    """

    dx: np.ndarray
    dy: np.ndarray
    dz: np.ndarray
    hx: np.ndarray
    hy: np.ndarray
    hz: np.ndarray


@dataclass
class Flow:
    """The liquid at one instant; part of State, so `restart.h5` holds exactly these.

    u, v, w [length/time] on faces, p [mass/length/time2] in cells, relative to the void; F [-] in cells. Arrays of
    shape (nx + 4, ny + 4, nz + 4), None where absent: v for one cell in y, F without a free surface.
    p_before, of mesh size: p of the step before the last one, for the first guess of the next; None at the start.
    dt [time]: the length of the last step; pace [time]: how long it might have been but for an impact that cut it
    short, which the next one may grow from. 0 at the start.
    moments (mesh, 3): F, and where in its cell the liquid lies (surface/carried_moments.py), in meshes of one layer.
    start_volume [length3] of liquid at t = 0, start_energy its kinetic and potential energy; passed (6,) [length3]:
    liquid that came in through each side since. friction (2,) [energy]: lost in viscosity since then, and what sides
    gave, those that slide (momentum/viscous_work.py) and streams through open ones (observe/streams.py). momenta
    (7, 3): the book of momentum (momentum_book.py), None where no body moves in the liquid.
    """

    u: np.ndarray | None
    v: np.ndarray | None
    w: np.ndarray | None
    p: np.ndarray
    F: np.ndarray | None
    dt: float
    start_volume: float = 0.0
    start_energy: float = 0.0
    passed: np.ndarray = field(default_factory=lambda: np.zeros(6))
    friction: np.ndarray = field(default_factory=lambda: np.zeros(2))
    p_before: np.ndarray | None = None
    pace: float = 0.0
    momenta: np.ndarray | None = None
    moments: np.ndarray | None = None

    @property
    def velocity(self) -> list[np.ndarray | None]:
        """[u, v, w]."""
        return [self.u, self.v, self.w]

    def nbytes(self) -> int:
        """Bytes of all arrays."""
        return sum(a.nbytes for a in (*self.velocity, self.p, self.F, self.p_before, self.moments) if a is not None)


class Open(NamedTuple):
    """Open fractions of what stands still: V of cells, Ax, Ay, Az of upper faces [-]; all None without solids."""

    V: np.ndarray | None
    Ax: np.ndarray | None
    Ay: np.ndarray | None
    Az: np.ndarray | None


def grid_of(block: Block) -> Grid:
    """The Grid of a block. Ghost widths mirror the inside; a single cell is its own neighbour."""
    widths = [_with_ghosts(np.diff(planes)) for planes in block.planes]
    return Grid(*widths, *(_centre_distances(d) for d in widths))


def _with_ghosts(widths: np.ndarray) -> np.ndarray:
    n = len(widths)
    inside = np.arange(-G, n + G)
    mirrored = np.where(inside < 0, -1 - inside, np.where(inside >= n, 2 * n - 1 - inside, inside))
    return widths[np.clip(mirrored, 0, n - 1)]


def _centre_distances(widths: np.ndarray) -> np.ndarray:
    """(n + 4,): the last entry has no upper neighbour and repeats the one before."""
    between = 0.5 * (widths[:-1] + widths[1:])
    return np.append(between, between[-1])


def zeros(block: Block) -> np.ndarray:
    """An array of mesh size with ghosts, float64."""
    return np.zeros(tuple(n + 2 * G for n in block.shape))
