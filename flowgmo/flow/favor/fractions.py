"""Open fractions: how much of each cell and face the solids leave to the liquid, and what each solid covers.

    V, A                 open share of a cell and of a face; None without solids
    S_b                  share of a face that solid b covers:   A + sum over b of S_b = 1
    a_b                  wall area of b in a cell = (S_b of the upper - S_b of the lower face) x face area, into b

The force of the liquid on b is the sum of p a_b. S_b is one number for each face, so the a_b of a whole body sum to
zero and constant pressure gives no force. The fractions come from distances at the nodes of cells near the surface
(near_surface.py): each cell is divided into `pieces`^3 equal parts, which are cut exactly (cut_cell.py). Where solids
overlap, their shares divide what is covered in proportion. Walls thinner than a cell: thin_walls.py; slivers:
clean_up.py.

`open_fractions` is all that stands still; `cover` one solid in any pose and any box of cells, for bodies that move.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from flowgmo.flow.favor.cell_parts import close_boxes, put_cells
from flowgmo.flow.favor.clean_up import close_slivers
from flowgmo.flow.favor.cut_pairs import CutPairs, cell_volumes, cut_pairs
from flowgmo.flow.favor.near_surface import Near, Planes, Pose, Shape, near_cells, placed
from flowgmo.flow.favor.shares import Shares, share_out
from flowgmo.flow.fields import G, Open
from flowgmo.mesh import Block

NOTHING = Open(None, None, None, None)


class Lost(NamedTuple):
    """What the mesh could not hold, as volumes [length3] and counts.

    closed: open volume that cleaning up took away, added: that it gave; divided: cells with a thin wall through them,
    thin: open volume that dividing took away from them, negative where the wall's own volume was lost.
    """

    closed: float
    added: float
    divided: int
    thin: float


@dataclass(frozen=True)
class Solids:
    """The solids that stand still, as the mesh sees them.

    open: fractions with ghosts, mirrored; None where no solid touches the domain. shares: one for each shape.
    covered (n,): each shape's own volume on the mesh [length3], without its surface cells inside another shape.
    lost: what was changed or could not be held.
    """

    open: Open
    shares: tuple[Shares, ...]
    covered: np.ndarray
    lost: Lost


class Cover(NamedTuple):
    """One solid on the mesh: cells (n, 3) int32 [with ghosts] that its surface may cut, the covered shares of their
    faces (n, 6) [lower x, upper x, lower y, ...] and of their volume (n,); inside (m, 2, 3): boxes of cells wholly
    covered, first and one past the last [with ghosts]."""

    cells: np.ndarray
    faces: np.ndarray
    volume: np.ndarray
    inside: np.ndarray


def open_fractions(
    block: Block,
    shapes: Sequence[Shape],
    pieces: int = 2,
    least: float = 1e-4,
    lone: float = 0.05,
    area_ratio: float | None = None,
) -> Solids:
    """Open fractions of all shapes that stand still, and the shares that each covers.

    pieces: parts of a cell in each direction (1 or 2); least, lone, area_ratio: clean_up.py, the decks' EPS, VFCLEAN,
    AVRCK. On return A + sum of S = 1 on every face of an open cell, and a cell with V = 0 has no open face.
    Raises ValueError when nothing is left open.
    """
    near = [near_cells(shape.distance, block.planes, shape.bounds()) for shape in shapes]
    volumes = cell_volumes(block)
    if not any(len(n.cells) or len(n.inside) for n in near):
        return Solids(NOTHING, tuple(Shares.none() for _ in shapes), np.zeros(len(shapes)), Lost(0.0, 0.0, 0, 0.0))
    fields = tuple(np.ones(tuple(n + 2 * G for n in block.shape)) for _ in range(4))
    for n in near:
        close_boxes(n.inside, *fields)
    V = fields[0]
    lists = [n.cells[V[tuple(n.cells.T + G)] > 0.0] for n in near]
    pairs = cut_pairs(block, [shape.distance for shape in shapes], lists, pieces, shapes=shapes)
    put_cells(pairs.cells, pairs.opened, *fields)
    inner = (slice(G, -G),) * 3
    before = V[inner].copy()
    close_slivers(*fields, least, lone, area_ratio)
    if not (V[inner] > 0.0).any():
        raise ValueError("the solids fill the whole mesh: no cell is left open")
    change = (V[inner] - before) * volumes
    lost = Lost(float(abs(change[change < 0].sum())), float(change[change > 0].sum()), pairs.divided, pairs.lost)
    covered = _own_volumes(pairs, near, block.planes, volumes)
    shares = share_out(block.shape, pairs, fields, len(shapes))
    if not any(len(s.cells) for s in shares) and (V[inner] == 1.0).all():
        return Solids(NOTHING, shares, covered, lost)  # it only touched the domain from outside
    for axis, a in enumerate(fields):
        mirror_ghosts(a, axis - 1)
    return Solids(Open(*fields), shares, covered, lost)


def cover(
    shape: Shape, block: Block, pose: Pose | None = None, box: np.ndarray | None = None, pieces: int = 1
) -> Cover:
    """What one solid in its pose covers, in the cells of `box` (2, 3), first and one past the last [without ghosts].

    Not cleaned up, and not looked through for thin walls, which would put it on the mesh: a body that moves is never
    snapped, so what is thinner than a cell leaks. Two solids in one cell may cover more than there is.
    """
    distance, bounds = placed(shape, pose)
    near = near_cells(distance, block.planes, bounds, box)
    pairs = cut_pairs(block, [distance], [near.cells], pieces, thin=False)
    return Cover(pairs.cells + np.int32(G), pairs.covered[:, :6], pairs.covered[:, 6], near.inside + np.int32(G))


def mirror_ghosts(a: np.ndarray, axis: int) -> None:
    """Fill the ghosts of an array by the mirror image of the inside at all sides.

    axis -1: cell centres; 0, 1, 2: upper faces across that axis. Those on the domain's sides are computed, so that
    entry G - 1 is real and entry 2 G - 2 - m its image m.
    """
    for across in range(3):
        s = np.moveaxis(a, across, 0)
        n = len(s) - 2 * G
        low, shift = (G - 1, 0) if across == axis else (G, 1)
        high = G + n - 1
        for g in range(1, G + 1):
            if low - g >= 0:
                s[low - g] = s[min(low + g - shift, high)]
            s[high + g] = s[max(high - g + shift, low)]


def _own_volumes(pairs: CutPairs, near: list[Near], planes: Planes, volumes: np.ndarray) -> np.ndarray:
    """Volume (n,) that each shape covers by itself."""
    own = np.zeros(len(near))
    of_pair = np.repeat(volumes[tuple(pairs.cells.T)], np.diff(pairs.starts))
    for b, n in enumerate(near):
        own[b] = (pairs.covered[:, 6] * of_pair)[pairs.which == b].sum()
        sides = [x[n.inside[:, 1, k]] - x[n.inside[:, 0, k]] for k, x in enumerate(planes)]
        own[b] += np.prod(sides, axis=0).sum()
    return own
