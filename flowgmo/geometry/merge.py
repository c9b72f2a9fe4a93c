"""Pieces that together are again one exact shape: boxes with common axes, solids of revolution with a common axis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from flowgmo.geometry.lattice import lattice_of
from flowgmo.geometry.moments import Moments
from flowgmo.geometry.primitives import Ball, Box
from flowgmo.geometry.profile import Bound, Field
from flowgmo.geometry.revolved import Revolved
from flowgmo.geometry.solid import Solid
from flowgmo.geometry.turned import half_plane_field

SAME = 1e-12  # cosines and relative offsets that count as none: rounding of rotations


def merge(roles: Sequence[str], solids: Sequence[Solid]) -> Solid | None:
    """One solid that is all of them applied in order; None when they have no common frame."""
    if len(solids) == 1 and roles[0] == "solid":
        return solids[0]
    if all(isinstance(s.shape, Box) for s in solids):
        return _boxes(roles, solids)
    if all(isinstance(s.shape, Ball) or isinstance(s.shape, Revolved) and s.shape.whole for s in solids):
        return _coaxial(roles, solids)
    return None


def _boxes(roles: Sequence[str], solids: Sequence[Solid]) -> Solid | None:
    frame, boxes = solids[0], []
    for solid in solids:
        turn = frame.R.T @ solid.R
        signs = np.round(turn)
        if np.abs(turn - signs).max() > SAME:
            return None
        origin = (solid.b - frame.b) @ frame.R
        lo, hi = solid.scale * solid.shape.lo, solid.scale * solid.shape.hi
        to = np.abs(signs).argmax(1)  # axis of the solid that becomes axis k of the frame
        flip = signs.sum(1) < 0
        boxes.append(Box(origin + np.where(flip, -hi[to], lo[to]), origin + np.where(flip, -lo[to], hi[to])))
    lattice = lattice_of(roles, boxes)
    return Solid(lattice, 1.0, frame.R, frame.b) if lattice else None


def _coaxial(roles: Sequence[str], solids: Sequence[Solid]) -> Solid | None:
    first = next((s for s in solids if isinstance(s.shape, Revolved)), None)
    if first is None:
        return None
    axis, bounds = first.R[:, 2], []
    for solid in solids:
        offset = solid.b - first.b
        z0 = float(offset @ axis)
        turned = isinstance(solid.shape, Revolved)
        size = max(solid.scale * (solid.shape.size if turned else solid.shape.radius), float(np.abs(offset).max()))
        flip = float(solid.R[:, 2] @ axis) if turned else 1.0
        if np.abs(offset - z0 * axis).max() > SAME * size or abs(abs(flip) - 1) > SAME:
            return None
        own = solid.shape.bounds if turned else (Bound(a=1.0, e=1.0, c=-(solid.shape.radius**2)),)
        bounds.append(tuple(bound.along_axis(solid.scale, z0, np.sign(flip)) for bound in own))
    every = tuple(bound for own in bounds for bound in own)
    field = _field(roles, bounds, np.ones(len(solids)))
    name = "coaxial solids of revolution"
    shape = CoaxialSolids(every, field, label=name, roles=tuple(roles), of_pieces=tuple(bounds))
    return Solid(shape, 1.0, first.R, first.b)


@dataclass(frozen=True, eq=False)
class CoaxialSolids(Revolved):
    """A solid of revolution that knows the roles and bounds of the pieces it is made of."""

    roles: tuple[str, ...] = ()
    of_pieces: tuple[tuple[Bound, ...], ...] = ()

    def moments(self, weights: np.ndarray | None = None) -> Moments | None:
        """Moments; weights: the density of each piece, the later holds where two overlap."""
        return super().moments(None if weights is None else _field(self.roles, self.of_pieces, weights))


def _field(roles: Sequence[str], bounds: Sequence[tuple[Bound, ...]], weights: np.ndarray) -> Field:
    fields = [half_plane_field(own) for own in bounds]

    def field(r: np.ndarray, z: np.ndarray) -> np.ndarray:
        total = np.zeros(np.shape(r))
        for role, own, weight in zip(roles, fields, weights, strict=True):
            within = own(r, z) != 0
            total = np.where(within ^ (role == "complement"), 0.0 if role == "hole" else weight, total)
        return total

    return field
