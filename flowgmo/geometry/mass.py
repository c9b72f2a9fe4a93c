"""Mass properties of a component, by the best of three ways.

one exact shape           closed form (box, sphere, revolved, ellipsoid, lattice of boxes, mesh)
pieces that do not touch  sum of closed forms; a hole that lies wholly in one solid is subtracted
anything else             columns (columns.py), with an error estimate
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from flowgmo.geometry.columns import integrate
from flowgmo.geometry.errors import GeometryError
from flowgmo.geometry.moments import NOTHING, MassProperties, Moments, mass_properties_from
from flowgmo.geometry.primitives import Ball, Box

if TYPE_CHECKING:
    from flowgmo.geometry.component import Component
    from flowgmo.geometry.piece import Piece
    from flowgmo.geometry.solid import Solid


def mass_properties(component: Component, density: float | None) -> MassProperties:
    """Of a bounded component; `density` [mass/length³] holds for solid pieces without their own."""
    refuse_unbounded(component.bounds())
    weights = np.array([_density(piece, density) for piece in component.pieces])
    if component.merged is not None:
        return _of_merged(component, weights)
    added = _added(component.roles, component.solids, weights)
    if added is not None:
        return mass_properties_from(added[0].m0, added[1])
    volume, weighted, error = integrate(component.solids, component.owner, weights)
    return mass_properties_from(volume, weighted, error)


def refuse_unbounded(bounds: np.ndarray) -> None:
    """Raise when a box (2,3) is infinite, naming the axes."""
    endless = [name for k, name in enumerate("xyz") if not np.isfinite(bounds[:, k]).all()]
    if endless:
        raise GeometryError(f"the body is unbounded in {' and '.join(endless)}: give it limits there")


def _density(piece: Piece, density: float | None) -> float:
    if piece.role == "hole":
        return 0.0
    value = density if piece.density is None else piece.density
    if value is None or not np.isfinite(value) or value <= 0:
        which = f" {piece.name}" if piece.name else ""
        raise GeometryError(f"subcomponent{which} has no positive density")
    return float(value)


def _of_merged(component: Component, weights: np.ndarray) -> MassProperties:
    shape, place = component.merged.shape, component.merged.place
    own = shape.moments()
    if own is None:  # a single general quadric with limiters
        volume, weighted, error = integrate(component.solids, component.owner, weights)
        return mass_properties_from(volume, weighted, error)
    volume = own.moved(place).m0
    if len(component.pieces) == 1:
        return mass_properties_from(volume, own.moved(place).times(weights[0]))
    return mass_properties_from(volume, shape.moments(weights).moved(place))


def _added(roles: Sequence[str], solids: Sequence[Solid], weights: np.ndarray) -> tuple[Moments, Moments] | None:
    """Plain and weighted moments when every piece stands apart or is a hole inside one solid; None otherwise."""
    volume, weighted, standing, holes = NOTHING, NOTHING, [], []
    for role, solid, weight in zip(roles, solids, weights, strict=True):
        moments = solid.moments()
        if moments is None or role == "complement" or not all(apart(solid, hole) for hole in holes):
            return None
        met = [(other, density) for other, density in standing if not apart(solid, other)]
        if role == "solid":
            if met:
                return None
            standing.append((solid, weight))
            volume, weighted = volume.plus(moments), weighted.plus(moments.times(weight))
        elif met:
            other, density = met[0]
            if len(met) > 1 or not holds(other, solid):
                return None
            holes.append(solid)
            volume, weighted = volume.plus(moments.times(-1)), weighted.plus(moments.times(-density))
    return volume, weighted


def apart(a: Solid, b: Solid) -> bool:
    """The boxes around two solids, along the axes of space or of either, share no volume."""
    for axes in (np.eye(3), a.R.T, b.R.T):
        for d in axes:
            low, high = max(-a.support(-d), -b.support(-d)), min(a.support(d), b.support(d))
            if low >= high - 1e-12 * max(abs(low), abs(high)):  # rounding: faces that touch share nothing
                return True
    return False


def holds(outer: Solid, inner: Solid) -> bool:
    """The inner solid surely lies within the outer: its surrounding ball is, or its surrounding box in a convex one."""
    low, high = np.array([[-inner.support(-d), inner.support(d)] for d in inner.R.T]).T
    if not np.isfinite([low, high]).all():
        return False
    middle = inner.R @ ((low + high) / 2)
    reach = (high - low)[0] / 2 if isinstance(inner.shape, Ball) else np.linalg.norm(high - low) / 2
    if outer.distance(middle[None])[0] <= -reach:
        return True
    corners = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
    points = np.where(corners, high, low) @ inner.R.T
    return isinstance(outer.shape, Box) and bool(outer.inside(points).all())
