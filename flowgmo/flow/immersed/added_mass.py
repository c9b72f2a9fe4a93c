"""The inertia that the liquid adds to a body for an impulse: the pressure equation solved for six unit velocities.

    A_fluid q = - J e_k   gives the impulse q = p dt / rho of liquid that a body sets going at once with velocity e_k
    A_jk = - rho J_j . q  added mass (6, 6), symmetric and >= 0

with the other bodies at rest and the surface where it is. An impact takes no time, so that nothing else acts in it: the
body answers an impulse with (M + A)^-1, and the liquid takes its share A dU of it.

Solutions may be rough. With what they leave of the equation, r_k = - J e_k - A_fluid q_k,

    A_jk = rho (- J_j . q_k + q_j . r_k)

misses the added mass by rho e_j . A_fluid e_k only, e the errors of q_j and q_k: two digits of q make four of A.
(- J_j . q_k alone is as good for j = k, where conjugate gradients leave r_k square to q_k; for other j it has two.)
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from flowgmo.flow.immersed.body_fluxes import BodyFluxes

NOTHING = 1e-12  # of a body's largest flux, and of it times a cell for turns: round-off, of a ball that turns
DIGITS = 1e-2  # of the first residual: measured 7e-6 to 4e-5 of A, 3 iterations a column (1e-4, without r: 5.5)


def added_mass(
    fluxes: BodyFluxes, solve: Callable[[np.ndarray, np.ndarray, float], Callable], shape: tuple, rho: float
) -> np.ndarray:
    """(6, 6) about B, space axes. fluxes: in cells of the equation only; shape: of arrays of mesh size.

    solve(right, q, digits): q (zero at first) becomes the solution of the pressure equation; returns what q . r is of
    this solution for any q, as a function.
    """
    out, known = np.zeros((6, 6)), {}
    cells, J = fluxes.cells, fluxes.J
    for k in np.flatnonzero(pushes(J)):
        right, q = np.zeros(shape), np.zeros(shape)
        right.reshape(-1)[cells] = -J[:, k]
        left = solve(right, q, DIGITS)
        size = 2.0 ** float(np.frexp(max(q.max(), -q.min()))[1])
        known[k] = (q / size).astype(np.float32), size  # 20 bytes a cell while this lasts; 1e-7 of a hundredth part
        for j, (of_j, scale) in known.items():
            out[j, k] = out[k, j] = rho * (scale * left(of_j) - float(J[:, j] @ q.reshape(-1)[cells]))
    return out


def pushes(J: np.ndarray) -> np.ndarray:
    """(6,) whether liquid is moved at all by each of the unit velocities of fluxes J (n, 6): none by a ball that turns,
    of which round-off is left."""
    sizes = np.abs(J).max(axis=0, initial=0.0)
    most = sizes[:3].max()
    return sizes > NOTHING * most * np.repeat([1.0, np.sqrt(most)], 3)


def wet_inverse(inverse_mass: np.ndarray, added: np.ndarray) -> np.ndarray:
    """(M + A)^-1 (6, 6) on what is free: P^1/2 (1 + P^1/2 A P^1/2)^-1 P^1/2 with P = M^-1, zero where nothing moves."""
    values, vectors = np.linalg.eigh(inverse_mass)
    root = (vectors * np.sqrt(np.maximum(values, 0.0))) @ vectors.T
    return root @ np.linalg.solve(np.eye(6) + root @ added @ root, root)
