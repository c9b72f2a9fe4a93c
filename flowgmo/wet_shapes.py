"""What the shapes of bodies that move in liquid say of them, seen from B: how far they reach, what they turn about."""

from __future__ import annotations

import numpy as np


def reach_of(shape: object, origin: np.ndarray) -> float:
    """Farthest point of a shape from `origin` [length], at most; inf where it has no end."""
    low, high = shape.bounds()
    return float(np.linalg.norm(np.maximum(np.abs(low - origin), np.abs(high - origin))))


def axis_of(shape: object, origin: np.ndarray) -> np.ndarray | None:
    """(2, 3) from `origin` to a point of the axis of a body of revolution, and its direction; None of others."""
    axis = getattr(shape, "as_revolved", lambda: None)()
    return None if axis is None else np.stack([axis[0] - origin, axis[1]])


def ball_centre(shape: object, origin: np.ndarray) -> np.ndarray | None:
    """Centre of a ball from `origin`; None where a shape is no ball."""
    ball = getattr(shape, "as_sphere", lambda: None)()  # tests bring shapes of their own
    return None if ball is None else ball[0] - origin
