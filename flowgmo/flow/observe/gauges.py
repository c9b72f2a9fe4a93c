"""Probes: pressure, velocity, fraction and depth of the liquid at points.

A value is interpolated between the eight places around the point where its kind lives (centres of cells for p and F,
faces for u, v, w), linearly along each direction:    value = sum of w f / sum of w

Left out are places in solids, and those that no open way inside the eight cells joins to the cell of the point (the
other side of a thin wall). So a gauge on a wall, or half a cell beside a side of the domain, reads from the liquid's
side only. What is left lies at x' = sum of w x / sum of w, not at the point x; pressure is taken from there to x as in
liquid at rest,

    p(x) = sum of w p / sum of w + s rho g . (x - x'),        s the share of w in liquid cells

(x' = x with all eight: plain interpolation). A point deeper in a solid reads the open cell whose box is nearest, the
mean of those equally near. Beside a wall the velocity across it is 0 on it. Where none of the cells around the point
holds liquid the velocity reads 0.

    height = floor + integral of F V dz / A        A the largest V of them: below 1 beside an upright wall

over the cells above each other that are open and joined, at the point's own level or nearest to it. The floor is where
they begin, higher by what solids take of the cells below the first that is open to A; a full column then reads its top.
A point on the plane between columns reads their mean.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from flowgmo.flow.fields import Flow, G, Open
from flowgmo.mesh import Block

SAME = 1e-9  # of a cell: a point so near to a plane of the mesh lies on it; rounding of the deck's numbers
ROUNDING = 16 * np.finfo(float).eps  # of a coordinate: of the sum of eight products
DUST = 1e-6  # of a cell: with less it is dry, as in liquid.py


@dataclass(frozen=True)
class Weights:
    """Where a value is read: index (m, 3) [with ghosts], weight (m,) adding up to 1, offset (3,) from there to the
    point."""

    index: np.ndarray
    weight: np.ndarray
    offset: np.ndarray

    @cached_property
    def at(self) -> tuple[np.ndarray, ...]:
        """index along each direction."""
        return tuple(np.ascontiguousarray(self.index.T))

    def of(self, a: np.ndarray) -> float:
        """The interpolated value."""
        return float(self.weight @ a[self.at])


@dataclass(frozen=True)
class Probe:
    """One gauge: cells for p and F, faces for u, v, w (None where the direction is absent); columns (m, 4) as in
    columns.py with their floors (m,) [length] and open areas (m,) [-]: A above."""

    number: int
    point: np.ndarray
    cells: Weights
    faces: tuple[Weights | None, ...]
    columns: np.ndarray
    floors: np.ndarray
    areas: np.ndarray


class Standing:
    """The Probe of a point among bodies that may move: found again where its surroundings have changed. still: nothing
    moves."""

    def __init__(self, number: int, point: np.ndarray, block: Block, openings: Open, *, still: bool = False) -> None:
        self.still = still
        self.number, self.point, self.block, self.openings = number, point, block, openings
        near = [(min(at), max(at) + 1) for at in zip(*_own_cells(np.asarray(point, float), block), strict=True)]
        self.column = tuple(slice(a + G, b + G) for a, b in near[:2])  # the height is read from all of it
        around = [slice(a + G - 2, b + G + 1) for a, b in near]  # 3 x 3 x 3 cells, and the lower faces of these
        self.boxes = (tuple(around), (*self.column, slice(None)))
        self.probe, self.seen = find_probe(number, point, block, openings), self._surroundings()

    def now(self) -> Probe:
        """The Probe as it is at present."""
        if self.still:
            return self.probe
        seen = self._surroundings()
        if any(not np.array_equal(a, b) for a, b in zip(seen, self.seen, strict=True)) or self._is_far():
            self.probe, self.seen = find_probe(self.number, self.point, self.block, self.openings), seen
        return self.probe

    def _surroundings(self) -> list[np.ndarray]:
        return [a[box].copy() for a in self.openings if a is not None for box in self.boxes]

    def _is_far(self) -> bool:
        """Whether all cells around are closed, so that the probe reads one that it does not watch."""
        V = self.openings.V
        return V is not None and not V[self.boxes[0]].any()


def find_probe(number: int, point: np.ndarray, block: Block, openings: Open) -> Probe:
    """The Probe of a point in (or beside) the domain. To be found again when the open fractions change."""
    point = np.asarray(point, dtype=float)
    centres = [0.5 * (x[1:] + x[:-1]) for x in block.planes]
    own = _own_cells(point, block)
    around = [_between(c, x) for c, x in zip(centres, point, strict=True)]
    reached = _reached(around, own, openings)
    if reached:
        cells = _weights(reached, around, centres, point)
    else:
        reached = _nearest_open(point, block, openings.V)
        cells = _mean_of(reached, centres, point)
        own = own if openings.V[_column(own[0])].any() else reached
    faces = tuple(
        _faces(d, point, block, centres, openings, reached) if n > 1 else None for d, n in enumerate(block.shape)
    )
    return Probe(number, point, cells, faces, *_columns(own, block, openings))


def read_probe(probe: Probe, flow: Flow, openings: Open, dz: np.ndarray, rho: float, gravity: np.ndarray) -> dict:
    """p relative to the void, u, v, w, F, height at the probe; absent velocities are left out.

    dz: grid.dz.
    """
    cells = probe.cells
    F = np.ones(len(cells.weight)) if flow.F is None else flow.F[cells.at]
    liquid = float(cells.weight @ (F >= 0.5))
    wet = bool((F > DUST).any())
    out = {"p": cells.of(flow.p) + liquid * rho * float(cells.offset @ gravity)}
    for name, a, weights in zip("uvw", flow.velocity, probe.faces, strict=True):
        if a is not None and weights is not None:
            out[name] = weights.of(a) if wet else 0.0
    out["F"] = float(cells.weight @ F)
    depth = np.array([_depth(column, flow.F, openings.V, dz) for column in probe.columns])
    out["height"] = float(np.mean(probe.floors + depth / probe.areas))
    return out


def _depth(column: np.ndarray, F: np.ndarray | None, V: np.ndarray | None, dz: np.ndarray) -> float:
    i, j, k0, k1 = column
    part = dz[k0:k1].copy()
    for a in (F, V):
        if a is not None:
            part *= a[i, j, k0:k1]
    return float(part.sum())


# ---- cells around a point; indices without ghosts until Weights


def _own_cells(point: np.ndarray, block: Block) -> list[tuple]:
    """The cells that hold the point: several where it lies on planes between them."""
    along = []
    for x, planes in zip(point, block.planes, strict=True):
        n = len(planes) - 1
        k = int(np.clip(np.searchsorted(planes, x, side="right") - 1, 0, n - 1))
        near = SAME * (planes[k + 1] - planes[k])
        both = {k}
        if abs(x - planes[k]) <= near:
            both.add(max(k - 1, 0))
        if abs(x - planes[k + 1]) <= near:
            both.add(min(k + 1, n - 1))
        along.append(sorted(both))
    return list(itertools.product(*along))


def _between(places: np.ndarray, x: float) -> list[tuple[int, float]]:
    """(place, weight) of the one or two ascending places that x lies between."""
    if len(places) == 1 or x <= places[0]:
        return [(0, 1.0)]
    if x >= places[-1]:
        return [(len(places) - 1, 1.0)]
    k = int(np.searchsorted(places, x, side="right")) - 1
    share = (x - places[k]) / (places[k + 1] - places[k])
    return [(k, 1.0 - share), (k + 1, share)]


def _reached(around: list, own: list[tuple], openings: Open) -> list[tuple]:
    """Of the cells around a point the open ones, and if any of its own is open only those that an open way joins."""
    every = list(itertools.product(*([k for k, _ in along] for along in around)))
    if openings.V is None:
        return every
    is_open = {cell: openings.V[_ghosted(cell)] > 0.0 for cell in {*every, *own}}
    start = [cell for cell in own if is_open[cell]]
    if not start:
        return [cell for cell in every if is_open[cell]]
    joined, new = set(start), list(start)
    while new:
        cell = new.pop()
        for other in is_open:
            if other not in joined and is_open[other] and _open_face(cell, other, openings):
                joined.add(other)
                new.append(other)
    return [cell for cell in every if cell in joined]


def _open_face(a: tuple, b: tuple, openings: Open) -> bool:
    """Whether two cells are neighbours with an open face between them."""
    steps = [abs(p - q) for p, q in zip(a, b, strict=True)]
    if sum(steps) != 1:
        return False
    return openings[1 + steps.index(1)][_ghosted(min(a, b))] > 0.0


def _column(cell: tuple) -> tuple:
    return cell[0] + G, cell[1] + G, slice(G, -G)


def _ghosted(cell: tuple) -> tuple:
    return tuple(k + G for k in cell)


def _weights(cells: list[tuple], around: list, places: list[np.ndarray], point: np.ndarray) -> Weights:
    """Linear weights of these cells among those around the point; equal ones where all of them are 0."""
    of = [dict(along) for along in around]
    weight = np.array([np.prod([of[d].get(k, 0.0) for d, k in enumerate(cell)]) for cell in cells])
    if not weight.sum() > 0.0:
        return _mean_of(cells, places, point)
    return _made(cells, weight, places, point)


def _mean_of(cells: list[tuple], places: list[np.ndarray], point: np.ndarray) -> Weights:
    return _made(cells, np.ones(len(cells)), places, point)


def _made(cells: list[tuple], weight: np.ndarray, places: list[np.ndarray], point: np.ndarray) -> Weights:
    weight = weight / weight.sum()
    read_at = np.array([[places[d][k] for d, k in enumerate(cell)] for cell in cells])
    offset = point - weight @ read_at
    offset[np.abs(offset) <= ROUNDING * np.abs(read_at).max(axis=0)] = 0.0
    return Weights(np.array(cells, dtype=np.intp).reshape(-1, 3) + G, weight, offset)


def _nearest_open(point: np.ndarray, block: Block, V: np.ndarray) -> list[tuple]:
    """The open cells whose boxes are nearest to the point (0 away: it lies on them); all that are equally near."""
    away = np.zeros(block.shape)
    for d, (x, planes) in enumerate(zip(point, block.planes, strict=True)):
        outside = np.maximum(np.maximum(planes[:-1] - x, x - planes[1:]), 0.0)
        away += (outside**2).reshape([-1 if e == d else 1 for e in range(3)])
    away = np.where(V[G:-G, G:-G, G:-G] > 0.0, np.sqrt(away), np.inf)
    size = max(float(np.diff(planes).min()) for planes in block.planes)
    return [tuple(int(k) for k in cell) for cell in np.argwhere(away <= away.min() + SAME * size)]


# ---- faces


def _faces(d: int, point: np.ndarray, block: Block, centres: list, openings: Open, reached: list[tuple]) -> Weights:
    """Weights of the velocity along d: planes of the mesh along d (index k of the face above cell k), else centres."""
    places = [block.planes[e] if e == d else centres[e] for e in range(3)]
    around = [_between(p, x) for p, x in zip(places, point, strict=True)]
    of = [dict(along) for along in around]
    beside = {
        (*cell[:d], cell[d] + up, *cell[d + 1 :]) for cell in reached for up in (0, 1)
    }  # faces of the cells that are read: others lie in solids or beyond a wall
    every = [face for face in itertools.product(*(of[e] for e in range(3))) if face in beside] or sorted(beside)
    made = _weights(every, around, places, point)
    index = made.index.copy()
    index[:, d] -= 1
    weight = made.weight
    if openings[1 + d] is not None:
        weight = np.where(openings[1 + d][tuple(index.T)] > 0.0, weight, 0.0)  # a wall: nothing crosses it
    return Weights(index, weight, made.offset)


# ---- columns


def _columns(own: list[tuple], block: Block, openings: Open) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Columns of open, joined cells at the probe's level, one for each (i, j) of its own cells; floors, open areas."""
    levels: dict[tuple[int, int], list[int]] = {}
    for i, j, k in own:
        levels.setdefault((i, j), []).append(k)
    columns, floors, areas = [], [], []
    for (i, j), ks in sorted(levels.items()):
        k0, k1 = _run(i, j, ks, block, openings)
        floor, area = block.z[k0], 1.0
        if openings.V is not None and k1 > k0:
            V = openings.V[i + G, j + G, k0 + G : k1 + G]
            area = float(V.max())
            below = slice(0, int(np.argmax(V)))
            floor += float(((1.0 - V / area) * np.diff(block.z[k0 : k1 + 1]))[below].sum())
        columns.append((i + G, j + G, k0 + G, k1 + G))
        floors.append(floor)
        areas.append(area)
    return np.array(columns, dtype=np.intp), np.array(floors), np.array(areas)


def _run(i: int, j: int, ks: list[int], block: Block, openings: Open) -> tuple[int, int]:
    """First and one past the last of the cells that are open and joined, at the levels ks or nearest to them."""
    n = block.shape[2]
    if openings.V is None:
        return 0, n
    is_open = openings.V[i + G, j + G, G : n + G] > 0.0
    if not is_open.any():
        return n, n
    levels = np.flatnonzero(is_open)
    gaps = np.abs(levels[:, None] - np.array(ks)[None, :]).min(axis=1)
    k0 = k1 = int(levels[len(levels) - 1 - int(np.argmin(gaps[::-1]))])  # of two the upper: it holds the surface
    while k0 > 0 and is_open[k0 - 1] and openings.Az[i + G, j + G, k0 - 1 + G] > 0.0:
        k0 -= 1
    while k1 < n - 1 and is_open[k1 + 1] and openings.Az[i + G, j + G, k1 + G] > 0.0:
        k1 += 1
    return k0, k1 + 1
