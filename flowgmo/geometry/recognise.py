"""Which shape a piece is."""

from __future__ import annotations

import numpy as np

from flowgmo.geometry.errors import GeometryError
from flowgmo.geometry.piece import Piece, Range
from flowgmo.geometry.primitives import Ball, Box
from flowgmo.geometry.solid import Solid
from flowgmo.geometry.transform import Affine


def span(limits: Range | None) -> tuple[float, float]:
    """Lower and upper bound, ±inf where there is none."""
    lo, hi = limits or (None, None)
    return (-np.inf if lo is None else float(lo), np.inf if hi is None else float(hi))


def recognise(piece: Piece, component: Affine) -> Solid:
    """The solid that a piece is, in space."""
    R, s = component.after(piece.transform.affine).columns()
    b = component.after(piece.transform.affine).b
    limits = piece.limits
    lo, hi = np.array([span(limits.x), span(limits.y), span(limits.z)]).T
    if np.isfinite(span(limits.sphere)[1]):
        return Solid(Ball(span(limits.sphere)[1]), s[0], R, b)
    if (lo >= hi).any():
        raise GeometryError("empty")
    return Solid(Box(lo * s, hi * s), 1.0, R, b)
