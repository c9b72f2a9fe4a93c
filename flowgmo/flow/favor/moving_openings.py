"""Open fractions among bodies that move: now, at the end of the step to come, and their mean over it.

    open      V, A at the poses last settled
    mean      A of the step to come, 1/2 (A now + A then); V, an array of its own, is whoever steps the liquid's
    S_b       share of a face that body b covers, likewise 1/2 (S_b now + S_b then)

    mean A + sum over b of S_b + the stationary solids' share = 1 on every face

The solver asks `sweep` for the poses that it expects, projects with `mean` and the shares, and calls `settle` when the
bodies are there; where they came to stand elsewhere, `sweep` again with keep_mean before that. What a body covers
(body_cover.py) is computed for its new pose only; what several leave open together (covered_cells.py) for the cells
near their surfaces. No pass is made over the mesh. Bodies are never snapped; the stationary solids are as
fractions.open_fractions left them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from flowgmo.flow.favor import covered_cells, put_openings
from flowgmo.flow.favor.body_cover import BodyCover, CoverMesh, cover_bodies, keep_volume, touches_side
from flowgmo.flow.favor.body_sheets import Body
from flowgmo.flow.favor.fractions import Solids
from flowgmo.flow.favor.near_surface import Pose, Shape
from flowgmo.flow.favor.overlaps import Posed, cut_overlaps
from flowgmo.flow.favor.shares import Shares
from flowgmo.flow.fields import Open, zeros
from flowgmo.flow.team import Team
from flowgmo.mesh import Block


class Swept(NamedTuple):
    """What bodies touch now or then.

    cells (n, 3) int32 [with ghosts] in C order: real cells that a body touches now or then and that have an open part
    now or then (so not those that stay inside). V0, V1 (n,): open shares of their volume now and then. shares: one for
    each body, of the mean; covered: the share of the volume of the same cells that it covers now; left: what it covers
    less of them then. volume (bodies, 2) [length3]: each body's own volume on the mesh, now and then.
    """

    cells: np.ndarray
    V0: np.ndarray
    V1: np.ndarray
    shares: tuple[Shares, ...]
    covered: tuple[np.ndarray, ...]
    left: tuple[np.ndarray, ...]
    volume: np.ndarray


class _Rows(NamedTuple):
    """What one body covers by itself of cells: their indices at (r,) ascending, shares (r, 7)."""

    at: np.ndarray
    shares: np.ndarray


class _Part(NamedTuple):
    """Of cells (n, 7), at one time: what the stationary solids leave, what all bodies cover, what is open."""

    still: np.ndarray
    total: np.ndarray
    opened: np.ndarray


class _Pending(NamedTuple):
    """The newest poses: their covers, all cells that change or may, and these open now and then (n, 7)."""

    poses: list[Pose]
    covers: list[BodyCover]
    cells: np.ndarray
    now: np.ndarray
    then: np.ndarray
    swept: Swept


class MovingOpenings:
    """Open fractions of a block with stationary solids and bodies that move.

    open, mean: dense arrays with ghosts. Ghosts are mirror images near the bodies, elsewhere the stationary solids'.
    on_write: is told of the cells (n, 3) of which, or of whose faces, `mean` is written.
    """

    def __init__(
        self,
        block: Block,
        stationary: Solids,
        stationary_shapes: Sequence[Shape],
        shapes: Sequence[Shape],
        poses: Sequence[Pose],
    ) -> None:
        """shapes: the bodies, given in their place at t = 0; poses: where they are now."""
        self._block, self._still, self._still_shapes = block, stationary.open, list(stationary_shapes)
        self._shapes, self._bodies = list(shapes), [Body(shape) for shape in shapes]
        self._mesh = CoverMesh(block)
        still = [zeros(block) + 1.0 if a is None else a.copy() for a in stationary.open]
        self.open = Open(*still)
        self.mean = Open(*(a.copy() for a in still))
        nowhere = BodyCover(np.zeros(0, np.int64), np.zeros((0, 7)), np.zeros((0, 2), np.int64), 0.0)
        self._poses: list[Pose | None] = [None] * len(self._shapes)
        self._covers = [nowhere] * len(self._shapes)
        self._pending: _Pending | None = None
        self._left: _Pending | None = None  # where bodies were expected but did not come
        self._targets: list[float | None] = [None] * len(self._shapes)
        self._changed: list[np.ndarray] = []
        self.on_write: Callable[[np.ndarray], None] = ignore
        self.sweep(poses)
        self.settle()
        self._targets = [c.volume if _inside(c, self._mesh) else None for c in self._covers]

    def share(self, team: Team) -> None:
        """What bodies cover is found by a team from now on; the same bits for any number of threads."""
        self._mesh.team = team

    @property
    def covers(self) -> list[BodyCover]:
        """What each body covers in the pose last settled."""
        return self._covers

    @property
    def still(self) -> Open:
        """What the stationary solids leave open."""
        return self._still

    def faces_towards(self, b: int, R: np.ndarray, directions: np.ndarray) -> tuple[bool, ...]:
        """As Body.faces_towards, of body b."""
        return self._bodies[b].faces_towards(R, directions)

    def take_changed(self) -> np.ndarray:
        """Numbers (n,) [with ghosts] of cells of which, or of whose lower faces, `mean` was written since last asked,
        ascending; ghosts are their images."""
        shape = np.array(self._mesh.shape)
        lists = [np.zeros(0, np.int64)]
        for cells in {id(a): a for a in self._changed}.values():
            lists.append(np.ravel_multi_index(tuple(cells.T.astype(np.int64)), shape))
        self._changed = []
        return covered_cells.united(lists)

    def sweep(self, poses: Sequence[Pose], *, middle: Sequence[Pose] | None = None, keep_mean: bool = False) -> Swept:
        """What the bodies touch on their way to new poses; sets `mean`, and leaves `open` as it is.

        middle: the poses halfway; the mean is then 1/6, 4/6, 1/6 of now, the middle, then (Simpson), without it half of
        now and half of then. A body that moves with the stream lets it pass as it is only as far as the mean over time
        is exact. May be called again with other poses: the mean is then that of now and the newest, or, keep_mean,
        stays, and no shares are found of bodies that move.
        """
        pending = self._pending
        if pending is not None and all(_same(a, b) for a, b in zip(poses, pending.poses, strict=True)):
            return pending.swept
        covers, halfway = self._cover(poses, middle)
        if pending is not None and not keep_mean:
            self._put(self.mean, pending.cells, pending.now)
        cells, rows0, rows1, rows_m = self._touched(covers, halfway)
        if keep_mean:
            self._left = self._left or pending
            kept = np.empty((len(cells), 7))
            covered_cells.read_open(cells, *self.mean, kept)
        still, now = np.empty((len(cells), 7)), np.empty((len(cells), 7))
        covered_cells.read_open(cells, *self._still, still)
        covered_cells.read_open(cells, *self.open, now)
        total0, _ = _sum(rows0, len(cells))
        total1, most = _sum(rows1, len(cells))
        then = self._left_open(cells, still, rows1, total1, most, poses)
        mean, wanted = np.empty((len(cells), 7)), np.empty(len(cells), bool)
        covered_cells.mean_open(now, then, mean, wanted)
        parts = [_Part(still, total0, now), _Part(still, total1, then)]
        times = [rows0, rows1]
        if rows_m is not None:
            total_m, most = _sum(rows_m, len(cells))
            between = self._left_open(cells, still, rows_m, total_m, most, middle)
            mean = (2.0 * mean + 4.0 * between) / 6.0
            wanted |= (mean[:, :6] > 0.0).any(axis=1)
            parts.append(_Part(still, total_m, between))
            times.append(rows_m)
        self._put(self.mean, cells, kept if keep_mean else mean)
        moved = any(a is not b for a, b in zip(self._covers, covers, strict=True))
        of_bodies = () if keep_mean and moved else zip(*times, strict=True)  # known, of the mean that is kept
        shares = tuple(_mean_shares(cells, wanted, of_body, parts) for of_body in of_bodies)
        volume = np.array([[a.volume, b.volume] for a, b in zip(self._covers, covers, strict=True)]).reshape(-1, 2)
        shares, covered, left = (tuple(s[k] for s in shares) for k in (0, 1, 2))
        swept = Swept(cells[wanted], now[wanted, 6], then[wanted, 6], shares, covered, left, volume)
        self._pending = _Pending([_copy(pose) for pose in poses], covers, cells, now, then, swept)
        return swept

    def settle(self) -> None:
        """The newest poses become now: `open` is what they leave, and `mean` the same. Again: nothing."""
        pending = self._pending
        if pending is None:
            return
        if self._left is not None:
            self._settle(self.mean, self._left.cells, self._left.now)
        for fields in (self.open, self.mean):
            self._settle(fields, pending.cells, pending.then)
        moved = any(a is not b for a, b in zip(self._covers, pending.covers, strict=True))
        self._poses, self._covers = pending.poses, pending.covers
        self._pending = None if moved else pending  # what was found of bodies that all rest stays true
        self._left = None

    def all_inside(self) -> bool:
        """Whether no body touches a side of the domain, now or at the newest poses."""
        covers = [*self._covers, *(self._pending.covers if self._pending is not None else ())]
        return all(not len(c.numbers) or _inside(c, self._mesh) for c in covers)

    def withdraw(self) -> None:
        """As if nothing had been swept since the last settle."""
        for pending in (self._pending, self._left):
            if pending is not None:
                self._settle(self.mean, pending.cells, pending.now)
        self._pending = self._left = None

    def _settle(self, fields: Open, cells: np.ndarray, opened: np.ndarray) -> None:
        """Volumes and faces of cells, and their images beyond the sides."""
        if fields is self.mean:
            self.on_write(cells)
        put_openings.put_volumes(cells, opened, fields.V)
        put_openings.mirror_cells(cells, fields.V, -1)
        self._put(fields, cells, opened)

    def _cover(
        self, poses: Sequence[Pose], middle: Sequence[Pose] | None
    ) -> tuple[list[BodyCover], list[BodyCover] | None]:
        """What the bodies cover in these poses and in the middle ones, known already where they are there or were swept
        there."""
        every = [*enumerate(poses), *enumerate(middle or ())]
        out = [self._known(b, pose) for b, pose in every]
        missing = [n for n, cover in enumerate(out) if cover is None]
        found = cover_bodies(self._mesh, [self._bodies[b].moved(pose) for b, pose in (every[n] for n in missing)])
        for n, cover in zip(missing, found, strict=True):
            target = self._targets[every[n][0]]
            keep = target is None or cover.volume == target or not _inside(cover, self._mesh)
            out[n] = cover if keep else keep_volume(self._mesh, cover, target)
        return out[: len(poses)], None if middle is None else out[len(poses) :]

    def _known(self, b: int, pose: Pose) -> BodyCover | None:
        if _same(pose, self._poses[b]):
            return self._covers[b]
        if self._pending is not None and _same(pose, self._pending.poses[b]):
            return self._pending.covers[b]
        return None

    def _touched(
        self, covers: list[BodyCover], halfway: list[BodyCover] | None
    ) -> tuple[np.ndarray, list[_Rows], list[_Rows], list[_Rows] | None]:
        """Cells (n, 3) that bodies touch now, halfway or then, but for those inside one body all the time; its rows."""
        lists = [np.zeros(0, np.int64), *(c.numbers for c in halfway or ())]
        for a, b in zip(self._covers, covers, strict=True):
            lists += [a.numbers] if a is b else [a.numbers, b.numbers, covered_cells.runs_apart(a.runs, b.runs)]
        union = covered_cells.united(lists)
        cells = np.empty((len(union), 3), np.int32)
        covered_cells.cells_of(union, self._mesh.shape, cells)
        now = [_rows(union, a) for a in self._covers]
        then = [r if a is b else _rows(union, b) for a, b, r in zip(self._covers, covers, now, strict=True)]
        between = (
            None
            if halfway is None
            else [r if a is b else _rows(union, b) for a, b, r in zip(self._covers, halfway, now, strict=True)]
        )
        return cells, now, then, between

    def _left_open(
        self,
        cells: np.ndarray,
        still: np.ndarray,
        rows: list[_Rows],
        total: np.ndarray,
        most: np.ndarray,
        poses: Sequence[Pose],
    ) -> np.ndarray:
        """Open shares (n, 7) that bodies in their poses and stationary solids leave; `mean` is scratch."""
        opened, overlapping = np.empty((len(cells), 7)), np.empty(len(cells), np.uint8)
        covered_cells.leave_open(still, total, most, opened, overlapping)
        some = np.zeros(0, np.int64)
        if overlapping.any():
            shapes = [Posed(shape, pose) for shape, pose in zip(self._shapes, poses, strict=True)]
            shared = sum(np.bincount(r.at, minlength=len(cells)) for r in rows) + (still < 1.0).any(axis=1) > 1
            of = still, total, shared, opened, overlapping.astype(bool)
            some = cut_overlaps(self._block, shapes + self._still_shapes, cells, *of)
        covered_cells.keep_volume(still, total, opened)
        faces = self.mean[1:]
        put_openings.put_faces(cells, opened, *faces)
        put_openings.put_faces(cells[some], opened[some], *faces)
        put_openings.close_full(cells, opened, *faces)
        covered_cells.read_open(cells, self.open.V, *faces, found := np.empty_like(opened))
        found[:, 6] = opened[:, 6]
        return found

    def _put(self, fields: Open, cells: np.ndarray, opened: np.ndarray) -> None:
        """Faces of cells, and their images beyond the sides."""
        if fields is self.mean:
            self._changed.append(cells)
            self.on_write(cells)
        put_openings.put_faces(cells, opened, *fields[1:])
        for axis, a in enumerate(fields[1:]):
            put_openings.mirror_cells(cells, a, axis)


def ignore(cells: np.ndarray) -> None:
    """Nobody wants to know."""


def _same(a: Pose | None, b: Pose | None) -> bool:
    """Whether two poses are the same, bit by bit."""
    if a is None or b is None:
        return a is b
    return a.set_back == b.set_back and np.array_equal(a.R, b.R) and np.array_equal(a.t, b.t)


def _copy(pose: Pose) -> Pose:
    """A pose of its own: the caller's may change in place."""
    return Pose(np.array(pose.R, float), np.array(pose.t, float), *pose[2:])


def _inside(cover: BodyCover, mesh: CoverMesh) -> bool:
    """Whether nothing of a body touches a side of the domain."""
    return bool(len(cover.numbers)) and not touches_side(cover.numbers, cover.shares, np.array(mesh.shape))


def _mean_shares(
    cells: np.ndarray, wanted: np.ndarray, times: tuple[_Rows, ...], parts: list[_Part]
) -> tuple[Shares, np.ndarray, np.ndarray]:
    """Mean shares of one body in the wanted cells (n,), what it covers of their volumes (m,) now, how much less then.
    times, parts: now, then, and the middle where it is known."""
    weights = (0.5, 0.5) if len(times) == 2 else (1.0 / 6.0, 1.0 / 6.0, 4.0 / 6.0)
    at = covered_cells.united([rows.at for rows in times])
    faces, covered = np.zeros((len(at), 6)), np.zeros((2, len(at)))
    for n, (rows, part, weight) in enumerate(zip(times, parts, weights, strict=True)):
        covered_cells.add_shares(*rows, *part, weight, at, faces, covered[n] if n < 2 else None)
    some = wanted[at]
    return Shares(cells[at[some]], faces[some]), covered[0, some], covered[0, some] - covered[1, some]


def _rows(union: np.ndarray, cover: BodyCover) -> _Rows:
    """What a body covers of the union's cells (n,)."""
    ends = [x for x in (cover.numbers, cover.runs[:, 0]) if len(x)]
    tops = [x + 1 for x in (cover.numbers[-1:], cover.runs[-1:, 1] - 1) if len(x)]
    if not ends:
        return _Rows(np.zeros(0, np.int64), np.zeros((0, 7)))
    a, b = np.searchsorted(union, [min(x[0] for x in ends), max(int(x[0]) for x in tops)])
    at, shares = np.empty(b - a, np.int64), np.empty((b - a, 7))
    n = covered_cells.rows_of_body(union[a:b], cover.numbers, cover.shares, cover.runs, at, shares)
    return _Rows(at[:n] + a, shares[:n])


def _sum(rows: list[_Rows], count: int) -> tuple[np.ndarray, np.ndarray]:
    """Sum and largest (count, 7) of what the bodies cover."""
    total, most = np.zeros((count, 7)), np.zeros((count, 7))
    for r in rows:
        covered_cells.add_rows(*r, total, most)
    return total, most
