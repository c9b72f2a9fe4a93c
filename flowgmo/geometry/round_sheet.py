"""Balls and cylinders among the curved sheets of a body, found by their distance alone."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

FITTED = 64  # points where a curved sheet is compared with a ball and a cylinder
FIT = 1e-13  # of the body's size: what both may differ by


def round_sheet(distance: Callable[[np.ndarray], np.ndarray], middle: np.ndarray, size: float) -> np.ndarray | None:
    """Numbers (8,) of the ball or cylinder whose distance this is, but for rounding; None for all others.

    d = s (|w| - r) with w = P y - c, P = I - a a, gives   d^2 = y . P y - 2 c . y - 2 s r d + (c . c - r^2),   linear
    in what is sought: P, c, s r. The axis a is where P is 0; a ball has none.
    """
    y = 2.0 * spread(FITTED) - 1.0
    d = distance(middle + size * y) / size
    if not np.isfinite(d).all():
        return None
    squares = y[:, [0, 1, 2, 1, 0, 0]] * y[:, [0, 1, 2, 2, 2, 1]]
    terms = np.column_stack([squares, -2.0 * y, -2.0 * d, np.ones(len(y))])
    xx, yy, zz, yz, xz, xy, cx, cy, cz, sr, _ = np.linalg.lstsq(terms, d * d, rcond=None)[0]
    along, axes = np.linalg.eigh(np.array([[xx, xy / 2, xz / 2], [xy / 2, yy, yz / 2], [xz / 2, yz / 2, zz]]))
    axis = axes[:, 0] if along[0] < 0.5 else np.zeros(3)
    axis = np.where(np.abs(axis) < FIT, 0.0, axis)
    c = np.array([cx, cy, cz])
    c -= axis * (c @ axis)
    r, s = abs(sr), np.sign(sr)
    across = y - np.outer(y @ axis, axis)
    if r == 0.0 or not np.abs(s * (np.linalg.norm(across - c, axis=1) - r) - d).max() <= FIT:
        return None
    return np.concatenate([middle + size * c, axis, [size * r, s]])


def spread(count: int) -> np.ndarray:
    """Points (count, 3) all over the unit cube: additive recurrence with the roots of x^4 = x + 1 (Roberts 2018)."""
    g = 1.22074408460575947536  # the positive root
    return (0.5 + np.arange(1, count + 1)[:, None] * np.array([1 / g, 1 / g**2, 1 / g**3])) % 1.0
