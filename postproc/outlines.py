"""Where a plane cuts the surface of a body: closed curves, from its triangles.

A triangle with corners on both sides of the plane is crossed once, along a line from the edge by which one walks down
through the plane (corners in their order) to the edge by which one walks up again. The neighbour walks the edge that
they share the other way, so that lines join end to start. A corner in the plane counts as above it: no triangle then
has a crossing of its own there, and a face in the plane is drawn or not as a whole.
"""

from __future__ import annotations

import numpy as np
from matplotlib.path import Path as Curve

from postproc.scene import Surface


def outlines(surface: Surface, axis: int, position: float) -> list[np.ndarray]:
    """Closed curves (n, 2) of a body in the plane across `axis`; what is inside lies on the same side of all of them.

    A hole runs the other way around than what it is in; pieces that overlap run the same way. surface.faces turn
    outwards, and neighbours share their points.
    """
    height = surface.points[:, axis] - position
    over = height[surface.faces] >= 0
    crossed = over.any(axis=1) & ~over.all(axis=1)
    faces, over = surface.faces[crossed], over[crossed]
    if not len(faces):
        return []
    rows = np.arange(len(faces))
    following = np.roll(over, -1, axis=1)
    down, up = ((a & ~b).argmax(axis=1) for a, b in ((over, following), (following, over)))
    begins, ends = (np.sort(np.stack([faces[rows, k], faces[rows, (k + 1) % 3]], 1), axis=1) for k in (down, up))
    others = [d for d in range(3) if d != axis]
    high, low = height[begins[:, 0]], height[begins[:, 1]]
    share = (high / (high - low))[:, None]
    first, second = (surface.points[begins[:, k]][:, others] for k in (0, 1))
    points = first + share * (second - first)
    return [points[loop] for loop in _loops(begins, ends)]


def _loops(begins: np.ndarray, ends: np.ndarray) -> list[np.ndarray]:
    """Numbers of the lines that follow each other; a line ends on the edge (2 points) on which the next begins."""
    starts_at = {tuple(edge): k for k, edge in enumerate(begins.tolist())}
    follows = [starts_at.get(tuple(edge), -1) for edge in ends.tolist()]
    left, loops = set(range(len(begins))), []
    while left:
        k, loop = min(left), []
        while k in left:
            left.remove(k)
            loop.append(k)
            k = follows[k]
        loops.append(np.array(loop))
    return loops


def curve_of(loops: list[np.ndarray]) -> Curve:
    """The curves as one path, whose inside is filled."""
    closed = [np.vstack([loop, loop[:1]]) for loop in loops]
    codes = [[Curve.MOVETO, *[Curve.LINETO] * (len(loop) - 2), Curve.CLOSEPOLY] for loop in closed]
    return Curve(np.concatenate(closed), np.concatenate(codes))
