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

from flowgmo.kernel import inner, kernel

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
    inverse_mass: np.ndarray, start: np.ndarray, rows: np.ndarray, speed: np.ndarray, known: dict | None = None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """W' (6 n, 6 n), U*' (6 n,) and (N W N^T)^+ (m, m): lambda = - that (N U - speed), U without the contacts.

    inverse_mass W (6 n, 6 n), start U* (6 n,), rows (m, 6 n) with right-hand sides speed (m,). Bodies that no row and
    nothing in W joins are solved apart: the cost goes with the cube of the largest group, not of all of them. known:
    solutions of groups by all that they depend on, looked up and added to: between the solutions of a step few change.
    """
    if not len(rows):
        return inverse_mass, start, np.zeros((0, 0))
    W, U, inverse = inverse_mass.copy(), start.copy(), np.zeros((len(rows), len(rows)))
    known = {} if known is None else known
    for of_rows, of_bodies in _groups(inverse_mass, rows):
        own, among = (of_bodies[:, None], of_bodies), (of_rows[:, None], of_rows)
        parts = inverse_mass[own], start[of_bodies], rows[of_rows[:, None], of_bodies], speed[of_rows]
        key = tuple(part.tobytes() for part in parts)
        if key not in known:
            known[key] = _constrain_group(*parts)
        W[own], U[of_bodies], inverse[among] = known[key]
    return W, U, inverse


@inner
def _touch(values, body):
    """Whether any of values (6 n,) of a body is not 0."""
    for c in range(6 * body, 6 * body + 6):
        if values[c] != 0.0:
            return True
    return False


@inner
def _first(group, a):
    """The first body of a's group."""
    while group[a] != a:
        a = group[a]
    return a


@kernel
def _join(rows, inverse_mass, group, of_rows):
    """group (n,), which begins with every body apart: the first body of each one's group; of_rows (m,): of each row's,
    0 where it touches none."""
    for r in range(len(rows) + len(inverse_mass)):
        values = rows[r] if r < len(rows) else inverse_mass[r - len(rows)]
        before = np.int64(-1) if r < len(rows) else np.int64((r - len(rows)) // 6)
        for body in range(len(group)):
            if _touch(values, body):
                if before >= 0:
                    a, b = _first(group, before), _first(group, np.int64(body))
                    group[max(a, b)] = min(a, b)
                before = np.int64(body)
        if r < len(rows):
            of_rows[r] = max(before, 0)
    for body in range(len(group)):
        group[body] = _first(group, np.int64(body))
    for r in range(len(rows)):
        of_rows[r] = group[of_rows[r]]


def _groups(inverse_mass: np.ndarray, rows: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """(rows, components of U) of each group of bodies that rows or W join; only groups with rows."""
    group = np.arange(len(inverse_mass) // 6)
    of_rows = np.empty(len(rows), np.int64)
    _join(np.ascontiguousarray(rows), np.ascontiguousarray(inverse_mass), group, of_rows)
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
