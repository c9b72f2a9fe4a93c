"""Moving the liquid: d(V F)/dt + div(A u F) = 0 with the face velocities of the projection.

One direction after the other. In the sweep along x the flux through a face is A u dt times the liquid share of the
slab, u dt thick, that leaves the cell it comes from (liquid_flux.py), and

    V F* = V F + c dt (A+ u+ - A- u-) / dx - (flux+ - flux-) / dx      c = 1 where F > 1/2 at the start of the step

The middle term undoes the stretching of a sweep that by itself is not divergence-free, so that a full cell stays full
and an empty one empty: Weymouth and Yue 2010 ("Conservative Volume-of-Fluid method for free-surface simulations on
Cartesian-grids", J. Comput. Phys. 229). With c constant over the step the middle terms add up to
c dt div(A u) = 0; 0 <= F <= 1 holds where sum |u| dt / dx <= 1/2. Here the last sweep takes minus the sum of the
others: all middle terms cancel whatever div(A u) is, what is left telescopes over the faces, and the liquid's volume
changes by what passed the domain's sides, to round-off. A cell that the projection left with div(A u) != 0 becomes
a little over- or underfull, which the next projection takes back. Nothing is clipped; dust stays where it is or drifts.

The order of the sweeps goes through all permutations, each followed by its reverse.

A side may give F of what enters through it, spread evenly: A u dt times this F comes in, wherever a plane of the ghosts
would put it (`_let_in`).

Where solids cut cells, what their little open volume V could not take up goes to the neighbours (spill_over.py).
A body that moves changes V from V0 to V1 during the step, and A u and that change balance in full cells. Its motion
counts as one more sweep, the first one (immersed/volume_change.py).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from flowgmo.flow.columns import widen, widen_beyond
from flowgmo.flow.fields import Flow, G, Grid, Open
from flowgmo.flow.immersed.volume_change import VolumeChange
from flowgmo.flow.surface.carriers import Carrier, Way
from flowgmo.flow.surface.liquid_flux import plic_flux
from flowgmo.flow.surface.liquid_sweep import FIRST, LAST, sweep, through_sides
from flowgmo.flow.surface.pieces import Pieces
from flowgmo.flow.surface.planes import Planes
from flowgmo.flow.surface.spill_over import find_excess, find_left, find_shares, settle
from flowgmo.flow.team import Team

ORDERS = {
    1: ((0,),),
    2: ((0, 1), (1, 0)),
    3: ((0, 1, 2), (2, 1, 0), (1, 2, 0), (0, 2, 1), (2, 0, 1), (1, 0, 2)),
}

Spread = Sequence[float | None]  # of each side: F [-] of what enters, evenly spread; None: as its ghosts hold it
Heads = Sequence[np.ndarray | None]  # of each side: the energy of a volume of what passes (observe/streams.py)


@dataclass
class Tracking:
    """What the liquid's motion needs besides Flow: 9 bytes per cell, 17 with solids; pieces: None in meshes of more
    than one layer of cells, and of other fluxes than planes'.

    carry: kernel that fills flux, `liquid_flux.plic_flux` or `donor_acceptor.donor_acceptor_flux`. flux [length]:
    A u dt times the liquid's share, of one direction at a time, located like u. heavy int8: c above. share [-]: of
    spill_over.py.
    """

    grid: Grid
    planes: Planes
    ways: tuple[Way, Way, Way]
    carry: Callable
    flux: np.ndarray
    heavy: np.ndarray
    share: np.ndarray
    bounds: np.ndarray  # (n, n, 2) int32: scratch of `widen`
    pieces: Pieces | None


class Moved(NamedTuple):
    """The books of a step.

    entered (6,) [length^3]: liquid that came in through Xmin .. Zmax; brought: the energy that it brought. over, under:
    largest V F - V and least V F of all cells, in shares of a cell, 0 if none. lost [length^3]: of cells that closed
    with no open face, else 0.
    """

    entered: np.ndarray
    brought: float
    over: float
    under: float
    lost: float


def tracking_of(
    grid: Grid,
    carry: Callable = plic_flux,
    planes: Planes | None = None,
    periodic: tuple[bool, bool, bool] = (False, False, False),
) -> Tracking:
    """Scratch arrays for a mesh, and the kernel that takes the liquid across faces. planes: the scene's, None: own;
    periodic: which sides are joined."""
    shape = (len(grid.dx), len(grid.dy), len(grid.dz))
    even = np.ones(shape[2])
    ways = Way(0, 1.0 / grid.dx, even), Way(1, 1.0 / grid.dy, even), Way(2, np.ones(1), 1.0 / grid.dz)
    bounds = np.zeros((*shape[:2], 2), np.int32)
    flux, heavy, share = np.zeros(shape), np.zeros(shape, np.int8), np.zeros(shape)
    planes, flat = planes or Planes(grid), sum(n == 1 + 2 * G for n in shape) == 1
    pieces = Pieces(grid, planes, periodic) if flat and carry is plic_flux else None
    return Tracking(grid, planes, ways, carry, flux, heavy, share, bounds, pieces)


def move_liquid(
    team: Team,
    tracking: Tracking,
    flow: Flow,
    opened: Open,
    dt: float,
    number: int,
    fill: Callable[[np.ndarray], None],
    change: VolumeChange | None = None,
    spread: Spread = (None,) * 6,
    heads: Heads = (None,) * 6,
) -> Moved:
    """Advance flow.F by dt [time] with the velocities u, v, w on faces; absent directions (None) are skipped.

    number of the step chooses the order of the sweeps. fill(F) sets the two ghost layers of F, corners too: mirror
    at walls, symmetry and absent directions, copy where periodic, what flows in at open sides; it is called before
    every sweep, but where the planes of F are known. change: of opened.V, which is then that of the end of the step.
    spread, heads: as of Spread and Heads; spread of the ghosts that fill(F) sets.
    With tracking.pieces: their moments are those of the end; the caller keeps them where the step is made.
    Holds after: the total of V F changed by what entered, to round-off; closed cells are dry.
    """
    F, own = flow.F, zip((flow.u, flow.v, flow.w), opened[1:], tracking.ways, strict=True)
    carriers = [Carrier(q, A, way) for q, A, way in own if q is not None]
    planes = tracking.planes
    if change is not None:
        change.stretch(F)
        planes.touch(np.column_stack(change.rows))
    entered, brought = np.zeros(6), 0.0
    if not planes.are_of(F):
        fill(F)
        planes.find(team, F, opened)
    wet = widen(planes.columns, 1, F.shape, tracking.bounds)
    if len(wet) == 0 or not carriers:
        planes.forget()
        if change is not None:
            change.restore(F, opened, tracking.grid)
        return Moved(entered, 0.0, 0.0, 0.0, 0.0)
    lines, around = planes.solid_lines.of(opened), widen(wet, 1, F.shape, tracking.bounds)
    reached = widen_beyond(planes.columns, 1, F.shape, tracking.bounds)
    orders = ORDERS[len(carriers)]
    order = [carriers[n] for n in orders[number % len(orders)]]
    pieces = tracking.pieces if len(order) == 2 else None
    if pieces is not None:
        np.copyto(pieces.before, F)
        pieces.spread_evenly(spread)
    for at, carrier in enumerate(order):
        if at > 0:
            fill(F)
        if at > 0 and pieces is not None:
            pieces.flow_across(team, (around, reached), order, dt, F, opened, tracking.flux)
        else:
            if at > 0 and tracking.carry is plic_flux:
                planes.find_in(team, reached, F, opened)
            found = planes.at, lines
            team.run_uneven(tracking.carry, around, carrier, dt, F, opened.V, opened, *found, tracking.flux)
        d = carrier.way.d
        _let_in(carrier, dt, spread[2 * d : 2 * d + 2], tracking.flux)
        _sweep(team, tracking, wet, order, at, F, opened.V, lines, dt)
        entered[2 * d : 2 * d + 2], more = _passed(team, tracking, wet, d, heads)
        brought += more
    planes.forget()
    if change is not None:
        change.restore(F, opened, tracking.grid)
    books = _settle(team, tracking, wet, around, F, opened, lines)
    if pieces is not None:
        fill(F)
        pieces.find_moments(team, wet, order, dt, F)
    return Moved(entered, brought, *books)


def _let_in(carrier: Carrier, dt: float, spread: Spread, flux: np.ndarray) -> None:
    """flux [length] of what enters through the lower and upper side of a direction where spread gives its F."""
    d, ends = carrier.way.d, (G - 1, flux.shape[carrier.way.d] - G - 1)
    for upper, (F, side) in enumerate(zip(spread, ends, strict=True)):
        if F is not None:
            at = (slice(None),) * d + (side,)
            moved = dt * carrier.q[at] * (1.0 if carrier.A is None else carrier.A[at])
            enters = moved < 0.0 if upper else moved > 0.0
            flux[at][enters] = F * moved[enters]


def _sweep(
    team: Team,
    tracking: Tracking,
    wet: np.ndarray,
    order: list[Carrier],
    at: int,
    F: np.ndarray,
    V: np.ndarray | None,
    lines: np.ndarray | None,
    dt: float,
) -> None:
    """Sweep number `at` of the order, with the fluxes in tracking.flux."""
    last = at == len(order) - 1
    before = (*order[:at], None, None)[:2] if last else (None, None)
    kind = (FIRST if at == 0 else 0) | (LAST if last else 0)
    own = order[at]
    team.run(sweep, wet, kind, own, own.A, *before, dt, F, V, lines, tracking.flux, tracking.heavy)


def _passed(team: Team, tracking: Tracking, wet: np.ndarray, d: int, heads: Heads) -> tuple[np.ndarray, float]:
    """(2,) [length^3]: liquid that came in through the lower and upper side of direction d; the energy it brought."""
    through = np.empty((4, len(wet)))
    n = tracking.flux.shape[d] - 4  # two ghost layers at each end
    team.run(through_sides, wet, d, n, tracking.flux, tracking.grid, heads[2 * d], heads[2 * d + 1], through)
    sums = through.sum(axis=1)
    return sums[:2], float(sums[2:].sum())


def _settle(
    team: Team,
    tracking: Tracking,
    wet: np.ndarray,
    around: np.ndarray,
    F: np.ndarray,
    opened: Open,
    lines: np.ndarray | None,
) -> tuple[float, float, float]:
    """(over, under, lost) once the excess of cut cells has gone to their neighbours; V F has become F."""
    V, reached, more = opened.V, wet, False
    cells, some = (F, V, opened, tracking.grid), np.zeros(F.shape[:2], np.int8)
    rates = tracking.flux, some, tracking.share
    if V is not None:
        reached = around  # what came as far as the border of wet, and finds no room there, goes one cell beyond it
        donors, left = widen(around, 1, F.shape, tracking.bounds), np.empty(len(around))
        team.run(find_excess, donors, False, *cells, lines, *rates[:2])
        team.run(find_shares, around, *cells[1:], *rates)
        team.run(find_left, around, *cells, *rates, left)
        more = bool(left.any())
    books = np.empty((len(reached), 3))
    team.run(settle, reached, False, more, *cells, lines, *rates, books)
    if more:
        team.run(find_excess, donors, True, *cells, lines, *rates[:2])
        team.run(settle, reached, True, False, *cells, lines, *rates, books)
    return float(books[:, 0].max()), float(books[:, 1].min()), float(books[:, 2].sum())
