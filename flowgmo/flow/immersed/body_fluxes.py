"""What a body that moves pushes through the cells around it, and the load of their pressure on it: the same numbers.

A body with velocity v of B and spin w covers the shares S of the faces of a cell. It brings out of the cell

    J . (v, w) = sum over faces (outward S area (v + w x r) . n)  =  a . v + (r x a) . w         [length3/time]

    a = (S of the upper - S of the lower face) x face area, for each direction       r = centre of the cell - B

so that the liquid has to let in as much. The pressure p of the cell pushes the body by p a, with the moment p r x a
about B: J transposed. That both are one matrix keeps the pressure equation symmetric, and no energy is made between
body and liquid (Batty, Bertails and Bridson 2007, "A fast variational framework for accurate solid-fluid coupling").
Arms end at the centres of cells, not of faces: a body wholly inside feels no moment of a constant pressure, since
sum of r x a = sum over faces of S area h (n x n) = 0. Of a ball all normals meet in the centre: there all arms end,
and its spin moves nothing at all. Of any body of revolution they meet its axis, and turns about that move nothing: what
arms to the centres of cells make of them is taken out (c a point of the axis, k its direction)

    r x a - k (k . ((centre of the cell - c) x a))

Without it floating logs begin to turn about themselves, .09 rad/s after a second. (A spin that seems to move a little,
of a ball of hardly any inertia, is used by the pressure to fill what is short in some cell, which it never does: w grew
without bound.)

Where a body leaves through an open side of the domain the liquid beyond presses it too, with the pressure of the cells
at the side: their part of a has no share of the side's faces. (Without it the water inside pushes it out: a ball that
floats in a stream of 1 m/s left with 2.8.) What the body takes out through the side with the velocity that was expected
of it is in the growth of the cells; only what is found beyond that does not know of it.

The pressure of the centre is not that of the wall. In liquid at rest the rest is known (observe/loads.py):

    lift = rho g volume ((S upper + S lower) / 2 - covered share)

The sums over p a and over the first part of the lift cancel, so that the covered share alone says how much water a body
displaces. It is that of the start of the step: position and velocity then take turns (symplectic Euler), and a floating
body swings without damping; with that of the middle of the step a body on waves of frequency omega would lose
omega2 dt / 4 of its amplitude in a unit of time.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from flowgmo.flow.favor.body_cover import BodyCover
from flowgmo.flow.favor.shares import Shares
from flowgmo.flow.fields import G, Grid
from flowgmo.flow.immersed.displaced_places import displaced_places
from flowgmo.flow.immersed.waterline import Surface, waterline

WHOLE = 1.0 - 1e-12  # of a face: it is covered, but for rounding


class BodyFluxes(NamedTuple):
    """Of one body: cells (m,) flat index into arrays of mesh size; J (m, 6) [length2, length3]; lift (m, 6) [length3,
    length]: force of water at rest in a gravity of one along each axis, per density (see above), and its arm; edge
    (m, 2, 3) [length4/time2]: of waterline.py, None without a surface; axis (2, 3): of a body of revolution, from B to
    a point of it [length], and its direction; None of others; places (m, 3) [length4]: of displaced_places.py, None of
    a ball; beyond (m, 6): what J would be more with the shares of open sides, None of bodies that touch none."""

    cells: np.ndarray
    J: np.ndarray
    lift: np.ndarray
    edge: np.ndarray | None = None
    axis: np.ndarray | None = None
    places: np.ndarray | None = None
    beyond: np.ndarray | None = None

    @property
    def whole(self) -> np.ndarray:
        """(m, 6): J with what goes through open sides of the domain."""
        return self.J if self.beyond is None else self.J + self.beyond


def body_fluxes(
    shares: Shares,
    covered: np.ndarray,
    grid: Grid,
    centres: list[np.ndarray],
    place: np.ndarray,
    middle: np.ndarray | None = None,
    surface: Surface | None = None,
    cover: BodyCover | None = None,
    open_sides: Sequence[int] = (),
) -> BodyFluxes:
    """The fluxes of a body: mean shares of its cells (m, 3), covered (m,) of their volumes now; place (3,) [length]: B.

    centres: of cells, (n + 4,) for each direction; middle (3,): of a ball, from B to its centre; (2, 3) of a body of
    revolution, from B to a point of its axis, and its direction; None of other bodies;
    surface: None where nothing is void; cover: of the body where it is now; None: all act at the centres of cells;
    open_sides: numbers of those that liquid passes.
    """
    at, faces = shares.cells, _inside(shares, grid, open_sides)
    shape = tuple(len(c) for c in centres)
    dx, dy, dz = (d[at[:, e]] for e, d in enumerate(grid[:3]))
    areas = np.column_stack([dy * dz, dz * dx, dx * dy])
    lower, upper = faces[:, ::2], faces[:, 1::2]
    a = (upper - lower) * areas
    lift = (0.5 * (lower + upper) - covered[:, None]) * (dx * dy * dz)[:, None]
    r = np.column_stack([c[at[:, e]] for e, c in enumerate(centres)]) - place
    axis = middle if middle is not None and middle.ndim == 2 else None
    if middle is not None and axis is None:
        r[:] = middle
    cells = np.ravel_multi_index(tuple(at.T.astype(np.int64)), shape)
    edge = below = None
    if surface is not None:
        edge, below = waterline(at, faces, covered, surface, grid, centres, cover)
    places = None
    if cover is not None and (middle is None or axis is not None):
        places = displaced_places(at, cells, covered, cover, below, grid, centres)
    beyond = None
    if faces is not shares.faces:
        out = ((shares.faces - faces)[:, 1::2] - (shares.faces - faces)[:, ::2]) * areas
        beyond = np.hstack([out, off_axis(out, cross(r, out), axis)])
    J = np.hstack([a, off_axis(a, cross(r, a), axis)])
    return BodyFluxes(cells, J, np.hstack([lift, r]), edge, axis, places, beyond)


def _inside(shares: Shares, grid: Grid, open_sides: Sequence[int]) -> np.ndarray:
    """A body's shares of faces (m, 6), without those on open sides of the domain, and on faces from which the body goes
    on to such a side through cells that it fills."""
    faces = shares.faces
    for side in open_sides:
        d, upper = divmod(side, 2)
        there = shares.cells[:, d] == (len(grid[d]) - G - 1 if upper else G)
        if not (there & (faces[:, side] > 0.0)).any():
            continue
        rows = [shares.cells[:, e] for e in range(3) if e != d]
        along = shares.cells[:, d] if upper else -shares.cells[:, d]
        order = np.lexsort((along, *rows))
        last = np.ones(len(order), bool)  # of its row, towards the side
        last[:-1] = np.any([row[order][1:] != row[order][:-1] for row in rows], axis=0)
        there[order[last & (faces[order, side] >= WHOLE)]] = True
        faces = faces.copy() if faces is shares.faces else faces
        faces[there, side] = 0.0
    return faces


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """a x b (..., 3), bit by bit that of numpy, whose own takes several times as long."""
    out = np.empty(np.broadcast_shapes(a.shape, b.shape))
    for c in range(3):
        d, e = (c + 1) % 3, (c + 2) % 3
        out[..., c] = a[..., d] * b[..., e] - a[..., e] * b[..., d]
    return out


def off_axis(force: np.ndarray, moment: np.ndarray, axis: np.ndarray | None) -> np.ndarray:
    """moment (..., 3) about B of force (..., 3) without what turns a body of revolution about its axis (2, 3)."""
    if axis is None:
        return moment
    point, direction = axis
    own = (moment - cross(point, force)) @ direction
    return moment - own[..., None] * direction


def closed_sum(a: np.ndarray) -> np.ndarray:
    """a (n,) or (n, m) with sums over n of zero: every row gives its part of the sum, by the size of a and evenly.

    In liquid that is shut in, a body inside brings out of all cells together what it takes in. Where it touches a wall
    the cells between are closed, and their share is missing.
    """
    if not len(a):
        return a
    size = np.abs(a)
    weights = size + size.max(axis=0) / len(a)
    total = weights.sum(axis=0)
    return a - weights * np.divide(a.sum(axis=0), total, out=np.zeros_like(total), where=total > 0.0)


def fluxes_in(each: Sequence[BodyFluxes], numbers: np.ndarray) -> np.ndarray:
    """(n, 6 bodies): J of all bodies in cells of flat indices numbers (n,)."""
    J = np.zeros((len(numbers), len(each), 6))
    for n, one in enumerate(each):
        if len(one.cells):  # they ascend
            at = np.minimum(np.searchsorted(one.cells, numbers), len(one.cells) - 1)
            J[:, n] = np.where((one.cells[at] == numbers)[:, None], one.J[at], 0.0)
    return J.reshape(len(numbers), -1)


def weight_of_displaced(fluxes: BodyFluxes, liquid: np.ndarray, rho: float, gravity: np.ndarray) -> np.ndarray:
    """(6,) force and moment about B: `lift` of the cells with liquid (m,) bool, see above, `edge` and `places`."""
    each = rho * gravity * fluxes.lift[:, :3] * liquid[:, None]
    if fluxes.edge is not None:
        each += rho * np.where(liquid[:, None], fluxes.edge[:, 0], fluxes.edge[:, 1])
    r = fluxes.lift[:, 3:]
    force, moment = each.sum(axis=0), cross(r, each).sum(axis=0)
    if fluxes.places is not None:
        moment -= rho * cross(fluxes.places, gravity).sum(axis=0)
    return np.concatenate([force, off_axis(force, moment, fluxes.axis)])
