"""How deep two bodies overlap.

sphere and sphere   r_a + r_b - |c_a - c_b|
sphere and box      r - d_box(c)
else                deepest of many points: of the surface of one in the other, and of the space common to both
"""

from __future__ import annotations

import numpy as np

from flowgmo.geometry.component import Component

POINTS = 24  # per longest side of the body that is sampled
LEAST = 1e-12  # of the scale: smaller depths are rounding


def overlap_depth(a: Component, b: Component, scale: float) -> float:
    """Depth [length] by which two bodies overlap, 0 when apart; `scale`: size of the smaller body [length].

    Exact for two spheres and for a sphere and one box; else from samples 1/24 of the common box apart.
    """
    for one, other in ((a, b), (b, a)):
        ball = one.as_sphere()
        boxes = other.as_boxes()
        if ball and (other.as_sphere() or boxes and len(boxes) == 1):
            centre, radius = ball
            return _cleaned(radius - float(other.distance(centre[None])[0]), scale)
    common = np.array([np.maximum(a.bounds()[0], b.bounds()[0]), np.minimum(a.bounds()[1], b.bounds()[1])])
    if (common[0] >= common[1]).any():
        return 0.0
    depth = 0.0
    for one, other in ((a, b), (b, a)):
        points = _surface_points(one, common, scale)
        if len(points):
            depth = max(depth, -float(other.distance(points).min()))
    if np.isfinite(common).all():
        depth = max(depth, float(np.minimum(-a.distance(grid := _grid(common)), -b.distance(grid)).max()))
    return _cleaned(depth, scale)


def _cleaned(depth: float, scale: float) -> float:
    return depth if depth > LEAST * scale else 0.0


def _grid(box: np.ndarray) -> np.ndarray:
    sides = [np.linspace(lo, hi, POINTS // 2 + 1) for lo, hi in box.T]
    return np.stack(np.meshgrid(*sides, indexing="ij"), -1).reshape(-1, 3)


def _surface_points(body: Component, common: np.ndarray, scale: float) -> np.ndarray:
    """Points (n,3) of the surface within the common box: corners, and large triangles filled evenly."""
    bounds = body.bounds()
    reach = np.array([common[0] - scale, common[1] + scale])
    clip = None if np.isfinite(bounds).all() else np.where(np.isfinite(reach), reach, np.sign(reach) * scale)
    vertices, faces = body.triangles(POINTS, clip)
    if not len(faces):
        return vertices
    corners = vertices[faces]
    spacing = max(float(np.ptp(np.where(np.isfinite(common), common, 0.0), axis=0).max()), scale) / POINTS
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(1)
    steps = np.clip(np.ceil(sides / spacing).astype(int), 1, 4 * POINTS)
    points = []
    for n in np.unique(steps):
        i, j = np.meshgrid(np.arange(n + 1), np.arange(n + 1), indexing="ij")
        share = np.stack([i, j, n - i - j], -1)[i + j <= n] / n
        points.append(np.einsum("sk,fkc->fsc", share, corners[steps == n]).reshape(-1, 3))
    points = np.vstack(points)
    return points[((points >= common[0]) & (points <= common[1])).all(1)]
