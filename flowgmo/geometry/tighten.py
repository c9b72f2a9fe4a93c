"""A finite box around quadrics and box limiters, so that a paraboloid cut by a plane is known to be bounded.

    m_i x_i² + 2 b_i x_i <= -(c + sum over j of the least m_j x_j² + 2 b_j x_j)

Source  Benhamou, Goualard, Granvilliers & Puget 1999 (HC4).
"""

from __future__ import annotations

import numpy as np

from flowgmo.geometry.quadrics import QuadricSolid
from flowgmo.geometry.root_quadric import RootQuadricSolid

Quadrics = list[QuadricSolid | RootQuadricSolid]


def tighten(lo: np.ndarray, hi: np.ndarray, quadrics: Quadrics) -> tuple[np.ndarray, np.ndarray]:
    """A smaller box (3,), (3,) around box and quadrics without mixed products, by interval propagation.

    k √(x²+y²) is at least k |x_i| for k > 0 and at least k (|x| + |y|) for k < 0.
    """
    lo, hi = lo.copy(), hi.copy()
    for _ in range(4):  # each pass can use the bounds that the one before found; three variables
        for q in quadrics:
            if np.abs(q.M - np.diag(np.diag(q.M))).max() > 0:
                continue
            root = getattr(q, "k", 0.0) * np.array([1, 1, 0])
            drop = np.maximum(-root, 0)
            least = [_least(q.M[j, j], 2 * q.b[j], drop[j], lo[j], hi[j]) for j in range(3)]
            for i in range(3):
                rest = q.c + sum(least[j] for j in range(3) if j != i)
                if np.isfinite(rest):
                    reach = _reach(q.M[i, i], 2 * q.b[i], -root[i], rest)
                    lo[i], hi[i] = max(lo[i], reach[0]), min(hi[i], reach[1])
    return lo, hi


def _least(m: float, b: float, k: float, lo: float, hi: float) -> float:
    """Least m x² + b x - k |x| for lo <= x <= hi."""
    tips = [(k - b) / (2 * m), -(k + b) / (2 * m)] if m > 0 else []
    ends = [x for x in (lo, hi, 0.0, *tips) if lo <= x <= hi and np.isfinite(x)]
    values = [m * x * x + b * x - k * abs(x) for x in ends]
    for x, slope in ((lo, -b - k), (hi, b - k)):
        if np.isinf(x) and (m < 0 or (m == 0 and slope < 0)):
            return -np.inf
    return min(values)


def _reach(m: float, b: float, k: float, rest: float) -> tuple[float, float]:
    """Interval around all x with m x² + b x - k |x| + rest <= 0; all of the axis where it has no two ends."""
    if m < 0:
        return -np.inf, np.inf
    right, left = _end(m, b - k, rest), _end(m, -b - k, rest)
    return (-left, right) if rest <= 0 or max(left, right) > 0 else (0.0, 0.0)


def _end(m: float, slope: float, rest: float) -> float:
    """Largest x >= 0 with m x² + slope x + rest <= 0: inf when there is no end, 0 when there is no such x."""
    if m == 0:
        if slope > 0:
            return max(-rest / slope, 0.0)
        return np.inf if slope < 0 or rest <= 0 else 0.0
    disc = slope * slope - 4 * m * rest
    return max((-slope + np.sqrt(disc)) / (2 * m), 0.0) if disc >= 0 else 0.0
