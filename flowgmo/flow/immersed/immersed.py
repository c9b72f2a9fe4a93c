"""Bodies that move, as the liquid sees them during one step.

    begin        open fractions for the step: A the mean of now and then, V the larger one; what becomes uncovered is
                 given a past (fresh.py), closed faces have the body's velocity
    source       what the bodies' motion pushes out of every cell: its open volume changes by V1 - V0
    (move the bodies)
    arrive       open volumes V1 at the poses that were reached
    settle       these poses are now

The liquid is carried with  d(V F)/dt + div(A u F) = 0  and the projection makes  div(A u) = - (V1 - V0) / dt,  so that
a full cell is full afterwards: V1 F1 = V0 - dt div(A u) = V1, exactly, whatever the mean of A is. The shares S of the
faces are only needed where a body's velocity is not known before the pressure (coupling.py): there they say how the
change of volume goes with it, and what is left, V1 - V0 at the expected velocity, is as exact as before.

What V1 - V0 asks of the cells differs from what a uniform stream gives that moves with the body, as far as the mean of
A over the step is not exact: the body then has a drag that is the mesh's. The mean is of three poses for this reason.
Faces that are hardly open are widened (narrow_faces.py).

A domain without void has no volume to keep: there the bodies push by their shares, and a stream that moves with them
stays uniform to round-off.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from flowgmo.flow.favor.covered_cells import cells_of, united
from flowgmo.flow.favor.moving_openings import MovingOpenings, ignore
from flowgmo.flow.favor.near_surface import Pose
from flowgmo.flow.fields import Flow, Grid
from flowgmo.flow.immersed.body_fluxes import BodyFluxes, body_fluxes, closed_sum
from flowgmo.flow.immersed.crossings import mend_crossings
from flowgmo.flow.immersed.fresh import mean_around
from flowgmo.flow.immersed.friction import Friction
from flowgmo.flow.immersed.moving_walls import spin_resistance, wall_faces
from flowgmo.flow.immersed.narrow_faces import JET, NARROW, NarrowFaces, reach_slits, still_going
from flowgmo.flow.immersed.short_cells import ShortCells
from flowgmo.flow.immersed.torn import Around, torn
from flowgmo.flow.immersed.volume_change import VolumeChange
from flowgmo.flow.immersed.waterline import Surface
from flowgmo.flow.pressure.face_flows import PUSH
from flowgmo.flow.team import Team
from flowgmo.kernel import kernel

if TYPE_CHECKING:
    from flowgmo.flow.momentum.momentum import Momentum

BARELY = 0.1  # of a cell: what a body that arrives elsewhere than expected may open; more is the liquid's own surface


class Driven(NamedTuple):
    """Whether prescribed bodies cover some of cells (n,), and their largest speeds [length/time] there (n,)."""

    any: np.ndarray
    speeds: np.ndarray


@kernel
def covered_faces(d, cells, shares, place, U, x, y, z, count, faces, speeds):
    """Fill in from `count` on: numbers of the faces along d of which a body covers something, and its velocity there;
    lower faces of all its cells first. Returns the count then.

    cells (m, 3), shares (m, 6), place (3,), U (6,) of the body; x, y, z: centres of cells.
    """
    ny, nz = len(y), len(z)
    e, f = (d + 1) % 3, (d + 2) % 3
    step = ny * nz if d == 0 else (nz if d == 1 else 1)
    for upper in range(2):
        for c in range(len(cells)):
            if shares[c, 2 * d + upper] > 0.0:
                i, j, k = np.int64(cells[c, 0]), np.int64(cells[c, 1]), np.int64(cells[c, 2])
                r = (x[i] - place[0], y[j] - place[1], z[k] - place[2])
                faces[count] = (i * ny + j) * nz + k - (1 - upper) * step
                speeds[count] = U[d] + U[3 + e] * r[f] - U[3 + f] * r[e]
                count += 1
    return count


class Immersed:
    """covers: open fractions; renew: called when these have changed, to sort faces and regions anew, with what can be
    done meanwhile; is_full: whether the equation, as it is now, knows of no void; on_fill: is told of cells (n, 3) of
    which F is written.

    After `begin`: cells (n, 3) that bodies touch, growth (n,) [length3] of their open volumes, change of these as the
    liquid's motion sees it, fluxes of each body.
    """

    def __init__(
        self,
        covers: MovingOpenings,
        grid: Grid,
        centres: list[np.ndarray],
        renew: Callable[[np.ndarray | None, Callable[[], None]], None],
        is_full: Callable[[], bool],
    ) -> None:
        self.covers, self.grid, self.centres, self.renew, self.is_full = covers, grid, centres, renew, is_full
        self.open = covers.mean
        self.weight = np.zeros(3)  # of the liquid, rho g
        self.gravity = np.zeros(3)
        self.rho = 1.0
        self.in_sight = 0.0  # [length/time] that liquid may come with anywhere
        self.swept = None
        self.cells = np.zeros((0, 3), np.int32)
        self.sorted = None  # numbers of the cells whose open fractions were other than `covers` has them: not yet any
        self.short: ShortCells | None = None
        self.solved = np.zeros(0, bool)  # (b,) bodies that the pressure moves
        self.uncovered: tuple[np.ndarray, np.ndarray] | None = None  # cells (n, 3) to which the step has given a past,
        # and F there (n,) before that
        self.open_sides: list[int] = []  # of the domain
        self.no_exit = False  # no side of the domain lets liquid through
        self.on_fill: Callable[[np.ndarray], None] = ignore

    # ---- before the liquid moves

    def begin(
        self,
        flow: Flow,
        poses: Sequence[Pose],
        middle: Sequence[Pose],
        places: np.ndarray,
        velocities: np.ndarray,
        centres: Sequence[np.ndarray | None],
        dt: float,
    ) -> None:
        """Open fractions from now to the expected poses, by those of the middle, reached with velocities (b, 6) of B
        and spins, B at places (b, 3), within dt. centres: of balls, see body_fluxes."""
        before, swept = self.swept, self.covers.sweep(poses, middle=middle)
        self.swept = swept
        self.cells, rows = swept.cells, tuple(swept.cells.T)
        self.change = VolumeChange(rows, swept.V0, swept.V1, self.open.V)
        volumes = np.prod([d[k] for d, k in zip(self.grid[:3], rows, strict=True)], axis=0)
        self.volumes, self.growth = volumes, (swept.V1 - swept.V0) * volumes
        if before is not swept:
            args = self.grid, self.centres, places, velocities, centres, dt
            self.shares = mend_crossings(self.open, self.covers.open, swept.shares, swept.left, *args)
        self.no_void, self.all_inside = flow.F is None, self.covers.all_inside()
        self.narrow = NarrowFaces(self.open, self.numbers(self.cells))
        self.less = [np.zeros(len(slits)) for slits in self.narrow.slits]  # of what gravity gives there
        self.let_by = self.narrow.let_by(self.shares, self.grid, self.centres, places, velocities, centres)
        self.driven_by = self._find_driven(places, velocities)
        self._uncover_cells(flow, dt)
        self.beyond = np.zeros(len(swept.V0))
        if flow.F is not None:
            self.beyond = np.maximum(flow.F[rows] - 1.0, 0.0) * (self.change.most - swept.V0) * volumes
        self._find_faces(flow, places, velocities, dt)
        self.hold(flow.velocity)
        for u, going in zip(flow.velocity, self.going, strict=True):
            if u is not None:
                u.reshape(-1)[going[0]] = going[1]
        self._renew_at_mean(partial(self._find_fluxes, flow, places, centres))
        self.pushed = None if flow.F is not None else self._pushed_out(velocities)

    def _find_fluxes(self, flow: Flow, places: np.ndarray, centres: Sequence[np.ndarray | None]) -> None:
        """Of each body, B at places (b, 3); centres: of balls, see body_fluxes."""
        surface, mesh = self.surface(flow), (self.grid, self.centres)
        each = self.shares, self.swept.covered, places, centres, self.covers.covers
        self.fluxes: list[BodyFluxes] = [
            body_fluxes(self.narrow.shares_of(shares), covered, *mesh, place, centre, surface, cover, self.open_sides)
            for shares, covered, place, centre, cover in zip(*each, strict=True)
        ]

    @property
    def closed(self) -> np.ndarray:
        """(b,) bool: bodies that bring out of all cells together what they take in, since no void is left.

        Where they touch a wall the shares alone do not say so, and a constant pressure, which is that of nothing in
        liquid that is shut in, would push the body: one that hit the lid of a full tank came back four times as fast.
        """
        bodies = self.solved & self.no_exit | self.all_inside
        return np.broadcast_to(bodies & (self.no_void or self.is_full()), len(self.shares))

    @property
    def shut_in(self) -> bool:
        """Whether all cells together grow by nothing."""
        known = self.all_inside or self.no_exit and bool(self.solved.all())
        return known and (self.no_void or self.is_full())

    def surface(self, flow: Flow) -> Surface | None:
        """Of the liquid as it is now, among what is open now; None where nothing is void."""
        return None if flow.F is None else Surface(flow.F, self.gravity, self.covers.open)

    def _renew_at_mean(self, meanwhile: Callable[[], None]) -> None:
        """Sort faces anew with the mean of the open volumes, as the areas are means: what is open of a cell must not
        exceed its section, or its sides would be walls (wall_shear.py). meanwhile: what another thread may do."""
        V, change = self.open.V, self.change
        V[change.rows] = 0.5 * (change.V0 + change.V1)
        self.renew(self._changed(), meanwhile)
        V[change.rows] = change.most

    def _changed(self) -> np.ndarray | None:
        """Cells (n, 3) in C order that are open otherwise, or whose lower faces are, than when this was last asked;
        None: any may be."""
        before, self.sorted = self.sorted, self.numbers(self.cells)
        written = self.covers.take_changed()
        if before is None:
            return None
        return self._places(united([written, before, self.sorted]))

    def numbers(self, cells: np.ndarray) -> np.ndarray:
        """(n,): flat index into arrays of mesh size of cells (n, 3)."""
        return np.ravel_multi_index(tuple(cells.T.astype(np.int64)), self.open.V.shape)

    def _places(self, numbers: np.ndarray) -> np.ndarray:
        """Cells (n, 3) of flat indices (n,)."""
        cells = np.empty((len(numbers), 3), np.int32)
        cells_of(numbers, self.open.V.shape, cells)
        return cells

    def _pushed_out(self, velocities: np.ndarray) -> np.ndarray:
        """(n,) [length3/time]: what the bodies bring out of cells with these velocities, by their shares of faces."""
        out, numbers = np.zeros(len(self.cells)), self.numbers(self.cells)
        for one, U, closed in zip(self.fluxes, velocities, self.closed, strict=True):
            np.add.at(out, np.searchsorted(numbers, one.cells), (closed_sum(one.J) if closed else one.whole) @ U)
        return out

    def _uncover_cells(self, flow: Flow, dt: float) -> None:
        """F and p of cells that were closed: of what is around them, or void (torn.py)."""
        closed = self.change.V0 == 0.0
        at = self.cells[closed]
        self._uncover_pressure(flow.p, self.cells[closed | self._unsolved(flow.p)])
        self.uncovered = None
        if flow.F is None:
            return
        if len(at):
            self.uncovered = at, flow.F[tuple(at.T)]
        mean, weight = mean_around(flow.F, self.covers.open.V, at)
        void = self._torn(flow, closed, self.growth / dt)[closed] | (weight == 0.0)
        flow.F[tuple(at.T)] = np.where(void, 0.0, mean)
        self.on_fill(at)

    def _unsolved(self, p: np.ndarray) -> np.ndarray:
        """(n,) bool: of the cells, those that a body has uncovered a little where the last step expected it to stay, so
        that they were no unknowns: 2e-10 of a cell, 0 beside -340 Pa, let out 5 m/s as it opened."""
        return (p[tuple(self.cells.T)] == 0.0) & (self.change.V0 < BARELY) & p.any()

    def _torn(self, flow: Flow, which: np.ndarray, rates: np.ndarray, *, amid: bool = False) -> np.ndarray:
        """(n,) bool: of `which` (n,) bool of the cells, those that prescribed bodies open and liquid cannot fill with
        rates (n,) [length3/time]."""
        some = which & self.driven_by.any & (self.growth > 0.0)
        if some.any():
            around = Around(self.covers.open.V, self.open[1:], flow.F, flow.p)
            of = self.cells[some], rates[some], self.driven_by.speeds[some], around, self.grid, self.rho
            some[some] = torn(*of, amid=amid)
        return some

    def _find_driven(self, places: np.ndarray, velocities: np.ndarray) -> Driven:
        """Where prescribed bodies cover some of the cells, and the largest speed (n,) of these or in sight there."""
        numbers, n = self.numbers(self.cells), len(self.cells)
        found = Driven(np.zeros(n, bool), np.full(n, self.in_sight))
        for k in np.flatnonzero(~self.solved):
            covered = self.shares[k].cells[self.swept.covered[k] > 0.0]
            at, U = np.searchsorted(numbers, self.numbers(covered)), velocities[k]
            r = np.column_stack([x[covered[:, d]] for d, x in enumerate(self.centres)]) - places[k]
            found.any[at] = True
            found.speeds[at] = np.maximum(found.speeds[at], np.linalg.norm(U[:3] + np.cross(U[3:], r), axis=1))
        return found

    def _uncover_pressure(self, p: np.ndarray, at: np.ndarray) -> None:
        """p of cells at (n, 3) that were closed: of what is around, but for the weight of the liquid between.

        Slivers (cut_viscosity.py) and implicit viscosity feel the gradient of the last pressure: jets, were p what it
        is in solids, or beyond the sides of the domain.
        """
        V, rows = self.covers.open.V, tuple(at.T)
        mean, sums = mean_around(p, V, at, ghosts=False)
        for d, x in enumerate(self.centres):
            if self.weight[d] != 0.0:
                mean += self.weight[d] * (x[at[:, d]] - mean_around(None, V, at, along=(d, x), ghosts=False)[0])
        p[rows] = np.where(sums > 0.0, mean, p[rows])

    def _find_faces(self, flow: Flow, places: np.ndarray, velocities: np.ndarray, dt: float) -> None:
        """Faces that bodies cover: their own velocity on closed ones; on those that open, that of what is around; in
        slits that prescribed bodies shut, what is left of the liquid's (narrow_faces.py)."""
        self.held: list[tuple | None] = []
        self.going: list[tuple | None] = []  # numbers of slits (n,) that prescribed bodies shut, u of their jets now
        covered = [self._covered_faces(d, places, velocities) for d in range(3)]
        fastest = max(np.abs(speed[driven]).max(initial=0.0) for _, speed, driven in covered)
        for d, u in enumerate(flow.velocity):
            if u is None:
                self.held.append(None)
                self.going.append(None)
                continue
            faces, speed, driven = covered[d]
            before, mean = self.covers.open[1 + d], self.open[1 + d].reshape(-1)[faces]
            opens = np.flatnonzero((before.reshape(-1)[faces] == 0.0) & (mean > 0.0))
            at = np.column_stack(np.unravel_index(faces[opens], u.shape))
            around, weight = mean_around(u, before, at, open_or_not=True)
            u.reshape(-1)[faces[opens]] = np.where(weight > 0.0, around, speed[opens])
            shut = np.flatnonzero(mean <= NARROW)
            squeezed = shut[driven[shut] & self.narrow.closing(d, faces[shut], before)]
            relative = u.reshape(-1)[faces[squeezed]] - speed[squeezed]
            squeezed = squeezed[np.abs(relative) > JET * fastest]
            at, going = np.unravel_index(faces[squeezed], u.shape)[d], u.reshape(-1)[faces[squeezed]]
            apart = 0.5 * (self.grid[d][at] + self.grid[d][at + 1])
            self.going.append((faces[squeezed], going))
            speed[squeezed] += still_going(going - speed[squeezed], apart, dt)
            self.held.append((faces[shut], speed[shut], (mean[shut] > 0.0).astype(float)))

    def _covered_faces(
        self, d: int, places: np.ndarray, velocities: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Numbers of the faces along d that bodies cover (wholly or in part), the bodies' velocity there, and whether
        it is prescribed."""
        most = 2 * sum(len(shares.cells) for shares in self.shares)
        faces, speeds, driven, count = np.empty(most, np.int64), np.empty(most), np.zeros(most, bool), 0
        for shares, place, U, solved in zip(self.shares, places, velocities, self.solved, strict=True):
            of_body, first = (shares.cells, shares.faces, place, U, *self.centres), count
            count = covered_faces(np.int64(d), *of_body, np.int64(count), faces, speeds)
            driven[first:count] = not solved
        return faces[:count], speeds[:count], driven[:count]

    def hold(self, velocity: Sequence[np.ndarray | None], pull: Sequence[float] = (0.0, 0.0, 0.0)) -> None:
        """Closed and narrow faces have the velocity of the body that covers them; narrow ones also what gravity adds,
        pull [length/time], for without it water at rest would rise in gaps (less at the surface, `reach_slits`)."""
        for u, held, g in zip(velocity, self.held, pull, strict=True):
            if u is not None:
                u.reshape(-1)[held[0]] = held[1] + g * held[2]

    def rest_in_slits(self, velocity: Sequence[np.ndarray | None], dt: float) -> None:
        """Before the pressure: slits give back what gravity gave them too much at the surface (`reach_slits`)."""
        for u, slits, less, g in zip(velocity, self.narrow.slits, self.less, self.gravity, strict=True):
            if u is not None:
                u.reshape(-1)[slits] -= dt * g * less

    def reach_slits(self, wet: np.ndarray, b: tuple) -> None:
        """The pressure's coefficients b [length] of narrow faces and slits at the present surface, and what gravity
        gives to them (narrow_faces.py); once in a step, after `begin`. wet (mesh): not 0 in liquid cells."""
        for d, held in enumerate(self.held):
            if held is not None:
                narrow = np.flatnonzero(held[2])
                of = d, wet, self.open[1 + d], b[d], self.grid
                held[2][narrow] = reach_slits(held[0][narrow], *of)
                self.less[d] = 1.0 - reach_slits(self.narrow.slits[d], *of)

    def friction(
        self, momentum: Momentum, mu: float, F: np.ndarray | None, places: np.ndarray, U0: np.ndarray, W: np.ndarray,
        dt: float,
    ) -> Friction:  # fmt: skip
        """After begin: the walls of the bodies move with the liquid's friction (friction.py). B at places (b, 3), U0
        (b, 6), W (b, 6, 6), mu [mass/length/time]."""
        operators = momentum.operators
        spread = 0.0 if momentum.implicit else dt * momentum.nu
        walls = wall_faces(operators, self.shares, places, self.grid, self.open, self.centres, mu, F, spread)
        speeds = [None if o is None or o.cut is None else np.zeros(len(o.cut.rows)) for o in operators]
        spins = [spin_resistance(*one, self.grid, self.centres, mu, F) for one in zip(self.shares, places, strict=True)]
        found = Friction(walls, np.array(spins), speeds, U0, W, dt)
        momentum.move_walls(found)
        return found

    def fill_short(self, team: Team, columns: np.ndarray, lines: np.ndarray, flow: Flow, dt: float) -> None:
        """Cells of columns that lack a little are full in F until `restore_short` (short_cells.py), but for voids that
        bodies open (torn.py). lines: solid_lines.py."""
        self.short, voids = None, np.zeros(0, np.int64)
        if flow.F is None:
            return
        if self.driven_by.any.any():
            rows = tuple(self.cells.T)
            lacks = PUSH * (1.0 - flow.F[rows]) * self.covers.open.V[rows] * self.volumes
            void = self._torn(flow, flow.F[rows] < 0.5, (self.growth + lacks) / dt, amid=True)
            voids = self.numbers(self.cells[void])
        self.short = ShortCells(team, columns, flow.F, self.open.V, self.open[1:], lines, voids)
        self.on_fill(self._places(self.short.changed))

    def restore_short(self) -> None:
        """F as it is again; once for each `fill_short`."""
        if self.short is not None:
            self.short.restore()
            self.on_fill(self._places(self.short.changed))
        self.short = None

    # ---- the pressure equation

    def source(self, diagonal: np.ndarray, dt: float, ease: float, right: np.ndarray) -> None:
        """right [length3/time] -= the growth of the open volume of the equation's cells within dt.

        ease [time]: in it PUSH of what they hold too much leaves, and of what they lack enters.

        What such a cell holds too much of, F - 1, it holds of V0, not of the larger V that net_inflow sees.
        """
        into, rows = right.reshape(-1), self.numbers(self.cells)
        solved = diagonal.reshape(-1)[rows] != 0.0
        growth = self.growth - dt * self.let_by if self.pushed is None else dt * self.pushed
        growth = np.where(solved, growth, 0.0)
        if self.shut_in:
            growth = closed_sum(growth)
        into[rows] -= growth / dt + np.where(solved, PUSH * self.beyond, 0.0) / ease
        if self.short is not None:
            at = self.short.numbers
            cells = np.unravel_index(at, right.shape)
            volumes = np.prod([d[k] for d, k in zip(self.grid[:3], cells, strict=True)], axis=0)
            lacking = self.short.lack * self.covers.open.V.reshape(-1)[at] * volumes
            into[at] -= np.where(diagonal.reshape(-1)[at] != 0.0, PUSH * lacking / ease, 0.0)

    def opened(self, cells: np.ndarray, dt: float) -> tuple[np.ndarray, np.ndarray]:
        """See pressure/bodies.Opening: of cells (n, 3), V0 (n,) and what `source` asks them for (n,)."""
        V0, grown = self.covers.open.V[tuple(cells.T)], np.zeros(len(cells))
        own = self.numbers(self.cells)
        if not (len(cells) and len(own)):
            return V0, grown
        wanted = self.numbers(cells)
        at = np.minimum(np.searchsorted(own, wanted), len(own) - 1)
        asked = self.growth / dt - self.let_by
        return V0, np.where(own[at] == wanted, asked[at], 0.0)

    # ---- the liquid

    def arrive(self, poses: Sequence[Pose]) -> None:
        """The bodies came to stand at poses: the change of all cells that any of them touched on the way."""
        swept = self.covers.sweep(poses, keep_mean=True)
        then = self.numbers(swept.cells)
        both = united([self.numbers(self.cells), then])
        rows = np.unravel_index(both, self.open.V.shape)
        V0 = self.covers.open.V[rows]
        V1 = V0.copy()  # cells that a body was expected in only
        V1[np.searchsorted(both, then)] = swept.V1
        self.change = VolumeChange(rows, V0, V1, self.open.V)

    def withdraw(self) -> None:
        """The step failed: open fractions as before it."""
        self.restore_short()
        self.covers.withdraw()

    def settle(self) -> None:
        """The newest poses are now."""
        self.covers.settle()
