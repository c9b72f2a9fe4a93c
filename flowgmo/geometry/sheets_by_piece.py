"""A body as its pieces in their order, and each piece by the sides of the body's sheets on which it lies.

    solid        S <- S or P
    hole         S <- S without P
    complement   S <- S or not P

P is where each of its sheets is negative, or positive where another piece has the same sheet from the other side:
touching boxes share a plane, and a hole that ends flush with the body has the body's. So sheets that are one cut once,
and pieces that lie on either side of one have nothing in common, to the bit. Whether a piece is of this kind is found
at points all over it and around; concave triangle meshes are divided into convex pieces first (convex_cells.py). What
is not, a sector of more than half a turn or a mesh of many faces, is one sheet, its distance.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from flowgmo.geometry.convex_cells import Cell as Convex
from flowgmo.geometry.convex_cells import convex_cells
from flowgmo.geometry.mesh_solid import MeshSolid
from flowgmo.geometry.piece import ROLES
from flowgmo.geometry.round_sheet import round_sheet, spread
from flowgmo.geometry.sheets import Sheets, sheets_of_solid
from flowgmo.geometry.solid import Solid

if TYPE_CHECKING:
    from flowgmo.geometry.component import Component

POINTS = 4096  # at which a piece is compared with its sheets: a part that they do not give is smaller than one of these
AROUND = 0.25  # of the piece's size: how far beyond its ends these points go, so that some are outside
BEYOND = 2.0  # of the distance of the ends that a body has: how far it is looked at where it has none
ALIKE = 1e-9  # of the body's size: two triangles of one flat face have planes that differ by rounding
SAME = 1e-12  # of the body's size: planes of two pieces, rounded by their rotations (merge.SAME)
MOST_SHEETS = 256  # of one body; their values at the nodes of a cell are 55 kB then
MOST_PIECES = 64  # of one body, convex parts of its meshes among them
MANY = (
    32  # planes of one piece: more stand for a curved surface, of which the distance says as much (flow/favor/sheets)
)
ROUND = 7  # numbers of a round sheet: centre (3), axis (3) or 0, radius
Distance = Callable[[np.ndarray], np.ndarray]


class PieceSheets(NamedTuple):
    """n (m, 3), h (m,): planes n . x = h; rounds (q, 7): balls and cylinders, centre, axis (0 of balls), radius;
    curved: distances of the other sheets. side (p, m + q + c) int8: -1, 1 where piece p lies on the negative,
    positive side of a sheet, 0 where that is none of its own; roles (p,) int64: index into piece.ROLES. exact: no
    piece is known by its distance only."""

    n: np.ndarray
    h: np.ndarray
    rounds: np.ndarray
    curved: tuple[Distance, ...]
    side: np.ndarray
    roles: np.ndarray
    exact: bool


def sheets_by_piece(body: Component) -> PieceSheets:
    """The sheets of a body's pieces; of one piece, known by its distance only, where there are too many."""
    one = _all_in_one(body)
    pieces, roles, exact = ([one], [0], True) if one is not None else _one_by_one(body)
    if not pieces or len(pieces) > MOST_PIECES or sum(len(p[0]) + len(p[2]) for p in pieces) > MOST_SHEETS:
        pieces, roles, exact = [known_by_distance(body)], [0], False
    middle, half = _box(body.bounds())
    sheets = _Once(middle, half)
    sides = [sheets.enter(piece) for piece in pieces]
    return sheets.put_together(sides, roles, exact)


def known_by_distance(shape: Component | Solid) -> Convex:
    """A piece of one curved sheet, its distance."""
    return np.zeros((0, 3)), np.zeros(0), (shape.distance,)


def _all_in_one(body: Component) -> Convex | None:
    """The body as what lies on the negative side of all its sheets; None where it does not."""
    low, high = body.bounds()
    if not np.isfinite(high - low).all() and len(body.solids) > 1:
        return None  # each by itself: what is cut out of a bar without an end may be anywhere
    if not may_be_ended(body.sheets, low, high):
        return None
    low, high = ended(low, high)
    if not (low < high).all():
        return None
    x = low + (high - low) * spread(POINTS)
    return _bounded_by(body.sheets, x, body.distance, 0.5 * (low + high), float(np.linalg.norm(high - low)))


def _one_by_one(body: Component) -> tuple[list[Convex], list[int], bool]:
    """Convex pieces in their order, with their roles, and whether none is known by its distance only."""
    low, high = body.bounds()
    pieces, roles, exact = [], [], True
    for solid, role in zip(body.solids, body.roles, strict=True):
        found = _convex(solid, role, low, high)
        exact = exact and found is not None
        found = found or [known_by_distance(solid)]
        pieces += found
        roles += [ROLES.index(role)] * len(found)
    return pieces, roles, exact


def may_be_ended(sheets: Sheets, low: np.ndarray, high: np.ndarray) -> bool:
    """Whether a piece with bounds (3,) is known where it has an end, if it has some: planes are, and round sheets along
    the one axis on which it has none (a cylinder). What has no end at all is not."""
    infinite = ~np.isfinite(low) | ~np.isfinite(high)
    ends = np.isfinite(low).any() or np.isfinite(high).any()
    return bool(not infinite.any() or ends and (not sheets.curved or infinite.sum() == 1))


def ended(low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Bounds (3,) with an end beyond those there are where a body has none: sheets that bound it do so there, and a
    plate without an end across a thin domain is as exact as one that ends beyond its sides."""
    ends = np.concatenate([low[np.isfinite(low)], high[np.isfinite(high)]])
    size = BEYOND * float(np.ptp(ends)) if len(ends) and np.ptp(ends) > 0.0 else 1.0
    first = np.where(np.isfinite(low), low, np.where(np.isfinite(high), high - size, -0.5 * size))
    return first, np.where(np.isfinite(high), high, first + size)


def _box(bounds: np.ndarray) -> tuple[np.ndarray, float]:
    """Middle (3,) and half the diagonal of bounds (2, 3)."""
    low, high = ended(*bounds)
    return 0.5 * (low + high), 0.5 * float(np.linalg.norm(high - low))


class _Once:
    """The sheets of all pieces, each once; middle (3,) and size [length] of the body."""

    def __init__(self, middle: np.ndarray, size: float) -> None:
        self.middle, self.size = middle, size
        self.planes: list[tuple[np.ndarray, float]] = []
        self.rounds: list[np.ndarray] = []
        self.curved: list[Distance] = []

    def enter(self, piece: Convex) -> tuple[list[tuple[int, int]], list[tuple[int, int]], list[tuple[int, int]]]:
        """Number and side of the piece's planes, round sheets, and others."""
        planes = [self._plane(n, h) for n, h in zip(*piece[:2], strict=True)]
        fitted = [round_sheet(d, self.middle, self.size) for d in piece[2]]
        rounds = [self._round(sheet) for sheet in fitted if sheet is not None]
        first = len(self.curved)
        self.curved += [d for d, sheet in zip(piece[2], fitted, strict=True) if sheet is None]
        return planes, rounds, [(c, -1) for c in range(first, len(self.curved))]

    def _plane(self, n: np.ndarray, h: float) -> tuple[int, int]:
        for s, (other, at) in enumerate(self.planes):
            for side in (-1, 1):
                apart = (n @ self.middle - h) + side * (other @ self.middle - at)
                if np.abs(n + side * other).max() <= SAME and abs(apart) <= SAME * self.size:
                    return s, side
        self.planes.append((n, h))
        return len(self.planes) - 1, -1

    def _round(self, sheet: np.ndarray) -> tuple[int, int]:
        sheet, side = sheet[:ROUND], -1 if sheet[ROUND] > 0.0 else 1
        for s, other in enumerate(self.rounds):
            turn = 1.0 if sheet[3:6] @ other[3:6] >= 0.0 else -1.0
            apart = np.append(sheet[:3] - other[:3], sheet[6] - other[6])
            if np.abs(apart).max() <= SAME * self.size and np.abs(sheet[3:6] - turn * other[3:6]).max() <= SAME:
                return s, side
        self.rounds.append(sheet)
        return len(self.rounds) - 1, side

    def put_together(self, sides: list[tuple], roles: list[int], exact: bool) -> PieceSheets:
        """All sheets, and which piece lies where."""
        first = 0, len(self.planes), len(self.planes) + len(self.rounds)
        side = np.zeros((len(sides), first[2] + len(self.curved)), np.int8)
        for p, kinds in enumerate(sides):
            for start, kind in zip(first, kinds, strict=True):
                for s, own in kind:
                    side[p, start + s] = own
        n, h = np.array([p[0] for p in self.planes]).reshape(-1, 3), np.array([p[1] for p in self.planes], float)
        rounds = np.array(self.rounds).reshape(-1, ROUND)
        return PieceSheets(n, h, rounds, tuple(self.curved), side, np.array(roles, np.int64), exact)


def _bounded_by(sheets: Sheets, x: np.ndarray, distance: Distance, middle: np.ndarray, size: float) -> Convex | None:
    """Planes and curved sheets with the points of x (q, 3) that are inside on the negative side of each, and only
    these; None where that cannot be."""
    n, h = _different(sheets.n, sheets.h, middle, size)
    curved = sheets.curved
    if len(n) > MANY or not len(n) + len(curved):
        return None
    inside = distance(x) < 0.0
    if not inside.any():
        return None
    planes = x @ n.T - h
    turn = np.where((planes[inside] > 0.0).mean(axis=0) > 0.5, -1.0, 1.0)
    values = np.column_stack([planes * turn, *(d(x) for d in curved)])
    if not ((values < 0.0).all(axis=1) == inside).all():
        return None
    return n * turn[:, None], h * turn, tuple(curved)


def _different(n: np.ndarray, h: np.ndarray, middle: np.ndarray, size: float) -> tuple[np.ndarray, np.ndarray]:
    """Each plane once."""
    kept: list[int] = []
    away = n @ middle - h
    for m in range(len(n)):
        alike = [k for k in kept if abs(n[k] - n[m]).max() <= ALIKE and abs(away[k] - away[m]) <= ALIKE * size]
        if not alike:
            kept.append(m)
        if len(kept) > MANY:
            break
    return n[kept], h[kept]


def _convex(solid: Solid, role: str, low: np.ndarray, high: np.ndarray) -> list[Convex] | None:
    """Planes and curved sheets of the convex pieces that a solid is; None where it is no such thing.

    low, high (3,): of the whole body; what lies beyond them does not matter.
    """
    sheets, points = sheets_of_solid(solid), _points(solid, low, high)
    if points is None or not may_be_ended(sheets, *Solid(solid.shape, 1.0, np.eye(3), np.zeros(3)).bounds()):
        return None
    x, middle, size = points
    found = _bounded_by(sheets, x, solid.distance, middle, size)
    if found is not None:
        return [found]
    if role == "complement" or not isinstance(solid.shape, MeshSolid):
        return None  # all but a union is no sequence of complements
    n, h = _different(sheets.n, sheets.h, middle, size)
    if len(n) > MANY:
        return None
    return convex_cells(solid.place(solid.shape.corners.reshape(-1, 3)).reshape(-1, 3, 3), n, h) or None


def _points(solid: Solid, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray, float] | None:
    """Points all over a piece and around it, their middle and how far apart they are; None where it has no end."""
    own = np.array(ended(*Solid(solid.shape, 1.0, np.eye(3), np.zeros(3)).bounds()))
    if np.isfinite(high - low).all():
        middle, half = solid.own(0.5 * (low + high)[None])[0], np.abs(solid.R.T) @ (0.5 * (high - low)) / solid.scale
        own = np.array([np.maximum(own[0], middle - half), np.minimum(own[1], middle + half)])
    size = own[1] - own[0]
    if not np.isfinite(size).all() or not (size > 0.0).all():
        return None
    x = solid.place(own[0] - AROUND * size + (1.0 + 2.0 * AROUND) * size * spread(POINTS))
    return x, solid.place(0.5 * (own[0] + own[1])[None])[0], solid.scale * float(np.linalg.norm(size))
