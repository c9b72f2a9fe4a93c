"""Faces beside bodies that are hardly open, widened for the pressure.

Open faces are open by NARROW at least: gaps between a body and what it rests on. In a gap of a millionth of a cell the
pressure would be what the solver's tolerance leaves, divided by the gap: jets, and blows on the body. So wide, the
pressure around the body reaches it. What flows there is the pressure's alone: before it acts the liquid moves with the
body, since friction would stop it at once.

A uniform stream that moves with a ball brings up to a hundredth of a face too much through them, which the pressure
answers with velocity: most of what a ball drifts by in decks/stream. Carried and asked for by what is open instead, it
drifts by a tenth of that; but then impacts book other energies than are lost, and light shells jump.
"""

from __future__ import annotations

import numpy as np

from flowgmo.flow.favor.covered_cells import united
from flowgmo.flow.favor.shares import Shares
from flowgmo.flow.fields import Open
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
