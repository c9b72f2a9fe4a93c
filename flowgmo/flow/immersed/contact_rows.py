"""Contacts that bodies keep while the pressure moves them: rows "no approach" beside the pressure equation.

    N U >= 0,   lambda >= 0,   one of them is equal           N (k, 6 bodies): approach of each contact, reversed
    U = U* + W (rho J^T q + N^T lambda)                       W: inverse masses of the bodies

A stone that the stream presses on the bed must not be projected into it in one step and pushed out by the next. The
rows that are pressed hold as equations: the bodies then answer the liquid with

    W' = W - W N^T (N W N^T)^+ N W         and start with  U*' = U* - W N^T (N W N^T)^+ N U*

so that the matrix of the pressure stays symmetric. Rows that pull are let go and rows that approach are taken up, and
the pressure is solved again, until neither happens (Takahashi and Batty 2020, "Monolith"). Contacts that stuck by
friction have two more rows along the surface as long as their normal row is pressed.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.sparse.csgraph import connected_components

SMALLEST = 1e-6  # of the largest singular value of N sqrt(W): rows that say the same


class Rows(NamedTuple):
    """normal (k, 6 n) and, where stuck (k,), tangential rows (k, 2, 6 n) of n bodies; speed (k,), slip (k, 2)
    [length/time]: what N U must reach, since a partner that is not solved for moves."""

    normal: np.ndarray
    tangential: np.ndarray
    stuck: np.ndarray
    speed: np.ndarray
    slip: np.ndarray

    def pressed(self, active: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Rows (m, 6 n) and right-hand sides (m,) of the active contacts (k,) bool."""
        rub = active & self.stuck
        size = self.normal.shape[1]
        rows = np.concatenate([self.normal[active], self.tangential[rub].reshape(-1, size)])
        return rows, np.concatenate([self.speed[active], self.slip[rub].reshape(-1)])


def rows_of_contacts(
    a: np.ndarray,
    b: np.ndarray,
    point: np.ndarray,
    normal: np.ndarray,
    stuck: np.ndarray,
    place: np.ndarray,
    velocity: np.ndarray,
    number: np.ndarray,
    count: int,
) -> Rows:
    """Rows of contacts (k,) between parties a and b, normal from b to a; place (p, 3), velocity (p, 6) of the parties;
    number (p,): of those that are solved for, -1 of others; count: how many these are."""
    k = len(a)
    first = np.eye(3)[np.abs(normal).argmin(axis=1)]
    one = np.cross(normal, first)
    one /= np.linalg.norm(one, axis=1)[:, None]
    directions = np.stack([normal, one, np.cross(normal, one)], axis=1)
    rows, speeds = np.zeros((k, 3, 6 * count)), np.zeros((k, 3))
    for side, sign in ((a, 1.0), (b, -1.0)):
        arm = point - place[side]
        full = sign * np.concatenate([directions, np.cross(arm[:, None], directions)], axis=2)
        for c in range(k):
            n = number[side[c]]
            if n >= 0:
                rows[c, :, 6 * n : 6 * n + 6] += full[c]
            else:
                speeds[c] -= full[c] @ velocity[side[c]]
    return Rows(rows[:, 0], rows[:, 1:], stuck, speeds[:, 0], speeds[:, 1:])


def constrain(
    inverse_mass: np.ndarray, start: np.ndarray, rows: np.ndarray, speed: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """W' (6 n, 6 n), U*' (6 n,) and (N W N^T)^+ (m, m): lambda = - that (N U - speed), U without the contacts.

    inverse_mass W (6 n, 6 n), start U* (6 n,), rows (m, 6 n) with right-hand sides speed (m,). Bodies that no row and
    nothing in W joins are solved apart: the cost goes with the cube of the largest group, not of all of them.
    """
    if not len(rows):
        return inverse_mass, start, np.zeros((0, 0))
    W, U, inverse = inverse_mass.copy(), start.copy(), np.zeros((len(rows), len(rows)))
    for of_rows, of_bodies in _groups(inverse_mass, rows):
        own, among = np.ix_(of_bodies, of_bodies), np.ix_(of_rows, of_rows)
        part = rows[np.ix_(of_rows, of_bodies)]
        W[own], U[of_bodies], inverse[among] = _constrain_group(
            inverse_mass[own], start[of_bodies], part, speed[of_rows]
        )
    return W, U, inverse


def _groups(inverse_mass: np.ndarray, rows: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """(rows, components of U) of each group of bodies that rows or W join; only groups with rows."""
    n = len(inverse_mass) // 6
    touched = rows.reshape(-1, n, 6).any(axis=2)
    joined = touched.T.astype(np.int64) @ touched + inverse_mass.reshape(n, 6, n, 6).any(axis=(1, 3))
    _, group = connected_components(joined, directed=False)
    of_rows = group[touched.argmax(axis=1)]
    number = np.repeat(group, 6)
    return [(np.flatnonzero(of_rows == g), np.flatnonzero(number == g)) for g in np.unique(of_rows)]


def _constrain_group(
    inverse_mass: np.ndarray, start: np.ndarray, rows: np.ndarray, speed: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """As `constrain`, of one group."""
    values, vectors = np.linalg.eigh(inverse_mass)
    L = vectors * np.sqrt(np.maximum(values, 0.0))  # W = L L^T, so that W' cannot be negative by rounding
    left, size, right = np.linalg.svd(rows @ L, full_matrices=False)
    kept = size > SMALLEST * size.max(initial=0.0)
    left, size, right = left[:, kept], size[kept], right[kept]
    free = L - (L @ right.T) @ right
    lacking = left.T @ (rows @ start - speed)
    return free @ free.T, start - L @ (right.T @ (lacking / size)), (left / size**2) @ left.T
