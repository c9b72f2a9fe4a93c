"""Where the liquid lifts a body: the centre of what it displaces.

The liquid's level at a body is the height to which still liquid would wet as much of its wall,

    sum over wall cells of |a| wetted(level) = sum of |a| F        wetted: the part of a cell's height below the level

which needs no search for a water line, is all of the wall of a body under water, and none in the dry. What the body
covers of the mesh below that level is what it displaces, cell by cell. In a cell of which it covers the part c and the
shares S of its faces, that part lies off the centre, along each direction, by

    (1 - c) / 2 (S_upper - S_lower) dx        exact for a body that fills one end of the cell

and lower where the level cuts the cell. Waves along the body and the air under a lid are averaged. Heights
are against gravity; without gravity nothing is lifted, and the level cuts along z.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.favor.body_cover import BodyCover
from flowgmo.flow.fields import Flow, Grid
from flowgmo.flow.observe.body_loads import wall_areas


def buoyancy_centre(
    cover: BodyCover, flow: Flow, V: np.ndarray, grid: Grid, centres: list[np.ndarray], up: np.ndarray
) -> tuple[np.ndarray, float]:
    """Centre (3,) [length] and volume [length3] of the liquid that a body displaces inside the domain; up (3,): unit
    vector against gravity. Volume 0 (and a centre that says nothing): the body is dry."""
    at, shares, lean = _covered_cells(cover)
    index = np.unravel_index(at, flow.p.shape)
    places = np.column_stack([c[k] for c, k in zip(centres, index, strict=True)])
    sizes = np.column_stack([d[k] for d, k in zip(grid[:3], index, strict=True)])
    places = places + lean * sizes
    below = 1.0
    if flow.F is not None:
        level = _level(cover, flow, V, grid, centres, up)
        half = 0.5 * sizes @ np.abs(up)
        height = places @ up
        below = np.clip(0.5 + 0.5 * (level - height) / half, 0.0, 1.0)
        places = places - ((1.0 - below) * half)[:, None] * up
    part = shares * below * sizes.prod(axis=1)
    volume = float(part.sum())
    return (part @ places / volume if volume > 0.0 else np.zeros(3)), volume


def _covered_cells(cover: BodyCover) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """All n cells of a body: their numbers, the shares of their volumes that it covers, and (n, 3) how far these parts
    lie off the centres, in cells."""
    inside = [np.arange(a, b) for a, b in cover.runs]
    numbers = np.concatenate([cover.numbers, *inside]) if inside else cover.numbers
    rest, c = len(numbers) - len(cover.numbers), cover.shares[:, 6]
    lean = 0.5 * (1.0 - c)[:, None] * (cover.shares[:, 1:6:2] - cover.shares[:, 0:6:2])
    return numbers, np.concatenate([c, np.ones(rest)]), np.concatenate([lean, np.zeros((rest, 3))])


def _level(cover: BodyCover, flow: Flow, V: np.ndarray, grid: Grid, centres: list[np.ndarray], up: np.ndarray) -> float:
    """Height [length] along `up` to which still liquid wets as much of a body's wall."""
    wall = np.linalg.norm(wall_areas(cover, flow.p.shape, grid), axis=1) * (V.reshape(-1)[cover.numbers] > 0.0)
    at = cover.numbers[wall > 0.0]
    wall = wall[wall > 0.0]
    wet = float(wall @ flow.F.reshape(-1)[at].clip(0.0, 1.0))
    if wet <= 0.0:
        return -np.inf
    if wet >= float(wall.sum()):
        return np.inf
    index = np.unravel_index(at, flow.p.shape)
    height = sum(u * c[k] for u, c, k in zip(up, centres, index, strict=True))
    half = 0.5 * sum(abs(u) * d[k] for u, d, k in zip(up, grid[:3], index, strict=True))
    # the wetted area grows by wall / (2 half) a height in each cell between its ends: linear between all of these
    ends = np.concatenate([height - half, height + half])
    slopes = np.concatenate([0.5 * wall / half, -0.5 * wall / half])
    order = np.argsort(ends, kind="stable")
    ends, slopes = ends[order], np.cumsum(slopes[order])
    areas = np.concatenate([[0.0], np.cumsum(slopes[:-1] * np.diff(ends))])
    k = int(np.searchsorted(areas, wet, side="left"))
    k = min(max(k, 1), len(ends) - 1)
    step = areas[k] - areas[k - 1]
    return float(ends[k - 1] + (ends[k] - ends[k - 1]) * ((wet - areas[k - 1]) / step if step > 0.0 else 1.0))
