"""The inertia that the liquid adds to a body for an impulse: the pressure equation solved for six unit velocities.

    A_fluid q = - J e_k   gives the impulse q = p dt / rho of liquid that a body sets going at once with velocity e_k
    A_jk = - rho J_j . q  added mass (6, 6), symmetric and >= 0

with the other bodies at rest and the surface where it is. An impact takes no time, so that nothing else acts in it: the
body answers an impulse with (M + A)^-1, and the liquid takes its share A dU of it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from flowgmo.flow.immersed.body_fluxes import BodyFluxes

DIGITS = 1e-4  # of the first residual: the added mass to four digits, where meshes give three


def added_mass(
    fluxes: BodyFluxes, solve: Callable[[np.ndarray, np.ndarray, float], None], shape: tuple, rho: float
) -> np.ndarray:
    """(6, 6) about B, space axes. fluxes: in cells of the equation only; solve(right, q, digits): q (zero at first)
    becomes the solution of the pressure equation; shape: of arrays of mesh size."""
    out = np.zeros((6, 6))
    cells, J = fluxes.cells, fluxes.J
    for k in range(6):
        if not len(cells) or not J[:, k].any():
            continue
        right, q = np.zeros(shape), np.zeros(shape)
        right.reshape(-1)[cells] = -J[:, k]
        solve(right, q, DIGITS)
        out[:, k] = -rho * (J.T @ q.reshape(-1)[cells])
    return 0.5 * (out + out.T)


def wet_inverse(inverse_mass: np.ndarray, added: np.ndarray) -> np.ndarray:
    """(M + A)^-1 (6, 6) on what is free: P^1/2 (1 + P^1/2 A P^1/2)^-1 P^1/2 with P = M^-1, zero where nothing moves."""
    values, vectors = np.linalg.eigh(inverse_mass)
    root = (vectors * np.sqrt(np.maximum(values, 0.0))) @ vectors.T
    return root @ np.linalg.solve(np.eye(6) + root @ added @ root, root)
