"""Faces beside bodies that are hardly open: widened for the pressure, and passed as they are.

Open faces are open by NARROW at least, A' in place of A: gaps between a body and what it rests on. In a gap of a
millionth of a cell the pressure would be what the solver's tolerance leaves, divided by the gap: jets, and blows on the
body. So wide, the pressure around the body reaches it. What flows there is the pressure's alone: before it acts the
liquid moves with the body, since friction would stop it at once.

Liquid that goes with the body passes by what is open only. With U of the wall there

    asked     sum over faces (A' u) = - (V1 - V0) / dt + sum over faces (A' - A) U . n       (projection)
    carried   A' u - (A' - A) U                                                              (through each face)

so that a uniform stream fits, and a full cell is full afterwards, exactly. With A' u on both sides a stream that moves
with a ball would bring up to a hundredth of a face too much, which the pressure answers with velocity: nine tenths of
what a ball drifted by (decks/stream).

The energy that the pressure keeps does not know of this. With b of the pressure's matrix, A' in it, S areas, and J' the
body's shares on the widened faces, A' + S' = 1,

    K(u, U) = 1/2 sum over faces rho (A' S u)^2 / b  +  1/2 U M U           A' u + J' U = c      in every cell

c is what A' - A let by: a right-hand side, no part of the rows. A step goes to the (u, U) with this c that is nearest
in K; since V1 - V0 = dt J U of a wall that is exact, J = J' + (A' - A) n, c is nothing where liquid and wall go
together, and was - (A' - A) U before: energy from nothing. An impact changes u and U within the step, by
A' du + J' dU = 0: the same rows, areas and b, the same K, and no c at all (wet_impacts.py). It sees the faces of the
step; liquid has been carried by then.

**Slits that a prescribed body shuts.** What it presses out must pass them, with velocities u that the pressure
has to give. At rest before each step the liquid would take p = rho u length / dt for it, length that between the cells,
and the work would grow without bound as steps get shorter: a gate that comes down on its bed with 1 m/s beside a wall
worked 154, 268, 822 J with steps of .45, .15, .05 of a cell. There the liquid keeps what it has relative to the wall,
but for the head of the jet behind the slit, rho u^2 / 2,

    du/dt = - u |u| / (2 length)          u1 = u0 / (1 + |u0| dt / (2 length))

and these are 93, 82, 98 J. So jets, JET times as fast as the walls. Other liquid beside a prescribed body is at rest
in slits as above (a ball drawn through a full tank left cells 1.4e-3 off full where it was not, 6.5e-5 at rest), and
all of it beside bodies that the pressure moves, which give way.

**At the surface.** Between a liquid cell and one that is not, the pressure ends at the surface
(surface_distance.py), at the share theta of the distance h of their centres. With the surface before the slit, in the
half of the liquid cell, nothing liquid passes the slit yet; what comes fills the void up to it, which is wider. As a
flow through the slit it meets hardly any inertia, A theta h, and so small an area does not relieve the pressure:

    u = q / (theta h)       39 m/s by the impulse of a ball that hits the bed, 3 without (hard/wet_thrown, theta .034)

which is nobody's momentum, and gone a step later, but bounds that step, and is in the books of energy as that of half
the cells beside it. Such a face counts as if the surface lay in the slit, u = q / (theta' h) with theta' h half a
liquid cell, and gravity gives it theta / theta' of what it gives others: so water stays at rest, with q = g dt theta h.
Faces that are open by more than that, up to SLIT, are on the way to those that count as they are: half a cell becomes
(SLIT - A) / (SLIT - NARROW) of it. A ball that met the water had 21 m/s at A = .024, theta some .01, 12 kPa in a step
(hard/wet_pile), and 6 % of the kinetic energy with it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flowgmo.flow.favor.covered_cells import united
from flowgmo.flow.favor.shares import Shares
from flowgmo.flow.fields import G, Grid, Open
from flowgmo.flow.immersed.crossings import SLOW, wall_speeds
from flowgmo.kernel import kernel

NARROW = 0.01  # of a face
JET = 3.0  # times the speed of the walls: liquid that prescribed bodies press out of slits; beside a ball it has 1.5
SLIT = 0.1  # of a face: wider ones have the surface where it is; a choice


@kernel
def narrow(numbers, faces, factors, part, shares):
    """shares[:, part] times the factor of the face, where numbers (n,) of faces, ascending, are among faces (m,)."""
    n = np.int64(0)
    for c in range(len(numbers)):
        while n < len(faces) and faces[n] < numbers[c]:
            n += 1
        if n < len(faces) and faces[n] == numbers[c]:
            shares[c, part] *= factors[n]


class NarrowFaces:
    """Of one step, for each direction: faces (m,), numbers of widened ones, ascending; opened (m,) A; factors (m,) of
    the bodies' shares; along, (A' - A) / A' U of the walls there (m,) [length/time]; slits, numbers of faces open by
    NARROW to SLIT."""

    def __init__(self, opened: Open, numbers: np.ndarray) -> None:
        """Widen faces of cells with these numbers (n,), ascending, in `opened`."""
        self.open, self.numbers, self.faces, self.factors, self.slits = opened, numbers, [], [], []
        self.opened = []
        for d, A in enumerate(opened[1:]):
            flat = A.reshape(-1)
            near = [at[(flat[at] > 0.0) & (flat[at] < NARROW)] for at in (numbers, numbers - self._step(d))]
            faces = united(near)
            self.faces.append(faces)
            self.opened.append(flat[faces])
            self.factors.append((1.0 - NARROW) / (1.0 - flat[faces]))
            flat[faces] = NARROW
            slits = [at[(flat[at] > NARROW) & (flat[at] < SLIT)] for at in (numbers, numbers - self._step(d))]
            self.slits.append(united(slits))
        self.along = [np.zeros(len(faces)) for faces in self.faces]

    def _step(self, d: int) -> int:
        return self.open.V.strides[d] // self.open.V.itemsize

    def _numbers(self, shares: Shares) -> np.ndarray:
        return np.ravel_multi_index(tuple(shares.cells.T.astype(np.int64)), self.open.V.shape)

    def shares_of(self, shares: Shares) -> Shares:
        """A body's shares with A' + sum of S = 1 on the widened faces too, so that it gets what the liquid loses."""
        if not any(len(faces) for faces in self.faces):
            return shares
        out, numbers = shares.faces.copy(), self._numbers(shares)
        for d, (faces, factors) in enumerate(zip(self.faces, self.factors, strict=True)):
            for upper in (0, 1):
                narrow(numbers - (1 - upper) * self._step(d), faces, factors, 2 * d + upper, out)
        return shares._replace(faces=out)

    def closing(self, d: int, faces: np.ndarray, before: np.ndarray) -> np.ndarray:
        """(n,) bool: those of faces (n,) along d that are widened, and open by less than `before` (mesh)."""
        if not len(self.faces[d]):
            return np.zeros(len(faces), bool)
        at = np.minimum(np.searchsorted(self.faces[d], faces), len(self.faces[d]) - 1)
        less = before.reshape(-1)[faces] - self.opened[d][at] > SLOW
        return less & (self.faces[d][at] == faces)

    def let_by(
        self, shares: Sequence[Shares], grid: Grid, centres: Sequence[np.ndarray], places: np.ndarray,
        velocities: np.ndarray, middles: Sequence[np.ndarray | None],
    ) -> np.ndarray:  # fmt: skip
        """(n,) [length3/time]: sum over faces of each cell of (A' - A) U . n area, n outward; none on sides.

        shares, B at places (b, 3) [length], velocities (b, 6) and middles of the bodies, centres of cells: as in
        body_fluxes.
        """
        for one, place, U, middle in zip(shares, places, velocities, middles, strict=True):
            lost = one.faces - self.shares_of(one).faces
            some = lost.any(axis=1)
            if some.any():
                cells = one.cells[some]
                r = np.column_stack([x[cells[:, e]] for e, x in enumerate(centres)]) - place
                self._add(Shares(cells, lost[some]), wall_speeds(r, U, middle))
        out = np.zeros(len(self.numbers))
        at = np.unravel_index(self.numbers, self.open.V.shape)
        for d, (faces, speed) in enumerate(zip(self.faces, self.along, strict=True)):
            if len(faces):
                area = grid[(d + 1) % 3][at[(d + 1) % 3]] * grid[(d + 2) % 3][at[(d + 2) % 3]]
                for face, sign in ((self.numbers, 1.0), (self.numbers - self._step(d), -1.0)):
                    row = np.minimum(np.searchsorted(faces, face), len(faces) - 1)
                    out += np.where(faces[row] == face, sign * NARROW * speed[row] * area, 0.0)
        return out

    def _add(self, lost: Shares, way: np.ndarray) -> None:
        """Of one body: what its shares of faces lost, and velocities (n, 3) of its wall in their cells."""
        numbers = self._numbers(lost)
        for d, faces in enumerate(self.faces):
            last = self.open.V.shape[d] - G - 1
            for upper in (0, 1):
                inside = lost.cells[:, d] != (last if upper else G)
                hit = np.flatnonzero((lost.faces[:, 2 * d + upper] > 0.0) & inside)
                row = np.searchsorted(faces, numbers[hit] - (1 - upper) * self._step(d))
                self.along[d][row] += 0.5 * lost.faces[hit, 2 * d + upper] * way[hit, d] / NARROW  # half of each cell

    def lean(self, velocity: Sequence[np.ndarray | None], sign: float) -> None:
        """Velocities become those with which liquid is carried through widened faces, sign 1, or again what they were,
        sign -1."""
        for u, faces, speed in zip(velocity, self.faces, self.along, strict=True):
            if u is not None:
                u.reshape(-1)[faces] -= sign * speed


def still_going(u: np.ndarray, length: np.ndarray, dt: float) -> np.ndarray:
    """u (n,) [length/time] after dt with du/dt = -u |u| / (2 length), length (n,)."""
    return u / (1.0 + 0.5 * dt * np.abs(u) / length)


def reach_slits(faces: np.ndarray, d: int, wet: np.ndarray, A: np.ndarray, b: np.ndarray, grid: Grid) -> np.ndarray:
    """b (mesh) [length] of the pressure's matrix on faces (n,), flat index, at the surface: no more than with the
    surface in the slit, of those open by NARROW, less and less up to SLIT. Returns theta / theta' (n,) of above, 1 on
    the others.

    d: direction of the faces; wet (mesh): not 0 in liquid cells; A (mesh) [-]: their openings.
    """
    out, along, liquid = np.ones(len(faces)), wet.strides[d] // wet.itemsize, wet.reshape(-1)
    beyond = liquid[faces + along] != 0
    at = np.flatnonzero((liquid[faces] != 0) != beyond)
    if not len(at):
        return out
    faces, beyond, flat = faces[at], beyond[at], b.reshape(-1)
    cells = np.unravel_index(faces + along * beyond, wet.shape)  # the liquid ones
    widths = [w[k] for w, k in zip(grid[:3], cells, strict=True)]
    opened = A.reshape(-1)[faces]
    length = 0.5 * widths[d] * np.minimum((SLIT - opened) / (SLIT - NARROW), 1.0)
    most = opened * np.prod([w for e, w in enumerate(widths) if e != d], axis=0)
    before = flat[faces]
    flat[faces] = np.where(before * length > most, most / np.maximum(length, 1e-300), before)
    out[at] = np.divide(flat[faces], before, out=np.ones(len(at)), where=before > 0.0)
    return out
