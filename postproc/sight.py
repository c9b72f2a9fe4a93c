"""What the pictures show: the box that the bodies sweep, the solids and sides of the domain beside it, the floor.

A body of radius r about its centre (the farthest of its points) that has turned by an angle θ at most since the first
picture is nowhere farther out than its first extent plus 2 r sin(θ/2), nor than r. With the extremes of its position
this bounds it in every frame, also between the rows of the history, where positions are linear.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from postproc.bounces import vertical_axis
from postproc.scene import Scene, Surface

WHOLE = 1.6  # the domain is shown as long as its diagonal is at most so many times that of what matters
NEAR = 0.35  # of the largest side of the swept box; what is not farther is shown
PAD = 0.12  # of the same; air around the bodies


@dataclass(frozen=True)
class Frame:
    """The box (2, 3) that a picture shows; whether that is the domain; the floor's four corners (4, 3), or None."""

    bounds: np.ndarray
    whole: bool = True
    floor: np.ndarray | None = None

    @property
    def corners(self) -> np.ndarray:
        """(8, 3)"""
        return np.array([[x, y, z] for x in self.bounds[:, 0] for y in self.bounds[:, 1] for z in self.bounds[:, 2]])


def frame_of(scene: Scene) -> Frame:
    """All that is ever to be seen: moving bodies in every frame as far as they are in the domain, and what is near.

    What leaves the domain through an open side would make all else tiny; it flies out of the picture.
    """
    domain = scene.bounds
    if scene.has_liquid:  # it goes everywhere
        return Frame(domain, floor=_floor(scene, domain))
    swept = swept_box(scene)
    if swept is None:
        return Frame(domain, floor=_floor(scene, domain))
    start = [s for s in scene.at(scene.times[0]) if not s.stationary]
    limits = _union(domain, *(_box(s) for s in start))  # a two-dimensional deck has bodies thicker than its domain
    box = _common(swept, limits)
    solids = [_common(_box(s), limits) for s in scene.at(scene.times[0]) if s.stationary]
    near = NEAR * np.ptp(box, axis=0).max()
    for solid in solids:
        together, beside = _union(box, solid), _common(solid, _grown(box, near))
        if (beside[0] <= beside[1]).all():
            box = together if _diagonal(together) <= WHOLE * _diagonal(box) else _union(box, beside)
    if _diagonal(_union(domain, box)) <= WHOLE * _diagonal(box):
        box = _union(domain, box)
        return Frame(box, floor=_floor(scene, box))
    size = np.ptp(box, axis=0).max()
    reached = (np.abs(box - domain) <= NEAR * size) & _walls(scene)
    padded = _common(_grown(box, PAD * size), _union(domain, box))
    box = _union(box, np.where(reached, domain, padded))
    return Frame(box, False, _floor(scene, box))


def swept_box(scene: Scene) -> np.ndarray | None:
    """(2, 3) that holds all moving bodies at all times of the history; None without one."""
    boxes = []
    for surface in scene.at(scene.times[0]):
        if surface.stationary or (track := scene.track(surface)) is None:
            continue
        p, q = track
        middle, first = scene.pose(surface, scene.times[0])
        points = surface.points - middle
        radius = np.linalg.norm(points, axis=1).max()
        cosine = np.abs(q @ first) / (np.linalg.norm(q, axis=1) * np.linalg.norm(first))  # of half the angle
        bulge = 2 * radius * np.sqrt(max(0.0, 1 - min(1.0, cosine.min()) ** 2))
        low = np.maximum(points.min(axis=0) - bulge, -radius)
        high = np.minimum(points.max(axis=0) + bulge, radius)
        boxes.append(np.array([p.min(axis=0) + low, p.max(axis=0) + high]))
    return _union(*boxes) if boxes else None


def _walls(scene: Scene) -> np.ndarray:
    """(2, 3): which sides of the domain are walls."""
    walls = scene.results.walls if scene.has_history else set()
    return np.array([[f"{axis}{end}" in walls for axis in "XYZ"] for end in ("min", "max")])


def _floor(scene: Scene, box: np.ndarray) -> np.ndarray | None:
    """The part of the domain's lower side in the box, where that side is a wall and up is z."""
    if not scene.has_history or vertical_axis(scene.results) != (2, 1.0) or "Zmin" not in scene.results.walls:
        return None
    z = scene.bounds[0, 2]
    if not box[0, 2] <= z <= box[1, 2]:
        return None
    (x0, y0, _), (x1, y1, _) = _common(box, scene.bounds)
    return np.array([[x0, y0, z], [x1, y0, z], [x1, y1, z], [x0, y1, z]])


def _box(surface: Surface) -> np.ndarray:
    return np.array([surface.points.min(axis=0), surface.points.max(axis=0)])


def _union(*boxes: np.ndarray) -> np.ndarray:
    return np.array([np.min([b[0] for b in boxes], axis=0), np.max([b[1] for b in boxes], axis=0)])


def _common(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """What two boxes share; the low corner is above the high one where that is nothing."""
    return np.array([np.maximum(a[0], b[0]), np.minimum(a[1], b[1])])


def _grown(box: np.ndarray, by: float) -> np.ndarray:
    return box + by * np.array([[-1.0], [1.0]])


def _diagonal(box: np.ndarray) -> float:
    return float(np.linalg.norm(np.ptp(box, axis=0)))
