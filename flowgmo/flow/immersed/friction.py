"""Friction between the liquid and bodies that move, within one step: equal and opposite, and stable at any mass.

The walls' velocity of the step U, the same for the liquid and for the body, is that which the body would have at its
end, with the liquid's velocity u as it is there:

    M (U - U0) = dt (pull(u) - K U)        (1 + dt M^-1 K) U = U0 + dt M^-1 pull        (moving_walls.py)

U0: what everything else would make of the body. A body of little mass then follows the liquid and does not overshoot;
explicitly dt K / M > 2 would blow up. With x = u - E U the exchange changes the kinetic energies by

    - dt sum D x^2 (1 - a / 2) - dt^2 / (2 M) (sum E^T D x)^2,    a = dt D / (mass of the face's liquid) <= 1

below zero always. The liquid's terms are evaluated at each stage of the prediction, and their mean counts; so after n
stages U is that for the mean u of all, and the wall of stage n has n U - (sum of the earlier ones).

With implicit viscosity u is what it becomes with these walls, a linear function of U. The residual

    left(U) = U0 + dt M^-1 load(u(U)) - U = 0

is then solved by the least squares of what the moves so far have gained, and (1 + dt M^-1 K)^-1 for the rest (Degroote,
Bathe and Vierendeels 2009, Performance of a new partitioned procedure versus a monolithic procedure in fluid-structure
interaction: for a linear function the same as GMRES). A heavy body needs no move: the first U is good enough.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from flowgmo.flow.immersed.moving_walls import WallFaces

Array = np.ndarray

FITS = 1e-3  # of what friction changes: a wall's velocity that misses the body's by this much; dt errs by more
MOST = 12  # turns; the six unknowns of one body alone take six


class Friction:
    """Of one step. walls: for each of b bodies, its faces; spins (b, 6, 6): spin_resistance. U0 (b, 6): velocities and
    spins that all else would give, W (b, 6, 6): inverse masses, zero for what is prescribed. speeds: of the cut faces
    of each component (n,) [length/time], written; None where there are none."""

    def __init__(
        self, walls: Sequence[Sequence[WallFaces]], spins: Array, speeds: Sequence[Array | None], U0: Array, W: Array,
        dt: float,
    ) -> None:  # fmt: skip
        self.walls, self.speeds, self.U0, self.W, self.dt = walls, speeds, U0, W, dt
        self.K = np.array([self._resistance(one) for one in walls]).reshape(-1, 6, 6) + spins
        scale = self._scale()  # in units of the bodies, so that the pivots are the same in all units
        own = np.eye(6) + dt * W @ self.K
        self.inverse = np.linalg.inv(scale[:, :, None] * own / scale[:, None]) * scale[:, None] / scale[:, :, None]
        self.U = U0.copy()
        self.pulls, self.slid, self.stages = np.zeros_like(U0), np.zeros_like(U0), 0
        self.loads = np.zeros_like(U0)

    @staticmethod
    def _resistance(faces: Sequence[WallFaces]) -> Array:
        """K (6, 6) of one body."""
        K = np.zeros((6, 6))
        for one in faces:
            K += one.resistance()
        return 0.5 * (K + K.T)

    def pull(self, velocity: Sequence[Array | None]) -> Array:
        """(b, 6): sum of E^T D u."""
        out = np.zeros_like(self.U0)
        for b, faces in enumerate(self.walls):
            for one in faces:
                out[b] += one.pull(velocity[one.c])
        return out

    def slide(self, U: Array) -> None:
        """Walls move with U (b, 6)."""
        for speed in self.speeds:
            if speed is not None:
                speed.fill(0.0)
        for faces, own in zip(self.walls, U, strict=True):
            for one in faces:
                self.speeds[one.c][one.at] += one.share * (one.E @ own)

    def _fit(self, pull: Array) -> Array:
        """(b, 6): U for the mean pull of the liquid."""
        free = self.U0 + self.dt * np.einsum("bij,bj->bi", self.W, pull)
        return np.einsum("bij,bj->bi", self.inverse, free)

    def load(self, pull: Array, U: Array) -> Array:
        """(b, 6): force and moment about B."""
        return pull - np.einsum("bij,bj->bi", self.K, U)

    # ---- explicit viscosity

    def meet(self, velocity: Sequence[Array | None]) -> None:
        """One more stage, with this velocity of the liquid: sets its walls, and the loads of the step so far."""
        self.stages += 1
        self.pulls += self.pull(velocity)
        mean = self.pulls / self.stages
        self.U = self._fit(mean)
        of_stage = self.stages * self.U - self.slid
        self.slid += of_stage
        self.slide(of_stage)
        self.loads = self.load(mean, self.U)

    # ---- implicit viscosity

    def diffuse(self, velocity: Sequence[Array | None], solve: Callable[[], None], change: Callable[[], None]) -> None:
        """solve(): velocity becomes that with viscosity and the walls of `speeds`; change(): adds what it gains when
        the walls are faster by `speeds`."""
        self.U = self._fit(self.pull(velocity))
        self.slide(self.U)
        solve()
        self.loads = self.load(self.pull(velocity), self.U)
        if not self.W.any():
            return
        left, scale = self._left(), self._scale()
        least = FITS * np.abs((left + self.U - self.U0) * scale).max()
        moves, gains = np.zeros((left.size, 0)), np.zeros((left.size, 0))
        while moves.shape[1] < MOST and np.abs(left * scale).max() > least:
            known, *_ = np.linalg.lstsq(gains, (left * scale).ravel(), rcond=None)
            rest = left - (gains @ known).reshape(left.shape) / scale
            move = (moves @ known).reshape(left.shape) + np.einsum("bij,bj->bi", self.inverse, rest)
            self.slide(move)
            change()
            self.U = self.U + move
            self.loads = self.load(self.pull(velocity), self.U)
            before, left = left, self._left()
            moves = np.column_stack([moves, move.ravel()])
            gains = np.column_stack([gains, ((before - left) * scale).ravel()])

    def _left(self) -> Array:
        """(b, 6): what the bodies' velocities miss of those of the walls."""
        return self.U0 + self.dt * np.einsum("bij,bj->bi", self.W, self.loads) - self.U

    def _scale(self) -> Array:
        """(b, 6): 1 and lengths, that make spins speeds of the wall."""
        scale = np.ones_like(self.U0)
        for own, faces in zip(scale, self.walls, strict=True):
            arms = [float((one.E[:, 3:] ** 2).sum(axis=1).max()) for one in faces]
            own[3:] = np.sqrt(max(arms, default=1.0))
        return scale
