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
    """fluxes: of each coupled body, in its liquid cells only; inverse_mass (b, 6, 6); rho of the liquid."""

    def __init__(self, fluxes: Sequence[BodyFluxes], inverse_mass: np.ndarray, rho: float) -> None:
        self.fluxes, self.inverse_mass = fluxes, rho * inverse_mass

    def velocities(self, q: np.ndarray) -> np.ndarray:
        """(b, 6): the change of each body's velocity and spin that q [length2/time] in cells makes."""
        flat = q.reshape(-1)
        loads = [J.T @ flat[cells] for cells, J, _ in self.fluxes]
        return np.array([m @ load for m, load in zip(self.inverse_mass, loads, strict=True)]).reshape(-1, 6)

    def add(self, x: np.ndarray, sign: float, out: np.ndarray) -> float:
        """out += sign (sum of rho J M^-1 J^T) x; returns x . that sum x."""
        flat, into, power = x.reshape(-1), out.reshape(-1), 0.0
        for (cells, J, _), m in zip(self.fluxes, self.inverse_mass, strict=True):
            load = J.T @ flat[cells]
            U = m @ load
            into[cells] += sign * (J @ U)
            power += float(load @ U)
        return power
