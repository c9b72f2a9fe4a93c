"""Where one body is on the mesh in one pose: cells near its surface with what it covers of them, and cells inside.

Cells are numbered as arrays with ghosts are, C order, so that cells inside are runs of numbers.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from flowgmo.flow.favor.body_cut import NODES
from flowgmo.flow.favor.body_fold import SOLID, WITHIN
from flowgmo.flow.favor.body_paint import count_painted, paint_body
from flowgmo.flow.favor.body_sheets import Moved
from flowgmo.flow.favor.body_values import BY_CHORDS, FAR_BEYOND, FAR_WITHIN, IN_PARTS, cut_body, cut_of_balls
from flowgmo.flow.favor.convex_cut import cut_convex, paint_convex
from flowgmo.flow.favor.near_surface import ROUNDING, TOUCHING, near_cells, node_planes, reach
from flowgmo.flow.fields import G
from flowgmo.flow.team import Team
from flowgmo.kernel import free_kernel, kernel
from flowgmo.mesh import Block

SHARED = 200  # cells that are one piece of work: a quarter of a millisecond
WORTHWHILE = 2  # pieces for each thread: thirty times what waking one takes
PIECES = 2  # halves of a cell in each direction, for curved sheets


class BodyCover(NamedTuple):
    """numbers (n,) int64 of cells near the surface, ascending; shares (n, 7) of their faces, lower x, upper x, .., and
    volume that the body covers; runs (m, 2) int64 of cells wholly inside, first and one past the last, ascending, that
    are not among the others. volume [length3] of the body on the mesh. ball (7,): centre, 0 (3), radius [length] of a
    body that is a ball and is cut exactly; planes (m, 4), n (3) and h: of one that is where all of them are negative;
    None of others. small: a ball that may be within a cell."""

    numbers: np.ndarray
    shares: np.ndarray
    runs: np.ndarray
    volume: float
    ball: np.ndarray | None = None
    planes: np.ndarray | None = None
    small: bool = False


class CoverMesh:
    """The mesh of a block for covers: planes of half cells, and scratch for the numbers of nodes."""

    def __init__(self, block: Block) -> None:
        self.block = block
        self.shape = tuple(n + 2 * G for n in block.shape)
        self.halves = node_planes(block.planes, PIECES)
        self.least = TOUCHING * min(np.diff(x).min() for x in block.planes)
        self.widths = tuple(np.diff(x) for x in block.planes)
        self._index = np.zeros(0, np.int32)
        self.team: Team | None = None  # that shares the cutting

    def index(self, sizes: np.ndarray) -> np.ndarray:
        """Zeros of these sizes (3,), int32; whoever writes in it makes it zero again."""
        need = int(np.prod(sizes))
        if len(self._index) < need:
            self._index = np.zeros(need, np.int32)
        return self._index[:need].reshape(sizes)


def cover_body(mesh: CoverMesh, body: Moved) -> BodyCover:
    """What a body in its pose covers of the mesh: exact where planes bound it, never snapped."""
    return cover_bodies(mesh, [body])[0]


def cover_bodies(mesh: CoverMesh, bodies: Sequence[Moved]) -> list[BodyCover]:
    """What each of the bodies covers by itself. The cells of all are shared by the threads."""
    near = _near_bodies(mesh, bodies)
    known = [_curved(mesh, body, cells) if len(cells) else None for body, (cells, _) in zip(bodies, near, strict=True)]
    convex = [_convex(body) for body in bodies]
    covered = [np.empty((len(cells), 7)) for cells, _ in near]
    balls = [cut_of_balls(body.rounds, _widths(mesh, body)) if len(body.rounds) else BY_CHORDS for body in bodies]
    jobs = [(n, k) for n, (cells, _) in enumerate(near) for k in range(0, len(cells), SHARED)]

    def cut(jobs: list, first: int, last: int) -> None:
        for n, k in jobs[first:last]:
            some, (rows, at, values) = slice(k, k + SHARED), known[n]
            if convex[n] is not None:
                cut_convex(near[n][0][some], *mesh.halves, convex[n], mesh.least, covered[n][some])
                continue
            body, of_cells = bodies[n], (np.ascontiguousarray(rows[:, some]), at, values)
            of_body = body.planes, body.rounds, balls[n], body.side, body.roles, mesh.least
            cut_body(near[n][0][some], *mesh.halves, *of_body, *of_cells, covered[n][some])

    if mesh.team is None:
        cut(jobs, 0, len(jobs))
    else:
        mesh.team.run_rows(cut, jobs, WORTHWHILE)
    found = [_collect(mesh, cells, of_body, runs) for (cells, runs), of_body in zip(near, covered, strict=True)]
    return [
        BodyCover(numbers, shares, runs, volume, _ball(body, how), planes, how == IN_PARTS)
        for (numbers, shares, volume), (_, runs), body, how, planes in zip(
            found, near, bodies, balls, convex, strict=True
        )
    ]


def _ball(body: Moved, how: int) -> np.ndarray | None:
    """The round sheet (7,) of a body that is nothing else; how: of cut_of_balls."""
    alone = len(body.rounds) == 1 and not len(body.planes) and not body.curved and body.side.tolist() == [[WITHIN]]
    return body.rounds[0] if how != BY_CHORDS and alone else None


def _convex(body: Moved) -> np.ndarray | None:
    """The planes (m, 4) of a body that is one convex piece of them."""
    alone = len(body.planes) > 0 and not len(body.rounds) and not body.curved
    return body.planes if alone and (body.side == WITHIN).all() and body.roles.tolist() == [SOLID] else None


def _widths(mesh: CoverMesh, body: Moved) -> tuple[np.ndarray, ...]:
    """Widths [length] of cells near a body along each direction."""
    first, past = reach(mesh.block.planes, body.bounds)
    return tuple(w[a : max(b, a + 1)] for w, a, b in zip(mesh.widths, first, past, strict=True))


def keep_volume(mesh: CoverMesh, cover: BodyCover, target: float) -> BodyCover:
    """The cover with the volume that the body should have [length3].

    Curved surfaces cut by chords have a volume that wavers by 1e-5 to 1e-4 of itself as the body moves through the
    mesh; a closed tank that is full has no room for that. The cells it cuts take the difference, each in proportion to
    the smaller of what is covered and what is open.
    """
    weights = np.minimum(cover.shares[:, 6], 1.0 - cover.shares[:, 6])
    sizes = np.empty(len(weights))
    sizes_of(cover.numbers, np.array(mesh.shape), *mesh.widths, sizes)
    room = float((weights * sizes).sum())
    if room <= 0.0:
        return cover
    shares = cover.shares.copy()
    shares[:, 6] += weights * np.clip((target - cover.volume) / room, -1.0, 1.0)
    return cover._replace(shares=shares, volume=target)


@kernel
def sizes_of(numbers, shape, dx, dy, dz, sizes):
    """Volumes (n,) [length3] of cells by their numbers."""
    for c in range(len(numbers)):
        k = numbers[c] % shape[2] - G
        j = numbers[c] // shape[2] % shape[1] - G
        i = numbers[c] // (shape[1] * shape[2]) - G
        sizes[c] = dx[i] * dy[j] * dz[k]


@kernel
def touches_side(numbers, shares, shape):
    """Whether a cell covers anything of a face on a side of the domain; a direction of one cell has no sides."""
    for c in range(len(numbers)):
        k = numbers[c] % shape[2]
        j = numbers[c] // shape[2] % shape[1]
        i = numbers[c] // (shape[1] * shape[2])
        for d in range(3):
            at = i if d == 0 else (j if d == 1 else k)
            if shape[d] > 1 + 2 * G and (
                (at == G and shares[c, 2 * d] > 0.0) or (at == shape[d] - G - 1 and shares[c, 2 * d + 1] > 0.0)
            ):
                return True
    return False


def _near_bodies(mesh: CoverMesh, bodies: Sequence[Moved]) -> list[tuple[np.ndarray, np.ndarray]]:
    """_near or _near_closed of each body; the latter are shared by the threads."""
    out = [_near(mesh, body) if body.curved else None for body in bodies]
    closed = [n for n, body in enumerate(bodies) if not body.curved]

    def find(closed: list, first: int, last: int) -> None:
        for n in closed[first:last]:
            out[n] = _near_closed(mesh, bodies[n])

    if mesh.team is None:
        find(closed, 0, len(closed))
    else:
        mesh.team.run_rows(find, closed, 1)
    return out


def _near_closed(mesh: CoverMesh, body: Moved) -> tuple[np.ndarray, np.ndarray]:
    """As _near, of a body whose sheets are all known by their numbers."""
    low, past = reach(mesh.block.planes, body.bounds)
    if (low >= past).any():
        return np.zeros((0, 3), np.int32), np.zeros((0, 2), np.int64)
    index, counts = np.zeros(past - low, np.int32), np.empty(2, np.int64)  # of its own: threads paint side by side
    box = *mesh.block.planes, low, past, index, counts
    if (planes := _convex(body)) is not None:
        paint_convex(planes, *box)
    else:
        paint_body(body.planes, body.rounds, body.side, body.roles, *box)
    return _read(mesh, low, index, counts)


def _near(mesh: CoverMesh, body: Moved) -> tuple[np.ndarray, np.ndarray]:
    """Near cells (n, 3) in C order, and runs (m, 2) of the cells inside."""
    near = near_cells(body.distance, mesh.block.planes, body.bounds)
    if not len(near.cells) and not len(near.inside):
        return near.cells, np.zeros((0, 2), np.int64)
    low = np.concatenate([near.cells, near.inside[:, 0]]).min(axis=0)
    past = np.concatenate([near.cells + 1, near.inside[:, 1]]).max(axis=0)
    index, counts = mesh.index(past - low), np.empty(2, np.int64)
    paint(near.cells, near.inside, low, index, counts)
    return _read(mesh, low, index, counts)


def _read(mesh: CoverMesh, low: np.ndarray, index: np.ndarray, counts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    cells, runs = np.empty((counts[0], 3), np.int32), np.empty((counts[1], 2), np.int64)
    read_painted(low, mesh.shape, index, cells, runs)
    return cells, runs


@kernel
def paint(cells, boxes, low, index, counts):
    """Paint index: 1 in cells (n, 3), 2 in boxes of them (m, 2, 3); low (3,): the cell at index[0, 0, 0]."""
    for b in range(len(boxes)):
        for i in range(boxes[b, 0, 0] - low[0], boxes[b, 1, 0] - low[0]):
            for j in range(boxes[b, 0, 1] - low[1], boxes[b, 1, 1] - low[1]):
                for k in range(boxes[b, 0, 2] - low[2], boxes[b, 1, 2] - low[2]):
                    index[i, j, k] = 2
    for c in range(len(cells)):
        index[cells[c, 0] - low[0], cells[c, 1] - low[1], cells[c, 2] - low[2]] = 1
    count_painted(index, counts)


@free_kernel
def read_painted(low, shape, index, cells, runs):
    """The painted cells (n, 3) in C order, and the runs (m, 2) as numbers with ghosts; index is zero on return."""
    n = np.int64(0)
    m = np.int64(0)
    for i in range(index.shape[0]):
        for j in range(index.shape[1]):
            start = ((i + low[0] + G) * shape[1] + j + low[1] + G) * shape[2] + low[2] + G
            before = 0
            for k in range(index.shape[2]):
                here = index[i, j, k]
                index[i, j, k] = 0
                if here == 1:
                    cells[n, 0] = i + low[0]
                    cells[n, 1] = j + low[1]
                    cells[n, 2] = k + low[2]
                    n += 1
                if here == 2:
                    if before != 2:
                        runs[m, 0] = start + k
                        m += 1
                    runs[m - 1, 1] = start + k + 1
                before = here


@kernel
def number_nodes(cells, chosen, low, index, at, points):
    """Number the nodes of cells[chosen] (c, 3), each once; returns how many.

    low (3,): the node at index[0, 0, 0]; index: zeros, and zeros again on return; at (c, NODES) int32 becomes the
    number of each node of each chosen cell, points (m, 3) int32 where it lies among the planes of half cells.
    """
    count = np.int64(0)
    for n in range(len(chosen)):
        a = 2 * cells[chosen[n], 0] - low[0]
        b = 2 * cells[chosen[n], 1] - low[1]
        c = 2 * cells[chosen[n], 2] - low[2]
        for v in range(NODES):
            i = a + v // 9
            j = b + v // 3 % 3
            k = c + v % 3
            if index[i, j, k] == 0:
                points[count, 0] = i + low[0]
                points[count, 1] = j + low[1]
                points[count, 2] = k + low[2]
                count += 1
                index[i, j, k] = count
            at[n, v] = index[i, j, k] - 1
    for m in range(count):
        index[points[m, 0] - low[0], points[m, 1] - low[1], points[m, 2] - low[2]] = 0
    return count


def _curved(mesh: CoverMesh, body: Moved, cells: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """rows, at, known of cut_body."""
    rows = np.empty((len(body.curved), len(cells)), np.int32)
    if not body.curved:
        return rows, np.zeros((0, NODES), np.int32), np.zeros(0)
    low = PIECES * cells.min(axis=0)
    index = mesh.index(PIECES * cells.max(axis=0) + PIECES + 1 - low)
    ats, values = [np.zeros((0, NODES), np.int32)], [np.zeros(0)]
    nodes = total = 0
    alone = len(body.curved) == 1 and not len(body.planes) and not len(body.rounds)
    for q, distance in enumerate(body.curved):
        chosen = np.arange(len(cells)) if alone else _reached(mesh, distance, cells, rows[q])
        rows[q, chosen] = np.arange(total, total + len(chosen))
        at = np.empty((len(chosen), NODES), np.int32)
        points = np.empty((len(chosen) * NODES, 3), np.int32)
        count = number_nodes(cells, chosen, low, index, at, points)
        d = distance(np.column_stack([x[points[:count, k]] for k, x in enumerate(mesh.halves)]))
        ats.append(at + np.int32(nodes))
        values.append(d)
        nodes, total = nodes + count, total + len(chosen)
    return rows, np.concatenate(ats), np.concatenate(values)


def _reached(mesh: CoverMesh, distance: object, cells: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Indices of the cells that a sheet may cut; rows (c,) becomes FAR_WITHIN or FAR_BEYOND elsewhere."""
    low, high = (np.column_stack([x[cells[:, k] + e] for k, x in enumerate(mesh.block.planes)]) for e in (0, 1))
    d = distance(0.5 * (low + high))
    radius = 0.5 * ROUNDING * np.linalg.norm(high - low, axis=1)
    rows[:] = np.where(d > 0.0, FAR_BEYOND, FAR_WITHIN)
    return np.flatnonzero(np.abs(d) <= radius)


def _collect(
    mesh: CoverMesh, cells: np.ndarray, covered: np.ndarray, runs: np.ndarray
) -> tuple[np.ndarray, np.ndarray, float]:
    """Numbers and shares of the cells of which anything is covered, and the body's volume."""
    numbers = np.empty(len(cells), np.int64)
    shares = np.empty((len(cells), 7))
    found = np.zeros(2)
    collect_covered(cells, covered, mesh.shape, *mesh.widths, runs, numbers, shares, found)
    n = int(found[0])
    return numbers[:n], shares[:n], float(found[1])


@kernel
def collect_covered(cells, covered, shape, dx, dy, dz, runs, numbers, shares, found):
    """Fill numbers and shares; found: how many, and the volume of all with the runs."""
    n = np.int64(0)
    volume = 0.0
    for c in range(len(cells)):
        most = 0.0
        for part in range(7):
            most = max(most, covered[c, part])
        if most == 0.0:
            continue
        i = cells[c, 0]
        j = cells[c, 1]
        k = cells[c, 2]
        numbers[n] = ((i + G) * shape[1] + j + G) * shape[2] + k + G
        for part in range(7):
            shares[n, part] = covered[c, part]
        volume += covered[c, 6] * dx[i] * dy[j] * dz[k]
        n += 1
    for m in range(len(runs)):
        k = runs[m, 0] % shape[2] - G
        j = runs[m, 0] // shape[2] % shape[1] - G
        i = runs[m, 0] // (shape[1] * shape[2]) - G
        for q in range(runs[m, 1] - runs[m, 0]):
            volume += dx[i] * dy[j] * dz[k + q]
    found[0] = n
    found[1] = volume
