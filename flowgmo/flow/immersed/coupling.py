"""Bodies that the pressure moves, as part of the pressure equation.

    U_b = U_b* + rho M_b^-1 J_b^T q              q = p dt / rho, J_b as in body_fluxes.py, over liquid cells
    sum (A S u) + sum over b (J_b U_b) = ...     in every liquid cell

With u = u* - grad q the matrix becomes A + sum over b of rho J_b M_b^-1 J_b^T: symmetric, and no less definite than A,
so that the solution is stable at any density of the bodies (Gibou and Min 2012; Ng, Min and Gibou 2009). Each body adds
a matrix of rank six at most, which is applied as it stands and never formed: six sums over its wall cells.

M_b^-1 is the inverse of the free block of the mass matrix: zero for what is prescribed or held.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flowgmo.flow.immersed.body_fluxes import BodyFluxes


class Coupling:
    """fluxes: of each of n coupled bodies, in cells of the equation only; inverse_mass (6 n, 6 n); rho [liquid]."""

    def __init__(self, fluxes: Sequence[BodyFluxes], inverse_mass: np.ndarray, rho: float) -> None:
        self.fluxes, self.inverse_mass = fluxes, rho * inverse_mass

    def loads(self, q: np.ndarray) -> np.ndarray:
        """(6 n,): J^T q, the load of q [length2/time] in cells on the bodies, per density."""
        flat = q.reshape(-1)
        return np.concatenate([one.J.T @ flat[one.cells] for one in self.fluxes])

    def velocities(self, q: np.ndarray) -> np.ndarray:
        """(6 n,): the change of the bodies' velocities and spins that q makes."""
        return self.inverse_mass @ self.loads(q)

    def add(self, x: np.ndarray, sign: float, out: np.ndarray) -> float:
        """out += sign (sum of rho J M^-1 J^T) x; returns x . that sum x."""
        loads = self.loads(x)
        U, into = self.inverse_mass @ loads, out.reshape(-1)
        for n, one in enumerate(self.fluxes):
            into[one.cells] += sign * (one.J @ U[6 * n : 6 * n + 6])
        return float(loads @ U)
