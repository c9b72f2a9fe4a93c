"""Walls of bodies that move, on the faces of the mesh beside them: their velocity, and the liquid's friction on them.

On a face of component c beside a body with velocity v of B and spin w the wall slides at

    u_wall = (v + w x r) . c = E (v, w),      E = (c, r x c),    r = wall - B

and the liquid has there (wall_shear.py) mu s (u - u_wall) volume: D (u - E U) with D = mu s volume x the body's share
of the wall, that of the area which it covers of the face's two cells. The load on the body is E transposed,

    load = sum over faces E^T D (u - E U) = pull - K U,      pull = sum E^T D u,  K = sum E^T D E  (6, 6)

so that what moves the wall and what loads the body are the same numbers: no momentum is lost, and the exchange can
only take energy. K is symmetric and not negative.

A sliver between wall and mesh holds next to no liquid but has D without bound. The liquid's step gives its face the
inertia of W > V (cut_viscosity.py), and how far the face is from rest between the wall and its neighbours says nothing
about the force on the wall. So the load takes, in place of u, with beta = V / W,

    beta u + (1 - beta) (sum c_n u_n + s E U) / (sum c_n + s)

which is u itself on all other faces: there the liquid and the body have the same force to rounding.

That is mu times the normal derivative of u, all that the liquid's nu laplacian(u) knows. The stress has another part,
mu (grad u)^T n, which no liquid feels (its divergence is nothing) but a wall that turns does: mu n x w, since on the
wall u is the body's. It sums to no force over a closed wall but to the moment -2 mu (volume) w, two fifths of the whole
on a cylinder that turns in one of twice its size. `spin_resistance` is that, summed over the wet wall.

The wall lies (V - 1/2) of the cell's width along its normal beyond the middle of the face's cell (exact for walls
along the mesh, and where it halves the cell), not in the middle: a cylinder R / h = 8 that turns would drag 1/16 more
liquid. Normal: the area vector that the body covers, outwards difference of shares (body_fluxes.py).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from flowgmo.flow.favor.shares import Shares, wall_areas
from flowgmo.flow.fields import Grid, Open
from flowgmo.flow.momentum.cut_viscosity import CutViscosity
from flowgmo.flow.momentum.viscosity import Viscosity

Array = np.ndarray


class WallFaces(NamedTuple):
    """Faces of component c beside one body.

    at (n,): row among the component's cut faces; low, high (n,): flat index of the face (that of the cell below it) and
    of the cell above; share (n,) [-] of the wall that is the body's; E (n, 6) [-, length]; own (n,) [mass/time] of the
    face itself, beside (n, 6) of its neighbours below and above along x, y, z, whose sum is what D was.
    """

    c: int
    at: Array
    low: Array
    high: Array
    share: Array
    E: Array
    own: Array
    beside: Array

    def wet(self, F: Array | None) -> WallFaces:
        """Those that liquid touches, as wet_face says. F (mesh) or None."""
        if F is None:
            return self
        flat = F.reshape(-1)
        some = np.maximum(flat[self.low], flat[self.high]) > 0.0
        return self if some.all() else WallFaces(self.c, *(a[some] for a in self[1:]))

    def resistance(self) -> Array:
        """K (6, 6)."""
        return self.E.T @ ((self.own + self.beside.sum(axis=1))[:, None] * self.E)

    def pull(self, q: Array) -> Array:
        """(6,): sum E^T D u; q (mesh) the component's velocity."""
        flat = q.reshape(-1)
        force = self.own * flat[self.low]
        slivers = np.flatnonzero(self.beside.any(axis=1))
        for n, step in enumerate(_steps(q.shape)):
            force[slivers] += self.beside[slivers, n] * flat[self.low[slivers] + step]
        return self.E.T @ force


class Covers(NamedTuple):
    """What a body covers of cells in C order: numbers (m,) flat, covered (m,) [length2] of all their faces, into
    (m, 3) [length2]: wall area into the body."""

    numbers: Array
    covered: Array
    into: Array


def wall_faces(
    operators: Sequence[Viscosity | None], shares: Sequence[Shares], places: Array, grid: Grid, open: Open,
    centres: Sequence[Array], mu: float, F: Array | None, spread: float,
) -> list[list[WallFaces]]:  # fmt: skip
    """For each body, its wet faces of u, v, w that feel it.

    shares: mean ones of every body's cells; places (b, 3) [length]: B; open: areas of the step; centres: of cells,
    (n + 4,) for each direction; mu [mass/length/time]; F (mesh) or None; spread [length2] = dt nu where slivers have
    another inertia, else 0.
    """
    found: list[list[WallFaces]] = [[] for _ in shares]
    shape = open.V.shape
    covers = [_covers(one, grid, shape) for one in shares]
    for c, operator in enumerate(operators):
        if operator is None or operator.cut is None:
            continue
        cut = operator.cut
        rows = np.ravel_multi_index(tuple(cut.rows[:, :3].T.astype(np.int64)), shape)
        step = int(np.prod(shape[c + 1 :]))
        for of_body, cover, place in zip(found, covers, places, strict=True):
            at, covered, into = _beside(rows, step, cover)
            some = cut.s[at] > 0.0
            at, covered, into = at[some], covered[some], into[some]
            if len(at):
                share = covered / np.maximum(_closed(cut.rows[at], c, grid, open), covered)
                volume, wall = _where(cut.rows[at], c, cut.V[at], into, grid, centres)
                E = np.zeros((len(at), 6))
                E[:, c] = 1.0
                E[:, 3:] = np.cross(wall - place, np.eye(3)[c])
                own, beside = _weights(cut, at, rows[at], step, F, shape, spread)
                D = mu * cut.s[at] * volume * share
                one = WallFaces(c, at, rows[at], rows[at] + step, share, E, D * own, D[:, None] * beside).wet(F)
                if len(one.at):
                    of_body.append(one)
    return found


def spin_resistance(
    shares: Shares, place: Array, grid: Grid, centres: Sequence[Array], mu: float, F: Array | None
) -> Array:
    """(6, 6): moment - mu sum of r x (a x w) with areas a out of the body, for a spin w. F (mesh) or None, as shares.

    Symmetrical: of r a^T only the closed wall's part, 0 across, is not; parts of walls are made so.
    """
    cells = tuple(shares.cells.T.astype(np.int64))
    a = -wall_areas(shares, grid)
    if F is not None:
        a *= F[cells].clip(0.0, 1.0)[:, None]
    r = np.column_stack([x[k] for x, k in zip(centres, cells, strict=True)]) - place
    moments = r.T @ a
    out = np.zeros((6, 6))
    out[3:, 3:] = mu * (np.trace(moments) * np.eye(3) - 0.5 * (moments + moments.T))
    return out


def _covers(shares: Shares, grid: Grid, shape: tuple[int, ...]) -> Covers:
    cells = tuple(shares.cells.T.astype(np.int64))
    areas = _face_areas(cells, grid)
    covered = ((shares.faces[:, ::2] + shares.faces[:, 1::2]) * areas).sum(axis=1)
    return Covers(np.ravel_multi_index(cells, shape), covered, wall_areas(shares, grid))


def _face_areas(cells: tuple, grid: Grid) -> Array:
    """(n, 3) [length2]."""
    dx, dy, dz = (d[k] for d, k in zip(grid[:3], cells, strict=True))
    return np.column_stack([dy * dz, dz * dx, dx * dy])


def _steps(shape: tuple[int, ...]) -> tuple[int, ...]:
    """To the flat indices of the neighbours below and above along x, y, z."""
    return tuple(sign * n for n in (shape[1] * shape[2], shape[2], 1) for sign in (-1, 1))


def _weights(
    cut: CutViscosity, at: Array, low: Array, step: int, F: Array | None, shape: tuple[int, ...], spread: float
) -> tuple[Array, Array]:
    """(n,) and (n, 6): of D, what goes with the face's own velocity and with those of its neighbours."""
    c, s = cut.c[at], cut.s[at]
    whole = np.maximum(cut.V[at], spread * (c.sum(axis=1) + s))
    beta = np.divide(cut.V[at], whole, out=np.ones(len(at)), where=whole > 0.0)
    if F is not None:
        flat = F.reshape(-1)
        near = low[:, None] + np.array(_steps(shape))
        c = np.where(np.maximum(flat[near], flat[near + step]) > 0.0, c, 0.0)
    return beta, ((1.0 - beta) / (c.sum(axis=1) + s))[:, None] * c


def _beside(rows: Array, step: int, cover: Covers) -> tuple[Array, Array, Array]:
    """Positions (n,) in rows (ascending numbers of faces) that a body touches with the cell below or above; covered
    (n,) and into (n, 3), both cells together."""
    at, cell = [], []
    for numbers in (cover.numbers, cover.numbers - step):  # the cell is the face's own, or the one above it
        if len(rows):
            place = np.minimum(np.searchsorted(rows, numbers), len(rows) - 1)
            hit = rows[place] == numbers
            at.append(place[hit])
            cell.append(np.flatnonzero(hit))
    if not at:
        return np.zeros(0, np.int64), np.zeros(0), np.zeros((0, 3))
    cell = np.concatenate(cell)
    faces, of = np.unique(np.concatenate(at), return_inverse=True)
    sums = [np.bincount(of, weights, len(faces)) for weights in (cover.covered[cell], *cover.into[cell].T)]
    return faces, sums[0], np.column_stack(sums[1:])


def _closed(rows: Array, c: int, grid: Grid, open: Open) -> Array:
    """(n,) [length2]: closed area of all faces of the two cells of each face."""
    total = np.zeros(len(rows))
    for up in (0, 1):
        cells = rows[:, :3].astype(np.int64)
        cells[:, c] += up
        at = tuple(cells.T)
        areas = _face_areas(at, grid)
        for d, A in enumerate(open[1:]):
            below = list(at)
            below[d] = at[d] - 1
            total += (2.0 - A[at] - A[tuple(below)]) * areas[:, d]
    return total


def _where(rows: Array, c: int, V: Array, into: Array, grid: Grid, centres: Sequence[Array]) -> tuple[Array, Array]:
    """Volumes (n,) [length3] of the faces' cells, and places (n, 3) [length] of the walls there."""
    cells = tuple(rows[:, :3].T)
    sizes = np.column_stack([d[k] for d, k in zip(grid[:3], cells, strict=True)])
    wall = np.column_stack([x[k] for x, k in zip(centres, cells, strict=True)])
    above = grid[c][cells[c] + 1]
    wall[:, c] += 0.5 * sizes[:, c]  # the face, above the cell's centre
    sizes[:, c] = 0.5 * (sizes[:, c] + above)
    length = np.linalg.norm(into, axis=1)
    normal = into / np.where(length > 0.0, length, 1.0)[:, None]
    width = (np.abs(normal) * sizes).sum(axis=1)
    return sizes.prod(axis=1), wall + ((V - 0.5) * width)[:, None] * normal
