"""Liquid of the deck that lies inside bodies: nothing is open there, so that it is not there at all.

A region, or the liquid below a height, of which no point lies outside all bodies. Looked at by points: a few first,
which settle most regions, since the distance to a mesh of many triangles takes time.
"""

from __future__ import annotations

import numpy as np

from flowgmo.bodies.body import Body
from flowgmo.building.findings import Findings
from flowgmo.flow_plan import LiquidStart
from flowgmo.geometry import Component
from flowgmo.mesh import Mesh

POINTS = 24  # along each direction of a region's box; with those at its ends a layer beside a side is met, however thin
EDGE = 1e-9  # of the box: how far its ends lie within
FIRST = 50  # points that are looked at before the others


def check_liquid_in_bodies(
    found: Findings, mesh: Mesh, bodies: tuple[Body, ...], start: LiquidStart, places: list[tuple], other: bool
) -> None:
    """A notice of each region that bodies fill, with their names; a problem where there is no other liquid.

    places: of each region of `start`, (variable, index) of the deck; other: whether a side brings liquid in.
    """
    regions = [
        (place, f"{region.name} of the liquid", region.shape)
        for place, region in zip(places, start.regions, strict=True)
        if region.adds and region.fraction > 0.0
    ]
    if start.height is not None and start.height > mesh.bounds[0, 2]:
        regions.append((("FLHT",), f"all liquid below flht={start.height:g}", start.height))
    inside = [_bodies_around(_points(shape, mesh), bodies) for *_, shape in regions]
    alone = not other and not start.volume and all(inside)
    for (place, name, _), names in zip(regions, inside, strict=True):
        wrong = f"{name} lies inside {' and '.join(names)}: none of it is there"
        if alone:
            found.problem(*place, wrong=f"{wrong}, and there is no other liquid", write="Move one of them")
        elif names:
            found.notice(*place, wrong=wrong, write="Move one of them, if that is not meant")


def _points(shape: Component | float, mesh: Mesh) -> np.ndarray:
    """Points (n, 3) of the domain within a shape, or below a height, in no order of place."""
    low, high = mesh.bounds
    if isinstance(shape, float):
        high = np.append(high[:2], min(high[2], shape))
    else:
        bounds = shape.bounds()
        low, high = np.maximum(low, bounds[0]), np.minimum(high, bounds[1])
    along = np.concatenate([[EDGE], (np.arange(POINTS) + 0.5) / POINTS, [1.0 - EDGE]])
    axes = [a + (b - a) * along for a, b in zip(low, high, strict=True)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    if not isinstance(shape, float):
        points = points[shape.distance(points) < 0.0]
    return np.random.default_rng(0).permutation(points)


def _bodies_around(points: np.ndarray, bodies: tuple[Body, ...]) -> list[str]:
    """Names of the bodies in which all the points lie together; none where one lies outside, or there are no points."""
    for some in (points[:FIRST], points):
        names, left = [], some
        for body in bodies:
            low, high = body.shape.bounds()
            near = ((left >= low) & (left <= high)).all(axis=1)
            if near.any():
                near[near] = body.shape.distance(left[near]) < 0.0
                left, names = left[~near], [*names, body.name] if near.any() else names
        if len(left) or not len(some):
            return []
    return names
