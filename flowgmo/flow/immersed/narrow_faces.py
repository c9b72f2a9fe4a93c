"""Faces beside bodies that are hardly open, widened for the pressure.

Open faces are open by NARROW at least: gaps between a body and what it rests on. In a gap of a millionth of a cell the
pressure would be what the solver's tolerance leaves, divided by the gap: jets, and blows on the body. So wide, the
pressure around the body reaches it. What flows there is the pressure's alone: before it acts the liquid moves with the
body, since friction would stop it at once.

A uniform stream that moves with a ball brings up to a hundredth of a face too much through them, which the pressure
answers with velocity: most of what a ball drifts by in decks/stream. Carried and asked for by what is open instead, it
drifts by a tenth of that; but then impacts book other energies than are lost, and light shells jump.

**At the surface.** Between a liquid cell and one that is not, the pressure ends at the surface
(surface_distance.py), at the share theta of the distance h of their centres. With the surface before the slit, in the
half of the liquid cell, nothing liquid passes the slit yet; what comes fills the void up to it, which is wider. As a
flow through the slit it meets hardly any inertia, A theta h, and so small an area does not relieve the pressure:

    u = q / (theta h)       39 m/s by the impulse of a ball that hits the bed, 3 without (hard/wet_thrown, theta .034)

which is nobody's momentum, and gone a step later, but bounds that step, and is in the books of energy as that of half
the cells beside it. Such a face counts as if the surface lay in the slit, u = q / (theta' h) with theta' h half a
liquid cell, and gravity gives it theta / theta' of what it gives others: so water stays at rest, with q = g dt theta h.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.favor.covered_cells import united
from flowgmo.flow.favor.shares import Shares
from flowgmo.flow.fields import Grid, Open
from flowgmo.kernel import kernel

NARROW = 0.01  # of a face


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
    """Of one step, for each direction: faces (m,), numbers of widened ones, ascending; factors (m,) of the bodies'
    shares."""

    def __init__(self, opened: Open, numbers: np.ndarray) -> None:
        """Widen faces of cells with these numbers (n,), ascending, in `opened`."""
        self.open, self.numbers, self.faces, self.factors = opened, numbers, [], []
        for d, A in enumerate(opened[1:]):
            flat = A.reshape(-1)
            near = [at[(flat[at] > 0.0) & (flat[at] < NARROW)] for at in (numbers, numbers - self._step(d))]
            faces = united(near)
            self.faces.append(faces)
            self.factors.append((1.0 - NARROW) / (1.0 - flat[faces]))
            flat[faces] = NARROW

    def _step(self, d: int) -> int:
        return self.open.V.strides[d] // self.open.V.itemsize

    def _numbers(self, shares: Shares) -> np.ndarray:
        return np.ravel_multi_index(tuple(shares.cells.T.astype(np.int64)), self.open.V.shape)

    def shares_of(self, shares: Shares) -> Shares:
        """A body's shares with A + sum of S = 1 on the widened faces too, so that it gets what the liquid loses."""
        if not any(len(faces) for faces in self.faces):
            return shares
        out, numbers = shares.faces.copy(), self._numbers(shares)
        for d, (faces, factors) in enumerate(zip(self.faces, self.factors, strict=True)):
            for upper in (0, 1):
                narrow(numbers - (1 - upper) * self._step(d), faces, factors, 2 * d + upper, out)
        return shares._replace(faces=out)


def reach_slits(faces: np.ndarray, d: int, wet: np.ndarray, b: np.ndarray, grid: Grid) -> np.ndarray:
    """b (mesh) [length] of the pressure's matrix on faces (n,), flat index, open by NARROW at most, at the surface:
    no more than with the surface in the slit. Returns theta / theta' (n,) of above, 1 on the others.

    d: direction of the faces; wet (mesh): not 0 in liquid cells.
    """
    out, along, liquid = np.ones(len(faces)), wet.strides[d] // wet.itemsize, wet.reshape(-1)
    beyond = liquid[faces + along] != 0
    at = np.flatnonzero((liquid[faces] != 0) != beyond)
    if not len(at):
        return out
    faces, beyond, flat = faces[at], beyond[at], b.reshape(-1)
    cells = np.unravel_index(faces + along * beyond, wet.shape)  # the liquid ones
    widths = [w[k] for w, k in zip(grid[:3], cells, strict=True)]
    most = NARROW * np.prod([w for e, w in enumerate(widths) if e != d], axis=0) / (0.5 * widths[d])
    before = flat[faces]
    flat[faces] = np.minimum(before, most)
    out[at] = np.divide(flat[faces], before, out=np.ones(len(at)), where=before > 0.0)
    return out
